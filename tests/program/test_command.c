// The program as a user meets it: exit statuses, what it writes, and that two runs write the same.
#include "fixture.h"
#include "fixture_program.h"

#include "files.h"

#include <glob.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void test_usage(void **state) {
    (void)state;
    static const struct {
        const char *arguments;
        int status;
        const char *output;
    } cases[] = {
        {"", 2, "clothcheck compare"},
        {"--help", 0, "clothcheck compare"},
        {"--version", 0, "clothcheck 0."},
        {"bench --help", 0, "bench.csv"},
        {"bench --rounds 0", 2, "must be a whole number from 1 to 99"},
        {"bench --only cots", 2, "--only cots: there is no such part or body; did you mean costs?; there are steps,"},
        {"bench --fast", 2, "--fast: no such option; 'clothcheck bench --help' tells"},
        {"claims --help", 0, "claims.csv"},
        {"claims rope", 2, "rope: claims takes no SCENE"},
        {"run rope_hanging --set seed-tecido.shine=1", 2,
         "seed-tecido has no shine; it has substeps, iterations, mended"},
        {"run rope_hanging --threads 0", 2, "--threads 0: it must be a whole number from 1 to 64"},
        {"run rope_hanging --threads 1.5", 2, "--threads 1.5: it must be a whole number from 1 to 64"},
        {"run rope_hanging --set seed-tecido.mended=0.5", 2, "seed-tecido.mended = 0.5: it must be a whole number"},
        {"fly", 2, "there is no command fly; known are demo, list"},
        {"tun", 2, "there is no command tun; did you mean tune?"},
        {"help", 0, "clothcheck compare"},
        {"help tune", 0, "clothcheck tune SCENE... [options]"},
        {"help fly", 2, "there is no command fly"},
        {"run -h", 0, "--engine NAME"},
        {"precision --help", 0, "cut and scored as far as it came; 0: any (default: 3)"},
        {"run", 2, "run takes one SCENE; none is given"},
        {"run --help", 0, "--engine NAME"},
        {"compare --help", 0, "--time-limit S"},
        {"list", 0, "native-verlet"},
        {"list all", 2, "there is no engine all; known are native-verlet"},
        {"list bullet-pbd", 0, "kLST         Material::m_kLST of every link, as it is; 1e-09 to 1"},
        {"list ode-quick", 0, "dWorldSetQuickStepW"},
        {"help --manual", 0, ".SS clothcheck run SCENE"},
        {"help --completion", 0, "complete -o filenames -F _clothcheck clothcheck"},
        {"run rope_hanging --engine=bullet-pbd -r0 --set bullet-pbd.piterations=4", 0, "4 iterations"},
        {"run rope_hanging -e bullet-pbd -r 0 -s bullet-pbd.iterations=4", 0, "4 iterations"},
        {"run rope_hanging -e bullet-pbd -r 0 -s bullet-pbd.kLST=0.1 --markdown", 0,
         "| Material::m_kLST | 0.1 | approximate | as set |"},
        {"run rope_hanging -e bullet-pbd -r 0 -s bullet-pbd.kDP=0.01 --markdown", 0,
         "| m_cfg.kDP | 0.01 | approximate | as set |"},
        {"run rope_hanging -e ode-quick -r 0 -s ode-quick.cfm=0.001 --markdown", 0,
         "| dParamCFM | 0.001 | approximate | as set |"},
        {"run rope_hanging -e ode-quick -r 0 -s ode-quick.erp=0.5 --markdown", 0,
         "| dParamERP | 0.5 | approximate | as set |"},
        {"run rope_hanging -e ode-quick -s ode-quick.sor=3", 2, "it must be a number from 0.01 to 2"},
        {"run rope_hanging -s native-xpbd.substeps=abc", 2,
         "substeps = abc: it must be a whole number from 1 to 1000000"},
        {"run rope_hanging -s native-xpbd.substeps=0", 2, "substeps = 0: it must be a whole number"},
        {"run rope_hanging -xyz", 2, "-x: no such option"},
        {"run oscillator -e 'ode-*' -r 0", 0, "ode-direct"},
        {"run oscillator -e 'havok-*' -r 0", 2, "there is no engine havok-*"},
        {"run rope_hanging free_fall", 2, "run takes one SCENE; 2 are given"},
        {"run rope_hanging --engine havok", 2, "there is no engine havok; known are native-verlet"},
        {"run rope_hanging --engine bulet-pbd", 2, "there is no engine bulet-pbd; did you mean bullet-pbd?"},
        {"run rope_hanging --fast", 2, "--fast: no such option"},
        {"run rope_hanging --engines still", 2, "--engines: no such option; did you mean --engine?"},
        {"run rope_hanging --out", 2, "needs a value"},
        {"run rope_hanging --repeats many", 2, "must be a whole number from 0 to 99"},
        {"compare rope_hanging --repeats 3.7", 2, "--repeats 3.7: it must be a whole number"},
        {"run rope_hanging --set ode-quick.substeps", 2, "must read ENGINE.KEY=NUMBER"},
        {"run rope_hanging --set ode-quick.substeps=1.5", 2, "ode-quick.substeps = 1.5: it must be a whole number"},
        {"run rope_hanging --set ode-quick.color=3", 2,
         "ode-quick has no color; it has substeps, iterations, sor, erp, cfm"},
        {"run rope_hanging --set bullet-pbd.relaxation=1.2", 2, "bullet-pbd has no relaxation"},
        {"run rope_hanging --set native-verlet.substep=2", 2, "has no substep; did you mean substeps?"},
        {"run nowhere", 2, "there is no scenes/nowhere.yaml; give a path"},
        {"run rope_hangin", 2, "there is no scenes/rope_hangin.yaml; did you mean rope_hanging?"},
        {"run scenes/nowhere.yaml", 2, "scenes/nowhere.yaml: No such file"},
        {"run oscillator --engine still --repeats 0", 0, "still: moves nothing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        int status = fixture_program(cases[i].arguments);
        if (status != cases[i].status) fail_msg("'%s' ended with %d", cases[i].arguments, status);
        fixture_assert_output(cases[i].output);
    }
}

// The tables of README files are what the program prints.
static void test_readme_tables(void **state) {
    (void)state;
    assert_int_equal(fixture_program("help --columns"), 0);
    char *printed = fixture_read("output"), *readme = NULL;
    size_t size;
    assert_int_equal(ck_file_read(&readme, &size, SCENE_DIRECTORY "/../reports/README.md", NULL), CK_OK);
    if (!strstr(readme, printed)) fail_msg("reports/README.md does not hold the output of clothcheck help --columns");
    free(readme);
    free(printed);
}

// A bad scene among good ones: nothing runs, nothing is written, not even the directory.
static void test_bad_input_writes_nothing(void **state) {
    (void)state;
    char *bad = fixture_file("name: bad\nrope: {particles: 2, spacing: 1, mass: 0}\ntime: {duration: 1, step: 0.1}\n"),
         arguments[300], out[100];
    snprintf(out, sizeof out, "%s/none", fixture_directory);
    snprintf(arguments, sizeof arguments, "compare oscillator %s --out %s/far//below/", bad, out);
    assert_int_equal(fixture_program(arguments), 2);
    fixture_assert_output(":2:40: rope.mass is 0; it must be a number above 0");
    assert_int_not_equal(access(out, F_OK), 0);
    unlink(bad);
    free(bad);
}

static void test_two_scenes_of_one_name(void **state) {
    (void)state;
    assert_int_equal(fixture_program("compare oscillator scenes/oscillator.yaml"), 2);
    fixture_assert_output("both named oscillator");
}

static void test_unwritable_output(void **state) {
    (void)state;
    assert_int_equal(fixture_program("compare oscillator --repeats 0 --out /proc/none"), 1);
    fixture_assert_output("/proc/none: ");
}

// The six files, whole, with the columns of the contract; and twice the same bytes in four of them.
static void test_comparison_repeats(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const files[] = {"runs.csv",       "machine.csv", "metrics.csv",
                                        "deviations.csv", "ledger.csv",  "series.csv"};
    static const char *const headers[] = {
        "scene,engine,status,reason,time_step_s,substeps,iterations,simulated_s,cpu_median_s,cpu_iqr_s,cpu_low_s,"
        "cpu_high_s,repeats,cpu_worst_step_s,realtime_factor,peak_rss_bytes,"
        "engine_version,method,command\n",
        "key,value\n",
        "scene,engine,metric,unit,value,truth,truth_kind,truth_uncertainty,error,predicted\n",
        "scene,metric,engine,other_engine,deviation,unit\n",
        "scene,engine,quantity,wanted,unit,native_parameter,native_value,formula,match\n",
        "scene,engine,time_s,metric,value\n",
    };
    for (int round = 0; round < 2; round++) {
        char arguments[300];
        snprintf(arguments, sizeof arguments,
                 "compare free_fall oscillator rope_hanging --full --repeats %d --seed %d --out %s/%d", round,
                 round + 1, fixture_directory, round);
        assert_int_equal(fixture_program(arguments), 0);
    }
    for (int i = 0; i < 6; i++) {
        char name[60];
        snprintf(name, sizeof name, "0/%s", files[i]);
        char *first = fixture_read(name);
        snprintf(name, sizeof name, "1/%s", files[i]);
        char *second = fixture_read(name);
        assert_non_null(first);
        assert_non_null(second);
        if (strncmp(first, headers[i], strlen(headers[i]))) fail_msg("%s begins with %.200s", files[i], first);
        if (i >= 2) assert_string_equal(first, second);
        free(first);
        free(second);
    }
    char pattern[100];
    glob_t left;
    snprintf(pattern, sizeof pattern, "%s/0/*.part", fixture_directory);
    assert_int_equal(glob(pattern, 0, NULL, &left), GLOB_NOMATCH);
}

// Interrupted in the middle of a long run: no file is left, neither whole nor begun, and no solver goes on.
static void test_interrupt(void **state) {
    (void)state;
    static const char *const signals[] = {"INT", "HUP"};
    for (int i = 0; i < 2; i++) {
        char command[500], pattern[100];
        glob_t left;
        snprintf(command, sizeof command,
                 "cd %s/.. && timeout -s %s 1 %s compare oscillator cloth_two_corners --engine ode-direct --out %s/cut "
                 ">/dev/null 2>&1",
                 SCENE_DIRECTORY, signals[i], PROGRAM, fixture_directory);
        int status = system(command);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 124); // timeout's own word for having sent the signal
        snprintf(pattern, sizeof pattern, "%s/cut/*.*", fixture_directory);
        assert_int_equal(glob(pattern, 0, NULL, &left), GLOB_NOMATCH);
    }
}

// A folder of that name that is not ours stays as it is; a scene may be called as our files are.
static void test_folder_of_others(void **state) {
    (void)state;
    char command[900];
    snprintf(
        command, sizeof command,
        "cd %s && mkdir -p mine/unfinished && echo precious >mine/unfinished/work && %s compare %s/oscillator.yaml "
        "%s/bounce.yaml --engine still --repeats 0 --out mine 2>&1 | grep -q 'is no folder of an unfinished "
        "comparison' "
        "&& grep -q precious mine/unfinished/work && sed 's/^name: .*/name: question/' %s/oscillator.yaml >q.yaml && "
        "sed 's/^name: .*/name: replays/' %s/bounce.yaml >r.yaml && %s compare q.yaml r.yaml --engine still --repeats "
        "0 "
        "--out named >/dev/null && test -s named/replays/question.replay && test ! -e named/unfinished && "
        "test -z \"$(find named/replays -type d -mindepth 1)\"",
        fixture_directory, PROGRAM, SCENE_DIRECTORY, SCENE_DIRECTORY, SCENE_DIRECTORY, SCENE_DIRECTORY, PROGRAM);
    assert_int_equal(system(command), 0);
}

// What compare writes of a scene with solids, moving ones among them, report takes.
static void test_report_of_solids(void **state) {
    (void)state;
    char command[900];
    snprintf(
        command, sizeof command,
        "cd %s && printf 'name: solids\\nrope: {particles: 2, spacing: 0.1, mass: 1}\\ngravity: [0, -9.81, "
        "0]\\ncolliders: [{capsule: {from: [0, -1, 0], to: [1, -1, 0], radius: 0.1}}, {cylinder: {point: [0, -2, 0], "
        "axis: [0, 0, 1], radius: 0.1}, path: {velocity: [0, 1, 0]}}, {box: {center: [0, -3, 0], size: [1, 1, "
        "1]}}]\\ntime: {duration: 0.2, fps: 10}\\n' >solids.yaml && %s compare solids.yaml --engine native-verlet "
        "--engine still --repeats 0 --out solids >/dev/null && %s report solids >/dev/null && test -s "
        "solids/index.html",
        fixture_directory, PROGRAM, PROGRAM);
    assert_int_equal(system(command), 0);
}

// Whoever reads what is printed may go, as head does: the results are there all the same, and the status says it.
static void test_reader_gone(void **state) {
    (void)state;
    char command[500], *rows;
    snprintf(command, sizeof command,
             "cd %s/.. && (%s compare oscillator --engine native-verlet --out %s/gone 2>/dev/null; echo $? "
             ">%s/gone.status) | true",
             SCENE_DIRECTORY, PROGRAM, fixture_directory, fixture_directory);
    assert_int_equal(system(command), 0);
    rows = fixture_read("gone/metrics.csv");
    assert_non_null(rows);
    free(rows);
    char *status = fixture_read("gone.status");
    assert_string_equal(status, "1\n");
    free(status);
}

static void test_full_disk(void **state) {
    (void)state;
    char command[500];
    snprintf(command, sizeof command, "cd %s/.. && %s list >/dev/full 2>/dev/null", SCENE_DIRECTORY, PROGRAM);
    int status = system(command);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 1);
}

static char *update_baseline(const char *options) {
    char command[600];
    snprintf(command, sizeof command,
             "cd %s && %s check --update %s/oscillator.yaml --engine native-verlet %s >/dev/null 2>&1",
             fixture_directory, PROGRAM, SCENE_DIRECTORY, options);
    int status = system(command);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    return fixture_read("tests/baseline/metrics.csv");
}

// Only what was measured moves, in its place; a run that does not come to its end stays as it was.
static void test_update_keeps(void **state) {
    (void)state;
    static const char header[] = "scene,engine,status,metric,value,band\n",
                      old[] = "oscillator,native-verlet,ok,sag,1,1\n", others[] = "free_fall,still,ok,sag,1,1\n";
    char command[500], wanted[300];
    snprintf(wanted, sizeof wanted, "%s%s%s", header, old, others);
    snprintf(command, sizeof command, "mkdir -p %s/tests/baseline && printf '%s' > %s/tests/baseline/metrics.csv",
             fixture_directory, wanted, fixture_directory);
    assert_int_equal(system(command), 0);
    char *cut_off = update_baseline("--set native-verlet.substeps=1000000 --time-limit 0.1"),
         *whole = update_baseline("");
    assert_string_equal(cut_off, wanted);
    assert_null(strstr(whole, old));
    assert_non_null(strstr(whole, "oscillator,native-verlet,ok,period,0.6"));
    assert_string_equal(whole + strlen(whole) - strlen(others), others);
    free(cut_off);
    free(whole);
}

// The program in the test's directory; its output goes to output there.
static int run_there(const char *before, const char *arguments) {
    char command[900];
    snprintf(command, sizeof command, "cd %s && %s %s %s >output 2>&1", fixture_directory, before, PROGRAM, arguments);
    int status = system(command);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

// No baseline is wrong usage, and no deviation.
static void test_no_baseline(void **state) {
    (void)state;
    assert_int_equal(run_there("mkdir -p empty && cd empty &&", "check " SCENE_DIRECTORY "/oscillator.yaml"), 2);
    char *output = fixture_read("empty/output");
    assert_non_null(
        strstr(output, "tests/baseline/metrics.csv: cannot be read; 'clothcheck check --update' writes it"));
    free(output);
}

static int count_of(const char *name, const char *wanted) {
    char *text = fixture_read(name);
    int count = 0;
    for (char *at = text; (at = strstr(at, wanted)); at++) count++;
    free(text);
    return count;
}

// Results that a directory holds are replaced by the same anew; others are kept or given up by the user's word alone.
static void test_keeping(void **state) {
    (void)state;
#define KEPT "compare --repeats 0 --engine native-verlet --out kept " SCENE_DIRECTORY
    assert_int_equal(run_there("", KEPT "/oscillator.yaml --engine still"), 0);
    assert_int_equal(run_there("", KEPT "/oscillator.yaml --engine still"), 0);
    assert_int_equal(run_there("", KEPT "/free_fall.yaml"), 2);
    fixture_assert_output("holds results of oscillator by native-verlet, which would be lost; --append keeps them");
    fixture_assert_output("--force replaces what is there");
    assert_int_equal(run_there("", KEPT "/free_fall.yaml --append"), 0);
    assert_int_equal(count_of("kept/runs.csv", "\noscillator,"), 2);
    assert_int_equal(count_of("kept/runs.csv", "\nfree_fall,"), 1);
    assert_true(count_of("kept/series.csv", "\noscillator,native-verlet,") > 100);
    assert_true(count_of("kept/series.csv", "\nfree_fall,native-verlet,") > 100);
    // an engine less
    assert_int_equal(run_there("", KEPT "/oscillator.yaml --append"), 2);
    fixture_assert_output("holds results of oscillator by still");
    assert_int_equal(count_of("kept/runs.csv", "\noscillator,"), 2);
    // of another machine
    assert_int_equal(
        run_there("sed -i 's/^processor,.*/processor,Z80/' kept/machine.csv &&", KEPT "/pendulum.yaml --append"), 2);
    fixture_assert_output("kept/machine.csv: its processor is not '");
    assert_int_equal(run_there("", KEPT "/free_fall.yaml --force"), 0);
    assert_int_equal(count_of("kept/runs.csv", "\noscillator,"), 0);
    assert_int_equal(count_of("kept/runs.csv", "\nfree_fall,"), 1);
    assert_int_equal(run_there("echo x > kept/runs.csv &&", KEPT "/free_fall.yaml"), 2);
    fixture_assert_output("kept/runs.csv:1: column 1 is 'x' where it must be scene; --force replaces");
}

static int compare_into(const char *directory, const char *sets) {
    char line[400];
    snprintf(line, sizeof line, "compare oscillator -e native-verlet %s -r 2 --force --out %s/%s", sets,
             fixture_directory, directory);
    return fixture_program(line);
}

static int diff(const char *old, const char *new, const char *options) {
    char line[600];
    snprintf(line, sizeof line, "diff %s/%s %s/%s %s", fixture_directory, old, fixture_directory, new, options);
    return fixture_program(line);
}

// The same results have not moved; those of another step have, and are told as a table that a pull request shows.
static void test_diff(void **state) {
    (void)state;
    assert_int_equal(compare_into("one", ""), 0);
    assert_int_equal(compare_into("same", ""), 0);
    assert_int_equal(compare_into("other", "--set native-verlet.substeps=7"), 0);
    assert_int_equal(compare_into("two", "-e still"), 0);
    assert_int_equal(diff("one", "same", ""), 0);
    fixture_assert_output("0 values moved, 0 runs ended otherwise");
    assert_int_equal(diff("one", "other", "--markdown"), 1);
    fixture_assert_output("| scene | engine | metric | was | is | error was | error is | known to |");
    fixture_assert_output("| oscillator | native-verlet | position_rms |");
    assert_int_equal(diff("one", "two", ""), 0);
    fixture_assert_output("0 runs are in");
    assert_int_equal(diff("one", "none", ""), 1);
    assert_int_equal(fixture_program("diff one"), 2);
    fixture_assert_output("diff takes OLD and NEW");
}

// An engine under a second name runs beside itself at other settings, over those that the scene has for it; its row
// says how to run it again.
static void test_second_name(void **state) {
    (void)state;
    char line[500], *scene = fixture_file("name: swing\nrope: {particles: 3, spacing: 0.5, mass: 1}\npins: [first]\n"
                                          "springs: {stiffness: 500}\ngravity: [0, -9.81, 0]\n"
                                          "time: {duration: 0.5, fps: 20}\ntruth: trajectory\n"
                                          "settings: {native-xpbd: {iterations: 3}}\n");
    snprintf(line, sizeof line,
             "compare %s -e native-xpbd -e coarse=native-xpbd -s native-xpbd.substeps=200 -s coarse.substeps=5 -r 0 "
             "--out %s/second",
             scene, fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    char *runs = fixture_read("second/runs.csv"), *metrics = fixture_read("second/metrics.csv");
    const char *fine = strstr(metrics, "\nswing,native-xpbd,position_rms,"),
               *coarse = strstr(metrics, "\nswing,coarse,position_rms,");
    assert_true(fine && coarse);
    double errors[2];
    assert_int_equal(sscanf(fine, "\nswing,native-xpbd,position_rms,%*[^,],%lf", &errors[0]), 1);
    assert_int_equal(sscanf(coarse, "\nswing,coarse,position_rms,%*[^,],%lf", &errors[1]), 1);
    // of first order in the step, which is 40 times as long
    assert_true(errors[1] > 10 * errors[0]);
    assert_non_null(strstr(runs, "\nswing,coarse,ok,"));
    assert_non_null(strstr(runs, " --engine coarse=native-xpbd --set coarse.substeps=5"));
    assert_non_null(strstr(runs, ",5,3,"));
    snprintf(line, sizeof line, "run %s -e native-bars=native-xpbd", scene);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("there is an engine native-bars already");
    unlink(scene);
    free(scene);
    free(metrics);
    free(runs);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_second_name),
        cmocka_unit_test(test_usage),
        cmocka_unit_test(test_readme_tables),
        cmocka_unit_test(test_bad_input_writes_nothing),
        cmocka_unit_test(test_two_scenes_of_one_name),
        cmocka_unit_test(test_unwritable_output),
        cmocka_unit_test(test_comparison_repeats),
        cmocka_unit_test(test_interrupt),
        cmocka_unit_test(test_reader_gone),
        cmocka_unit_test(test_report_of_solids),
        cmocka_unit_test(test_folder_of_others),
        cmocka_unit_test(test_full_disk),
        cmocka_unit_test(test_update_keeps),
        cmocka_unit_test(test_no_baseline),
        cmocka_unit_test(test_keeping),
        cmocka_unit_test(test_diff),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
