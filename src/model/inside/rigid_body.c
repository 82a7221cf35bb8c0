// The rigid bodies of a scene, and the springs that they hang on.
#include "body.h"

#include "collider.h"
#include "rigid.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A solid sphere's, or a solid box's with sharp edges, whatever its rounding.
static void set_inertia(ck_RigidBody *rigid, double mass) {
    const ck_Collider *shape = &rigid->shape;
    for (int k = 0; k < 3; k++) {
        const double b = 2 * (shape->half[(k + 1) % 3] + shape->radius),
                     c = 2 * (shape->half[(k + 2) % 3] + shape->radius);
        rigid->inertia[k] =
            shape->shape == CK_SPHERE ? 0.4 * mass * shape->radius * shape->radius : mass * (b * b + c * c) / 12;
    }
}

// Its shape and motion; the nodes that it hangs on are found while the cloth is alone.
static ck_Status set_rigid(ck_Model *model, const ck_Scene *scene, uint32_t index, int *chosen, ck_Error *error) {
    const ck_SceneRigidBody *from = &scene->file->bodies[index];
    ck_RigidBody *rigid = &model->rigid[index];
    char at[48];
    snprintf(at, sizeof at, "bodies[%u].%s", index, from->box ? "box" : "sphere");
    ck_Status status = from->box ? ck_model_set_box(&rigid->shape, from->box, scene, at, error)
                                 : ck_model_set_sphere(&rigid->shape, from->sphere);
    if (status) return status;
    for (int k = 0; k < 3 && !from->box; k++) rigid->shape.axes[k][k] = 1;
    if (from->spin) memcpy(rigid->spin, from->spin, sizeof rigid->spin);
    set_inertia(rigid, from->mass);
    for (uint32_t i = 0; i < from->hang_count; i++) {
        char place[64];
        int count = 0;
        snprintf(place, sizeof place, "bodies[%u].hang[%u]", index, i);
        status = ck_model_resolve_pin(chosen, &count, model, scene, from->hang[i], place, error);
        if (status) return status;
        int *grown = realloc(rigid->hung, sizeof *grown * (size_t)(rigid->hung_count + count + 1));
        if (!grown) return CK_NO_MEMORY;
        rigid->hung = grown;
        memcpy(grown + rigid->hung_count, chosen, sizeof *grown * (size_t)count);
        rigid->hung_count += count;
    }
    return CK_OK;
}

// false without memory
static bool grow(void **array, size_t count, size_t more, size_t size) {
    char *grown = realloc(*array, (count + more + 1) * size);
    if (!grown) return false;
    memset(grown + count * size, 0, more * size);
    *array = grown;
    return true;
}

static ck_Status make_room(ck_Model *model, size_t springs) {
    const size_t count = (size_t)model->particle_count, more = (size_t)model->rigid_count;
    const bool has_room = grow((void **)&model->position, 3 * count, 3 * more, sizeof(double)) &&
                          grow((void **)&model->velocity, 3 * count, 3 * more, sizeof(double)) &&
                          grow((void **)&model->mass, count, more, sizeof(double)) &&
                          grow((void **)&model->pinned, count, more, sizeof(bool)) &&
                          grow((void **)&model->released, count, more, sizeof(bool)) &&
                          grow((void **)&model->springs, (size_t)model->spring_count, springs, sizeof(ck_Spring));
    return has_room ? CK_OK : CK_NO_MEMORY;
}

static ck_Status hang(ck_Model *model, const ck_Scene *scene, uint32_t index, ck_Error *error) {
    const ck_SceneSprings *springs = ck_body_springs(scene);
    const ck_RigidBody *rigid = &model->rigid[index];
    char place[48];
    snprintf(place, sizeof place, "bodies[%u].hang", index);
    if (rigid->hung_count && !(springs && (springs->rigid || springs->stiffness > 0)))
        return ck_scene_fail(scene, place, error,
                             "what hangs a body are springs: give springs.stiffness, or rigid: true");
    for (int i = 0; i < rigid->hung_count; i++) {
        const double length = ck_distance(model->position + 3 * rigid->hung[i], model->position + 3 * rigid->particle);
        if (!(length > 0))
            return ck_scene_fail(scene, place, error, "node %d is at the body's centre; move one of them",
                                 rigid->hung[i]);
        for (int k = 0; k < i; k++)
            if (rigid->hung[k] == rigid->hung[i])
                return ck_scene_fail(scene, place, error, "node %d is named twice; name it once", rigid->hung[i]);
        ck_body_add_spring(model, springs, rigid->hung[i], rigid->particle, length, CK_STRUCTURAL);
    }
    return CK_OK;
}

// Errors: CK_BAD_INPUT where something starts inside of a body, or two would meet that nothing says how to.
static ck_Status check_apart(const ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    ck_Collider *bodies = malloc(sizeof *bodies * ((size_t)model->rigid_count + (size_t)model->collider_count));
    ck_Touch *touches = malloc(sizeof *touches * ck_rigid_most_touches(model));
    ck_Status status = bodies && touches ? CK_OK : CK_NO_MEMORY;
    double velocity[3], gain[3];
    char place[32];
    for (int i = 0; i < model->rigid_count && !status; i++) {
        bodies[i] = model->rigid[i].shape;
        snprintf(place, sizeof place, "bodies[%d]", i);
        bool is_unknown = false;
        for (int j = 0; j < model->collider_count; j++)
            is_unknown |= ck_rigid_is_unknown(&bodies[i], &model->colliders[j]);
        for (int j = 0; j < i; j++) is_unknown |= ck_rigid_is_unknown(&bodies[i], &bodies[j]);
        if (is_unknown)
            status = ck_scene_fail(scene, place, error,
                                   "a box that moves meets cloth, planes and spheres; how it meets a capsule, a "
                                   "cylinder or another box is not modelled: make one of them a sphere");
    }
    for (int j = 0; j < model->collider_count && !status; j++)
        bodies[model->rigid_count + j] = ck_collider_at(&model->colliders[j], 0, 1, velocity, gain);
    const int count = status ? 0
                             : ck_rigid_find_touches(model, model->position, bodies, bodies + model->rigid_count,
                                                     -1e-9 * model->spacing, touches);
    for (int i = 0; i < count && !status; i++) {
        const int rigid = touches[i].rigid >= 0 ? touches[i].rigid : touches[i].other;
        snprintf(place, sizeof place, "bodies[%d]", rigid);
        if (touches[i].rigid < 0)
            status = ck_scene_fail(scene, place, error, "particle %d starts %g m inside this body; move one of them",
                                   touches[i].particle, -touches[i].gap);
        else
            status = ck_scene_fail(scene, place, error, "this body starts %g m inside another or a collider; move it",
                                   -touches[i].gap);
    }
    free(bodies);
    free(touches);
    return status;
}

ck_Status ck_model_add_rigid(ck_Model *model, const ck_Scene *scene, bool is_part, ck_Error *error) {
    const ck_SceneFile *file = scene->file;
    const int cloth = model->particle_count;
    if (!file->bodies_count) return CK_OK;
    int *chosen = malloc(sizeof *chosen * (size_t)cloth);
    size_t springs = 0;
    model->rigid = calloc(file->bodies_count, sizeof *model->rigid);
    ck_Status status = chosen && model->rigid ? CK_OK : CK_NO_MEMORY;
    if (model->rigid) model->rigid_count = (int)file->bodies_count;
    for (uint32_t i = 0; i < file->bodies_count && !status; i++) {
        status = set_rigid(model, scene, i, chosen, error);
        springs += (size_t)model->rigid[i].hung_count;
    }
    free(chosen);
    if (!status) status = make_room(model, springs);
    if (status) return status;
    for (uint32_t i = 0; i < file->bodies_count; i++) {
        const int particle = model->rigid[i].particle = model->particle_count++;
        memcpy(model->position + 3 * particle, model->rigid[i].shape.point, 3 * sizeof(double));
        if (file->bodies[i].velocity)
            memcpy(model->velocity + 3 * particle, file->bodies[i].velocity, 3 * sizeof(double));
        model->mass[particle] = file->bodies[i].mass;
    }
    for (uint32_t i = 0; i < file->bodies_count && !status; i++) status = hang(model, scene, i, error);
    return status || is_part ? status : check_apart(model, scene, error);
}
