// Settings as they act: theory of every method that has one, to what the fit can tell; and what Bullet's own numbers
// come to.
#include "fixture_comparison.h"

#include "means.h"

static ck_Means measure(const char *engine, ck_Settings settings, double damping) {
    ck_Means means;
    ck_Error error = {0};
    const ck_MeansQuestion question = {.engine = ck_engine_find(engine),
                                       .settings = settings,
                                       .mass = 0.05,
                                       .frame = 1 / 60.0,
                                       .stiffness = 1000,
                                       .damping = damping,
                                       .limits = ck_limits_default()};
    if (ck_means_measure(&means, &question, &error)) fail_msg("%s", error.message);
    return means;
}

static void assert_law(const char *engine, const ck_SpringLaw *measured, const ck_SpringLaw *theory, double tolerance) {
    print_message("%s: %.8g N/m at rest, %.8g in motion, %.8g N*s/m\n", engine, measured->at_rest, measured->moving,
                  measured->damping);
    assert_near("at rest", measured->at_rest / theory->at_rest, 1, tolerance);
    assert_near("in motion", measured->moving / theory->moving, 1, tolerance);
    assert_near("damping", measured->damping, theory->damping, tolerance * sqrt(0.05 * theory->moving));
}

// Linear springs, stepped linearly: what is left is rounding, of a fit over some hundred frames.
static void test_linear(void **state) {
    (void)state;
    static const struct {
        const char *engine;
        double damping;
    } cases[] = {{"native-verlet", 0},   {"native-verlet", 0.5},   {"native-xpbd", 0},     {"native-xpbd", 0.5},
                 {"bullet-explicit", 0}, {"bullet-explicit", 0.5}, {"bullet-implicit", 0}, {"bullet-implicit", 0.5},
                 {"ode-quick", 0.5},     {"ode-direct", 0.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Means means = measure(cases[i].engine, (ck_Settings){0}, cases[i].damping);
        assert_law(cases[i].engine, &means.measured, &means.theory, 1e-6);
        assert_near("stiffness", means.measured.at_rest, 1000, 1e-3);
    }
}

// ODE's numbers by its manual's formulas: k = ERP/(h·CFM), c = (1 − ERP)/CFM.
static void test_ode(void **state) {
    (void)state;
    static const char *const engines[] = {"ode-quick", "ode-direct"};
    for (size_t i = 0; i < 2; i++) {
        ck_Settings settings = {.substeps = 4};
        const ck_Setting *table = ck_engine_find(engines[i])->settings;
        ck_settings_set(&settings, ck_setting_find(table, "erp")->slot, 0.2);
        ck_settings_set(&settings, ck_setting_find(table, "cfm")->slot, 0.01);
        ck_Means means = measure(engines[i], settings, 0);
        assert_near("stiffness", means.measured.at_rest, 0.2 * 240 / 0.01, 1e-6 * 4800);
        assert_law(engines[i], &means.measured, &means.theory, 1e-6);
    }
}

// Bullet's kLST s: n sweeps leave (1 − s)^n of an error, and a mass m hangs by m·S/((1 − S)·h²), S = 1 − (1 − s)^n.
// Its correction is straight to the strain, of which 2e-3 are asked for, and a half more for what is fitted to them.
static void test_bullet(void **state) {
    (void)state;
    for (uint32_t iterations = 1; iterations <= 10; iterations += 9) {
        ck_Means means =
            measure("bullet-stock", (ck_Settings){.softness = 0.5, .iterations = iterations, .substeps = 4}, 0);
        const double share = 1 - pow(0.5, iterations);
        assert_near("stiffness", means.measured.at_rest * (1 - share) / (0.05 * share * 240 * 240), 1, 3e-3);
        assert_law("bullet-stock", &means.measured, &means.theory, 4e-3);
        // far less in a chain: sweeps reach a link further each
        assert_true(means.chain < 0.5 * means.measured.at_rest);
    }
    ck_Means bar = measure("bullet-stock", (ck_Settings){.softness = 1, .iterations = 1, .substeps = 4}, 0);
    assert_true(isinf(bar.measured.at_rest) && isinf(bar.theory.at_rest) && isfinite(bar.chain));
}

static void test_mujoco(void **state) {
    (void)state;
    if (!ck_engine_find("mujoco")) skip();
    ck_Means means = measure("mujoco", (ck_Settings){0}, 0);
    assert_near("stiffness", means.measured.at_rest, 1000, 1e-6);
    assert_near("chain", means.chain, 1000, 1e-3);
}

// A ledger says what would act alike; set so, it does.
static void test_alike(void **state) {
    (void)state;
    ck_Ledger ledger;
    ck_Error error = {0};
    const ck_MeansQuestion question = {.mass = 0.05, .frame = 1 / 60.0, .limits = ck_limits_default()};
    assert_int_equal(ck_means_alike(&ledger, ck_engine_find("ode-direct"), &question, 4800, 80, &error), CK_OK);
    double erp = NAN, cfm = NAN, dt = NAN;
    for (int i = 0; i < ledger.count; i++) {
        const ck_LedgerRow *row = &ledger.rows[i];
        if (!strcmp(row->native_parameter, "dParamERP")) erp = row->native_value;
        if (!strcmp(row->native_parameter, "dParamCFM")) cfm = row->native_value;
        if (!strcmp(row->quantity, "time step")) dt = row->native_value;
    }
    assert_near("k", erp / (dt * cfm), 4800, 1e-6);
    assert_near("c", (1 - erp) / cfm, 80, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_linear), cmocka_unit_test(test_ode),
                                       cmocka_unit_test(test_bullet), cmocka_unit_test(test_mujoco),
                                       cmocka_unit_test(test_alike)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
