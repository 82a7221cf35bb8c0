#include "bench.h"

#include "clock.h"
#include "engine.h"
#include "lanes.h"
#include "scene.h"
#include "stability.h"

#include <malloc.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_ROUNDS 99
// How long a repeat lasts at least, s: far above the clock's grain.
#define REPEAT 0.02
// Substeps of a frame: what an engine does once a frame is shared out, as in use.
#define SUBSTEPS 16
// Additions and multiplications of the explicit row kernel: 30 a spring without damping, 60 a particle.
#define EXPLICIT_PER_SPRING 30
#define EXPLICIT_PER_PARTICLE 60

const char *const ck_bench_columns[] = {"body", "particles", "springs", "engine", "iterations", "metric",
                                        "unit", "value",     "low",     "high",   "reason",     NULL};

typedef struct Body {
    const char *name;
    uint32_t rows, columns; // columns 1: a rope
} Body;

static const Body bodies[] = {{"cloth", 20, 20}, {"cloth", 64, 64}, {"cloth", 256, 256}, {"rope", 1000, 1}};

// Engines, and the iterations that each is given: as many as its method needs for a step to be one.
static const struct {
    const char *engine;
    uint32_t iterations;
} candidates[] = {{"native-verlet", 0},   {"native-bars", 10}, {"native-xpbd", 10}, {"native-rope", 4},
                  {"seed-tecido", 10},    {"seed-cloth", 0},   {"bullet-pbd", 10},  {"bullet-explicit", 0},
                  {"bullet-implicit", 1}, {"ode-quick", 10}};
#define CANDIDATES (sizeof candidates / sizeof *candidates)

typedef struct Entrant {
    const ck_Engine *engine;
    void *state;
    uint32_t iterations;
    int frames;               // of a repeat
    double times[MAX_ROUNDS]; // s a step
    int count;
    const char *reason; // why there is no time
} Entrant;

// A body of 1 m and 0.2 kg in gravity, let go level: k = 1000 N/m along, 500 across. A substep is half of the explicit
// bound, so that every engine steps alike.
static ck_Status build(ck_Model *model, const Body *body, ck_Error *error) {
    double down[3] = {0, 0, 1}, gravity[3] = {0, -9.81, 0}, along[3] = {1, 0, 0};
    char *pins[] = {body->columns > 1 ? "top_left" : "first", body->columns > 1 ? "top_right" : "first"};
    uint32_t longest = body->rows > body->columns ? body->rows : body->columns;
    ck_SceneCloth cloth = {.rows = body->rows, .columns = body->columns, .spacing = 1.0 / (longest - 1), .mass = 0.2};
    ck_SceneRope rope = {.particles = body->rows, .spacing = cloth.spacing, .mass = 0.2};
    ck_SceneSprings springs = {.stiffness = 1000, .shear = 500};
    cloth.down = down;
    rope.along = along;
    ck_SceneFile file = {.name = (char *)body->name,
                         .cloth = body->columns > 1 ? &cloth : NULL,
                         .rope = body->columns > 1 ? NULL : &rope,
                         .springs = &springs,
                         .pins = pins,
                         .pins_count = 2,
                         .gravity = gravity,
                         .time = {1, 1}};
    ck_Scene scene = {.file = &file};
    ck_Status status = ck_model_build(model, &scene, error);
    double frequency = 0;
    if (!status) status = ck_stability_frequency(model, &frequency);
    if (!status) model->step = SUBSTEPS / frequency;
    return status;
}

// CPU time of a substep, s.
static double time_frames(Entrant *entrant, int frames) {
    double start = ck_thread_cpu();
    for (int i = 0; i < frames && !entrant->reason; i++)
        if (entrant->engine->step(entrant->state) != CK_STEP_OK) entrant->reason = "did not get through its steps";
    return (ck_thread_cpu() - start) / frames / SUBSTEPS;
}

// Creates an engine's world and finds how many frames make a repeat.
static void enter(Entrant *entrant, size_t candidate, const ck_Model *model, const ck_BenchOptions *options) {
    static char refused[200];
    *entrant = (Entrant){.engine = ck_engine_find(candidates[candidate].engine),
                         .iterations = candidates[candidate].iterations};
    ck_Settings wanted = {.substeps = SUBSTEPS, .iterations = entrant->iterations}, used;
    ck_Error why = {0};
    if (model->terms & ~entrant->engine->terms) {
        entrant->reason = "does not model it";
    } else if (entrant->engine->create(&entrant->state, model, &wanted, &used, NULL, &why)) {
        snprintf(refused, sizeof refused, "%.199s", why.message);
        entrant->reason = refused;
        entrant->state = NULL;
    }
    if (entrant->reason) return;
    double once = SUBSTEPS * time_frames(entrant, 1);
    entrant->frames = (int)fmax(1, ceil(REPEAT / fmax(once, 1e-9)));
    if (once > options->budget) entrant->reason = "one frame takes longer than the budget";
}

static int compare_numbers(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void add_row(ck_Csv *csv, const Body *body, const ck_Model *model, const char *engine, uint32_t iterations,
                    const char *metric, const char *unit, const double *quartiles, double scale, const char *reason) {
    ck_csv_text(csv, body->name);
    ck_csv_count(csv, (uint64_t)model->particle_count);
    ck_csv_count(csv, (uint64_t)model->spring_count);
    ck_csv_text(csv, engine);
    ck_csv_count(csv, iterations);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, unit);
    for (int i = 0; i < 3; i++) ck_csv_number(csv, quartiles ? scale * quartiles[i] : NAN);
    ck_csv_text(csv, reason ? reason : "");
}

// The median and the quartiles, in this order.
static void find_quartiles(Entrant *entrant, double *quartiles) {
    qsort(entrant->times, (size_t)entrant->count, sizeof *entrant->times, compare_numbers);
    quartiles[0] = entrant->times[entrant->count / 2];
    quartiles[1] = entrant->times[entrant->count / 4];
    quartiles[2] = entrant->times[(3 * entrant->count) / 4];
}

static void add_entrant(ck_Csv *csv, const Body *body, const ck_Model *model, Entrant *entrant, double peak) {
    const char *name = entrant->engine->name;
    if (entrant->reason || !entrant->count) {
        add_row(csv, body, model, name, entrant->iterations, "step_time", "s", NULL, 1, entrant->reason);
        return;
    }
    double quartiles[3], updates = (double)model->spring_count * (entrant->iterations ? entrant->iterations : 1);
    find_quartiles(entrant, quartiles);
    add_row(csv, body, model, name, entrant->iterations, "step_time", "s", quartiles, 1, NULL);
    add_row(csv, body, model, name, entrant->iterations, "update_time", "ns", quartiles, 1e9 / updates, NULL);
    if (strcmp(name, "native-verlet") || body->columns == 1) return;
    double work =
        EXPLICIT_PER_SPRING * (double)model->spring_count + EXPLICIT_PER_PARTICLE * (double)model->particle_count;
    double shares[3] = {work / peak / quartiles[0], work / peak / quartiles[2], work / peak / quartiles[1]};
    add_row(csv, body, model, name, 0, "share_of_peak", "1", shares, 1, NULL);
}

// All engines on one body, in rounds: a slow spell of the machine hits all alike.
static ck_Status race(ck_Csv *csv, const Body *body, const ck_BenchOptions *options, double peak, ck_Error *error) {
    ck_Model model = {0};
    Entrant *entrants = calloc(CANDIDATES, sizeof *entrants);
    ck_Status status = entrants ? build(&model, body, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (size_t i = 0; i < CANDIDATES && !status; i++) {
        if (options->progress) options->progress(body->name, candidates[i].engine);
        enter(&entrants[i], i, &model, options);
    }
    for (int round = 0; round < options->rounds && !status; round++)
        for (size_t i = 0; i < CANDIDATES; i++)
            if (!entrants[i].reason)
                entrants[i].times[entrants[i].count++] = time_frames(&entrants[i], entrants[i].frames);
    for (size_t i = 0; i < CANDIDATES && !status; i++) add_entrant(csv, body, &model, &entrants[i], peak);
    for (size_t i = 0; i < CANDIDATES && entrants; i++)
        if (entrants[i].state) entrants[i].engine->destroy(entrants[i].state);
    free(entrants);
    ck_model_free(&model);
    return status;
}

#define PEAK_LANES 96
#define PEAK_ROUNDS 20000

// So many independent chains of one product and one sum each that the processor is never idle.
CK_KERNEL static double multiply_add(double *lanes) {
    for (int round = 0; round < PEAK_ROUNDS; round++)
        for (int i = 0; i < PEAK_LANES; i++) lanes[i] = lanes[i] * 0.999999 + 1e-6;
    return lanes[0];
}

// Additions and multiplications a second, at best: what no loop here can beat.
static double find_peak(void) {
    double lanes[PEAK_LANES] = {0}, best = 0, sum = 0;
    for (int i = 0; i < 20; i++) {
        double start = ck_thread_cpu();
        sum += multiply_add(lanes);
        best = fmax(best, 2.0 * PEAK_LANES * PEAK_ROUNDS / (ck_thread_cpu() - start));
    }
    return sum >= 0 ? best : NAN;
}

static double bytes_in_use(void) {
    struct mallinfo2 info = mallinfo2();
    return (double)(info.uordblks + info.hblkhd);
}

// One size of the growing cloth: step time and the memory of the engine's own state.
static ck_Status grow_to(ck_Csv *csv, const Body *body, const ck_BenchOptions *options, double *seconds,
                         ck_Error *error) {
    ck_Model model = {0};
    ck_Status status = build(&model, body, error);
    if (!status) {
        Entrant entrant;
        double before = bytes_in_use();
        enter(&entrant, 0, &model, options);
        double bytes = (bytes_in_use() - before) / model.particle_count, quartiles[3] = {NAN, NAN, NAN};
        for (int round = 0; round < options->rounds && !entrant.reason; round++)
            entrant.times[entrant.count++] = time_frames(&entrant, entrant.frames);
        if (entrant.count) find_quartiles(&entrant, quartiles);
        *seconds = quartiles[0];
        const double each[3] = {bytes, bytes, bytes};
        add_row(csv, body, &model, "native-verlet", 0, "growth_step_time", "s", quartiles, 1, entrant.reason);
        add_row(csv, body, &model, "native-verlet", 0, "memory_per_particle", "B", each, 1, NULL);
        if (entrant.state) entrant.engine->destroy(entrant.state);
    }
    ck_model_free(&model);
    return status;
}

// The exponent of time ~ particles^p, by least squares over all sizes.
static ck_Status grow(ck_Csv *csv, const ck_BenchOptions *options, ck_Error *error) {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0;
    ck_Status status = CK_OK;
    for (uint32_t side = 16; side <= (uint32_t)options->largest && !status; side *= 2) {
        double seconds = NAN;
        if (options->progress) options->progress("growing cloth", "native-verlet");
        status = grow_to(csv, &(Body){"cloth", side, side}, options, &seconds, error);
        if (isnan(seconds)) continue;
        double a = 2 * log(side), b = log(seconds);
        n++;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
    }
    const double p = (n * xy - x * y) / (n * xx - x * x), each[3] = {p, p, p};
    ck_Model none = {0};
    add_row(csv, &(Body){.name = "cloth"}, &none, "native-verlet", 0, "growth_exponent", "1", each, 1, NULL);
    return status;
}

ck_Status ck_bench_write(ck_Csv *csv, const ck_BenchOptions *options, ck_Error *error) {
    double peak = find_peak();
    const double each[3] = {peak, peak, peak};
    ck_Model none = {0};
    add_row(csv, &(Body){.name = "processor"}, &none, "", 0, "multiply_add_peak", "1/s", each, 1, NULL);
    ck_Status status = CK_OK;
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies && !status; i++)
        status = race(csv, &bodies[i], options, peak, error);
    return status ? status : grow(csv, options, error);
}
