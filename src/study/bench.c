#include "bench.h"

#include "bench_body.h"
#include "bench_cost.h"
#include "bench_processor.h"
#include "bench_row.h"
#include "csv_child.h"
#include "engines.h"
#include "loops.h"
#include "names.h"
#include "process.h"
#include "springs.h"
#include "statistics.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_SIZES 16 // of a growing cloth, whose side doubles
// How long a repeat lasts at least, s: far above the clock's grain.
#define REPEAT 0.02
// Frames in which threads wake and find out whether they gain, before they are timed.
#define CHOICE 16
// Sweeps that a start may take to the strain that is asked for.
#define MOST_SWEEPS 4096
#define STRAIN 0.04

static const ck_BenchBody bodies[] = {
    {"cloth", CK_BENCH_CLOTH, 20, 20},     {"cloth", CK_BENCH_CLOTH, 64, 64},  {"cloth", CK_BENCH_CLOTH, 256, 256},
    {"rope", CK_BENCH_ROPE, 1000, 1},      {"ropes", CK_BENCH_ROPES, 32, 128}, {"mesh", CK_BENCH_MESH, 17, 17},
    {"mesh", CK_BENCH_MESH, 55, 55},       {"mesh", CK_BENCH_MESH, 173, 173},  {"on_ball", CK_BENCH_ON_BALL, 20, 20},
    {"on_ball", CK_BENCH_ON_BALL, 64, 64},
};
#define BODIES (sizeof bodies / sizeof *bodies)

// Operations of a row kernel on a regular cloth with shear, as a processor's arithmetic units issue them for a lane:
// products, sums, both fused, shifts and comparisons. What marks springs that are there counts with the particle;
// bars are marked by their constants.
typedef struct Work {
    double spring, particle;
} Work;

// Engines and set-ups. What projects is given ten iterations, but lines one; beside: the native engine whose updates
// are the measure.
typedef struct Candidate {
    const char *engine, *setup;
    ck_Settings settings;
    int beside;
    Work work; // 0: not counted
    bool is_damped;
    const char *own; // a setting of the engine's own, NULL: none; and its value
    double value;
} Candidate;

enum { VERLET, BARS, XPBD, VERLET_2, BARS_2, XPBD_2 };

static const Candidate candidates[] = {
    [VERLET] = {"native-verlet", "", {0}, VERLET, .work = {25, 12}},
    [BARS] = {"native-bars", "10 iterations", {.iterations = 10}, BARS, .work = {17, 9}},
    [XPBD] = {"native-xpbd", "10 iterations", {.iterations = 10}, BARS},
    [VERLET_2] = {"native-verlet", "2 threads", {.threads = 2}, VERLET},
    [BARS_2] = {"native-bars", "10 iterations, 2 threads", {.iterations = 10, .threads = 2}, BARS},
    [XPBD_2] = {"native-xpbd", "10 iterations, 2 threads", {.iterations = 10, .threads = 2}, XPBD},
    {"native-lines", "1 iteration", {.iterations = 1}, BARS},
    {"native-verlet", "vectors of 4", {0}, VERLET, .own = "vectors", .value = 4},
    {"native-bars", "10 iterations, vectors of 4", {.iterations = 10}, BARS, .own = "vectors", .value = 4},
    {"native-xpbd", "10 iterations, vectors of 4", {.iterations = 10}, XPBD, .own = "vectors", .value = 4},
    {"native-lines", "1 iteration, vectors of 4", {.iterations = 1}, BARS, .own = "vectors", .value = 4},
    {"native-verlet", "vectors of 2", {0}, VERLET, .own = "vectors", .value = 2},
    {"native-bars", "10 iterations, vectors of 2", {.iterations = 10}, BARS, .own = "vectors", .value = 2},
    {"native-xpbd", "10 iterations, vectors of 2", {.iterations = 10}, XPBD, .own = "vectors", .value = 2},
    {"native-verlet", "single precision", {0}, VERLET, .own = "single", .value = 1},
    {"native-bars", "10 iterations, single precision", {.iterations = 10}, BARS, .own = "single", .value = 1},
    {"native-xpbd", "10 iterations, single precision", {.iterations = 10}, XPBD, .own = "single", .value = 1},
    {"native-lines", "1 iteration, single precision", {.iterations = 1}, BARS, .own = "single", .value = 1},
    {"native-verlet", "springs damped, drag", {0}, VERLET, .work = {33, 19}, .is_damped = true},
    {"native-xpbd", "10 iterations, relaxation 1.3", {.iterations = 10, .relaxation = 1.3}, BARS},
    {"native-rope", "4 iterations", {.iterations = 4}, BARS},
    {"seed-tecido", "10 iterations", {.iterations = 10}, BARS},
    {"seed-cloth", "", {0}, VERLET},
    {"bullet-pbd", "10 iterations", {.iterations = 10}, BARS},
    {"bullet-pbd", "10 iterations, reordered", {.iterations = 10}, BARS, .own = "reordered", .value = 1},
    {"bullet-explicit", "", {0}, VERLET},
    {"bullet-implicit", "", {0}, VERLET},
    {"ode-quick", "10 iterations", {.iterations = 10}, BARS},
};
#define CANDIDATES (sizeof candidates / sizeof *candidates)

typedef struct Entrant {
    const ck_Engine *engine;
    const Candidate *candidate;
    void *state;
    int frames;                        // of a repeat
    double times[CK_BENCH_MAX_ROUNDS]; // s a step, by round
    int count;
    char reason[200]; // why there is no time; empty: there is
} Entrant;

// Time of a substep, s: CPU time, but of threads that share it wall time.
static double time_frames(Entrant *entrant, int frames) {
    double (*clock)(void) = entrant->candidate->settings.threads > 1 ? ck_wall : ck_thread_cpu;
    double start = clock();
    for (int i = 0; i < frames && !*entrant->reason; i++)
        if (entrant->engine->step(entrant->state) != CK_STEP_OK)
            snprintf(entrant->reason, sizeof entrant->reason, "did not get through its steps");
    return (clock() - start) / frames / CK_BENCH_SUBSTEPS;
}

static void time_round(Entrant *entrant) {
    if (entrant->candidate->settings.threads > 1) time_frames(entrant, CHOICE);
    entrant->times[entrant->count++] = time_frames(entrant, entrant->frames);
}

static bool sets(const Candidate *candidate, const char *own) {
    return candidate->own && !strcmp(candidate->own, own);
}

static void create(Entrant *entrant, const ck_Model *model, ck_Settings wanted) {
    const Candidate *candidate = entrant->candidate;
    if (candidate->own)
        ck_settings_set(&wanted, ck_setting_find(entrant->engine->settings, candidate->own)->slot, candidate->value);
    ck_Settings used;
    ck_Error why = {0};
    if (ck_engine_lacks(entrant->engine, model))
        snprintf(entrant->reason, sizeof entrant->reason, "does not model it");
    else if (ck_engine_create(entrant->engine, &entrant->state, model, &wanted, &used, NULL, &why))
        snprintf(entrant->reason, sizeof entrant->reason, "%.199s", why.message);
    if (*entrant->reason) entrant->state = NULL;
}

// Creates an engine's world and finds how many frames make a repeat.
static void enter(Entrant *entrant, const Candidate *candidate, const ck_Model *model, const ck_BenchOptions *options) {
    *entrant = (Entrant){.engine = ck_engine_find(candidate->engine), .candidate = candidate};
    ck_Settings wanted = candidate->settings;
    wanted.substeps = CK_BENCH_SUBSTEPS;
    create(entrant, model, wanted);
    if (sets(candidate, "vectors") && (candidate->value >= ck_loops_at(0)->lanes))
        snprintf(entrant->reason, sizeof entrant->reason, "no other than without that setting");
    if (*entrant->reason) return;
    const double once = CK_BENCH_SUBSTEPS * time_frames(entrant, 1);
    entrant->frames = (int)fmax(1, ceil(REPEAT / fmax(once, 1e-9)));
    if (once > options->budget)
        snprintf(entrant->reason, sizeof entrant->reason, "one frame takes longer than the budget");
}

static double updates_of(const Entrant *entrant, const ck_Model *model) {
    uint32_t iterations = entrant->candidate->settings.iterations;
    return (double)model->spring_count * (iterations ? iterations : 1);
}

// This engine's time over that of the native one, an update of each, round by round; of threads the gain.
static void add_ratio(ck_Csv *csv, const ck_BenchBody *body, const ck_Model *model, const Entrant *entrant,
                      const Entrant *native) {
    double ratios[CK_BENCH_MAX_ROUNDS], quartiles[3];
    bool is_shared = entrant->candidate->settings.threads > 1;
    if (entrant == native || *native->reason || !native->count) return;
    for (int i = 0; i < entrant->count; i++) {
        ratios[i] = entrant->times[i] / native->times[i] * updates_of(native, model) / updates_of(entrant, model);
        if (is_shared) ratios[i] = 1 / ratios[i];
    }
    ck_bench_quartiles(ratios, entrant->count, quartiles);
    ck_bench_add_row(csv, body, model, entrant->engine->name, entrant->candidate->setup,
                     is_shared ? "speedup_of_threads" : "update_over_native", "1", quartiles, 1, NULL);
}

// The share of the processor's peak that the row kernels reach: on cloths, with one thread.
static void add_share(ck_Csv *csv, const ck_BenchBody *body, const ck_Model *model, const Entrant *entrant, double peak,
                      const double *quartiles) {
    const Work *each = &entrant->candidate->work;
    if (body->kind != CK_BENCH_CLOTH || each->spring == 0 || !ck_loops_at(0)->fuses) return;
    double work = each->spring * updates_of(entrant, model) + each->particle * (double)model->particle_count;
    const double shares[3] = {work / peak / quartiles[0], work / peak / quartiles[2], work / peak / quartiles[1]};
    ck_bench_add_row(csv, body, model, entrant->engine->name, entrant->candidate->setup, "share_of_peak", "1", shares,
                     1, NULL);
}

static void add_entrant(ck_Csv *csv, const ck_BenchBody *body, const ck_Model *model, const Entrant *entrant,
                        const Entrant *native, double peak) {
    const char *name = entrant->engine->name, *setup = entrant->candidate->setup;
    if (*entrant->reason || !entrant->count) {
        ck_bench_add_row(csv, body, model, name, setup, "step_time", "s", NULL, 1, entrant->reason);
        return;
    }
    double quartiles[3];
    ck_bench_quartiles(entrant->times, entrant->count, quartiles);
    ck_bench_add_row(csv, body, model, name, setup, "step_time", "s", quartiles, 1, NULL);
    ck_bench_add_row(csv, body, model, name, setup, "update_time", "ns", quartiles, 1e9 / updates_of(entrant, model),
                     NULL);
    add_ratio(csv, body, model, entrant, native);
    add_share(csv, body, model, entrant, peak, quartiles);
}

static void leave(Entrant *entrants, size_t count) {
    for (size_t i = 0; i < count && entrants; i++)
        if (entrants[i].state) entrants[i].engine->destroy(entrants[i].state);
    free(entrants);
}

// All engines on one body, in rounds: a slow spell of the machine hits all alike.
static ck_Status race(ck_Csv *csv, const ck_BenchBody *body, const ck_BenchOptions *options, double peak,
                      ck_Error *error) {
    ck_Model models[2] = {0}; // undamped, damped
    Entrant *entrants = calloc(CANDIDATES, sizeof *entrants);
    ck_Status status =
        entrants ? ck_bench_body_build(&models[0], body, false, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_bench_body_build(&models[1], body, true, error);
    for (size_t i = 0; i < CANDIDATES && !status; i++) {
        if (options->progress) options->progress(body->name, candidates[i].engine);
        enter(&entrants[i], &candidates[i], &models[candidates[i].is_damped], options);
    }
    for (int round = 0; round < options->rounds && !status; round++)
        for (size_t i = 0; i < CANDIDATES; i++)
            if (!*entrants[i].reason) time_round(&entrants[i]);
    for (size_t i = 0; i < CANDIDATES && !status; i++)
        add_entrant(csv, body, &models[0], &entrants[i], &entrants[candidates[i].beside], peak);
    leave(entrants, CANDIDATES);
    ck_model_free(&models[0]);
    ck_model_free(&models[1]);
    return status;
}

// What a simulated second costs where each engine's own rules set its step, on the body as it is let go.
static ck_Status add_seconds(ck_Csv *csv, const ck_BenchBody *body, const ck_BenchOptions *options, ck_Error *error) {
    ck_Model model = {0};
    ck_Status status = ck_bench_body_build(&model, body, false, error);
    for (int i = 0; i < ck_engine_count() && !status; i++) {
        Candidate automatic = {.engine = ck_engine_at(i)->name, .setup = "automatic"};
        Entrant entrant = {.engine = ck_engine_at(i), .candidate = &automatic};
        if (entrant.engine->method == CK_METHOD_STILL) continue;
        if (options->progress) options->progress(body->name, automatic.engine);
        create(&entrant, &model, automatic.settings);
        double spent = 0;
        while (!*entrant.reason && spent < 10 * REPEAT && entrant.count < CK_BENCH_MAX_ROUNDS) {
            double once = CK_BENCH_SUBSTEPS * time_frames(&entrant, 1);
            spent += once;
            entrant.times[entrant.count++] = once / model.step;
        }
        double quartiles[3];
        if (entrant.count) ck_bench_quartiles(entrant.times, entrant.count, quartiles);
        ck_bench_add_row(csv, body, &model, automatic.engine, automatic.setup, "second_time", "s/s",
                         *entrant.reason ? NULL : quartiles, 1, entrant.reason);
        if (entrant.state) entrant.engine->destroy(entrant.state);
    }
    ck_model_free(&model);
    return status;
}

// One step of so many sweeps from the model's start: the strain that is left, and the CPU time; NaN where it fails.
static double sweep_start(const Candidate *candidate, const ck_Model *model, uint32_t sweeps, double *seconds) {
    Entrant entrant = {.engine = ck_engine_find(candidate->engine), .candidate = candidate};
    ck_Settings wanted = candidate->settings;
    wanted.substeps = 1;
    wanted.iterations = sweeps;
    create(&entrant, model, wanted);
    *seconds = NAN;
    if (*entrant.reason) return NAN;
    double *state = malloc(6 * sizeof *state * (size_t)model->particle_count), strain = NAN;
    *seconds = CK_BENCH_SUBSTEPS * time_frames(&entrant, 1);
    if (state && !*entrant.reason) {
        entrant.engine->read(entrant.state, state, state + 3 * model->particle_count);
        strain = ck_springs_rms_strain(model, state);
    }
    entrant.engine->destroy(entrant.state);
    free(state);
    return strain;
}

// The fewest sweeps that leave no more than STRAIN; 0 where MOST_SWEEPS do not.
static uint32_t find_sweeps(const Candidate *candidate, const ck_Model *model) {
    double seconds;
    uint32_t enough = 1, few = 0;
    while (enough <= MOST_SWEEPS && !(sweep_start(candidate, model, enough, &seconds) <= STRAIN)) {
        few = enough;
        enough *= 2;
    }
    while (enough <= MOST_SWEEPS && enough - few > 1) {
        uint32_t middle = (few + enough) / 2;
        if (sweep_start(candidate, model, middle, &seconds) <= STRAIN)
            enough = middle;
        else
            few = middle;
    }
    return enough <= MOST_SWEEPS ? enough : 0;
}

// A cloth of rigid bars that starts 10 % too long, hung by its upper corners, without gravity: the time to 4 % strain.
static ck_Status build_stretched(ck_Model *model, const ck_BenchBody *body, ck_Error *error) {
    ck_Status status = ck_bench_body_build(model, body, false, error);
    for (int i = 0; i < model->spring_count && !status; i++) {
        model->springs[i].rest /= 1.1;
        model->springs[i].stiffness = INFINITY;
    }
    memset(model->gravity, 0, sizeof model->gravity);
    model->terms = CK_TERM_SPRINGS | CK_TERM_RIGID;
    return status;
}

// What projects, by one thread and with the vectors that there are: the rest take as many sweeps.
static bool has_residual(const Candidate *candidate) {
    return candidate->settings.iterations && !candidate->settings.threads && !sets(candidate, "vectors") &&
           !sets(candidate, "single");
}

static ck_Status add_residuals(ck_Csv *csv, const ck_BenchBody *body, const ck_BenchOptions *options, ck_Error *error) {
    ck_Model model = {0};
    uint32_t sweeps[CANDIDATES] = {0};
    double times[CANDIDATES][CK_BENCH_MAX_ROUNDS], quartiles[3];
    ck_Status status = build_stretched(&model, body, error);
    for (size_t i = 0; i < CANDIDATES && !status; i++) {
        if (!has_residual(&candidates[i])) continue;
        if (options->progress) options->progress(body->name, candidates[i].engine);
        sweeps[i] = find_sweeps(&candidates[i], &model);
    }
    for (int round = 0; round < options->rounds && !status; round++)
        for (size_t i = 0; i < CANDIDATES; i++)
            if (sweeps[i]) sweep_start(&candidates[i], &model, sweeps[i], &times[i][round]);
    for (size_t i = 0; i < CANDIDATES && !status; i++) {
        if (!has_residual(&candidates[i])) continue;
        const double count = sweeps[i], each[3] = {count, count, count};
        const char *reason = count > 0 ? NULL : "does not model rigid bars, or does not get there in 4096 sweeps";
        ck_bench_quartiles(times[i], sweeps[i] ? options->rounds : 0, quartiles);
        ck_bench_add_row(csv, body, &model, candidates[i].engine, candidates[i].setup, "sweeps_to_strain", "1",
                         reason ? NULL : each, 1, reason);
        ck_bench_add_row(csv, body, &model, candidates[i].engine, candidates[i].setup, "time_to_strain", "s",
                         reason ? NULL : quartiles, 1, reason);
    }
    ck_model_free(&model);
    return status;
}

static double bytes_in_use(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)(info.uordblks + info.hblkhd);
}

// One size of the growing cloth: step time and the memory of the engine's own state.
static ck_Status grow_to(ck_Csv *csv, const ck_BenchBody *body, const ck_BenchOptions *options, double *seconds,
                         ck_Error *error) {
    ck_Model model = {0};
    ck_Status status = ck_bench_body_build(&model, body, false, error);
    if (!status) {
        Entrant entrant;
        double before = bytes_in_use();
        enter(&entrant, &candidates[VERLET], &model, options);
        double bytes = (bytes_in_use() - before) / model.particle_count, quartiles[3] = {NAN, NAN, NAN};
        for (int round = 0; round < options->rounds && !*entrant.reason; round++)
            entrant.times[entrant.count++] = time_frames(&entrant, entrant.frames);
        if (entrant.count) ck_bench_quartiles(entrant.times, entrant.count, quartiles);
        *seconds = quartiles[0];
        const double each[3] = {bytes, bytes, bytes};
        ck_bench_add_row(csv, body, &model, "native-verlet", "", "growth_step_time", "s", quartiles, 1, entrant.reason);
        ck_bench_add_row(csv, body, &model, "native-verlet", "", "memory_per_particle", "B", each, 1, NULL);
        if (entrant.state) entrant.engine->destroy(entrant.state);
    }
    ck_model_free(&model);
    return status;
}

// The exponent of time ~ particles^p, by least squares over all sizes.
static ck_Status grow(ck_Csv *csv, const ck_BenchOptions *options, ck_Error *error) {
    double x[MAX_SIZES], y[MAX_SIZES];
    int count = 0;
    ck_Status status = CK_OK;
    for (uint32_t side = 16; side <= (uint32_t)options->largest && !status; side *= 2) {
        double seconds = NAN;
        if (options->progress) options->progress("growing cloth", "native-verlet");
        status = grow_to(csv, &(ck_BenchBody){"cloth", CK_BENCH_CLOTH, side, side}, options, &seconds, error);
        if (isnan(seconds)) continue;
        x[count] = 2 * log(side);
        y[count++] = log(seconds);
    }
    const double p = ck_slope(x, y, count), each[3] = {p, p, p};
    ck_Model none = {0};
    ck_bench_add_row(csv, &(ck_BenchBody){.name = "cloth"}, &none, "native-verlet", "", "growth_exponent", "1", each, 1,
                     NULL);
    return status;
}

// What is timed in one child: a part of the whole, on a body.
typedef struct Section Section;
struct Section {
    const char *part;
    ck_Status (*write)(ck_Csv *csv, const Section *section, ck_Error *error);
    const ck_BenchBody *body;
    const ck_BenchCloth *cloth;
    const ck_BenchOptions *options;
    double peak;
};

static ck_Status write_race(ck_Csv *csv, const Section *section, ck_Error *error) {
    return race(csv, section->body, section->options, section->peak, error);
}

static ck_Status write_seconds(ck_Csv *csv, const Section *section, ck_Error *error) {
    return add_seconds(csv, section->body, section->options, error);
}

static ck_Status write_residuals(ck_Csv *csv, const Section *section, ck_Error *error) {
    return add_residuals(csv, section->body, section->options, error);
}

static ck_Status write_costs(ck_Csv *csv, const Section *section, ck_Error *error) {
    return ck_bench_add_costs(csv, section->cloth, section->options, error);
}

static ck_Status write_growth(ck_Csv *csv, const Section *section, ck_Error *error) {
    return grow(csv, section->options, error);
}

static ck_Status write_section(ck_Csv *csv, void *context, ck_Error *error) {
    const Section *section = context;
    return section->write(csv, section, error);
}

// An engine that crashes or hangs costs the rows of its section, which say so, and no others.
static ck_Status add_section(ck_Csv *csv, Section section, ck_Error *error) {
    const ck_Limits limits = ck_limits_default();
    const ck_BenchBody *body = section.body;
    const char *only = section.options->only;
    const bool is_taken = body->kind == CK_BENCH_ROPE || (int)body->rows <= section.options->largest;
    if (!is_taken || (only && strcmp(only, section.part) && strcmp(only, body->name))) return CK_OK;
    if (section.options->progress) section.options->progress(body->name, "its engines");
    ck_Status status = ck_csv_from_child(csv, write_section, &section, &limits, error);
    if (status != CK_REFUSED) return status;
    ck_Model none = {0};
    ck_bench_add_row(csv, body, &none, "", "", "step_time", "s", NULL, 1, error->message);
    return CK_OK;
}

static const char *const parts[] = {"steps", "seconds", "strain", "costs", "growth"};
enum { PART_STEPS, PART_SECONDS, PART_STRAIN, PART_COSTS, PART_GROWTH, PARTS };

// Names of parts, then of bodies, of which several in a row have the same.
static const char *only_at(const void *table, int index) {
    (void)table;
    if (index < PARTS) return parts[index];
    index -= PARTS;
    for (size_t i = 0; i < BODIES; i++) {
        const bool is_new = !i || strcmp(bodies[i].name, bodies[i - 1].name);
        if (is_new && index-- == 0) return bodies[i].name;
    }
    return NULL;
}

static ck_Status check_only(const char *only, ck_Error *error) {
    char known[200], hint[80];
    for (int i = 0; only && only_at(NULL, i); i++)
        if (!strcmp(only, only_at(NULL, i))) return CK_OK;
    if (!only) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "--only %s: there is no such part or body%s; there are %s", only,
                   ck_name_hint(hint, sizeof hint, only, only_at, NULL),
                   ck_name_list(known, sizeof known, only_at, NULL));
}

ck_Status ck_bench_write(ck_Csv *csv, const ck_BenchOptions *options, ck_Error *error) {
    const ck_BenchBody growing = {"growing cloth", CK_BENCH_CLOTH, 1, 1};
    double peak = 0;
    ck_Status status = check_only(options->only, error);
    if (!status) status = ck_bench_add_processor(csv, &peak, error);
    for (size_t i = 0; i < BODIES && !status; i++)
        status = add_section(csv, (Section){parts[PART_STEPS], write_race, &bodies[i], NULL, options, peak}, error);
    for (size_t i = 0; i < BODIES && !status; i++)
        status =
            add_section(csv, (Section){parts[PART_SECONDS], write_seconds, &bodies[i], NULL, options, peak}, error);
    for (size_t i = 0; i < 2 && !status; i++)
        status =
            add_section(csv, (Section){parts[PART_STRAIN], write_residuals, &bodies[i], NULL, options, peak}, error);
    for (size_t i = 0; i < CK_BENCH_CLOTHS && !status; i++)
        status = add_section(
            csv,
            (Section){parts[PART_COSTS], write_costs, &ck_bench_cloths[i].body, &ck_bench_cloths[i], options, peak},
            error);
    return status ? status
                  : add_section(csv, (Section){parts[PART_GROWTH], write_growth, &growing, NULL, options, peak}, error);
}
