#include "replay.h"

#include "file.h"
#include "path.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_FRAMES 61
#define MOST_BYTES ((size_t)4 << 20)
// A page looks for the end of the header in so many bytes.
#define MOST_HEADER 8192

// The frames that are kept: every stride-th, and the last.
static int find_stride(const ck_Model *model, int paths) {
    size_t frame_bytes = (size_t)paths * (size_t)model->particle_count * 3 * sizeof(float);
    size_t most = MOST_BYTES / frame_bytes;
    if (most > MOST_FRAMES) most = MOST_FRAMES;
    if (most < 2) most = 2;
    return (model->frame_count + (int)most - 2) / ((int)most - 1);
}

static int kept_frame(const ck_Model *model, int stride, int index) {
    int frame = index * stride;
    return frame < model->frame_count ? frame : model->frame_count;
}

static bool is_drawn(const ck_Spring *spring) {
    return spring->kind == CK_STRUCTURAL;
}

static int write_header(FILE *file, const ck_Comparison *comparison, int frames) {
    const ck_Model *model = &comparison->model;
    bool has_truth = comparison->truth.path_count > 0;
    int springs = 0, paths = has_truth;
    for (int i = 0; i < model->spring_count; i++) springs += is_drawn(&model->springs[i]);
    for (int i = 0; i < comparison->run_count; i++) paths += comparison->runs[i].trajectory.frame_count > 0;
    fprintf(file, "clothcheck replay 1\nscene %s\ncolumns %d\nparticles %d\nsprings %d\nframes %d\npaths %d\n",
            model->name, model->columns, model->particle_count, springs, frames, paths);
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].trajectory.frame_count > 0)
            fprintf(file, "path %s\n", comparison->runs[i].engine->name);
    if (has_truth) fprintf(file, "path truth\n");
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider *collider = &model->colliders[i];
        const double *point = collider->point, *normal = collider->normal;
        if (collider->shape == CK_SPHERE)
            fprintf(file, "sphere %g %g %g %g\n", point[0], point[1], point[2], collider->radius);
        else
            fprintf(file, "plane %g %g %g %g %g %g\n", point[0], point[1], point[2], normal[0], normal[1], normal[2]);
    }
    fprintf(file, "data\n");
    return paths;
}

static void write_float(FILE *file, double number) {
    float value = (float)number;
    fwrite(&value, sizeof value, 1, file);
}

static void write_springs(FILE *file, const ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++)
        if (is_drawn(&model->springs[i])) {
            const int32_t ends[2] = {model->springs[i].a, model->springs[i].b};
            fwrite(ends, sizeof ends, 1, file);
        }
    for (int i = 0; i < model->spring_count; i++)
        if (is_drawn(&model->springs[i])) write_float(file, model->springs[i].rest);
}

// A truth at rest has a single frame, which stands for all times.
static void write_path(FILE *file, const ck_Model *model, const ck_Trajectory *path, bool is_static, int stride,
                       int frames) {
    for (int i = 0; i < frames; i++) {
        int frame = is_static ? 0 : kept_frame(model, stride, i);
        for (int k = 0; k < 3 * model->particle_count; k++)
            write_float(file, frame < path->frame_count ? ck_trajectory_position(path, frame)[k] : NAN);
    }
}

static void write_all(FILE *file, const ck_Comparison *comparison) {
    const ck_Model *model = &comparison->model;
    int stride = find_stride(model, comparison->run_count + 1);
    int frames = (model->frame_count + stride - 1) / stride + 1;
    write_header(file, comparison, frames);
    for (int i = 0; i < frames; i++) write_float(file, kept_frame(model, stride, i) * model->step);
    write_springs(file, model);
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].trajectory.frame_count > 0)
            write_path(file, model, &comparison->runs[i].trajectory, false, stride, frames);
    if (comparison->truth.path_count)
        write_path(file, model, &comparison->truth.reference.trajectory, comparison->truth.reference.is_static, stride,
                   frames);
}

size_t ck_replay_spring_bytes(const ck_Replay *replay) {
    return (size_t)replay->spring_count * 3 * sizeof(float);
}

size_t ck_replay_path_numbers(const ck_Replay *replay) {
    return (size_t)replay->frame_count * (size_t)replay->particle_count * 3;
}

static char *name_of(const char *scene) {
    char *name;
    return asprintf(&name, "%s.replay", scene) < 0 ? NULL : name;
}

ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, ck_Error *error) {
    char *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY), *name = name_of(comparison->model.name);
    char *path = folder && name ? ck_path_join(folder, name) : NULL;
    char *part = path ? ck_path_part(folder, name) : NULL;
    ck_Status status = part ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    int failed = status ? 0 : ck_path_make(folder);
    FILE *file = status || failed ? NULL : fopen(part, "wb");
    if (!status && !file) status = ck_fail(error, CK_IO, "%s: %s", part, strerror(failed ? failed : errno));
    if (file) {
        write_all(file, comparison);
        bool is_whole = !fflush(file) && !ferror(file);
        is_whole &= !fclose(file);
        if (!is_whole || rename(part, path)) {
            status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
            unlink(part);
        }
    }
    free(part);
    free(path);
    free(name);
    free(folder);
    return status;
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

// "path NAME", where NAME is an engine or the truth and none that came before.
static bool read_path(const char **line, const char *first) {
    char whole[80];
    size_t length = strcspn(*line, "\n");
    if (length < 6 || length > 60) return false;
    snprintf(whole, sizeof whole, "\n%.*s\n", (int)length, *line);
    const char *name = whole + strlen("\npath ");
    char plain[80];
    snprintf(plain, sizeof plain, "%.*s", (int)strcspn(name, "\n"), name);
    bool is_known = !strcmp(plain, "truth") || ck_engine_find(plain);
    bool is_new = strstr(first, whole) == *line - 1;
    *line += length + 1;
    return !strncmp(whole, "\npath ", strlen("\npath ")) && is_known && is_new;
}

// "plane" or "sphere" and its numbers.
static bool read_collider(const char **line) {
    int numbers = !strncmp(*line, "plane ", 6) ? 6 : !strncmp(*line, "sphere ", 7) ? 4 : 0;
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
        !read_count(&line, "frames", 1, most, &replay->frame_count) ||
        !read_count(&line, "paths", 0, CK_SCENE_MAX_ENGINES + 1, &replay->path_count))
        return false;
    if (columns && replay->particle_count % columns) return false;
    for (int i = 0; i < replay->path_count; i++)
        if (!read_path(&line, replay->bytes)) return false;
    while (!read_text(&line, "data\n"))
        if (!read_collider(&line)) return false;
    replay->header_size = (size_t)(line - replay->bytes);
    return replay->header_size <= MOST_HEADER;
}

// True where the file has the size that its header says, and springs are between its particles.
static bool is_sound(const ck_Replay *replay) {
    size_t numbers = (size_t)replay->frame_count + (size_t)replay->path_count * ck_replay_path_numbers(replay);
    if (replay->size != replay->header_size + numbers * sizeof(float) + ck_replay_spring_bytes(replay)) return false;
    const char *at = replay->bytes + replay->header_size;
    for (int i = 0; i < replay->frame_count; i++, at += sizeof(float)) {
        float time;
        memcpy(&time, at, sizeof time);
        if (!isfinite(time)) return false;
    }
    for (int i = 0; i < 2 * replay->spring_count; i++, at += sizeof(int32_t)) {
        int32_t end;
        memcpy(&end, at, sizeof end);
        if (end < 0 || end >= replay->particle_count) return false;
    }
    return true;
}

ck_Status ck_replay_read(ck_Replay *replay, const char *directory, const char *scene, ck_Error *error) {
    *replay = (ck_Replay){0};
    char *name = name_of(scene), *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY);
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
