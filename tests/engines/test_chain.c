// Chains of springs, each solved as one line by native-lines: against theory, and against themselves in another order.
#include "fixture.h"

#include "vector.h"

#define COUNT 6

// A chain that is neither straight nor even, and its springs from node to node.
static const char *const nodes[COUNT] = {"{at: [0, 0, 0], mass: 0.1}",      "{at: [0.1, 0.02, 0], mass: 0.05}",
                                         "{at: [0.2, 0, 0.05], mass: 0.2}", "{at: [0.31, -0.02, 0], mass: 0.03}",
                                         "{at: [0.4, 0, 0], mass: 0.1}",    "{at: [0.5, 0.03, 0.01], mass: 0.4}"};
static const char *const springs[COUNT - 1] = {"stiffness: 600", "stiffness: 300, rest: 0.11", "stiffness: 900",
                                               "stiffness: 2000, rest: 0.09", "stiffness: 500"};

// Which numbers nodes have, and in which order springs come, each second one turned over.
typedef struct Layout {
    int node[COUNT], spring[COUNT - 1];
    const char *damping, *more;
} Layout;

static void write_chain(char text[1500], const Layout *layout) {
    int length = snprintf(text, 1500, "name: chain\nnetwork:\n  nodes:\n"), node_at[COUNT];
    for (int i = 0; i < COUNT; i++) node_at[layout->node[i]] = i;
    for (int i = 0; i < COUNT; i++)
        length += snprintf(text + length, 1500 - (size_t)length, "    - %s\n", nodes[node_at[i]]);
    length += snprintf(text + length, 1500 - (size_t)length, "  springs:\n");
    for (int i = 0; i < COUNT - 1; i++) {
        const int spring = layout->spring[i], turned = i % 2;
        length +=
            snprintf(text + length, 1500 - (size_t)length, "    - {ends: [%d, %d], %s%s}\n",
                     layout->node[spring + turned], layout->node[spring + !turned], springs[spring], layout->damping);
    }
    snprintf(text + length, 1500 - (size_t)length, "gravity: [0, -9.81, 0]\ntime: {duration: 0.4, step: 0.02}\n%s",
             layout->more);
}

static void run(ck_Trajectory *trajectory, const char *text, const char *engine, uint32_t substeps) {
    Fixture fixture;
    const ck_Settings settings = {.substeps = substeps, .iterations = strcmp(engine, "native-lines") ? 0 : 1};
    fixture_load(&fixture, text);
    fixture_run(trajectory, &fixture.model, ck_engine_find(engine), &settings, NULL);
    fixture_free(&fixture);
}

// The largest distance of a path's nodes from another's.
//   node  which node of the second each of the first is; NULL: the same
static double apart(const ck_Trajectory *a, const ck_Trajectory *b, const int *node) {
    double most = 0;
    assert_int_equal(a->frame_count, b->frame_count);
    for (int frame = 0; frame < a->frame_count; frame++)
        for (int i = 0; i < COUNT; i++)
            most = fmax(most, ck_distance(ck_trajectory_position(a, frame) + 3L * i,
                                          ck_trajectory_position(b, frame) + 3L * (node ? node[i] : i)));
    return most;
}

static const Layout plain = {{0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4}, "", "pins: [0]\n"};

// Of the second order, with and without dampers: half the step leaves a quarter of the error, to a few hundredths where
// a substep is less than a hundredth of the fastest period, 17 ms. The other path has no error to see.
static void test_order(void **state) {
    (void)state;
    for (int is_damped = 0; is_damped < 2; is_damped++) {
        char text[1500];
        ck_Trajectory fine, coarse, half;
        Layout layout = plain;
        if (is_damped) layout.damping = ", damping: 2";
        write_chain(text, &layout);
        run(&fine, text, "native-verlet", 5000);
        run(&coarse, text, "native-lines", 200);
        run(&half, text, "native-lines", 400);
        assert_near("order", log2(apart(&coarse, &fine, NULL) / apart(&half, &fine, NULL)), 2, 0.1);
        ck_trajectory_free(&fine);
        ck_trajectory_free(&coarse);
        ck_trajectory_free(&half);
    }
}

// Whatever order nodes and springs come in, a chain moves alike, to rounding.
static void test_numbers(void **state) {
    (void)state;
    static const Layout others[] = {{{5, 4, 3, 2, 1, 0}, {0, 1, 2, 3, 4}, ", damping: 1", "pins: [5]\n"},
                                    {{2, 4, 0, 5, 1, 3}, {3, 0, 4, 2, 1}, ", damping: 1", "pins: [2]\n"}};
    char text[1500];
    ck_Trajectory path, other;
    Layout layout = plain;
    layout.damping = ", damping: 1";
    write_chain(text, &layout);
    run(&path, text, "native-lines", 10);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        write_chain(text, &others[i]);
        run(&other, text, "native-lines", 10);
        assert_near("nodes", apart(&path, &other, others[i].node), 0, 1e-12);
        ck_trajectory_free(&other);
    }
    ck_trajectory_free(&path);
}

// Two chains of a network move as each does alone, to the bit.
static void test_several(void **state) {
    (void)state;
    static const char head[] = "name: chains\nnetwork:\n  nodes: [",
                      tail[] = "]\nsprings: {stiffness: 300, damping: 1}\ngravity: [0, -9.81, 0]\n"
                               "time: {duration: 0.4, step: 0.02}\n",
                      first[] = "{at: [0, 0, 0], mass: 0.1}, {at: [0.1, 0.1, 0], mass: 0.3}",
                      second[] = "{at: [1, 0, 0], mass: 0.2}, {at: [1.2, 0, 0.1], mass: 0.4}";
    char text[1500];
    ck_Trajectory both, one, other;
    snprintf(text, sizeof text, "%s%s, %s]\n  bars: [[0, 1], [3, 2]%spins: [0, 2]\n", head, first, second, tail);
    run(&both, text, "native-lines", 10);
    snprintf(text, sizeof text, "%s%s]\n  bars: [[0, 1]%spins: [0]\n", head, first, tail);
    run(&one, text, "native-lines", 10);
    snprintf(text, sizeof text, "%s%s]\n  bars: [[1, 0]%spins: [0]\n", head, second, tail);
    run(&other, text, "native-lines", 10);
    const int last = both.frame_count - 1;
    assert_memory_equal(ck_trajectory_position(&both, last), ck_trajectory_position(&one, last), 6 * sizeof(double));
    assert_memory_equal(ck_trajectory_position(&both, last) + 6, ck_trajectory_position(&other, last),
                        6 * sizeof(double));
    ck_trajectory_free(&both);
    ck_trajectory_free(&one);
    ck_trajectory_free(&other);
}

// What nothing holds falls by g·t²/2 in the mean, whatever its springs do, and a ball that hangs on its end with it.
static void test_fall(void **state) {
    (void)state;
    char text[1500];
    Layout layout = plain;
    layout.more =
        "springs: {stiffness: 1000}\nbodies: [{sphere: {center: [0.5, -0.2, 0], radius: 0.05}, mass: 2, hang: [5]}]\n";
    write_chain(text, &layout);
    Fixture fixture;
    ck_Trajectory path;
    fixture_load(&fixture, text);
    fixture_run(&path, &fixture.model, ck_engine_find("native-lines"), NULL, NULL);
    const double *from = ck_trajectory_position(&path, 0), *x = ck_trajectory_position(&path, path.frame_count - 1);
    double mass = 0, fallen = 0, torn = 0;
    for (int i = 0; i < fixture.model.particle_count; i++) {
        mass += fixture.model.mass[i];
        fallen += fixture.model.mass[i] * (from[3 * i + 1] - x[3 * i + 1]);
    }
    torn = ck_distance(x + 3 * (COUNT - 1), x + 3 * COUNT) - ck_distance(from + 3 * (COUNT - 1), from + 3 * COUNT);
    assert_near("fall", fallen / mass, 0.5 * 9.81 * 0.4 * 0.4, 1e-12);
    assert_true(fabs(torn) < 0.05);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
}

// On a floor with friction, and let go by its pin: within a thousandth of its length of native-verlet's fine path,
// where impacts come by the step and are of the first order.
static void test_events(void **state) {
    (void)state;
    static const char *const events[] = {
        "pins: [0]\nrelease: [{at: 0.2, pins: [0]}]\n",
        "colliders: [{plane: {point: [0, -0.2, 0], normal: [0, 1, 0], friction: 0.3}}]\n",
        "pins: [0]\nmoves: [{pins: [0], path: {velocity: [1, 0, 0]}}]\n"};
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        char text[1500];
        ck_Trajectory fine, path;
        Layout layout = plain;
        layout.damping = ", damping: 2";
        layout.more = events[i];
        write_chain(text, &layout);
        run(&fine, text, "native-verlet", 5000);
        run(&path, text, "native-lines", 400);
        assert_near(events[i], apart(&fine, &path, NULL), 0, 5e-4);
        ck_trajectory_free(&fine);
        ck_trajectory_free(&path);
    }
}

static void test_refusals(void **state) {
    (void)state;
    static const struct {
        const char *bars, *why;
    } refused[] = {{"[0, 1], [0, 2], [0, 3]", "of open chains of springs"},
                   {"[0, 1], [1, 2], [2, 0]", "a closed chain"}};
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        char text[600];
        Fixture fixture;
        ck_Error error;
        ck_Settings used;
        void *created;
        snprintf(text, sizeof text,
                 "name: net\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [0, 1, 0], "
                 "mass: 1}, {at: [0, 0, 1], mass: 1}]\n  bars: [%s]\nsprings: {stiffness: 1}\n"
                 "time: {duration: 1, step: 0.1}\n",
                 refused[i].bars);
        fixture_load(&fixture, text);
        assert_int_equal(ck_engine_create(ck_engine_find("native-lines"), &created, &fixture.model, &(ck_Settings){0},
                                          &used, NULL, &error),
                         CK_REFUSED);
        assert_non_null(strstr(error.message, refused[i].why));
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_order),   cmocka_unit_test(test_numbers),
                                       cmocka_unit_test(test_several), cmocka_unit_test(test_fall),
                                       cmocka_unit_test(test_events),  cmocka_unit_test(test_refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
