// Contact of regular cloths whose constraints are projected, in rows, against the particles one by one.
#include "fixture_lines.h"
#include "fixture_loops.h"

#include "constraint_kernel.h"
#include "contact.h"
#include "sweep_order.h"
#include "vector.h"

// What a run ends with: places, speeds times a frame, and the colliders' force, as a share of the weight.
typedef struct End {
    double *numbers;
    size_t count;
} End;

static End run(const ck_Model *model, const char *engine, const ck_Settings *settings) {
    ck_Trajectory trajectory;
    fixture_run(&trajectory, model, ck_engine_find(engine), settings, NULL);
    const int last = trajectory.frame_count - 1;
    const size_t count = 3 * (size_t)model->particle_count;
    End end = {calloc(2 * count + 3, sizeof(double)), 2 * count + 3};
    memcpy(end.numbers, ck_trajectory_position(&trajectory, last), count * sizeof(double));
    for (size_t i = 0; i < count; i++)
        end.numbers[count + i] = model->step * ck_trajectory_velocity(&trajectory, last)[i];
    for (int axis = 0; axis < 3; axis++) end.numbers[2 * count + (size_t)axis] = trajectory.contact[3 * last + axis];
    ck_trajectory_free(&trajectory);
    return end;
}

static double distance(const End *a, const End *b) {
    double off = 0;
    for (size_t i = 0; i < a->count; i++) off = fmax(off, fabs(a->numbers[i] - b->numbers[i]));
    return off;
}

// Off the rows: colliders that may move are the list's. Its bars in the rows' order, so that the sweeps are the same.
static void leave_rows(ck_Model *model, uint32_t sweeps) {
    const size_t count = (size_t)model->spring_count;
    ck_RowSprings springs;
    int *order = malloc(sizeof *order * count);
    ck_Spring *sorted = malloc(sizeof *sorted * count);
    assert_true(ck_projection_fits(model, &springs));
    assert_int_equal(ck_sweep_order(model, CK_PROJECT_BARS, sweeps, order), CK_OK);
    for (size_t i = 0; i < count; i++) sorted[i] = model->springs[order[i]];
    memcpy(model->springs, sorted, count * sizeof *sorted);
    free(order);
    free(sorted);
    model->terms |= CK_TERM_MOVING_COLLIDERS;
    assert_false(ck_projection_fits(model, &springs));
}

// XPBD spring by spring, or line by line, and particle by particle, by the formulas that rows stand for.
//   pulls  [3*n] m: what springs moved in the last substep, and not surfaces: lines begin with half of it
typedef struct Plain {
    const ck_Model *model;
    bool has_lines;
    ck_Contact *contact;
    double dt, *x, *v, *before, *start, *from, *pulls, *multipliers; // before: v a substep earlier
    ck_Pressed *pressed;
    int *order;
} Plain;

// m/s: lines take drag in the middle of a substep, XPBD after it.
static double speed_after(const Plain *plain, double v, double field) {
    const double half = plain->has_lines ? 0.5 * plain->model->drag * plain->dt : 0;
    return ((1 - half) * v + plain->dt * field) / (1 + half);
}

static void plain_fly(const Plain *plain) {
    const ck_Model *model = plain->model;
    for (int i = 0; i < model->particle_count; i++) {
        double *x = plain->x + 3 * i, field[3], next[3], v[3];
        memcpy(plain->before + 3 * i, plain->v + 3 * i, sizeof v);
        memcpy(plain->start + 3 * i, x, sizeof v);
        memcpy(plain->from + 3 * i, x, sizeof v);
        plain->pressed[i] = (ck_Pressed){0};
        if (model->pinned[i]) continue;
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++)
            next[axis] = v[axis] = speed_after(plain, plain->v[3 * i + axis], field[axis]);
        for (int axis = 0; axis < 3 && plain->has_lines; axis++) // what moves it, drag and all
            field[axis] = (next[axis] - plain->v[3 * i + axis]) / plain->dt;
        if (ck_contact_meet(plain->contact, model->mass[i], field, x, v)) {
            memcpy(plain->from + 3 * i, x, sizeof v);
            ck_add_scaled(plain->from + 3 * i, -plain->dt, v);
            memcpy(plain->before + 3 * i, v, sizeof v);
            ck_add_scaled(plain->before + 3 * i, -plain->dt, field);
        } else {
            ck_add_scaled(x, plain->dt, next);
        }
        if (plain->has_lines) ck_add_scaled(x, 0.5, plain->pulls + 3 * i);
    }
}

static void plain_spring(const Plain *plain, int index) {
    const ck_Spring *spring = &plain->model->springs[index];
    const double dt = plain->dt, compliance = 1 / (spring->stiffness * dt * dt),
                 gamma = spring->damping / (spring->stiffness * dt);
    const double weight_a = ck_model_inverse_mass(plain->model, spring->a),
                 weight_b = ck_model_inverse_mass(plain->model, spring->b);
    double *a = plain->x + 3 * spring->a, *b = plain->x + 3 * spring->b, now[3], old[3];
    if (weight_a + weight_b == 0) return;
    ck_subtract(now, b, a);
    ck_subtract(old, plain->start + 3 * spring->b, plain->start + 3 * spring->a);
    const double length = ck_length(now), moved = length - ck_dot(now, old) / length;
    const double change = -(length - spring->rest + compliance * plain->multipliers[index] + gamma * moved) /
                          ((1 + gamma) * (weight_a + weight_b) + compliance);
    plain->multipliers[index] += change;
    ck_add_scaled(a, -weight_a * change / length, now);
    ck_add_scaled(b, weight_b * change / length, now);
}

// All springs once, and what they pull.
static void plain_sweep(const Plain *plain) {
    const ck_Model *model = plain->model;
    if (!plain->has_lines) {
        for (int k = 0; k < model->spring_count; k++) plain_spring(plain, plain->order[k]);
        return;
    }
    const int count = 3 * model->particle_count;
    for (int i = 0; i < count; i++) plain->pulls[i] -= plain->x[i];
    fixture_sweep_lines(model, plain->dt, 1 / (1 + 0.5 * model->drag * plain->dt), plain->order, plain->start, plain->x,
                        plain->multipliers);
    for (int i = 0; i < count; i++) plain->pulls[i] += plain->x[i];
}

static void plain_substep(const Plain *plain, uint32_t sweeps) {
    const ck_Model *model = plain->model;
    plain_fly(plain);
    for (int i = 0; i < 3 * model->particle_count; i++) plain->pulls[i] *= 0.5;
    memset(plain->multipliers, 0, sizeof(double) * (size_t)model->spring_count);
    for (uint32_t sweep = 0; sweep < sweeps; sweep++) {
        plain_sweep(plain);
        for (int i = 0; i < model->particle_count; i++)
            if (!model->pinned[i])
                ck_contact_project(plain->contact, model->mass[i], plain->from + 3 * i, &plain->pressed[i],
                                   plain->x + 3 * i);
    }
    const double rate = plain->has_lines ? 1 / plain->dt : 1 / (1 + model->drag * plain->dt) / plain->dt;
    for (int i = 0; i < 3 * model->particle_count; i++) plain->v[i] = rate * (plain->x[i] - plain->from[i]);
}

// Half a substep back, as a leapfrog keeps speeds.
static void turn_back(const Plain *plain) {
    for (int i = 0; i < plain->model->particle_count; i++) {
        double field[3];
        ck_model_field(plain->model, i, field);
        ck_add_scaled(field, -plain->model->drag, plain->v + 3 * i);
        if (!plain->model->pinned[i]) ck_add_scaled(plain->v + 3 * i, -0.5 * plain->dt, field);
    }
}

static End run_plain(const ck_Model *model, const char *engine, const ck_Settings *settings) {
    const size_t count = 3 * (size_t)model->particle_count, springs = (size_t)model->spring_count;
    double *state = calloc(6 * count + springs, sizeof *state);
    Plain plain = {.model = model,
                   .has_lines = !strcmp(engine, "native-lines"),
                   .dt = model->step / settings->substeps,
                   .x = state,
                   .v = state + count,
                   .start = state + 2 * count,
                   .from = state + 3 * count,
                   .pulls = state + 4 * count,
                   .before = state + 5 * count,
                   .multipliers = state + 6 * count,
                   .pressed = malloc(sizeof *plain.pressed * count),
                   .order = malloc(sizeof *plain.order * springs)};
    End end = {calloc(2 * count + 3, sizeof(double)), 2 * count + 3};
    assert_int_equal(ck_contact_create(&plain.contact, model, plain.dt, NULL), CK_OK);
    assert_int_equal(ck_sweep_order(model, plain.has_lines ? CK_PROJECT_LINES : CK_PROJECT_SPRINGS,
                                    settings->iterations, plain.order),
                     CK_OK);
    memcpy(plain.x, model->position, count * sizeof *state);
    memcpy(plain.v, model->velocity, count * sizeof *state);
    if (plain.has_lines) turn_back(&plain);
    for (int frame = 0; frame < model->frame_count; frame++) {
        memset(plain.contact->impulse, 0, sizeof plain.contact->impulse);
        for (uint32_t i = 0; i < settings->substeps; i++) {
            plain_substep(&plain, settings->iterations);
            for (size_t k = 0; k < count && frame == 0 && i == 0; k++) plain.pulls[k] *= 2; // as line_kernel.c says
        }
    }
    memcpy(end.numbers, plain.x, count * sizeof *state);
    for (size_t i = 0; i < count; i++)
        end.numbers[count + i] =
            model->step * (plain.v[i] + (plain.has_lines ? 0.5 * (plain.v[i] - plain.before[i]) : 0));
    for (size_t axis = 0; axis < 3; axis++) end.numbers[2 * count + axis] = plain.contact->impulse[axis] / model->step;
    free(plain.contact);
    free(plain.pressed);
    free(plain.order);
    free(state);
    return end;
}

// All kinds of vectors, one thread and two, to the bit where they fuse; and the particles one by one, to what rounding
// grows to, which is measured by a start that is 1e-13 m beside.
static void compare(const char *body, const char *colliders, const char *engine, uint32_t sweeps) {
    char text[900];
    snprintf(text, sizeof text,
             "name: touching\n%s\ngravity: [0, -9.81, 0]\ndrag: 1\nnoise: {amplitude: 1e-3, seed: 3}\ncolliders:\n%s"
             "time: {duration: 0.25, step: 0.01}\n",
             body, colliders);
    Fixture fixture;
    fixture_load(&fixture, text);
    ck_Settings settings = {.substeps = 20, .iterations = sweeps, .threads = 1, .own_set = 1};
    settings.own[0] = ck_loops_at(0)->lanes;
    const End widest = run(&fixture.model, engine, &settings);
    for (int kind = 0; ck_loops_at(kind); kind++)
        for (settings.threads = 1; settings.threads < 3; settings.threads++) {
            settings.own[0] = ck_loops_at(kind)->lanes;
            End end = run(&fixture.model, engine, &settings);
            assert_near("vectors", distance(&end, &widest), 0, 1e-7);
            if (ck_loops_at(kind)->fuses && ck_loops_at(0)->fuses)
                assert_memory_equal(end.numbers, widest.numbers, end.count * sizeof *end.numbers);
            free(end.numbers);
        }
    settings.threads = 1;
    const bool are_bars = !strcmp(engine, "native-bars");
    if (are_bars) leave_rows(&fixture.model, sweeps);
    End alone = are_bars ? run(&fixture.model, engine, &settings) : run_plain(&fixture.model, engine, &settings);
    for (int i = 0; i < 3 * fixture.model.particle_count; i++) fixture.model.position[i] += 1e-13 * sin(i);
    End beside = are_bars ? run(&fixture.model, engine, &settings) : run_plain(&fixture.model, engine, &settings);
    const double growth = distance(&alone, &beside) / 1e-13;
    // each of 500 substeps rounds by 1e-16
    assert_near(text, distance(&alone, &widest), 0, fmin(1e-12 * growth + 1e-10, 1e-6));
    free(beside.numbers);
    assert_true(fabs(widest.numbers[widest.count - 2]) > 0.1);
    free(alone.numbers);
    free(widest.numbers);
    fixture_free(&fixture);
}

static void test_shapes(void **state) {
    (void)state;
    static const char *const bodies[] = {
        "cloth: {rows: 9, columns: 9, spacing: 0.05, mass: 0.1, origin: [-0.2, 0.25, -0.2], down: [0, 0, 1]}\n"
        "springs: {stiffness: 100, shear: 50}",
        "cloth: {rows: 12, columns: 19, spacing: 0.05, mass: 0.3, origin: [-0.45, 0.25, -0.3], down: [0, 0, 1]}\n"
        "springs: {stiffness: 200, damping: 0.02}\npins: [top_left]"};
    static const char *const colliders[] = {
        "  - {plane: {point: [0, 0.2, 0], normal: [0.1, 1, 0], friction: 0.5}}\n",
        "  - {sphere: {center: [0, 0, 0], radius: 0.2, friction: 0.8}}\n",
        "  - {plane: {point: [0, 0.2, 0], normal: [0, 1, 0], restitution: 0.5, friction: 0.1}}\n",
        "  - {box: {center: [0, 0, 0], size: [0.3, 0.4, 0.3], rounding: 0.02, friction: 0.4}}\n",
        "  - {sphere: {center: [0, 0, 0], radius: 0.2, friction: 0.3}}\n"
        "  - {plane: {point: [0, 0.1, 0], normal: [0, 1, 0], friction: 0.2}}\n"
        "  - {capsule: {from: [-0.3, 0.18, 0.12], to: [0.3, 0.18, 0.2], radius: 0.03, friction: 0.3}}\n"};
    for (size_t body = 0; body < (fixture_is_hurried() ? 1 : sizeof bodies / sizeof *bodies); body++)
        for (size_t i = 0; i < sizeof colliders / sizeof *colliders; i += fixture_is_hurried() ? 4 : 1)
            for (uint32_t sweeps = 1; sweeps < 5; sweeps += 3) {
                compare(bodies[body], colliders[i], "native-bars", sweeps);
                compare(bodies[body], colliders[i], "native-xpbd", sweeps);
                compare(bodies[body], colliders[i], "native-lines", sweeps);
            }
    // rows enough for two threads
    static const char tall[] = "cloth: {rows: 40, columns: 5, spacing: 0.02, mass: 0.2, origin: [-0.04, 0.25, -0.4], "
                               "down: [0, 0, 1]}\nsprings: {stiffness: 100, shear: 50}\npins: [top_left]";
    for (uint32_t sweeps = 1; sweeps < 5; sweeps += 3) {
        compare(tall, colliders[1], "native-bars", sweeps);
        compare(tall, colliders[1], "native-xpbd", sweeps);
    }
}

// A plane that stops within a substep, after it has come to a cloth at rest: it gives each particle (1 + e) times its
// speed.
static void test_jump(void **state) {
    (void)state;
    static const char *const engines[] = {"native-verlet", "native-bars", "native-xpbd"};
    static const char text[] =
        "name: jump\ncloth: {rows: 3, columns: 3, spacing: 0.1, mass: 1, origin: [0, 0.0505, 0], "
        "down: [0, 0, 1]}\nsprings: {stiffness: 1e-4}\ncolliders:\n"
        "  - plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.5}\n"
        "    path: {velocity: [0, 1, 0], to: 0.0512}\ntime: {duration: 0.1, step: 0.01}\n";
    Fixture fixture;
    fixture_load(&fixture, text);
    for (size_t i = 0; i < sizeof engines / sizeof *engines; i++)
        for (uint32_t substeps = 1; substeps < 8; substeps += 6) {
            const ck_Settings settings = {.substeps = substeps, .iterations = i ? 1 : 0};
            End end = run(&fixture.model, engines[i], &settings);
            for (int particle = 0; particle < 9; particle++)
                assert_near(engines[i], end.numbers[27 + 3 * particle + 1], 1.5 * fixture.model.step, 1e-12);
            free(end.numbers);
        }
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_shapes), cmocka_unit_test(test_jump)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
