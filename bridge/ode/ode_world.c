// ODE: particles are bodies, springs are double ball joints whose softness (ERP, CFM) is the spring's k and c.
#include "engine.h"
#include "hinges.h"
#include "ode_contact.h"
#include "ode_rigid.h"
#include "ode_translation.h"
#include "path.h"
#include "scaled_model.h"
#include "time_scale.h"
#include "vector.h"
#include "wind.h"

#include <ode/ode.h>
#include <stdlib.h>
#include <string.h>

// Rows that dWorldStep, whose cost grows with their cube, is given at most: 1500 take about 0.1 s a step.
#define DIRECT_MAX_ROWS 1500
// Beyond this speed, in sizes of the body per second, ODE's own assertions would abort the process soon.
#define MAX_SPEED 1e6
// Of contacts, as the least of bars: dWorldStep aborts on redundant constraints without.
#define CONTACT_SOFTNESS 5e-13

typedef struct OdeWorld {
    ck_ScaledModel scaled;
    const ck_Model *model; // of scaled
    dWorldID world;
    dJointGroupID joints;
    dBodyID *bodies; // [particle_count]
    double *outer;   // [3][3*particle_count] places, speeds and forces of hinges and air; NULL without
    ck_OdeContacts *contacts;
    ck_OdeRigid *rigid;
    double dt;     // s, one substep
    uint64_t done; // substeps
    uint32_t substeps;
    bool quick;
    ck_Settings used;
} OdeWorld;

// dInitODE2 and dCloseODE bracket all worlds of the process.
static int world_count;

static const char *version(void) {
    return dGetConfiguration() ? CK_ODE_VERSION " double" : "";
}

// With contact that may be on every particle, of three rows each with friction.
static int row_count(const ck_Model *model) {
    int rows = (3 * ck_model_cloth_count(model) + 24) * model->rigid_count;
    for (int i = 0; i < model->collider_count; i++)
        rows += model->particle_count * (model->colliders[i].friction > 0 ? 3 : 1);
    for (int i = 0; i < model->spring_count; i++)
        rows += !(model->pinned[model->springs[i].a] && model->pinned[model->springs[i].b]);
    return rows;
}

static void destroy(void *state) {
    OdeWorld *ode = state;
    ck_ode_contacts_destroy(ode->contacts);
    ck_ode_rigid_destroy(ode->rigid);
    ck_scaled_model_free(&ode->scaled);
    if (ode->joints) dJointGroupDestroy(ode->joints);
    if (ode->world) dWorldDestroy(ode->world);
    if (--world_count == 0) dCloseODE();
    free(ode->bodies);
    free(ode->outer);
    free(ode);
}

static void add_bodies(OdeWorld *ode) {
    const ck_Model *model = ode->model;
    for (int i = 0; i < model->particle_count; i++) {
        const double *position = model->position + 3 * i, *velocity = model->velocity + 3 * i;
        dBodyID body = dBodyCreate(ode->world);
        ode->bodies[i] = body;
        dBodySetPosition(body, position[0], position[1], position[2]);
        // springs pull at the centre, so that nothing turns and any inertia does
        dMass mass;
        dMassSetSphereTotal(&mass, model->mass[i], 0.5 * model->spacing);
        dBodySetMass(body, &mass);
        dBodySetGyroscopicMode(body, 0);
        dBodySetLinearVel(body, velocity[0], velocity[1], velocity[2]);
        if (model->pinned[i]) dBodySetKinematic(body);
        dBodySetLinearDampingThreshold(body, 0);
        dBodySetLinearDamping(body, model->pinned[i] ? 0 : model->drag * ode->dt);
    }
}

static void set_joint(const OdeWorld *ode, dJointID joint, const ck_Spring *spring) {
    dJointSetDBallParam(joint, dParamERP, ck_ode_error_reduction(spring, ode->dt, &ode->used));
    dJointSetDBallParam(joint, dParamCFM,
                        ck_ode_constraint_force_mixing(ode->model, spring, ode->dt, &ode->used, ode->scaled.mass));
}

static void add_joint(OdeWorld *ode, const ck_Spring *spring) {
    dJointID joint = dJointCreateDBall(ode->world, ode->joints);
    dJointAttach(joint, ode->bodies[spring->a], ode->bodies[spring->b]);
    // after attaching, which takes the current length for the rest length
    dJointSetDBallDistance(joint, spring->rest);
    set_joint(ode, joint, spring);
    dJointSetData(joint, (void *)spring);
}

// Springs between two pins do nothing, until one of them is let go.
static void release(void *state, int particle) {
    OdeWorld *ode = state;
    dBodyID body = ode->bodies[particle];
    for (int i = 0; i < ode->model->spring_count; i++) {
        const ck_Spring *spring = &ode->model->springs[i];
        if (spring->a != particle && spring->b != particle) continue;
        if (dBodyIsKinematic(ode->bodies[spring->a]) && dBodyIsKinematic(ode->bodies[spring->b]))
            add_joint(ode, spring);
    }
    dBodySetDynamic(body);
    dBodySetLinearDamping(body, ode->model->drag * ode->dt);
}

static ck_Status build(void **state, const ck_Model *scene, const ck_Settings *used, bool quick, ck_Error *error) {
    OdeWorld *ode = calloc(1, sizeof *ode);
    if (!ode) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *ode = (OdeWorld){.dt = scene->step / used->substeps, .substeps = used->substeps, .quick = quick, .used = *used};
    ck_Status scaled = ck_scaled_model_create(&ode->scaled, scene);
    const ck_Model *model = ode->model = &ode->scaled.model;
    if (world_count++ == 0) dInitODE2(0);
    ode->bodies = calloc((size_t)model->particle_count, sizeof *ode->bodies);
    const bool has_outer = model->terms & (CK_TERM_BENDING | CK_TERM_WIND);
    if (has_outer) ode->outer = calloc(9 * (size_t)model->particle_count, sizeof(double));
    if (ode->bodies && !scaled && !ode->outer == !has_outer) ode->world = dWorldCreate();
    if (ode->world) ode->joints = dJointGroupCreate(0);
    ck_Status status = ode->joints ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = ck_ode_contacts_create(&ode->contacts, model, ode->dt, error);
    if (!status) status = ck_ode_rigid_create(&ode->rigid, model, ode->dt, error);
    if (status) {
        destroy(ode);
        return status;
    }
    dWorldSetGravity(ode->world, model->gravity[0], model->gravity[1], model->gravity[2]);
    dWorldSetAutoDisableFlag(ode->world, 0);
    // that of contacts, whose default of 1e-10 is what this is for particles of 5 g
    dWorldSetCFM(ode->world, CONTACT_SOFTNESS * ck_stability_lightness(model));
    if (quick) dWorldSetQuickStepNumIterations(ode->world, (int)used->iterations);
    if (quick) dWorldSetQuickStepW(ode->world, used->relaxation);
    add_bodies(ode);
    ck_ode_rigid_shape(model, ode->bodies);
    for (int i = 0; i < model->spring_count; i++)
        if (!(model->pinned[model->springs[i].a] && model->pinned[model->springs[i].b]))
            add_joint(ode, &model->springs[i]);
    *state = ode;
    return CK_OK;
}

static ck_Status create_quick(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                              ck_Ledger *ledger, ck_Error *error) {
    ck_ode_translate(model, wanted, used, ledger, true);
    return build(state, model, used, true, error);
}

static ck_Status create_direct(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                               ck_Ledger *ledger, ck_Error *error) {
    ck_ode_translate(model, wanted, used, ledger, false);
    int rows = row_count(model);
    if (rows > DIRECT_MAX_ROWS)
        return ck_fail(
            error, CK_REFUSED,
            "dWorldStep's cost grows with the cube of its rows: this scene has %d, the most taken is %d; use ode-quick",
            rows, DIRECT_MAX_ROWS);
    return build(state, model, used, false, error);
}

// NaN or a runaway speed would abort the process inside ODE
static bool is_safe(const OdeWorld *ode) {
    for (int i = 0; i < ode->model->particle_count; i++) {
        const dReal *position = dBodyGetPosition(ode->bodies[i]), *velocity = dBodyGetLinearVel(ode->bodies[i]);
        if (!(ck_length(velocity) < MAX_SPEED * ode->model->size) || !isfinite(ck_dot(position, position)))
            return false;
    }
    return true;
}

// Adds the forces of hinges and air.
static void add_outer(OdeWorld *ode) {
    const size_t count = 3 * (size_t)ode->model->particle_count;
    double *position = ode->outer, *velocity = position + count, *force = velocity + count;
    for (size_t i = 0; i < count; i++) {
        position[i] = dBodyGetPosition(ode->bodies[i / 3])[i % 3];
        velocity[i] = dBodyGetLinearVel(ode->bodies[i / 3])[i % 3];
        force[i] = 0;
    }
    ck_hinges_add_force(ode->model, position, 1, NULL, force);
    ck_wind_add_force(ode->model, position, velocity, NULL, force);
    for (size_t i = 0; i < count; i += 3)
        if (!dBodyIsKinematic(ode->bodies[i / 3]))
            dBodyAddForce(ode->bodies[i / 3], force[i], force[i + 1], force[i + 2]);
}

// ODE moves a kinematic body by the speed that it is given.
static void drive(OdeWorld *ode) {
    const double end = (double)++ode->done * ode->dt;
    for (int i = 0; i < ode->model->driven_count; i++) {
        const ck_Driven *driven = &ode->model->driven[i];
        const dBodyID body = ode->bodies[driven->particle];
        double at[3];
        if (!ck_driven_holds(ode->model, driven, end)) continue;
        ck_driven_at(driven, end, at);
        ck_add_scaled(at, -1, dBodyGetPosition(body));
        dBodySetLinearVel(body, at[0] / ode->dt, at[1] / ode->dt, at[2] / ode->dt);
    }
}

static ck_StepResult step(void *state) {
    OdeWorld *ode = state;
    const double *force = ode->model->force;
    if (ode->contacts) memset(ode->contacts->impulse, 0, sizeof ode->contacts->impulse);
    for (uint32_t i = 0; i < ode->substeps; i++) {
        if (!is_safe(ode)) return CK_STEP_DIVERGED;
        for (int j = 0; j < ode->model->particle_count && (ode->model->terms & CK_TERM_FORCE); j++)
            if (!dBodyIsKinematic(ode->bodies[j])) dBodyAddForce(ode->bodies[j], force[0], force[1], force[2]);
        drive(ode);
        if (ode->outer) add_outer(ode);
        if (ode->contacts)
            ck_ode_contacts_add(ode->contacts, ode->world, ode->bodies, ((double)ode->done - 1) * ode->dt);
        if (ode->rigid) ck_ode_rigid_add(ode->rigid, ode->world, ode->bodies, ode->contacts);
        // QuickStep shuffles its rows from a seed that is global to the process
        dRandSetSeed(1);
        int done = ode->quick ? dWorldQuickStep(ode->world, ode->dt) : dWorldStep(ode->world, ode->dt);
        if (!done) return CK_STEP_NO_MEMORY;
        if (ode->rigid) ck_ode_rigid_remove(ode->rigid, ode->contacts);
        if (ode->contacts) ck_ode_contacts_remove(ode->contacts);
    }
    return is_safe(ode) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

// The springs' softness, drag and contact go by the substep.
static void pace(void *state, double duration) {
    OdeWorld *ode = state;
    ode->dt = duration / ode->substeps;
    if (ode->contacts) ode->contacts->h = ode->dt;
    if (ode->rigid) ode->rigid->h = ode->dt;
    for (int i = 0; i < ode->model->particle_count; i++) {
        const dBodyID body = ode->bodies[i];
        if (!dBodyIsKinematic(body)) dBodySetLinearDamping(body, ode->model->drag * ode->dt);
        for (int k = 0; k < dBodyGetNumJoints(body); k++) {
            const ck_Spring *spring = dJointGetData(dBodyGetJoint(body, k));
            // each once: from its first end
            if (spring && spring->a == i) set_joint(ode, dBodyGetJoint(body, k), spring);
        }
    }
}

static void read_state(const void *state, double *position, double *velocity) {
    const OdeWorld *ode = state;
    for (int i = 0; i < ode->model->particle_count; i++)
        for (int axis = 0; axis < 3; axis++) {
            position[3 * i + axis] = ode->scaled.length * dBodyGetPosition(ode->bodies[i])[axis];
            velocity[3 * i + axis] = ode->scaled.length * dBodyGetLinearVel(ode->bodies[i])[axis];
        }
}

static void read_contact(const void *state, double *force) {
    const OdeWorld *ode = state;
    double unit = ode->scaled.mass * ode->scaled.length;
    for (int axis = 0; axis < 3; axis++)
        force[axis] = ode->contacts ? unit * ode->contacts->impulse[axis] / ode->model->step : 0;
}

static void read_turn(const void *state, ck_Turn *turn) {
    const OdeWorld *ode = state;
    ck_ode_rigid_turns(ode->model, ode->bodies, turn);
}

extern const char ck_code_ode[];

static ck_Status code(ck_Code *code, const ck_ScaledModel *scaled, const ck_Settings *used, bool is_quick) {
    const ck_Model *model = &scaled->model;
    code->text = ck_code_ode;
    code->extension = "c";
    ck_code_number(code, "contact_cfm", CONTACT_SOFTNESS * ck_stability_lightness(model));
    ck_code_number(code, "push_speed", ck_ode_push_speed(model));
    ck_code_number(code, "body_radius", 0.5 * model->spacing);
    ck_code_number(code, "sor", used->relaxation);
    ck_code_number(code, "erp_set", used->own[CK_ODE_ERP]);
    ck_code_number(code, "cfm_set", used->own[CK_ODE_CFM] * scaled->mass);
    ck_code_part(code, "erp", ck_settings_has(used, CK_OWN + CK_ODE_ERP));
    ck_code_part(code, "cfm", ck_settings_has(used, CK_OWN + CK_ODE_CFM));
    ck_code_part(code, "quick", is_quick);
    return CK_OK;
}

static ck_Status code_quick(ck_Code *out, const ck_ScaledModel *scaled, const ck_Settings *used, ck_Error *error) {
    (void)error;
    return code(out, scaled, used, true);
}

static ck_Status code_direct(ck_Code *out, const ck_ScaledModel *scaled, const ck_Settings *used, ck_Error *error) {
    (void)error;
    return code(out, scaled, used, false);
}

#define ODE_TERMS                                                                                                      \
    (CK_TERM_SPRINGS | CK_TERM_RIGID | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG |              \
     CK_TERM_VELOCITY | CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_MOVES |         \
     CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_JITTER)

static const ck_Setting quick_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "tension across springs, stiffness, drag, at most 1/120 s",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "50",
     .help = "dWorldSetQuickStepNumIterations: sweeps over rows a substep"},
    {.name = "sor",
     .slot = CK_RELAXATION,
     .least = 0.01,
     .most = 2,
     .unit = "1",
     .rule = "1.3",
     .help = "dWorldSetQuickStepW: over-relaxation of a sweep",
     .also = "relaxation"},
    {.name = "erp",
     .slot = CK_OWN + CK_ODE_ERP,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "h*k/(h*k + c)",
     .help = "dParamERP of every spring's joint",
     .leaves_theory = true},
    {.name = "cfm",
     .slot = CK_OWN + CK_ODE_CFM,
     .least = 0,
     .most = 1e6,
     .unit = "1/kg",
     .rule = "1/(h*k + c)",
     .help = "dParamCFM of every spring's joint",
     .leaves_theory = true},
    {0},
};

static const ck_Setting direct_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "tension across springs, drag, at most 1/120 s",
     .help = "steps a frame"},
    {.name = "erp",
     .slot = CK_OWN + CK_ODE_ERP,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "h*k/(h*k + c)",
     .help = "dParamERP of every spring's joint",
     .leaves_theory = true},
    {.name = "cfm",
     .slot = CK_OWN + CK_ODE_CFM,
     .least = 0,
     .most = 1e6,
     .unit = "1/kg",
     .rule = "1/(h*k + c)",
     .help = "dParamCFM of every spring's joint",
     .leaves_theory = true},
    {0},
};

const ck_Engine ck_ode_quick = {
    .name = "ode-quick",
    .about = "dWorldQuickStep: springs as soft constraints, projected Gauss-Seidel",
    .family = "ODE",
    .version = version,
    .method = CK_METHOD_SEMI_IMPLICIT_ODE,
    .terms = ODE_TERMS,
    .settings = quick_settings,
    .order = 1,
    .create = create_quick,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = read_contact,
    .turn = read_turn,
    .destroy = destroy,
    .code = code_quick,
};

const ck_Engine ck_ode_direct = {
    .name = "ode-direct",
    .about = "dWorldStep: springs as soft constraints, solved exactly",
    .family = "ODE",
    .version = version,
    .method = CK_METHOD_SEMI_IMPLICIT_ODE,
    .terms = ODE_TERMS,
    .settings = direct_settings,
    .order = 1,
    .create = create_direct,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = read_contact,
    .turn = read_turn,
    .destroy = destroy,
    .code = code_direct,
};
