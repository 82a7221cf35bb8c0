// A live session: what is done in it is a scene that does the same, to the last bit; bad orders do nothing.
#include "fixture_program.h"

#include "fixture.h"

#include "engines.h"
#include "live.h"
#include "orders.h"
#include "session.h"
#include "vector.h"

#include <unistd.h>

static const char cloth[] =
    "name: sheet\nabout: a sheet\n"
    "cloth: {rows: 6, columns: 6, spacing: 0.1, mass: 0.1, down: [0, 0, 1]}\n"
    "springs: {stiffness: 400, shear: 200, damping: 0.05}\npins: [top_left, top_right]\n"
    "gravity: [0, -9.81, 0]\ndrag: 1\ncolliders: [{plane: {point: [0, -0.9, 0], normal: [0, 1, 0]}}]\n"
    "time: {duration: 0.5, fps: 60}\ntruth: rest\n";
static const char *const names[] = {"native-verlet", "native-xpbd", "bullet-pbd", "ode-quick", "mujoco"};
#define ENGINES 5

static int start(ck_Live **live, ck_Stage *stage, const char *path) {
    const ck_Engine *engines[ENGINES];
    // as from the command line
    ck_Settings wanted[ENGINES] = {{0}, {.substeps = 11}};
    const ck_Limits limits = ck_limits_default();
    ck_Error error = {0};
    int count = 0;
    for (int i = 0; i < ENGINES; i++)
        if (ck_engine_find(names[i])) engines[count++] = ck_engine_find(names[i]);
    if (ck_live_start(live, path, engines, wanted, count, &limits, &error)) fail_msg("%s", error.message);
    assert_int_equal(ck_stage_begin(stage, *live), CK_OK);
    stage->folder = fixture_directory;
    return count;
}

// Tells the stage something; what it answers must hold that, or nothing be answered.
static void tell(ck_Stage *stage, const char *order, const char *wanted) {
    char answer[1000];
    ck_stage_obey(stage, order, strlen(order), answer, sizeof answer);
    if (wanted ? !strstr(answer, wanted) : *answer) fail_msg("%s: %s", order, answer);
}

// The saved scene, run as compare runs it.
static void run_again(const char *path, const ck_Engine *engine, ck_Trajectory *shown) {
    Fixture fixture;
    ck_Error error = {0};
    ck_Session session;
    ck_Settings used;
    if (fixture_open(&fixture, path, &error)) fail_msg("%s", error.message);
    assert_int_equal(ck_trajectory_create(shown, &fixture.model, &error), CK_OK);
    const ck_Settings wanted = ck_engine_scene_settings(engine, &fixture.scene);
    assert_int_equal(ck_session_begin(&session, engine, &fixture.model, &wanted, &used, NULL, &error), CK_OK);
    for (int frame = 0; frame < fixture.model.frame_count; frame++)
        assert_int_equal(ck_session_advance(&session, frame), CK_STEP_OK);
    ck_session_read(&session, shown, 0);
    shown->frame_count = fixture.model.frame_count;
    ck_session_end(&session);
    fixture_free(&fixture);
}

static void test_same_bits(void **state) {
    (void)state;
    ck_Live *live;
    ck_Stage stage;
    char *path = fixture_file(cloth), saved[300];
    const int count = start(&live, &stage, path);
    // longer than the scene itself, with something done in each of many frames
    for (int frame = 0; frame < 70; frame++) {
        if (frame == 0) tell(&stage, "{\"do\":\"set\",\"key\":\"drag\",\"value\":\"0.5\"}", NULL);
        if (frame == 10) tell(&stage, "{\"do\":\"lock\",\"particle\":20}", NULL);
        if (frame == 20) tell(&stage, "{\"do\":\"set\",\"key\":\"gravity\",\"value\":\"[3, -5, 1]\"}", NULL);
        if (frame == 20) tell(&stage, "{\"do\":\"free\",\"particle\":0}", NULL);
        if (frame == 30) tell(&stage, "{\"do\":\"set\",\"key\":\"springs.stiffness\",\"value\":\"250\"}", NULL);
        if (frame == 35)
            tell(&stage, "{\"do\":\"set\",\"key\":\"settings.native-xpbd.substeps\",\"value\":\"9\"}", NULL);
        if (frame == 40) tell(&stage, "{\"do\":\"drag\",\"particle\":35,\"to\":[0.4, 0.3, 0.2]}", NULL);
        if (frame == 43) tell(&stage, "{\"do\":\"drag\",\"particle\":35,\"to\":[0.5, 0.1, 0.6]}", NULL);
        if (frame == 55) tell(&stage, "{\"do\":\"drop\"}", NULL);
        ck_stage_step(&stage);
    }
    tell(&stage, "{\"do\":\"save\",\"name\":\"told\"}", "saved");
    snprintf(saved, sizeof saved, "%s/told.yaml", fixture_directory);
    for (int i = 0; i < count; i++) {
        const ck_LiveEngine *engine = ck_live_engine(live, i);
        ck_Trajectory again;
        if (!engine->runs) fail_msg("%s: %s", engine->engine->name, engine->reason);
        run_again(saved, engine->engine, &again);
        assert_int_equal(again.frame_count, 70);
        const double *one = ck_trajectory_position(&engine->shown, 0), *other = ck_trajectory_position(&again, 0);
        double off = 0;
        for (int k = 0; k < 3 * again.particle_count; k++) off = fmax(off, fabs(one[k] - other[k]));
        print_message("%-16s %g m off\n", engine->engine->name, off);
        assert_memory_equal(one, other, 6 * sizeof *one * (size_t)again.particle_count);
        ck_trajectory_free(&again);
    }
    ck_stage_end(&stage);
    ck_live_end(live);
    unlink(path);
    free(path);
}

// A point that is dragged goes there, in all engines, and hangs free again once it is dropped; locked ones stay.
static void test_orders(void **state) {
    (void)state;
    ck_Live *live;
    ck_Stage stage;
    char *path = fixture_file(cloth);
    const int count = start(&live, &stage, path);
    const double goal[3] = {0.4, 0.2, 0.4};
    double start_at[3 * 36];
    memcpy(start_at, ck_live_model(live)->position, sizeof start_at);
    tell(&stage, "{\"do\":\"lock\",\"particle\":14}", NULL);
    tell(&stage, "{\"do\":\"drag\",\"particle\":35,\"to\":[0.4, 0.2, 0.4]}", NULL);
    for (int frame = 0; frame < 20; frame++) ck_stage_step(&stage);
    for (int i = 0; i < count; i++) {
        const double *at = ck_trajectory_position(&ck_live_engine(live, i)->shown, 0);
        assert_near("dragged", ck_distance(at + 3 * 35, goal), 0, 1e-6);
        assert_near("locked", ck_distance(at + 3 * 14, start_at + 3 * 14), 0, 1e-12);
    }
    tell(&stage, "{\"do\":\"drop\"}", NULL);
    for (int frame = 0; frame < 20; frame++) ck_stage_step(&stage);
    for (int i = 0; i < count; i++)
        assert_true(ck_distance(ck_trajectory_position(&ck_live_engine(live, i)->shown, 0) + 3 * 35, goal) > 0.02);
    tell(&stage, "{\"do\":\"reset\"}", "back to the start");
    assert_int_equal(ck_live_frame(live), 0);
    assert_false(ck_live_model(live)->pinned[14]);
    for (int i = 0; i < count; i++)
        assert_memory_equal(ck_trajectory_position(&ck_live_engine(live, i)->shown, 0), start_at, sizeof start_at);
    ck_stage_end(&stage);
    ck_live_end(live);
    unlink(path);
    free(path);
}

// Another frame rate is another session, that begins as this one did, and that is saved with it.
static void test_rate(void **state) {
    (void)state;
    ck_Live *live;
    ck_Stage stage;
    char *path = fixture_file(cloth), saved[300];
    const int count = start(&live, &stage, path);
    tell(&stage, "{\"do\":\"lock\",\"particle\":20}", NULL);
    tell(&stage, "{\"do\":\"drag\",\"particle\":35,\"to\":[0.4, 0.2, 0.4]}", NULL);
    ck_stage_step(&stage);
    tell(&stage, "{\"do\":\"rate\",\"rate\":0}", "rate takes");
    assert_int_equal(ck_live_frame(stage.live), 1);
    tell(&stage, "{\"do\":\"rate\",\"rate\":120}", NULL);
    tell(&stage, "{\"do\":\"rate\",\"rate\":25}", NULL);
    const ck_Model *model = ck_live_model(stage.live);
    assert_int_equal(ck_live_frame(stage.live), 0);
    assert_near("step", model->step, 0.04, 1e-15);
    assert_false(model->pinned[20]);
    assert_int_equal(stage.held, -1);
    for (int frame = 0; frame < 9; frame++) ck_stage_step(&stage);
    tell(&stage, "{\"do\":\"save\",\"name\":\"slow\"}", "slow.yaml -e native-verlet -e native-xpbd");
    snprintf(saved, sizeof saved, "%s/slow.yaml", fixture_directory);
    for (int i = 0; i < count; i++) {
        const ck_LiveEngine *engine = ck_live_engine(stage.live, i);
        ck_Trajectory again;
        run_again(saved, engine->engine, &again);
        assert_int_equal(again.frame_count, 9);
        assert_memory_equal(ck_trajectory_position(&engine->shown, 0), ck_trajectory_position(&again, 0),
                            6 * sizeof(double) * (size_t)again.particle_count);
        ck_trajectory_free(&again);
    }
    live = stage.live;
    ck_stage_end(&stage);
    ck_live_end(live);
    unlink(path);
    free(path);
}

// What is no order, names what is not there, or reaches for a file, does nothing but say so.
static void test_bad_orders(void **state) {
    (void)state;
    static const struct {
        const char *order, *wanted;
    } cases[] = {
        {"", "no such order"},
        {"{", "no such order"},
        {"[1, 2]", "no such order"},
        {"{\"do\":7}", "no such order"},
        {"{\"do\":\"fly\"}", "no such order"},
        {"{\"do\":\"lock\",\"particle\":36}", "no such particle"},
        {"{\"do\":\"lock\",\"particle\":-1}", "no such particle"},
        {"{\"do\":\"lock\",\"particle\":1.5}", "no such particle"},
        {"{\"do\":\"drag\",\"particle\":1,\"to\":[1, 2]}", "takes a place"},
        {"{\"do\":\"drag\",\"particle\":1,\"to\":[1, 2, 1e300]}", "takes a place"},
        {"{\"do\":\"set\",\"key\":\"mesh.file\",\"value\":\"1\"}", "cannot be set"},
        {"{\"do\":\"set\",\"key\":\"name\",\"value\":\"1\"}", "cannot be set"},
        {"{\"do\":\"set\",\"key\":\"pins\",\"value\":\"[1]\"}", "cannot be set"},
        {"{\"do\":\"set\",\"key\":\"drag\",\"value\":\"-3\"}", "drag is -3"},
        {"{\"do\":\"set\",\"key\":\"drag\",\"value\":\"1@gravity=[0,0,0]\"}", "takes numbers"},
        {"{\"do\":\"set\",\"key\":\"drag\",\"value\":\"1\\nmesh: 1\"}", "takes numbers"},
        {"{\"do\":\"set\",\"key\":\"drag@x\",\"value\":\"1\"}", "cannot be set"},
        {"{\"do\":\"set\",\"key\":\"springs.stiffness\",\"value\":\"[1]\"}", "must be a number"},
        {"{\"do\":\"save\",\"name\":\"../out\"}", "a name is made of"},
        {"{\"do\":\"save\",\"name\":\".hidden\"}", "a name is made of"},
        {"{\"do\":\"save\",\"name\":\"early\"}", "nothing has been stepped"},
        {"{\"do\":\"pace\",\"times\":-1}", "pace takes"},
    };
    ck_Live *live;
    ck_Stage stage;
    char *path = fixture_file(cloth);
    const int count = start(&live, &stage, path);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) tell(&stage, cases[i].order, cases[i].wanted);
    assert_near("drag", ck_live_model(live)->drag, 1, 0);
    ck_stage_step(&stage);
    for (int i = 0; i < count; i++) assert_true(ck_live_engine(live, i)->runs);
    ck_stage_end(&stage);
    ck_live_end(live);
    unlink(path);
    free(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_same_bits), cmocka_unit_test(test_orders),
                                       cmocka_unit_test(test_rate), cmocka_unit_test(test_bad_orders)};
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
