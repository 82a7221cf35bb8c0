// Damped springs stepped by velocity Verlet with predicted velocity: the accuracy workhorse.
#include "engine.h"
#include "explicit.h"
#include "hinges.h"
#include "native.h"
#include "path.h"
#include "time_scale.h"
#include "vector.h"
#include "verlet_contact.h"
#include "verlet_pace.h"
#include "wind.h"

#include <stdlib.h>
#include <string.h>

// Acceleration of all particles from springs, hinges, air, field and drag, [3*n] m/s², where they are with the velocity
// that is predicted. Cost: one pass over springs, one over particles. Cannot fail.
static void accelerate(const ck_Native *native, double *acceleration) {
    const ck_Model *model = native->model;
    const double *velocity = native->other_velocity;
    ck_explicit_pull(native->springs, native->position, velocity, acceleration);
    if (model->hinge_count) ck_hinges_add_force(model, native->position, 1, native->inverse_mass, acceleration);
    if (model->wind.face_count)
        ck_wind_add_force(model, native->position, velocity, native->inverse_mass, acceleration);
}

// Where a pin's speed jumps between two substeps, dampers pull otherwise from then on: so the order stays two.
static void follow_jump(ck_Native *native) {
    const ck_Model *model = native->model;
    const double time = ck_native_time(native);
    if (!model->driven_count || !(model->terms & (CK_TERM_DAMPING | CK_TERM_WIND)) || !ck_driven_jump(model, time))
        return;
    memcpy(native->other_velocity, native->velocity, 3 * sizeof(double) * (size_t)model->particle_count);
    ck_driven_place(model, time, 1, native->position, native->other_velocity);
    accelerate(native, native->acceleration);
}

// The first half of a particle's substep where nothing is in its way.
static void fly(ck_Native *native, int particle) {
    const double dt = native->dt, *acceleration = native->acceleration + 3 * particle;
    double *v = native->velocity + 3 * particle, *predicted = native->other_velocity + 3 * particle;
    ck_add_scaled(native->position + 3 * particle, dt, v);
    ck_add_scaled(native->position + 3 * particle, 0.5 * dt * dt, acceleration);
    memcpy(predicted, v, 3 * sizeof *v);
    ck_add_scaled(predicted, dt, acceleration);
    ck_add_scaled(v, 0.5 * dt, acceleration);
}

// What bodies hold has no velocity into them, which dampers would see.
static void foresee(ck_Native *native) {
    for (int i = 0; i < 3 * native->model->particle_count && native->rigid; i++)
        native->other_velocity[i] += native->rigid->held[i];
}

static void speeds(const ck_Native *native, int particle, double *drift, double *now) {
    (void)now; // is the velocity
    ck_add_scaled(drift, 0.5 * native->dt, native->acceleration + 3 * particle);
}

// As substep, where every particle's motion under its acceleration is followed through contact: what is left of both
// accelerations, by the state at the end, makes the correction.
static void substep_with_contact(ck_Native *native) {
    double *x = native->position, *v = native->velocity, *predicted = native->other_velocity, left[3];
    const int cloth = ck_model_cloth_count(native->model);
    if (native->contact->motion) ck_contact_follow(native->contact, ck_native_time(native));
    native->contact->elapsed = native->dt;
    for (int i = 0; i < native->model->particle_count; i++) {
        double *a = native->acceleration + 3 * i;
        if (native->inverse_mass[i] == 0) continue;
        if (i >= cloth) {
            fly(native, i);
            continue;
        }
        ck_contact_advance(native->contact, native->model->mass[i], x + 3 * i, v + 3 * i, a);
        memcpy(predicted + 3 * i, v + 3 * i, 3 * sizeof(double));
        ck_contact_filter(native->contact, x + 3 * i, v + 3 * i, a, left);
        ck_add_scaled(v + 3 * i, -0.5 * native->dt, left);
    }
    ck_native_drive(native);
    ck_native_drive_speed(native);
    foresee(native);
    accelerate(native, native->acceleration);
    for (int i = 0; i < native->model->particle_count; i++) {
        if (native->inverse_mass[i] == 0) continue;
        if (i < cloth)
            ck_contact_filter(native->contact, x + 3 * i, predicted + 3 * i, native->acceleration + 3 * i, left);
        else
            memcpy(left, native->acceleration + 3 * i, sizeof left);
        ck_add_scaled(v + 3 * i, 0.5 * native->dt, left);
    }
    follow_jump(native);
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt;  a' = a(x, v*);  v ← v + (a + a')·dt/2
// With the velocity predicted, damping keeps the second order; with last step's velocity it would be first.
// Source: Groot and Warren 1997, eq. 10 with λ = 1.
static void substep(ck_Native *native) {
    if (native->contact) {
        substep_with_contact(native);
        return;
    }
    const double dt = native->dt;
    const int count = 3 * native->model->particle_count;
    double *position = native->position, *velocity = native->velocity, *predicted = native->other_velocity;
    double *acceleration = native->acceleration;
    for (int i = 0; i < count; i++) {
        position[i] += dt * velocity[i] + 0.5 * dt * dt * acceleration[i];
        predicted[i] = velocity[i] + dt * acceleration[i];
        velocity[i] += 0.5 * dt * acceleration[i];
    }
    ck_native_drive(native);
    ck_native_drive_speed(native);
    foresee(native);
    accelerate(native, acceleration);
    for (int i = 0; i < count; i++) velocity[i] += 0.5 * dt * acceleration[i];
    follow_jump(native);
}

// The same among rigid bodies. At its end no velocity is left into what is touched.
static void substep_with_bodies(ck_Native *native) {
    ck_native_meet(native, speeds);
    substep(native);
    ck_rigid_contact_settle(native->rigid, native, ck_native_time(native));
}

// Time step: half of the stability bound, so that a cloth that folds (up to √2 in ω) stays inside;
// and a quarter of the time in which drag takes a speed.
static ck_Status translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    double frequency;
    ck_Status status = ck_stability_frequency(model, &frequency);
    if (status) return status;
    double damping = frequency * frequency * ck_stability_damping_time(model) + model->drag;
    double limit = ck_stability_drag_time(model, 0.25);
    if (frequency > 0) limit = fmin(limit, 0.5 * ck_stability_verlet_limit(frequency, damping));
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : ck_stability_substeps(model, limit),
                          .threads = wanted->threads};
    ck_settings_take_own(used, wanted);
    ck_own_ledger(ledger, model, used, "force -drag*m*v, v predicted", CK_EXACT);
    ck_own_ledger_springs(ledger, model, "stiffness", "k", CK_EXACT);
    ck_ledger_add_wind(ledger, model, "acceleration", "by face, with v predicted", CK_EXACT);
    ck_ledger_add_bending(ledger, model, "stiffness", "s at rows and edges, 2*s at twisted squares", CK_EXACT);
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "damping",
                                             model->springs[0].damping, "c along the spring", CK_EXACT});
    return CK_OK;
}

// Where nothing but springs, field, drag and colliders move the body, its state is the kernel's and native holds it at
// the end of a frame; else native steps it and has the springs' part from there.
typedef struct Verlet {
    ck_Native *native;
    ck_VerletContact *contact; // of a body in the kernel; NULL without colliders
    ck_VerletPace *pace;       // NULL: all steps are alike
    double duration;           // s, of a frame
    bool is_whole;             // all of it is the kernel's
} Verlet;

static void destroy(void *state) {
    Verlet *verlet = state;
    ck_verlet_contact_destroy(verlet->contact);
    ck_verlet_pace_destroy(verlet->pace);
    ck_native_destroy(verlet->native);
    free(verlet);
}

static ck_ExplicitSetup setup_of(const ck_Native *native) {
    return (ck_ExplicitSetup){ck_native_loops(native), native->model,    native->dt,
                              native->position,        native->velocity, native->inverse_mass};
}

// The first acceleration belongs to the start, or the first step would lose half a dt of it.
static void start(Verlet *verlet) {
    ck_Native *native = verlet->native;
    memcpy(native->other_velocity, native->velocity, 3 * sizeof(double) * (size_t)native->model->particle_count);
    if (!verlet->is_whole) accelerate(native, native->acceleration);
}

static ck_Status lay_out(Verlet *verlet, ck_Error *error) {
    ck_Native *native = verlet->native;
    const ck_ExplicitSetup setup = setup_of(native);
    verlet->is_whole = ck_only_springs_act(native->model);
    ck_Status status = verlet->is_whole ? ck_explicit_create(&native->springs, &setup, error)
                                        : ck_explicit_create_list(&native->springs, &setup, error);
    if (!status && verlet->is_whole) status = ck_verlet_contact_create(&verlet->contact, native, error);
    if (!status) start(verlet);
    return status;
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    ck_RowSprings springs;
    ck_Status status = translate(model, wanted, used, ledger);
    if (status) return ck_fail(error, status, "out of memory");
    status = ck_native_check_precision(used, ck_rows_fit(model, &springs), error);
    if (status) return status;
    if (ck_settings_own(used, CK_NATIVE_SINGLE, 0) > 0 && ck_settings_own(used, CK_NATIVE_TOLERANCE, 0) > 0)
        return ck_fail(error, CK_REFUSED, "steps adapt in double precision only: set 'tolerance' or 'single'");
    Verlet *verlet = calloc(1, sizeof *verlet);
    if (!verlet) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    status = ck_native_create(&verlet->native, model, used, error);
    if (!status) status = lay_out(verlet, error);
    if (!status) status = ck_verlet_pace_create(&verlet->pace, verlet->native, error);
    verlet->duration = model->step;
    if (status)
        destroy(verlet);
    else
        *state = verlet;
    return status;
}

static void release(void *state, int particle) {
    Verlet *verlet = state;
    ck_native_release(verlet->native, particle);
    const ck_ExplicitSetup setup = setup_of(verlet->native);
    ck_explicit_place(verlet->native->springs, &setup);
    start(verlet);
}

static void advance(const Verlet *verlet, uint32_t substeps) {
    ck_Native *native = verlet->native;
    void (*const alone)(ck_Native *) = native->rigid ? substep_with_bodies : substep;
    if (verlet->is_whole && !native->contact)
        ck_explicit_step(native->springs, substeps, native->waves);
    else if (verlet->is_whole)
        ck_verlet_contact_step(verlet->contact, native, native->springs, substeps);
    else
        for (uint32_t i = 0; i < substeps; i++) alone(native);
}

static void set_step(const Verlet *verlet, double dt) {
    ck_native_set_step(verlet->native, dt);
    const ck_ExplicitSetup setup = setup_of(verlet->native);
    if (verlet->is_whole) ck_explicit_pace(verlet->native->springs, &setup);
}

static const double *accelerations(const Verlet *verlet, size_t *count) {
    if (verlet->is_whole) return ck_explicit_acceleration(verlet->native->springs, count);
    *count = 3 * (size_t)verlet->native->model->particle_count;
    return verlet->native->acceleration;
}

// A frame in steps that adapt. Without memory for the look they stay as they are.
static void advance_adaptively(const Verlet *verlet) {
    double left = verlet->duration, dt;
    ck_verlet_pace_look(verlet->pace, verlet->native);
    while (left > 1e-9 * verlet->duration) {
        size_t count;
        const uint32_t together = ck_verlet_pace_next(verlet->pace, left, &dt);
        set_step(verlet, dt);
        advance(verlet, together - 1);
        const double *a = accelerations(verlet, &count);
        ck_verlet_pace_before(verlet->pace, a, count);
        advance(verlet, 1);
        ck_verlet_pace_after(verlet->pace, dt, a, count);
        left -= together * dt;
        if (verlet->is_whole)
            ck_explicit_read(verlet->native->springs, verlet->native->position, verlet->native->velocity);
        if (!ck_native_is_finite(verlet->native)) return;
    }
}

static ck_StepResult step(void *state) {
    const Verlet *verlet = state;
    ck_Native *native = verlet->native;
    ck_native_start_frame(native);
    if (verlet->pace)
        advance_adaptively(verlet);
    else
        advance(verlet, native->substeps);
    if (verlet->is_whole) ck_explicit_read(native->springs, native->position, native->velocity);
    return ck_native_is_finite(native) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static const char *remark(const void *state) {
    ck_VerletPace *pace = ((const Verlet *)state)->pace;
    return pace ? ck_verlet_pace_tell(pace) : NULL;
}

static void read_state(const void *state, double *position, double *velocity) {
    ck_native_read(((const Verlet *)state)->native, position, velocity);
}

static void pace(void *state, double duration) {
    Verlet *verlet = state;
    verlet->duration = duration;
    if (!verlet->pace) ck_native_pace(verlet->native, duration);
}

static void read_turn(const void *state, ck_Turn *turn) {
    ck_native_turn(((const Verlet *)state)->native, turn);
}

static void read_contact(const void *state, double *force) {
    ck_native_contact(((const Verlet *)state)->native, force);
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "half of the largest stable step",
     .help = "steps a frame"},
    {.name = "threads",
     .slot = CK_THREADS,
     .is_whole = true,
     .least = 1,
     .most = 64,
     .unit = "1",
     .rule = "1",
     .help = "threads that share a step, where nothing but springs, field and drag act"},
    CK_NATIVE_VECTORS_ROW,
    {.name = "tolerance",
     .slot = CK_OWN + CK_NATIVE_TOLERANCE,
     .least = 1e-12,
     .most = 1,
     .unit = "1/s",
     .rule = "none: all substeps are alike",
     .help = "error a second, over the size, that a substep may make; substeps then follow it and what is stable",
     .leaves_theory = true},
    CK_NATIVE_SINGLE_ROW,
    {0},
};

const ck_Engine ck_native_verlet = {
    .name = "native-verlet",
    .about = "damped springs, velocity Verlet with predicted velocity",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_VELOCITY_VERLET,
    .terms = CK_NATIVE_TERMS | CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_BODIES,
    .settings = settings,
    .order = 2,
    .create = create,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = read_contact,
    .turn = read_turn,
    .remark = remark,
    .destroy = destroy,
};

// As narrow as the packages of the peers are built: two doubles an instruction. It says how much of a lead is width.
static ck_Status create_narrow(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                               ck_Ledger *ledger, ck_Error *error) {
    ck_RowSprings springs;
    if (!ck_rows_fit(model, &springs))
        return ck_fail(error, CK_REFUSED,
                       "is native-verlet but for the width of its vectors, which is measured on regular cloths");
    ck_Settings narrow = *wanted;
    ck_settings_set(&narrow, CK_OWN + CK_NATIVE_VECTORS, 2);
    return create(state, model, &narrow, used, ledger, error);
}

static const ck_Setting narrow_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "half of the largest stable step",
     .help = "steps a frame"},
    {.name = "threads",
     .slot = CK_THREADS,
     .is_whole = true,
     .least = 1,
     .most = 64,
     .unit = "1",
     .rule = "1",
     .help = "threads that share a step, where nothing but springs, field and drag act"},
    {0},
};

const ck_Engine ck_native_narrow = {
    .name = "native-narrow",
    .about = "native-verlet with two doubles an instruction, as the packages of its peers are built",
    .family = "native",
    .version = ck_own_version,
    .method = CK_METHOD_VELOCITY_VERLET,
    .terms = CK_NATIVE_TERMS & ~(unsigned)CK_TERM_JITTER,
    .settings = narrow_settings,
    .order = 2,
    .create = create_narrow,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = read_contact,
    .destroy = destroy,
};
