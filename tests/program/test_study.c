// Studies through the program: killed and resumed, in parts and merged; and what they find where it is known.
#include "csv_reader.h"
#include "fixture.h"
#include "fixture_program.h"

#include "stability_study.h"
#include "statistics.h"
#include "time_scale.h"

#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

// %s in arguments is the fixture_directory, up to five times.
static void fill(char *filled, size_t size, const char *arguments) {
    const char *at = fixture_directory;
    snprintf(filled, size, arguments, at, at, at, at, at);
}

static pid_t start(const char *arguments) {
    char filled[800];
    fill(filled, sizeof filled, arguments);
    return fixture_start(filled);
}

static void finish(const char *arguments, int wanted) {
    char filled[800];
    fill(filled, sizeof filled, arguments);
    int status = fixture_program(filled);
    if (status != wanted) fail_msg("%s: exit status %d, %s", filled, status, fixture_read("output"));
}

static char *read_text(const char *name) {
    char *text = fixture_read(name);
    if (!text) fail_msg("%s is not there", name);
    return text;
}

static void assert_same(const char *one, const char *other) {
    char *a = read_text(one), *b = read_text(other);
    if (strcmp(a, b)) fail_msg("%s and %s differ", one, other);
    assert_true(strlen(a) > 1000);
    free(a);
    free(b);
}

static long size_of(const char *name) {
    char path[200];
    struct stat about;
    snprintf(path, sizeof path, "%s/%s", fixture_directory, name);
    return stat(path, &about) ? -1 : (long)about.st_size;
}

#define STUDY "stability rope_hanging --engine native-verlet --engine native-xpbd --engine bullet-pbd --jobs 2 --out "

// Killed twenty times at a random moment, nothing is lost or repeated: the journal only grows, the CSV is the same.
static void test_kill(void **state) {
    (void)state;
    ck_Random random = ck_random_seed(11);
    long size = -1;
    int kills = 0, status = 0;
    finish(STUDY "%s/whole", 0);
    for (int i = 0; i < 20; i++) {
        pid_t child = start(STUDY "%s/killed");
        usleep((useconds_t)(60000 * ck_random_unit(&random)));
        kill(child, SIGKILL);
        waitpid(child, &status, 0);
        const long now = size_of("killed/stability.journal");
        // a study that got to its end has taken its journal away
        if (WIFEXITED(status) || size_of("killed/stability.csv") > 0) break;
        assert_true(now >= size - 400); // what a kill cut off is dropped: at most one row
        size = now;
        kills++;
    }
    print_message("%d kills, %ld bytes of journal\n", kills, size);
    finish(STUDY "%s/killed", 0);
    assert_same("whole/stability.csv", "killed/stability.csv");
    assert_int_equal(size_of("killed/stability.journal"), -1);
}

#define COMPARISON                                                                                                     \
    "compare oscillator bounce slide_0 incline_slips rope_hanging --engine native-verlet --engine native-xpbd "        \
    "--engine bullet-pbd --repeats 1 --out "

// Killed as soon as one scene more is finished, a comparison goes on with those that it has, to the same rows; what it
// leaves meanwhile is gone in the end.
static void test_kill_comparison(void **state) {
    (void)state;
    static const char *const files[] = {"metrics.csv", "deviations.csv", "ledger.csv", "series.csv"};
    static const char *const scenes[] = {"oscillator", "bounce", "slide_0", "incline_slips"};
    int kills = 0, kept = 0;
    finish(COMPARISON "%s/undisturbed", 0);
    for (int i = 0; i < 4; i++) {
        char whole[100];
        int status = 0, ended = 0;
        snprintf(whole, sizeof whole, "disturbed/unfinished/scenes/%s/machine.csv", scenes[i]);
        pid_t child = start(COMPARISON "%s/disturbed");
        while (size_of(whole) < 0 && !(ended = waitpid(child, &status, WNOHANG))) usleep(500);
        if (!ended) {
            kill(child, i % 2 ? SIGKILL : SIGHUP);
            waitpid(child, &status, 0);
        }
        if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
        kills++;
        char *said = fixture_read("output");
        kept += said && strstr(said, "as it was finished before the interruption") != NULL;
        free(said);
    }
    assert_true(kills >= 2);
    finish(COMPARISON "%s/disturbed", 0);
    print_message("%d kills, %d runs went on\n", kills, kept);
    for (int i = 0; i < 4; i++) {
        char one[60], other[60];
        snprintf(one, sizeof one, "undisturbed/%s", files[i]);
        snprintf(other, sizeof other, "disturbed/%s", files[i]);
        assert_same(one, other);
    }
    assert_int_equal(size_of("disturbed/unfinished"), -1);
    assert_true(size_of("disturbed/replays/slide_0.replay") == size_of("undisturbed/replays/slide_0.replay"));
    assert_true(size_of("disturbed/replays/slide_0.replay") > 0);
}

static void test_shards(void **state) {
    (void)state;
    finish(STUDY "%s/1 --shard 1/4", 0);
    finish(STUDY "%s/2 --shard 2/4", 0);
    finish(STUDY "%s/3 --shard 3/4", 0);
    finish(STUDY "%s/4 --shard 4/4", 0);
    finish("merge %s/all %s/1 %s/2 %s/3 %s/4", 0);
    assert_same("whole/stability.csv", "all/stability.csv");
    assert_true(size_of("whole/machine.csv") > 0 && size_of("all/machine.csv") > 0);
    // the scene's text counts, not its path
    finish("stability scenes/../scenes/rope_hanging.yaml --engine native-verlet --engine native-xpbd --engine "
           "bullet-pbd --jobs 2 --shard 4/4 --out %s/elsewhere",
           0);
    finish("merge %s/again %s/elsewhere %s/1 %s/2 %s/3", 0);
    assert_same("whole/stability.csv", "again/stability.csv");
    finish("stability rope_catenary --engine native-verlet --shard 1/2 --out %s/other", 0);
    finish("merge %s/none %s/1 %s/other", 2);
    finish("merge %s/none %s/empty", 2);
    finish("merge %s/1 %s/1 %s/2", 2);
    fixture_assert_output("is a part, too");
    finish("stability rope_hanging --shard 5/4", 2);
}

// A directory is one study's at a time, and what is unfinished there is not thrown away for another.
static void test_two_at_once(void **state) {
    (void)state;
    fixture_skip_long();
    pid_t busy = start("stability rope_hanging -e native-verlet -e bullet-pbd -e ode-quick --jobs 1 --out %s/busy");
    int ended = 0;
    while (size_of("busy/stability.journal") <= 0 && !(ended = waitpid(busy, NULL, WNOHANG))) usleep(500);
    assert_false(ended);
    // it stands still and holds what it has, however long the other waits
    kill(busy, SIGSTOP);
    finish("stability rope_catenary --engine native-verlet --out %s/busy", 2);
    fixture_assert_output("another clothcheck is writing there");
    kill(busy, SIGKILL);
    waitpid(busy, NULL, 0);
    const long size = size_of("busy/stability.journal");
    assert_true(size > 0);
    finish("stability rope_catenary --engine native-verlet --out %s/busy", 2);
    assert_true(size_of("busy/stability.journal") == size);
    finish("stability rope_hanging -e native-verlet -e bullet-pbd -e ode-quick --jobs 2 --out %s/busy", 0);
}

// The growth of one damped mode over many steps of velocity Verlet with predicted velocity, or of symplectic Euler with
// implicit damping; in units of its start.
static double grow(ck_Method method, double frequency, double damping, double dt) {
    double x = 1, v = 0, a = -frequency * frequency;
    for (int i = 0; i < 40000 && fabs(x) < 1e6; i++) {
        if (method == CK_METHOD_VELOCITY_VERLET) {
            double predicted = v + dt * a, before = a;
            x += dt * v + 0.5 * dt * dt * a;
            a = -frequency * frequency * x - damping * predicted;
            v += 0.5 * dt * (before + a);
        } else {
            v = (v - dt * frequency * frequency * x) / (1 + damping * dt);
            x += dt * v;
        }
    }
    return fabs(x);
}

// The limits of theory are where the method's own recurrence turns from bounded to growing.
static void test_limits(void **state) {
    (void)state;
    static const ck_Method methods[] = {CK_METHOD_VELOCITY_VERLET, CK_METHOD_SYMPLECTIC_EULER};
    for (int i = 0; i < 2; i++)
        for (double damping = 0; damping < 300; damping = 3 * damping + 1) {
            double limit = ck_stability_limit(methods[i], (ck_Vibration){50, damping}, (ck_Vibration){0, 0});
            assert_true(grow(methods[i], 50, damping, 0.999 * limit) < 100);
            assert_true(grow(methods[i], 50, damping, 1.001 * limit) > 1e5);
        }
    // damping along springs that would allow 6 s does not reach what swings across them: 2/20 s
    double limit = ck_stability_limit(CK_METHOD_SYMPLECTIC_EULER, (ck_Vibration){27.9, 4800}, (ck_Vibration){20, 0});
    assert_near("across springs", limit, 0.1, 1e-12);
}

// Fields of one CSV row whose first fields are these; fails where there is none.
static void find_row(char *row, size_t size, const char *name, const char *start) {
    char *text = read_text(name), *at = strstr(text, start);
    if (!at) fail_msg("%s has no row %s", name, start);
    snprintf(row, size, "%.*s", at ? (int)strcspn(at, "\n") : 0, at ? at : "");
    free(text);
}

static double field_of(const char *row, int index) {
    for (; index > 0; index--) row = strchr(row, ',') + 1;
    return atof(row);
}

// Critical steps at those of theory, of springs and of bending: 2 % undamped, 5 % damped; ODE's, whose theory leaves
// damping out, 10 % with it.
static void test_critical(void **state) {
    (void)state;
    static const char *const scenes[] = {"rope_hanging", "cantilever"};
    static const struct {
        const char *engine, *damping;
        double tolerance;
    } rows[] = {{"native-verlet", "none", 0.02},    {"native-verlet", "scene", 0.05}, {"bullet-explicit", "none", 0.05},
                {"bullet-explicit", "scene", 0.05}, {"ode-quick", "none", 0.02},      {"ode-quick", "scene", 0.1}};
    for (size_t scene = 0; scene < sizeof scenes / sizeof *scenes; scene++) {
        char row[1000], start[200], command[300];
        snprintf(command, sizeof command,
                 "stability %s --engine native-verlet --engine bullet-explicit --engine ode-quick --append "
                 "--out %%s/critical",
                 scenes[scene]);
        finish(command, 0);
        for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
            snprintf(start, sizeof start, "%s,%s,critical,%s,", scenes[scene], rows[i].engine, rows[i].damping);
            find_row(row, sizeof row, "critical/stability.csv", start);
            *strrchr(row, ',') = 0; // rounding_step_s, behind the ratio
            assert_near(row, atof(strrchr(row, ',') + 1), 1, rows[i].tolerance);
        }
    }
}

// Second order, damping and all.
static void test_precision(void **state) {
    (void)state;
    char row[1000];
    finish("precision oscillator --engine native-verlet --repeats 0 --out %s/precision", 0);
    find_row(row, sizeof row, "precision/precision_summary.csv", "oscillator,native-verlet,order");
    assert_near(row, field_of(row, 4), 2, 0.2);
    ck_CsvTable table;
    ck_Error error = {0};
    char directory[200];
    int on_front = 0;
    snprintf(directory, sizeof directory, "%s/precision", fixture_directory);
    if (ck_csv_table_read(&table, directory, &ck_layouts[CK_PRECISION], &error)) fail_msg("%s", error.message);
    for (int i = 0; i < table.row_count; i++) {
        on_front += ck_csv_number_of(&table, i, "on_front") == 1;
        // of doubles about a metre: 2.2e-16 m against g*dt^2, which this scene has none of
        assert_true(isnan(ck_csv_number_of(&table, i, "rounding")));
    }
    assert_in_range(on_front, 2, table.row_count);
    ck_csv_table_free(&table);
}

// A drag that does nothing is not needed, and it alone.
static void test_needs(void **state) {
    (void)state;
    char path[200], arguments[400], row[1000];
    snprintf(path, sizeof path, "%s/idle.yaml", fixture_directory);
    FILE *file = fopen(path, "w");
    fputs(
        "name: idle\ncloth: {rows: 8, columns: 8, spacing: 0.1, mass: 0.2, down: [0, 0, 1]}\nsprings: {stiffness: 50, "
        "shear: 20, damping: 0.5}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\ndrag: 1.0e-7\ntime: "
        "{duration: 1, step: 0.02}\n",
        file);
    fclose(file);
    snprintf(arguments, sizeof arguments, "needs %s --out %%s/needs", path);
    finish(arguments, 0);
    char *text = read_text("needs/needs.csv"), *output = read_text("output");
    for (char *at = text; (at = strstr(at, "\nidle,native-verlet,drag,")); at++)
        if (strstr(at, ",yes,") && strstr(at, ",yes,") < strchr(at + 1, '\n')) fail_msg("drag is said to matter");
    assert_non_null(strstr(output, "drag                     is not needed"));
    assert_non_null(strstr(output, "shear                    is needed"));
    assert_non_null(strstr(output, "spring damping           is needed"));
    find_row(row, sizeof row, "needs/needs.csv", "idle,native-verlet,drag,sag");
    free(text);
    free(output);
}

// Half as many springs of a rope leave it as long and as heavy, as soft, and as stiff to bend; a sheet that has no half
// of its own size is not tried.
static void test_half(void **state) {
    (void)state;
    char row[1000];
    finish("needs tests/cases/halved_rope.yaml --out %s/half", 0);
    find_row(row, sizeof row, "half/needs.csv", "halved_rope,native-verlet,every second particle,sag");
    assert_near("sag, of half", field_of(row, 6) - field_of(row, 5), 0.019, 5e-4);
    finish("needs tests/cases/no_half.yaml --append --out %s/half", 0);
    fixture_assert_output("every second particle    not tried");
    fixture_assert_output("no coarser grid of square cells has its size");
    find_row(row, sizeof row, "half/needs.csv", "no_half,native-verlet,every second particle,");
    assert_non_null(strstr(row, ",refused,"));
    assert_null(strstr(row, "inf"));
}

// A study's file is not written over by that of another scene, but by its own anew.
static void test_keeping(void **state) {
    (void)state;
    char row[1000];
    finish("needs oscillator --engine native-verlet --out %s/keep", 0);
    finish("needs oscillator --engine native-verlet --out %s/keep", 0);
    finish("needs pendulum --engine native-bars --out %s/keep", 2);
    fixture_assert_output("keep/needs.csv: holds results of oscillator by native-verlet, which would be lost");
    finish("needs pendulum --engine native-bars --out %s/keep --append", 0);
    find_row(row, sizeof row, "keep/needs.csv", "oscillator,native-verlet,");
    find_row(row, sizeof row, "keep/needs.csv", "pendulum,native-bars,");
    finish("needs pendulum --engine native-bars --out %s/keep --force", 0);
    char *text = read_text("keep/needs.csv");
    assert_null(strstr(text, "oscillator"));
    free(text);
}

// Three scenes, an answer for each, and the page.
static void test_demo(void **state) {
    (void)state;
    // its truth of contact takes ten times as long under the sanitizers, and has tests of its own there
#ifdef __SANITIZE_ADDRESS__
    skip();
#endif
    char arguments[200];
    snprintf(arguments, sizeof arguments, "demo -e native-verlet -e bullet-pbd --patience 100 --out %s/demo",
             fixture_directory);
    assert_int_equal(fixture_program(arguments), 0);
    fixture_assert_output("=> rope_hanging: the cheapest within 1 % of the truth is ");
    fixture_assert_output("=> cloth_two_corners: the cheapest within 1 % of the truth is ");
    fixture_assert_output("=> cloth_on_ball: the cheapest within 1 % of the truth is ");
    fixture_assert_output("demo/index.html");
    char *page = fixture_read("demo/index.html");
    assert_non_null(page);
    free(page);
}

// Every engine that takes a body is timed on it.
static void test_bench(void **state) {
    (void)state;
    fixture_skip_unasked();
    char arguments[100];
    snprintf(arguments, sizeof arguments, "bench --rounds 1 --largest 17 --out %s/bench", fixture_directory);
    assert_int_equal(fixture_program(arguments), 0);
    char *csv = fixture_read("bench/bench.csv");
    assert_non_null(csv);
    assert_non_null(strstr(csv, "rope,1000,999,native-verlet,,step_time,s,"));
    assert_non_null(strstr(csv, "rope,1000,999,bullet-pbd,10 iterations,update_time,ns,"));
    assert_non_null(strstr(csv, "mesh,289,800,native-verlet,,step_time,s,"));
    free(csv);
}

// A part of it by its name, or by its body's.
static void test_bench_only(void **state) {
    (void)state;
    fixture_skip_unasked();
    static const struct {
        const char *only, *is_there, *is_not;
    } cases[] = {{"growth", ",growth_step_time,", ",update_time,"}, {"rope", "rope,1000,999,native-verlet,,", "mesh"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char arguments[200];
        snprintf(arguments, sizeof arguments, "bench --rounds 1 --largest 16 --only %s --out %s/only", cases[i].only,
                 fixture_directory);
        assert_int_equal(fixture_program(arguments), 0);
        char *csv = fixture_read("only/bench.csv");
        assert_non_null(csv);
        assert_non_null(strstr(csv, cases[i].is_there));
        assert_null(strstr(csv, cases[i].is_not));
        free(csv);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_limits),     cmocka_unit_test(test_kill),        cmocka_unit_test(test_kill_comparison),
        cmocka_unit_test(test_shards),     cmocka_unit_test(test_two_at_once), cmocka_unit_test(test_critical),
        cmocka_unit_test(test_needs),      cmocka_unit_test(test_bench),       cmocka_unit_test(test_demo),
        cmocka_unit_test(test_half),       cmocka_unit_test(test_keeping),     cmocka_unit_test(test_precision),
        cmocka_unit_test(test_bench_only),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
