#include "verlet_contact.h"

#include "vector.h"

#include <stdlib.h>
#include <string.h>

// A particle that is followed by itself.
typedef struct Loose {
    int particle;
    double position[3], velocity[3], predicted[3];
} Loose;

struct ck_VerletContact {
    ck_NearSurface *surfaces; // [colliders]
    int *near;                // [n]
    Loose *loose;             // [n]
};

ck_Status ck_verlet_contact_create(ck_VerletContact **out, const ck_Native *native, ck_Error *error) {
    const size_t count = (size_t)native->model->particle_count;
    *out = NULL;
    if (!native->contact) return CK_OK;
    ck_VerletContact *contact = calloc(1, sizeof *contact);
    if (contact) {
        contact->surfaces = calloc((size_t)native->model->collider_count, sizeof *contact->surfaces);
        contact->near = malloc(count * sizeof *contact->near);
        contact->loose = malloc(count * sizeof *contact->loose);
    }
    if (!contact || !contact->surfaces || !contact->near || !contact->loose) {
        ck_verlet_contact_destroy(contact);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *out = contact;
    return CK_OK;
}

void ck_verlet_contact_destroy(ck_VerletContact *contact) {
    if (!contact) return;
    free(contact->surfaces);
    free(contact->near);
    free(contact->loose);
    free(contact);
}

// Where the colliders are at the start of the substep; how far they move in it counts as nearness.
static void set_surfaces(ck_NearSurface *surfaces, const ck_Contact *contact) {
    for (int i = 0; i < contact->model->collider_count; i++) {
        const ck_Collider *collider = &contact->model->colliders[i];
        ck_NearSurface *surface = &surfaces[i];
        *surface = (ck_NearSurface){
            .is_plane = collider->shape == CK_PLANE, .radius = collider->radius, .margin = 2 * contact->slack};
        memcpy(surface->point, collider->point, sizeof surface->point);
        memcpy(surface->normal, collider->normal, sizeof surface->normal);
        for (int k = 0; k < 3; k++) {
            if (!(collider->half[k] > 0)) continue;
            memcpy(surface->axes[surface->axis_count], collider->axes[k], sizeof collider->axes[k]);
            surface->half[surface->axis_count++] = collider->half[k];
        }
        if (!collider->path || !contact->motion) continue;
        const ck_Motion *motion = &contact->motion[i];
        const double dt = contact->dt;
        ck_add_scaled(surface->point, 1, motion->moved);
        surface->margin += dt * ck_length(motion->velocity) + 0.5 * dt * dt * ck_length(motion->acceleration);
        // it jumps on the way: whatever is anywhere may be met
        if (contact->until < dt) surface->margin = INFINITY;
    }
}

void ck_verlet_contact_substep(ck_VerletContact *own, ck_Native *native, ck_Explicit *cloth) {
    ck_Contact *contact = native->contact;
    const ck_Model *model = native->model;
    const double dt = native->dt;
    double left[3];
    if (contact->motion) ck_contact_follow(contact, (double)native->done * dt);
    if (contact->motion || !native->done) set_surfaces(own->surfaces, contact);
    const int count = ck_explicit_find_near(cloth, own->surfaces, model->collider_count, own->near);
    for (int i = 0; i < count; i++) {
        Loose *loose = &own->loose[i];
        loose->particle = own->near[i];
        ck_explicit_take(cloth, loose->particle, loose->position, loose->velocity, loose->predicted);
    }
    ck_explicit_drift(cloth);
    contact->elapsed = dt;
    for (int i = 0; i < count; i++) {
        Loose *loose = &own->loose[i];
        double *x = loose->position, *v = loose->velocity, a[3];
        memcpy(a, loose->predicted, sizeof a);
        ck_contact_advance(contact, model->mass[loose->particle], x, v, a);
        memcpy(loose->predicted, v, sizeof loose->predicted);
        ck_contact_filter(contact, x, v, a, left);
        ck_add_scaled(v, -0.5 * dt, left);
        ck_explicit_put(cloth, loose->particle, v, x, loose->predicted);
    }
    native->done++;
    ck_explicit_kick(cloth);
    for (int i = 0; i < count; i++) {
        Loose *loose = &own->loose[i];
        double x[3], v[3], a[3];
        ck_explicit_take(cloth, loose->particle, x, v, a);
        ck_contact_filter(contact, x, loose->predicted, a, left);
        ck_add_scaled(loose->velocity, 0.5 * dt, left);
        ck_explicit_put(cloth, loose->particle, loose->velocity, NULL, NULL);
    }
}
