// A solver's own repository guards it: built with other flags it passes, with a stiffness off by a hundredth it does
// not.
#include "fixture.h"
#include "fixture_program.h"

#include <unistd.h>

static const char rope[] =
    "name: rope\nrope: {particles: 12, spacing: 0.1, mass: 0.6}\nsprings: {stiffness: 400}\npins: "
    "[first]\ngravity: [0, -9.81, 0]\ndrag: 6\ntime: {duration: 4, fps: 60}\ntruth: "
    "equilibrium\n";
static const char cape[] =
    "name: cape\ncloth: {rows: 8, columns: 6, spacing: 0.1, mass: 0.2, down: [0, 0, 1]}\nsprings: "
    "{stiffness: 300, shear: 150}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\ndrag: "
    "4\ntime: {duration: 6, fps: 60}\ntruth: equilibrium\n";

static int check(const char *scenes, const char *library, const char *options) {
    char line[1000];
    snprintf(line, sizeof line, "check %s --engine mine=%s --baseline %s/mine.csv --out %s/out %s", scenes, library,
             fixture_directory, fixture_directory, options);
    return fixture_program(line);
}

static void test_guard(void **state) {
    (void)state;
    char *one = fixture_file(rope), *other = fixture_file(cape), scenes[200];
    snprintf(scenes, sizeof scenes, "%s %s", one, other);
    assert_int_equal(check(scenes, FLOAT_LIBRARY, ""), 2);
    fixture_assert_output("mine.csv: cannot be read; 'clothcheck check --update' writes it");
    assert_int_equal(check(scenes, FLOAT_LIBRARY, "--update"), 0);
    assert_int_equal(check(scenes, FLOAT_LIBRARY, ""), 0);
    fixture_assert_output("2 runs, 0 deviations");
    // other instructions, another order of sums: what float rounds, and no more
    assert_int_equal(check(scenes, FAST_LIBRARY, ""), 0);
    assert_int_equal(check(scenes, FAST_LIBRARY, "--tolerance 1%"), 0);
    assert_int_equal(check(scenes, SOFT_LIBRARY, ""), 1);
    assert_int_equal(check(scenes, SOFT_LIBRARY, "--tolerance 1%"), 1);
    fixture_assert_output("stretch_peak");
    assert_int_equal(check(scenes, SOFT_LIBRARY, "--tolerance 3%"), 0);
    assert_int_equal(check(scenes, FLOAT_LIBRARY, "--tolerance sag"), 2);
    fixture_assert_output("--tolerance sag: it must read X%, METRIC=X or METRIC=X%");
    for (char **path = (char *[]){one, other, NULL}; *path; path++) {
        unlink(*path);
        free(*path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_guard)};
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
