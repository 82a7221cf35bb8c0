// Programs to paste: they compile, and what they record is what the engine does, to rounding.
#include "fixture.h"
#include "fixture_program.h"

#include <jansson.h>

static void run_there(const char *command) {
    char line[1000];
    snprintf(line, sizeof line, "cd %s && (%s) > build.log 2>&1", fixture_directory, command);
    if (system(line)) fail_msg("%s: %s", command, fixture_read("build.log"));
}

// Writes the program of an engine on a scene, builds and runs it, and scores its path beside the engine.
static void run_program(const char *scene, const char *engine, const char *sets) {
    bool is_ode = !strncmp(engine, "ode", 3), is_mujoco = !strcmp(engine, "mujoco");
    char line[1000];
    snprintf(line, sizeof line, "code %s --engine %s %s", scene, engine, sets);
    if (fixture_program(line)) fail_msg("%s fails", line);
    run_there(
        is_mujoco ? "mv output cloth.c && cc -O1 -Wall -Wextra -Werror cloth.c -lmujoco -lm -o cloth && ./cloth > "
                    "path.csv"
        : is_ode  ? "mv output cloth.c && cc -O1 -Wall -Wextra -Werror cloth.c $(pkg-config --cflags --libs ode) -lm "
                    "-o cloth && ./cloth > path.csv"
                  : "mv output cloth.cpp && g++ -O1 -Wall -Werror -Wno-maybe-uninitialized cloth.cpp $(pkg-config "
                    "--cflags --libs bullet-float64 | sed 's/-I/-isystem /g') -o cloth && ./cloth > path.csv");
    snprintf(line, sizeof line,
             "score %s --path %s/path.csv --name pasted -e %s %s -r 0 --patience 0 --json --force --out %s/scored",
             scene, fixture_directory, engine, sets, fixture_directory);
    if (fixture_program(line)) fail_msg("%s fails", line);
}

static double number_of(json_t *runs, int run, const char *key) {
    return json_number_value(json_object_get(json_array_get(runs, (size_t)run), key));
}

// Whatever the compiler makes of sums: rounding, which a scene at rest does not let grow. Of a conjugate gradient that
// ends by its residual, 1e-9 of the size.
static void test_programs(void **state) {
    (void)state;
    static const struct {
        const char *scene, *engine, *sets;
    } cases[] = {
        {"rope_hanging", "bullet-pbd", ""},
        {"cloth_released", "bullet-pbd", "--set bullet-pbd.reordered=1"},
        {"cloth_on_sphere", "bullet-pbd", ""},
        {"network_truss", "bullet-pbd", "--set bullet-pbd.kLST=0.4"},
        {"cloth_released", "bullet-implicit", ""},
        {"bounce", "bullet-implicit", ""},
        {"incline_slips", "bullet-explicit", ""},
        {"cloth_release", "ode-quick", ""},
        {"cloth_on_sphere", "ode-quick", ""},
        {"pendulum", "ode-direct", ""},
        {"rope_over_edge", "ode-direct", ""},
        {"cloth_released", "ode-quick", "--set ode-quick.erp=0.3 --set ode-quick.cfm=0.1"},
        {"cloth_released", "mujoco", ""},
        {"bounce", "mujoco", ""},
        {"network_truss", "mujoco", "--set mujoco.integrator=1"},
    };
    size_t count = sizeof cases / sizeof *cases;
#ifdef __SANITIZE_ADDRESS__
    count = 1; // what the program prints is the same, and its engines take minutes here
#endif
    for (size_t i = 0; i < count; i += fixture_asks_all() ? 1 : 3) {
        char scene[100];
        if (!ck_engine_find(cases[i].engine)) continue; // MuJoCo is not everywhere
        // a truth is not what is asked, and some take long
        snprintf(scene, sizeof scene, "%s@truth=none", cases[i].scene);
        run_program(scene, cases[i].engine, cases[i].sets);
        char *text = fixture_read("output");
        json_t *document = json_loads(text, 0, NULL), *runs = json_object_get(document, "runs");
        assert_int_equal(json_array_size(runs), 2);
        static const char *const keys[] = {"sag", "stretch_max"};
        for (size_t k = 0; k < 2; k++) {
            double pasted = number_of(runs, 0, keys[k]), engine = number_of(runs, 1, keys[k]);
            if (!(fabs(pasted - engine) <= 1e-9))
                fail_msg("%s by %s: %s %.17g, and %.17g as pasted", cases[i].scene, cases[i].engine, keys[k], engine,
                         pasted);
        }
        json_decref(document);
        free(text);
    }
}

static void test_usage(void **state) {
    (void)state;
    assert_int_equal(fixture_program("code rope_hanging"), 2);
    fixture_assert_output("code needs one --engine NAME, of bullet-pbd, bullet-implicit, bullet-explicit, ode-quick");
    assert_int_equal(fixture_program("code rope_hanging -e native-verlet"), 2);
    fixture_assert_output("native-verlet has no program to paste; these have: bullet-pbd");
    assert_int_equal(fixture_program("code pendulum -e bullet-implicit"), 1);
    fixture_assert_output("bullet-implicit does not model rigid bars");
}

// A recording joins a comparison that is there, and nothing is lost.
static void test_score(void **state) {
    (void)state;
    char line[600];
    run_program("rope_hanging", "ode-quick", "");
    snprintf(line, sizeof line, "compare rope_hanging -e native-verlet -r 1 --out %s/joined", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    snprintf(line, sizeof line, "score rope_hanging --path %s/path.csv --cost-ms 0.25 --out %s/joined",
             fixture_directory, fixture_directory);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("holds results of rope_hanging by native-verlet, which would be lost; --append keeps them");
    snprintf(line, sizeof line, "score rope_hanging --path %s/path.csv --cost-ms 0.25 --append --out %s/joined",
             fixture_directory, fixture_directory);
    for (int twice = 0; twice < 2; twice++) {
        assert_int_equal(fixture_program(line), 0);
        char *runs = fixture_read("joined/runs.csv"), *replay = fixture_read("joined/replays/rope_hanging.replay");
        assert_non_null(strstr(runs, "\nrope_hanging,native-verlet,ok"));
        char *row = strstr(runs, "\nrope_hanging,recorded,ok");
        assert_non_null(row);
        assert_null(strstr(row + 1, "\nrope_hanging,recorded"));
        assert_non_null(strstr(replay, "paths 3\npath native-verlet\npath recorded\npath truth\n"));
        free(runs);
        free(replay);
    }
    char *said = fixture_read("output");
    assert_null(strstr(said, "a pin, is"));
    free(said);
    // a recording whose pin stays where another scene drives it
    run_there("head -n 741 path.csv > half.csv");
    snprintf(line, sizeof line, "score rope_pulled --path %s/half.csv -r 0", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    fixture_assert_output("particle 0, a pin, is 1 m from where the scene has it at t = 0.2 s");
    snprintf(line, sizeof line, "report %s/joined", fixture_directory);
    assert_int_equal(fixture_program(line), 0);
    assert_int_equal(fixture_program("score rope_hanging --path tests/README.md"), 2);
    fixture_assert_output("tests/README.md:1: the header has no column x");
    assert_int_equal(fixture_program("score rope_hanging"), 2);
    snprintf(line, sizeof line, "score rope_hanging --path %s/path.csv --name native-verlet", fixture_directory);
    assert_int_equal(fixture_program(line), 2);
    fixture_assert_output("there is an engine native-verlet already");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_programs),
        cmocka_unit_test(test_usage),
        cmocka_unit_test(test_score),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
