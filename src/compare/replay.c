#include "tables.h"

#include "files.h"
#include "path.h"
#include "rigid.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_BYTES_A_FRAME (((size_t)4 << 20) / CK_REPLAY_FRAMES)

// A rigid body is its centre and, behind all particles, the tips of its first two axes, which tell how it is turned.
static int drawn_particles(const ck_Model *model) {
    return model->particle_count + 2 * model->rigid_count;
}

// The frames that are kept: every stride-th, and the last.
static int find_stride(const ck_Model *model, int paths, int most_frames) {
    size_t frame_bytes = (size_t)paths * (size_t)drawn_particles(model) * 3 * sizeof(float);
    size_t most = (size_t)most_frames * MOST_BYTES_A_FRAME / frame_bytes;
    if (most > (size_t)most_frames) most = (size_t)most_frames;
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

// Room in the header for the motion of colliders, letters, and what a place of it takes.
#define MOST_MOTION 4500
#define PLACE_LETTERS 50

#define MOST_ABOUT ((size_t)500) // bytes

// How far a collider has come at even times, which are joined by straight lines.
// A solid's radius, and of what is no ball its axes and half its core along them; of a cylinder so much as is seen.
static void write_solid(FILE *file, const ck_Model *model, const ck_Collider *collider) {
    fprintf(file, " %g", collider->radius);
    for (int k = 0; k < 9 && collider->shape != CK_SPHERE; k++) fprintf(file, " %g", collider->axes[k / 3][k % 3]);
    for (int k = 0; k < 3 && collider->shape != CK_SPHERE; k++)
        fprintf(file, " %g", fmin(collider->half[k], model->size));
    fprintf(file, "\n");
}

static void write_motion(FILE *file, const ck_Model *model, const ck_Path *path) {
    const int places = (int)fmin(32, MOST_MOTION / PLACE_LETTERS / model->path_count);
    if (places < 2) return;
    fprintf(file, "moves");
    for (int i = 0; i < places; i++) {
        const double time = model->duration * i / (places - 1);
        double moved[3], v[3], a[3];
        ck_path_at(path, time, -1, moved, v, a);
        fprintf(file, " %.5g %.5g %.5g %.5g", time, moved[0], moved[1], moved[2]);
    }
    fprintf(file, "\n");
}

// A sentence on one line, cut between letters where it is long.
static void write_about(FILE *file, const char *about) {
    size_t length = strlen(about);
    if (length > MOST_ABOUT) length = MOST_ABOUT;
    while (about[length] && ((unsigned char)about[length] & 0xc0) == 0x80) length--;
    fprintf(file, "about ");
    for (size_t i = 0; i < length; i++) fputc((unsigned char)about[i] < ' ' ? ' ' : about[i], file);
    fputc('\n', file);
}

// stay, names: paths of an older replay, which come first; a name ends with its line.
static void write_header(FILE *file, const ck_Comparison *comparison, int frames, int stay, const char *const *names) {
    const ck_Model *model = &comparison->model;
    bool has_truth = comparison->truth.path_count > 0;
    int springs = 0, paths = has_truth + stay;
    for (int i = 0; i < model->spring_count; i++) springs += is_drawn(&model->springs[i]);
    for (int i = 0; i < comparison->run_count; i++) paths += comparison->runs[i].trajectory.frame_count > 0;
    fprintf(file,
            "clothcheck replay 1\nscene %s\ncolumns %d\nparticles %d\nsprings %d\ntriangles %d\nframes %d\n"
            "paths %d\n",
            model->name, model->columns, drawn_particles(model), springs, model->triangle_count, frames, paths);
    for (int i = 0; i < stay; i++) fprintf(file, "path %.*s\n", (int)strcspn(names[i], "\n"), names[i]);
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].trajectory.frame_count > 0)
            fprintf(file, "path %s\n", comparison->runs[i].engine->name);
    if (has_truth) fprintf(file, "path truth\n");
    if (model->about) write_about(file, model->about);
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider *collider = &model->colliders[i];
        const double *point = collider->point, *normal = collider->normal;
        fprintf(file, "%s %g %g %g", ck_shape_names[collider->shape], point[0], point[1], point[2]);
        if (collider->shape == CK_PLANE)
            fprintf(file, " %g %g %g\n", normal[0], normal[1], normal[2]);
        else
            write_solid(file, model, collider);
        if (collider->path) write_motion(file, model, collider->path);
    }
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_Collider *shape = &model->rigid[i].shape;
        fprintf(file, "body %g %g %g %g\n", shape->radius, shape->half[0], shape->half[1], shape->half[2]);
    }
    fprintf(file, "data\n");
}

static void write_float(FILE *file, double number) {
    float value = (float)number;
    fwrite(&value, sizeof value, 1, file);
}

static void write_body(FILE *file, const ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++)
        if (is_drawn(&model->springs[i])) {
            const int32_t ends[2] = {model->springs[i].a, model->springs[i].b};
            fwrite(ends, sizeof ends, 1, file);
        }
    for (int i = 0; i < model->spring_count; i++)
        if (is_drawn(&model->springs[i])) write_float(file, model->springs[i].rest);
    for (int i = 0; i < 3 * model->triangle_count; i++) {
        const int32_t corner = model->triangles[i / 3][i % 3];
        fwrite(&corner, sizeof corner, 1, file);
    }
}

static void write_tips(FILE *file, const ck_Model *model, const ck_Trajectory *path, int frame) {
    const double none[4] = {1, 0, 0, 0};
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        if (frame >= path->frame_count) {
            for (int k = 0; k < 6; k++) write_float(file, NAN);
            continue;
        }
        const double *center = ck_trajectory_position(path, frame) + 3 * rigid->particle;
        const double *rotation = ck_trajectory_turn(path, frame)[i].rotation;
        // who does not tell how it turns has it unturned
        const ck_Collider now = ck_rigid_place(rigid, center, isnan(rotation[0]) ? none : rotation);
        for (int k = 0; k < 6; k++) write_float(file, center[k % 3] + model->spacing * now.axes[k / 3][k % 3]);
    }
}

// A truth at rest has a single frame, which stands for all times.
static void write_path(FILE *file, const ck_Model *model, const ck_Trajectory *path, bool is_static, int stride,
                       int frames) {
    for (int i = 0; i < frames; i++) {
        int frame = is_static ? 0 : kept_frame(model, stride, i);
        for (int k = 0; k < 3 * model->particle_count; k++)
            write_float(file, frame < path->frame_count ? ck_trajectory_position(path, frame)[k] : NAN);
        write_tips(file, model, path, frame);
    }
}

static void write_paths(FILE *file, const ck_Comparison *comparison, int stride, int frames) {
    const ck_Model *model = &comparison->model;
    const ck_Reference *truth = &comparison->truth.reference;
    for (int i = 0; i < comparison->run_count; i++)
        if (comparison->runs[i].trajectory.frame_count > 0)
            write_path(file, model, &comparison->runs[i].trajectory, false, stride, frames);
    if (comparison->truth.path_count) write_path(file, model, &truth->trajectory, truth->is_static, stride, frames);
}

static void write_all(FILE *file, const ck_Comparison *comparison, int most_frames) {
    const ck_Model *model = &comparison->model;
    int stride = find_stride(model, comparison->run_count + 1, most_frames);
    int frames = (model->frame_count + stride - 1) / stride + 1;
    write_header(file, comparison, frames, 0, NULL);
    for (int i = 0; i < frames; i++) write_float(file, kept_frame(model, stride, i) * model->step);
    write_body(file, model);
    write_paths(file, comparison, stride, frames);
}

// The paths of an older replay of the scene that stay, by their number; those run anew and the truth are replaced.
static int find_staying(const ck_Replay *old, const ck_Comparison *comparison, const char **names, int *numbers) {
    const char *line = strstr(old->bytes, "\npath ");
    int count = 0;
    for (int i = 0; i < old->path_count; i++, line = strchr(line + 1, '\n')) {
        const char *name = line + strlen("\npath ");
        size_t length = strcspn(name, "\n");
        bool stays = strncmp(name, "truth\n", 6) != 0 || !comparison->truth.path_count;
        for (int k = 0; k < comparison->run_count && stays; k++) {
            const char *again = comparison->runs[k].engine->name;
            stays = strlen(again) != length || strncmp(again, name, length) != 0;
        }
        names[count] = name;
        numbers[count] = i;
        count += stays;
    }
    return count;
}

// The paths of an older replay, and those of the comparison at its frames.
static void write_joined(FILE *file, const ck_Comparison *comparison, const ck_Replay *old) {
    const char *names[CK_REPLAY_MAX_PATHS];
    int numbers[CK_REPLAY_MAX_PATHS], stay = find_staying(old, comparison, names, numbers);
    size_t front = (size_t)old->frame_count * sizeof(float) + ck_replay_body_bytes(old);
    size_t path_bytes = ck_replay_path_numbers(old) * sizeof(float);
    const char *data = old->bytes + old->header_size;
    const ck_Model *model = &comparison->model;
    write_header(file, comparison, old->frame_count, stay, names);
    fwrite(data, 1, front, file);
    for (int i = 0; i < stay; i++) fwrite(data + front + (size_t)numbers[i] * path_bytes, 1, path_bytes, file);
    int stride = find_stride(model, 1, CK_REPLAY_FRAMES);
    // its frames are every stride-th, of whatever stride it was made with
    float second = 0;
    if (old->frame_count > 1) memcpy(&second, data + sizeof second, sizeof second);
    if (second > 0) stride = (int)fmax(1, round((double)second / model->step));
    write_paths(file, comparison, stride, old->frame_count);
}

ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, bool joins, int most_frames,
                          ck_Error *error) {
    ck_Replay old = {0};
    joins = joins && !ck_replay_read(&old, directory, comparison->model.name, NULL) &&
            old.particle_count == drawn_particles(&comparison->model) &&
            old.path_count + comparison->run_count <= CK_REPLAY_MAX_PATHS;
    char *folder = ck_path_join(directory, CK_REPLAY_DIRECTORY), *name = ck_replay_name(comparison->model.name);
    ck_WholeFile whole = {0};
    ck_Status status = folder && name ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_whole_file_open(&whole, folder, name, error);
    if (!status) {
        if (joins)
            write_joined(whole.file, comparison, &old);
        else
            write_all(whole.file, comparison, most_frames);
        status = ck_whole_file_close(&whole, error);
    }
    ck_whole_file_discard(&whole);
    ck_replay_free(&old);
    free(name);
    free(folder);
    return status;
}
