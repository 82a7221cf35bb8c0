#include "touching.h"

#include "collider.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void add_pairs(ck_Touching *touching, const ck_Model *model, int particle, double radius) {
    for (int j = 0; j < model->collider_count; j++)
        touching->pairs[touching->count++] = (ck_TouchingPair){particle, -1, j, radius, 0};
    for (int j = 0; j < model->rigid_count && model->rigid[j].particle > particle; j++) {
        const ck_RigidBody *rigid = &model->rigid[j];
        bool is_hung = false;
        for (int k = 0; k < rigid->hung_count; k++) is_hung |= rigid->hung[k] == particle;
        if (is_hung) continue;
        touching->pairs[touching->count++] =
            (ck_TouchingPair){particle, rigid->particle, -1, radius + rigid->shape.radius, 0};
    }
}

ck_Status ck_touching_create(ck_Touching **out, const ck_Model *model, const double *origin, double stiffness) {
    const size_t surfaces = (size_t)(model->collider_count + model->rigid_count);
    *out = NULL;
    if (!surfaces) return CK_OK;
    ck_Touching *touching = calloc(1, sizeof *touching);
    if (!touching) return CK_NO_MEMORY;
    touching->stiffness = stiffness;
    touching->pairs = calloc((size_t)model->particle_count * surfaces, sizeof *touching->pairs);
    touching->colliders = calloc((size_t)model->collider_count + 1, sizeof *touching->colliders);
    if (!touching->pairs || !touching->colliders) {
        ck_touching_free(touching);
        return CK_NO_MEMORY;
    }
    for (int i = 0; i < model->collider_count; i++) {
        touching->colliders[i] = model->colliders[i];
        ck_add_scaled(touching->colliders[i].point, -1, origin);
    }
    const int cloth = ck_model_cloth_count(model);
    for (int i = 0; i < cloth; i++)
        if (!model->pinned[i]) add_pairs(touching, model, i, 0);
    // a pin may be under a body
    for (int i = 0; i < cloth; i++) {
        ck_Model bodies = *model;
        bodies.collider_count = 0;
        if (model->pinned[i]) add_pairs(touching, &bodies, i, 0);
    }
    for (int i = 0; i < model->rigid_count; i++)
        add_pairs(touching, model, model->rigid[i].particle, model->rigid[i].shape.radius);
    *out = touching;
    return CK_OK;
}

void ck_touching_free(ck_Touching *touching) {
    if (!touching) return;
    free(touching->pairs);
    free(touching->colliders);
    free(touching);
}

static double gap_of(const ck_Touching *touching, const ck_TouchingPair *pair, const double *position,
                     const double *particle, double *normal) {
    if (pair->other < 0) return ck_collider_gap(&touching->colliders[pair->collider], particle, normal) - pair->apart;
    ck_subtract(normal, particle, position + 3 * pair->other);
    const double distance = ck_length(normal);
    for (int axis = 0; axis < 3; axis++) normal[axis] = distance > 0 ? normal[axis] / distance : axis == 1;
    return distance - pair->apart;
}

// max(0, λ − κ·gap), N
static double push_of(const ck_Touching *touching, const ck_TouchingPair *pair, const double *position,
                      double *normal) {
    const double gap = gap_of(touching, pair, position, position + 3 * pair->particle, normal);
    return fmax(0, pair->force - touching->stiffness * gap);
}

double ck_touching_energy(const ck_Touching *touching, const double *position, double *gradient) {
    double energy = 0, normal[3];
    for (int i = 0; i < touching->count; i++) {
        const ck_TouchingPair *pair = &touching->pairs[i];
        const double push = push_of(touching, pair, position, normal);
        energy += 0.5 * (push * push - pair->force * pair->force) / touching->stiffness;
        if (!gradient || !(push > 0)) continue;
        ck_add_scaled(gradient + 3 * pair->particle, -push, normal);
        if (pair->other >= 0) ck_add_scaled(gradient + 3 * pair->other, push, normal);
    }
    return energy;
}

// Of the radius or so: by how much a normal turns is told from there.
#define NUDGE 1e-5

// κ·n·nᵀ − push·∂n/∂x; how a solid's normal turns is taken from places beside.
bool ck_touching_block(const ck_Touching *touching, const ck_TouchingPair *pair, const double *position,
                       double *block) {
    const double *at = position + 3 * pair->particle;
    double normal[3], one[3], other[3];
    const double push = push_of(touching, pair, position, normal);
    if (!(push > 0)) return false;
    for (int k = 0; k < 9; k++) block[k] = touching->stiffness * normal[k / 3] * normal[k % 3];
    const bool is_solid = pair->other >= 0 || touching->colliders[pair->collider].shape != CK_PLANE;
    const double size = pair->other >= 0 ? pair->apart : touching->colliders[pair->collider].radius + pair->apart;
    for (int k = 0; k < 3 && is_solid && size > 0; k++) {
        double before[3] = {at[0], at[1], at[2]}, after[3] = {at[0], at[1], at[2]};
        before[k] -= NUDGE * size;
        after[k] += NUDGE * size;
        gap_of(touching, pair, position, before, one);
        gap_of(touching, pair, position, after, other);
        for (int row = 0; row < 3; row++) block[3 * row + k] -= push * (other[row] - one[row]) / (2 * NUDGE * size);
    }
    return true;
}

// Pairs of the cloth come first: a body that it carries has its load from them, and what holds the body holds both.
bool ck_touching_hold(const ck_Touching *touching, const double *position, double near, double *gradient) {
    for (int i = 0; i < touching->count; i++) {
        const ck_TouchingPair *pair = &touching->pairs[i];
        double normal[3];
        const double gap = gap_of(touching, pair, position, position + 3 * pair->particle, normal);
        if (gap < -near) return false;
        const double press = gap <= near ? fmax(0, ck_dot(gradient + 3 * pair->particle, normal)) : 0;
        ck_add_scaled(gradient + 3 * pair->particle, -press, normal);
        if (pair->other >= 0) ck_add_scaled(gradient + 3 * pair->other, press, normal);
    }
    return true;
}

double ck_touching_update(ck_Touching *touching, const double *position) {
    double off = 0, normal[3];
    for (int i = 0; i < touching->count; i++) {
        ck_TouchingPair *pair = &touching->pairs[i];
        const double push = push_of(touching, pair, position, normal);
        off = fmax(off, fabs(push - pair->force) / touching->stiffness);
        pair->force = push;
    }
    return off;
}
