// Capsules, cylinders and boxes: their geometry, and what ropes do on them in closed form.
#include "fixture_truth.h"

#include "collider.h"
#include "runge_kutta.h"
#include "statistics.h"
#include "vector.h"

#include <stdarg.h>

#define SHAPES                                                                                                         \
    "name: s\nrope: {particles: 2, spacing: 1, mass: 1, origin: [0, 9, 0]}\ntime: {duration: 1, fps: "                 \
    "10}\ncolliders:\n"                                                                                                \
    "  - capsule: {from: [-0.3, 0.1, 0], to: [0.4, -0.1, 0.2], radius: 0.25}\n"                                        \
    "  - cylinder: {point: [0.1, 0, 0], axis: [1, 0.3, -0.2], radius: 0.3}\n"                                          \
    "  - box: {center: [0, 0.1, 0], size: [0.9, 0.5, 0.7], along: [1, 0.2, 0.1], up: [0, 1, 0.3], rounding: 0.1}\n"    \
    "  - box: {center: [0, 0, 0], size: [0.6, 0.5, 0.8], along: [1, 0.5, 0]}\n"

static void pick(ck_Random *random, double size, double *point) {
    for (int axis = 0; axis < 3; axis++) point[axis] = size * (2 * ck_random_unit(random) - 1);
}

// A function that changes by no more than the way, and has its zero as far away as it says, is the distance.
static void test_gap_is_the_distance(void **state) {
    (void)state;
    Fixture fixture;
    ck_Random random = ck_random_seed(1);
    fixture_load(&fixture, SHAPES);
    for (int i = 0; i < fixture.model.collider_count; i++)
        for (int round = 0; round < 2000; round++) {
            const ck_Collider *collider = &fixture.model.colliders[i];
            double one[3], other[3], foot[3], normal[3], none[3];
            pick(&random, 1, one);
            pick(&random, 1, other);
            const double gap = ck_collider_gap(collider, one, normal), there = ck_collider_gap(collider, other, none);
            assert_near("unit", ck_length(normal), 1, 1e-14);
            assert_true(fabs(gap - there) <= ck_distance(one, other) * (1 + 1e-14));
            memcpy(foot, one, sizeof foot);
            ck_add_scaled(foot, -gap, normal);
            assert_near("foot", ck_collider_gap(collider, foot, none), 0, 1e-14);
        }
    fixture_free(&fixture);
}

// Off a sharp face by what rounding makes, the way out is still the face's own.
static void test_normal_of_a_face(void **state) {
    (void)state;
    Fixture fixture;
    ck_Random random = ck_random_seed(4);
    fixture_load(&fixture,
                 "name: f\nrope: {particles: 2, spacing: 1, mass: 1, origin: [0, 9, 0]}\ntime: {duration: 1, fps: "
                 "10}\ncolliders: [{box: {center: [0, 1, 0], size: [0.6, 0.2, 0.4], along: [1, 0.5, 0.3], up: [0.2, "
                 "1, 0.4]}}]\n");
    const ck_Collider *box = &fixture.model.colliders[0];
    for (int round = 0; round < 2000; round++) {
        const int face = round % 3;
        const double off = pow(10, -16 + 6 * ck_random_unit(&random));
        double point[3], normal[3];
        memcpy(point, box->point, sizeof point);
        for (int k = 0; k < 3; k++)
            ck_add_scaled(point,
                          k == face ? box->half[k] + off : 0.9 * box->half[k] * (2 * ck_random_unit(&random) - 1),
                          box->axes[k]);
        ck_collider_gap(box, point, normal);
        assert_near("normal", ck_dot(normal, box->axes[face]), 1, 1e-12);
    }
    fixture_free(&fixture);
}

// How fast a surface turns away from a tangent, by the gap along it.
static void test_turn_is_the_curvature(void **state) {
    (void)state;
    const double way = 1e-4;
    int parts[4] = {0, 0, 0, 0};
    Fixture fixture;
    ck_Random random = ck_random_seed(2);
    fixture_load(&fixture, SHAPES);
    for (int i = 0; i < fixture.model.collider_count; i++)
        for (int round = 0; round < 2000; round++) {
            const ck_Collider *collider = &fixture.model.colliders[i];
            double point[3], normal[3], speed[3], along[3], ahead[3], back[3], none[3];
            pick(&random, 1, point);
            pick(&random, 1, speed);
            const double gap = ck_collider_gap(collider, point, normal);
            if (gap <= 0) continue;
            ck_add_scaled(point, -gap, normal);
            ck_tangential(along, speed, normal);
            memcpy(ahead, point, sizeof ahead);
            memcpy(back, point, sizeof back);
            ck_add_scaled(ahead, way, along);
            ck_add_scaled(back, -way, along);
            const ck_Part part = ck_collider_part(collider, point, along),
                          next = ck_collider_part(collider, ahead, along),
                          last = ck_collider_part(collider, back, along);
            if (memcmp(&part, &next, sizeof part) || memcmp(&part, &last, sizeof part)) continue;
            if (collider->shape == CK_BOX && !(collider->radius > 0) && !ck_collider_is_flat(collider, part)) continue;
            const double rise = ck_collider_gap(collider, ahead, none) + ck_collider_gap(collider, back, none);
            // the gap's fourth power of the way, and its rounding
            assert_near("turn", rise / (way * way), ck_collider_turn(collider, part, along), 1e-4);
            assert_near("own surface", ck_collider_part_gap(collider, part, ahead, none),
                        ck_collider_gap(collider, ahead, none), 1e-14);
            parts[abs(part.beyond[0]) + abs(part.beyond[1]) + abs(part.beyond[2])]++;
        }
    print_message("on lines %d, faces %d, edges %d, corners %d\n", parts[0], parts[1], parts[2], parts[3]);
    for (int i = 0; i < 4; i++) assert_true(parts[i] > 50);
    fixture_free(&fixture);
}

static void test_hits(void **state) {
    (void)state;
    Fixture fixture;
    ck_Random random = ck_random_seed(3);
    int hits = 0;
    fixture_load(&fixture, SHAPES);
    for (int i = 0; i < fixture.model.collider_count; i++)
        for (int round = 0; round < 2000; round++) {
            const ck_Collider *collider = &fixture.model.colliders[i];
            const double still[3] = {0, 0, 0};
            double point[3], speed[3], at[3], normal[3], first = INFINITY;
            pick(&random, 1, point);
            pick(&random, 2, speed);
            if (ck_collider_gap(collider, point, normal) < 0) continue;
            for (int step = 0; step <= 1000 && isinf(first); step++) {
                memcpy(at, point, sizeof at);
                ck_add_scaled(at, step / 1000.0, speed);
                if (ck_collider_gap(collider, at, normal) < 0) first = step / 1000.0;
            }
            const double hit = ck_collider_hit(collider, point, speed, still, 1, 1e-12);
            hits += isfinite(hit);
            // what is inside for less than a step is not seen by steps
            if (isfinite(first)) assert_near("hit", hit, first - 5e-4, 5.1e-4);
            if (!isfinite(hit)) continue;
            memcpy(at, point, sizeof at);
            ck_add_scaled(at, hit, speed);
            assert_near("on it", ck_collider_gap(collider, at, normal), 0, 1e-14);
        }
    print_message("%d hits\n", hits);
    assert_true(hits > 500);
    fixture_free(&fixture);
}

// A text that grows.
typedef struct Text {
    char bytes[40000];
    int length;
} Text;

__attribute__((format(printf, 2, 3))) static void add(Text *text, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    text->length += vsnprintf(text->bytes + text->length, sizeof text->bytes - (size_t)text->length, format, arguments);
    va_end(arguments);
    assert_true(text->length < (int)sizeof text->bytes);
}

// The reference and native-verlet, each compared at every frame by what one test knows.
static void follow(const char *text, double (*off)(const ck_Model *model, const ck_Trajectory *path),
                   double tolerance) {
    Fixture fixture;
    ck_ReferencePath path;
    ck_Trajectory native;
    ck_Error error = {0};
    fixture_load(&fixture, text);
    if (ck_reference_path_create(&path, &fixture.model, &error)) fail_msg("%s", error.message);
    fixture_run(&native, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
    print_message("off by %.2e and %.2e, horizon %d of %d\n", off(&fixture.model, &path.fine),
                  off(&fixture.model, &native), path.horizon, fixture.model.frame_count);
    assert_near("reference", off(&fixture.model, &path.fine), 0, tolerance);
    assert_near("native-verlet", off(&fixture.model, &native), 0, tolerance);
    ck_trajectory_free(&native);
    ck_reference_path_free(&path);
    fixture_free(&fixture);
}

// A rope of 1 m, 0.2 m of it over a table's edge that is rounded by r. Source: L·x'' = g·(x − c), c = r·(π/2 − 1) of
// the arc: x − c = (x_0 − c)·cosh(√(g/L)·t), as long as the edge carries, x·(L − x) > x² − x_0².
#define EDGE_NODES 61
#define EDGE_ROUND 0.05

static double off_the_edge(const ck_Model *model, const ck_Trajectory *path) {
    const double c = EDGE_ROUND * (M_PI / 2 - 1);
    double largest = 0;
    for (int frame = 1; frame <= model->frame_count; frame++) {
        const double slid = (0.2 - c) * (cosh(sqrt(9.81) * frame * model->step) - 1);
        largest = fmax(largest, fabs(ck_trajectory_position(path, frame)[0] - model->position[0] - slid));
    }
    return largest;
}

static void test_table_edge(void **state) {
    (void)state;
    Text text = {.length = 0};
    add(&text, "name: e\nnetwork:\n  nodes:\n");
    for (int i = 0; i < EDGE_NODES; i++) {
        const double along = i / (EDGE_NODES - 1.0) - 0.8, turn = fmin(M_PI / 2, fmax(0, along / EDGE_ROUND));
        const double down = fmax(0, along - EDGE_ROUND * M_PI / 2);
        add(&text, "    - {at: [%.17g, %.17g, 0], mass: %.17g}\n", fmin(0, along) + EDGE_ROUND * (sin(turn) - 1),
            -EDGE_ROUND * (1 - cos(turn)) - down, 0.1 / (EDGE_NODES - 1) * (i && i < EDGE_NODES - 1 ? 1 : 0.5));
    }
    add(&text, "  springs:\n");
    for (int i = 1; i < EDGE_NODES; i++)
        add(&text, "    - {ends: [%d, %d], stiffness: 3000, damping: 0.3}\n", i - 1, i);
    add(&text, "gravity: [0, -9.81, 0]\ntime: {duration: 0.5, fps: 60}\n"
               "colliders: [{box: {center: [-1, -1, 0], size: [2, 2, 1], rounding: 0.05}}]\n");
    // a chord over the edge is shorter than its arc by 1 − (h/r)²/24 = 0.5 % of its 0.08 m, and springs give 0.3 %
    follow(text.bytes, off_the_edge, 2e-3);
}

// Two weights of a light rope over a pulley without friction. Source: M·x'' = g·(Δm + 2·ρ·x), x = Δm/(2·ρ)·
// (cosh(√(2·ρ·g/M)·t) − 1).
#define PULLEY_NODES 81
#define PULLEY_RADIUS 0.1
#define PULLEY_HANGS 0.5

static double off_the_pulley(const ck_Model *model, const ck_Trajectory *path) {
    const int last = 3 * (PULLEY_NODES - 1);
    const double density = 0.05, heavier = 0.2, whole = 2.2 + density * (2 * PULLEY_HANGS + M_PI * PULLEY_RADIUS);
    double largest = 0;
    for (int frame = 1; frame <= model->frame_count; frame++) {
        const double time = frame * model->step, *now = ck_trajectory_position(path, frame);
        const double slid = heavier / (2 * density) * (cosh(sqrt(2 * density * 9.81 / whole) * time) - 1);
        const double rise = now[1] - model->position[1], fall = model->position[last + 1] - now[last + 1];
        largest = fmax(largest, fabs(0.5 * (rise + fall) - slid));
    }
    return largest;
}

// A rope that goes up, around the top of a cylinder by so many half turns, and down.
//   mass  of each node;  tension  of each spring at the start, N
static void add_wound(Text *text, int nodes, double radius, double hangs, double half_turns, const double *mass,
                      const double *tension, double stiffness) {
    const double wound = half_turns * M_PI * radius, length = 2 * hangs + wound;
    double before[3] = {0, 0, 0};
    add(text, "network:\n  nodes:\n");
    for (int i = 0; i < nodes; i++) {
        const double along = length * i / (nodes - 1) - hangs, turn = fmin(wound, fmax(0, along)) / radius;
        const double down = along < 0 ? -along : fmax(0, along - wound);
        add(text, "    - {at: [%.17g, %.17g, 0], mass: %.17g}\n", -radius * cos(turn), radius * sin(turn) - down,
            mass[i]);
    }
    add(text, "  springs:\n");
    for (int i = 0; i < nodes; i++) {
        const double along = length * i / (nodes - 1) - hangs, turn = fmin(wound, fmax(0, along)) / radius;
        const double down = along < 0 ? -along : fmax(0, along - wound);
        const double now[3] = {-radius * cos(turn), radius * sin(turn) - down, 0};
        if (i)
            add(text, "    - {ends: [%d, %d], stiffness: %g, damping: 2, rest: %.17g}\n", i - 1, i, stiffness,
                ck_distance(before, now) - tension[i] / stiffness);
        memcpy(before, now, sizeof before);
    }
}

static void test_pulley(void **state) {
    (void)state;
    fixture_skip_long();
    Text text = {.length = 0};
    double mass[PULLEY_NODES], tension[PULLEY_NODES];
    const double length = 2 * PULLEY_HANGS + M_PI * PULLEY_RADIUS, node = 0.05 * length / (PULLEY_NODES - 1);
    for (int i = 0; i < PULLEY_NODES; i++) {
        mass[i] = i == 0 ? 1 + 0.5 * node : i == PULLEY_NODES - 1 ? 1.2 + 0.5 * node : node;
        tension[i] = 2 * 1.0 * 1.2 / 2.2 * 9.81;
    }
    add(&text, "name: a\n");
    add_wound(&text, PULLEY_NODES, PULLEY_RADIUS, PULLEY_HANGS, 1, mass, tension, 1e5);
    add(&text, "gravity: [0, -9.81, 0]\ntime: {duration: 0.4, fps: 60}\n"
               "colliders: [{cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: 0.1}}]\n");
    // of the 0.07 m that it slides: chords are shorter than arcs by (h/r)²/24 = 0.1 %, and the rope's own weight, which
    // the tension at the start leaves out, is 3 %
    follow(text.bytes, off_the_pulley, 1e-3);
}

// Friction over one and a half turns. Source: Euler and Eytelwein, of a polygon: at each corner of an angle d the
// tension grows by (cos(d/2) + μ·sin(d/2))/(cos(d/2) − μ·sin(d/2)) at most.
#define CAPSTAN_CHORDS 48
#define CAPSTAN_ENDS 4
#define CAPSTAN_FRICTION 0.1

static double growth(double angle) {
    return (cos(angle / 2) + CAPSTAN_FRICTION * sin(angle / 2)) / (cos(angle / 2) - CAPSTAN_FRICTION * sin(angle / 2));
}

// How far the end of a rope slides in 0.2 s whose pull is a factor beside what friction holds, m.
static double slides_by(double factor) {
    const int nodes = CAPSTAN_CHORDS + 2 * CAPSTAN_ENDS + 1;
    const double angle = 3 * M_PI / CAPSTAN_CHORDS, radius = 0.1, length = radius * angle;
    const double limit = 2 * log(growth(angle / 2)) + (CAPSTAN_CHORDS - 1) * log(growth(angle));
    const double share = log(exp(limit) * factor) / limit, light = 1e-4;
    double mass[64], tension[64], pull = 9.81;
    Text text = {.length = 0};
    Fixture fixture;
    ck_Trajectory path;
    for (int i = 0; i < nodes; i++) {
        const int corner = i - CAPSTAN_ENDS; // 0 and the last turn by half
        mass[i] = light;
        tension[i] = pull;
        if (corner < 0 || corner > CAPSTAN_CHORDS) continue;
        pull *= pow(growth(corner % CAPSTAN_CHORDS ? angle : angle / 2), share);
    }
    mass[0] = 1;
    mass[nodes - 1] = pull / 9.81;
    add(&text, "name: c\n");
    // the ends hang by four chords' arcs, so that the first and last corner are where it leaves the cylinder
    add_wound(&text, nodes, radius, CAPSTAN_ENDS * length, 3, mass, tension, 2e4);
    add(&text, "gravity: [0, -9.81, 0]\ntime: {duration: 0.2, fps: 60}\n"
               "colliders: [{cylinder: {point: [0, 0, 0], axis: [0, 0, 1], radius: 0.1, friction: 0.1}}]\n");
    fixture_load(&fixture, text.bytes);
    fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
    const double slid = fixture.model.position[3 * (nodes - 1) + 1] -
                        ck_trajectory_position(&path, fixture.model.frame_count)[3 * (nodes - 1) + 1];
    print_message("%g of what friction holds, a factor of %.3f: slides by %.2e m\n", factor, exp(limit), slid);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
    return slid;
}

static void test_capstan(void **state) {
    (void)state;
    fixture_skip_long();
    // at 1.05 the weights gain g·(1 − 1/1.05)·m/(m + 1) = 0.33 m/s², 6.6 mm
    assert_near("holds", slides_by(0.95), 0, 1e-3);
    assert_near("slides", slides_by(1.05), 6.6e-3, 2e-3);
}

// The least gap of all particles in all frames of a path, m.
static double least_gap(const ck_Model *model, const ck_Trajectory *path) {
    double least = INFINITY, normal[3];
    for (int frame = 0; frame < path->frame_count; frame++)
        for (int i = 0; i < model->particle_count; i++)
            least =
                fmin(least, ck_collider_gap(&model->colliders[0], ck_trajectory_position(path, frame) + 3 * i, normal));
    return least;
}

// Cloths that skim a tilted, sharp box, some spacings' billionths above its face and falling by more than that a
// substep: none is found behind the face, however uncertain a way out so short is. What rounding leaves of places of
// 1 m is 1e-16 m each, and some steps add some of these.
static void test_skimming(void **state) {
    (void)state;
    ck_Random random = ck_random_seed(7);
    for (int round = 0; round < 60; round++) {
        const double tilt = 1.4 * ck_random_unit(&random) - 0.7, turn = 1.5 * ck_random_unit(&random);
        const double gap = 0.02e-9 * (3 + 17 * ck_random_unit(&random)), dt = 1e-3, c = cos(tilt), s = sin(tilt);
        const double fall = gap / dt * (1.1 + 2 * ck_random_unit(&random)), speed = 30 * 0.7;
        char text[1000];
        Fixture fixture;
        ck_Trajectory path;
        snprintf(text, sizeof text,
                 "name: skim\ncloth: {rows: 8, columns: 17, spacing: 0.02, mass: 0.136, origin: [%.17g, %.17g, -0.2], "
                 "across: [%.17g, %.17g, 0], down: [0, 0, 1]}\nsprings: {stiffness: 500, shear: 100}\nvelocity: "
                 "[%.17g, %.17g, %g]\ncolliders: [{box: {center: [%.17g, %.17g, 0], size: [6, 1, 6], along: [%.17g, "
                 "%.17g, %.17g], up: [%.17g, %.17g, 0]}}]\ntime: {duration: 0.003, fps: 1000}\n",
                 -gap * s - 0.2 * c, gap * c - 0.2 * s, c, s, speed * c + fall * s, speed * s - fall * c, speed,
                 0.5 * s, -0.5 * c, cos(turn) * c, cos(turn) * s, sin(turn), -s, c);
        fixture_load(&fixture, text);
        fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), &(ck_Settings){.substeps = 1}, NULL);
        assert_true(least_gap(&fixture.model, &path) > -1e-15);
        ck_trajectory_free(&path);
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gap_is_the_distance),
                                       cmocka_unit_test(test_normal_of_a_face),
                                       cmocka_unit_test(test_turn_is_the_curvature),
                                       cmocka_unit_test(test_hits),
                                       cmocka_unit_test(test_table_edge),
                                       cmocka_unit_test(test_pulley),
                                       cmocka_unit_test(test_capstan),
                                       cmocka_unit_test(test_skimming)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
