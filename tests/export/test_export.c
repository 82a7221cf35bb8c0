// What is exported loads again into the same numbers, and moves alike, byte for byte.
#include "fixture.h"

#include "export.h"

#include <glob.h>
#include <unistd.h>

static void assert_bytes(const char *scene, const char *what, const void *one, const void *other, size_t bytes) {
    if (bytes && memcmp(one, other, bytes)) fail_msg("%s: %s changed", scene, what);
}

static void assert_same_model(const ck_Model *one, const ck_Model *other) {
    const size_t particles = (size_t)one->particle_count;
    assert_int_equal(one->particle_count, other->particle_count);
    assert_int_equal(one->spring_count, other->spring_count);
    assert_int_equal(one->collider_count, other->collider_count);
    assert_int_equal(one->terms, other->terms);
    assert_int_equal(one->frame_count, other->frame_count);
    assert_bytes(one->name, "positions", one->position, other->position, 3 * particles * sizeof(double));
    assert_bytes(one->name, "velocities", one->velocity, other->velocity, 3 * particles * sizeof(double));
    assert_bytes(one->name, "masses", one->mass, other->mass, particles * sizeof(double));
    assert_bytes(one->name, "pins", one->pinned, other->pinned, particles);
    assert_bytes(one->name, "releases", one->released, other->released, particles);
    for (int i = 0; i < one->spring_count; i++) {
        const ck_Spring *a = &one->springs[i], *b = &other->springs[i];
        if (a->a != b->a || a->b != b->b || a->rest != b->rest || a->stiffness != b->stiffness ||
            a->damping != b->damping || a->kind != b->kind)
            fail_msg("%s: spring %d changed", one->name, i);
    }
    for (int i = 0; i < one->collider_count; i++) {
        const ck_Collider *a = &one->colliders[i], *b = &other->colliders[i];
        assert_int_equal(a->shape, b->shape);
        assert_bytes(one->name, "a collider's place", a->point, b->point, sizeof a->point);
        assert_bytes(one->name, "a collider's normal", a->normal, b->normal, sizeof a->normal);
        assert_true(a->radius == b->radius && a->restitution == b->restitution && a->friction == b->friction);
    }
    const double of_one[] = {one->drag, one->step, one->duration, one->size, one->spacing},
                 of_other[] = {other->drag, other->step, other->duration, other->size, other->spacing};
    assert_bytes(one->name, "a number", of_one, of_other, sizeof of_one);
    assert_bytes(one->name, "gravity", one->gravity, other->gravity, sizeof one->gravity);
    assert_bytes(one->name, "force", one->force, other->force, sizeof one->force);
}

// The last of some frames by native-verlet's list of springs, which knows nothing of rows and columns: [6*n].
static double *move(const ck_Model *model, int frames) {
    const ck_Engine *engine = ck_engine_find("native-verlet");
    ck_Model list = *model;
    ck_Settings automatic = {0}, used;
    ck_Error error = {0};
    void *state;
    list.columns = 0;
    list.body = CK_NETWORK;
    if (ck_engine_create(engine, &state, &list, &automatic, &used, NULL, &error)) fail_msg("%s", error.message);
    double *last = calloc(6 * (size_t)model->particle_count, sizeof *last);
    assert_non_null(last);
    for (int i = 0; i < frames; i++) ck_engine_advance(engine, state, &list, i);
    engine->read(state, last, last + 3 * model->particle_count);
    engine->destroy(state);
    return last;
}

static void try_scene(const char *path) {
    Fixture fixture, again;
    ck_Error error = {0};
    char *copy = fixture_file("");
    FILE *file = fopen(copy, "w");
    assert_non_null(file);
    if (fixture_open(&fixture, path, &error)) fail_msg("%s", error.message);
    if (ck_export_json(file, &fixture.model, &error)) fail_msg("%s", error.message);
    fclose(file);
    if (fixture_open(&again, copy, &error)) fail_msg("%s: %s", path, error.message);
    assert_same_model(&fixture.model, &again.model);
    // some frames tell, and the debug build is slow
    int frames = fixture.model.particle_count > 1000 ? 3
                 : fixture.model.frame_count < 40    ? fixture.model.frame_count
                                                     : 40;
    if (!ck_engine_lacks(ck_engine_find("native-verlet"), &fixture.model)) {
        double *one = move(&fixture.model, frames), *other = move(&again.model, frames);
        assert_bytes(path, "the way", one, other, 6 * (size_t)fixture.model.particle_count * sizeof *one);
        free(one);
        free(other);
    }
    fixture_free(&again);
    fixture_free(&fixture);
    unlink(copy);
    free(copy);
}

static void test_every_scene(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob(SCENE_DIRECTORY "/*.yaml", 0, NULL, &found), 0);
    assert_true(found.gl_pathc > 30);
#ifdef __SANITIZE_ADDRESS__
    const size_t apart = 3;
#else
    const size_t apart = 1;
#endif
    for (size_t i = 0; i < found.gl_pathc; i += apart) try_scene(found.gl_pathv[i]);
    globfree(&found);
}

// Springs of their own values: slack, bars of three kinds, speeds.
static void test_network(void **state) {
    (void)state;
    char *path = fixture_file(
        "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 0.1, velocity: [0.1, 0.3, 0]},\n"
        "    {at: [2, 0, 0], mass: 0.3}]\n  springs: [{ends: [0, 1], stiffness: 3, rest: 1.1}, {ends: [1, 2], "
        "stiffness: 7,\n    damping: 0.7, kind: shear}, {ends: [0, 2], stiffness: 1, kind: bend}]\n  bars: [[0, 2]]\n"
        "springs: {stiffness: 5, prestretch: 0.1}\npins: [first]\nvelocity: [1, 0, 0]\n"
        "colliders: [{plane: {point: [0, -3, 0], normal: [0.1, 1, 0.3]}}]\ntime: {duration: 1, fps: 60}\n");
    Fixture fixture;
    ck_Error error = {0};
    if (fixture_open(&fixture, path, &error)) fail_msg("%s", error.message);
    const ck_Model *model = &fixture.model;
    assert_int_equal(model->spring_count, 4);
    assert_near("bar", model->springs[0].rest, 2 / 1.1, 1e-15);
    assert_near("slack", model->springs[1].rest, 1.1, 0);
    assert_near("from the distance", model->springs[2].rest, 1, 0);
    assert_int_equal(model->springs[2].kind, CK_SHEAR);
    assert_near("its own speed", model->velocity[4], 0.3, 0);
    assert_near("the scene's speed", model->velocity[6], 1, 0);
    assert_near("a pin has none", model->velocity[0], 0, 0);
    assert_true(model->terms & CK_TERM_DAMPING && !(model->terms & CK_TERM_RIGID));
    fixture_free(&fixture);
    try_scene(path);
    unlink(path);
    free(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_every_scene), cmocka_unit_test(test_network)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
