// Random scenes over every key, from a milligram to a tonne and from 1e-3 to 1e9 N/m: each engine has a row with a
// status and a reason, no result that is called ok is absurd, all limits are kept, and a second run gives the same
// bits. RANDOM_SCENES says how many, and RANDOM_SEED which is the first.
#include "fixture_comparison.h"

#include "process.h"
#include "statistics.h"
#include "vector.h"

#include <stdarg.h>
#include <unistd.h>

#ifdef __SANITIZE_ADDRESS__
#define SCENES 2
#else
#define SCENES 20
#endif

// Seconds of a run, of CPU and on the wall, and of what the parent does beside.
#define PATIENCE 0.05
#define SECONDS 1.0
#define BESIDE 2.0

typedef struct Text {
    ck_Random random;
    char bytes[6000];
    size_t length;
} Text;

__attribute__((format(printf, 2, 3))) static void add(Text *text, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    text->length += (size_t)vsnprintf(text->bytes + text->length, sizeof text->bytes - text->length, format, arguments);
    va_end(arguments);
    assert_true(text->length < sizeof text->bytes);
}

static double pick(Text *text, double from, double to) {
    return from + (to - from) * ck_random_unit(&text->random);
}

static double pick_power(Text *text, double from, double to) {
    return pow(10, pick(text, from, to));
}

static bool one_in(Text *text, int count) {
    return ck_random_unit(&text->random) * count < 1;
}

static int pick_count(Text *text, int from, int to) {
    return from + (int)((to - from + 1) * ck_random_unit(&text->random));
}

static void add_vector(Text *text, const char *before, double size, const char *after) {
    add(text, "%s[%.6g, %.6g, %.6g]%s", before, pick(text, -size, size), pick(text, -size, size),
        pick(text, -size, size), after);
}

static void add_body(Text *text, double spacing, bool *is_cloth) {
    const double mass = pick_power(text, -6, 3);
    const int kind = pick_count(text, 0, 2), count = pick_count(text, 2, 7);
    *is_cloth = kind == 0;
    if (kind == 0) {
        add(text, "cloth: {rows: %d, columns: %d, spacing: %.6g, mass: %.6g", pick_count(text, 1, 5), count, spacing,
            mass);
        if (one_in(text, 2)) add(text, ", down: [0, %.3f, 1]", pick(text, -1, 1));
        add(text, "}\n");
    } else if (kind == 1) {
        add(text, "rope: {particles: %d, spacing: %.6g, mass: %.6g", count, spacing, mass);
        if (one_in(text, 2)) add(text, ", end_mass: %.6g", pick_power(text, -6, 3));
        if (one_in(text, 2)) add_vector(text, ", along: ", 1, "");
        add(text, "}\n");
    } else {
        add(text, "network: {nodes: [");
        for (int i = 0; i < count; i++)
            add(text, "%s{at: [%.6g, %.6g, %.6g], mass: %.6g}", i ? ", " : "", i * spacing,
                pick(text, -spacing, spacing), pick(text, -spacing, spacing), pick_power(text, -6, 3));
        add(text, "], bars: [");
        for (int i = 1; i < count; i++) add(text, "%s[%d, %d]", i > 1 ? ", " : "", pick_count(text, 0, i - 1), i);
        add(text, "]}\n");
    }
}

static void add_springs(Text *text, bool is_cloth) {
    if (one_in(text, 6)) {
        add(text, "springs: {rigid: true}\n");
        return;
    }
    add(text, "springs: {stiffness: %.6g", pick_power(text, -3, 9));
    if (is_cloth && one_in(text, 2)) add(text, ", shear: %.6g", pick_power(text, -3, 9));
    if (one_in(text, 2)) add(text, ", damping: %.6g", pick_power(text, -6, 3));
    if (one_in(text, 8)) add(text, ", pull_only: true");
    if (one_in(text, 8)) add(text, ", prestretch: %.6g", pick(text, 0, 0.1));
    add(text, "}\n");
    if (is_cloth && one_in(text, 6)) add(text, "bending: {stiffness: %.6g}\n", pick_power(text, -9, 0));
    if (is_cloth && one_in(text, 6)) add_vector(text, "wind: {velocity: ", 10, ", drag: 1, lift: 0.5}\n");
}

static void add_path(Text *text, double spacing) {
    const int kind = pick_count(text, 0, 2);
    if (kind == 0) add_vector(text, "path: {velocity: ", 10 * spacing, ", to: 0.1}");
    if (kind == 1) {
        add_vector(text, "path: {amplitude: ", spacing, "");
        add(text, ", frequency: %.6g}", pick_power(text, -1, 2));
    }
    if (kind == 2)
        add(text, "path: {points: [[0, 0, 0, 0], [0.05, %.6g, %.6g, %.6g]]}", pick(text, -spacing, spacing),
            pick(text, -spacing, spacing), pick(text, -spacing, spacing));
}

static void add_colliders(Text *text, double spacing) {
    const int count = pick_count(text, 0, 3);
    if (count) add(text, "colliders:\n");
    for (int i = 0; i < count; i++) {
        const double below = pick(text, 1, 4) * spacing, size = pick_power(text, -2, 1) * spacing;
        switch (pick_count(text, 0, 4)) {
        case 0: add(text, "  - {plane: {point: [0, %.6g, 0], normal: [0.1, 1, 0]", -10 * below); break;
        case 1: add(text, "  - {sphere: {center: [%.6g, %.6g, 0], radius: %.6g", spacing, -below - size, size); break;
        case 2:
            add(text, "  - {capsule: {from: [0, %.6g, 0], to: [%.6g, %.6g, 0], radius: %.6g", -below - size, spacing,
                -below - 2 * size, size);
            break;
        case 3:
            add(text, "  - {cylinder: {point: [0, %.6g, 0], axis: [0, 0, 1], radius: %.6g", -10 * below - size, size);
            break;
        default:
            add(text, "  - {box: {center: [0, %.6g, 0], size: [%.6g, %.6g, %.6g], rounding: %.6g", -below - 2 * size,
                2 * size, size, 2 * size, one_in(text, 2) ? 0 : 0.2 * size);
        }
        add(text, ", friction: %.3f, restitution: %.3f}", pick(text, 0, 1), pick(text, 0, 1));
        if (one_in(text, 4)) {
            add(text, ", ");
            add_path(text, 0.1 * spacing);
        }
        add(text, "}\n");
    }
}

// Returns how many.
static int add_bodies(Text *text, double spacing) {
    const int count = one_in(text, 4) ? pick_count(text, 1, 2) : 0;
    if (count) add(text, "bodies:\n");
    for (int i = 0; i < count; i++) {
        const double above = (2 + 30 * i) * spacing, size = pick_power(text, -2, 1) * spacing;
        if (one_in(text, 2) || i)
            add(text, "  - {sphere: {center: [%.6g, %.6g, 0], radius: %.6g", spacing, above + size, size);
        else
            add(text, "  - {box: {center: [0, %.6g, 0], size: [%.6g, %.6g, %.6g], along: [1, %.3f, 0]",
                above + 2 * size, 2 * size, size, size, pick(text, -1, 1));
        add(text, ", friction: %.3f, restitution: %.3f}, mass: %.6g, ", pick(text, 0, 1), pick(text, 0, 1),
            pick_power(text, -6, 3));
        add_vector(text, "velocity: ", 10 * spacing, ", ");
        add_vector(text, "spin: ", 10, "");
        add(text, "%s}\n", one_in(text, 4) ? ", hang: ['0']" : "");
    }
    return count;
}

static void write_scene(Text *text, uint64_t seed) {
    static const char *const truths[] = {"equilibrium", "trajectory", "converged", "rest"};
    bool is_cloth;
    *text = (Text){.random = ck_random_seed(seed)};
    const double spacing = pick_power(text, -3, 1);
    add(text, "name: random%d\n", (int)seed);
    add_body(text, spacing, &is_cloth);
    add_springs(text, is_cloth);
    const bool has_pins = !one_in(text, 3);
    if (has_pins) add(text, "pins: ['0'%s]\n", one_in(text, 2) ? ", '1'" : "");
    if (has_pins && one_in(text, 4)) {
        add(text, "moves: [{pins: ['0'], ");
        add_path(text, spacing);
        add(text, "}]\n");
    }
    if (has_pins && one_in(text, 5)) add(text, "release: [{at: 0.05, pins: ['0']}]\n");
    if (!one_in(text, 4)) add(text, "gravity: [0, %.4g, 0]\n", -pick(text, 0.1, 20));
    if (one_in(text, 5)) add_vector(text, "force: ", pick_power(text, -6, 2), "\n");
    if (one_in(text, 5)) add_vector(text, "velocity: ", pick_power(text, -3, 2), "\n");
    if (one_in(text, 3)) add(text, "drag: %.6g\n", pick_power(text, -2, 3));
    if (one_in(text, 6)) add(text, "noise: {amplitude: %.6g, seed: 3}\n", 1e-3 * spacing);
    add_colliders(text, spacing);
    const int bodies = add_bodies(text, spacing);
    add(text, "time: {duration: %.1f, fps: %d", 0.1 * pick_count(text, 2, 5), one_in(text, 2) ? 60 : 20);
    if (one_in(text, 8)) add(text, ", jitter: %.3f", pick(text, 0, 1));
    add(text, "}\n");
    const bool changes = one_in(text, 8);
    if (changes) add(text, "changes: [{at: 0.05, set: '@gravity=[1, -3, 0]@drag=%.3g'}]\n", pick_power(text, -2, 2));
    // most truths know none of these
    if (bodies || changes) return;
    if (!one_in(text, 3)) add(text, "truth: %s\n", truths[pick_count(text, 0, 3)]);
}

// What is called ok may be wrong, but not beyond what a scene of this size can be: nothing is farther than it falls or
// flies in the time, by a hundred, and no spring is longer than that.
static void check_run(const ck_Comparison *comparison, int index, const char *text) {
    const ck_Model *model = &comparison->model;
    const ck_Run *run = &comparison->runs[index];
    double field[3], fastest = 0, reach = 0;
    if (!*run->reason) fail_msg("%s says no reason\n%s", run->engine->name, text);
    if (run->status != CK_RUN_OK) return;
    assert_true(ck_run_has_all_frames(run));
    ck_model_mean_field(model, field);
    for (int i = 0; i < model->particle_count; i++)
        fastest = fmax(fastest, ck_length(model->velocity + 3 * i) + ck_length(model->force) / model->mass[i]);
    for (int i = 0; i < model->path_count; i++)
        fastest = fmax(fastest, ck_length(model->paths[i].vector) * (1 + 7 * model->paths[i].frequency));
    const double bound =
        100 * (model->size + fastest * model->duration + 20 * model->duration * model->duration + ck_length(field));
    for (int i = 0; i < model->particle_count; i++) {
        const double *at = ck_trajectory_position(&run->trajectory, model->frame_count) + 3 * i;
        for (int axis = 0; axis < 3; axis++)
            if (!isfinite(at[axis]))
                fail_msg("%s is ok beside a position that is no number\n%s", run->engine->name, text);
        reach = fmax(reach, ck_distance(at, model->position + 3 * i));
    }
    if (reach > bound && fixture_is_solver(run->engine) && !run->engine->is_stock)
        fail_msg("%s is ok, %.3g m from its start, where %.3g m are far\n%s", run->engine->name, reach, bound, text);
}

// What ended before a limit of time ends alike, to the last bit.
static void check_again(const ck_Comparison *comparison, const ck_CompareOptions *options, int index,
                        const char *text) {
    const ck_Run *run = &comparison->runs[index];
    ck_Settings wanted = ck_comparison_settings(run->engine, &comparison->scene, options);
    ck_Run again;
    if (run->status == CK_RUN_TIMED_OUT || run->status == CK_RUN_TOO_SLOW) return;
    assert_int_equal(ck_verdict_run(&again, &comparison->model, &comparison->truth.reference, run->engine, &wanted,
                                    &options->limits, NULL),
                     CK_OK);
    const bool is_cut = again.status == CK_RUN_TIMED_OUT || again.status == CK_RUN_TOO_SLOW;
    const size_t bytes = 6 * sizeof(double) * (size_t)comparison->model.particle_count;
    if (!is_cut && again.status != run->status)
        fail_msg("%s is %s, and then %s\n%s", run->engine->name, ck_run_status_names[run->status],
                 ck_run_status_names[again.status], text);
    for (int frame = 0; frame < run->trajectory.frame_count && !is_cut; frame++)
        if (memcmp(ck_trajectory_position(&run->trajectory, frame), ck_trajectory_position(&again.trajectory, frame),
                   bytes))
            fail_msg("%s differs from itself in frame %d\n%s", run->engine->name, frame, text);
    ck_run_free(&again);
}

// One scene in so many is run twice.
#define AGAIN 5

static int number_of(const char *name, int otherwise) {
    const char *text = getenv(name);
    return text ? atoi(text) : otherwise;
}

static void test_random_scenes(void **state) {
    (void)state;
    const int first = number_of("RANDOM_SEED", 1),
              scenes = number_of("RANDOM_SCENES", fixture_asks_all() ? 2 * SCENES : SCENES);
    int counts[CK_RUN_STATUS_COUNT] = {0}, valid = 0;
    double longest = 0;
    for (int seed = first; seed < first + scenes; seed++) {
        Text text;
        ck_Comparison comparison;
        ck_Error error = {0};
        write_scene(&text, (uint64_t)seed);
        char *path = fixture_file(text.bytes);
        ck_Status status = ck_comparison_load(&comparison, path, &error);
        // a scene that is none says where
        if (status && (status != CK_BAD_INPUT || strncmp(error.message, path, strlen(path))))
            fail_msg("seed %d: %d, %s\n%s", seed, status, error.message, text.bytes);
        if (!status) {
            ck_CompareOptions options = ck_compare_options_default();
            options.limits = (ck_Limits){.seconds = SECONDS, .memory_bytes = (size_t)1 << 30, .patience = PATIENCE};
            options.repeats = 1;
            const double start = ck_wall();
            if (ck_comparison_run(&comparison, &options, &error))
                fail_msg("seed %d: %s\n%s", seed, error.message, text.bytes);
            const double took = ck_wall() - start;
            longest = fmax(longest, took);
            // each engine may be tried four times, timed and asked by its theory; the truth once
            if (took > SECONDS * (1 + 7 * comparison.run_count) + BESIDE) fail_msg("seed %d took %.1f s", seed, took);
            for (int i = 0; i < comparison.run_count; i++) {
                check_run(&comparison, i, text.bytes);
                if (seed % AGAIN == 0) check_again(&comparison, &options, i, text.bytes);
                counts[comparison.runs[i].status]++;
            }
            valid++;
        }
        ck_comparison_free(&comparison);
        unlink(path);
        free(path);
    }
    print_message("%d of %d scenes are valid, the longest took %.1f s:", valid, scenes, longest);
    for (int i = 0; i < CK_RUN_STATUS_COUNT; i++) print_message(" %d %s", counts[i], ck_run_status_names[i]);
    print_message("\n");
    assert_true(valid > scenes / 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_random_scenes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
