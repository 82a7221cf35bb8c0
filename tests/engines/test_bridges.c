// Every call of an engine that is no native one, with what it holds in between: made, stepped through contact, asked,
// a pin let go, and ended. For valgrind, which sees into their libraries.
#include "fixture.h"

static const char text[] =
    "name: fall\ncloth: {rows: 4, columns: 4, spacing: 0.1, mass: 0.1, origin: [-0.15, 0.22, -0.15], "
    "down: [0, 0, 1]}\nsprings: {stiffness: 100, shear: 50, damping: 0.05}\n"
    "pins: [top_left]\nrelease: [{at: 0.1, pins: [top_left]}]\ngravity: [0, -9.81, 0]\n"
    "colliders: [{sphere: {center: [0, 0, 0], radius: 0.2, friction: 0.3}}]\n"
    "time: {duration: 0.4, step: 0.02}\n";

static void test_bridges(void **state) {
    (void)state;
    int taken = 0;
    Fixture fixture;
    fixture_load(&fixture, text);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Trajectory path;
        if (!strcmp(engine->family, "native") || !fixture_supports(engine, &fixture.model) ||
            !fixture_takes(engine, &fixture.model))
            continue;
        fixture_run(&path, &fixture.model, engine, &(ck_Settings){0}, NULL);
        // nothing is where it began
        assert_true(path.frame_count > fixture.model.frame_count);
        assert_true(ck_trajectory_position(&path, fixture.model.frame_count)[1] < fixture.model.position[1]);
        ck_trajectory_free(&path);
        taken++;
    }
    // Bullet's four and ODE's two
    assert_true(taken >= 6);
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bridges)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
