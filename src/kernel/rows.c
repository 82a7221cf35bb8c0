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

ck_Rows ck_rows_of(const ck_Model *model) {
    int span = (model->columns + CK_STRIPE - 1) / CK_STRIPE, rows = model->particle_count / model->columns;
    if (span < 2) span = 2; // so that the right of a vector is another
    long stride = (long)span * CK_STRIPE;
    // arrays a multiple of 4 KiB apart would fall on the same lines of the first cache
    return (ck_Rows){rows, model->columns, span, stride, (size_t)(rows * stride) + 3 * CK_STRIPE};
}

double *ck_rows_allocate(const ck_Rows *rows, int count) {
    size_t bytes = sizeof(double) * rows->size * (size_t)count;
    double *block = aligned_alloc(sizeof(double) * CK_STRIPE, bytes);
    if (block) memset(block, 0, bytes);
    return block;
}

void ck_rows_load(const ck_Rows *rows, double *tiles, const double *vectors) {
    for (int i = 0; i < rows->rows * rows->columns; i++)
        for (int axis = 0; axis < 3; axis++)
            tiles[ck_rows_at(rows, i / rows->columns, i % rows->columns).tile + axis * CK_STRIPE] =
                vectors[3 * i + axis];
}

void ck_rows_store(const ck_Rows *rows, double *vectors, const double *tiles) {
    for (int row = 0; row < rows->rows; row++, vectors += 3 * rows->columns)
        for (int lane = 0; lane * rows->span < rows->columns; lane++) {
            double *to = vectors + 3 * lane * rows->span;
            const double *from = tiles + ck_rows_place(rows, row, 0).tile + lane;
            for (int i = 0; i < rows->span && lane * rows->span + i < rows->columns; i++, from += 3 * CK_STRIPE)
                for (int axis = 0; axis < 3; axis++) to[3 * i + axis] = from[axis * CK_STRIPE];
        }
}

void ck_rows_mark_paired(const ck_Rows *rows, int reach, double *paired) {
    for (int column = 0; column < rows->span * CK_STRIPE; column++)
        paired[ck_rows_at(rows, 0, column).single] = column + reach < rows->columns;
}
