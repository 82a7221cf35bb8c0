#include "tables.h"

#include "files.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_FRAMES 61
#define MOST_BYTES ((size_t)4 << 20)

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

ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, ck_Error *error) {
    char *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY), *name = ck_replay_name(comparison->model.name);
    ck_WholeFile whole = {0};
    ck_Status status = folder && name ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_whole_file_open(&whole, folder, name, error);
    if (!status) {
        write_all(whole.file, comparison);
        status = ck_whole_file_close(&whole, error);
    }
    ck_whole_file_discard(&whole);
    free(name);
    free(folder);
    return status;
}
