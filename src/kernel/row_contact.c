#include "row_contact.h"

#include <stdlib.h>
#include <string.h>

#define TILE (3 * CK_STRIPE)

static ck_Rows rows_of_eight(int particles) {
    const int rows = (particles + CK_STRIPE - 1) / CK_STRIPE;
    return (ck_Rows){rows, CK_STRIPE, 1, CK_STRIPE, (size_t)(rows + 3) * CK_STRIPE};
}

static bool allocate(ck_RowContact *contact, bool is_beside) {
    const size_t size = contact->rows.size, count = (size_t)contact->rows.rows;
    contact->state = ck_rows_allocate(&contact->rows, is_beside ? 17 : 8);
    contact->impulse = calloc(count * TILE, sizeof *contact->impulse);
    contact->is_pressed = calloc(count, sizeof *contact->is_pressed);
    if (!contact->state || !contact->impulse || !contact->is_pressed) return false;
    contact->from = contact->state;
    contact->held = contact->state + 3 * size;
    contact->depth = contact->state + 6 * size;
    contact->mass = contact->state + 7 * size;
    if (!is_beside) return true;
    contact->x = contact->state + 8 * size;
    contact->way = contact->state + 11 * size;
    contact->gain = contact->state + 14 * size;
    return true;
}

static ck_Status create(ck_RowContact **out, const ck_Loops *loops, const ck_Rows *rows, const ck_Touched *touched,
                        bool is_beside, ck_Error *error) {
    const size_t surfaces = sizeof *touched->surfaces * (size_t)touched->count;
    *out = NULL;
    ck_RowContact *contact = calloc(1, sizeof *contact + 2 * surfaces);
    if (!contact) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    contact->loops = loops;
    contact->rows = *rows;
    contact->touched = *touched;
    contact->touched.surfaces = ck_row_contact_surfaces(contact, false);
    contact->ends = ck_row_contact_surfaces(contact, true);
    memcpy(ck_row_contact_surfaces(contact, false), touched->surfaces, surfaces);
    memcpy(ck_row_contact_surfaces(contact, true), touched->surfaces, surfaces);
    if (!allocate(contact, is_beside)) {
        ck_row_contact_destroy(contact);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *out = contact;
    return CK_OK;
}

ck_Status ck_row_contact_create(ck_RowContact **contact, const ck_Loops *loops, const ck_Touched *touched,
                                const ck_Follower *follower, int particles, ck_Error *error) {
    const ck_Rows rows = rows_of_eight(particles);
    ck_Status status = create(contact, loops, &rows, touched, true, error);
    if (!status) (*contact)->follower = *follower;
    return status;
}

ck_Status ck_row_contact_of_rows(ck_RowContact **contact, const ck_RowContact *beside, const ck_Rows *rows,
                                 ck_Error *error) {
    ck_Status status = create(contact, beside->loops, rows, &beside->touched, false, error);
    if (status) return status;
    (*contact)->follower = beside->follower;
    for (int i = 0; i < rows->rows * rows->columns; i++)
        (*contact)->mass[ck_rows_at(rows, i / rows->columns, i % rows->columns).single] = beside->mass[i];
    return CK_OK;
}

void ck_row_contact_destroy(ck_RowContact *contact) {
    if (!contact) return;
    free(contact->state);
    free(contact->impulse);
    free(contact->is_pressed);
    free(contact);
}

ck_NearSurface *ck_row_contact_surfaces(ck_RowContact *contact, bool at_end) {
    return (ck_NearSurface *)(contact + 1) + (at_end ? contact->touched.count : 0);
}

void ck_row_contact_begin(ck_RowContact *contact, int row) {
    if (!contact->is_pressed[row]) return;
    const ck_Place at = ck_rows_place(&contact->rows, row, 0);
    const size_t bytes = sizeof(double) * (size_t)contact->rows.stride;
    memset(contact->depth + at.single, 0, bytes);
    memset(contact->held + at.tile, 0, 3 * bytes);
    contact->is_pressed[row] = false;
}

void ck_row_contact_take(double *tiles, const double *vectors, int particles) {
    for (int i = 0; i < particles; i++)
        for (int axis = 0; axis < 3; axis++) tiles[ck_tile_of(i) + axis * CK_STRIPE] = vectors[3 * (long)i + axis];
}

void ck_row_contact_give(const ck_RowContact *contact, int row, double *position, int particles) {
    const int first = row * CK_STRIPE, end = first + CK_STRIPE < particles ? first + CK_STRIPE : particles;
    for (int i = first; i < end; i++)
        for (int axis = 0; axis < 3; axis++)
            position[3 * (long)i + axis] = contact->x[ck_tile_of(i) + axis * CK_STRIPE];
}

void ck_row_contact_forget_impulse(ck_RowContact *contact) {
    memset(contact->impulse, 0, sizeof *contact->impulse * TILE * (size_t)contact->rows.rows);
}

void ck_row_contact_impulse(const ck_RowContact *contact, double *impulse) {
    for (long i = 0; i < (long)contact->rows.rows * TILE; i++) impulse[i / CK_STRIPE % 3] += contact->impulse[i];
}
