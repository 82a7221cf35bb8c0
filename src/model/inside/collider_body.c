// The colliders of a scene: each shape's own keys into one core and radius.
#include "body.h"

#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Two more directions square to the first, which is a unit vector.
static void complete_axes(double (*axes)[3]) {
    int least = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(axes[0][k]) < fabs(axes[0][least])) least = k;
    memset(axes[1], 0, sizeof axes[1]);
    axes[1][least] = 1;
    ck_add_scaled(axes[1], -axes[0][least], axes[0]);
    const double length = ck_length(axes[1]);
    for (int k = 0; k < 3; k++) axes[1][k] /= length;
    ck_cross(axes[2], axes[0], axes[1]);
}

static void set_surface(ck_Collider *collider, double restitution, double friction) {
    collider->restitution = restitution;
    collider->friction = friction;
}

static ck_Status set_capsule(ck_Collider *collider, const ck_SceneCapsule *from, const ck_Scene *scene, const char *at,
                             ck_Error *error) {
    double along[3];
    collider->shape = CK_CAPSULE;
    set_surface(collider, from->restitution, from->friction);
    collider->radius = from->radius;
    ck_subtract(along, from->to, from->from);
    for (int k = 0; k < 3; k++) collider->point[k] = from->from[k] + 0.5 * along[k];
    collider->half[0] = 0.5 * ck_length(along);
    if (!(collider->half[0] > 0))
        return ck_scene_fail(scene, at, error, "from and to are one point; a sphere has its place as center");
    ck_Status status = ck_model_unit(collider->axes[0], along, scene, at, error);
    if (!status) complete_axes(collider->axes);
    return status;
}

static ck_Status set_cylinder(ck_Collider *collider, const ck_SceneCylinder *from, const ck_Scene *scene,
                              const char *at, ck_Error *error) {
    char place[64];
    snprintf(place, sizeof place, "%s.axis", at);
    collider->shape = CK_CYLINDER;
    set_surface(collider, from->restitution, from->friction);
    collider->radius = from->radius;
    collider->half[0] = INFINITY;
    memcpy(collider->point, from->point, sizeof collider->point);
    ck_Status status = ck_model_unit(collider->axes[0], from->axis, scene, place, error);
    if (!status) complete_axes(collider->axes);
    return status;
}

ck_Status ck_model_set_box(ck_Collider *collider, const ck_SceneBox *from, const ck_Scene *scene, const char *at,
                           ck_Error *error) {
    static const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    char place[64];
    double up[3];
    collider->shape = CK_BOX;
    set_surface(collider, from->restitution, from->friction);
    collider->radius = from->rounding;
    memcpy(collider->point, from->center, sizeof collider->point);
    for (int k = 0; k < 3; k++) {
        collider->half[k] = 0.5 * from->size[k] - from->rounding;
        if (!(collider->half[k] > 0))
            return ck_scene_fail(scene, at, error, "a side of %g m has no room for edges rounded by %g m",
                                 from->size[k], from->rounding);
    }
    snprintf(place, sizeof place, "%s.along", at);
    ck_Status status = ck_model_unit(collider->axes[0], from->along ? from->along : x, scene, place, error);
    if (status) return status;
    memcpy(up, from->up ? from->up : y, sizeof up);
    // one that is square already stays, so that what is written out reads back the same
    if (fabs(ck_dot(up, collider->axes[0])) > 4e-16 * ck_length(up))
        ck_add_scaled(up, -ck_dot(up, collider->axes[0]), collider->axes[0]);
    snprintf(place, sizeof place, "%s.%s", at, from->up ? "up" : "along");
    if (!(ck_length(up) > 1e-9 * ck_length(from->up ? from->up : y)))
        return ck_scene_fail(scene, place, error, "along and up are one direction; give up another");
    status = ck_model_unit(collider->axes[1], up, scene, place, error);
    if (!status) ck_cross(collider->axes[2], collider->axes[0], collider->axes[1]);
    return status;
}

static ck_Status set_plane(ck_Collider *collider, const ck_ScenePlane *from, const ck_Scene *scene, const char *at,
                           ck_Error *error) {
    char place[64];
    snprintf(place, sizeof place, "%s.normal", at);
    collider->shape = CK_PLANE;
    set_surface(collider, from->restitution, from->friction);
    memcpy(collider->point, from->point, sizeof collider->point);
    return ck_model_unit(collider->normal, from->normal, scene, place, error);
}

ck_Status ck_model_set_sphere(ck_Collider *collider, const ck_SceneSphere *from) {
    collider->shape = CK_SPHERE;
    collider->radius = from->radius;
    memcpy(collider->point, from->center, sizeof collider->point);
    set_surface(collider, from->restitution, from->friction);
    return CK_OK;
}

static ck_Status set_collider(ck_Model *model, const ck_Scene *scene, uint32_t index, ck_Error *error) {
    const ck_SceneCollider *from = &scene->file->colliders[index];
    ck_Collider *collider = &model->colliders[model->collider_count++];
    // a scene's collider has one of these
    const void *const shapes[CK_SHAPE_COUNT] = {from->plane, from->sphere, from->capsule, from->cylinder, from->box};
    ck_ColliderShape shape = CK_PLANE;
    char at[48];
    while (!shapes[shape] && shape + 1 < CK_SHAPE_COUNT) shape++;
    snprintf(at, sizeof at, "colliders[%u].%s", index, ck_shape_names[shape]);
    switch (shape) {
    case CK_PLANE: return set_plane(collider, from->plane, scene, at, error);
    case CK_SPHERE: return ck_model_set_sphere(collider, from->sphere);
    case CK_CAPSULE: return set_capsule(collider, from->capsule, scene, at, error);
    case CK_CYLINDER: return set_cylinder(collider, from->cylinder, scene, at, error);
    default: return ck_model_set_box(collider, from->box, scene, at, error);
    }
}

ck_Status ck_model_set_colliders(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    model->colliders = calloc(scene->file->colliders_count + 1, sizeof *model->colliders);
    if (!model->colliders) return CK_NO_MEMORY;
    ck_Status status = CK_OK;
    for (uint32_t i = 0; i < scene->file->colliders_count && !status; i++)
        status = set_collider(model, scene, i, error);
    return status;
}
