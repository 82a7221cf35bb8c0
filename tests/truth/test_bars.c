// The reference with rigid bars: pendulums, ropes and pins that move, against closed forms, angles and conservation.
#include "fixture_truth.h"

#include "path.h"
#include "runge_kutta.h"
#include "springs.h"
#include "vector.h"

static void open_path(Fixture *fixture, ck_ReferencePath *path, const char *text) {
    ck_Error error = {0};
    fixture_load(fixture, text);
    if (ck_reference_path_create(path, &fixture->model, &error)) fail_msg("%s", error.message);
}

static void close_path(Fixture *fixture, ck_ReferencePath *path) {
    ck_reference_path_free(path);
    fixture_free(fixture);
}

// A level rope of 19 bars let go: the depth of its tip after 1 s, in lengths, by a model in angles.
static void test_level_rope(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    open_path(&fixture, &path,
              "name: l\nrope: {particles: 20, spacing: 0.1, mass: 1, along: [1, 0, 0]}\nsprings: {rigid: true}\n"
              "pins: [first]\ngravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n");
    const double *end = ck_trajectory_position(&path.fine, 60);
    print_message("tip %.9f below after 1 s, horizon %d, %d substeps\n", -end[58], path.horizon, path.substeps);
    assert_near("tip", -end[58] / 1.9, 0.4384706, 1e-7);
    double energy = ck_energy_drift(&fixture.model, &path.fine);
    assert_near("energy", energy, 0, 1e-9);
    assert_near("longest bar", ck_springs_largest_strain(&fixture.model, end), 0, 1e-13);
    close_path(&fixture, &path);
}

// A double pendulum in angles, by the same method at a step of 1e-4 s.
static void double_pendulum(const double *y, double *k) {
    const double g = 9.81, a = y[0], b = y[1], p = y[2], q = y[3], c = cos(a - b), s = sin(a - b);
    // 2·a'' + c·b'' = −s·q² − 2g·sin a;  c·a'' + b'' = s·p² − g·sin b, of unit lengths and masses
    const double f = -s * q * q - 2 * g * sin(a), h = s * p * p - g * sin(b), determinant = 2 - c * c;
    k[0] = p;
    k[1] = q;
    k[2] = (f - c * h) / determinant;
    k[3] = (2 * h - c * f) / determinant;
}

static void test_double_pendulum(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    const double a = 1.2, b = -0.4;
    char text[500];
    snprintf(text, sizeof text,
             "name: d\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [%.17g, %.17g, 0], mass: 1}, {at: [%.17g, "
             "%.17g, 0], mass: 1}]\n  bars: [[0, 1], [1, 2]]\nsprings: {rigid: true}\npins: [0]\n"
             "gravity: [0, -9.81, 0]\ntime: {duration: 2, fps: 50}\n",
             sin(a), -cos(a), sin(a) + sin(b), -cos(a) - cos(b));
    open_path(&fixture, &path, text);
    double y[4] = {a, b, 0, 0}, largest = 0;
    for (int step = 0; step <= 20000; step++) {
        const double *x = ck_trajectory_position(&path.fine, step / 200);
        const double tip[3] = {sin(y[0]) + sin(y[1]), -cos(y[0]) - cos(y[1]), 0};
        if (step % 200 == 0 && step / 200 <= path.horizon) largest = fmax(largest, ck_distance(x + 6, tip));
        double k[4][4], z[4];
        for (int i = 0; i < 4; i++) {
            const double node = i == 3 ? 1 : i ? 0.5 : 0;
            for (int j = 0; j < 4; j++) z[j] = y[j] + (i ? node * 1e-4 * k[i - 1][j] : 0);
            double_pendulum(z, k[i]);
        }
        for (int j = 0; j < 4; j++) y[j] += 1e-4 / 6 * (k[0][j] + 2 * k[1][j] + 2 * k[2][j] + k[3][j]);
    }
    print_message("double pendulum: %.2g m off its angles up to frame %d of 100\n", largest, path.horizon);
    assert_int_equal(path.horizon, 100);
    // the reference agrees with itself to 1e-9 of its size, 2 m
    assert_near("tip", largest, 0, 2e-9);
    close_path(&fixture, &path);
}

// A bar swung about a pin by a second one: length, momentum about the axis and energy stay.
static void test_whirl(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    open_path(
        &fixture, &path,
        "name: w\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [0.5, 0, 0], mass: 0.2, velocity: [0, 0, 3]}, "
        "{at: [1, 0, 0], mass: 0.1, velocity: [0, 1, 6]}]\n  bars: [[0, 1], [1, 2]]\nsprings: {rigid: true}\n"
        "pins: [0]\ntime: {duration: 2, fps: 50}\n");
    const ck_Model *model = &fixture.model;
    double start[3] = {0};
    for (int frame = 0; frame <= 100; frame++) {
        double momentum[3] = {0}, turn[3];
        for (int i = 1; i < 3; i++) {
            ck_cross(turn, ck_trajectory_position(&path.fine, frame) + 3 * i,
                     ck_trajectory_velocity(&path.fine, frame) + 3 * i);
            ck_add_scaled(momentum, model->mass[i], turn);
        }
        if (!frame) memcpy(start, momentum, sizeof start);
        assert_near("angular momentum", ck_distance(momentum, start), 0, 1e-9 * ck_length(start));
    }
    close_path(&fixture, &path);
}

// A mass on a bar whose pin is moved by A·sin(Ω·t), sideways and little: x'' = −ω²·(x − A·sin(Ω·t)).
static void test_moved_pin(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    const double pi = acos(-1), amplitude = 1e-4, drive = 2 * pi * 0.8, own = sqrt(9.81);
    open_path(&fixture, &path,
              "name: m\nrope: {particles: 2, spacing: 1, mass: 1}\nsprings: {rigid: true}\npins: [first]\n"
              "moves: [{pins: [first], path: {amplitude: [1.0e-4, 0, 0], frequency: 0.8}}]\n"
              "gravity: [0, -9.81, 0]\ntime: {duration: 2, fps: 50}\n");
    double largest = 0;
    for (int frame = 0; frame <= 100; frame++) {
        const double t = frame / 50.0, *x = ck_trajectory_position(&path.fine, frame);
        const double share = own * own * amplitude / (own * own - drive * drive);
        largest = fmax(largest, fabs(x[3] - share * (sin(drive * t) - drive / own * sin(own * t))));
        assert_near("pin", x[0], amplitude * sin(drive * t), 1e-15);
    }
    print_message("moved pendulum: %.2g of its amplitude off the linear form\n", largest / amplitude);
    // linear in the angle: off by its square, 1e-7
    assert_near("mass", largest, 0, 1e-6 * amplitude);
    close_path(&fixture, &path);
}

// A mass on a spring whose pin runs off at speed v and stops: x = v·(t − sin(ω·t)/ω), then it rings about the new
// place.
static void test_pulled(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    const double v = 5, own = sqrt(400 / 0.5), stop = 0.2;
    open_path(&fixture, &path,
              "name: p\nrope: {particles: 2, spacing: 2, mass: 1, along: [1, 0, 0]}\nsprings: {stiffness: 400}\n"
              "pins: [first]\nmoves: [{pins: [first], path: {velocity: [5, 0, 0], to: 0.2}}]\n"
              "time: {duration: 1, fps: 48}\n");
    double largest = 0;
    for (int frame = 0; frame <= 48; frame++) {
        const double t = frame / 48.0, left = t - stop;
        const double at = v * (stop - sin(own * stop) / own), speed = v * (1 - cos(own * stop));
        const double wanted = left <= 0 ? v * (t - sin(own * t) / own)
                                        : v * stop + (at - v * stop) * cos(own * left) + speed / own * sin(own * left);
        largest = fmax(largest, fabs(ck_trajectory_position(&path.fine, frame)[3] - 2 - wanted));
    }
    print_message("pulled mass: %.2g m off its form, of 1 m\n", largest);
    assert_near("mass", largest, 0, 2e-9);
    close_path(&fixture, &path);
}

// The time in which the free end of a folded chain of length 1 falls so far, by v² = g·y·(2 − y)/(1 − y) of one that is
// fine and loses nothing. Source: Calkin and March 1989.
static double folded_time(double fallen) {
    double time = 0;
    const int steps = 100000;
    // y = u²·fallen, so that the root at the start is none
    for (int i = 0; i < steps; i++) {
        const double u = (i + 0.5) / steps, y = u * u * fallen;
        time += 2 * u * fallen / steps / sqrt(9.81 * y * (2 - y) / (1 - y));
    }
    return time;
}

// A chain that hangs folded from its two ends, one of which is let go, which falls faster than free; of so many bars.
static double folded_fall(int half, double time) {
    const int particles = 2 * half + 2;
    const double bar = 1.0 / (2 * half + 1);
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    fprintf(out, "name: u\nnetwork:\n  nodes: [");
    for (int i = 0; i < particles; i++) {
        const bool is_left = i <= half;
        fprintf(out, "%s{at: [%.17g, %.17g, 0], mass: 0.01}", i ? ", " : "", is_left ? 0 : bar,
                -bar * (is_left ? i : particles - 1 - i));
    }
    fprintf(out, "]\n  bars: [");
    for (int i = 1; i < particles; i++) fprintf(out, "%s[%d, %d]", i > 1 ? ", " : "", i - 1, i);
    fprintf(out,
            "]\nsprings: {rigid: true}\npins: ['0']\ngravity: [0, -9.81, 0]\ntime: {duration: %.17g, fps: %.17g}\n",
            time, 40 / time);
    fclose(out);
    Fixture fixture;
    ck_ReferencePath path;
    open_path(&fixture, &path, text);
    const double fallen = -ck_trajectory_position(&path.fine, 40)[3 * (particles - 1) + 1];
    print_message("%d bars: fallen %.5f, horizon %d of 40\n", particles - 1, fallen, path.horizon);
    close_path(&fixture, &path);
    free(text);
    return fallen;
}

// Half of the bars of the finest; the sanitizers make it ten times as slow.
#ifdef __SANITIZE_ADDRESS__
#define FINEST 20
#else
#define FINEST 40
#endif

static void test_folded_chain(void **state) {
    (void)state;
    const double fallen = 0.6, time = folded_time(fallen);
    print_message("time %.5f s, of free fall %.5f s\n", time, sqrt(2 * fallen / 9.81));
    double off = 1;
    for (int half = 5; half <= FINEST; half *= 2) {
        const double now = folded_fall(half, time);
        // faster than what falls freely, and nearer to the fine chain the finer it is: by a power of its bars' length
        assert_true(now > 0.5 * 9.81 * time * time);
        assert_true(fallen - now > 0 && fallen - now < off / 1.3);
        off = fallen - now;
    }
    assert_true(off < 0.025 * 40 / FINEST);
}

// The bars of a triangle pinned at all its corners hold one another.
static void test_refused(void **state) {
    (void)state;
    Fixture fixture;
    ck_ReferencePath path;
    ck_Error error = {0};
    fixture_load(&fixture,
                 "name: t\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [2, 0, "
                 "0], mass: 1}]\n  bars: [[0, 1], [1, 2]]\nsprings: {rigid: true}\npins: [0, 2]\n"
                 "gravity: [0, -9.81, 0]\ntime: {duration: 1, fps: 60}\n");
    assert_int_equal(ck_reference_path_create(&path, &fixture.model, &error), CK_REFUSED);
    print_message("%s\n", error.message);
    close_path(&fixture, &path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_level_rope), cmocka_unit_test(test_double_pendulum),
                                       cmocka_unit_test(test_whirl),      cmocka_unit_test(test_moved_pin),
                                       cmocka_unit_test(test_pulled),     cmocka_unit_test(test_folded_chain),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
