#include "rows.h"

#include <stdlib.h>
#include <string.h>

// How many springs of a kind a regular cloth has.
static int springs_of_kind(ck_SpringKind kind, int rows, int columns) {
    if (kind == CK_STRUCTURAL) return rows * (columns - 1) + (rows - 1) * columns;
    if (kind == CK_SHEAR) return 2 * (rows - 1) * (columns - 1);
    return rows * (columns > 2 ? columns - 2 : 0) + (rows > 2 ? rows - 2 : 0) * columns;
}

// True where a spring joins the neighbours that its kind is for.
static bool joins_neighbours(const ck_Spring *spring, int columns) {
    int down = spring->b / columns - spring->a / columns, right = spring->b % columns - spring->a % columns;
    if (spring->kind == CK_SHEAR) return down == 1 && abs(right) == 1;
    int reach = spring->kind == CK_BEND ? 2 : 1;
    return (down == 0 && right == reach) || (down == reach && right == 0);
}

bool ck_only_springs_act(const ck_Model *model) {
    return model->spring_count && !model->hinge_count && !model->wind.face_count && !model->driven_count &&
           !model->rigid_count && !(model->jitter > 0);
}

bool ck_rows_fit(const ck_Model *model, ck_RowSprings *springs) {
    *springs = (ck_RowSprings){0};
    if (model->body != CK_CLOTH || !ck_only_springs_act(model)) return false;
    for (int i = 1; i < model->particle_count; i++)
        if (model->mass[i] != model->mass[0]) return false;
    int counts[CK_SPRING_KINDS] = {0}, rows = model->particle_count / model->columns;
    springs->damping = model->springs[0].damping;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        if (spring->pulls_only) return false;
        if (!joins_neighbours(spring, model->columns) || spring->damping != springs->damping) return false;
        if (!counts[spring->kind]++) {
            springs->stiffness[spring->kind] = spring->stiffness;
            springs->rest[spring->kind] = spring->rest;
        }
        if (spring->stiffness != springs->stiffness[spring->kind] || spring->rest != springs->rest[spring->kind])
            return false;
    }
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
        if (counts[kind] && counts[kind] != springs_of_kind(kind, rows, model->columns)) return false;
    return counts[CK_STRUCTURAL] > 0;
}
