// Every solver of the program passes its conformance card, and each fault that a solver may have fails the property
// that is about it.
#include "fixture_comparison.h"

#include "conform.h"
#include "springs.h"
#include "vector.h"

#include <unistd.h>

static int find_property(const char *name) {
    int found = 0;
    while (found < ck_conform_property_count() && strcmp(ck_conform_property(found), name)) found++;
    assert_true(found < ck_conform_property_count());
    return found;
}

static void open_card(ck_Conform *conform) {
    ck_Error error = {0};
    ck_Limits limits = ck_limits_default();
    if (ck_conform_open(conform, &limits, &error)) fail_msg("%s", error.message);
}

static void test_every_engine(void **state) {
    (void)state;
    fixture_skip_sanitized();
    ck_Conform conform;
    open_card(&conform);
    for (int i = 0; i < ck_engine_count(); i++) {
        if (!fixture_is_solver(ck_engine_at(i))) continue;
        int passed = 0;
        for (int property = 0; property < ck_conform_property_count(); property++) {
            ck_ConformResult result;
            ck_Error error = {0};
            if (ck_conform_ask(&result, &conform, ck_engine_at(i), property, &error)) fail_msg("%s", error.message);
            if (result.verdict == CK_CONFORM_FAIL)
                fail_msg("%s, %s: %.3g, within %.3g: %s", ck_engine_at(i)->name, ck_conform_property(property),
                         result.value, result.tolerance, result.reason);
            passed += result.verdict == CK_CONFORM_PASS;
        }
        // a rope's solver takes one of the scenes
        assert_true(passed >= 2);
    }
    ck_conform_close(&conform);
}

// Damped springs by symplectic Euler, with one fault.
typedef enum Fault {
    NONE,
    DAMPS_ALL,
    KNOWS_ORIGIN,
    KNOWS_LEFT,
    KNOWS_LENGTH,
    FIRST_IS_STIFFER,
    TURNS,
    PUSHES,
    GROWS,
    DICE,
    WRONG_ORDER
} Fault;

typedef struct Faulty {
    const ck_Model *model;
    Fault fault;
    double dt;
    int substeps;
    double *x, *v, *a; // [3*n]
} Faulty;

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        Fault fault) {
    size_t count = 3 * (size_t)model->particle_count;
    Faulty *faulty = calloc(1, sizeof *faulty);
    double *memory = calloc(3 * count, sizeof *memory);
    if (!faulty || !memory) return CK_NO_MEMORY;
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : 20};
    *faulty = (Faulty){
        model, fault, model->step / used->substeps, (int)used->substeps, memory, memory + count, memory + 2 * count};
    memcpy(faulty->x, model->position, count * sizeof(double));
    memcpy(faulty->v, model->velocity, count * sizeof(double));
    *state = faulty;
    return CK_OK;
}

static void push(const Faulty *faulty, int i) {
    double *a = faulty->a + 3 * i;
    const double *x = faulty->x + 3 * i, *v = faulty->v + 3 * i;
    switch (faulty->fault) {
    case DAMPS_ALL: ck_add_scaled(a, faulty->model->terms & CK_TERM_DAMPING ? -0.5 : 0, v); break;
    case KNOWS_ORIGIN: ck_add_scaled(a, -0.01, x); break;
    case KNOWS_LEFT: a[0] += 0.01; break;
    case KNOWS_LENGTH: ck_add_scaled(a, -0.1 * ck_length(v), v); break;
    case PUSHES: a[2] += 1e-4; break;
    case TURNS: a[0] += 1e-3 * v[1], a[1] -= 1e-3 * v[0]; break;
    case GROWS: ck_add_scaled(a, 0.05, v); break;
    case DICE: a[1] += 1e-9 * ((double)(getpid() % 1000) + 1); break;
    // goes with the root of the step: half an order
    case WRONG_ORDER: ck_add_scaled(a, 3 * sqrt(faulty->dt), v); break;
    default: break;
    }
}

static ck_StepResult step(void *state) {
    Faulty *faulty = state;
    const ck_Model *model = faulty->model;
    for (int substep = 0; substep < faulty->substeps; substep++) {
        ck_springs_accelerate(model, faulty->x, faulty->v, faulty->a);
        if (faulty->fault == FIRST_IS_STIFFER) {
            const ck_Spring *spring = &model->springs[0];
            double d[3], pull = 0.1 * spring->stiffness * ck_spring_strain(spring, faulty->x);
            ck_subtract(d, faulty->x + 3 * spring->b, faulty->x + 3 * spring->a);
            ck_add_scaled(faulty->a + 3 * spring->a, pull, d);
            ck_add_scaled(faulty->a + 3 * spring->b, -pull, d);
        }
        for (int i = 0; i < model->particle_count; i++) {
            if (model->pinned[i]) continue;
            push(faulty, i);
            ck_add_scaled(faulty->v + 3 * i, faulty->dt, faulty->a + 3 * i);
            ck_add_scaled(faulty->x + 3 * i, faulty->dt, faulty->v + 3 * i);
        }
    }
    return CK_STEP_OK;
}

static void read_state(const void *state, double *position, double *velocity) {
    const Faulty *faulty = state;
    size_t bytes = 3 * sizeof(double) * (size_t)faulty->model->particle_count;
    memcpy(position, faulty->x, bytes);
    memcpy(velocity, faulty->v, bytes);
}

static void destroy(void *state) {
    Faulty *faulty = state;
    free(faulty->x);
    free(faulty);
}

#define CREATE(fault)                                                                                                  \
    static ck_Status create_##fault(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, \
                                    ck_Ledger *ledger, ck_Error *error) {                                              \
        (void)ledger, (void)error;                                                                                     \
        return create(state, model, wanted, used, fault);                                                              \
    }
CREATE(NONE)
CREATE(DAMPS_ALL)
CREATE(KNOWS_ORIGIN)
CREATE(KNOWS_LEFT)
CREATE(KNOWS_LENGTH)
CREATE(FIRST_IS_STIFFER)
CREATE(TURNS)
CREATE(PUSHES)
CREATE(GROWS)
CREATE(DICE)
CREATE(WRONG_ORDER)

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "20",
     .help = "steps"},
    {0},
};

static void test_faults(void **state) {
    (void)state;
    static const struct {
        ck_Status (*create)(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                            ck_Ledger *ledger, ck_Error *error);
        const char *property;
    } faults[] = {
        {create_NONE, NULL},
        {create_DAMPS_ALL, "damped fall"},
        {create_KNOWS_ORIGIN, "translation 1 m"},
        {create_KNOWS_LEFT, "mirror"},
        {create_KNOWS_LENGTH, "scale"},
        {create_FIRST_IS_STIFFER, "order of springs"},
        {create_TURNS, "rotation"},
        {create_TURNS, "angular momentum"},
        {create_PUSHES, "momentum"},
        {create_GROWS, "energy"},
        {create_DICE, "two runs"},
        {create_WRONG_ORDER, "order"},
    };
    ck_Conform conform;
    open_card(&conform);
    for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
        const ck_Engine engine = {.name = "faulty",
                                  .terms = ~0u & ~(unsigned)CK_TERM_RIGID,
                                  .settings = settings,
                                  .create = faults[i].create,
                                  .step = step,
                                  .read = read_state,
                                  .destroy = destroy};
        for (int property = 0; property < ck_conform_property_count(); property++) {
            ck_ConformResult result;
            if (faults[i].property && property != find_property(faults[i].property)) continue;
            assert_int_equal(ck_conform_ask(&result, &conform, &engine, property, NULL), CK_OK);
            if ((result.verdict == CK_CONFORM_FAIL) != (faults[i].property != NULL))
                fail_msg("fault %zu, %s: %.3g, within %.3g: %s", i, ck_conform_property(property), result.value,
                         result.tolerance, result.reason);
        }
    }
    ck_conform_close(&conform);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_engine), cmocka_unit_test(test_faults)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
