// A material is the same sheet in every pattern and at every resolution: its moduli and its mass.
#include "fixture.h"

#include "springs.h"
#include "vector.h"

#include <unistd.h>

#define MEMBRANE 400.0

static void load(Fixture *fixture, const char *pattern, int cells, const char *poisson) {
    char text[700];
    const double height = !strcmp(pattern, "triangle") ? sqrt(0.75) : 1;
    // rows of triangles lie closer: as many more of them
    snprintf(text, sizeof text,
             "name: m\ncloth: {rows: %d, columns: %d, spacing: %.17g, pattern: %s, down: [0, 1, 0]}\n"
             "material: {membrane: 400, density: 0.2, bending: 2e-5, retardation: 0.001%s}\n"
             "time: {duration: 1, step: 1}\n",
             (int)(cells / height) + 1, cells + 1, 1.0 / cells, pattern, poisson);
    fixture_load(fixture, text);
}

// Deforms x and y by strains, and gives the energy an area of what is there, J/m².
static double energy_of(const Fixture *fixture, double area, double xx, double yy, double xy) {
    const ck_Model *model = &fixture->model;
    double *at = malloc(3 * sizeof *at * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        const double *from = model->position + 3 * i;
        at[3 * i] = (1 + xx) * from[0] + xy * from[1];
        at[3 * i + 1] = xy * from[0] + (1 + yy) * from[1];
        at[3 * i + 2] = from[2];
    }
    const double energy = ck_springs_energy(model, at);
    free(at);
    return energy / area;
}

// The area of all faces.
static double area_of(const Fixture *fixture, bool is_triangle) {
    const ck_SceneCloth *cloth = fixture->scene.file->cloth;
    return (cloth->rows - 1.0) * (cloth->columns - 1.0) * cloth->spacing * cloth->spacing *
           (is_triangle ? sqrt(0.75) : 1);
}

// Along threads a sheet stretches by E·h and ν, and on every pattern it shears as it should where that is isotropic:
// energy ½·E·h·e² of a pull whose sides give by ν·e, and ½·C₁₁·(e² + …) where they are held.
static void test_moduli(void **state) {
    (void)state;
    static const struct {
        const char *pattern, *text;
        double poisson;
        bool is_isotropic;
    } cases[] = {{"square", "", 1.0 / 3, true},
                 {"cross", "", 1.0 / 3, true},
                 {"triangle", "", 1.0 / 3, true},
                 {"square", ", poisson: 0.2", 0.2, false},
                 {"cross", ", poisson: 0.45", 0.45, false},
                 {"square", ", poisson: 0", 0, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Fixture fixture;
        load(&fixture, cases[i].pattern, 24, cases[i].text);
        const bool is_triangle = !strcmp(cases[i].pattern, "triangle");
        const double e = 1e-4, nu = cases[i].poisson, area = area_of(&fixture, is_triangle);
        const double pull = energy_of(&fixture, area, e, -nu * e, 0) / (0.5 * MEMBRANE * e * e),
                     side = energy_of(&fixture, area, -nu * e, e, 0) / (0.5 * MEMBRANE * e * e),
                     held = energy_of(&fixture, area, e, 0, 0) / (0.5 * MEMBRANE / (1 - nu * nu) * e * e),
                     sheared = energy_of(&fixture, area, 0, 0, e) / (2 * MEMBRANE / (2 * (1 + nu)) * e * e);
        print_message("%s nu %.3g: pull %.5f %.5f, held %.5f, shear %.5f of theory\n", cases[i].pattern, nu, pull, side,
                      held, sheared);
        // lengths differ from their strains by the second order in e, which is 1e-4
        const double tolerance = 5e-4;
        assert_near("pull", pull, 1, tolerance);
        assert_near("pull across", side, 1, tolerance);
        assert_near("held", held, 1, tolerance);
        if (cases[i].is_isotropic) assert_near("shear", sheared, 1, tolerance);
        fixture_free(&fixture);
    }
}

// Forces vanish inside a sheet that is deformed alike everywhere, to the second order of its strain: it is at rest.
static void test_patch(void **state) {
    (void)state;
    static const char *const patterns[] = {"square", "cross", "triangle"};
    for (int i = 0; i < 3; i++) {
        Fixture fixture;
        load(&fixture, patterns[i], 12, "");
        ck_Model *model = &fixture.model;
        double *start = malloc(6 * sizeof *start * (size_t)model->particle_count),
               *acceleration = start + 3 * model->particle_count;
        double inside = 0, border = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        memcpy(start, model->position, 3 * sizeof *start * (size_t)model->particle_count);
        for (int k = 0; k < model->particle_count; k++) {
            double *at = model->position + 3 * k;
            for (int axis = 0; axis < 2; axis++) {
                low[axis] = fmin(low[axis], start[3 * k + axis]);
                high[axis] = fmax(high[axis], start[3 * k + axis]);
            }
            at[0] += 1e-5 * start[3 * k] + 3e-5 * start[3 * k + 1];
            at[1] += 2e-5 * start[3 * k] - 4e-5 * start[3 * k + 1];
        }
        ck_springs_accelerate(model, model->position, model->velocity, acceleration);
        for (int k = 0; k < model->particle_count; k++) {
            const double *from = start + 3 * k, force = model->mass[k] * ck_length(acceleration + 3 * k);
            const bool is_inside =
                from[0] > low[0] + 0.1 && from[0] < high[0] - 0.1 && from[1] > low[1] + 0.1 && from[1] < high[1] - 0.1;
            *(is_inside ? &inside : &border) = fmax(is_inside ? inside : border, force);
        }
        print_message("%s: %.2e N inside, %.2e N at the border\n", patterns[i], inside, border);
        assert_true(border > 1e-4 && inside < 1e-6 * border);
        free(start);
        fixture_free(&fixture);
    }
}

// The same mass, and the same energy of a bend, at any resolution.
static void test_resolution(void **state) {
    (void)state;
    static const char *const patterns[] = {"square", "cross"};
    for (int i = 0; i < 2; i++)
        for (int cells = 4; cells <= 32; cells *= 2) {
            Fixture fixture;
            double mass = 0;
            load(&fixture, patterns[i], cells, "");
            for (int k = 0; k < fixture.model.particle_count; k++) mass += fixture.model.mass[k];
            assert_near("mass", mass, 0.2, 1e-12);
            assert_near("corner", fixture.model.mass[0], 0.05 / (cells * cells), 1e-15);
            assert_near("damping", fixture.model.springs[5].damping / fixture.model.springs[5].stiffness, 0.001, 1e-15);
            assert_near("pull", energy_of(&fixture, 1, 1e-5, 0, 0) / (0.5 * MEMBRANE / (8.0 / 9) * 1e-10), 1, 1e-4);
            fixture_free(&fixture);
        }
}

static void refuse(const char *text, const char *wanted) {
    Fixture fixture;
    ck_Error error = {0};
    char *path = fixture_file(text);
    if (fixture_open(&fixture, path, &error) != CK_BAD_INPUT || !strstr(error.message, wanted))
        fail_msg("'%s' without '%s'", error.message, wanted);
    fixture_free(&fixture);
    unlink(path);
    free(path);
}

#define SHEET "name: m\ncloth: {rows: 3, columns: 3, spacing: 0.1%s}\n%s\ntime: {duration: 1, step: 1}\n"

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *cloth, *rest, *message;
    } cases[] = {
        {", pattern: triangle", "material: {membrane: 9, density: 1, poisson: 0.2}", "springs along triangles are 1/3"},
        {"", "material: {membrane: 9, density: 1, poisson: 1}", "have one below 1"},
        {"", "material: {membrane: 9}", "cloth has no mass; give it one"},
        {", mass: 1", "material: {membrane: 9, density: 1}", "keep one"},
        {"", "springs: {stiffness: 3}", "cloth has no mass"},
        {", mass: 1", "material: {membrane: 9}\nsprings: {stiffness: 1}", "springs and material both say"},
        {", mass: 1", "material: {membrane: 9, bending: 1}\nbending: {stiffness: 1}", "the material has a bending"},
        {", mass: 1, pattern: plaid", "springs: {stiffness: 1}", "it must be square, cross or triangle"},
        {", mass: 1, pattern: triangle", "springs: {stiffness: 1, shear: 1}", "only a cloth of squares has diagonals"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[600];
        snprintf(text, sizeof text, SHEET, cases[i].cloth, cases[i].rest);
        refuse(text, cases[i].message);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_moduli), cmocka_unit_test(test_patch),
                                       cmocka_unit_test(test_resolution), cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
