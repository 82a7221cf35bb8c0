// A scene with some of its values changed in the word that names it.
#include "fixture.h"

#include "change.h"

#include <unistd.h>

// é stands before what is changed: places are told in characters, and texts have bytes.
#define CLOTH                                                                                                          \
    "# a comment é\n"                                                                                                 \
    "name: sheet\n"                                                                                                    \
    "cloth: {rows: 5, columns: 5, spacing: 0.1, mass: 0.1}\n"                                                          \
    "springs:\n"                                                                                                       \
    "  stiffness: 100 # N/m\n"                                                                                         \
    "  shear: 50\n"                                                                                                    \
    "pins: [top_left]\n"                                                                                               \
    "gravity: [0, -9.81, 0]\n"                                                                                         \
    "colliders:\n"                                                                                                     \
    "  - sphere: {center: [0, -9, 0], radius: 0.5}\n"                                                                  \
    "time: {duration: 1, fps: 60}\n"

static ck_Status load(ck_Scene *scene, const char *text, const char *changes, ck_Error *error) {
    char *path = fixture_file(text), word[500];
    snprintf(word, sizeof word, "%s%s", path, changes);
    ck_Status status = ck_scene_load(scene, word, error);
    unlink(path);
    free(path);
    return status;
}

static void test_values(void **state) {
    (void)state;
    ck_Scene scene;
    ck_Error error = {0};
    if (load(&scene, CLOTH,
             "@springs.stiffness=250@gravity=[0, 0, -1]@gravity[2]=-3@colliders[0].sphere.radius=0.25@springs.damping="
             "0.5@noise.amplitude=1e-3@noise.seed=7@drag=2@cloth.pattern=cross@settings.native-verlet.substeps=8",
             &error))
        fail_msg("%s", error.message);
    const ck_SceneFile *file = scene.file;
    assert_near("stiffness", file->springs->stiffness, 250, 0);
    assert_near("damping, which was not there", file->springs->damping, 0.5, 0);
    assert_near("shear, which stays", file->springs->shear, 50, 0);
    assert_near("gravity, as a whole", file->gravity[1], 0, 0);
    assert_near("gravity, one of three", file->gravity[2], -3, 0);
    assert_near("radius", file->colliders[0].sphere->radius, 0.25, 0);
    assert_near("noise, whose mapping was not there", file->noise->amplitude, 1e-3, 0);
    assert_int_equal(file->noise->seed, 7);
    assert_near("drag", file->drag, 2, 0);
    assert_string_equal(file->cloth->pattern, "cross");
    assert_int_equal(scene.setting_count, 1);
    assert_string_equal(scene.settings[0].engine, "native-verlet");
    assert_near("substeps", scene.settings[0].value, 8, 0);
    assert_true(!strncmp(file->name, "sheet-stiffness_250-gravity_0_0_-1-", 35));
    ck_scene_free(&scene);
}

// Lines that end in other ways, and a mark of byte order.
static void test_breaks(void **state) {
    (void)state;
    static const char *const breaks[] = {"\n", "\r\n", "\r", "\xc2\x85", "\xe2\x80\xa8"};
    for (size_t i = 0; i < sizeof breaks / sizeof *breaks; i++) {
        char text[400];
        ck_Scene scene;
        ck_Error error = {0};
        const char *b = breaks[i];
        snprintf(text, sizeof text,
                 "\xef\xbb\xbf# \xc3\xa9%sname: r%srope: {particles: 5, spacing: 0.1, mass: 1}%sdrag: 3%s"
                 "time: {duration: 1, fps: 60}%s",
                 b, b, b, b, b);
        if (load(&scene, text, "@drag=12.5@rope.mass=2", &error)) fail_msg("%s", error.message);
        assert_near("drag", scene.file->drag, 12.5, 0);
        assert_near("mass", scene.file->rope->mass, 2, 0);
        ck_scene_free(&scene);
    }
}

// A key takes the place of the one that says the same otherwise, wherever that stands.
static void test_instead(void **state) {
    (void)state;
    static const struct {
        const char *time, *changes;
        double step;
    } cases[] = {{"{duration: 1, fps: 60}", "@time.step=0.005", 0.005},
                 {"{fps: 60, duration: 1}", "@time.step=0.005@time.fps=50", 0.02},
                 {"{duration: 1, step: 0.01}", "@time.fps=25", 0.04},
                 {"\n  step: 0.01 # s\n  duration: 1", "@time.fps=25", 0.04},
                 {"\n  duration: 1\n  step: 0.01", "@time.fps=25@time.duration=2", 0.04}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Scene scene;
        ck_Error error = {0};
        char text[400];
        snprintf(text, sizeof text, "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\ntime: %s\ndrag: 1\n",
                 cases[i].time);
        if (load(&scene, text, cases[i].changes, &error)) fail_msg("%s%s: %s", text, cases[i].changes, error.message);
        assert_near(cases[i].changes, scene.file->time.step, cases[i].step, 1e-15);
        assert_near("drag", scene.file->drag, 1, 0);
        ck_scene_free(&scene);
    }
}

// Values on lines of their own are replaced with these lines, and a key without a value gets one.
static void test_blocks(void **state) {
    (void)state;
    static const char text[] =
        "name: b\nrope:\n  particles: 5\n  spacing: 0.1\n  mass: 1\npins:\n- first\n- last\n"
        "colliders: # none of these\n  - plane:\n      point: [0, -1, 0]\n      normal: [0, 1, 0]\n"
        "\n  - sphere: {center: [0, -9, 0], radius: 0.5}\n# a comment\n"
        "time:\n  duration: 1\n  fps: 60\ndrag:\n";
    ck_Scene scene;
    ck_Error error = {0};
    if (load(&scene, text,
             "@pins=[last]@drag=3@colliders[0]={sphere: {center: [1, 2, 3], radius: 4}}@rope={particles: "
             "9, spacing: 1, mass: 2}",
             &error))
        fail_msg("%s", error.message);
    assert_int_equal(scene.file->pins_count, 1);
    assert_string_equal(scene.file->pins[0], "last");
    assert_near("drag", scene.file->drag, 3, 0);
    assert_int_equal(scene.file->colliders_count, 2);
    assert_near("radius", scene.file->colliders[0].sphere->radius, 4, 0);
    assert_int_equal(scene.file->rope->particles, 9);
    ck_scene_free(&scene);
    if (load(&scene, text, "@drag=1@colliders=[]", &error)) fail_msg("%s", error.message);
    assert_int_equal(scene.file->colliders_count, 0);
    assert_near("what stands behind it", scene.file->time.duration, 1, 0);
    ck_scene_free(&scene);
}

static void test_names(void **state) {
    (void)state;
    static const struct {
        const char *changes, *name;
    } cases[] = {{"", "sheet"},
                 {"@drag=2@springs.stiffness=1e+02", "sheet-drag_2-stiffness_1e02"},
                 {"@drag=2@name=other", "other"},
                 {"@drag=2@name=other@force=[0, 0, 1]@cloth.mass=2", "other-force_0_0_1-mass_2"},
                 // a value may have an @ of its own
                 {"@about=a@b@drag=1", "sheet-about_ab-drag_1"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Scene scene;
        ck_Error error = {0};
        if (load(&scene, CLOTH, cases[i].changes, &error)) fail_msg("%s", error.message);
        assert_string_equal(scene.file->name, cases[i].name);
        ck_scene_free(&scene);
    }
}

static void test_errors(void **state) {
    (void)state;
    static const struct {
        const char *changes, *message;
    } cases[] = {{"@springs.stiffness=-1", ":5:14: springs.stiffness is -1; it must be 0 or a number above it"},
                 {"@spring.stiffness=1", "unknown key spring; did you mean springs?"},
                 {"@springs.stiffnes=1", "unknown key stiffnes in springs; did you mean stiffness?"},
                 {"@drag=", "drag has no value; it must read @KEY=VALUE"},
                 {"@colliders[1].sphere.radius=1", "there is no place for colliders[1].sphere.radius here"},
                 {"@springs.stiffness.more=1", "there is no place for springs.stiffness.more here"},
                 {"@springs.stiffness=[", "is not YAML"},
                 {"@springs.stiffness=*a", "an alias is not supported"},
                 {"@resolution=0.3", "resolution is 0.3, which it cannot have: no grid of whole cells has its size"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Scene scene;
        ck_Error error = {0};
        assert_int_equal(load(&scene, CLOTH, cases[i].changes, &error), CK_BAD_INPUT);
        if (!strstr(error.message, cases[i].message))
            fail_msg("%s: wanted %s, got %s", cases[i].changes, cases[i].message, error.message);
        ck_scene_free(&scene);
    }
}

// At twice the resolution a sheet is the same sheet.
static void test_resolution(void **state) {
    (void)state;
    ck_Scene scene;
    ck_Error error = {0};
    if (load(&scene, CLOTH, "@resolution=2@force=[1, 0, 0]", &error)) fail_msg("%s", error.message);
    assert_int_equal(scene.file->cloth->rows, 9);
    assert_near("spacing", scene.file->cloth->spacing, 0.05, 1e-15);
    assert_near("stiffness of a sheet", scene.file->springs->stiffness, 100, 0);
    assert_near("force in all", scene.file->force[0] * 81, 25, 1e-12);
    ck_scene_free(&scene);
    if (load(&scene,
             "name: r\nrope: {particles: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\n"
             "time: {duration: 1, fps: 60}\n",
             "@resolution=2", &error))
        fail_msg("%s", error.message);
    assert_int_equal(scene.file->rope->particles, 9);
    assert_near("stiffness of a rope's springs", scene.file->springs->stiffness, 200, 0);
    ck_scene_free(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_values),    cmocka_unit_test(test_breaks),
                                       cmocka_unit_test(test_instead),   cmocka_unit_test(test_blocks),
                                       cmocka_unit_test(test_names),     cmocka_unit_test(test_errors),
                                       cmocka_unit_test(test_resolution)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
