// Tuning: the search over whole numbers where the least work is known, and what the program finds.
#include "fixture.h"
#include "fixture_program.h"

#include "tune_grid.h"

#include <jansson.h>
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
    fixture_skip_sanitized();
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

// Runs tune with --json; the row of its front that was chosen, of a document that the caller frees.
static json_t *tune(const char *arguments, json_t **document) {
    char line[600];
    snprintf(line, sizeof line, "tune %s --json --force --out %s/goal", arguments, fixture_directory);
    if (fixture_program(line)) fail_msg("%s fails", line);
    char *text = fixture_read("output");
    json_error_t error;
    *document = json_loads(text, 0, &error);
    if (!*document) fail_msg("%s: %s in %s", line, error.text, text);
    free(text);
    json_t *row;
    size_t i;
    json_array_foreach(json_object_get(*document, "front"), i, row) {
        if (!strcmp(json_string_value(json_object_get(row, "chosen")), "chosen")) return row;
    }
    fail_msg("%s: nothing is chosen", line);
    return NULL;
}

static double number_of(const json_t *row, const char *key) {
    return json_number_value(json_object_get(row, key));
}

// A bound of strain, a value to come to, a cost to stay within.
static void test_goals(void **state) {
    (void)state;
    json_t *document, *row = tune("rope_hanging -e bullet-pbd --stretch 0.12", &document);
    assert_true(number_of(row, "stretch_max") <= 0.12);
    double work = number_of(row, "sweeps_per_s");
    json_decref(document);
    // the cheapest of less strain cannot be cheaper
    row = tune("rope_hanging -e bullet-pbd --stretch 0.1", &document);
    assert_true(number_of(row, "stretch_max") <= 0.1 && number_of(row, "sweeps_per_s") >= work);
    json_decref(document);
    // the search is the same for other goals
    fixture_skip_long();
    // a share of each link's error is what makes it softer: any sag between is to be had
    row = tune("rope_hanging -e bullet-pbd --target sag=1.2 --vary kLST", &document);
    assert_true(number_of(row, "error") < 1e-3);
    json_decref(document);
    row = tune("rope_hanging -e native-xpbd --max-frame-ms 1000", &document);
    assert_true(number_of(row, "cpu_ms_per_frame") <= 1000 && number_of(row, "error") < 1e-4);
    json_decref(document);
}

// Two particles that fall for 0.5 s, recorded at every second frame. Symplectic Euler's error is g*t*h/2: of rms
// g*T*h/(2*sqrt(3)) over the way.
static void test_like_a_file(void **state) {
    (void)state;
    char *scene = fixture_file("name: falling\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}], "
                               "bars: [[0, 1]]}\nsprings: {stiffness: 100}\ngravity: [0, -9.81, 0]\n"
                               "time: {duration: 0.5, step: 0.0125}\n");
    char text[4000] = "time_s,particle,x,y,z\n", arguments[400];
    size_t used = strlen(text);
    for (int frame = 0; frame <= 40; frame += 2)
        for (int particle = 0; particle < 2; particle++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%.9g,%d,%d,%.12g,0\n", 0.0125 * frame, particle,
                                     particle, -0.5 * 9.81 * 0.0125 * frame * 0.0125 * frame);
    char *path = fixture_file(text);
    double of_one = 9.81 * 0.5 * 0.0125 / (2 * sqrt(3));
    json_t *document, *row;
    snprintf(arguments, sizeof arguments, "%s -e bullet-pbd --like %s --error %.9g", scene, path, 1.02 * of_one / 8);
    row = tune(arguments, &document);
    assert_near("substeps", number_of(row, "substeps"), 8, 0);
    fixture_assert_output("20 frames interpolated between 21 recorded ones");
    json_decref(document);
    snprintf(arguments, sizeof arguments, "tune %s -e bullet-pbd --like nobody", scene);
    assert_int_equal(fixture_program(arguments), 2);
    fixture_assert_output("there is no such engine, and no such file");
    for (char **file = (char *[]){scene, path, NULL}; *file; file++) {
        unlink(*file);
        free(*file);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_grid),    cmocka_unit_test(test_lucky),       cmocka_unit_test(test_no_iterations),
        cmocka_unit_test(test_program), cmocka_unit_test(test_refused),     cmocka_unit_test(test_unreachable),
        cmocka_unit_test(test_goals),   cmocka_unit_test(test_like_a_file),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
