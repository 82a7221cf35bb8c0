#include "near_surfaces.h"

#include "vector.h"

#include <math.h>
#include <string.h>

static ck_NearSurface surface_of(const ck_Contact *contact, int index) {
    const ck_Collider *collider = &contact->model->colliders[index];
    ck_NearSurface surface = {.is_plane = collider->shape == CK_PLANE,
                              .radius = collider->radius,
                              .margin = 2 * contact->slack,
                              .friction = collider->friction,
                              .moves = collider->path && contact->motion};
    memcpy(surface.point, collider->point, sizeof surface.point);
    memcpy(surface.normal, collider->normal, sizeof surface.normal);
    for (int k = 0; k < 3; k++) {
        if (!(collider->half[k] > 0)) continue;
        memcpy(surface.axes[surface.axis_count], collider->axes[k], sizeof collider->axes[k]);
        surface.half[surface.axis_count++] = collider->half[k];
    }
    return surface;
}

void ck_near_surfaces(ck_NearSurface *surfaces, const ck_Contact *contact) {
    for (int i = 0; i < contact->model->collider_count; i++) {
        ck_NearSurface *surface = &surfaces[i];
        *surface = surface_of(contact, i);
        if (!surface->moves) continue;
        const ck_Motion *motion = &contact->motion[i];
        const double dt = contact->dt;
        ck_add_scaled(surface->point, 1, motion->moved);
        memcpy(surface->velocity, motion->velocity, sizeof surface->velocity);
        memcpy(surface->acceleration, motion->acceleration, sizeof surface->acceleration);
        surface->margin += dt * ck_length(motion->velocity) + 0.5 * dt * dt * ck_length(motion->acceleration);
        // it jumps on the way: whatever is anywhere may be met
        if (contact->until < dt) surface->margin = INFINITY;
    }
}

void ck_near_surfaces_at_end(ck_NearSurface *surfaces, const ck_Contact *contact) {
    for (int i = 0; i < contact->model->collider_count; i++) {
        surfaces[i] = surface_of(contact, i);
        if (!surfaces[i].moves) continue;
        ck_add_scaled(surfaces[i].point, 1, contact->motion[i].end);
        memcpy(surfaces[i].way, contact->motion[i].way, sizeof surfaces[i].way);
    }
}
