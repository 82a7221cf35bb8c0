// Hostile engines: each costs one row, and the comparison goes on.
#include "fixture_comparison.h"

#include "process.h"
#include "runner.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

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

static ck_StepResult step_leave(void *state) {
    (void)state;
    exit(0);
}

static ck_Status create_leave(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                              ck_Ledger *ledger, ck_Error *error) {
    (void)state, (void)model, (void)wanted, (void)used, (void)ledger, (void)error;
    exit(0);
}

static ck_StepResult step_close_and_hang(void *state) {
    for (int i = 0; i < 100; i++) close(i);
    return step_for_ever(state);
}

// as much as it can, for as long as it may
static ck_StepResult step_shout(void *state) {
    (void)state;
    for (;;) puts("a line that nobody asked for, and that says less the more often it is said");
    return CK_STEP_OK;
}

#ifndef __SANITIZE_ADDRESS__
// at once, and gone before anybody looks
static ck_StepResult step_gulp(void *state) {
    (void)state;
    const size_t much = (size_t)2 << 30;
    char *memory = malloc(much);
    if (!memory) return CK_STEP_NO_MEMORY;
    for (size_t i = 0; i < much; i += 4096) memory[i] = 1;
    free(memory);
    return CK_STEP_OK;
}
#endif

// A process of its own that holds what it was given, left behind.
static pid_t *left_behind;

static ck_StepResult step_fork_and_abort(void *state) {
    (void)state;
    pid_t child = fork();
    if (!child)
        for (;;) pause();
    *left_behind = child;
    raise(SIGABRT);
    return CK_STEP_OK;
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
    ENGINE("leaves", create, step_leave),
    ENGINE("leaves at once", create_leave, step_fine),
    ENGINE("closes", create, step_close_and_hang),
    ENGINE("shouts", create, step_shout),
    ENGINE("forks", create, step_fork_and_abort),
#ifndef __SANITIZE_ADDRESS__
    // what the kernel refuses; the sanitizer maps more than any limit
    ENGINE("gulps", create, step_gulp),
#endif
};

static const struct {
    ck_RunStatus status;
    const char *reason;
} wanted[] = {
    {CK_RUN_ABORTED, "signal 6, Aborted: the solver's own last words, at t = 0 s"},
    {CK_RUN_TIMED_OUT, "still running after the limit of 3 s"},
    {CK_RUN_OUT_OF_MEMORY, "took more than the limit of 250 MiB"},
    {CK_RUN_ABORTED, "exit status 7"},
    {CK_RUN_DIVERGED, "left the finite numbers"},
    {CK_RUN_REFUSED, "too large for me"},
    {CK_RUN_UNSUPPORTED, "simple does not model springs, gravity"},
    {CK_RUN_OK, "ran to t = 0.2 s"},
    {CK_RUN_ABORTED, "exit status 0 before its end, at t = 0 s"},
    {CK_RUN_ABORTED, "exit status 0 before its end, at t = 0 s"},
    {CK_RUN_TIMED_OUT, "still running after the limit of 3 s"},
    {CK_RUN_TIMED_OUT, "still running after the limit of 3 s"},
    {CK_RUN_ABORTED, "signal 6, Aborted, at t = 0 s"},
    {CK_RUN_OUT_OF_MEMORY, ""},
};

static const char scene[] =
    "name: prey\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\npins: [first]\n"
    "gravity: [0, -9.81, 0]\ntime: {duration: 0.2, step: 0.1}\n";

// True once a process runs no more, which dies when the kernel gets to it; nobody need have waited for it.
static bool is_gone(pid_t process) {
    char path[40], state = 'Z';
    snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
    for (double start = ck_wall(); ck_wall() < start + 5;) {
        FILE *file = fopen(path, "r");
        if (file && fscanf(file, "%*d (%*[^)]) %c", &state) != 1) state = 'Z';
        if (file) fclose(file);
        if (!file || state == 'Z') return true;
    }
    return false;
}

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
    options.limits = (ck_Limits){.seconds = 3, .memory_bytes = (size_t)250 << 20};
    left_behind = ck_shared_allocate(sizeof *left_behind);
    ck_Error error = {0};
    assert_int_equal(ck_comparison_run(&comparison, &options, &error), CK_OK);
    assert_int_equal(comparison.run_count, count);
    for (int i = 0; i < count - 1; i++) {
        const ck_Run *run = &comparison.runs[i];
        if (run->status != wanted[i].status || !strstr(run->reason, wanted[i].reason))
            fail_msg("%s: %s, %s", run->engine->name, ck_run_status_names[run->status], run->reason);
        assert_int_equal(run->timing.repeat_count, run->status == CK_RUN_OK ? 5 : 0);
    }
    assert_true(*left_behind > 0 && is_gone(*left_behind));
    ck_shared_free(left_behind, sizeof *left_behind);
    const ck_Run *last = &comparison.runs[count - 1];
    assert_int_equal(last->status, CK_RUN_OK);
    assert_int_equal(last->timing.repeat_count, 5);
    assert_true(ck_timing_median(&last->timing) > 0 && ck_timing_iqr(&last->timing) >= 0);
    ck_comparison_free(&comparison);
}

// Of 20 s in frames of 20 ms a patience of 1 s sees a fifth of itself, and cuts the run; it keeps its frames, its cost
// and the way to more. A single frame that outlasts the patience ends, too.
static void test_patience(void **state) {
    (void)state;
    static const ck_Engine slow = ENGINE("slow", create, step_slowly), hung = ENGINE("hung", create, step_for_ever);
    ck_Comparison comparison;
    fixture_load_comparison(
        &comparison, "name: long\nrope: {particles: 3, spacing: 0.1, mass: 1}\ntime: {duration: 100, step: 0.1}\n");
    ck_Run run;
    const ck_Limits limits = {.seconds = 60, .patience = 1}, less = {.seconds = 60, .patience = 0.1};
    assert_int_equal(ck_run_measure(&run, &comparison.model, &slow, &(ck_Settings){0}, &limits, NULL), CK_OK);
    assert_int_equal(run.status, CK_RUN_TOO_SLOW);
    assert_true(run.trajectory.frame_count > 1 && run.trajectory.frame_count <= 12);
    assert_int_equal(run.timing.frames, run.trajectory.frame_count - 1);
    assert_true(run.timing.cpu[0] >= 0.2);
    if (!strstr(run.reason, "s of CPU a simulated second, some 2")) fail_msg("%s", run.reason);
    if (!strstr(run.reason, "--patience 3")) fail_msg("%s", run.reason);
    ck_run_free(&run);
    assert_int_equal(ck_run_measure(&run, &comparison.model, &hung, &(ck_Settings){0}, &less, NULL), CK_OK);
    assert_int_equal(run.status, CK_RUN_TOO_SLOW);
    if (!strstr(run.reason, "not one frame in 0.4 s")) fail_msg("%s", run.reason);
    ck_run_free(&run);
    ck_comparison_free(&comparison);
}

// A cut run is scored as far as it came where the truth moves, and not where the truth knows only the end.
static void test_cut_scores(void **state) {
    (void)state;
    static const char *const texts[] = {
        "name: fall\nrope: {particles: 3, spacing: 0.1, mass: 1}\ngravity: [0, -9.81, 0]\n"
        "time: {duration: 1, step: 0.1}\ntruth: free_fall\n",
        "name: hang\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 1000, damping: 1}\npins: "
        "[first]\n"
        "gravity: [0, -9.81, 0]\ntime: {duration: 1, step: 0.1}\ntruth: equilibrium\n"};
    for (int i = 0; i < 2; i++) {
        ck_Comparison comparison;
        fixture_load_comparison(&comparison, texts[i]);
        assert_int_equal(ck_truth_create(&comparison.truth, &comparison.model, NULL, NULL, NULL), CK_OK);
        ck_Run run = {.model = &comparison.model, .engine = &engines[7], .status = CK_RUN_TOO_SLOW};
        assert_int_equal(ck_trajectory_create(&run.trajectory, &comparison.model, NULL), CK_OK);
        run.trajectory.frame_count = 4;
        comparison.runs = calloc(1, sizeof run);
        *comparison.runs = run;
        ck_Model model;
        ck_Reference reference;
        assert_int_equal(ck_comparison_scores(&comparison, 0, &model, &reference), i == 0);
        if (i == 0) {
            assert_int_equal(model.frame_count, 3);
            assert_near("duration", model.duration, 0.3, 1e-15);
            assert_int_equal(reference.trajectory.frame_count, 4);
        }
        ck_trajectory_free(&run.trajectory);
        free(comparison.runs);
        comparison.runs = NULL;
        ck_comparison_free(&comparison);
    }
}

// Timing ends when the median's interval is narrow, when enough is spent, and not before five where repeats are short.
static void test_timing(void **state) {
    (void)state;
    ck_Timing timing = {.frames = 1};
    double low, high;
    for (int i = 0; i < 40; i++) timing.cpu[i] = 0.001 * (1 + 0.0001 * (i % 5));
    timing.repeat_count = 4;
    timing.spent = 0.004;
    assert_false(ck_timing_is_known(&timing, 1));
    timing.repeat_count = 8;
    assert_true(ck_timing_is_known(&timing, 1));
    for (int i = 0; i < 40; i++) timing.cpu[i] = 0.001 * (1 + 0.2 * (i % 5));
    assert_false(ck_timing_is_known(&timing, 1));
    timing.spent = 0.01;
    assert_true(ck_timing_is_known(&timing, 0.009));
    // P(X <= 1) of ten throws is 1.1 %, P(X <= 2) 5.5 %: the second and the ninth hold the median with 97.9 %
    for (int i = 0; i < 10; i++) timing.cpu[i] = 10 - i;
    timing.repeat_count = 10;
    ck_timing_interval(&timing, &low, &high);
    assert_near("low", low, 2, 0);
    assert_near("high", high, 9, 0);
    timing.repeat_count = 5;
    ck_timing_interval(&timing, &low, &high);
    assert_near("least", low, 6, 0);
    assert_near("most", high, 10, 0);
    // one says nothing of how far the next would be off
    timing.repeat_count = 1;
    ck_timing_interval(&timing, &low, &high);
    assert_true(isnan(low) && isnan(high) && isnan(ck_timing_iqr(&timing)));
}

static ck_Status count_up(void *context, int index, ck_Error *error) {
    ((int *)context)[index]++;
    return index == 3 || index == 7 ? ck_fail(error, CK_IO, "number %d", index) : CK_OK;
}

// Each index once, whatever failed; the first failure is told.
static void test_parallel(void **state) {
    (void)state;
    int counts[50] = {0};
    ck_Error error = {0};
    assert_int_equal(ck_parallel(50, 4, count_up, counts, &error), CK_IO);
    assert_string_equal(error.message, "number 3");
    for (int i = 0; i < 50; i++) assert_int_equal(counts[i], 1);
    assert_int_equal(ck_parallel(0, 0, count_up, counts, NULL), CK_OK);
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
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_hostile_engines), cmocka_unit_test(test_patience),
                                       cmocka_unit_test(test_cut_scores),      cmocka_unit_test(test_timing),
                                       cmocka_unit_test(test_parallel),        cmocka_unit_test(test_threads_count),
                                       cmocka_unit_test(test_verdict),         cmocka_unit_test(test_quantiles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
