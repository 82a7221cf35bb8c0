#include "kernel_projection.h"

#include <math.h>
#include <stdlib.h>

// Sweeps that run interleaved: enough independent work for a processor that waits for each sweep's last result.
#define DEPTH 4
// Rows between a sweep and the next: neither then touches the other's, which are its row and those beside it.
#define LAG 3
// Vectors of a row beyond which it alone has work enough, and several would not stay in the first cache.
#define WIDE 10
// Vectors of springs that go through each operation together: a processor would not look far enough ahead to fill the
// wait for one's result with another's work.
#define GROUP 4

// One colour of a row's springs: no two of a colour share a particle. DOWN_LATE is the DOWN of the row above.
typedef enum Colour { ALONG_EVEN, ALONG_ODD, ALONG_LAST, DOWN, DOWN_RIGHT, DOWN_LEFT, DOWN_LATE } Colour;
#define COLOURS 6

// The order of a sweep at a row. Springs that come late do more than twice as much for a stretched cloth; bars where
// they are more than the freedoms they act on shake with it.
static const Colour orders[][COLOURS] = {
    [CK_PROJECT_BARS] = {ALONG_EVEN, ALONG_ODD, ALONG_LAST, DOWN, DOWN_RIGHT, DOWN_LEFT},
    [CK_PROJECT_SPRINGS] = {ALONG_EVEN, ALONG_ODD, ALONG_LAST, DOWN_RIGHT, DOWN_LEFT, DOWN_LATE},
};

// What project_springs needs of a kind of springs.
typedef struct Compliant {
    double compliance, gamma;   // α̃ and γ̃
    double one_free, both_free; // relaxation/((1 + γ̃)·W + α̃) with one end free, or both
} Compliant;

struct ck_ProjectedCloth {
    ck_Rows rows;
    ck_ProjectionRule rule;
    double lightness, rest[CK_SPRING_KINDS]; // 1/kg, m
    Compliant compliant[CK_SPRING_KINDS];
    int terms;
    long sweeps; // of this call
    double *x[3], *start[3], *v[3], *before[3], *is_free, *paired, *all;
    double *multiplier[DOWN_LATE + 1]; // NULL: one sweep starts from 0 and needs none
    bool *is_held;                     // [rows + 1] a pin in the row or the one below
    double *state, *pairs, *multipliers;
};

enum { DAMPED = 1, REPEATED = 2, BARS = 4, HELD = 8 };

typedef struct Ends {
    long a, b;
    ck_SpringKind kind;
    const double *paired; // 1 where there is a spring, else 0
    double *multiplier;
} Ends;

// 0 where one of two ends is free, 1 where both are or none: then none will move.
CK_INLINE ck_Lanes both_alike(const ck_ProjectedCloth *cloth, const Ends *ends) {
    ck_Lanes apart = ck_lanes_load(cloth->is_free + ends->a) - ck_lanes_load(cloth->is_free + ends->b);
    return 1 - apart * apart;
}

// x_a ← x_a + change, x_b ← x_b − change, where free.
CK_INLINE void move(const ck_ProjectedCloth *cloth, const Ends *ends, ck_Lanes3 change, const int terms) {
    ck_Lanes3 a = change, b = change;
    if (terms & HELD) {
        a = ck_lanes3_scale(ck_lanes_load(cloth->is_free + ends->a), change);
        b = ck_lanes3_scale(ck_lanes_load(cloth->is_free + ends->b), change);
    }
    ck_lanes3_store(cloth->x, ends->a, ck_lanes3_add(ck_lanes3_load(cloth->x, ends->a), a));
    ck_lanes3_store(cloth->x, ends->b, ck_lanes3_subtract(ck_lanes3_load(cloth->x, ends->b), b));
}

// Change, before masses: (l² − L²)/(4·(d·d_start)) along d_start, where masses cancel. A bar that turned by more than
// 60° in a substep is projected along itself instead.
CK_INLINE void project_bars(const ck_ProjectedCloth *cloth, const Ends *ends, const int count, const int terms) {
    const double quarter = 0.25 * cloth->rule.relaxation;
    ck_Lanes3 now[GROUP], old[GROUP];
    ck_Lanes scale[GROUP];
    for (int i = 0; i < count; i++) {
        now[i] = ck_lanes3_subtract(ck_lanes3_load(cloth->x, ends[i].b), ck_lanes3_load(cloth->x, ends[i].a));
        old[i] = ck_lanes3_subtract(ck_lanes3_load(cloth->start, ends[i].b), ck_lanes3_load(cloth->start, ends[i].a));
    }
    for (int i = 0; i < count; i++) {
        const double rest = cloth->rest[ends[i].kind], squared_rest = rest * rest;
        ck_Lanes along = ck_lanes3_dot(now[i], old[i]), squared = ck_lanes3_dot(now[i], now[i]);
        ck_LaneMask turned = along < (ck_Lanes){0} + 0.5 * squared_rest;
        old[i] = ck_lanes3_choose(turned, now[i], old[i]);
        along = ck_lanes_choose(turned, squared, along);
        ck_Lanes share = quarter * (squared - squared_rest);
        if (terms & HELD) share += share - share * both_alike(cloth, &ends[i]);
        scale[i] = ck_lanes_where(along > (ck_Lanes){0}, share / along);
        scale[i] *= ck_lanes_load(ends[i].paired);
    }
    for (int i = 0; i < count; i++) move(cloth, &ends[i], ck_lanes3_scale(scale[i], old[i]), terms);
}

CK_INLINE void project_springs(const ck_ProjectedCloth *cloth, const Ends *ends, const int count, const int terms) {
    ck_Lanes3 now[GROUP];
    ck_Lanes squared[GROUP], inverse[GROUP], change[GROUP];
    for (int i = 0; i < count; i++) {
        now[i] = ck_lanes3_subtract(ck_lanes3_load(cloth->x, ends[i].b), ck_lanes3_load(cloth->x, ends[i].a));
        squared[i] = ck_lanes3_dot(now[i], now[i]);
    }
    ck_lanes_inverse_root(inverse, squared, count);
    for (int i = 0; i < count; i++) {
        const Compliant *compliant = &cloth->compliant[ends[i].kind];
        ck_Lanes residual = squared[i] * inverse[i] - cloth->rest[ends[i].kind];
        if (terms & REPEATED) residual += compliant->compliance * ck_lanes_load(ends[i].multiplier);
        if (terms & DAMPED) {
            ck_Lanes3 old =
                ck_lanes3_subtract(ck_lanes3_load(cloth->start, ends[i].b), ck_lanes3_load(cloth->start, ends[i].a));
            residual += compliant->gamma * (ck_lanes3_dot(ck_lanes3_subtract(now[i], old), now[i]) * inverse[i]);
        }
        ck_Lanes share = (ck_Lanes){0} + compliant->both_free;
        if (terms & HELD)
            share = compliant->one_free + (compliant->both_free - compliant->one_free) * both_alike(cloth, &ends[i]);
        change[i] = ck_lanes_where(squared[i] > (ck_Lanes){0}, share * residual);
        change[i] *= ck_lanes_load(ends[i].paired);
    }
    for (int i = 0; i < count; i++) {
        if (terms & REPEATED) ck_lanes_store(ends[i].multiplier, ck_lanes_load(ends[i].multiplier) - change[i]);
        move(cloth, &ends[i], ck_lanes3_scale(cloth->lightness * (change[i] * inverse[i]), now[i]), terms);
    }
}

CK_INLINE Ends ends_of(const ck_ProjectedCloth *cloth, Colour colour, int row, int vector) {
    const long at = row * cloth->rows.stride, here = (long)vector * CK_LANES, below = at + cloth->rows.stride;
    const long right = ck_rows_right(&cloth->rows, vector, 1);
    double *multiplier = cloth->multiplier[colour] ? cloth->multiplier[colour] + at + here : NULL;
    const double *paired = cloth->paired + here;
    switch (colour) {
    case DOWN:
    case DOWN_LATE: return (Ends){at + here, below + here, CK_STRUCTURAL, cloth->all + here, multiplier};
    case DOWN_RIGHT: return (Ends){at + here, below + right, CK_SHEAR, paired, multiplier};
    case DOWN_LEFT: return (Ends){at + right, below + here, CK_SHEAR, paired, multiplier};
    default: return (Ends){at + here, at + right, CK_STRUCTURAL, paired, multiplier};
    }
}

// The vectors of a row that are of a colour: first, first + step … below end.
typedef struct Vectors {
    int first, step, end;
} Vectors;

CK_INLINE Vectors vectors_of(const ck_ProjectedCloth *cloth, Colour colour, int row) {
    const int span = cloth->rows.span;
    if (colour == ALONG_EVEN || colour == ALONG_ODD) return (Vectors){colour == ALONG_ODD, 2, span - 1};
    if (colour == ALONG_LAST) return (Vectors){span - 1, 1, span};
    bool is_there = row + 1 < cloth->rows.rows && (colour == DOWN || colour == DOWN_LATE || cloth->rest[CK_SHEAR] > 0);
    return (Vectors){0, 1, is_there ? span : 0};
}

CK_INLINE void project_vectors(const ck_ProjectedCloth *cloth, Colour colour, int row, Vectors vectors, const int count,
                               const int terms) {
    Ends ends[GROUP];
    for (int i = 0; i < count; i++) ends[i] = ends_of(cloth, colour, row, vectors.first + i * vectors.step);
    if (terms & BARS)
        project_bars(cloth, ends, count, terms);
    else
        project_springs(cloth, ends, count, terms);
}

CK_INLINE void project_row(const ck_ProjectedCloth *cloth, Colour colour, int row, const int terms) {
    Vectors vectors = vectors_of(cloth, colour, row);
    for (; vectors.first + (GROUP - 1) * vectors.step < vectors.end; vectors.first += GROUP * vectors.step)
        project_vectors(cloth, colour, row, vectors, GROUP, terms);
    for (; vectors.first < vectors.end; vectors.first += vectors.step)
        project_vectors(cloth, colour, row, vectors, 1, terms);
}

// The sweeps of a block, and the row at which each is in a wave.
typedef struct Wave {
    long first_sweep;
    int sweeps, wave;
} Wave;

CK_INLINE void project_colour(const ck_ProjectedCloth *cloth, const Wave *wave, int first, int end, Colour colour,
                              const int terms) {
    for (int i = first; i < end; i++) {
        int at = wave->wave - LAG * i, row = at - (colour == DOWN_LATE);
        if (row < 0 || at >= cloth->rows.rows) continue;
        if (cloth->is_held[row])
            project_row(cloth, colour, row, terms | HELD);
        else
            project_row(cloth, colour, row, terms);
    }
}

// x_start ← x;  x ← x + (carry·v + push)·dt
CK_INLINE void predict_row(const ck_ProjectedCloth *cloth, int row, bool is_last) {
    const long at = row * cloth->rows.stride, stride = cloth->rows.stride;
    const double dt = cloth->rule.dt, carry = cloth->rule.carry;
    for (int axis = 0; axis < 3; axis++) {
        const double push = cloth->rule.push[axis];
        for (long i = at; i < at + stride; i += CK_LANES) {
            ck_Lanes x = ck_lanes_load(cloth->x[axis] + i), v = ck_lanes_load(cloth->v[axis] + i);
            ck_lanes_store(cloth->start[axis] + i, x);
            ck_lanes_store(cloth->x[axis] + i, x + ck_lanes_load(cloth->is_free + i) * (dt * (carry * v + push)));
            if (is_last) ck_lanes_store(cloth->before[axis] + i, v);
        }
    }
    for (int colour = ALONG_LAST; colour <= DOWN_LEFT && cloth->multipliers; colour++)
        memset(cloth->multiplier[colour] + at, 0, sizeof(double) * (size_t)stride);
}

// v ← keep·(x − x_start)/dt
CK_INLINE void finish_row(const ck_ProjectedCloth *cloth, int row) {
    const long at = row * cloth->rows.stride;
    const double rate = cloth->rule.keep / cloth->rule.dt;
    for (int axis = 0; axis < 3; axis++)
        for (long i = at; i < at + cloth->rows.stride; i += CK_LANES)
            ck_lanes_store(cloth->v[axis] + i,
                           rate * (ck_lanes_load(cloth->x[axis] + i) - ck_lanes_load(cloth->start[axis] + i)));
}

// One loop for all colours: one for each takes a sixth less time and seven times as long to compile. Colour by colour,
// so that each sweep in flight has the others' work to wait with. A substep's first sweep finds the row below
// predicted; its last leaves the row above done.
CK_INLINE void run_colours(const ck_ProjectedCloth *cloth, const Wave *wave, const int terms) {
    for (int i = 0; i < wave->sweeps; i++) {
        long sweep = wave->first_sweep + i;
        int row = wave->wave - LAG * i;
        if (sweep % cloth->rule.iterations || row < 0 || row >= cloth->rows.rows) continue;
        bool is_last = sweep + cloth->rule.iterations >= cloth->sweeps;
        if (row == 0) predict_row(cloth, 0, is_last);
        if (row + 1 < cloth->rows.rows) predict_row(cloth, row + 1, is_last);
    }
    const int together = cloth->rows.span > WIDE ? 1 : wave->sweeps;
    for (int first = 0; first < wave->sweeps; first += together)
        for (int turn = 0; turn < COLOURS; turn++)
            project_colour(cloth, wave, first, first + together, orders[cloth->rule.projection][turn], terms);
    for (int i = 0; i < wave->sweeps; i++) {
        int row = wave->wave - LAG * i;
        if ((wave->first_sweep + i + 1) % cloth->rule.iterations || row < 0 || row >= cloth->rows.rows) continue;
        if (row > 0) finish_row(cloth, row - 1);
        if (row + 1 == cloth->rows.rows) finish_row(cloth, row);
    }
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
CK_KERNEL static void run_terms(const ck_ProjectedCloth *shared, const Wave *wave) {
    const ck_ProjectedCloth cloth = *shared;
    switch (cloth.terms) {
    case BARS: run_colours(&cloth, wave, BARS); break;
    case 0: run_colours(&cloth, wave, 0); break;
    case DAMPED: run_colours(&cloth, wave, DAMPED); break;
    case REPEATED: run_colours(&cloth, wave, REPEATED); break;
    default: run_colours(&cloth, wave, REPEATED | DAMPED); break;
    }
}

static void run_wave(void *state, long block, int wave) {
    const ck_ProjectedCloth *cloth = state;
    long first = block * DEPTH, left = cloth->sweeps - first;
    run_terms(cloth, &(Wave){first, left < DEPTH ? (int)left : DEPTH, wave});
}

void ck_projection_step(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    cloth->sweeps = (long)substeps * cloth->rule.iterations;
    // a block's first sweep reads the row below it as the last sweep of the block before left it
    ck_waves_run(waves, &(ck_WaveWork){run_wave, cloth, (cloth->sweeps + DEPTH - 1) / DEPTH,
                                       cloth->rows.rows + LAG * (DEPTH - 1), LAG * (DEPTH - 1) + 2});
}

void ck_projection_read(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before) {
    ck_rows_store(&cloth->rows, position, cloth->x);
    ck_rows_store(&cloth->rows, velocity, cloth->v);
    ck_rows_store(&cloth->rows, before, cloth->before);
}

void ck_projection_destroy(ck_ProjectedCloth *cloth) {
    if (!cloth) return;
    free(cloth->state);
    free(cloth->pairs);
    free(cloth->multipliers);
    free(cloth->is_held);
    free(cloth);
}

bool ck_projection_fits(const ck_Model *model, ck_RowSprings *springs) {
    return !model->collider_count && ck_rows_fit(model, springs) && springs->rest[CK_BEND] == 0;
}

static void set_rule(ck_ProjectedCloth *cloth, const ck_RowSprings *springs, const ck_ProjectionRule *rule) {
    const double light = cloth->lightness, dt = rule->dt;
    bool is_elastic =
        rule->projection == CK_PROJECT_SPRINGS && (rule->compliance > 0 || isfinite(springs->stiffness[CK_STRUCTURAL]));
    cloth->rule = *rule;
    cloth->terms = rule->projection == CK_PROJECT_BARS ? BARS : 0;
    if (is_elastic) cloth->terms |= (springs->damping > 0 ? DAMPED : 0) | (rule->iterations > 1 ? REPEATED : 0);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        Compliant *compliant = &cloth->compliant[kind];
        cloth->rest[kind] = springs->rest[kind];
        if (springs->rest[kind] == 0) continue;
        double stiffness = rule->compliance > 0 ? 1 / rule->compliance : springs->stiffness[kind];
        compliant->compliance = 1 / (stiffness * dt * dt);
        compliant->gamma = springs->damping / (stiffness * dt);
        compliant->one_free = rule->relaxation / ((1 + compliant->gamma) * light + compliant->compliance);
        compliant->both_free = rule->relaxation / ((1 + compliant->gamma) * 2 * light + compliant->compliance);
    }
}

static void place_arrays(ck_ProjectedCloth *cloth) {
    const size_t size = cloth->rows.size;
    double **const groups[] = {cloth->x, cloth->start, cloth->v, cloth->before};
    for (size_t group = 0; group < 4; group++)
        for (size_t axis = 0; axis < 3; axis++) groups[group][axis] = cloth->state + size * (3 * group + axis);
    cloth->is_free = cloth->state + size * 12;
    cloth->paired = cloth->pairs;
    cloth->all = cloth->pairs + cloth->rows.stride;
    // the colours along a row have the row's vectors between them
    for (int colour = 0; colour <= DOWN_LEFT && cloth->multipliers; colour++)
        cloth->multiplier[colour] = cloth->multipliers + size * (size_t)(colour > ALONG_LAST ? colour - ALONG_LAST : 0);
    cloth->multiplier[DOWN_LATE] = cloth->multiplier[DOWN];
}

// Marks what is free; a row is held where it or the one below has a pin.
static void mark_free(ck_ProjectedCloth *cloth, const double *inverse_mass) {
    const ck_Rows *rows = &cloth->rows;
    for (int i = 0; i < rows->rows * rows->columns; i++) {
        int row = i / rows->columns;
        cloth->is_free[ck_rows_at(rows, row, i % rows->columns)] = inverse_mass[i] > 0;
        if (inverse_mass[i] > 0) continue;
        cloth->is_held[row] = true;
        if (row > 0) cloth->is_held[row - 1] = true;
    }
}

ck_Status ck_projection_create(ck_ProjectedCloth **out, const ck_Model *model, const ck_RowSprings *springs,
                               const ck_ProjectionRule *rule, const double *position, const double *velocity,
                               const double *before, const double *inverse_mass, ck_Error *error) {
    ck_ProjectedCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    cloth->rows = ck_rows_of(model);
    cloth->lightness = 1 / model->mass[0];
    set_rule(cloth, springs, rule);
    const ck_Rows row = {.size = (size_t)cloth->rows.stride};
    cloth->state = ck_rows_allocate(&cloth->rows, 13);
    cloth->pairs = ck_rows_allocate(&row, 2);
    cloth->multipliers = cloth->terms & REPEATED ? ck_rows_allocate(&cloth->rows, 4) : NULL;
    cloth->is_held = calloc((size_t)cloth->rows.rows, sizeof *cloth->is_held);
    if (!cloth->state || !cloth->pairs || !cloth->is_held || ((cloth->terms & REPEATED) && !cloth->multipliers)) {
        ck_projection_destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    place_arrays(cloth);
    mark_free(cloth, inverse_mass);
    ck_rows_mark_paired(&cloth->rows, 1, cloth->paired);
    ck_rows_mark_paired(&cloth->rows, 0, cloth->all);
    ck_rows_load(&cloth->rows, cloth->x, position);
    ck_rows_load(&cloth->rows, cloth->v, velocity);
    ck_rows_load(&cloth->rows, cloth->before, before);
    *out = cloth;
    return CK_OK;
}

typedef struct Visit {
    long when;
    int spring;
} Visit;

static int compare_visits(const void *a, const void *b) {
    long x = ((const Visit *)a)->when, y = ((const Visit *)b)->when;
    return (x > y) - (x < y);
}

// When a sweep comes to a spring: by the row it is at, colour, vector and lane.
static long when_visited(const ck_Rows *rows, ck_Projection projection, const ck_Spring *spring) {
    int row = spring->a / rows->columns, right = spring->b % rows->columns - spring->a % rows->columns;
    int column = spring->a % rows->columns - (right < 0), vector = column % rows->span;
    bool is_late = projection == CK_PROJECT_SPRINGS;
    Colour colour = is_late ? DOWN_LATE : DOWN;
    if (spring->kind == CK_SHEAR) colour = right > 0 ? DOWN_RIGHT : DOWN_LEFT;
    if (spring->b / rows->columns == row) colour = vector + 1 == rows->span ? ALONG_LAST : vector % 2;
    // the colours' numbers have the order of either sweep
    return ((row + (colour == DOWN_LATE)) * (DOWN_LATE + 1) + colour) * rows->stride + ck_rows_at(rows, 0, column);
}

ck_Status ck_sweep_order(const ck_Model *model, ck_Projection projection, int *order) {
    ck_RowSprings springs;
    for (int i = 0; i < model->spring_count; i++) order[i] = i;
    if (!ck_projection_fits(model, &springs)) return CK_OK;
    const ck_Rows rows = ck_rows_of(model);
    Visit *visits = malloc(sizeof *visits * (size_t)model->spring_count);
    if (!visits) return CK_NO_MEMORY;
    for (int i = 0; i < model->spring_count; i++)
        visits[i] = (Visit){when_visited(&rows, projection, &model->springs[i]), i};
    qsort(visits, (size_t)model->spring_count, sizeof *visits, compare_visits);
    for (int i = 0; i < model->spring_count; i++) order[i] = visits[i].spring;
    free(visits);
    return CK_OK;
}
