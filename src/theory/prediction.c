#include "prediction.h"

#include "constraint_kernel.h"
#include "rest_prediction.h"
#include "time_scale.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

typedef struct Theory {
    ck_Method method;
    const char *truth;
    // Writes the state at time s; false where the theory does not reach.
    bool (*at)(const ck_Model *model, const ck_Settings *used, double time, double *position, double *velocity);
} Theory;

static double time_step(const ck_Model *model, const ck_Settings *used) {
    return model->step / used->substeps;
}

// A second-order scheme falls exactly.
static bool fall_exactly(const ck_Model *model, const ck_Settings *used, double time, double *position,
                         double *velocity) {
    (void)used;
    return ck_truth_form_find("free_fall")->at(model, time, position, velocity, NULL) == CK_OK;
}

// Symplectic or backward Euler adds the step's whole g·dt before it moves: ahead by g·t·dt/2.
static bool fall_ahead(const ck_Model *model, const ck_Settings *used, double time, double *position,
                       double *velocity) {
    if (!fall_exactly(model, used, time, position, velocity)) return false;
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        ck_model_field(model, i, field);
        ck_add_scaled(position + 3 * i, 0.5 * time * time_step(model, used), field);
    }
    return true;
}

// One substep of a fall with drag: distance, speed and carried acceleration under a unit field, by superposition with
// the start velocity as a second, fieldless fall.
typedef struct Fall {
    double field, drag, dt;
    double x, v, a;
} Fall;

static void fall_verlet(Fall *f) {
    double a = f->a;
    f->x += f->dt * f->v + 0.5 * f->dt * f->dt * a;
    f->a = f->field - f->drag * (f->v + f->dt * a);
    f->v += 0.5 * f->dt * (a + f->a);
}

// v is half a substep behind x, as the method holds it, and a how it changed over the last substep
static void fall_leapfrog(Fall *f) {
    const double before = f->v;
    f->v = (f->v * (1 - 0.5 * f->drag * f->dt) + f->field * f->dt) / (1 + 0.5 * f->drag * f->dt);
    f->a = (f->v - before) / f->dt;
    f->x += f->dt * f->v;
}

// XPBD's and Bullet's kDP: moves by the whole of v + g·dt, then damps
static void fall_then_damp(Fall *f) {
    f->v += f->field * f->dt;
    f->x += f->dt * f->v;
    f->v /= 1 + f->drag * f->dt;
}

static void damp_then_fall(Fall *f) {
    f->v = (f->v + f->field * f->dt) / (1 + f->drag * f->dt);
    f->x += f->dt * f->v;
}

// ODE's LinearDamping takes h·drag off the speed once it has moved
static void fall_then_scale(Fall *f) {
    f->v += f->field * f->dt;
    f->x += f->dt * f->v;
    f->v *= 1 - f->drag * f->dt;
}

static Fall fall_for(const ck_Model *model, const ck_Settings *used, double time, double field, double speed,
                     void (*substep)(Fall *)) {
    Fall f = {.field = field, .drag = model->drag, .dt = time_step(model, used), .v = speed};
    f.a = field - f.drag * speed;
    if (substep == fall_leapfrog) f.v -= 0.5 * f.dt * f.a;
    for (long step = lround(time / f.dt); step > 0; step--) substep(&f);
    // told at the time of x, as the engines tell it
    if (substep == fall_leapfrog) f.v += 0.5 * f.dt * f.a;
    return f;
}

static bool fall_with_drag(const ck_Model *model, const ck_Settings *used, double time, double *position,
                           double *velocity, void (*substep)(Fall *)) {
    Fall pulled = fall_for(model, used, time, 1, 0, substep), thrown = fall_for(model, used, time, 0, 1, substep);
    memcpy(position, model->position, 3 * sizeof(double) * (size_t)model->particle_count);
    memset(velocity, 0, 3 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        double field[3];
        ck_model_field(model, i, field);
        ck_add_scaled(position + 3 * i, pulled.x, field);
        ck_add_scaled(position + 3 * i, thrown.x, model->velocity + 3 * i);
        ck_add_scaled(velocity + 3 * i, pulled.v, field);
        ck_add_scaled(velocity + 3 * i, thrown.v, model->velocity + 3 * i);
    }
    return true;
}

#define FALL_WITH_DRAG(name, substep)                                                                                  \
    static bool name(const ck_Model *model, const ck_Settings *used, double time, double *position,                    \
                     double *velocity) {                                                                               \
        return fall_with_drag(model, used, time, position, velocity, substep);                                         \
    }

FALL_WITH_DRAG(drag_verlet, fall_verlet)
FALL_WITH_DRAG(drag_leapfrog, fall_leapfrog)
FALL_WITH_DRAG(drag_then_damp, fall_then_damp)
FALL_WITH_DRAG(drag_damp_first, damp_then_fall)
FALL_WITH_DRAG(drag_then_scale, fall_then_scale)

// One substep of a damped oscillator: u, v and the acceleration that the method carries over, in m, m/s and m/s².
typedef struct Oscillator {
    double k, c, m, rest, dt;
    uint32_t iterations;
    double u, v, a;
    int step;      // since the start
    double held;   // a length that a method goes on with, m
    double behind; // m/s, half a substep before
} Oscillator;

// m·v' = m·v − dt·(k·u' + c·v'), u' = u + dt·v'.
static void backward_euler(Oscillator *o) {
    o->v = (o->m * o->v - o->dt * o->k * o->u) / (o->m + o->dt * o->c + o->dt * o->dt * o->k);
    o->u += o->dt * o->v;
}

// u' = u + dt·v + dt²·a/2, a' = a(u', v + dt·a), v' = v + dt·(a + a')/2; a' serves the next substep too.
static void velocity_verlet(Oscillator *o) {
    double a = o->a;
    o->u += o->dt * o->v + 0.5 * o->dt * o->dt * a;
    o->a = -(o->k * o->u + o->c * (o->v + o->dt * a)) / o->m;
    o->v += 0.5 * o->dt * (a + o->a);
}

// m·v' = m·v − dt·(k·u + c·v'), u' = u + dt·v'.
static void symplectic_euler(Oscillator *o) {
    o->v = (o->m * o->v - o->dt * o->k * o->u) / (o->m + o->dt * o->c);
    o->u += o->dt * o->v;
}

// Bullet's link answers an error x − L with f(x) = x·(x² − L²)/(x² + L²), and the bridge divides it by
// h(l) = l·(l + L)/(l² + L²) of the length before the step, so that f/h is Hooke's l − L where both lengths agree.
// But no link may give more than its whole error: h is at least the share that a sweep takes.
static double bullet_error(double x, double l, double rest, double share) {
    double f = x * (x * x - rest * rest) / (x * x + rest * rest), h = l * (l + rest) / (l * l + rest * rest);
    return f / fmax(h, share);
}

// The share of the error that one of the bridge's sweeps takes off.
static double bullet_share(double q, uint32_t iterations) {
    if (isinf(q)) return 1;
    return iterations == 1 ? fmin(1, q / (1 + q / 2)) : 1 - pow(1 + q, -1.0 / iterations);
}

// Damping explicit, for two substeps at once where it leaves a relative speed its direction; the length that the
// correction is made for is held for twice as many. Then each sweep takes its share off what is left, at most all of
// it.
static void bullet_link(Oscillator *o) {
    double share = bullet_share(o->k * o->dt * o->dt / o->m, o->iterations);
    int apart = 4 * o->c / o->m * o->dt > 1 ? 1 : 2;
    double taken = o->step % apart == 0 ? apart * o->dt * o->c / o->m : 0;
    if (o->step % (2 * apart) == 0) o->held = o->rest + o->u;
    o->step++;
    double moved = o->u + o->dt * o->v * (1 - taken);
    for (uint32_t i = 0; i < o->iterations; i++)
        moved -= share * bullet_error(o->rest + moved, o->held, o->rest, share);
    o->v = (moved - o->u) / o->dt;
    o->u = moved;
}

// Of one spring along one line, what native-lines has of chains: the flight, a share of the last pull, and what the
// spring finds, damped by the rate at the substep's end; see native/chain.c.
static void line(Oscillator *o) {
    const double weight = 1 / o->m, damping = o->c / (o->k * o->dt), gamma = CK_LINES_RATE * damping,
                 compliance = 1 / (o->k * (1 - CK_LINES_KEPT) * o->dt * o->dt);
    const double last = o->step ? o->behind : o->v, flown = o->u + o->dt * last;
    double moved = flown + (o->step ? CK_LINES_KEPT * o->held : 0);
    moved -= weight * (moved + gamma * (moved - o->u) - (CK_LINES_RATE - 1) * damping * o->dt * last) /
             ((1 + gamma) * weight + compliance);
    o->held = (o->step++ ? 1 : 2) * (moved - flown);
    o->behind = (moved - o->u) / o->dt;
    o->v = o->behind + 0.5 * (o->behind - last);
    o->u = moved;
}

static bool oscillate(const ck_Model *model, const ck_Settings *used, double time, double *position, double *velocity,
                      void (*substep)(Oscillator *)) {
    if (model->drag > 0) return false; // each method takes drag in its own way

    const ck_Spring *spring = &model->springs[0];
    double along[3], dt = time_step(model, used);
    ck_subtract(along, model->position + 3, model->position);
    for (int axis = 0; axis < 3; axis++) along[axis] /= spring->rest;
    Oscillator o = {spring->stiffness,
                    spring->damping,
                    model->mass[1],
                    spring->rest,
                    dt,
                    used->iterations,
                    .v = ck_dot(model->velocity + 3, along)};
    o.a = -o.c * o.v / o.m;
    for (long step = lround(time / dt); step > 0; step--) substep(&o);
    memcpy(position, model->position, 6 * sizeof(double));
    memset(velocity, 0, 6 * sizeof(double));
    ck_add_scaled(position + 3, o.u, along);
    ck_add_scaled(velocity + 3, o.v, along);
    return true;
}

static bool oscillate_verlet(const ck_Model *model, const ck_Settings *used, double time, double *position,
                             double *velocity) {
    return oscillate(model, used, time, position, velocity, velocity_verlet);
}

// One spring along one line: XPBD's only constraint, Bullet's Newton step and ODE's joint all solve backward Euler
// exactly.
static bool oscillate_backward(const ck_Model *model, const ck_Settings *used, double time, double *position,
                               double *velocity) {
    return oscillate(model, used, time, position, velocity, backward_euler);
}

static bool oscillate_symplectic(const ck_Model *model, const ck_Settings *used, double time, double *position,
                                 double *velocity) {
    return oscillate(model, used, time, position, velocity, symplectic_euler);
}

static bool oscillate_bullet_link(const ck_Model *model, const ck_Settings *used, double time, double *position,
                                  double *velocity) {
    return !(used->softness > 0) && oscillate(model, used, time, position, velocity, bullet_link);
}

static bool oscillate_line(const ck_Model *model, const ck_Settings *used, double time, double *position,
                           double *velocity) {
    return !(used->softness > 0) && oscillate(model, used, time, position, velocity, line);
}

// All constraints at once: nothing stretches.
static bool hang_direct(const ck_Model *model, const ck_Settings *used, double time, double *position,
                        double *velocity) {
    (void)used;
    ck_Model bars = *model;
    bars.springs = malloc(sizeof *bars.springs * (size_t)model->spring_count);
    if (!bars.springs) return false;
    for (int i = 0; i < model->spring_count; i++) {
        bars.springs[i] = model->springs[i];
        bars.springs[i].stiffness = INFINITY;
    }
    bool hangs = ck_truth_form_find("vertical_chain")->at(&bars, time, position, velocity, NULL) == CK_OK;
    free(bars.springs);
    return hangs;
}

// True where the method's forces balance at rest: it steps by them, or solves for the end of the step. QuickStep's
// iterations do so to 1e-9 at 50 of them and k·h²·W ≤ 10; a bar's residual softness (CFM) is no truth.
static bool balances_forces(const ck_Model *model, ck_Method method, const ck_Settings *used) {
    if (method == CK_METHOD_VELOCITY_VERLET || method == CK_METHOD_IMPLICIT_EULER ||
        method == CK_METHOD_SYMPLECTIC_EULER)
        return true;
    double dt = time_step(model, used);
    bool converged =
        !used->iterations || (used->iterations >= 50 && ck_stability_stiffness_rate(model) * dt * dt <= 10);
    return method == CK_METHOD_SEMI_IMPLICIT_ODE && converged && !(model->terms & CK_TERM_RIGID);
}

// At rest the stretch is exact.
static bool hang_exactly(const ck_Model *model, const ck_Settings *used, double time, double *position,
                         double *velocity) {
    (void)used;
    return ck_truth_form_find("vertical_chain")->at(model, time, position, velocity, NULL) == CK_OK;
}

static bool hang_ode(const ck_Model *model, const ck_Settings *used, double time, double *position, double *velocity) {
    return balances_forces(model, CK_METHOD_SEMI_IMPLICIT_ODE, used) &&
           hang_exactly(model, used, time, position, velocity);
}

static const Theory theories[] = {
    {CK_METHOD_VELOCITY_VERLET, "free_fall", fall_exactly},
    {CK_METHOD_STOERMER_BARS, "free_fall", fall_exactly},
    {CK_METHOD_STOERMER_DIRECT, "free_fall", fall_exactly},
    {CK_METHOD_STOERMER_LINES, "free_fall", fall_exactly},
    {CK_METHOD_XPBD, "free_fall", fall_ahead},
    {CK_METHOD_BULLET_PBD, "free_fall", fall_ahead},
    {CK_METHOD_IMPLICIT_EULER, "free_fall", fall_ahead},
    {CK_METHOD_SYMPLECTIC_EULER, "free_fall", fall_ahead},
    {CK_METHOD_SEMI_IMPLICIT_ODE, "free_fall", fall_ahead},
    {CK_METHOD_VELOCITY_VERLET, "terminal_speed", drag_verlet},
    {CK_METHOD_STOERMER_BARS, "terminal_speed", drag_leapfrog},
    {CK_METHOD_STOERMER_DIRECT, "terminal_speed", drag_leapfrog},
    {CK_METHOD_STOERMER_LINES, "terminal_speed", drag_leapfrog},
    {CK_METHOD_XPBD, "terminal_speed", drag_then_damp},
    {CK_METHOD_BULLET_PBD, "terminal_speed", drag_then_damp},
    {CK_METHOD_IMPLICIT_EULER, "terminal_speed", drag_damp_first},
    {CK_METHOD_SYMPLECTIC_EULER, "terminal_speed", drag_damp_first},
    {CK_METHOD_SEMI_IMPLICIT_ODE, "terminal_speed", drag_then_scale},
    {CK_METHOD_VELOCITY_VERLET, "oscillator", oscillate_verlet},
    {CK_METHOD_STOERMER_LINES, "oscillator", oscillate_line},
    {CK_METHOD_XPBD, "oscillator", oscillate_backward},
    {CK_METHOD_BULLET_PBD, "oscillator", oscillate_bullet_link},
    {CK_METHOD_IMPLICIT_EULER, "oscillator", oscillate_backward},
    {CK_METHOD_SYMPLECTIC_EULER, "oscillator", oscillate_symplectic},
    {CK_METHOD_SEMI_IMPLICIT_ODE, "oscillator", oscillate_backward},
    {CK_METHOD_VELOCITY_VERLET, "vertical_chain", hang_exactly},
    {CK_METHOD_STOERMER_DIRECT, "vertical_chain", hang_direct},
    {CK_METHOD_IMPLICIT_EULER, "vertical_chain", hang_exactly},
    {CK_METHOD_SYMPLECTIC_EULER, "vertical_chain", hang_exactly},
    {CK_METHOD_SEMI_IMPLICIT_ODE, "vertical_chain", hang_ode},
};

// At rest: those that solve a step's forces are exact, the sweeping ones soften.
static bool rest_on_network(const ck_Model *model, const ck_Engine *engine, const ck_Settings *used,
                            const ck_Truth *truth, double *position) {
    ck_Method method = engine->method;
    const double *at_rest = ck_trajectory_position(&truth->reference.trajectory, 0);
    if (ck_prediction_sweeps(method)) return ck_prediction_rest(model, engine, used, at_rest, position);
    if (!balances_forces(model, method, used)) return false;
    memcpy(position, at_rest, 3 * sizeof(double) * (size_t)model->particle_count);
    return true;
}

// A setting that is not the scene's takes the engine out of reach.
static bool left_theory(const ck_Engine *engine, const ck_Settings *used) {
    for (const ck_Setting *row = engine->settings; row && row->name; row++)
        if (row->leaves_theory && ck_settings_has(used, row->slot)) return true;
    return false;
}

static const Theory *find_theory(ck_Method method, const ck_Truth *truth) {
    for (size_t i = 0; truth->form && i < sizeof theories / sizeof *theories; i++)
        if (theories[i].method == method && !strcmp(theories[i].truth, truth->form->name)) return &theories[i];
    return NULL;
}

// What a prediction is of, and where its path goes: into memory that a child shares.
typedef struct Sampling {
    const ck_Model *model;
    const ck_Engine *engine;
    const ck_Settings *used;
    const ck_Truth *truth;
    const Theory *theory; // NULL: of a network at rest
    const ck_Trajectory *path;
    int *frame_count; // 0: theory says nothing after all
} Sampling;

static void sample(void *context) {
    const Sampling *to = context;
    if (!to->theory) {
        *to->frame_count = rest_on_network(to->model, to->engine, to->used, to->truth, to->path->data);
        return;
    }
    const int frames = to->truth->reference.is_static ? 1 : to->model->frame_count + 1;
    for (int frame = 0; frame < frames; frame++)
        if (!to->theory->at(to->model, to->used, frame * to->model->step, ck_trajectory_position(to->path, frame),
                            ck_trajectory_velocity(to->path, frame)))
            return;
    *to->frame_count = frames;
}

ck_Status ck_prediction_create(ck_Reference *prediction, const ck_Model *model, const ck_Engine *engine,
                               const ck_Settings *used, const ck_Truth *truth, const ck_Limits *limits,
                               ck_Error *error) {
    *prediction = (ck_Reference){.is_static = truth->reference.is_static, .horizon = model->frame_count};
    const Theory *theory = find_theory(engine->method, truth);
    bool network = !theory && truth->path_count && truth->form->is_static;
    // no theory knows these
    const unsigned beyond = CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_MOVES |
                            CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_JITTER | CK_TERM_CHANGES |
                            (network ? (unsigned)CK_TERM_COLLIDERS : 0);
    if ((!theory && !network) || left_theory(engine, used) || (model->terms & beyond)) return CK_OK;
    ck_ChildResult child = {.end = CK_CHILD_DONE};
    ck_Status status = ck_trajectory_create(&prediction->trajectory, model, error);
    int *frame_count = status ? NULL : ck_shared_allocate(sizeof *frame_count);
    if (!status && !frame_count) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", model->name);
    if (status) return status;
    Sampling to = {model, engine, used, truth, theory, &prediction->trajectory, frame_count};
    if (limits)
        status = ck_child_run(&child, sample, &to, limits, error);
    else
        sample(&to);
    // one that takes too long is none
    if (!status && child.end == CK_CHILD_DONE) prediction->trajectory.frame_count = *frame_count;
    ck_shared_free(frame_count, sizeof *frame_count);
    return status;
}
