// Hostile engines: each costs one row, and the comparison goes on.
#include "fixture_comparison.h"

#include "process.h"
#include "runner.h"

#include <pthread.h>
#include <signal.h>

static const char *version(void) {
    return "test";
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    (void)wanted, (void)ledger, (void)error;
    *used = (ck_Settings){.substeps = 1};
    *state = (void *)model;
    return CK_OK;
}

static void read_state(const void *state, double *position, double *velocity) {
    const ck_Model *model = state;
    memcpy(position, model->position, 3 * sizeof(double) * (size_t)model->particle_count);
    memcpy(velocity, model->velocity, 3 * sizeof(double) * (size_t)model->particle_count);
}

static void destroy(void *state) {
    (void)state;
}

static ck_StepResult step_abort(void *state) {
    (void)state;
    fprintf(stderr, "first line\nthe solver's own last words\n");
    raise(SIGABRT);
    return CK_STEP_OK;
}

static ck_StepResult step_for_ever(void *state) {
    (void)state;
    for (volatile int i = 0;; i = 1 - i) continue;
    return CK_STEP_OK;
}

// 100 GB, page by page, as a leak would take them
static ck_StepResult step_eat(void *state) {
    (void)state;
    const size_t chunk = (size_t)16 << 20;
    for (size_t eaten = 0; eaten < (size_t)100 << 30; eaten += chunk) {
        char *memory = malloc(chunk);
        if (!memory) return CK_STEP_NO_MEMORY;
        memset(memory, 1, chunk);
    }
    return CK_STEP_OK;
}

static ck_StepResult step_exit(void *state) {
    (void)state;
    _Exit(7);
}

static ck_StepResult step_fine(void *state) {
    (void)state;
    return CK_STEP_OK;
}

static ck_StepResult step_diverge(void *state) {
    (void)state;
    return CK_STEP_DIVERGED;
}

static ck_Status create_refuse(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                               ck_Ledger *ledger, ck_Error *error) {
    (void)state, (void)model, (void)wanted, (void)used, (void)ledger;
    return ck_fail(error, CK_REFUSED, "too large for me");
}

static ck_StepResult step_slowly(void *state) {
    (void)state;
    for (double start = ck_thread_cpu(); ck_thread_cpu() - start < 0.02;) continue;
    return CK_STEP_OK;
}

// Works for a hundredth of a second, in a thread that the caller waits for.
static void *work(void *unused) {
    for (double start = ck_thread_cpu(); ck_thread_cpu() < start + 0.01;) continue;
    return unused;
}

static ck_StepResult step_in_a_thread(void *state) {
    pthread_t thread;
    (void)state;
    if (pthread_create(&thread, NULL, work, NULL) || pthread_join(thread, NULL)) return CK_STEP_NO_MEMORY;
    return CK_STEP_OK;
}

#define ENGINE(engine_name, create_function, step_function)                                                            \
    {                                                                                                                  \
        .name = engine_name, .about = "hostile", .family = "test", .version = version, .terms = ~0u,                   \
        .create = create_function, .step = step_function, .read = read_state, .destroy = destroy                       \
    }

static const ck_Engine engines[] = {
    ENGINE("aborts", create, step_abort),
    ENGINE("hangs", create, step_for_ever),
    ENGINE("eats", create, step_eat),
    ENGINE("exits", create, step_exit),
    ENGINE("diverges", create, step_diverge),
    ENGINE("refuses", create_refuse, step_fine),
    {.name = "simple",
     .about = "no terms",
     .family = "test",
     .version = version,
     .terms = 0,
     .create = create,
     .step = step_fine,
     .read = read_state,
     .destroy = destroy},
    ENGINE("fine", create, step_fine),
};

static const struct {
    ck_RunStatus status;
    const char *reason;
} wanted[] = {
    {CK_RUN_ABORTED, "signal 6, Aborted: the solver's own last words, at t = 0 s"},
    {CK_RUN_TIMED_OUT, "still running after the limit of 1.5 s"},
    {CK_RUN_OUT_OF_MEMORY, "took more than the limit of 600 MiB"},
    {CK_RUN_ABORTED, "exit status 7"},
    {CK_RUN_DIVERGED, "left the finite numbers"},
    {CK_RUN_REFUSED, "too large for me"},
    {CK_RUN_UNSUPPORTED, "simple does not model springs, gravity"},
    {CK_RUN_OK, "ran to t = 0.2 s"},
};

static const char scene[] =
    "name: prey\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\npins: [first]\n"
    "gravity: [0, -9.81, 0]\ntime: {duration: 0.2, step: 0.1}\n";

static void test_hostile_engines(void **state) {
    (void)state;
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, scene);
    const ck_Engine *list[sizeof engines / sizeof *engines + 1];
    int count = 0;
    for (; count < (int)(sizeof engines / sizeof *engines); count++) list[count] = &engines[count];
    list[count++] = ck_engine_find("native-verlet");
    ck_CompareOptions options = ck_compare_options_default();
    options.engines = list;
    options.engine_count = count;
    options.repeats = 5;
    options.limits = (ck_Limits){.seconds = 1.5, .memory_bytes = (size_t)600 << 20};
    ck_Error error = {0};
    assert_int_equal(ck_comparison_run(&comparison, &options, &error), CK_OK);
    assert_int_equal(comparison.run_count, count);
    for (int i = 0; i < count - 1; i++) {
        const ck_Run *run = &comparison.runs[i];
        if (run->status != wanted[i].status || !strstr(run->reason, wanted[i].reason))
            fail_msg("%s: %s, %s", run->engine->name, ck_run_status_names[run->status], run->reason);
        assert_int_equal(run->timing.repeat_count, run->status == CK_RUN_OK ? 5 : 0);
    }
    const ck_Run *last = &comparison.runs[count - 1];
    assert_int_equal(last->status, CK_RUN_OK);
    assert_int_equal(last->timing.repeat_count, 5);
    assert_true(ck_timing_median(&last->timing) > 0 && ck_timing_iqr(&last->timing) >= 0);
    ck_comparison_free(&comparison);
}

// A run of 1000 frames of 20 ms within 1 s is given up as soon as its frames say so, and one that will be done is not.
static void test_foreseen(void **state) {
    (void)state;
    static const ck_Engine slow = ENGINE("slow", create, step_slowly);
    static const char long_scene[] =
        "name: long\nrope: {particles: 3, spacing: 0.1, mass: 1}\ntime: {duration: 100, step: 0.1}\n";
    static const struct {
        double seconds;
        ck_RunStatus status;
        int frames;
        const char *reason;
    } cases[] = {{1, CK_RUN_TIMED_OUT, 4, "given up at t = 0.3 s: it would take 20"},
                 {60, CK_RUN_OK, 1001, "ran to t"}};
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, long_scene);
    for (int i = 0; i < 2; i++) {
        const ck_Limits limits = {.seconds = cases[i].seconds, .foresees = true};
        const ck_Engine *engine = i ? &engines[7] : &slow;
        ck_Run run;
        assert_int_equal(ck_run_measure(&run, &comparison.model, engine, &(ck_Settings){0}, &limits, NULL), CK_OK);
        assert_int_equal(run.status, cases[i].status);
        assert_int_equal(run.trajectory.frame_count, cases[i].frames);
        assert_non_null(strstr(run.reason, cases[i].reason));
        ck_run_free(&run);
    }
    ck_comparison_free(&comparison);
}

// A verdict is about motion: a blow-up that stays finite has more kinetic energy than there ever was; a spring that is
// longer than its stiffness allows is told while it moves; a body that came to rest has an error, whatever its strain.
static void test_verdict(void **state) {
    (void)state;
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, scene);
    ck_Run run = {.model = &comparison.model, .engine = &engines[7]};
    assert_int_equal(ck_trajectory_create(&run.trajectory, &comparison.model, NULL), CK_OK);
    run.trajectory.frame_count = comparison.model.frame_count + 1;
    const int last = run.trajectory.frame_count - 1;
    for (int frame = 0; frame <= last; frame++)
        memcpy(ck_trajectory_position(&run.trajectory, frame), comparison.model.position, 9 * sizeof(double));
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_OK);
    // a spring three times its length, reached by falling 0.2 m, and at rest there: 100 N/m would hold 2 J, and the
    // fall gave 0.65 J
    ck_trajectory_position(&run.trajectory, last)[3 * 2 + 1] -= 0.2;
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_OK);
    // the same on its way
    ck_trajectory_velocity(&run.trajectory, last)[6] = 0.1;
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_OVERSTRETCHED);
    // 10 N/m would hold 0.2 J: the scene allows it
    comparison.model.springs[0].stiffness = comparison.model.springs[1].stiffness = 10;
    run.status = CK_RUN_OK;
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_OK);
    // speed without a fall
    ck_trajectory_velocity(&run.trajectory, 1)[6] = 10;
    run.status = CK_RUN_OK;
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_ENERGY_GAIN);
    // still moving where the truth is at rest
    ck_trajectory_velocity(&run.trajectory, 1)[6] = 0;
    ck_trajectory_velocity(&run.trajectory, run.trajectory.frame_count - 1)[6] = 0.1;
    memcpy(ck_trajectory_position(&run.trajectory, run.trajectory.frame_count - 1), comparison.model.position,
           9 * sizeof(double));
    ck_trajectory_position(&run.trajectory, 1)[3 * 2 + 1] -= 0.1;
    comparison.truth.reference.is_static = true;
    run.status = CK_RUN_OK;
    ck_verdict(&run, &comparison.truth.reference);
    assert_int_equal(run.status, CK_RUN_UNSETTLED);
    // no engine can settle without damping
    assert_non_null(strstr(run.reason, "neither drag nor spring damping"));
    ck_run_free(&run);
    ck_comparison_free(&comparison);
}

// CPU time is that of every thread, whoever of them did the work.
static void test_threads_count(void **state) {
    (void)state;
    static const ck_Engine threaded = ENGINE("threaded", create, step_in_a_thread);
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, scene);
    ck_Limits limits = ck_limits_default();
    ck_Run run;
    assert_int_equal(ck_run_measure(&run, &comparison.model, &threaded, &(ck_Settings){0}, &limits, NULL), CK_OK);
    assert_int_equal(run.status, CK_RUN_OK);
    assert_int_equal(ck_run_time(&run, INFINITY, &limits, NULL), CK_OK);
    assert_true(run.measured_cpu >= 0.01 * comparison.model.frame_count);
    assert_true(ck_timing_median(&run.timing) >= 0.01 * comparison.model.frame_count);
    ck_run_free(&run);
    ck_comparison_free(&comparison);
}

static void test_quantiles(void **state) {
    (void)state;
    ck_Timing timing = {.cpu = {5, 1, 4, 2, 3}, .repeat_count = 5};
    assert_near("median", ck_timing_median(&timing), 3, 0);
    assert_near("interquartile range", ck_timing_iqr(&timing), 2, 0);
    timing.repeat_count = 4;
    assert_near("median of four", ck_timing_median(&timing), 3, 0); // 1 2 4 5
    timing.repeat_count = 0;
    assert_true(isnan(ck_timing_median(&timing)));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hostile_engines), cmocka_unit_test(test_foreseen),
                                       cmocka_unit_test(test_threads_count), cmocka_unit_test(test_verdict),
                                       cmocka_unit_test(test_quantiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
