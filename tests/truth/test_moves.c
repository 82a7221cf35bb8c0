// Pins that move: the path itself, and every engine against the reference as its step shrinks.
#include "fixture_truth.h"

#include "path.h"
#include "path_file.h"
#include "runge_kutta.h"
#include "vector.h"

#include <unistd.h>

#define ROPE                                                                                                           \
    "name: p\nrope: {particles: 6, spacing: 0.2, mass: 0.6}\nsprings: {stiffness: 300, damping: 0.5}\npins: [first]\n" \
    "gravity: [0, -9.81, 0]\ntime: {duration: 0.5, fps: 40}\n"

static const char pulled[] = ROPE "moves: [{pins: [first], path: {velocity: [5, 0, 0], to: 0.2}}]\n";
static const char shaken[] = ROPE "moves: [{pins: [first], path: {amplitude: [0.1, 0, 0.05], frequency: 3}}]\n";
static const char thrown[] = ROPE "moves: [{pins: [first], path: {velocity: [3, 2, 0], to: 0.2}}]\n"
                                  "release: [{at: 0.2, pins: [first]}]\n";
static const char traced[] = ROPE "moves: [{pins: [first], path: {points: [[0, 1, 1, 1], [0.1, 1.2, 1, 1], "
                                  "[0.15, 1.3, 1.1, 1], [0.3, 1.2, 1.1, 0.9], [0.4, 1, 1, 1]]}}]\n";

// Frames in two uneven steps each, up to four times as long as each other.
static const char uneven[] = "name: u\nrope: {particles: 6, spacing: 0.2, mass: 0.6}\n"
                             "springs: {stiffness: 300, damping: 0.5}\npins: [first]\ngravity: [3, -9.81, 0]\n"
                             "time: {duration: 0.5, fps: 40, jitter: 0.6, seed: 3}\n";

// The root mean square distance of all particles over the frames, m.
static double off_of(const ck_Model *model, const ck_Engine *engine, uint32_t substeps, const ck_Trajectory *truth) {
    ck_Settings settings = {.substeps = substeps};
    ck_Trajectory path;
    fixture_run(&path, model, engine, &settings, NULL);
    double sum = 0;
    for (int frame = 1; frame <= model->frame_count; frame++)
        for (int i = 0; i < model->particle_count; i++) {
            double off =
                ck_distance(ck_trajectory_position(&path, frame) + 3 * i, ck_trajectory_position(truth, frame) + 3 * i);
            sum += off * off;
        }
    // the pin itself is exactly where it belongs
    for (int frame = 0; frame <= model->frame_count && !engine->is_single && !engine->is_stock; frame++)
        for (int i = 0; i < model->driven_count && model->driven[i].until >= frame * model->step; i++) {
            double at[3];
            ck_driven_at(&model->driven[i], frame * model->step, at);
            assert_near(engine->name, ck_distance(ck_trajectory_position(&path, frame), at), 0, 1e-12);
        }
    ck_trajectory_free(&path);
    return sqrt(sum / model->frame_count / model->particle_count);
}

static void converge(const char *text) {
    Fixture fixture;
    ck_ReferencePath path;
    ck_Error error = {0};
    fixture_load(&fixture, text);
    if (ck_reference_path_create(&path, &fixture.model, &error)) fail_msg("%s", error.message);
    assert_int_equal(path.horizon, fixture.model.frame_count);
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        if (!engine->order || engine->is_stock || !fixture_supports(engine, &fixture.model) ||
            !strcmp(engine->name, "native-narrow"))
            continue;
        const double coarse = off_of(&fixture.model, engine, 128, &path.fine),
                     fine = off_of(&fixture.model, engine, 256, &path.fine);
        print_message("%-16s %.2e m off, order %.2f\n", engine->name, fine, log2(coarse / fine));
        // what is left of the next order is some hundredths here; a bar of a second order may be below what is seen
        assert_near(engine->name, log2(coarse / fine), engine->order, 0.1);
    }
    ck_reference_path_free(&path);
    fixture_free(&fixture);
}

static void test_pulled(void **state) {
    (void)state;
    converge(pulled);
}
static void test_shaken(void **state) {
    (void)state;
    converge(shaken);
}
static void test_thrown(void **state) {
    (void)state;
    converge(thrown);
}
static void test_traced(void **state) {
    (void)state;
    converge(traced);
}

static void test_uneven(void **state) {
    (void)state;
    converge(uneven);
    // the two steps are the frame, and differ from one frame to the next
    Fixture fixture;
    double parts[2], other[2];
    fixture_load(&fixture, uneven);
    ck_model_parts(&fixture.model, 0, parts);
    ck_model_parts(&fixture.model, 1, other);
    assert_near("a frame", parts[0] + parts[1], 0.025, 1e-17);
    assert_true(fabs(parts[0] - 0.0125) <= 0.6 * 0.0125 && parts[0] != other[0]);
    fixture_free(&fixture);
}

// A path of points goes through them, is smooth there, and at rest before and after.
static void test_path(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, traced);
    const ck_Path *path = &fixture.model.paths[0];
    double at[3], before[3], after[3], none[3], next = 0;
    for (int i = 0; i < path->point_count; i++) {
        const double *point = path->points[i], moved[3] = {point[1] - 1, point[2] - 1, point[3] - 1};
        ck_path_at(path, point[0], -1, at, before, none);
        assert_near("at a point", ck_distance(at, moved), 0, 1e-15);
        ck_path_at(path, point[0], 1, at, after, none);
        assert_near("at a point", ck_distance(at, moved), 0, 1e-15);
        assert_near("jump of speed", ck_distance(before, after), 0, 1e-13);
        if (i) assert_near("next jump", next, point[0], 1e-15);
        next = ck_path_next_jump(path, point[0]);
    }
    assert_true(isinf(next));
    // the speed is the rate of the place
    for (double time = 0.013; time < 0.4; time += 0.02) {
        double one[3], other[3], speed[3];
        ck_path_at(path, time - 1e-6, 1, one, none, none);
        ck_path_at(path, time + 1e-6, 1, other, none, none);
        ck_path_at(path, time, 1, at, speed, none);
        ck_subtract(other, other, one);
        ck_add_scaled(other, -2e-6, speed);
        assert_near("speed", ck_length(other) / 2e-6, 0, 1e-6);
    }
    fixture_free(&fixture);
}

static void test_file(void **state) {
    (void)state;
    static const struct {
        const char *text, *says; // NULL: it is fine
    } cases[] = {
        {"time_s,x,y,z\n0,1,2,3\n0.5,2,3,4\n", NULL},
        {"frame,z,time_s,y,x\n1,3,0,2,1\r\n2,4,0.5,3,2\r\n", NULL},
        {"\xef\xbb\xbftime_s,x,y,z\n0,1,2,3\n0.5,2,3,4\n", NULL}, // as spreadsheets write it
        {"", "has 0 points"},
        {"time_s,x,y\n0,1,2\n", "must name columns"},
        {"time_s,x,y,z\n0,1,2\n0.5,2,3,4\n", ":2: a value is missing"},
        {"time_s,x,y,z\n0,1,2,nan\n0.5,2,3,4\n", "must be a number"},
        {"time_s,x,y,z\n0,1,2,3\n", "has 1 points"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char *file = fixture_file(cases[i].text);
        double(*points)[4];
        int count;
        ck_Error error = {0};
        ck_Status status = ck_path_file_read(&points, &count, file, &error);
        if (cases[i].says && (!status || !strstr(error.message, cases[i].says)))
            fail_msg("'%s' wanted, '%s' said", cases[i].says, error.message);
        if (!cases[i].says) {
            assert_int_equal(status, CK_OK);
            assert_int_equal(count, 2);
            assert_true(points[1][0] == 0.5 && points[0][3] == 3 && points[1][1] == 2);
        }
        free(points);
        unlink(file);
        free(file);
    }
}

// A path that is faster than the body: steps follow it, whatever the body would allow.
static void test_fast(void **state) {
    (void)state;
    static const char *const paths[] = {"amplitude: [0.05, 0, 0], frequency: 40",
                                        "points: [[0, 0, 0, 0], [0.00625, 0.05, 0, 0], [0.0125, 0, 0, 0], "
                                        "[0.01875, -0.05, 0, 0], [0.025, 0, 0, 0]]"};
    for (int i = 0; i < 2; i++) {
        char text[500];
        Fixture fixture;
        ck_Settings used, wanted = {0};
        snprintf(text, sizeof text, ROPE "moves: [{pins: [first], path: {%s}}]\n", paths[i]);
        fixture_load(&fixture, text);
        for (int e = 0; e < ck_engine_count(); e++) {
            const ck_Engine *engine = ck_engine_at(e);
            if (!engine->order || engine->is_stock || !fixture_supports(engine, &fixture.model) ||
                !strcmp(engine->name, "native-narrow"))
                continue;
            void *engine_state;
            assert_int_equal(ck_engine_create(engine, &engine_state, &fixture.model, &wanted, &used, NULL, NULL),
                             CK_OK);
            engine->destroy(engine_state);
            // twenty steps a period of one frame; points that go as far turn as fast
            if (!(used.substeps >= (i ? 15 : 20))) fail_msg("%s takes %u substeps", engine->name, used.substeps);
        }
        fixture_free(&fixture);
    }
}

static void test_refused(void **state) {
    (void)state;
    static const struct {
        const char *text, *says;
    } cases[] = {
        {ROPE "moves: [{pins: [last], path: {velocity: [1, 0, 0]}}]\n", "last is not pinned"},
        {ROPE "moves: [{pins: [first, '0'], path: {velocity: [1, 0, 0]}}]\n", "already moves"},
        {ROPE "moves: [{pins: [first], path: {}}]\n", "this has none"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0], file: a.csv}}]\n", "this has more"},
        {ROPE "moves: [{pins: [first], path: {amplitude: [1, 0, 0]}}]\n", "go together"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0], frequency: 2}}]\n", "go together"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0], from: 0.2, to: 0.1}}]\n", "end after it begins"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0], from: 2}}]\n", "the scene ends at 0.5 s"},
        {ROPE "moves: [{pins: [first], path: {points: [[0.5, 0, 0, 0], [1, 1, 0, 0]]}}]\n", "the scene ends at 0.5 s"},
        {ROPE "moves: [{pins: [first], path: {amplitude: [1, 0, 0], frequency: 1.0e+6}}]\n", "25000 periods a frame"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0], from: 0.3}}]\nrelease: [{at: 0.2, pins: "
              "[first]}]\n",
         "before its path begins"},
        {ROPE "moves: [{pins: [first], path: {velocity: [0, 0, 4], to: 0.2}}]\nrelease: [{at: 0.2, pins: [first]}]\n"
              "colliders: [{sphere: {center: [0, 0, 1], radius: 0.3}}]\n",
         "0.1 m inside this collider when it is let go, at 0.2 s"},
        {ROPE "release: [{at: 0.2, pins: [first]}]\ncolliders: [{sphere: {center: [0, 0, 2], radius: 0.3}, path: "
              "{velocity: [0, 0, -9], from: 0}}]\n",
         "0.1 m inside this collider when it is let go, at 0.2 s"},
        {ROPE "moves: [{pins: [first], path: {points: [[0, 0, 0, 0], [0, 1, 0, 0]]}}]\n", "no later than"},
        {ROPE "moves: [{pins: [first], path: {points: [[-1, 0, 0, 0], [0, 1, 0, 0]]}}]\n", "begin at 0 or later"},
        {ROPE "moves: [{pins: [first], path: {points: [[0, 0, 0, 0], [1, 1, 0, 0]], to: 1}}]\n", "leave from and to"},
        {ROPE "moves: [{pins: [first], path: {file: nowhere.csv}}]\n", "nowhere.csv"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0]}}]\ntruth: rest\n", "nothing comes to rest"},
        {ROPE "moves: [{pins: [first], path: {velocity: [1, 0, 0]}}]\ntruth: vertical_chain\n", "no moving pins"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        TruthFixture fixture;
        ck_Error error = {0};
        char *file = fixture_file(cases[i].text);
        if (!fixture_open_truth(&fixture, file, &error) || !strstr(error.message, cases[i].says))
            fail_msg("'%s' wanted, '%s' said", cases[i].says, error.message);
        unlink(file);
        free(file);
        fixture_free_truth(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pulled), cmocka_unit_test(test_shaken), cmocka_unit_test(test_thrown),
        cmocka_unit_test(test_traced), cmocka_unit_test(test_uneven), cmocka_unit_test(test_path),
        cmocka_unit_test(test_file),   cmocka_unit_test(test_fast),   cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
