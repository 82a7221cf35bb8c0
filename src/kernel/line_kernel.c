// Compliant springs of a regular cloth, whole lines at a time; see constraint_kernel.h. Compiled for either precision;
// see single.h.
#include "line_loop.h"
#include "row_contact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A softness is at least this share of 1/m, or rounding could make a pivot 0.
#define ROUNDING (CK_IS_SINGLE ? 1e-6 : 1e-12)

static struct ck_LinedCloth *of(const ck_ProjectedCloth *cloth) {
    return (struct ck_LinedCloth *)cloth;
}

static long padded(long count) {
    return (count + CK_STRIPE - 1) / CK_STRIPE * CK_STRIPE;
}

static long place_of(const struct ck_LinedCloth *lined, int particle) {
    return particle / lined->columns * lined->stride + particle % lined->columns;
}

// The first substep of what begins to move finds half of its forces, as a leapfrog's first kick is half of one. The
// next one begins with all of that, so that half of it is told to be twice as much.
static void end_start(struct ck_LinedCloth *lined) {
    for (int i = 0; i < lined->rows * lined->columns; i++)
        for (int axis = 0; axis < 3 && lined->is_fresh[i]; axis++) {
            const long at = place_of(lined, i) + axis * lined->plane;
            lined->flown[at] = 2 * lined->flown[at] - lined->x[at];
        }
    free(lined->is_fresh);
    lined->is_fresh = NULL;
}

static void follow(struct ck_LinedCloth *lined) {
    const ck_Real shift[] = {lined->start[0], lined->start[lined->plane], lined->start[2 * lined->plane]};
    if (!ck_origin_follows(lined->origin, shift, lined->size)) return;
    for (int i = 0; i < 3 * lined->rows * lined->columns; i++)
        lined->start[place_of(lined, i / 3) + i % 3 * lined->plane] -= shift[i % 3];
}

static void step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    struct ck_LinedCloth *lined = of(cloth);
    (void)waves; // one thread alone
#ifdef CK_SINGLE
    ck_sixteens_see(&lined->head, lined->origin, lined->size);
#endif
    for (uint32_t i = 0; i < substeps; i++) {
        lined->loops->line_substep(lined, i + 1 == substeps);
        if (lined->is_fresh) end_start(lined);
    }
    if (CK_IS_SINGLE) follow(lined);
}

// A particle's number among places beside the cloth.
static int place_beside(const struct ck_LinedCloth *lined, int particle) {
    return (int)(particle / lined->columns * ck_line_places(lined)) + particle % lined->columns;
}

// m: where contact measures a particle's way from.
static double *from_at(const struct ck_LinedCloth *lined, int particle, int axis) {
    return lined->head.contact->from + ck_eight_tile(place_beside(lined, particle)) + axis * CK_EIGHT;
}

static void read_state(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    const struct ck_LinedCloth *lined = of(cloth);
    const double rate = lined->rule.keep / lined->rule.dt;
    for (int i = 0; i < 3 * lined->rows * lined->columns; i++) {
        const long at = place_of(lined, i / 3) + i % 3 * lined->plane;
        const double begun = CK_IS_SINGLE          ? lined->begun[at]
                             : lined->head.contact ? *from_at(lined, i / 3, i % 3)
                                                   : lined->start[at];
        position[i] = lined->x[at] + lined->origin[i % 3];
        if (CK_IS_SINGLE) position[i] += lined->start[at];
        velocity[i] = rate * (lined->x[at] - begun);
        before[i] = rate * lined->before[at];
    }
}

static void destroy(ck_ProjectedCloth *cloth) {
    free(of(cloth)->state);
    free(of(cloth)->is_fresh);
    free(cloth);
}

static ck_Real *take(ck_Real **next, long size) {
    ck_Real *taken = *next + CK_MARGIN;
    *next += size + CK_MARGIN;
    return taken;
}

// Rows and columns in whole squares, as they are turned. The margin right of a row is the one left of the next.
static void measure(struct ck_LinedCloth *lined) {
    const long rows = padded(lined->rows), columns = padded(lined->columns);
    lined->stride = columns + CK_MARGIN;
    lined->plane = rows * lined->stride;
    lined->turned_stride = rows;
    lined->multipliers = lined->plane > columns * rows ? lined->plane : columns * rows;
}

static bool allocate(struct ck_LinedCloth *lined) {
    const long columns = padded(lined->columns), tiles = 3 * CK_STRIPE * columns,
               longest = lined->rows > lined->columns ? lined->rows : lined->columns,
               multipliers = lined->terms & CK_LINE_REPEATED ? lined->multipliers : 0;
    const long arrays = (CK_IS_SINGLE ? 16 : 13) * lined->plane + lined->stride + columns * lined->turned_stride +
                        CK_LINE_KINDS * multipliers + 2 * tiles + CK_LINE_SCRATCH * longest;
    const size_t bytes = sizeof(ck_Real) * (size_t)(arrays + (12 + CK_LINE_KINDS) * CK_MARGIN);
    lined->state = aligned_alloc(sizeof(ck_Real) * CK_STRIPE, bytes);
    if (!lined->state) return false;
    memset(lined->state, 0, bytes);
    ck_Real *next = lined->state;
    // first, so that lines that begin beside the cloth begin in the block
    lined->before = take(&next, 3 * lined->plane);
    lined->x = take(&next, 3 * lined->plane);
    lined->start = take(&next, 3 * lined->plane);
    lined->flown = take(&next, 3 * lined->plane);
    lined->begun = take(&next, CK_IS_SINGLE ? 3 * lined->plane : 0);
    lined->weight = take(&next, lined->plane);
    lined->there = take(&next, lined->stride);
    lined->turned_weight = take(&next, columns * lined->turned_stride);
    lined->tiles = take(&next, tiles);
    lined->start_tiles = take(&next, tiles);
    lined->scratch = take(&next, CK_LINE_SCRATCH * longest);
    for (int kind = 0; kind < CK_LINE_KINDS; kind++) lined->multiplier[kind] = take(&next, multipliers);
    lined->is_fresh = malloc(sizeof *lined->is_fresh * (size_t)(lined->rows * lined->columns));
    return lined->is_fresh != NULL;
}

// Springs give way by rounding at least, or lines that reach straight from pin to pin would have no solution. Drag
// eases what a force moves in a substep, as the flight has it of the field: by (1 + carry)/2.
static ck_LineSprings springs_of(const ck_RowSprings *springs, ck_SpringKind kind, const ck_ProjectionRule *rule,
                                 double weight) {
    const double softness = rule->compliance > 0 ? rule->compliance : 1 / springs->stiffness[kind],
                 least = ROUNDING * weight;
    const double moved = 0.5 * (1 + rule->carry) * rule->dt * rule->dt,
                 compliance = fmax(softness / ((1 - CK_LINES_KEPT) * moved), least),
                 gamma = springs->damping * softness / rule->dt;
    return (ck_LineSprings){(ck_Real)fmax(compliance / (1 + gamma), least), (ck_Real)compliance, (ck_Real)gamma,
                            (ck_Real)(1 / (1 + gamma)), (ck_Real)springs->rest[kind]};
}

static void set_springs(struct ck_LinedCloth *lined, const ck_RowSprings *springs, double weight) {
    for (int kind = 0; kind < CK_LINE_KINDS; kind++) {
        const ck_SpringKind of = kind == CK_LINES_DOWN_RIGHT || kind == CK_LINES_DOWN_LEFT ? CK_SHEAR : CK_STRUCTURAL;
        if (springs->rest[of] > 0) lined->springs[kind] = springs_of(springs, of, &lined->rule, weight);
        if (lined->springs[kind].gamma > 0) lined->terms |= CK_LINE_DAMPED;
    }
}

// Places as they are, and as velocities say that they were. What moved before keeps its pulls.
static void start_moving(struct ck_LinedCloth *lined, const ck_ProjectionSetup *setup) {
    const double rate = lined->rule.keep / lined->rule.dt;
    const struct ck_LinedCloth *last = of(setup->last);
    for (int i = 0; i < lined->rows * lined->columns; i++) {
        const long at = place_of(lined, i);
        lined->weight[at] = (ck_Real)setup->inverse_mass[i];
        lined->turned_weight[i % lined->columns * lined->turned_stride + i / lined->columns] = lined->weight[at];
        const bool goes_on = last && last->weight[at] > 0 && !(last->is_fresh && last->is_fresh[i]);
        lined->is_fresh[i] = setup->inverse_mass[i] > 0 && !goes_on;
        for (int axis = 0; axis < 3; axis++) {
            const long one = at + axis * lined->plane;
            const double x = setup->position[3 * i + axis] - lined->origin[axis],
                         way = setup->velocity[3 * i + axis] / rate;
            lined->start[one] = (ck_Real)(CK_IS_SINGLE ? x : x - way);
            lined->x[one] = (ck_Real)(CK_IS_SINGLE ? x - lined->start[one] : x);
            if (CK_IS_SINGLE) lined->begun[one] = (ck_Real)(x - lined->start[one] - way);
            lined->flown[one] = lined->x[one] - (goes_on ? last->x[one] - last->flown[one] : 0);
            lined->before[one] = (ck_Real)(setup->before[3 * i + axis] / rate);
        }
    }
    for (int column = 0; column < lined->columns; column++) lined->there[column] = 1;
}

static ck_Status create(ck_ProjectedCloth **out, const ck_ProjectionSetup *setup, ck_Error *error) {
    const ck_Model *model = setup->model;
    const ck_ProjectionRule *rule = setup->rule;
    struct ck_LinedCloth *lined = calloc(1, sizeof *lined);
    if (!lined) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *lined = (struct ck_LinedCloth){.head.kind = &ck_projection_lines,
                                    .loops = setup->loops,
                                    .rule = *rule,
                                    .carried = rule->carry * rule->keep,
                                    .terms = rule->iterations > 1 ? CK_LINE_REPEATED : 0,
                                    .rows = model->particle_count / model->columns,
                                    .columns = model->columns,
                                    .size = model->size};
    if (CK_IS_SINGLE) memcpy(lined->origin, setup->position, sizeof lined->origin);
    for (int axis = 0; axis < 3; axis++) lined->push[axis] = rule->dt * rule->push[axis];
    set_springs(lined, setup->springs, 1 / model->mass[0]);
    measure(lined);
    if (!allocate(lined)) {
        destroy((ck_ProjectedCloth *)lined);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    start_moving(lined, setup);
    *out = (ck_ProjectedCloth *)lined;
    return CK_OK;
}

static int particle_at(const ck_ProjectedCloth *cloth, int place) {
    const struct ck_LinedCloth *lined = of(cloth);
    const int places = (int)ck_line_places(lined);
    return place / places * lined->columns + place % places;
}

// What moves starts as without contact.
static ck_Status touch(ck_ProjectedCloth *cloth, const ck_ProjectionSetup *setup, ck_Error *error) {
    struct ck_LinedCloth *lined = of(cloth);
    const ck_RowContact *beside = setup->beside;
    const ck_Follower follower = ck_projection_follower(cloth, &beside->follower);
    const long places = lined->rows * ck_line_places(lined);
#ifdef CK_SINGLE
    const ck_Status status = ck_sixteens_create(&lined->head, beside, &follower, places, error);
#else
    const ck_Status status =
        ck_row_contact_create(&lined->head.contact, beside->loops, &beside->touched, &follower, (int)places, error);
#endif
    for (int i = 0; i < lined->rows * lined->columns && !status; i++) {
        lined->head.contact->mass[place_beside(lined, i)] = beside->mass[i];
        for (int axis = 0; axis < 3 && !CK_IS_SINGLE; axis++)
            *from_at(lined, i, axis) = lined->start[place_of(lined, i) + axis * lined->plane];
    }
    return status;
}

const ck_ProjectionKind ck_projection_lines = {create, destroy, step, read_state, touch, particle_at};
