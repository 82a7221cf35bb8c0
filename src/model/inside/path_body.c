// The paths of a scene, and the pins that move along them.
#include "body.h"

#include "path.h"
#include "path_file.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Twenty steps a period, and no more steps a frame than there may be.
#define MOST_PERIODS 5000

static ck_Status set_points(ck_Path *path, const ck_ScenePath *from, const ck_Scene *scene, const char *at,
                            ck_Error *error) {
    const size_t bytes = from->points_count * sizeof *path->points;
    char place[80];
    path->kind = CK_PATH_POINTS;
    snprintf(place, sizeof place, "%s.%s", at, from->file ? "file" : "points");
    if (from->file) {
        char *file = ck_body_file(scene, from->file);
        ck_Error why = {0};
        ck_Status status = file ? ck_path_file_read(&path->points, &path->point_count, file, &why) : CK_NO_MEMORY;
        free(file);
        if (status) return status == CK_NO_MEMORY ? status : ck_scene_fail(scene, place, error, "%s", why.message);
    } else {
        path->points = malloc(bytes);
        if (!path->points) return CK_NO_MEMORY;
        memcpy(path->points, from->points, bytes);
        path->point_count = (int)from->points_count;
    }
    for (int i = 1; i < path->point_count; i++)
        if (!(path->points[i][0] > path->points[i - 1][0]))
            return ck_scene_fail(scene, place, error, "point %d is at %g s, no later than the one before it", i,
                                 path->points[i][0]);
    if (path->points[0][0] < 0)
        return ck_scene_fail(scene, place, error, "the first point is at %g s; begin at 0 or later",
                             path->points[0][0]);
    path->from = path->points[0][0];
    path->to = path->points[path->point_count - 1][0];
    return CK_OK;
}

// What moves in no frame, or too fast for any step, is an error: nothing is left out in silence.
static ck_Status check_times(const ck_Model *model, const ck_Path *path, const ck_Scene *scene, const char *at,
                             ck_Error *error) {
    if (!(path->from < path->to))
        return ck_scene_fail(scene, at, error, "it moves from %g s to %g s; let it end after it begins", path->from,
                             path->to);
    if (path->from >= model->duration)
        return ck_scene_fail(scene, at, error, "it moves from %g s on, but the scene ends at %g s", path->from,
                             model->duration);
    if (path->frequency * model->step > MOST_PERIODS)
        return ck_scene_fail(scene, at, error, "%g periods a frame are more than any step follows; at most %d",
                             path->frequency * model->step, MOST_PERIODS);
    return CK_OK;
}

//   at  where in the scene, as moves[0].path
static ck_Status set_path(ck_Model *model, const ck_ScenePath *from, const ck_Scene *scene, const char *at,
                          ck_Error *error) {
    ck_Path *path = &model->paths[model->path_count++];
    const bool has_points = from->points_count || from->file;
    *path = (ck_Path){.from = from->from, .to = from->to > 0 ? from->to : INFINITY, .slack = 1e-9 * model->step};
    const int ways = !!from->velocity + !!from->towards + !!from->amplitude + !!from->points_count + !!from->file;
    if (ways != 1)
        return ck_scene_fail(scene, at, error,
                             "a path has one of velocity, towards, amplitude, points and file; this has %s",
                             ways ? "more" : "none");
    if ((from->frequency > 0) != (from->amplitude != NULL))
        return ck_scene_fail(scene, at, error,
                             "amplitude and frequency go together: it moves by amplitude*sin(2*pi*f*t)");
    if (has_points && (from->from > 0 || from->to > 0))
        return ck_scene_fail(scene, at, error, "points have times of their own; leave from and to out");
    if (from->towards && (!(from->to > 0) || !strncmp(at, "colliders", 9)))
        return ck_scene_fail(scene, at, error, "towards is for pins, and needs to: the time when they are there");
    ck_Status status = has_points ? set_points(path, from, scene, at, error) : CK_OK;
    path->frequency = from->frequency;
    if (!status) status = check_times(model, path, scene, at, error);
    if (status || has_points) return status;
    path->kind = from->amplitude ? CK_PATH_SINE : CK_PATH_VELOCITY;
    path->has_goal = from->towards != NULL;
    if (path->has_goal)
        memcpy(path->goal, from->towards, sizeof path->goal);
    else
        memcpy(path->vector, from->velocity ? from->velocity : from->amplitude, sizeof path->vector);
    return CK_OK;
}

// Of each particle, so that wide edges are not searched for each of their pins. Arrays [n].
typedef struct Pins {
    int *chosen;
    bool *moves;
    double *until; // s: when it is let go; INFINITY: never
} Pins;

static ck_Status create_pins(Pins *pins, const ck_Model *model) {
    const size_t count = (size_t)model->particle_count;
    *pins = (Pins){malloc(count * sizeof *pins->chosen), calloc(count, sizeof *pins->moves),
                   malloc(count * sizeof *pins->until)};
    if (!pins->chosen || !pins->moves || !pins->until) return CK_NO_MEMORY;
    for (size_t i = 0; i < count; i++) pins->until[i] = INFINITY;
    for (int i = 0; i < model->release_count; i++)
        for (int k = 0; k < model->releases[i].particle_count; k++)
            pins->until[model->releases[i].particles[k]] = model->releases[i].frame * model->step;
    return CK_OK;
}

static void free_pins(Pins *pins) {
    free(pins->chosen);
    free(pins->moves);
    free(pins->until);
}

//   move  the number of the path
static ck_Status add_driven(ck_Model *model, Pins *pins, int move, int particle, const char *pin, const ck_Scene *scene,
                            const char *place, ck_Error *error) {
    if (!model->pinned[particle])
        return ck_scene_fail(scene, place, error, "%s is not pinned, so that it cannot be moved; add it to pins", pin);
    if (pins->moves[particle]) return ck_scene_fail(scene, place, error, "%s already moves; name it once", pin);
    pins->moves[particle] = true;
    const double until = pins->until[particle], from = model->paths[move].from;
    if (from >= until)
        return ck_scene_fail(scene, place, error, "%s is let go at %g s, before its path begins at %g s", pin, until,
                             from);
    ck_Driven *driven = &model->driven[model->driven_count++];
    *driven = (ck_Driven){.particle = particle, .path = &model->paths[move], .until = until};
    memcpy(driven->start, model->position + 3 * particle, sizeof driven->start);
    if (!model->paths[move].has_goal) return CK_OK;
    // each has a way of its own
    ck_Path *own = &model->paths[model->path_count++];
    *own = model->paths[move];
    ck_path_aim(own, driven->start);
    driven->path = own;
    return CK_OK;
}

static ck_Status set_move(ck_Model *model, const ck_Scene *scene, uint32_t index, Pins *pins, ck_Error *error) {
    const ck_SceneMove *from = &scene->file->moves[index];
    char place[64];
    snprintf(place, sizeof place, "moves[%u].path", index);
    const int move = model->path_count;
    ck_Status status = set_path(model, &from->path, scene, place, error);
    for (uint32_t i = 0; i < from->pins_count && !status; i++) {
        int count = 0;
        snprintf(place, sizeof place, "moves[%u].pins[%u]", index, i);
        status = ck_model_resolve_pin(pins->chosen, &count, model, scene, from->pins[i], place, error);
        for (int j = 0; j < count && !status; j++)
            status = add_driven(model, pins, move, pins->chosen[j], from->pins[i], scene, place, error);
    }
    return status;
}

ck_Status ck_model_set_paths(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneFile *file = scene->file;
    Pins pins;
    ck_Status status = create_pins(&pins, model);
    // driven pins point to paths, which therefore never move
    model->paths =
        calloc((size_t)file->moves_count + file->colliders_count + (size_t)model->pin_count + 1, sizeof *model->paths);
    model->driven = calloc((size_t)model->pin_count + 1, sizeof *model->driven);
    if (!model->paths || !model->driven) status = CK_NO_MEMORY;
    for (uint32_t i = 0; i < file->moves_count && !status; i++) status = set_move(model, scene, i, &pins, error);
    for (uint32_t i = 0; i < file->colliders_count && !status; i++) {
        char place[48];
        if (!file->colliders[i].path) continue;
        snprintf(place, sizeof place, "colliders[%u].path", i);
        status = set_path(model, file->colliders[i].path, scene, place, error);
        model->colliders[i].path = &model->paths[model->path_count - 1];
    }
    free_pins(&pins);
    return status;
}
