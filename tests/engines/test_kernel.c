// The kernels of springs, in rows and as lists, against the plain loops that they stand for; and what all kernels
// share.
#include "fixture_loops.h"

#include "choice.h"
#include "explicit.h"
#include "lanes.h"
#include "springs.h"
#include "statistics.h"
#include "vector.h"

#include <float.h>

// The substep as its formula reads, with the reference integrator's forces.
static void plain_step(const ck_Model *model, double dt, double *x, double *v, double *predicted, double *a) {
    int count = 3 * model->particle_count;
    for (int i = 0; i < count; i++) {
        x[i] += dt * v[i] + 0.5 * dt * dt * a[i];
        predicted[i] = v[i] + dt * a[i];
        v[i] += 0.5 * dt * a[i];
    }
    ck_springs_accelerate(model, x, predicted, a);
    for (int i = 0; i < count; i++) v[i] += 0.5 * dt * a[i];
}

// A root good to 4e-14 of forces of up to 10 N on 6 g and more: over the 0.1 s of 100 substeps 3e-13 m and what that
// grows by; sums in another order, fused or not, are less.
static void compare_explicit(const char *text, const ck_Model *model, bool is_list) {
    size_t count = 3 * (size_t)model->particle_count;
    double *state = calloc(4 * count, sizeof *state), *weight = malloc(count * sizeof *weight), dt = 1e-3;
    double *x = state, *v = state + count, *a = state + 2 * count, *predicted = state + 3 * count;
    memcpy(x, model->position, count * sizeof *x);
    memcpy(v, model->velocity, count * sizeof *v);
    ck_springs_accelerate(model, x, v, a);
    for (int i = 0; i < model->particle_count; i++) weight[i] = ck_model_inverse_mass(model, i);
    double *results[MOST_LOOPS];
    for (int kind = 0; ck_loops_at(kind); kind++) {
        ck_Explicit *cloth;
        results[kind] = calloc(2 * count, sizeof *x);
        const ck_ExplicitSetup setup = {ck_loops_at(kind), model, dt, x, v, weight};
        assert_int_equal(
            is_list ? ck_explicit_create_list(&cloth, &setup, NULL) : ck_explicit_create(&cloth, &setup, NULL), CK_OK);
        // in two calls, as two frames are
        ck_explicit_step(cloth, 60, NULL);
        ck_explicit_step(cloth, 40, NULL);
        ck_explicit_read(cloth, results[kind], results[kind] + count);
        ck_explicit_destroy(cloth);
    }
    for (int i = 0; i < 100; i++) plain_step(model, dt, x, v, predicted, a);
    fixture_compare_loops(text, results, state, 2 * count);
    double moved = 0;
    for (size_t i = 0; i < count; i++) moved = fmax(moved, fabs(x[i] - model->position[i]));
    assert_true(moved > 1e-2);
    free(state);
    free(weight);
}

static void compare_cloth(const char *size, const char *springs, const char *terms) {
    char text[600];
    snprintf(text, sizeof text,
             "name: kernel\ncloth: {%s, spacing: 0.1, mass: 1, down: [0, 0, 1]}\nsprings: {%s}\n%s"
             "pins: [top_left, 0:2]\nnoise: {amplitude: 0.01, seed: 5}\nvelocity: [0.3, -0.5, 0.2]\nforce: [0, 0.01, "
             "0]\ngravity: [0, -9.81, 1]\ntime: {duration: 1, step: 0.01}\n",
             size, springs, terms);
    Fixture fixture;
    ck_RowSprings row_springs;
    fixture_load(&fixture, text);
    assert_true(ck_rows_fit(&fixture.model, &row_springs));
    compare_explicit(text, &fixture.model, false);
    compare_explicit(text, &fixture.model, true);
    fixture_free(&fixture);
}

// Every set of terms, on rows shorter and longer than a vector and a cloth of few rows; in rows and as a list.
static void test_explicit(void **state) {
    (void)state;
    static const char *const sizes[] = {"rows: 2, columns: 3", "rows: 5, columns: 8", "rows: 6, columns: 16",
                                        "rows: 9, columns: 19"};
    static const char *const springs[] = {
        "stiffness: 100", "stiffness: 100, shear: 50", "stiffness: 100, shear: 50, damping: 0.05",
        "stiffness: 100, shear: 50, bend: 20", "stiffness: 100, bend: 20, damping: 0.05"};
    for (size_t size = 0; size < sizeof sizes / sizeof *sizes; size++)
        for (size_t i = 0; i < sizeof springs / sizeof *springs; i++) {
            compare_cloth(sizes[size], springs[i], "");
            compare_cloth(sizes[size], springs[i], "drag: 2\n");
        }
}

// What rows are not for: springs that each have values of their own, join any two particles, or hang slack.
static void scramble(ck_Model *model, uint64_t seed) {
    ck_Random random = ck_random_seed(seed);
    for (int i = 0; i < model->spring_count; i++) {
        ck_Spring *spring = &model->springs[i];
        spring->a = (int)(ck_random_unit(&random) * model->particle_count);
        spring->b = (int)(ck_random_unit(&random) * model->particle_count);
        if (spring->b == spring->a) spring->b = (spring->a + 1) % model->particle_count;
        spring->stiffness *= 0.5 + 0.5 * ck_random_unit(&random);
        spring->damping *= ck_random_unit(&random);
        spring->rest = 0.3 * ck_random_unit(&random);
        spring->pulls_only = seed % 2 && ck_random_unit(&random) < 0.5;
    }
    for (int i = 0; i < model->particle_count; i++) model->mass[i] *= 1 + ck_random_unit(&random);
    if (seed % 2) model->terms |= CK_TERM_PULL_ONLY;
}

// Networks at random, in parts, with lone particles, with one that all are joined to, and with one spring in all.
static void test_list(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed < 41; seed++) {
        char text[500];
        Fixture fixture;
        snprintf(text, sizeof text,
                 "name: list\ncloth: {rows: %d, columns: 9, spacing: 0.1, mass: 5}\nsprings: {stiffness: 40, damping: "
                 "0.05}\npins: [top_left, 0:2]\ndrag: %d\nnoise: {amplitude: 0.02, seed: 5}\nvelocity: [0.3, -0.5, "
                 "0.2]\ngravity: [0, -9.81, 1]\ntime: {duration: 1, step: 0.01}\n",
                 seed % 4 ? 30 : 3, (int)(seed % 3));
        fixture_load(&fixture, text);
        ck_Model *model = &fixture.model;
        const int springs = model->spring_count;
        scramble(model, seed);
        if (seed % 5 == 0) model->spring_count = 1;
        if (seed % 5 == 1) model->spring_count /= 4;
        for (int i = 0; i < 40 && seed % 5 == 2; i++) {
            model->springs[i].a = 7;
            model->springs[i].b = 8 + i % (model->particle_count - 8);
            model->springs[i].stiffness = 1;
        }
        compare_explicit(text, model, true);
        model->spring_count = springs;
        fixture_free(&fixture);
    }
}

// The largest difference of two paths' last positions, m.
static double last_apart(const ck_Trajectory *one, const ck_Trajectory *other) {
    const int last = one->frame_count - 1;
    double off = 0;
    for (int k = 0; k < 3 * one->particle_count; k++)
        off = fmax(off, fabs(ck_trajectory_position(one, last)[k] - ck_trajectory_position(other, last)[k]));
    return off;
}

// Particle by particle, as where there is wind: this is air without density. From a start all of whose coordinates are
// off at random by as much as this, m.
static void run_alone(ck_Trajectory *path, ck_Model *model, double off, uint64_t seed) {
    const size_t count = 3 * (size_t)model->particle_count;
    double *start = memcpy(malloc(count * sizeof *start), model->position, count * sizeof *start);
    int face[1][3] = {{0, 1, 2}};
    const ck_Wind wind = model->wind;
    ck_Random random = ck_random_seed(seed);
    model->wind = (ck_Wind){.faces = face, .face_count = 1};
    for (size_t i = 0; i < count; i++) model->position[i] += off * (2 * ck_random_unit(&random) - 1);
    fixture_run(path, model, ck_engine_find("native-verlet"), &(ck_Settings){.substeps = 16}, NULL);
    memcpy(model->position, start, count * sizeof *start);
    free(start);
    model->wind = wind;
}

// In rows, or as a list: where one spring is damped otherwise.
static void run_whole(ck_Trajectory *path, ck_Model *model, int lanes, bool is_list) {
    const double damping = model->springs[7].damping;
    const ck_Settings settings = {.substeps = 16, .own = {lanes}, .own_set = 1};
    if (is_list) model->springs[7].damping = damping * (1 + 1e-15);
    fixture_run(path, model, ck_engine_find("native-verlet"), &settings, NULL);
    model->springs[7].damping = damping;
}

// Contact in rows and lists, all particles in vectors and those near a collider one by one, against all one by one: off
// by what nudges of the start do, of as much as a root good to 4e-14 of forces of 1 N on 2 g makes in 0.2 s, 4e-13 m.
// On the rounded box one nudge in thirty sends a particle another way at an edge, ten times as far: hence so many.
static void test_contact(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const colliders[] = {
        "{sphere: {center: [0.4, -0.35, 0.3], radius: 0.3, friction: 0.5}}",
        "{plane: {point: [0, -0.05, 0], normal: [0.2, 1, 0], friction: 0.3, restitution: 0.5}}",
        "{capsule: {from: [0.2, -0.25, 0.3], to: [0.6, -0.3, 0.3], radius: 0.2, friction: 1}}",
        "{cylinder: {point: [0.4, -0.35, 0.3], axis: [1, 0, 0.3], radius: 0.3}}",
        "{box: {center: [0.4, -0.3, 0.3], size: [0.5, 0.4, 0.5], along: [1, 0.2, 0], rounding: 0.05, friction: 0.5}}",
        "{sphere: {center: [0.4, -0.45, 0.3], radius: 0.3, friction: 0.5}, path: {velocity: [0, 1, 0], to: 0.153}}",
        "{box: {center: [0.4, -0.4, 0.3], size: [0.5, 0.4, 0.5]}, path: {amplitude: [0, 0.15, 0], frequency: 2}}"};
    for (size_t i = 0; i < sizeof colliders / sizeof *colliders; i++) {
        char text[800];
        Fixture fixture;
        snprintf(text, sizeof text,
                 "name: drape\ncloth: {rows: 9, columns: 11, spacing: 0.08, mass: 0.2, down: [0, 0.02, 1]}\nsprings: "
                 "{stiffness: 200, shear: 80, damping: 0.02}\npins: [top_left]\ndrag: 0.5\ngravity: [0, -9.81, 0]\n"
                 "time: {duration: 0.2, fps: 60}\ncolliders: [%s]\n",
                 colliders[i]);
        fixture_load(&fixture, text);
        const size_t count = 3 * (size_t)fixture.model.particle_count;
        ck_Trajectory alone, nudged;
        double sensitivity = 0;
        run_alone(&alone, &fixture.model, 0, 1);
        for (uint64_t seed = 1; seed <= 200; seed++) {
            run_alone(&nudged, &fixture.model, 4e-13, seed);
            sensitivity = fmax(sensitivity, last_apart(&alone, &nudged));
            ck_trajectory_free(&nudged);
        }
        for (int is_list = 0; is_list < 2; is_list++) {
            double *first = NULL;
            for (int kind = 0; ck_loops_at(kind); kind++) {
                ck_Trajectory whole;
                run_whole(&whole, &fixture.model, ck_loops_at(kind)->lanes, is_list);
                const double *end = ck_trajectory_position(&whole, fixture.model.frame_count);
                const double off = last_apart(&whole, &alone);
                print_message("%s %s: %d doubles, %.1e m off, %.1e by a nudge\n", is_list ? "list" : "rows",
                              colliders[i], ck_loops_at(kind)->lanes, off, sensitivity);
                assert_near(colliders[i], off, 0, 1e-12 + 2 * sensitivity);
                if (first && ck_loops_at(kind)->fuses) assert_memory_equal(first, end, count * sizeof *first);
                if (!first) first = memcpy(malloc(count * sizeof *first), end, count * sizeof *first);
                ck_trajectory_free(&whole);
            }
            free(first);
        }
        ck_trajectory_free(&alone);
        fixture_free(&fixture);
    }
}

// What lies still beside what slides, in one vector or in another: the same bits in all of the paths.
static void test_resting(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const scenes[] = {
        "cloth: {rows: 19, columns: 21, spacing: 0.02, mass: 0.399, down: [0, 0, 1]}\nsprings: {stiffness: 200, "
        "damping: 0.05, bend: 40}\ndrag: 0.5\nnoise: {amplitude: 2.0e-5, seed: 163}\nvelocity: [0, -1, 0]\n"
        "colliders: [{sphere: {center: [0.21, -0.105, 0.22], radius: 0.1, friction: 1.9, restitution: 0.2}}]\n",
        "cloth: {rows: 16, columns: 12, spacing: 0.05, mass: 0.2, down: [0, 0, 1]}\nsprings: {stiffness: 200, shear: "
        "60, damping: 0.02}\nnoise: {amplitude: 5.0e-5, seed: 2}\ncolliders: [{sphere: {center: [0.25, -0.25, 0.35], "
        "radius: 0.2, friction: 1.5}}, {plane: {point: [0, -0.3, 0], normal: [0, 1, 0], friction: 0.4}}]\n"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        char text[800];
        Fixture fixture;
        ck_Trajectory first = {0};
        snprintf(text, sizeof text, "name: rest\n%sgravity: [0, -9.81, 0]\ntime: {duration: 0.8, fps: 60}\n",
                 scenes[i]);
        fixture_load(&fixture, text);
        for (int kind = 0; ck_loops_at(kind) && ck_loops_at(kind)->fuses; kind++) {
            ck_Trajectory path;
            run_whole(&path, &fixture.model, ck_loops_at(kind)->lanes, false);
            for (int frame = 0; kind && frame <= fixture.model.frame_count; frame++)
                assert_memory_equal(ck_trajectory_position(&first, frame), ck_trajectory_position(&path, frame),
                                    3 * sizeof(double) * (size_t)fixture.model.particle_count);
            if (kind) ck_trajectory_free(&path);
            if (!kind) first = path;
        }
        ck_trajectory_free(&first);
        fixture_free(&fixture);
    }
}

// A body with a collider goes the same way however its substeps are parted into frames: what was near and is no longer
// is let go within a frame, and between two all is taken anew; it flies as the others do.
static void compare_parted(ck_Model *model, bool is_list) {
    const double step = model->step, damping = model->springs[7].damping;
    const size_t bytes = 3 * sizeof(double) * (size_t)model->particle_count;
    const ck_Engine *engine = ck_engine_find("native-verlet");
    double *ends[3];
    if (is_list) model->springs[7].damping = damping * (1 + 1e-15);
    for (int parts = 0; parts < 3; parts++) {
        const uint32_t substeps = 64u >> 3 * parts;
        const ck_Settings wanted = {.substeps = substeps};
        ck_Settings used;
        void *state;
        ends[parts] = malloc(2 * bytes);
        model->step = step * substeps / 64;
        assert_int_equal(ck_engine_create(engine, &state, model, &wanted, &used, NULL, NULL), CK_OK);
        for (uint32_t done = 0; done < 20 * 64; done += substeps) assert_int_equal(engine->step(state), CK_STEP_OK);
        engine->read(state, ends[parts], ends[parts] + bytes / sizeof(double));
        engine->destroy(state);
    }
    for (int parts = 1; parts < 3; parts++) assert_memory_equal(ends[0], ends[parts], 2 * bytes);
    for (int parts = 0; parts < 3; parts++) free(ends[parts]);
    model->step = step;
    model->springs[7].damping = damping;
}

static void test_parted(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const colliders[] = {
        "cylinder: {point: [0, -0.133, -0.28], axis: [0.388, 0.02, 1], radius: 0.063, restitution: 1, friction: 0.3}",
        "sphere: {center: [0, -0.2, 0], radius: 0.15, friction: 0.4, restitution: 0.2}",
        "box: {center: [0, -0.25, -0.1], size: [0.3, 0.2, 0.3], rounding: 0.02, friction: 0.5}"};
    for (size_t i = 0; i < 4 * sizeof colliders / sizeof *colliders; i++) {
        char text[800];
        Fixture fixture;
        snprintf(text, sizeof text,
                 "name: parted\ncloth: {rows: 25, columns: 16, spacing: 0.032, mass: 0.2, origin: [-0.24, 0, -0.384], "
                 "down: [0, 0.3, 1]}\nsprings: {stiffness: 200, damping: 0.01, shear: 100}\nvelocity: [1.73, -1, "
                 "-1.72]\ndrag: %g\ngravity: [0, -30, 0]\ncolliders:\n  - %s\ntime: {duration: 1, step: "
                 "0.03125}\n",
                 i % 4 / 2 ? 0.5 : 0, colliders[i / 4]);
        fixture_load(&fixture, text);
        compare_parted(&fixture.model, i % 2);
        fixture_free(&fixture);
    }
}

// A whole run of an engine, in positions: the same bits with any number of threads.
static void compare_threads(const ck_Model *model, const ck_Engine *engine, uint32_t substeps, uint32_t threads) {
    size_t bytes = 3 * sizeof(double) * (size_t)model->particle_count;
    double *one = malloc(2 * bytes), *many = malloc(2 * bytes);
    for (int run = 0; run < 2; run++) {
        ck_Settings used, wanted = {.substeps = substeps, .iterations = 3, .threads = run ? threads : 1};
        double *x = run ? many : one;
        void *state;
        assert_int_equal(ck_engine_create(engine, &state, model, &wanted, &used, NULL, NULL), CK_OK);
        for (int frame = 0; frame < 4; frame++) assert_int_equal(engine->step(state), CK_STEP_OK);
        engine->read(state, x, x + bytes / sizeof *x);
        engine->destroy(state);
    }
    if (memcmp(one, many, 2 * bytes)) fail_msg("%s: not the same with %u threads", engine->name, threads);
    free(one);
    free(many);
}

static void check_threads(int rows, int columns, const char *springs, uint32_t substeps, uint32_t most) {
    static const char *const engines[] = {"native-verlet", "native-bars", "native-xpbd"};
    char text[400];
    snprintf(text, sizeof text,
             "name: threads\ncloth: {rows: %d, columns: %d, spacing: 0.05, mass: 1, down: [0, 0, 1]}\nsprings: "
             "{stiffness: 100, %s, damping: 0.01}\npins: [top_left, top_right]\ndrag: 1\ngravity: [0, -9.81, "
             "0]\ntime: {duration: 1, step: 0.01}\n",
             rows, columns, springs);
    Fixture fixture;
    fixture_load(&fixture, text);
    for (size_t engine = 0; engine < sizeof engines / sizeof *engines; engine++)
        for (uint32_t threads = 2; threads <= most; threads++)
            compare_threads(&fixture.model, ck_engine_find(engines[engine]), substeps, threads);
    // as a list
    fixture.model.springs[7].damping *= 2;
    for (uint32_t threads = 2; threads <= most; threads++)
        compare_threads(&fixture.model, ck_engine_find(engines[0]), substeps, threads);
    fixture_free(&fixture);
}

static void test_threads(void **state) {
    (void)state;
    for (int columns = 16; columns < 22; columns += 5) {
        check_threads(60, columns, "shear: 50", 7, 4);
        check_threads(60, columns, "shear: 50, bend: 20", 7, 4);
    }
    check_threads(40, 40, "shear: 50", 7, 2);
    fixture_skip_long();
    // beyond a second cache, several passes run interleaved, and fewer of them with threads
    check_threads(300, 90, "shear: 50", 24, 3);
    check_threads(160, 72, "shear: 50, bend: 20", 24, 2);
}

// Every thread has its part however many passes a block could hold, and what a cache holds is not held back by blocks.
static void test_depth(void **state) {
    (void)state;
    ck_Waves *waves;
    assert_int_equal(ck_waves_depth(NULL, 100, 64, 1, 64 * 96), 1);
    assert_true(ck_waves_depth(NULL, 100, 256, 3, 256 * 48) > 4);
    assert_int_equal(ck_waves_depth(NULL, 3, 256, 3, 256 * 48), 3);
    for (int threads = 2; threads < 9; threads++) {
        assert_int_equal(ck_waves_create(&waves, threads, NULL), CK_OK);
        for (int rows = 150; rows < 1100; rows += 50)
            for (int lag = 1; lag < 4; lag++) {
                const int depth = ck_waves_depth(waves, 1000, rows, lag, (size_t)rows * 96);
                if (depth > 1) assert_true((rows + lag * (depth - 1)) / (3 * lag * depth) >= threads);
            }
        ck_waves_destroy(waves);
    }
}

static void run_quickly(void *state, long block, int wave) {
    (void)state;
    (void)block;
    (void)wave;
}

// A job whose layout is for one thread where it goes alone does not stay alone for that. A trial that lost its
// processor for 20 ms is tried again after jobs of 1 s, which are millions.
static void test_way_back(void **state) {
    (void)state;
    ck_Waves *waves;
    int shared = 0;
    assert_false(ck_waves_are_shared(NULL));
    assert_int_equal(ck_waves_create(&waves, 2, NULL), CK_OK);
    for (int i = 0; i < 1000000000 && shared <= CK_CHOICE_PAUSE; i++) {
        const bool is_shared = ck_waves_are_shared(waves);
        shared += is_shared;
        ck_waves_run(waves, &(ck_WaveWork){run_quickly, NULL, 4, 20, is_shared ? 1 : 20, 4});
    }
    ck_waves_destroy(waves);
    assert_true(shared > CK_CHOICE_PAUSE);
}

// The widest that are there and no wider than asked for; two doubles always are.
static void test_vectors(void **state) {
    (void)state;
    assert_ptr_equal(ck_loops_for(0), ck_loops_at(0));
    for (uint32_t lanes = 1; lanes < 20; lanes++) {
        const ck_Loops *loops = ck_loops_for(lanes);
        assert_true(loops->lanes <= (int)lanes || loops->lanes == 2);
        for (int kind = 0; ck_loops_at(kind); kind++)
            assert_true(ck_loops_at(kind)->lanes <= loops->lanes || ck_loops_at(kind)->lanes > (int)lanes);
    }
}

// A third-order step leaves 2.5·e³ of the 2.5e-5 before it; what else there is is rounding.
static void test_root(void **state) {
    (void)state;
    for (int i = 0; i < 100000; i++) {
        double square = exp(fmod(i * 0.618034, 1) * 400 - 200), root;
        ck_Lanes lanes = ck_lanes_all(square), inverse;
        ck_lanes_inverse_root(&inverse, &lanes, 1);
        root = inverse[0] * sqrt(square);
        assert_near("1/sqrt", root, 1, 4e-14 + 4 * DBL_EPSILON);
    }
    ck_Lanes none = ck_lanes_all(0), inverse;
    ck_lanes_inverse_root(&inverse, &none, 1);
    assert_true(isfinite(inverse[0]));
}

// A cloth that is not regular is none for rows: a spring less, another stiffness, another mass.
static void test_fit(void **state) {
    (void)state;
    Fixture fixture;
    ck_RowSprings springs;
    fixture_load(&fixture, "name: fit\ncloth: {rows: 4, columns: 5, spacing: 0.1, mass: 1}\nsprings: {stiffness: 10, "
                           "shear: 5, bend: 1}\ntime: {duration: 1, step: 0.1}\n");
    ck_Model *model = &fixture.model;
    assert_true(ck_rows_fit(model, &springs));
    assert_near("shear", springs.stiffness[CK_SHEAR], 5, 0);
    model->springs[7].stiffness *= 1.01;
    assert_false(ck_rows_fit(model, &springs));
    model->springs[7].stiffness = model->springs[6].stiffness;
    assert_true(ck_rows_fit(model, &springs));
    model->spring_count--;
    assert_false(ck_rows_fit(model, &springs));
    model->spring_count++;
    model->mass[3] *= 2;
    assert_false(ck_rows_fit(model, &springs));
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_explicit), cmocka_unit_test(test_list),     cmocka_unit_test(test_contact),
        cmocka_unit_test(test_resting),  cmocka_unit_test(test_parted),   cmocka_unit_test(test_threads),
        cmocka_unit_test(test_depth),    cmocka_unit_test(test_way_back), cmocka_unit_test(test_vectors),
        cmocka_unit_test(test_root),     cmocka_unit_test(test_fit)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
