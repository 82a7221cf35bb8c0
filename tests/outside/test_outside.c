// Engines from outside: one solver reached in four ways does the same in each; what misbehaves costs a row, hangs
// nothing and leaves nothing running; the adapters of bridge/examples agree.
#include "fixture_comparison.h"

#include "float_engine.h"
#include "outside.h"
#include "prediction.h"

#include <dirent.h>
#include <unistd.h>

// It knows no damping of springs.
static const char scene[] = "name: cape\ncloth: {rows: 8, columns: 6, spacing: 0.1, mass: 0.2, down: [0, 0, 1]}\n"
                            "springs: {stiffness: 300, shear: 150}\npins: [top_edge]\ngravity: [0, -9.81, 0]\ndrag: 3\n"
                            "release: [{at: 0.5, pins: [top_left]}]\ntime: {duration: 1, fps: 60}\ntruth: trajectory\n";

static void write_recording(const char *path, const ck_Trajectory *trajectory) {
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "time_s,particle,x,y,z,vx,vy,vz\n");
    for (int frame = 0; frame < trajectory->frame_count; frame++)
        for (int i = 0; i < trajectory->particle_count; i++) {
            const double *x = ck_trajectory_position(trajectory, frame) + 3 * i,
                         *v = ck_trajectory_velocity(trajectory, frame) + 3 * i;
            fprintf(file, "%.17g,%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", frame * trajectory->step, i, x[0], x[1],
                    x[2], v[0], v[1], v[2]);
        }
    fclose(file);
}

static void assert_same_run(const ck_Run *one, const ck_Run *other) {
    const ck_Trajectory *a = &one->trajectory, *b = &other->trajectory;
    if (other->status != one->status) fail_msg("%s: %s", other->engine->name, other->reason);
    assert_int_equal(a->frame_count, b->frame_count);
    size_t numbers = 6 * (size_t)a->particle_count * (size_t)a->frame_count;
    for (size_t i = 0; i < numbers; i++)
        if (a->data[i] != b->data[i])
            fail_msg("%s: number %zu is %.17g, and compiled in %.17g", other->engine->name, i, b->data[i], a->data[i]);
}

// Compiled in, as a library, as a command, as a recording: the same to the last bit, and so are all metrics.
static void test_four_ways(void **state) {
    (void)state;
    ck_Comparison comparison;
    ck_Engine *made[3];
    ck_Error error = {0};
    ck_Run run;
    const ck_Limits limits = ck_limits_default();
    fixture_load_comparison(&comparison, scene);
    if (ck_run_measure(&run, &comparison.model, &float_engine, &(ck_Settings){0}, &limits, &error))
        fail_msg("%s", error.message);
    assert_int_equal(run.status, CK_RUN_OK);
    char *path = fixture_file("");
    write_recording(path, &run.trajectory);
    ck_run_free(&run);
    if (ck_outside_library(&made[0], NULL, FLOAT_LIBRARY, &error)) fail_msg("%s", error.message);
    if (ck_outside_command(&made[1], "command", FLOAT_ADAPTER, false, &error)) fail_msg("%s", error.message);
    if (ck_outside_recording(&made[2], "recorded", path, 0, 1e-4, &comparison.model, &error))
        fail_msg("%s", error.message);
    const ck_Engine *list[] = {&float_engine, made[0], made[1], made[2]};
    ck_CompareOptions options = ck_compare_options_default();
    options.engines = list;
    options.engine_count = 4;
    options.repeats = 5;
    options.consistency_budget = 0;
    if (ck_comparison_run(&comparison, &options, &error)) fail_msg("%s", error.message);
    for (int i = 1; i < 4; i++) assert_same_run(&comparison.runs[0], &comparison.runs[i]);
    assert_string_equal(made[0]->name, "float-xpbd");
    assert_string_equal(ck_engine_version(made[0]), "2.1 float");
    assert_string_equal(ck_engine_version(made[1]), "2.1 float");
    assert_non_null(strstr(comparison.runs[1].reason, "in single precision"));
    assert_string_equal(comparison.runs[1].ledger.rows[0].native_parameter, "compliance");
    assert_string_equal(comparison.runs[2].ledger.rows[0].quantity, "message");
    assert_near("recorded cost", ck_timing_median(&comparison.runs[3].timing), 1e-4 * 60, 1e-15);
    // a figure for whoever reads it, not a test: time is noisy
    for (int i = 1; i < 3; i++)
        print_message("%s takes %.3f times as long as compiled in\n", list[i]->name,
                      ck_timing_median(&comparison.runs[i].timing) / ck_timing_median(&comparison.runs[0].timing));
    for (int i = 0; i < 3; i++) ck_outside_free(made[i]);
    ck_comparison_free(&comparison);
    unlink(path);
    free(path);
}

// True where a process of that command line is left.
static bool is_left(const char *words) {
    DIR *processes = opendir("/proc");
    bool is_left = false;
    for (struct dirent *entry; processes && (entry = readdir(processes));) {
        char path[300], line[200] = "";
        snprintf(path, sizeof path, "/proc/%.250s/cmdline", entry->d_name);
        FILE *file = fopen(path, "r");
        size_t length = file ? fread(line, 1, sizeof line - 1, file) : 0;
        if (file) fclose(file);
        for (size_t i = 0; i + 1 < length; i++)
            if (!line[i]) line[i] = ' ';
        is_left |= !strncmp(line, words, strlen(words));
    }
    if (processes) closedir(processes);
    return is_left;
}

static void test_hostile(void **state) {
    (void)state;
    static const struct {
        const char *mode;
        ck_RunStatus status;
        const char *reason;
    } cases[] = {
        {"good", CK_RUN_OK, ""},
        {"refuses", CK_RUN_REFUSED, "not on a Saturday"},
        {"hangs", CK_RUN_TIMED_OUT, "still running after the limit of 2 s"},
        {"dies", CK_RUN_ABORTED, "exit status 7: no more memory for the solver"},
        {"leaves", CK_RUN_ABORTED, "exit status 1: it ended before its scene did"},
        {"crashes", CK_RUN_ABORTED, "signal 11, Segmentation fault"},
        {"diverges", CK_RUN_DIVERGED, "left the finite numbers"},
        {"floods", CK_RUN_ABORTED, "it said 'ok' where it must say x y z vx vy vz of each particle"},
        {"lies", CK_RUN_ABORTED, "it said 'fine' where it must say ok or diverged"},
        {"forks", CK_RUN_OK, ""},
        {"nan", CK_RUN_DIVERGED, "left the finite numbers"},
        {"few", CK_RUN_ABORTED, "it said 'that is all' where it must say x y z"},
    };
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, "name: r\nrope: {particles: 4, spacing: 0.1, mass: 1}\nsprings: {stiffness: "
                                         "10}\npins: [first]\ntime: {duration: 0.2, step: 0.1}\n");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char line[400];
        ck_Engine *engine;
        ck_Error error = {0};
        ck_Run run;
        ck_Limits limits = ck_limits_default();
        limits.seconds = cases[i].status == CK_RUN_TIMED_OUT ? 2 : 60;
        snprintf(line, sizeof line, "%s %s", HOSTILE, cases[i].mode);
        if (ck_outside_command(&engine, "hostile", line, false, &error)) fail_msg("%s", error.message);
        if (ck_run_measure(&run, &comparison.model, engine, &(ck_Settings){0}, &limits, &error))
            fail_msg("%s", error.message);
        if (run.status != cases[i].status || !strstr(run.reason, cases[i].reason))
            fail_msg("%s: %s, %s", cases[i].mode, ck_run_status_names[run.status], run.reason);
        if (is_left("sleep 98765")) fail_msg("%s leaves something running", cases[i].mode);
        ck_run_free(&run);
        ck_outside_free(engine);
    }
    ck_comparison_free(&comparison);
}

// What cannot be an engine says so before anything runs.
static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *mode, *wanted;
    } cases[] = {
        {HOSTILE " absent", "does not answer hello: exit status 4"},
        {HOSTILE " old", "it said 'clothcheck 0' where it must say clothcheck 1"},
        {HOSTILE " garbled",
         "it said 'hello yourself' where it must say version, about, models, setting, positions, precision"},
        {HOSTILE " rain", "it said 'rain' where it must say models with words of springs"},
        {"/none/there", "does not answer hello: exit status 127"},
    };
    ck_Engine *engine;
    ck_Error error;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(ck_outside_command(&engine, "x", cases[i].mode, false, &error), CK_BAD_INPUT);
        if (!strstr(error.message, cases[i].wanted)) fail_msg("%s: %s", cases[i].mode, error.message);
        assert_null(engine);
    }
    assert_int_equal(ck_outside_library(&engine, "x", "/none/there.so", &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "there is no such library"));
    assert_int_equal(ck_outside_library(&engine, "x", HOSTILE, &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "cannot be used as an engine"));
    assert_int_equal(ck_outside_library(&engine, "x", OLD_LIBRARY, &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "it is of version 0 of the interface"));
}

static void run_example(ck_Run *run, const ck_Model *model, const char *name, const char *line) {
    ck_Engine *engine;
    ck_Error error = {0};
    const ck_Limits limits = ck_limits_default();
    if (ck_outside_command(&engine, name, line, false, &error)) fail_msg("%s", error.message);
    if (ck_run_measure(run, model, engine, &(ck_Settings){.substeps = 60}, &limits, &error))
        fail_msg("%s", error.message);
    if (run->status != CK_RUN_OK) fail_msg("%s: %s", name, run->reason);
    assert_int_equal(run->used.substeps, 60);
}

// The three adapters do the same sums, which differ by rounding.
static void test_examples(void **state) {
    (void)state;
    ck_Comparison comparison;
    ck_Run runs[3];
    const ck_Metric *position = ck_metric_find("position_rms");
    const ck_Reference none = {0};
    fixture_load_comparison(&comparison, "name: r\nrope: {particles: 5, spacing: 0.1, mass: 0.5, along: [1, 0, 0]}\n"
                                         "springs: {stiffness: 200, damping: 0.05}\npins: [first]\ngravity: [0, -9.81, "
                                         "0]\nforce: [0.1, 0, 0.1]\ndrag: 0.7\nvelocity: [0, 0, 1]\nrelease: [{at: "
                                         "0.4, pins: [first]}]\ntime: {duration: 0.6, fps: 60}\n");
    run_example(&runs[0], &comparison.model, "c", EXAMPLE);
    run_example(&runs[1], &comparison.model, "python", "python3 " EXAMPLES "/adapter.py");
    run_example(&runs[2], &comparison.model, "javascript", "node " EXAMPLES "/adapter.js");
    for (int i = 1; i < 3; i++) {
        double apart =
            ck_metric_deviation(position, &comparison.model, &runs[0].trajectory, &runs[i].trajectory, &none);
        assert_near("apart", apart, 0, 1e-12);
    }
    for (int i = 0; i < 3; i++) {
        ck_Engine *engine = (ck_Engine *)runs[i].engine;
        ck_run_free(&runs[i]);
        ck_outside_free(engine);
    }
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_four_ways),
        cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_refused),
        cmocka_unit_test(test_examples),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
