// One small experiment for each quirk of the origins, in their own units.
#include "claims.h"
#include "engines.h"
#include "seed.h"
#include "statistics.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Quirk {
    const char *engine;
    uint32_t bit; // 0: the scene's own
    const char *name, *experiment, *metric, *unit;
    // With that quirk mended or not. scenes: directory. Errors as ck_quirks_write.
    ck_Status (*run)(double *value, bool mended, const char *scenes, ck_Error *error);
    double physics;
} Quirk;

// Two particles and a bar of one metre; what an experiment needs to be otherwise, it sets.
typedef struct Pair {
    ck_Model model;
    double position[6], velocity[6], mass[2];
    bool pinned[2];
    ck_Spring spring;
    ck_Tecido *tecido;
} Pair;

static void set_pair(Pair *pair, double rate) {
    *pair =
        (Pair){.position = {0, 0, 0, 1, 0, 0}, .mass = {1, 1}, .spring = {.b = 1, .rest = 1, .stiffness = INFINITY}};
    pair->model = (ck_Model){.body = CK_NETWORK,
                             .particle_count = 2,
                             .spring_count = 1,
                             .position = pair->position,
                             .velocity = pair->velocity,
                             .mass = pair->mass,
                             .pinned = pair->pinned,
                             .springs = &pair->spring,
                             .step = 1 / rate};
}

static ck_Status start_pair(Pair *pair, uint32_t sweeps, uint32_t mended, ck_Error *error) {
    return ck_tecido_create(&pair->tecido, &pair->model,
                            &(ck_Settings){.substeps = 1, .iterations = sweeps, .own = {mended}, .own_set = 1}, error);
}

static void step_pair(const Pair *pair, int count) {
    for (int i = 0; i < count; i++) ck_tecido_step(pair->tecido, pair->model.step);
}

static ck_Status hanging_bar(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.pinned[0] = true;
    pair.model.gravity[0] = 15;
    ck_Status status = start_pair(&pair, 1, mended ? CK_TECIDO_HALF_CORRECTION : 0, error);
    if (status) return status;
    step_pair(&pair, 600);
    *value = ck_tecido_position(pair.tecido)[3] - 1;
    ck_tecido_destroy(pair.tecido);
    return CK_OK;
}

static ck_Status unequal_masses(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.position[3] = 2;
    pair.mass[1] = 9;
    ck_Status status = start_pair(&pair, 1, mended ? CK_TECIDO_MASSLESS_BARS : 0, error);
    if (status) return status;
    step_pair(&pair, 1);
    const double *x = ck_tecido_position(pair.tecido);
    *value = (x[0] + 9 * x[3]) / 10;
    ck_tecido_destroy(pair.tecido);
    return CK_OK;
}

static ck_Status uneven_steps(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.model.gravity[1] = -15;
    ck_Status status = start_pair(&pair, 1, mended ? CK_TECIDO_UNSCALED_STEP : 0, error);
    if (status) return status;
    for (int i = 0; i < 120; i++) ck_tecido_step(pair.tecido, i % 2 ? 2.0 / 60 - 0.01 : 0.01);
    *value = ck_tecido_position(pair.tecido)[1];
    ck_tecido_destroy(pair.tecido);
    return CK_OK;
}

static ck_Status unlocked(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.velocity[0] = pair.velocity[3] = 10;
    ck_Status status = start_pair(&pair, 1, mended ? CK_TECIDO_STALE_VELOCITY : 0, error);
    if (status) return status;
    step_pair(&pair, 10);
    for (int i = 0; i < 2; i++) ck_tecido_lock(pair.tecido, i, true);
    step_pair(&pair, 60);
    for (int i = 0; i < 2; i++) ck_tecido_lock(pair.tecido, i, false);
    step_pair(&pair, 1);
    double velocity[6];
    ck_tecido_velocity(pair.tecido, velocity);
    *value = velocity[0];
    ck_tecido_destroy(pair.tecido);
    return CK_OK;
}

static ck_Status pendulum(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.pinned[0] = true;
    pair.model.gravity[1] = -15;
    // locks corrected in full and many sweeps: only the direction is left
    uint32_t always = CK_TECIDO_HALF_CORRECTION;
    ck_Status status = start_pair(&pair, 20, mended ? always | CK_TECIDO_NEW_DIRECTION : always, error);
    if (status) return status;
    step_pair(&pair, 600);
    double velocity[6];
    const double *x = ck_tecido_position(pair.tecido);
    ck_tecido_velocity(pair.tecido, velocity);
    // the speed is that of half a step ago
    *value = 0.5 * ck_dot(velocity + 3, velocity + 3) + 15 * (x[4] - 0.5 * pair.model.step * velocity[4]);
    ck_tecido_destroy(pair.tecido);
    return CK_OK;
}

// Runs a scene's model, once changed, for some frames and hands its end to measure.
static ck_Status run_scene(double *value, const char *scenes, const char *name, uint32_t sweeps, uint32_t mended,
                           int frames, void (*change)(ck_Model *model),
                           double (*measure)(const ck_Model *model, const double *x, const double *v),
                           ck_Error *error) {
    ck_Scene scene = {0};
    ck_Model model = {0};
    ck_Tecido *tecido = NULL;
    double *velocity = NULL;
    ck_Status status = ck_claims_load(&scene, &model, scenes, name, error);
    if (!status) {
        if (change) change(&model);
        velocity = calloc(3 * (size_t)model.particle_count, sizeof *velocity);
        if (!velocity) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    if (!status)
        status = ck_tecido_create(
            &tecido, &model, &(ck_Settings){.substeps = 1, .iterations = sweeps, .own = {mended}, .own_set = 1}, error);
    if (!status) {
        for (int i = 0; i < frames; i++) ck_tecido_step(tecido, model.step);
        ck_tecido_velocity(tecido, velocity);
        *value = measure(&model, ck_tecido_position(tecido), velocity);
    }
    ck_tecido_destroy(tecido);
    free(velocity);
    ck_model_free(&model);
    ck_scene_free(&scene);
    return status;
}

static double fastest(const ck_Model *model, const double *x, const double *v) {
    (void)x;
    double speed = 0;
    for (int i = 0; i < model->particle_count; i++) speed = fmax(speed, ck_length(v + 3 * i));
    return speed;
}

static void slacken(ck_Model *model) {
    for (int i = 1; i < model->particle_count; i++)
        for (int axis = 0; axis < 3; axis++)
            model->position[3 * i + axis] =
                model->position[axis] +
                (model->position[3 * i + axis] - model->position[axis]) / (1 + 0.41421356237309515);
}

static ck_Status first_frame(double *value, bool mended, const char *scenes, ck_Error *error) {
    return run_scene(value, scenes, "seed_tecido_rope", 20, 0, 1, mended ? slacken : NULL, fastest, error);
}

static void disturb(ck_Model *model) {
    memset(model->force, 0, sizeof model->force);
    // 1 mm in the first step: the sweeps before the start would take noise in the positions away
    ck_Random random = ck_random_seed(1);
    for (int i = 0; i < 3 * model->particle_count; i++)
        if (!model->pinned[i / 3]) model->velocity[i] = 1e-3 * (2 * ck_random_unit(&random) - 1) / model->step;
}

static double longest_bar(const ck_Model *model, const double *x, const double *v) {
    (void)v;
    double longest = 0;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double length = ck_distance(x + 3 * spring->a, x + 3 * spring->b) / spring->rest;
        longest = isfinite(length) ? fmax(longest, length) : INFINITY;
    }
    return longest;
}

static ck_Status one_sweep(double *value, bool mended, const char *scenes, ck_Error *error) {
    return run_scene(value, scenes, "seed_tecido_flag", 1, mended ? CK_TECIDO_INTERLEAVED : 0, 300, disturb,
                     longest_bar, error);
}

// A force that its mirror leaves as it is, on the 33 rows that the pins lie evenly on.
static void mirror(ck_Model *model) {
    model->force[1] = 0;
    int kept = 0, rows = model->particle_count / model->columns - 1;
    for (int i = 0; i < model->spring_count; i++)
        if (model->springs[i].a / model->columns < rows && model->springs[i].b / model->columns < rows)
            model->springs[kept++] = model->springs[i];
    model->spring_count = kept;
    model->particle_count -= model->columns;
}

static double mirror_error(const ck_Model *model, const double *x, const double *v) {
    (void)v;
    int rows = model->particle_count / model->columns;
    double largest = 0, twice_middle = model->position[1] + model->position[3 * (rows - 1) * model->columns + 1];
    for (int row = 0; row < rows; row++)
        for (int column = 0; column < model->columns; column++) {
            const double *one = x + 3 * (row * model->columns + column);
            const double *other = x + 3 * ((rows - 1 - row) * model->columns + column);
            double off[3] = {one[0] - other[0], one[1] + other[1] - twice_middle, one[2] - other[2]};
            largest = fmax(largest, ck_length(off));
        }
    return largest;
}

static ck_Status bias(double *value, bool mended, const char *scenes, ck_Error *error) {
    return run_scene(value, scenes, "seed_tecido_flag", 20, mended ? CK_TECIDO_ONE_WAY : 0, 15, mirror, mirror_error,
                     error);
}

// What the second origin's collision makes of one particle: at (0, 0, 0) on a surface that looks up.
typedef struct Collision {
    ck_Collider collider;
    double x[3], v[3], force[3];
    double dt;
} Collision;

static Collision collision(ck_ColliderShape shape) {
    return (Collision){.collider = {.shape = shape,
                                    .point = {0, shape == CK_SPHERE ? -0.3 : 0, 0},
                                    .normal = {0, 1, 0},
                                    .radius = 0.3,
                                    .restitution = shape == CK_SPHERE ? 0.2 : 0.6,
                                    .friction = 0.5},
                       .force = {0, -9.8, 0},
                       .dt = 1.0 / 9000};
}

static void collide(Collision *c, uint32_t mended) {
    ck_seed_cloth_collide(&c->collider, mended, c->dt, 1, c->force, c->x, c->v);
}

static ck_Status oblique(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_SPHERE);
    c.v[0] = 1;
    c.v[1] = -1;
    collide(&c, mended ? CK_CLOTH_FORCE_FRICTION | CK_CLOTH_RUBBED_REBOUND : 0);
    *value = c.v[0];
    return CK_OK;
}

static ck_Status rebound(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_SPHERE);
    c.v[0] = 1;
    c.v[1] = -1;
    collide(&c, mended ? CK_CLOTH_RUBBED_REBOUND : 0);
    *value = c.v[1];
    return CK_OK;
}

static ck_Status pulled_off(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_SPHERE);
    c.v[0] = 0.1;
    c.force[1] = 630;
    collide(&c, mended ? CK_CLOTH_PULLING_NORMAL : 0);
    *value = c.v[0];
    return CK_OK;
}

// The share of substeps of one second that a particle lying on the floor is found at rest.
static ck_Status lying(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_PLANE);
    int still = 0;
    for (int i = 0; i < 9000; i++) {
        ck_add_scaled(c.x, c.dt, c.v);
        ck_add_scaled(c.v, c.dt, c.force);
        collide(&c, mended ? CK_CLOTH_ONE_TOLERANCE : 0);
        still += c.v[1] == 0;
    }
    *value = still / 9000.0;
    return CK_OK;
}

static ck_Status lifted(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_SPHERE);
    c.force[1] = 5;
    for (int i = 0; i < 90; i++) {
        ck_add_scaled(c.x, c.dt, c.v);
        ck_add_scaled(c.v, c.dt, c.force);
        collide(&c, mended ? CK_CLOTH_GLUE : 0);
    }
    *value = c.x[1];
    return CK_OK;
}

static ck_Status floor_friction(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes, (void)error;
    Collision c = collision(CK_PLANE);
    c.v[0] = 1;
    c.v[1] = -1;
    uint32_t always = CK_CLOTH_FORCE_FRICTION | CK_CLOTH_RUBBED_REBOUND;
    collide(&c, mended ? always | CK_CLOTH_SMOOTH_FLOOR : always);
    *value = c.v[0];
    return CK_OK;
}

// Energy of a spring after one second, as a multiple of that at the start.
static ck_Status oscillator(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.pinned[0] = true;
    pair.mass[1] = 0.0008;
    pair.spring.stiffness = 35;
    pair.velocity[3] = 0.01;
    void *state;
    ck_Settings used;
    ck_Status status =
        ck_engine_find("seed-cloth")
            ->create(&state, &pair.model, &(ck_Settings){.own = {mended ? CK_CLOTH_FORWARD_EULER : 0}, .own_set = 1},
                     &used, NULL, error);
    if (status) return status;
    for (int frame = 0; frame < 60; frame++) ck_engine_find("seed-cloth")->step(state);
    double x[6], v[6];
    ck_engine_find("seed-cloth")->read(state, x, v);
    ck_engine_find("seed-cloth")->destroy(state);
    *value = (pair.mass[1] * v[3] * v[3] + 35 * (x[3] - 1) * (x[3] - 1)) / (pair.mass[1] * 0.01 * 0.01);
    return CK_OK;
}

static ck_Status coincident(double *value, bool mended, const char *scenes, ck_Error *error) {
    (void)scenes;
    Pair pair;
    set_pair(&pair, 60);
    pair.position[3] = 0;
    pair.spring.stiffness = 35;
    void *state;
    ck_Settings used;
    ck_Status status =
        ck_engine_find("seed-cloth")
            ->create(&state, &pair.model, &(ck_Settings){.own = {mended ? CK_CLOTH_COINCIDENT_NODES : 0}, .own_set = 1},
                     &used, NULL, error);
    if (status) return status;
    *value = ck_engine_find("seed-cloth")->step(state) == CK_STEP_OK;
    ck_engine_find("seed-cloth")->destroy(state);
    return CK_OK;
}

static const Quirk quirks[] = {
    {"seed-tecido", CK_TECIDO_HALF_CORRECTION, NULL, "a bar hangs at rest, one sweep, g = 15, 60 Hz", "excess_length",
     "m", hanging_bar, 0},
    {"seed-tecido", CK_TECIDO_MASSLESS_BARS, NULL, "a stretched bar between masses 1 and 9 is corrected once",
     "center_of_mass", "m", unequal_masses, 1.8},
    {"seed-tecido", CK_TECIDO_UNSCALED_STEP, NULL, "a drop of 2 s in steps of 10 and 23.3 ms by turns, g = 15",
     "height", "m", uneven_steps, -30},
    {"seed-tecido", CK_TECIDO_STALE_VELOCITY, NULL, "locked at 10 m/s for one second, then unlocked", "speed", "m/s",
     unlocked, 0},
    {"seed-tecido", CK_TECIDO_NEW_DIRECTION, NULL, "a pendulum let go level swings for 10 s at 60 Hz; drop -15",
     "energy", "J", pendulum, 0},
    {"seed-tecido", CK_TECIDO_INTERLEAVED, NULL, "the flag without force, 1 mm of noise, one sweep, 5 s", "longest_bar",
     "1", one_sweep, 1},
    {"seed-tecido", CK_TECIDO_ONE_WAY, NULL, "a flag and its mirror image, 20 sweeps, 0.25 s", "mirror_error", "m",
     bias, 0},
    {"seed-tecido", 0, "rope starts stretched", "the rope's first frame at 60 Hz", "speed", "m/s", first_frame,
     15.0 / 60},
    {"seed-cloth", CK_CLOTH_FORWARD_EULER, NULL, "a spring swings for one second", "energy_ratio", "1", oscillator, 1},
    {"seed-cloth", CK_CLOTH_FORCE_FRICTION, NULL, "(1, -1) m/s onto the ball, mu = 0.5, e = 0.2", "speed_along", "m/s",
     oblique, 0.4},
    {"seed-cloth", CK_CLOTH_RUBBED_REBOUND, NULL, "(1, -1) m/s onto the ball, e = 0.2", "speed_off", "m/s", rebound,
     0.2},
    {"seed-cloth", CK_CLOTH_PULLING_NORMAL, NULL, "0.1 m/s along the ball, pulled off it at 630 m/s2", "speed_along",
     "m/s", pulled_off, 0.1},
    {"seed-cloth", CK_CLOTH_ONE_TOLERANCE, NULL, "a particle lies on the floor for one second", "share_at_rest", "1",
     lying, 1},
    {"seed-cloth", CK_CLOTH_GLUE, NULL, "lifted off the ball at 5 m/s2 for 10 ms", "gap", "m", lifted, 2.5e-4},
    {"seed-cloth", CK_CLOTH_SMOOTH_FLOOR, NULL, "(1, -1) m/s onto the floor, mu = 0.5, e = 0.6", "speed_along", "m/s",
     floor_friction, 0.2},
    {"seed-cloth", CK_CLOTH_COINCIDENT_NODES, NULL, "two nodes of a spring at one place", "is_finite", "1", coincident,
     1},
};

static const char *name_of(const Quirk *quirk) {
    if (quirk->name) return quirk->name;
    int bit = __builtin_ctz(quirk->bit);
    return strcmp(quirk->engine, "seed-tecido") ? ck_cloth_quirk_names[bit] : ck_tecido_quirk_names[bit];
}

ck_Status ck_quirks_write(ck_Csv *csv, const char *scenes, ck_Error *error) {
    ck_Status status = CK_OK;
    for (size_t i = 0; i < sizeof quirks / sizeof *quirks && !status; i++) {
        const Quirk *quirk = &quirks[i];
        double was = NAN, mended = NAN;
        status = quirk->run(&was, false, scenes, error);
        if (!status) status = quirk->run(&mended, true, scenes, error);
        if (status) break;
        ck_csv_text(csv, quirk->engine);
        ck_csv_text(csv, name_of(quirk));
        ck_csv_text(csv, quirk->experiment);
        ck_csv_text(csv, quirk->metric);
        ck_csv_text(csv, quirk->unit);
        ck_csv_number(csv, was);
        ck_csv_number(csv, mended);
        ck_csv_number(csv, quirk->physics);
    }
    return status;
}
