// Air pushes faces by its law, a sheet that falls in it comes to its terminal speed, and still air only takes energy.
#include "fixture_truth.h"

#include "springs.h"
#include "vector.h"
#include "wind.h"

#include <unistd.h>

// A right triangle of 3 m² in the plane of x and z; its faces lie across y.
static void load_face(Fixture *fixture, const char *wind) {
    char text[500];
    snprintf(
        text, sizeof text,
        "name: f\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [2, 0, 0], mass: 1}, {at: [0, 0, 3], mass: 1}]\n"
        "  triangles: [[0, 1, 2]]\nwind: {%s}\ntime: {duration: 1, step: 1}\n",
        wind);
    fixture_load(fixture, text);
}

// At an angle a between face and wind: drag ½ρC_dA·sin a·u² along it, lift ½ρC_lA·sin a·cos a·u² across; the same where
// the face moves against still air.
static void test_face(void **state) {
    (void)state;
    for (int degrees = 0; degrees <= 180; degrees += 15) {
        const double angle = degrees * M_PI / 180, speed = 7, unit = 0.5 * 1.3 * 3 * speed * speed;
        for (int moves = 0; moves < 2; moves++) {
            Fixture fixture;
            char wind[200];
            const double along[3] = {cos(angle), sin(angle), 0}, sign = moves ? -speed : 0;
            double velocity[9], force[3];
            snprintf(wind, sizeof wind, "velocity: [%.17g, %.17g, 0], density: 1.3, drag: 1.1, lift: 0.4",
                     moves ? 0 : speed * along[0], moves ? 0 : speed * along[1]);
            load_face(&fixture, wind);
            for (int i = 0; i < 9; i++) velocity[i] = sign * along[i % 3];
            ck_wind_face_force(&fixture.model, 0, fixture.model.position, velocity, force);
            const double drag = ck_dot(force, along), lift = -force[0] * along[1] + force[1] * along[0];
            assert_near("drag", drag, 1.1 * unit * fabs(sin(angle)), 1e-12 * unit);
            assert_near("lift", lift, 0.4 * unit * fabs(sin(angle)) * cos(angle), 1e-12 * unit);
            assert_true(fabs(force[2]) < 1e-12 * unit);
            fixture_free(&fixture);
        }
    }
}

// A grid feels its whole area, each corner a quarter of each of its squares.
static void test_grid(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, "name: g\ncloth: {rows: 4, columns: 3, spacing: 0.5, mass: 1}\n"
                           "wind: {velocity: [0, 0, 2], density: 1, drag: 1}\ntime: {duration: 1, step: 1}\n");
    double force[36] = {0}, sum = 0;
    ck_wind_add_force(&fixture.model, fixture.model.position, fixture.model.velocity, NULL, force);
    for (int i = 0; i < 12; i++) sum += force[3 * i + 2];
    assert_near("whole", sum, 0.5 * 4 * 1.5 * 1, 1e-12);
    assert_near("corner", force[2], sum / 6 / 4, 1e-12);
    assert_near("inner", force[3 * 4 + 2], sum / 6, 1e-12);
    fixture_free(&fixture);
}

// Every engine that knows air comes to the terminal speed, and native-verlet falls with the truth in second order.
static void test_fall(void **state) {
    (void)state;
    TruthFixture fixture;
    ck_Error error = {0};
    ck_Trajectory path;
    if (fixture_open_truth(&fixture, SCENE_DIRECTORY "/air_fall.yaml", &error)) fail_msg("%s", error.message);
    if (ck_truth_create(&fixture.truth, &fixture.model, NULL, NULL, &error)) fail_msg("%s", error.message);
    const double terminal = sqrt(2 * 0.2 * 9.81 / (1.225 * 1.2));
    int count = 0;
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!fixture_is_solver(engine) || !fixture_supports(engine, &fixture.model)) continue;
        fixture_run(&path, &fixture.model, engine, NULL, NULL);
        const double speed = -ck_trajectory_velocity(&path, fixture.model.frame_count)[1];
        print_message("%s: %.5f of the terminal speed\n", engine->name, speed / terminal);
        // after 2 s, 12 of the time v_t/g, nothing is left of the start; Bullet and ODE keep the last step's push of
        // air
        assert_near(engine->name, speed / terminal, 1, 1e-3);
        ck_trajectory_free(&path);
        count++;
    }
    assert_true(count >= 7);
    double errors[2];
    for (uint32_t i = 0; i < 2; i++) {
        const ck_Settings settings = {.substeps = 20u << i};
        fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), &settings, NULL);
        errors[i] = ck_metric_value(ck_metric_find("position_rms"), &fixture.model, &path, &fixture.truth.reference);
        ck_trajectory_free(&path);
    }
    assert_near("order", log2(errors[0] / errors[1]), 2, 0.2);
    fixture_free_truth(&fixture);
}

// A sheet that swings in still air never has more energy than before.
static void test_still(void **state) {
    (void)state;
    Fixture fixture;
    ck_Trajectory path;
    fixture_load(&fixture, "name: s\ncloth: {rows: 5, columns: 5, spacing: 0.1, mass: 0.05, down: [0, 0, 1]}\n"
                           "springs: {stiffness: 100, shear: 50}\nwind: {drag: 1.2, lift: 0.8}\npins: [top_edge]\n"
                           "gravity: [0, -9.81, 0]\ntime: {duration: 2, fps: 60}\n");
    fixture_run(&path, &fixture.model, ck_engine_find("native-verlet"), NULL, NULL);
    double before = INFINITY, scale = ck_energy_scale(&fixture.model, &path);
    for (int frame = 0; frame <= fixture.model.frame_count; frame++) {
        const ck_Energy energy = ck_energy_at(&fixture.model, &path, frame);
        assert_true(ck_energy_total(&energy) < before + 1e-4 * scale); // Verlet's own swing, of the second order
        before = fmin(before, ck_energy_total(&energy));
    }
    const ck_Energy start = ck_energy_at(&fixture.model, &path, 0);
    assert_true(before < ck_energy_total(&start) - 0.3 * scale);
    ck_trajectory_free(&path);
    fixture_free(&fixture);
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *message;
    } cases[] = {
        {"name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nwind: {drag: 1}\ntime: {duration: 1, step: 1}\n",
         "wind acts on faces, which this body has none of"},
        {"name: r\ncloth: {rows: 3, columns: 3, spacing: 1, mass: 1}\nwind: {lift: 1}\ntime: {duration: 1, step: 1}\n",
         "wind lacks the key drag"},
        {"name: r\ncloth: {rows: 3, columns: 3, spacing: 1, mass: 1}\nsprings: {stiffness: 9}\npins: [top_edge]\n"
         "gravity: [0, -9, 0]\nwind: {velocity: [1, 0, 0], drag: 1}\ntime: {duration: 1, step: 1}\ntruth: "
         "equilibrium\n",
         "still air: wind has no energy to be least"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Error error = {0};
        char *path = fixture_file(cases[i].text);
        if (fixture_open_truth(&fixture, path, &error) != CK_BAD_INPUT || !strstr(error.message, cases[i].message))
            fail_msg("'%s' without '%s'", error.message, cases[i].message);
        fixture_free_truth(&fixture);
        unlink(path);
        free(path);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_face), cmocka_unit_test(test_grid),
                                       cmocka_unit_test(test_fall), cmocka_unit_test(test_still),
                                       cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
