#include "follower.h"

#include "vector.h"

#include <string.h>

// A copy adds up what its own particle is given.
static ck_Contact alone(const ck_Native *native) {
    ck_Contact contact = *native->contact;
    memset(contact.impulse, 0, sizeof contact.impulse);
    return contact;
}

static bool meet(void *state, int particle, const double *field, double *x, double *v, double *impulse) {
    const ck_Native *native = state;
    ck_Contact contact = alone(native);
    if (!ck_contact_meet(&contact, native->model->mass[particle], field, x, v)) return false;
    ck_add_scaled(impulse, 1, contact.impulse);
    return true;
}

static void press(void *state, int particle, const double *from, double *depth, double *held, double *x,
                  double *impulse) {
    const ck_Native *native = state;
    ck_Contact contact = alone(native);
    ck_Pressed pressed = {*depth, {held[0], held[1], held[2]}};
    ck_contact_project(&contact, native->model->mass[particle], from, &pressed, x);
    *depth = pressed.depth;
    memcpy(held, pressed.held, sizeof pressed.held);
    ck_add_scaled(impulse, 1, contact.impulse);
}

ck_Follower ck_native_follower(ck_Native *native) {
    return (ck_Follower){native, meet, press};
}
