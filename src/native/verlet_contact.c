#include "verlet_contact.h"

#include "near_surfaces.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

struct ck_VerletContact {
    ck_NearSurface *surfaces; // [colliders]
    ck_Loose loose;
    double *state;
    long *places;
};

// Room for so many and the end of a vector.
static bool allocate(ck_VerletContact *contact, int colliders, int particles) {
    const long stride = ((long)particles / CK_STRIPE + 1) * CK_STRIPE;
    contact->surfaces = calloc((size_t)colliders, sizeof *contact->surfaces);
    contact->state = calloc(19 * (size_t)stride, sizeof *contact->state);
    contact->places = calloc((size_t)stride, sizeof *contact->places);
    double *state = contact->state;
    if (state)
        contact->loose = (ck_Loose){.place = contact->places,
                                    .stride = stride,
                                    .x = state,
                                    .v = state + 3 * stride,
                                    .a = state + 6 * stride,
                                    .predicted = state + 9 * stride,
                                    .mass = state + 12 * stride,
                                    .is_alone = state + 13 * stride,
                                    .curvature = state + 14 * stride,
                                    .friction = state + 15 * stride,
                                    .normal = state + 16 * stride};
    return contact->surfaces && contact->places && state;
}

ck_Status ck_verlet_contact_create(ck_VerletContact **out, const ck_Native *native, ck_Error *error) {
    *out = NULL;
    if (!native->contact) return CK_OK;
    ck_VerletContact *contact = calloc(1, sizeof *contact);
    if (!contact || !allocate(contact, native->model->collider_count, native->model->particle_count)) {
        ck_verlet_contact_destroy(contact);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *out = contact;
    return CK_OK;
}

void ck_verlet_contact_destroy(ck_VerletContact *contact) {
    if (!contact) return;
    free(contact->surfaces);
    free(contact->places);
    free(contact->state);
    free(contact);
}

static void take_one(double *one, const double *many, long stride, int i) {
    for (int axis = 0; axis < 3; axis++) one[axis] = many[axis * stride + i];
}

static void put_one(double *many, long stride, int i, const double *one) {
    for (int axis = 0; axis < 3; axis++) many[axis * stride + i] = one[axis];
}

// One by one, those that something happens to.
static void follow_alone(const ck_Loose *loose, ck_Contact *contact) {
    const long stride = loose->stride;
    for (int i = 0; i < loose->count; i++) {
        double x[3], v[3], a[3], left[3];
        if (!(loose->is_alone[i] > 0)) continue;
        take_one(x, loose->x, stride, i);
        take_one(v, loose->v, stride, i);
        take_one(a, loose->a, stride, i);
        ck_contact_advance(contact, loose->mass[i], x, v, a);
        put_one(loose->x, stride, i, x);
        put_one(loose->predicted, stride, i, v);
        ck_contact_filter(contact, x, v, a, left);
        ck_add_scaled(v, -0.5 * contact->dt, left);
        put_one(loose->v, stride, i, v);
    }
}

// So many, which were there before others came to be near.
static void kick_alone(const ck_Loose *loose, const ck_Contact *contact, int count) {
    const long stride = loose->stride;
    for (int i = 0; i < count; i++) {
        double x[3], v[3], predicted[3], a[3], left[3];
        if (!(loose->is_alone[i] > 0)) continue;
        take_one(x, loose->x, stride, i);
        take_one(v, loose->v, stride, i);
        take_one(predicted, loose->predicted, stride, i);
        take_one(a, loose->a, stride, i);
        ck_contact_filter(contact, x, predicted, a, left);
        ck_add_scaled(v, 0.5 * contact->dt, left);
        put_one(loose->v, stride, i, v);
    }
}

// The first half of a substep of what is loose. True where any is left alone.
static bool slide(ck_VerletContact *own, ck_Native *native, ck_Explicit *body) {
    ck_Contact *contact = native->contact;
    ck_Loose *loose = &own->loose;
    const ck_Touched touch = {own->surfaces, native->model->collider_count, native->dt, contact->slack};
    // what fills the last vector up weighs nothing
    for (int i = loose->count; i % CK_STRIPE; i++) loose->mass[i] = 0;
    contact->elapsed = native->dt;
    const unsigned others = ck_native_doubles(native)->touch_slide(&touch, loose, contact->impulse);
    if (others & CK_SOME_ALONE) follow_alone(loose, contact);
    ck_explicit_put(body, loose, false);
    if (others & CK_SOME_LEAVE) ck_explicit_leave(body, loose);
    return others & CK_SOME_ALONE;
}

static void drift(ck_VerletContact *own, ck_Native *native, ck_Explicit *body) {
    ck_Contact *contact = native->contact;
    if (contact->motion) ck_contact_follow(contact, ck_native_time(native));
    if (contact->motion || !native->done) ck_near_surfaces(own->surfaces, contact);
    ck_explicit_drift(body, own->surfaces, native->model->collider_count, &own->loose);
}

void ck_verlet_contact_step(ck_VerletContact *own, ck_Native *native, ck_Explicit *body, uint32_t substeps) {
    const ck_Contact *contact = native->contact;
    ck_Loose *loose = &own->loose;
    bool has_started = false;
    for (uint32_t i = 1; i <= substeps; i++) {
        if (!has_started) drift(own, native, body);
        const bool any_alone = slide(own, native, body);
        const int before = loose->count;
        native->done++;
        // what moves is somewhere else in the next substep, and what is alone still asks where it has been
        has_started = i < substeps && !contact->motion;
        if (has_started)
            ck_explicit_turn(body, own->surfaces, native->model->collider_count, loose);
        else
            ck_explicit_kick(body, loose);
        ck_native_doubles(native)->touch_hold(native->dt, loose);
        if (any_alone) kick_alone(loose, contact, before);
        if (!has_started) ck_explicit_put(body, loose, true);
    }
}
