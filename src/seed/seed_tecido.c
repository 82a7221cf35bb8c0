// Source: N. Paes Leme, INF1608, "Tecido" (Unity, C#), rebuilt from its description.
#include "seed.h"

#include "engine.h"
#include "own_ledger.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Sweeps over the bars before the first step, and in each step where the user does not say.
#define SWEEPS_BEFORE 50
#define SWEEPS_USUAL 5

const char *const ck_tecido_quirk_names[CK_TECIDO_QUIRK_COUNT] = {
    "half correction at a lock",
    "bars ignore mass",
    "step length not rescaled",
    "stale velocity when unlocked",
    "bars corrected along their new direction",
    "kinds of bars interleaved",
    "sweeps run one way",
};

typedef struct Bar {
    int a, b;
    double rest;
    long order; // its place in a sweep
} Bar;

struct ck_Tecido {
    const ck_Model *model;
    uint32_t substeps, sweeps, mended;
    double *position, *before, *start; // [3*n] now, one step ago, at the start of this step
    double last;                       // s, length of the last step
    bool *locked;                      // [n]
    Bar *bars;
    int bar_count;
};

// A cloth's bars as its loops make them: for each node, column by column, down, diagonal (+1, −1), right, diagonal
// (+1, +1); sorted by kind where that is mended. Other bodies keep their own order.
static long order_of(const ck_Model *model, const ck_Spring *spring, int index, bool sorted) {
    if (model->body != CK_CLOTH) return index;
    int column_a = spring->a % model->columns, column_b = spring->b % model->columns;
    int row_a = spring->a / model->columns, row_b = spring->b / model->columns;
    bool swap = column_b < column_a;
    int column = swap ? column_b : column_a, row = swap ? row_b : row_a;
    int right = abs(column_b - column_a), down = swap ? row_a - row_b : row_b - row_a;
    int kind = right == 0 ? 0 : down < 0 ? 1 : down == 0 ? 2 : 3;
    long node = (long)column * (model->particle_count / model->columns) + row;
    return sorted ? (long)kind * model->particle_count + node : 4 * node + kind;
}

static int compare_bars(const void *a, const void *b) {
    long x = ((const Bar *)a)->order, y = ((const Bar *)b)->order;
    return (x > y) - (x < y);
}

static bool is_mended(const ck_Tecido *tecido, ck_TecidoQuirk quirk) {
    return tecido->mended & quirk;
}

// The shares of a bar's error that its ends take; 0 and 0 where both are locked.
static void shares(const ck_Tecido *tecido, const Bar *bar, double *a, double *b) {
    double weight_a = 0.5, weight_b = 0.5;
    if (is_mended(tecido, CK_TECIDO_MASSLESS_BARS)) {
        double mass_a = tecido->model->mass[bar->a], mass_b = tecido->model->mass[bar->b];
        weight_a = mass_b / (mass_a + mass_b);
        weight_b = mass_a / (mass_a + mass_b);
    }
    bool full = is_mended(tecido, CK_TECIDO_HALF_CORRECTION);
    bool locked_a = tecido->locked[bar->a], locked_b = tecido->locked[bar->b];
    *a = locked_a ? 0 : locked_b && full ? 1 : weight_a;
    *b = locked_b ? 0 : locked_a && full ? 1 : weight_b;
}

// Moves both ends until the bar has its length: along itself, or along where it lay at the start of the step.
static void correct(ck_Tecido *tecido, const Bar *bar) {
    double *a = tecido->position + 3 * bar->a, *b = tecido->position + 3 * bar->b, now[3], along[3], share_a, share_b;
    shares(tecido, bar, &share_a, &share_b);
    ck_subtract(now, b, a);
    double length = ck_length(now), scale = 1 - bar->rest / length;
    memcpy(along, now, sizeof along);
    if (is_mended(tecido, CK_TECIDO_NEW_DIRECTION)) {
        double old[3];
        ck_subtract(old, tecido->start + 3 * bar->b, tecido->start + 3 * bar->a);
        double projected = ck_dot(now, old);
        // a bar that turned by more than 60° is corrected along itself
        if (projected > 0.5 * length * ck_length(old)) {
            memcpy(along, old, sizeof along);
            scale = 0.5 * (length * length - bar->rest * bar->rest) / projected;
        }
    }
    ck_add_scaled(a, share_a * scale, along);
    ck_add_scaled(b, -share_b * scale, along);
}

static void sweep(ck_Tecido *tecido, uint32_t count) {
    for (uint32_t n = 0; n < count; n++) {
        bool back = is_mended(tecido, CK_TECIDO_ONE_WAY) && n % 2;
        for (int i = 0; i < tecido->bar_count; i++)
            correct(tecido, &tecido->bars[back ? tecido->bar_count - 1 - i : i]);
    }
}

void ck_tecido_step(ck_Tecido *tecido, double h) {
    const ck_Model *model = tecido->model;
    bool rescaled = is_mended(tecido, CK_TECIDO_UNSCALED_STEP);
    double keep = rescaled ? h / tecido->last : 1, push = rescaled ? 0.5 * h * (h + tecido->last) : h * h;
    memcpy(tecido->start, tecido->position, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        double *x = tecido->position + 3 * i, *before = tecido->before + 3 * i, field[3];
        if (tecido->locked[i]) continue;
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++) {
            double now = x[axis];
            x[axis] += keep * (now - before[axis]) + push * field[axis];
            before[axis] = now;
        }
    }
    sweep(tecido, tecido->sweeps);
    tecido->last = h;
}

void ck_tecido_lock(ck_Tecido *tecido, int particle, bool locked) {
    tecido->locked[particle] = locked;
    if (is_mended(tecido, CK_TECIDO_STALE_VELOCITY))
        memcpy(tecido->before + 3 * particle, tecido->position + 3 * particle, 3 * sizeof(double));
}

const double *ck_tecido_position(const ck_Tecido *tecido) {
    return tecido->position;
}

void ck_tecido_velocity(const ck_Tecido *tecido, double *velocity) {
    for (int i = 0; i < 3 * tecido->model->particle_count; i++)
        velocity[i] = tecido->locked[i / 3] ? 0 : (tecido->position[i] - tecido->before[i]) / tecido->last;
}

void ck_tecido_destroy(ck_Tecido *tecido) {
    if (!tecido) return;
    free(tecido->position);
    free(tecido->before);
    free(tecido->start);
    free(tecido->locked);
    free(tecido->bars);
    free(tecido);
}

static void set_start(ck_Tecido *tecido) {
    const ck_Model *model = tecido->model;
    size_t count = (size_t)model->particle_count;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        tecido->bars[tecido->bar_count++] = (Bar){spring->a, spring->b, spring->rest,
                                                  order_of(model, spring, i, is_mended(tecido, CK_TECIDO_INTERLEAVED))};
    }
    qsort(tecido->bars, (size_t)tecido->bar_count, sizeof *tecido->bars, compare_bars);
    memcpy(tecido->locked, model->pinned, count * sizeof(bool));
    memcpy(tecido->position, model->position, 3 * count * sizeof(double));
    memcpy(tecido->start, model->position, 3 * count * sizeof(double));
    if (model->body == CK_CLOTH) sweep(tecido, SWEEPS_BEFORE);
    memcpy(tecido->before, tecido->position, 3 * count * sizeof(double));
    for (int i = 0; i < model->particle_count; i++)
        if (!model->pinned[i]) ck_add_scaled(tecido->before + 3 * i, -tecido->last, model->velocity + 3 * i);
}

ck_Status ck_tecido_create(ck_Tecido **out, const ck_Model *model, const ck_Settings *used, ck_Error *error) {
    size_t count = (size_t)model->particle_count, bytes = 3 * count * sizeof(double);
    ck_Tecido *tecido = calloc(1, sizeof *tecido);
    if (!tecido) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *tecido = (ck_Tecido){.model = model,
                          .substeps = used->substeps,
                          .sweeps = used->iterations,
                          .mended = (uint32_t)used->own[CK_TECIDO_MENDED],
                          .last = model->step / used->substeps,
                          .position = malloc(bytes),
                          .before = malloc(bytes),
                          .start = malloc(bytes),
                          .locked = malloc(count * sizeof(bool)),
                          .bars = malloc(sizeof(Bar) * ((size_t)model->spring_count + 1))};
    if (!tecido->position || !tecido->before || !tecido->start || !tecido->locked || !tecido->bars) {
        ck_tecido_destroy(tecido);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    set_start(tecido);
    *out = tecido;
    return CK_OK;
}

static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : 1,
                          .iterations = wanted->iterations ? wanted->iterations : SWEEPS_USUAL};
    ck_settings_take_own(used, wanted);
    uint32_t mended = (uint32_t)used->own[CK_TECIDO_MENDED];
    ck_own_ledger(ledger, model, used, "", CK_EXACT);
    bool rigid = model->terms & CK_TERM_RIGID;
    ck_own_ledger_springs(ledger, model, "bar", rigid ? "relaxed by sweeps" : "a bar does not stretch",
                          rigid ? CK_APPROXIMATE : CK_IMPOSSIBLE);
    for (int i = 0; i < CK_TECIDO_QUIRK_COUNT; i++)
        ck_ledger_add(ledger, (ck_LedgerRow){"physics", 1, "1", ck_tecido_quirk_names[i], mended >> i & 1,
                                             "a quirk of the original; 1 where mended",
                                             mended >> i & 1 ? CK_EXACT : CK_IMPOSSIBLE});
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    translate(model, wanted, used, ledger);
    return ck_tecido_create((ck_Tecido **)state, model, used, error);
}

static ck_StepResult step(void *state) {
    ck_Tecido *tecido = state;
    double sum = 0;
    for (uint32_t i = 0; i < tecido->substeps; i++) ck_tecido_step(tecido, tecido->model->step / tecido->substeps);
    for (int i = 0; i < 3 * tecido->model->particle_count; i++) sum += tecido->position[i] * 0;
    return sum == 0 ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static void read_state(const void *state, double *position, double *velocity) {
    const ck_Tecido *tecido = state;
    memcpy(position, tecido->position, 3 * sizeof(double) * (size_t)tecido->model->particle_count);
    ck_tecido_velocity(tecido, velocity);
}

static void release(void *state, int particle) {
    ck_tecido_lock(state, particle, false);
}

static void destroy(void *state) {
    ck_tecido_destroy(state);
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "5",
     .help = "sweeps over all bars"},
    {.name = "mended",
     .slot = CK_OWN + CK_TECIDO_MENDED,
     .is_whole = true,
     .least = 0,
     .most = 1e6,
     .unit = "1",
     .rule = "0: none",
     .help = "quirks to leave out, added up as clothcheck list counts them"},
    {0},
};

const ck_Engine ck_seed_tecido = {
    .name = "seed-tecido",
    .about = "the first origin as it was: Verlet and rigid bars, five sweeps, locked ends half corrected",
    .family = "seed",
    .version = ck_own_version,
    .method = CK_METHOD_SEED,
    .terms = CK_TERM_SPRINGS | CK_TERM_RIGID | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_VELOCITY | CK_TERM_RELEASE,
    .settings = settings,
    .order = 0,
    .create = create,
    .step = step,
    .read = read_state,
    .release = release,
    .destroy = destroy,
};
