#include "replay_file.h"

#include "files.h"
#include "names.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A page looks for the end of the header in so many bytes.
#define MOST_HEADER 8192

size_t ck_replay_body_bytes(const ck_Replay *replay) {
    return ((size_t)replay->spring_count + (size_t)replay->triangle_count) * 3 * sizeof(float);
}

size_t ck_replay_path_numbers(const ck_Replay *replay) {
    return (size_t)replay->frame_count * (size_t)replay->particle_count * 3;
}

char *ck_replay_name(const char *scene) {
    char *name;
    return asprintf(&name, "%s.replay", scene) < 0 ? NULL : name;
}

// Reads "KEY NUMBER" from least to most, and steps over the line. False where it is none.
static bool read_count(const char **line, const char *key, long least, long most, int *count) {
    size_t length = strlen(key);
    char *end;
    if (strncmp(*line, key, length) || (*line)[length] != ' ' || !isdigit((unsigned char)(*line)[length + 1]))
        return false;
    errno = 0;
    long number = strtol(*line + length + 1, &end, 10);
    if (*end != '\n' || errno || number < least || number > most) return false;
    *count = (int)number;
    *line = end + 1;
    return true;
}

static bool read_text(const char **line, const char *text) {
    size_t length = strlen(text);
    if (strncmp(*line, text, length)) return false;
    *line += length;
    return true;
}

// "path NAME", where NAME is plain and none that came before.
static bool read_path(const char **line, const char *first) {
    char whole[80];
    size_t length = strcspn(*line, "\n");
    if (length < 6 || length > 60) return false;
    snprintf(whole, sizeof whole, "\n%.*s\n", (int)length, *line);
    const char *name = whole + strlen("\npath ");
    bool is_plain = name[strspn(name, CK_PLAIN_LETTERS)] == '\n';
    bool is_new = strstr(first, whole) == *line - 1;
    *line += length + 1;
    return !strncmp(whole, "\npath ", strlen("\npath ")) && is_plain && is_new;
}

// A collider's shape and its numbers; "moves", of the one before, and times and places; or "body", a rigid one, its
// radius and half its core.
static bool read_collider(const char **line) {
    static const struct {
        const char *word;
        int numbers;
    } shapes[] = {{"plane ", 6}, {"sphere ", 4}, {"capsule ", 16}, {"cylinder ", 16}, {"box ", 16}, {"body ", 4}};
    int numbers = 0;
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++)
        if (!strncmp(*line, shapes[i].word, strlen(shapes[i].word))) numbers = shapes[i].numbers;
    if (!strncmp(*line, "moves ", 6))
        for (const char *letter = *line; *letter && *letter != '\n'; letter++) numbers += *letter == ' ';
    const char *at = strchr(*line, ' ');
    for (int i = 0; i < numbers; i++) {
        char *end;
        double number = strtod(at, &end);
        if (*at != ' ' || end == at || !isfinite(number)) return false;
        at = end;
    }
    if (!numbers || *at != '\n') return false;
    *line = at + 1;
    return true;
}

static bool read_header(ck_Replay *replay, const char *scene) {
    const int most = 1 << 23;
    const char *line = replay->bytes;
    int columns = 0;
    if (!read_text(&line, "clothcheck replay 1\nscene ") || !read_text(&line, scene) || !read_text(&line, "\n"))
        return false;
    if (!read_count(&line, "columns", 0, most, &columns) ||
        !read_count(&line, "particles", 1, most, &replay->particle_count) ||
        !read_count(&line, "springs", 0, most, &replay->spring_count) ||
        !read_count(&line, "triangles", 0, most, &replay->triangle_count) ||
        !read_count(&line, "frames", 1, most, &replay->frame_count) ||
        !read_count(&line, "paths", 0, CK_REPLAY_MAX_PATHS, &replay->path_count))
        return false;
    for (int i = 0; i < replay->path_count; i++)
        if (!read_path(&line, replay->bytes)) return false;
    replay->about = read_text(&line, "about ") ? line : "";
    if (*replay->about && !(line = strchr(line, '\n'))) return false;
    replay->about_length = *replay->about ? (size_t)(line - replay->about) : 0;
    line += *line == '\n';
    int bodies = 0;
    while (!read_text(&line, "data\n")) {
        bodies += !strncmp(line, "body ", 5);
        if (!read_collider(&line)) return false;
    }
    // each is three of the particles, behind the cloth's
    const int cloth = replay->particle_count - 3 * bodies;
    if (cloth < 1 || (columns && cloth % columns)) return false;
    replay->header_size = (size_t)(line - replay->bytes);
    return replay->header_size <= MOST_HEADER;
}

static bool are_particles(const ck_Replay *replay, const char *at, int count) {
    for (int i = 0; i < count; i++, at += sizeof(int32_t)) {
        int32_t particle;
        memcpy(&particle, at, sizeof particle);
        if (particle < 0 || particle >= replay->particle_count) return false;
    }
    return true;
}

// True where the file has the size that its header says, and springs and triangles are of its particles.
static bool is_sound(const ck_Replay *replay) {
    size_t numbers = (size_t)replay->frame_count + (size_t)replay->path_count * ck_replay_path_numbers(replay);
    if (replay->size != replay->header_size + numbers * sizeof(float) + ck_replay_body_bytes(replay)) return false;
    const char *at = replay->bytes + replay->header_size;
    for (int i = 0; i < replay->frame_count; i++, at += sizeof(float)) {
        float time;
        memcpy(&time, at, sizeof time);
        if (!isfinite(time)) return false;
    }
    const char *triangles = at + (size_t)replay->spring_count * 3 * sizeof(float);
    return are_particles(replay, at, 2 * replay->spring_count) &&
           are_particles(replay, triangles, 3 * replay->triangle_count);
}

ck_Status ck_replay_read(ck_Replay *replay, const char *directory, const char *scene, ck_Error *error) {
    *replay = (ck_Replay){0};
    char *name = ck_replay_name(scene), *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY);
    char *path = name && folder ? ck_path_join(folder, name) : NULL;
    ck_Status status = path ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_file_read(&replay->bytes, &replay->size, path, error);
    if (!status && !(read_header(replay, scene) && is_sound(replay)))
        status =
            ck_fail(error, CK_BAD_INPUT, "%s: is no whole replay of %s; 'clothcheck compare' writes it", path, scene);
    free(path);
    free(folder);
    free(name);
    return status;
}

void ck_replay_free(ck_Replay *replay) {
    free(replay->bytes);
    *replay = (ck_Replay){0};
}
