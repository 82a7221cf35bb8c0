// Tuning: the search over whole numbers where the least work is known, and what the program finds.
#include "fixture.h"
#include "fixture_program.h"

#include "tune_grid.h"

#include <unistd.h>

typedef struct Landscape {
    double (*error)(uint32_t substeps, uint32_t iterations, int variant);
    double tolerance;
    int calls;
} Landscape;

static bool meets(void *context, uint32_t substeps, uint32_t iterations, int variant) {
    Landscape *landscape = context;
    landscape->calls++;
    return landscape->error(substeps, iterations, variant) <= landscape->tolerance;
}

static double smooth(uint32_t substeps, uint32_t iterations, int variant) {
    return (variant == 1 ? 0.5 : 1) / (double)substeps / substeps / iterations;
}

// As smooth, but for one lucky pair that no rule of growth foretells.
static double lucky(uint32_t substeps, uint32_t iterations, int variant) {
    return substeps == 3 && iterations == 4 ? 0 : smooth(substeps, iterations, variant);
}

// The cheapest by trying every pair, in this file's own words.
static double cheapest(const Landscape *landscape, int variant_count) {
    double least = INFINITY;
    for (uint32_t substeps = 1; substeps < 200; substeps++)
        for (uint32_t iterations = 1; iterations < 200; iterations++)
            for (int variant = 0; variant < variant_count; variant++)
                if (landscape->error(substeps, iterations, variant) <= landscape->tolerance)
                    least = fmin(least, substeps * (1.0 + iterations));
    return least;
}

static void test_grid(void **state) {
    (void)state;
    static const double tolerances[] = {0.3, 0.02, 1e-3, 1e-4};
    for (size_t i = 0; i < sizeof tolerances / sizeof *tolerances; i++)
        for (int variants = 1; variants <= 2; variants++) {
            Landscape landscape = {.error = smooth, .tolerance = tolerances[i]};
            ck_TuneGrid grid = {.has_iterations = true,
                                .variant_count = variants,
                                .work = 5000,
                                .iterations = 49,
                                .most_tries = 400,
                                .meets = meets,
                                .context = &landscape};
            double wanted = cheapest(&landscape, variants);
            ck_tune_grid_refine(&grid);
            assert_near("refined, of the cheapest", grid.work / wanted, 1, 0.1);
            assert_true(landscape.calls == grid.tries);
            grid.most_tries = 100000;
            assert_true(ck_tune_grid_exhaust(&grid));
            assert_near("exhausted", grid.work, wanted, 0);
        }
}

static void test_lucky(void **state) {
    (void)state;
    Landscape landscape = {.error = lucky, .tolerance = 1e-3};
    ck_TuneGrid grid = {.has_iterations = true,
                        .variant_count = 1,
                        .work = 60,
                        .iterations = 1,
                        .most_tries = 1000,
                        .meets = meets,
                        .context = &landscape};
    assert_true(ck_tune_grid_exhaust(&grid));
    assert_near("the lucky pair", grid.work, 15, 0);
    grid = (ck_TuneGrid){.has_iterations = true,
                         .variant_count = 1,
                         .work = 60,
                         .iterations = 1,
                         .most_tries = 100,
                         .meets = meets,
                         .context = &landscape};
    landscape.calls = 0;
    assert_false(ck_tune_grid_exhaust(&grid));
    assert_int_equal(landscape.calls, 0);
}

static void test_no_iterations(void **state) {
    (void)state;
    Landscape landscape = {.error = smooth, .tolerance = 1e-4};
    ck_TuneGrid grid = {.variant_count = 1,
                        .work = 2 * 4096,
                        .iterations = 1,
                        .most_tries = 300,
                        .meets = meets,
                        .context = &landscape};
    ck_tune_grid_refine(&grid);
    assert_true(ck_tune_grid_exhaust(&grid));
    assert_near("a hundred substeps", grid.work, 200, 0);
}

// Work in sweeps a second at most; for grids so small that all that is cheaper is tried, it is exact.
static void test_program(void **state) {
    (void)state;
    static const struct {
        const char *arguments, *row;
        double work;
    } goals[] = {
        {"rope_hanging --engine bullet-pbd --error 0.01", "rope_hanging,bullet-pbd,best,2,1,", 240},
        {"rope_heavy_end --engine native-xpbd --error 0.05", "rope_heavy_end,native-xpbd,best,", 2400},
        {"rope_heavy_end --engine native-xpbd --error 0.005", "rope_heavy_end,native-xpbd,best,", 4320},
        {"tests/cases/soft_is_no_blowup.yaml --engine bullet-pbd --error 0.1", "soft_is_no_blowup,bullet-pbd,best,1,1,",
         120},
    };
    for (size_t i = 0; i < sizeof goals / sizeof *goals; i++) {
        char arguments[400];
        snprintf(arguments, sizeof arguments, "tune %s --out %s/tune%zu", goals[i].arguments, fixture_directory, i);
        assert_int_equal(fixture_program(arguments), 0);
        snprintf(arguments, sizeof arguments, "tune%zu/tune.csv", i);
        char *text = fixture_read(arguments), *row = strstr(text, goals[i].row);
        if (!row || !strstr(row, ",yes,")) fail_msg("%s: %s", goals[i].arguments, text);
        double work = atof(strstr(row, ",yes,") + strlen(",yes,"));
        if (!(work > 0 && work <= goals[i].work)) fail_msg("%s: %g sweeps a second", goals[i].arguments, work);
        free(text);
    }
}

static void test_refused(void **state) {
    (void)state;
    char arguments[400];
    snprintf(arguments, sizeof arguments,
             "tune rope_hanging --engine bullet-pbd --error 0.01 --validate "
             "rope_catenary --out %s/tune",
             fixture_directory);
    assert_int_equal(fixture_program(arguments), 0);
    char *text = fixture_read("tune/tune.csv");
    assert_non_null(strstr(text, "\nrope_catenary,bullet-pbd,validation"));
    free(text);
    snprintf(arguments, sizeof arguments, "tune rope_hanging --error 0.01 --out %s/tune", fixture_directory);
    assert_int_equal(fixture_program(arguments), 2);
    snprintf(arguments, sizeof arguments, "tune rope_hanging --engine bullet-pbd --vary mass --out %s/tune",
             fixture_directory);
    assert_int_equal(fixture_program(arguments), 2);
}

// A goal that no engine can reach is refused before anything takes time, with what would help.
static void test_unreachable(void **state) {
    (void)state;
    static const struct {
        const char *terms, *wanted;
    } cases[] = {
        {"drag: 0.5\ntime: {duration: 2, fps: 60}",
         "drag of 0.5/s takes some 27.6 s to bring the scene to rest, and it has 2 s"},
        {"time: {duration: 2, fps: 60}", "without drag and spring damping the scene never comes to its rest"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600], arguments[300];
        snprintf(text, sizeof text,
                 "name: cape\ncloth: {rows: 6, columns: 4, spacing: 0.1, mass: 0.3, down: [0, 0, 1]}\nsprings: "
                 "{stiffness: 800, shear: 400}\npins: [top_edge]\ngravity: [0, -9.81, 0]\ntruth: equilibrium\n%s\n",
                 cases[i].terms);
        char *path = fixture_file(text);
        snprintf(arguments, sizeof arguments, "tune %s -e bullet-pbd --error 0.01 --out %s/cape", path,
                 fixture_directory);
        assert_int_equal(fixture_program(arguments), 2);
        fixture_assert_output(cases[i].wanted);
        unlink(path);
        free(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),    cmocka_unit_test(test_lucky),   cmocka_unit_test(test_no_iterations),
        cmocka_unit_test(test_program), cmocka_unit_test(test_refused), cmocka_unit_test(test_unreachable),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
