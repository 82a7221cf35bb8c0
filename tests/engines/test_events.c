// Contact against paths that are followed from event to event: every engine converges to them as its steps shrink.
#include "fixture.h"

#include "vector.h"

// How far outside a collider a point is, and the way out; written anew, as the engines share theirs.
static double gap_of(const ck_Collider *collider, const double *x, double *normal) {
    double from[3];
    ck_subtract(from, x, collider->point);
    if (collider->shape == CK_PLANE) {
        memcpy(normal, collider->normal, 3 * sizeof(double));
        return ck_dot(from, normal);
    }
    for (int axis = 0; axis < 3; axis++) normal[axis] = from[axis] / ck_length(from);
    return ck_length(from) - collider->radius;
}

static void fly(const double *x, const double *v, const double *a, double time, double *to, double *speed) {
    for (int axis = 0; axis < 3; axis++) {
        to[axis] = x[axis] + v[axis] * time + 0.5 * a[axis] * time * time;
        speed[axis] = v[axis] + a[axis] * time;
    }
}

// The time in which a flight meets the collider from outside, by bisection between samples that are close enough for
// one meeting; time where it does not.
static double meeting(const ck_Collider *collider, const double *x, const double *v, const double *a, double time) {
    double to[3], speed[3], normal[3], before = 0;
    for (int i = 1; i <= 10000; i++) {
        double now = time * i / 10000;
        fly(x, v, a, now, to, speed);
        if (gap_of(collider, to, normal) < 0 && ck_dot(speed, normal) < 0 && i > 1) {
            for (int round = 0; round < 80; round++) {
                double middle = 0.5 * (before + now);
                fly(x, v, a, middle, to, speed);
                if (gap_of(collider, to, normal) < 0)
                    now = middle;
                else
                    before = middle;
            }
            return before;
        }
        before = now;
    }
    return time;
}

// A particle's path from event to event: flights, impacts that give (1 + e)·v_n and take at most μ times that, and on a
// plane without restitution a slide that friction slows.
static void follow_events(const ck_Model *model, double *x, double *v) {
    const ck_Collider *collider = &model->colliders[0];
    double a[3], left = model->duration, normal[3], to[3], speed[3], along[3];
    memcpy(x, model->position, 3 * sizeof(double));
    memcpy(v, model->velocity, 3 * sizeof(double));
    ck_model_field(model, 0, a);
    for (int event = 0; event < 100 && left > 0; event++) {
        double time = meeting(collider, x, v, a, left);
        fly(x, v, a, time, to, speed);
        memcpy(x, to, sizeof to);
        memcpy(v, speed, sizeof speed);
        left -= time;
        if (!(left > 0)) return;
        gap_of(collider, x, normal);
        double push = -(1 + collider->restitution) * ck_dot(v, normal);
        ck_add_scaled(v, push, normal);
        ck_tangential(along, v, normal);
        double sliding = ck_length(along);
        if (sliding > 0) ck_add_scaled(v, -fmin(1, collider->friction * push / sliding), along);
        if (collider->restitution > 0) continue;
        ck_tangential(along, v, normal);
        sliding = ck_length(along);
        double slowing = collider->friction * -ck_dot(a, normal);
        double until = fmin(left, sliding / slowing);
        ck_add_scaled(x, until - 0.5 * slowing * until * until / sliding, along);
        memcpy(v, along, sizeof along);
        ck_add_scaled(v, -slowing * until / sliding, along);
        return;
    }
}

static double error_at(const Fixture *fixture, const ck_Engine *engine, uint32_t substeps, const double *x,
                       const double *v) {
    ck_Trajectory path;
    fixture_run(&path, &fixture->model, engine, &(ck_Settings){.substeps = substeps}, NULL);
    int last = fixture->model.frame_count;
    double off = ck_distance(ck_trajectory_position(&path, last), x) +
                 ck_distance(ck_trajectory_velocity(&path, last), v) * fixture->model.duration;
    ck_trajectory_free(&path);
    return off;
}

// Every engine comes to the path that events give as its steps become smaller. A step may be early or late at an impact
// by all of itself, so that errors scatter below a bound that shrinks with it: from 8 … 32 substeps to 256 … 1024 by 32
// times, of which a quarter is asked.
// Methods that take speeds from positions are left with 1e-16 m on each of some 1e3 steps, over a step of 5 µs.
static void test_events(void **state) {
    (void)state;
    static const char *const texts[] = {
        "velocity: [1.0, 0, 0.5]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.6, "
        "friction: "
        "0.25}}]\n",
        "velocity: [2.0, -1, 0.5]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0.3, 1, 0.1], restitution: 0.5, "
        "friction: 0.2}}]\n",
        "velocity: [0.3, -1, 0]\ncolliders: [{sphere: {center: [-0.1, -0.7, -0.05], radius: 0.5, restitution: 0.5, "
        "friction: 0.3}}]\n",
        "velocity: [0.3, -4, 0]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 0.4}}]\n",
        "velocity: [1.0, 0, 0]\ncolliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], friction: 0.2}}]\n"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char text[600];
        Fixture fixture;
        double x[3], v[3];
        snprintf(text, sizeof text,
                 "name: events\nnetwork: {nodes: [{at: [0, 0.3, 0], mass: 0.1}], bars: []}\ngravity: [0, -9.81, 0]\n"
                 "%stime: {duration: 0.4, step: 0.02}\n",
                 texts[i]);
        fixture_load(&fixture, text);
        follow_events(&fixture.model, x, v);
        for (int k = 0; k < ck_engine_count(); k++) {
            const ck_Engine *engine = ck_engine_at(k);
            if (!fixture_is_solver(engine) || !fixture_takes(engine, &fixture.model)) continue;
            double coarse = 0, fine = 0;
            for (uint32_t n = 8; n <= 32; n *= 2) coarse = fmax(coarse, error_at(&fixture, engine, n, x, v));
            for (uint32_t n = 256; n <= 1024; n *= 2) fine = fmax(fine, error_at(&fixture, engine, n, x, v));
            char what[100];
            snprintf(what, sizeof what, "%s on path %zu at 256 and more substeps", engine->name, i);
            assert_near(what, fine, 0, fmax(coarse / 8, 1e-7));
        }
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_events)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
