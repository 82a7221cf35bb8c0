// The row kernels against the plain loops that they stand for.
#include "fixture.h"

#include "kernel_explicit.h"
#include "reference.h"
#include "vector.h"

// The substep as its formula reads, with the reference integrator's forces.
static void plain_step(const ck_Model *model, double dt, double *x, double *v, double *predicted, double *a) {
    int count = 3 * model->particle_count;
    for (int i = 0; i < count; i++) {
        x[i] += dt * v[i] + 0.5 * dt * dt * a[i];
        predicted[i] = v[i] + dt * a[i];
        v[i] += 0.5 * dt * a[i];
    }
    ck_reference_accelerate(model, x, predicted, a);
    for (int i = 0; i < count; i++) v[i] += 0.5 * dt * a[i];
}

// Sums in another order, and a root good to some 4e-16: over 100 substeps of ω·dt < 1 that grows by less than 1e4.
static void compare_explicit(const char *size, const char *springs, const char *terms) {
    char text[600];
    snprintf(text, sizeof text,
             "name: kernel\ncloth: {%s, spacing: 0.1, mass: 1, down: [0, 0, 1]}\nsprings: {%s}\n%s"
             "pins: [top_left, 0:2]\nnoise: {amplitude: 0.01, seed: 5}\nvelocity: [0.3, -0.5, 0.2]\nforce: [0, 0.01, "
             "0]\ngravity: [0, -9.81, 1]\ntime: {duration: 1, step: 0.01}\n",
             size, springs, terms);
    ck_Comparison comparison;
    fixture_load(&comparison, text);
    const ck_Model *model = &comparison.model;
    size_t count = 3 * (size_t)model->particle_count;
    double *state = calloc(6 * count, sizeof *state), *weight = malloc(count * sizeof *weight), dt = 1e-3;
    double *x = state, *v = state + count, *a = state + 2 * count, *predicted = state + 3 * count;
    ck_RowSprings row_springs;
    ck_ExplicitCloth *cloth;
    memcpy(x, model->position, count * sizeof *x);
    memcpy(v, model->velocity, count * sizeof *v);
    ck_reference_accelerate(model, x, v, a);
    for (int i = 0; i < model->particle_count; i++) weight[i] = ck_model_inverse_mass(model, i);
    assert_true(ck_rows_fit(model, &row_springs));
    assert_int_equal(ck_explicit_create(&cloth, model, &row_springs, dt, x, v, a, weight, NULL), CK_OK);
    // in two calls, as two frames are
    ck_explicit_step(cloth, 60);
    ck_explicit_step(cloth, 40);
    for (int i = 0; i < 100; i++) plain_step(model, dt, x, v, predicted, a);
    ck_explicit_read(cloth, state + 4 * count, state + 5 * count);
    double off = 0, moved = 0;
    for (size_t i = 0; i < count; i++) {
        off = fmax(off, fabs(state[4 * count + i] - x[i]));
        moved = fmax(moved, fabs(x[i] - model->position[i]));
    }
    assert_near(text, off, 0, 1e-11);
    assert_true(moved > 1e-2);
    ck_explicit_destroy(cloth);
    free(state);
    free(weight);
    ck_comparison_free(&comparison);
}

// Every set of terms, on rows shorter and longer than a vector and a cloth of few rows.
static void test_explicit(void **state) {
    (void)state;
    static const char *const sizes[] = {"rows: 2, columns: 3", "rows: 5, columns: 8", "rows: 9, columns: 19"};
    static const char *const springs[] = {
        "stiffness: 100", "stiffness: 100, shear: 50", "stiffness: 100, shear: 50, damping: 0.05",
        "stiffness: 100, shear: 50, bend: 20", "stiffness: 100, bend: 20, damping: 0.05"};
    for (size_t size = 0; size < sizeof sizes / sizeof *sizes; size++)
        for (size_t i = 0; i < sizeof springs / sizeof *springs; i++) {
            compare_explicit(sizes[size], springs[i], "");
            compare_explicit(sizes[size], springs[i], "drag: 2\n");
        }
}

// A cloth that is not regular is none for rows: a spring less, another stiffness, another mass.
static void test_fit(void **state) {
    (void)state;
    ck_Comparison comparison;
    ck_RowSprings springs;
    fixture_load(&comparison,
                 "name: fit\ncloth: {rows: 4, columns: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 10, "
                 "shear: 5, bend: 1}\ntime: {duration: 1, step: 0.1}\n");
    ck_Model *model = &comparison.model;
    assert_true(ck_rows_fit(model, &springs));
    assert_near("shear", springs.stiffness[CK_SHEAR], 5, 0);
    model->springs[7].stiffness *= 1.01;
    assert_false(ck_rows_fit(model, &springs));
    model->springs[7].stiffness = model->springs[6].stiffness;
    assert_true(ck_rows_fit(model, &springs));
    model->spring_count--;
    assert_false(ck_rows_fit(model, &springs));
    model->spring_count++;
    model->mass[3] *= 2;
    assert_false(ck_rows_fit(model, &springs));
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_explicit), cmocka_unit_test(test_fit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
