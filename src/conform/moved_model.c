#include "moved_model.h"

#include "statistics.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// 50° about (1, 2, 3)/√14. Source: Rodrigues' formula.
static void rotate(double *vector) {
    const double axis[3] = {0.2672612419124244, 0.5345224838248488, 0.8017837257372732};
    const double sine = 0.766044443118978, cosine = 0.6427876096865394;
    double cross[3];
    ck_cross(cross, axis, vector);
    double along = ck_dot(axis, vector) * (1 - cosine);
    for (int i = 0; i < 3; i++) vector[i] = vector[i] * cosine + cross[i] * sine + axis[i] * along;
}

static void change(double *vector, ck_Move move, double by) {
    if (move == CK_MOVE_ROTATE) rotate(vector);
    if (move == CK_MOVE_MIRROR) vector[0] = -vector[0];
    for (int axis = 0; axis < 3 && move == CK_MOVE_GROW; axis++) vector[axis] *= by;
}

static void shuffle(ck_Model *model) {
    ck_Random random = ck_random_seed(5);
    for (int i = model->spring_count - 1; i > 0; i--) {
        int other = (int)(ck_random_next(&random) % (uint64_t)(i + 1));
        ck_Spring kept = model->springs[i];
        model->springs[i] = model->springs[other];
        model->springs[other] = kept;
    }
}

static void *copy_of(const void *from, size_t bytes) {
    void *copy = malloc(bytes + 1);
    if (copy && bytes) memcpy(copy, from, bytes);
    return copy;
}

ck_Status ck_moved_model_create(ck_Model *moved, const ck_Model *model, ck_Move move, double by, ck_Error *error) {
    const size_t vectors = 3 * (size_t)model->particle_count * sizeof(double);
    *moved = *model;
    moved->position = copy_of(model->position, vectors);
    moved->velocity = copy_of(model->velocity, vectors);
    moved->springs = copy_of(model->springs, (size_t)model->spring_count * sizeof *model->springs);
    if (!moved->position || !moved->velocity || !moved->springs) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < model->particle_count; i++) {
        change(moved->position + 3 * i, move, by);
        change(moved->velocity + 3 * i, move, by);
        if (move == CK_MOVE_SHIFT) moved->position[3 * i] += by;
    }
    change(moved->gravity, move, by);
    change(moved->force, move, by);
    if (move == CK_MOVE_SHUFFLE) shuffle(moved);
    if (move != CK_MOVE_GROW) return CK_OK;
    for (int i = 0; i < model->spring_count; i++) moved->springs[i].rest *= by;
    moved->size *= by;
    moved->spacing *= by;
    return CK_OK;
}

void ck_moved_model_free(ck_Model *moved) {
    free(moved->position);
    free(moved->velocity);
    free(moved->springs);
    *moved = (ck_Model){0};
}
