// Compiled for either precision; see single.h.
#include "constraint_loop.h"
#include "row_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// m/s of what moved a metre in a substep.
static double rate_of(const ck_ProjectedCloth *cloth) {
    return cloth->rule.keep / cloth->rule.dt;
}

// Of a number of [3*n].
static ck_Real *place_at(const ck_ProjectedCloth *cloth, ck_Real *tiles, int number) {
    const int particle = number / 3, columns = cloth->rows.columns;
    return tiles + ck_rows_at(&cloth->rows, particle / columns, particle % columns).tile + number % 3 * CK_STRIPE;
}

static void read_state(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    const double rate = rate_of(cloth);
    static const double none[3];
    ck_rows_store(&cloth->rows, position, cloth->x, none);
    ck_rows_store(&cloth->rows, velocity, cloth->from, none);
    ck_rows_store(&cloth->rows, before, cloth->before, none);
    for (int i = 0; i < 3 * cloth->rows.rows * cloth->rows.columns; i += 3)
        for (int axis = 0; axis < 3; axis++) {
            velocity[i + axis] = rate * (position[i + axis] - velocity[i + axis]);
            before[i + axis] *= rate;
            position[i + axis] += cloth->origin[axis];
        }
    if (CK_IS_SINGLE) ck_rows_add(&cloth->rows, position, cloth->start);
}

static void destroy(ck_ProjectedCloth *cloth) {
    free(cloth->state);
    free(cloth->met_from);
    free(cloth->springs);
    free(cloth->multipliers);
    free(cloth->is_held);
    free(cloth->far_from);
    free(cloth);
}

static void set_compliant(ck_Compliant *compliant, const ck_RowSprings *springs, ck_SpringKind kind,
                          const ck_ProjectionRule *rule, double light) {
    const double dt = rule->dt, stiffness = rule->compliance > 0 ? 1 / rule->compliance : springs->stiffness[kind];
    compliant->compliance = 1 / (stiffness * dt * dt);
    compliant->gamma = springs->damping / (stiffness * dt);
    const double one = (1 + compliant->gamma) * light + compliant->compliance,
                 both = one + (1 + compliant->gamma) * light;
    compliant->share = light / both;
    compliant->alone = both / one;
}

static void set_rule(ck_ProjectedCloth *cloth, const ck_RowSprings *springs, const ck_ProjectionRule *rule) {
    const double dt = rule->dt;
    bool is_elastic =
        rule->projection == CK_PROJECT_SPRINGS && (rule->compliance > 0 || isfinite(springs->stiffness[CK_STRUCTURAL]));
    cloth->rule = *rule;
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) cloth->rest[kind] = (ck_Real)springs->rest[kind];
    cloth->carried = rule->carry * rule->keep;
    for (int axis = 0; axis < 3; axis++) cloth->push[axis] = dt * rule->push[axis];
    cloth->terms = rule->projection == CK_PROJECT_BARS ? CK_SWEEP_BARS : 0;
    cloth->long_scale = 0.25 * rule->relaxation * (CK_LONG_BAR - 1);
    if (is_elastic)
        cloth->terms |= (springs->damping > 0 ? CK_SWEEP_DAMPED : 0) | (rule->iterations > 1 ? CK_SWEEP_REPEATED : 0);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
        if (springs->rest[kind] > 0) set_compliant(&cloth->compliant[kind], springs, kind, rule, 1 / cloth->mass);
}

static void fill_stripes(ck_ProjectedCloth *cloth, ck_Direction direction) {
    const ck_SpringKind kind = direction == CK_IS_ACROSS ? CK_SHEAR : CK_STRUCTURAL;
    const double rest = cloth->rest[kind], square = rest * rest;
    bool are_bars = cloth->rule.projection == CK_PROJECT_BARS;
    double share = cloth->rule.relaxation * (are_bars ? 0.25 / square : cloth->compliant[kind].share);
    for (int column = 0; column < cloth->rows.span * CK_STRIPE; column++) {
        ck_Stripe *stripe = &cloth->stripes[direction][column % cloth->rows.span];
        const int lane = column / cloth->rows.span;
        bool is_there = rest > 0 && column + (direction != CK_IS_DOWN) < cloth->rows.columns;
        stripe->share[lane] = is_there ? share : 0;
        stripe->share_rest[lane] = is_there ? share * (are_bars ? square : rest) : 0;
        if (are_bars) continue;
        stripe->softness[lane] = stripe->share[lane] * cloth->compliant[kind].compliance * cloth->mass;
        stripe->viscosity[lane] = stripe->share[lane] * cloth->compliant[kind].gamma;
    }
}

static void place_arrays(ck_ProjectedCloth *cloth) {
    const size_t size = cloth->rows.size;
    cloth->x = cloth->state;
    cloth->start = cloth->state + 3 * size;
    cloth->before = cloth->state + 6 * size;
    cloth->is_free = cloth->state + 9 * size;
    cloth->kept = CK_IS_SINGLE ? cloth->state + 10 * size : NULL;
    cloth->from = CK_IS_SINGLE ? cloth->kept : cloth->start;
    for (int direction = 0; direction < CK_DIRECTIONS; direction++)
        cloth->stripes[direction] = (ck_Stripe *)cloth->springs + direction * cloth->rows.span;
    // the colours along a row have the row's vectors between them
    for (int colour = 0; colour <= CK_DOWN_LEFT && cloth->multipliers; colour++)
        cloth->multiplier[colour] =
            cloth->multipliers + size * (size_t)(colour > CK_ALONG_LAST ? colour - CK_ALONG_LAST : 0);
    cloth->multiplier[CK_DOWN_LATE] = cloth->multiplier[CK_DOWN];
}

// Marks what is free; a row is held where it or the one below has a pin.
static void mark_free(ck_ProjectedCloth *cloth, const double *inverse_mass) {
    const ck_Rows *rows = &cloth->rows;
    for (int i = 0; i < rows->rows * rows->columns; i++) {
        int row = i / rows->columns;
        cloth->is_free[ck_rows_at(rows, row, i % rows->columns).single] = inverse_mass[i] > 0;
        if (inverse_mass[i] > 0) continue;
        cloth->is_held[row] = true;
        if (row > 0) cloth->is_held[row - 1] = true;
    }
}

// Places as they are, and as velocities say that they were; in single precision ways, of which a place takes what its
// digits reach.
static void start_moving(ck_ProjectedCloth *cloth, const double *position, const double *velocity,
                         const double *before) {
    const double rate = rate_of(cloth);
    for (int i = 0; i < 3 * cloth->rows.rows * cloth->rows.columns; i++) {
        const double x = position[i] - cloth->origin[i % 3], way = velocity[i] / rate;
        ck_Real *start = place_at(cloth, cloth->start, i);
        *start = (ck_Real)(CK_IS_SINGLE ? x : x - way);
        *place_at(cloth, cloth->x, i) = (ck_Real)(CK_IS_SINGLE ? x - *start : x);
        *place_at(cloth, cloth->before, i) = (ck_Real)(before[i] / rate);
        if (CK_IS_SINGLE) *place_at(cloth, cloth->kept, i) = (ck_Real)(x - *start - way);
    }
}

static ck_Status create(ck_ProjectedCloth **out, const ck_ProjectionSetup *setup, ck_Error *error) {
    const ck_Model *model = setup->model;
    ck_ProjectedCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    cloth->head.kind = &ck_projection_rows;
    cloth->loops = setup->loops;
    cloth->rows = ck_rows_of(model);
    cloth->mass = (ck_Real)model->mass[0];
    cloth->size = model->size;
    set_rule(cloth, setup->springs, setup->rule);
    const ck_Rows stripes = {.size = (size_t)cloth->rows.span * sizeof(ck_Stripe) / sizeof(ck_Real)};
    cloth->state = ck_rows_allocate(&cloth->rows, CK_IS_SINGLE ? 13 : 10);
    cloth->springs = ck_rows_allocate(&stripes, CK_DIRECTIONS);
    cloth->multipliers = cloth->terms & CK_SWEEP_REPEATED ? ck_rows_allocate(&cloth->rows, 4) : NULL;
    cloth->is_held = calloc((size_t)cloth->rows.rows, sizeof *cloth->is_held);
    cloth->far_from = calloc((size_t)cloth->rows.rows, sizeof *cloth->far_from);
    if (!cloth->state || !cloth->springs || !cloth->is_held || !cloth->far_from ||
        ((cloth->terms & CK_SWEEP_REPEATED) && !cloth->multipliers)) {
        destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    place_arrays(cloth);
    mark_free(cloth, setup->inverse_mass);
    for (int direction = 0; direction < CK_DIRECTIONS; direction++) fill_stripes(cloth, direction);
    if (CK_IS_SINGLE) memcpy(cloth->origin, setup->position, sizeof cloth->origin);
    start_moving(cloth, setup->position, setup->velocity, setup->before);
    *out = cloth;
    return CK_OK;
}

#ifdef CK_SINGLE
// Of a place beside the cloth, in the order of its vectors.
static int particle_at(const ck_ProjectedCloth *cloth, int place) {
    const int stride = (int)cloth->rows.stride, lane = place % CK_STRIPE, vector = place % stride / CK_STRIPE;
    return place / stride * cloth->rows.columns + lane * cloth->rows.span + vector;
}

// What moves starts as without contact.
static ck_Status touch(ck_ProjectedCloth *cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    const ck_Rows *rows = &cloth->rows;
    const ck_Follower follower = ck_projection_follower(cloth, &setup->beside->follower);
    ck_Status status = ck_sixteens_create(&cloth->head, setup->beside, &follower, rows->rows * rows->stride, error);
    if (status) return status;
    for (int i = 0; i < rows->rows * rows->columns; i++)
        cloth->head.contact->mass[ck_rows_at(rows, i / rows->columns, i % rows->columns).single] =
            setup->beside->mass[i];
    cloth->met_from = ck_rows_allocate(rows, 3);
    if (!cloth->met_from) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    memcpy(cloth->met_from, cloth->kept, 3 * sizeof *cloth->kept * rows->size);
    cloth->from = cloth->met_from;
    return CK_OK;
}
#else
// What moves starts as without contact.
static ck_Status touch(ck_ProjectedCloth *cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    ck_Status status = ck_row_contact_of_rows(&cloth->head.contact, setup->beside, &cloth->rows, error);
    if (status) return status;
    cloth->head.contact->x = cloth->x;
    memcpy(cloth->head.contact->from, cloth->start, 3 * sizeof *cloth->start * cloth->rows.size);
    cloth->from = cloth->head.contact->from;
    return CK_OK;
}
#endif

const ck_ProjectionKind ck_projection_rows = {
    .create = create,
    .destroy = destroy,
    .step = ck_projection_run,
    .read = read_state,
    .touch = touch,
#ifdef CK_SINGLE
    .particle_at = particle_at,
#endif
};
