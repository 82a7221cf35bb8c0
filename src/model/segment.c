#include "segment.h"

#include "body.h"
#include "change.h"
#include "path.h"
#include "scene.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void ck_segment_free(ck_Segment *segment) {
    free(segment->words);
    ck_model_free(&segment->model);
    *segment = (ck_Segment){0};
}

ck_Status ck_segment_build(ck_Segment *segment, const ck_Model *base, const char *file, const char *words, int frame,
                           ck_Error *error) {
    ck_Scene scene = {0};
    char *path;
    *segment = (ck_Segment){.frame = frame, .words = strdup(words)};
    if (!segment->words || asprintf(&path, "%s%s", file, words) < 0)
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", base->name);
    ck_Status status = ck_scene_load(&scene, path, error);
    if (!status) status = ck_model_build_part(&segment->model, &scene, error);
    const ck_Model *model = &segment->model;
    if (!status && (model->particle_count != base->particle_count || model->rigid_count != base->rigid_count ||
                    model->step != base->step))
        status = ck_fail(error, CK_BAD_INPUT, "%s: a change keeps particles, bodies and frames as they are", path);
    ck_scene_free(&scene);
    free(path);
    return status;
}

const ck_Segment *ck_model_segment_at(const ck_Model *model, int frame) {
    for (int i = 0; i < model->segment_count; i++)
        if (model->segments[i].frame == frame) return &model->segments[i];
    return NULL;
}

static ck_Status add_segment(ck_Model *model, const ck_Scene *scene, uint32_t index, char **words, ck_Error *error) {
    const ck_SceneChange *change = &scene->file->changes[index];
    char place[32];
    snprintf(place, sizeof place, "changes[%u]", index);
    const double frames = change->at / model->step;
    ck_Error why = {0};
    if (!(fabs(frames - round(frames)) < 1e-6 * fmax(1, frames)) || frames >= model->frame_count)
        return ck_scene_fail(scene, place, error,
                             "at is %g s; it must be a whole number of frames of %g s, before the end", change->at,
                             model->step);
    if (model->segment_count && (int)round(frames) <= model->segments[model->segment_count - 1].frame)
        return ck_scene_fail(scene, place, error, "at is %g s, no later than the change before", change->at);
    char *more = NULL;
    if (asprintf(&more, "%s%s", *change->set == '@' ? "" : "@", change->set) < 0) return CK_NO_MEMORY;
    const bool is_merged = ck_change_merge(words, more);
    free(more);
    if (!is_merged) return CK_NO_MEMORY;
    ck_Segment *segment = &model->segments[model->segment_count++];
    ck_Status status = ck_segment_build(segment, model, scene->document.path, *words, (int)round(frames), &why);
    if (status == CK_BAD_INPUT) return ck_scene_fail(scene, place, error, "%s", why.message);
    return status;
}

ck_Status ck_model_build_segments(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const uint32_t count = scene->file->changes_count;
    if (!count) return CK_OK;
    char *words = strdup("");
    model->segments = calloc(count, sizeof *model->segments);
    ck_Status status = words && model->segments ? CK_OK : CK_NO_MEMORY;
    for (uint32_t i = 0; i < count && !status; i++) {
        status = add_segment(model, scene, i, &words, error);
        if (status) break;
        const ck_Model *part = &model->segments[i].model;
        model->terms |= part->terms | CK_TERM_CHANGES;
        // a pin that a change takes away is free at some time
        for (int k = 0; k < model->particle_count; k++)
            model->released[k] |= model->pinned[k] && (!part->pinned[k] || part->released[k]);
    }
    free(words);
    return status;
}

static void *copy_of(const void *from, size_t count, size_t size) {
    void *copy = malloc(count * size + 1);
    if (copy && count) memcpy(copy, from, count * size);
    return copy;
}

// Paths by a clock that begins later, and what goes along them from there.
static bool shift_paths(ck_Model *resumed, const ck_Model *from, double time) {
    bool has_all = resumed->paths && resumed->driven && resumed->colliders;
    for (int i = 0; i < resumed->path_count && has_all; i++) {
        ck_Path *path = &resumed->paths[i];
        path->points = copy_of(path->points, (size_t)path->point_count, sizeof *path->points);
        has_all = path->points != NULL;
        for (int k = 0; k < path->point_count && has_all; k++) path->points[k][0] -= time;
        path->from -= time;
        path->to -= time;
    }
    for (int i = 0; i < resumed->collider_count && has_all; i++)
        if (from->colliders[i].path)
            resumed->colliders[i].path = resumed->paths + (from->colliders[i].path - from->paths);
    for (int i = 0; i < resumed->driven_count && has_all; i++) {
        ck_Driven *driven = &resumed->driven[i];
        double moved[3], velocity[3], gain[3];
        driven->path = resumed->paths + (from->driven[i].path - from->paths);
        driven->until -= time;
        if (driven->path->has_goal)
            ck_path_aim(resumed->paths + (driven->path - resumed->paths), resumed->position + 3 * driven->particle);
        // from where it is, as far as it would have come
        ck_path_at(driven->path, 0, 1, moved, velocity, gain);
        memcpy(driven->start, resumed->position + 3 * driven->particle, sizeof driven->start);
        ck_add_scaled(driven->start, -1, moved);
    }
    return has_all;
}

// Releases that are due later; what was due before is let go.
static bool shift_releases(ck_Model *resumed, const ck_Model *from, int frame) {
    resumed->releases = copy_of(from->releases, (size_t)from->release_count, sizeof *from->releases);
    resumed->release_count = 0;
    for (int i = 0; i < from->release_count && resumed->releases; i++) {
        const ck_Release *release = &from->releases[i];
        if (release->frame >= frame) {
            ck_Release later = *release;
            later.frame -= frame;
            later.at -= frame * from->step;
            resumed->releases[resumed->release_count++] = later;
            continue;
        }
        for (int k = 0; k < release->particle_count; k++) resumed->pinned[release->particles[k]] = false;
    }
    return resumed->releases != NULL;
}

ck_Status ck_model_resume(ck_Model *resumed, const ck_Segment *segment, const double *position, const double *velocity,
                          const ck_Turn *turn) {
    const ck_Model *from = &segment->model;
    const size_t count = (size_t)from->particle_count;
    *resumed = *from;
    resumed->position = copy_of(position, 3 * count, sizeof *position);
    resumed->velocity = copy_of(velocity, 3 * count, sizeof *velocity);
    resumed->pinned = copy_of(from->pinned, count, sizeof *from->pinned);
    resumed->paths = copy_of(from->paths, (size_t)from->path_count, sizeof *from->paths);
    for (int i = 0; i < from->path_count && resumed->paths; i++) resumed->paths[i].points = from->paths[i].points;
    resumed->driven = copy_of(from->driven, (size_t)from->driven_count, sizeof *from->driven);
    resumed->colliders = copy_of(from->colliders, (size_t)from->collider_count, sizeof *from->colliders);
    resumed->rigid = copy_of(from->rigid, (size_t)from->rigid_count, sizeof *from->rigid);
    const bool has_memory = resumed->position && resumed->velocity && resumed->pinned && resumed->rigid;
    const bool has_releases = has_memory && shift_releases(resumed, from, segment->frame);
    if (!has_releases || !shift_paths(resumed, from, segment->frame * from->step)) {
        ck_model_end_resumed(resumed);
        return CK_NO_MEMORY;
    }
    resumed->pin_count = 0;
    for (size_t i = 0; i < count; i++) {
        resumed->pin_count += resumed->pinned[i];
        for (int axis = 0; axis < 3 && resumed->pinned[i]; axis++) resumed->velocity[3 * i + (size_t)axis] = 0;
    }
    for (int i = 0; i < resumed->rigid_count; i++) {
        ck_RigidBody *rigid = &resumed->rigid[i];
        rigid->shape = ck_rigid_place(rigid, resumed->position + 3 * rigid->particle, turn[i].rotation);
        memcpy(rigid->spin, turn[i].spin, sizeof rigid->spin);
    }
    for (size_t i = 0; i < 3 * count; i++)
        if (resumed->velocity[i] != 0) resumed->terms |= CK_TERM_VELOCITY;
    return CK_OK;
}

void ck_model_end_resumed(ck_Model *resumed) {
    for (int i = 0; i < resumed->path_count && resumed->paths; i++) free(resumed->paths[i].points);
    free(resumed->paths);
    free(resumed->driven);
    free(resumed->colliders);
    free(resumed->releases);
    free(resumed->rigid);
    free(resumed->position);
    free(resumed->velocity);
    free(resumed->pinned);
    *resumed = (ck_Model){0};
}
