#include "replay.h"

#include "csv_table.h"
#include "path.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_FRAMES 61
#define MOST_BYTES ((size_t)4 << 20)
#define CODE_BITS 24
#define CODE_MASK ((1u << CODE_BITS) - 1)
#define NO_POSITION (1u << 21)

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

static size_t spring_bytes(const ck_Replay *replay) {
    return (size_t)replay->spring_count * 3 * sizeof(float);
}

static size_t path_codes(const ck_Replay *replay) {
    return (size_t)replay->frame_count * (size_t)replay->particle_count * 3;
}

// Takes the counts from the header. False where it is none, or the file has not the size that they say.
static bool read_header(ck_Replay *replay, const char *scene) {
    char name[128] = "";
    int columns, used = 0;
    sscanf(replay->bytes,
           "clothcheck replay 1\nscene %127s\ncolumns %d\nparticles %d\nsprings %d\nframes %d\npaths %d%n", name,
           &columns, &replay->particle_count, &replay->spring_count, &replay->frame_count, &replay->path_count, &used);
    const char *end = used ? strstr(replay->bytes, "\ndata\n") : NULL;
    if (!end || strcmp(name, scene)) return false;
    // more than any comparison writes would overflow what follows
    const int most = 1 << 23;
    if (replay->particle_count < 1 || replay->spring_count < 0 || replay->frame_count < 1 || replay->path_count < 0 ||
        replay->particle_count > most || replay->spring_count > most || replay->frame_count > most ||
        replay->path_count > CK_SCENE_MAX_ENGINES + 1)
        return false;
    replay->header_size = (size_t)(end - replay->bytes) + strlen("\ndata\n");
    size_t numbers = (size_t)replay->frame_count + (size_t)replay->path_count * path_codes(replay);
    return replay->size == replay->header_size + numbers * sizeof(float) + spring_bytes(replay);
}

ck_Status ck_replay_read(ck_Replay *replay, const char *directory, const char *scene, ck_Error *error) {
    *replay = (ck_Replay){0};
    char *name = name_of(scene), *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY);
    char *path = name && folder ? ck_path_join(folder, name) : NULL;
    ck_Status status = path ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_file_read(&replay->bytes, &replay->size, path, error);
    if (!status && !read_header(replay, scene))
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

// [paths][frames][3*n], at any alignment.
static float position_at(const ck_Replay *replay, size_t index) {
    float value;
    const char *positions =
        replay->bytes + replay->header_size + sizeof(float) * (size_t)replay->frame_count + spring_bytes(replay);
    memcpy(&value, positions + sizeof value * index, sizeof value);
    return value;
}

// What the first path that is there all the time fills, and half as much again on either side: what flies off leaves.
static void find_box(const ck_Replay *replay, float box[2][3]) {
    size_t codes = path_codes(replay), first = 0;
    for (int path = replay->path_count - 1; path >= 0; path--) {
        bool is_whole = true;
        for (size_t i = 0; i < codes && is_whole; i++) is_whole = fabsf(position_at(replay, path * codes + i)) < 1e6f;
        if (is_whole) first = (size_t)path * codes;
    }
    float least[3] = {INFINITY, INFINITY, INFINITY}, largest[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < codes; i++) {
        float at = position_at(replay, first + i);
        if (!isfinite(at)) continue;
        least[i % 3] = fminf(least[i % 3], at);
        largest[i % 3] = fmaxf(largest[i % 3], at);
    }
    float width = 0;
    for (int k = 0; k < 3; k++) width = fmaxf(width, largest[k] - least[k]);
    if (!(width > 0)) width = 1;
    for (int k = 0; k < 3; k++) {
        box[0][k] = isfinite(least[k]) ? least[k] - width / 2 : -width;
        box[1][k] = isfinite(largest[k]) ? largest[k] + width / 2 : width;
    }
}

static uint32_t code_of(float at, const float box[2][3], size_t axis) {
    float share = (at - box[0][axis]) / (box[1][axis] - box[0][axis]);
    // also false where it is no number
    return share >= 0 && share <= 1 ? (uint32_t)lrintf(share * (float)(NO_POSITION - 1)) : NO_POSITION;
}

static uint32_t zigzag(uint32_t difference) {
    bool is_negative = difference >> (CODE_BITS - 1) & 1;
    return (difference << 1 ^ (is_negative ? CODE_MASK : 0)) & CODE_MASK;
}

// The change of a path's code since the frame before, less the first path's where it is led by it.
static uint32_t change_at(const uint32_t *codes, const uint32_t *first, size_t index, size_t width) {
    uint32_t change = codes[index] - (index < width ? 0 : codes[index - width]);
    if (first) change -= first[index] - (index < width ? 0 : first[index - width]);
    return zigzag(change & CODE_MASK);
}

// Writes a path's codes in whichever way has smaller numbers. Returns what follows.
static char *pack_path(char *out, const uint32_t *codes, const uint32_t *first, size_t count, size_t width) {
    double alone = 0, led = 0;
    for (size_t i = 0; i < count; i++) {
        alone += change_at(codes, NULL, i, width);
        led += change_at(codes, first, i, width);
    }
    const uint32_t *leader = codes != first && led < alone ? first : NULL;
    *out++ = leader != NULL;
    for (size_t i = 0; i < count; i++) {
        uint32_t change = change_at(codes, leader, i, width);
        for (size_t byte = 0; byte < CODE_BITS / 8; byte++) out[byte * count + i] = (char)(change >> 8 * byte & 0xff);
    }
    return out + CODE_BITS / 8 * count;
}

ck_Status ck_replay_pack(char **packed, size_t *size, const ck_Replay *replay, ck_Error *error) {
    size_t before = replay->header_size + sizeof(float) * (size_t)replay->frame_count + spring_bytes(replay);
    size_t count = path_codes(replay), width = 3 * (size_t)replay->particle_count;
    size_t paths = (size_t)replay->path_count;
    float box[2][3];
    *size = before + sizeof box + paths * (1 + CODE_BITS / 8 * count);
    *packed = malloc(*size);
    uint32_t *codes = malloc((paths * count + 1) * sizeof *codes);
    if (!*packed || !codes) {
        free(codes);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    find_box(replay, box);
    for (size_t i = 0; i < paths * count; i++) codes[i] = code_of(position_at(replay, i), box, i % 3);
    memcpy(*packed, replay->bytes, before);
    memcpy(*packed + before, box, sizeof box);
    char *out = *packed + before + sizeof box;
    for (size_t i = 0; i < paths; i++) out = pack_path(out, codes + i * count, codes, count, width);
    assert(out == *packed + *size);
    free(codes);
    return CK_OK;
}
