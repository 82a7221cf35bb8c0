// MuJoCo: a particle is a body with three slide joints, a spring a spatial tendon, a pin a site of the world.
#include "engine.h"
#include "hinges.h"
#include "mujoco_xml.h"
#include "path.h"
#include "rigid.h"
#include "scaled_model.h"
#include "time_scale.h"
#include "vector.h"
#include "wind.h"

#include <math.h>
#include <mujoco/mujoco.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Its own settings, by their numbers.
enum { OWN_INTEGRATOR };

extern const char ck_code_mujoco[];

// What some 2 GiB hold.
#define MOST_NUMBERS 1e8

static const char *const integrators[] = {"Euler", "implicit", "RK4"};

typedef struct MujocoWorld {
    ck_ScaledModel scaled;     // its pins are let go there
    const ck_RigidBody *rigid; // of the scene: how they are turned at the start
    ck_Settings used;
    mjModel *model;
    mjData *data;
    uint64_t done; // substeps
    int *body;     // [particle_count] of each particle; 0, the world, where it is pinned and stays
    double *outer; // [3][3*particle_count] places, speeds and forces of hinges and air; NULL without
} MujocoWorld;

static const char *version(void) {
    static char text[40];
    snprintf(text, sizeof text, "%s double", mj_versionString());
    return text;
}

// MuJoCo's own would ask for a key and write into the user's folder.
static void fail_fatally(const char *message) {
    fprintf(stderr, "MuJoCo: %s\n", message);
    _exit(1);
}

static void ignore(const char *message) {
    (void)message;
}

static int integrator_of(const ck_Settings *used) {
    return (int)ck_settings_own(used, OWN_INTEGRATOR, 0);
}

// Time step: springs are explicit forces, stable to 2/ω; half of that, so that a cloth that folds stays inside, and the
// same of damping; drag, implicit, a tenth of its time; in contact 1/1000 s, and an impact with restitution is over
// within a quarter of a frame, or it would be seen half done.
static ck_Status translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    double frequency = 0, limit = 1.0 / 240;
    *used = (ck_Settings){.substeps = wanted->substeps};
    ck_settings_take_own(used, wanted);
    ck_Status status = ck_stability_frequency(model, &frequency);
    if (status) return status;
    if (frequency > 0) limit = fmin(limit, 1 / frequency);
    limit = fmin(limit, 1 / ck_stability_damping_rate(model));
    limit = fmin(limit, ck_stability_drag_time(model, 0.1));
    if (model->collider_count || model->rigid_count) limit = fmin(limit, 1.0 / 1000);
    for (int i = 0; i < model->rigid_count; i++)
        if (model->rigid[i].shape.restitution > 0) limit = fmin(limit, model->step / (4 * CK_MUJOCO_BOUNCE_STEPS));
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].restitution > 0) limit = fmin(limit, model->step / (4 * CK_MUJOCO_BOUNCE_STEPS));
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    ck_scaled_model_ledger(ledger, model);
    ck_ledger_add(ledger, (ck_LedgerRow){"time step", model->step, "s", "option/timestep", model->step / used->substeps,
                                         "step / substeps", CK_EXACT});
    ck_ledger_add_masses(ledger, model,
                         (ck_LedgerRow){.unit = "kg",
                                        .native_parameter = "inertial/mass",
                                        .formula = "m; a site of the world where pinned",
                                        .match = CK_EXACT},
                         false);
    if (model->terms & CK_TERM_GRAVITY)
        ck_ledger_add(ledger, (ck_LedgerRow){"gravity", ck_length(model->gravity), "m/s2", "option/gravity",
                                             ck_length(model->gravity), "g", CK_EXACT});
    if (model->terms & CK_TERM_FORCE)
        ck_ledger_add(ledger, (ck_LedgerRow){"force", ck_length(model->force), "N", "xfrc_applied",
                                             ck_length(model->force), "F on each body", CK_EXACT});
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, kind);
        if (spring)
            ck_ledger_add(ledger, (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m",
                                                 "spatial/stiffness", spring->stiffness, "k", CK_EXACT});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "spatial/damping",
                                             model->springs[0].damping, "c", CK_EXACT});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger, (ck_LedgerRow){"drag", model->drag, "1/s", "joint/damping", model->drag,
                                             "drag*m of each slide joint", CK_EXACT});
    ck_ledger_add_wind(ledger, model, "xfrc_applied", "by face, before each step", CK_APPROXIMATE);
    ck_ledger_add_bending(ledger, model, "xfrc_applied", "each hinge's force before each step: explicit",
                          CK_APPROXIMATE);
    ck_ledger_add_colliders(
        ledger, model,
        (ck_LedgerRow){"restitution", 0, "1", "solref", 0,
                       "-k, -b: e = exp(-2*z*acos(z)/sqrt(1 - z^2)), z = b/(2*sqrt(k))", CK_APPROXIMATE},
        (ck_LedgerRow){"friction", 0, "1", "geom/friction", 0, "mu, an elliptic cone; it creeps", CK_APPROXIMATE});
    return CK_OK;
}

static void unload(MujocoWorld *world) {
    if (world->data) mj_deleteData(world->data);
    if (world->model) mj_deleteModel(world->model);
    world->data = NULL;
    world->model = NULL;
}

static void destroy(void *state) {
    MujocoWorld *world = state;
    unload(world);
    ck_scaled_model_free(&world->scaled);
    free(world->body);
    free(world->outer);
    free(world);
}

// MuJoCo reads its own kind of files in memory, of which there are many: 2 MB of names.
static mjModel *compile(const char *text, size_t length, char *reason, int size) {
    mjVFS *files = malloc(sizeof *files);
    mjModel *model = NULL;
    if (!files) return NULL;
    mj_defaultVFS(files);
    if (!mj_makeEmptyFileVFS(files, "scene.xml", (int)length)) {
        memcpy(files->filedata[mj_findFileVFS(files, "scene.xml")], text, length);
        model = mj_loadXML("scene.xml", files, reason, size);
    }
    mj_deleteVFS(files);
    free(files);
    return model;
}

// Compiles the scaled model as it is now, and sets its state.
static ck_Status load(MujocoWorld *world, ck_Error *error) {
    const ck_Model *model = &world->scaled.model;
    const ck_MujocoOptions options = {model->step / world->used.substeps, integrators[integrator_of(&world->used)],
                                      ck_mujoco_radius(model), 0};
    size_t length;
    char reason[300] = "", *text = ck_mujoco_xml(model, &options, &length);
    if (!text) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    unload(world);
    world->model = compile(text, length, reason, sizeof reason);
    free(text);
    if (!world->model) return ck_fail(error, CK_REFUSED, "MuJoCo: %s", reason);
    world->data = mj_makeData(world->model);
    if (!world->data) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < model->particle_count; i++) {
        char name[20];
        snprintf(name, sizeof name, "b%d", i);
        const bool stays = model->pinned[i] && !ck_driven_find(model, i, 0);
        world->body[i] = stays ? 0 : mj_name2id(world->model, mjOBJ_BODY, name);
        if (!world->body[i]) continue;
        const int joint = world->model->body_dofadr[world->body[i]];
        for (int axis = 0; axis < 3; axis++) {
            world->data->qvel[joint + axis] = model->velocity[3 * i + axis];
            world->data->xfrc_applied[6 * world->body[i] + axis] = model->force[axis];
        }
    }
    for (int i = 0; i < model->rigid_count; i++) // about the body's own axes, which at first are the world's
        memcpy(world->data->qvel + world->model->body_dofadr[world->body[model->rigid[i].particle]] + 3,
               model->rigid[i].spin, sizeof model->rigid[i].spin);
    return CK_OK;
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    mju_user_error = fail_fatally;
    mju_user_warning = ignore;
    ck_Status status = translate(model, wanted, used, ledger);
    if (status) return ck_fail(error, status, "out of memory");
    // it keeps each tendon's pull on each joint, and counts in 32 bits
    for (int i = 0; i < model->collider_count; i++)
        if (model->colliders[i].path && model->colliders[i].shape == CK_PLANE)
            return ck_fail(error, CK_REFUSED, "MuJoCo's planes belong to the world: they do not move");
    double numbers = 3.0 * model->spring_count * model->particle_count;
    if (numbers > MOST_NUMBERS)
        return ck_fail(error, CK_REFUSED,
                       "MuJoCo keeps springs x 3 x particles numbers: this scene's are %.3g, the most taken %g",
                       numbers, MOST_NUMBERS);
    MujocoWorld *world = calloc(1, sizeof *world);
    if (!world) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    world->used = *used;
    world->rigid = model->rigid;
    world->body = calloc((size_t)model->particle_count, sizeof *world->body);
    const bool has_outer = model->terms & (CK_TERM_BENDING | CK_TERM_WIND);
    if (has_outer) world->outer = calloc(9 * (size_t)model->particle_count, sizeof(double));
    status = ck_scaled_model_create(&world->scaled, model);
    if (status || !world->body || !world->outer != !has_outer)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    else
        status = load(world, error);
    if (status) {
        destroy(world);
        return status;
    }
    *state = world;
    return CK_OK;
}

static bool has_left(const mjData *data) {
    return data->warning[mjWARN_BADQPOS].number || data->warning[mjWARN_BADQVEL].number ||
           data->warning[mjWARN_BADQACC].number;
}

// Where a body's place is among all: a turn takes one number more than a spin.
static int place_of(const MujocoWorld *world, int body) {
    return world->model->jnt_qposadr[world->model->body_jntadr[body]];
}

static void read_units(const MujocoWorld *world, double *position, double *velocity, double unit) {
    const ck_Model *model = &world->scaled.model;
    for (int i = 0; i < 3 * model->particle_count; i++) {
        const int body = world->body[i / 3], joint = body ? world->model->body_dofadr[body] + i % 3 : 0;
        position[i] = unit * (model->position[i] + (body ? world->data->qpos[place_of(world, body) + i % 3] : 0));
        velocity[i] = body ? unit * world->data->qvel[joint] : 0;
    }
}

// Sets each body's force to the scene's, its hinges' and the air's.
static void add_outer(MujocoWorld *world) {
    const ck_Model *model = &world->scaled.model;
    const size_t count = 3 * (size_t)model->particle_count;
    double *position = world->outer, *velocity = position + count, *force = velocity + count;
    read_units(world, position, velocity, 1);
    for (size_t i = 0; i < count; i++) force[i] = model->force[i % 3];
    ck_hinges_add_force(model, position, 1, NULL, force);
    ck_wind_add_force(model, position, velocity, NULL, force);
    for (size_t i = 0; i < count; i++)
        if (world->body[i / 3]) world->data->xfrc_applied[6 * (size_t)world->body[i / 3] + i % 3] = force[i];
}

// Pins that move, with the speed that dampers see.
//   side  of a jump of that speed, as ck_path_at has it
static void drive(MujocoWorld *world, int side) {
    const ck_Model *model = &world->scaled.model;
    const double now = (double)world->done * model->step / world->used.substeps;
    for (int i = 0; i < model->driven_count; i++) {
        const ck_Driven *driven = &model->driven[i];
        if (!ck_driven_holds(model, driven, now)) continue;
        const int joint = world->model->body_dofadr[world->body[driven->particle]];
        const double *start = model->position + 3 * driven->particle;
        double moved[3], at[3], v[3], a[3];
        ck_driven_at(driven, now, at);
        ck_path_at(driven->path, now, side, moved, v, a);
        for (int axis = 0; axis < 3; axis++) {
            world->data->qpos[joint + axis] = at[axis] - start[axis];
            world->data->qvel[joint + axis] = v[axis];
        }
    }
}

// Balls that move: with a force that gives their bodies the acceleration of their path.
static void drive_colliders(MujocoWorld *world) {
    const ck_Model *model = &world->scaled.model;
    const double now = (double)world->done * model->step / world->used.substeps;
    for (int i = 0; i < model->collider_count && (model->terms & CK_TERM_MOVING_COLLIDERS); i++) {
        char name[20];
        double moved[3], v[3], a[3];
        if (!model->colliders[i].path) continue;
        snprintf(name, sizeof name, "c%d", i);
        const int body = mj_name2id(world->model, mjOBJ_BODY, name), joint = world->model->body_dofadr[body];
        ck_path_at(model->colliders[i].path, now, 1, moved, v, a);
        for (int axis = 0; axis < 3; axis++) {
            world->data->qpos[joint + axis] = moved[axis];
            world->data->qvel[joint + axis] = v[axis];
            world->data->xfrc_applied[6 * body + axis] =
                world->model->body_mass[body] * (a[axis] - model->gravity[axis]);
        }
    }
}

static ck_StepResult step(void *state) {
    MujocoWorld *world = state;
    if (!world->data) return CK_STEP_NO_MEMORY;
    for (uint32_t i = 0; i < world->used.substeps; i++) {
        drive(world, 1);
        drive_colliders(world);
        if (world->outer) add_outer(world);
        mj_step(world->model, world->data);
        world->done++;
        // it would begin anew from the start, and say nothing
        if (has_left(world->data)) return CK_STEP_DIVERGED;
    }
    drive(world, -1);
    return CK_STEP_OK;
}

// How soft contact is stays that of an even step.
static void pace(void *state, double duration) {
    MujocoWorld *world = state;
    if (world->model) world->model->opt.timestep = duration / world->used.substeps;
}

static void read_state(const void *state, double *position, double *velocity) {
    const MujocoWorld *world = state;
    if (world->data) read_units(world, position, velocity, world->scaled.length);
}

// Where a rigid body's axes are, and its spin, rad/s.
static void read_axes(const MujocoWorld *world, int index, double (*axes)[3], double *spin) {
    const ck_RigidBody *rigid = &world->scaled.model.rigid[index];
    const int body = world->body[rigid->particle];
    const double *rotation = world->data->qpos + place_of(world, body) + 3;
    for (int k = 0; k < 3; k++) ck_rigid_rotate(axes[k], rotation, rigid->shape.axes[k]);
    ck_rigid_rotate(spin, rotation, world->data->qvel + world->model->body_dofadr[body] + 3);
}

static void read_turn(const void *state, ck_Turn *turn) {
    const MujocoWorld *world = state;
    for (int i = 0; i < world->scaled.model.rigid_count && world->data; i++) {
        double axes[3][3];
        read_axes(world, i, axes, turn[i].spin);
        ck_rigid_rotation(turn[i].rotation, &world->rigid[i], axes);
    }
}

// What is fixed to the world stays so in a compiled model: another one is made, from where everything is now.
static void release(void *state, int particle) {
    MujocoWorld *world = state;
    ck_Model *model = &world->scaled.model;
    if (!world->data) return;
    size_t count = 3 * (size_t)model->particle_count;
    double *now = malloc(2 * count * sizeof *now);
    if (now) {
        read_units(world, now, now + count, 1);
        memcpy(model->position, now, count * sizeof *now);
        memcpy(model->velocity, now + count, count * sizeof *now);
    }
    free(now);
    for (int i = 0; i < model->rigid_count; i++) {
        double axes[3][3];
        read_axes(world, i, axes, model->rigid[i].spin);
        memcpy(model->rigid[i].shape.axes, axes, sizeof axes);
    }
    if (!ck_driven_find(model, particle, 0)) memset(model->velocity + 3 * particle, 0, 3 * sizeof(double));
    model->pinned[particle] = false;
    if (!now || load(world, NULL)) unload(world);
}

static ck_Status code(ck_Code *code, const ck_ScaledModel *scaled, const ck_Settings *used, ck_Error *error) {
    (void)error;
    code->text = ck_code_mujoco;
    code->extension = "c";
    ck_code_text(code, "integrator", integrators[integrator_of(used)]);
    ck_code_number(code, "radius", ck_mujoco_radius(&scaled->model));
    ck_code_number(code, "spacing", scaled->model.spacing);
    ck_code_number(code, "bounce_steps", CK_MUJOCO_BOUNCE_STEPS);
    ck_code_number(code, "stack", ck_mujoco_stack(&scaled->model, integrators[integrator_of(used)]));
    return CK_OK;
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
    {.name = "integrator",
     .slot = CK_OWN + OWN_INTEGRATOR,
     .is_whole = true,
     .least = 0,
     .most = 2,
     .unit = "1",
     .rule = "0",
     .help = "0 Euler, 1 implicit in velocity, 2 RK4",
     .leaves_theory = true},
    {0},
};

const ck_Engine ck_mujoco = {
    .name = "mujoco",
    .about = "slide joints and spatial tendons, soft contact with an elliptic cone",
    .family = "MuJoCo",
    .version = version,
    .method = CK_METHOD_SYMPLECTIC_EULER,
    .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY |
             CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_MOVES |
             CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_JITTER,
    .settings = settings,
    .order = 1,
    .create = create,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .turn = read_turn,
    .destroy = destroy,
    .code = code,
};
