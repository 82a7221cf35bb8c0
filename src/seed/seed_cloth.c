// Source: goguma1000, "Cloth-Simulation" (C++), rebuilt from its description, in metres.
#include "seed.h"

#include "collider.h"
#include "engine.h"
#include "own_ledger.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

// Substeps of a frame where the user does not say.
#define SUBSTEPS_USUAL 150
// Near enough to touch: in cm and cm/s there, 1e-4 for the floor and 1e-3 for the ball.
#define PLANE_TOLERANCE 1e-6
#define SPHERE_TOLERANCE 1e-5

const char *const ck_cloth_quirk_names[CK_CLOTH_QUIRK_COUNT] = {
    "forward Euler",
    "friction of the force, not of the impact",
    "friction takes from the rebound",
    "friction where nothing presses",
    "one tolerance for length and speed",
    "glued to the surface when leaving",
    "floor without friction",
    "coincident nodes",
};

typedef struct SeedCloth {
    const ck_Model *model;
    uint32_t substeps, mended;
    double dt;                           // s
    double *position, *velocity, *force; // [3*n]
    bool *pinned;                        // [n]
} SeedCloth;

// Takes from the speed what friction of a normal impulse holds, both per mass in m/s.
static void rub(double *v, double push) {
    double speed = ck_length(v);
    if (speed > 0) ck_add_scaled(v, -fmin(push, speed) / speed, v);
}

void ck_seed_cloth_collide(const ck_Collider *collider, uint32_t mended, double dt, double mass, const double *force,
                           double *x, double *v) {
    double normal[3], gap = ck_collider_gap(collider, x, normal), along[3];
    double tolerance = collider->shape == CK_PLANE ? PLANE_TOLERANCE : SPHERE_TOLERANCE;
    double speed = ck_dot(v, normal), press = -ck_dot(force, normal) / mass;
    double slow = mended & CK_CLOTH_ONE_TOLERANCE ? 2 * fabs(press) * dt : tolerance;
    if (gap >= tolerance) return;
    if (!(mended & CK_CLOTH_GLUE) || gap < 0) ck_add_scaled(x, -gap, normal);
    if (speed > (mended & CK_CLOTH_GLUE ? 0 : slow)) return;
    if (mended & CK_CLOTH_PULLING_NORMAL) press = fmax(0, press);

    double rebound = speed < -slow ? -collider->restitution * speed : 0;
    double friction = collider->shape == CK_PLANE && !(mended & CK_CLOTH_SMOOTH_FLOOR) ? 0 : collider->friction;
    double push = friction * (mended & CK_CLOTH_FORCE_FRICTION ? fmax(press * dt, rebound - speed) : press * dt);
    memcpy(along, v, sizeof along);
    ck_add_scaled(along, -speed, normal);
    if (mended & CK_CLOTH_RUBBED_REBOUND) {
        rub(along, push);
        ck_add_scaled(along, rebound, normal);
    } else {
        ck_add_scaled(along, rebound, normal);
        rub(along, push);
    }
    memcpy(v, along, sizeof along);
}

static void add_forces(SeedCloth *cloth) {
    const ck_Model *model = cloth->model;
    for (int i = 0; i < model->particle_count; i++) {
        double field[3], *force = cloth->force + 3 * i;
        ck_model_field(model, i, field);
        for (int axis = 0; axis < 3; axis++)
            force[axis] = model->mass[i] * (field[axis] - model->drag * cloth->velocity[3 * i + axis]);
    }
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        double d[3], moving[3];
        ck_subtract(d, cloth->position + 3 * spring->a, cloth->position + 3 * spring->b);
        ck_subtract(moving, cloth->velocity + 3 * spring->a, cloth->velocity + 3 * spring->b);
        double length = ck_length(d);
        if (!(length > 0) && cloth->mended & CK_CLOTH_COINCIDENT_NODES) continue;
        double push =
            -(spring->stiffness * (length - spring->rest) + spring->damping * ck_dot(moving, d) / length) / length;
        ck_add_scaled(cloth->force + 3 * spring->a, push, d);
        ck_add_scaled(cloth->force + 3 * spring->b, -push, d);
    }
}

static void substep(SeedCloth *cloth) {
    const ck_Model *model = cloth->model;
    const double dt = cloth->dt;
    add_forces(cloth);
    for (int i = 0; i < model->particle_count; i++) {
        double *x = cloth->position + 3 * i, *v = cloth->velocity + 3 * i, *force = cloth->force + 3 * i;
        if (cloth->pinned[i]) continue;
        bool mended = cloth->mended & CK_CLOTH_FORWARD_EULER;
        if (!mended) ck_add_scaled(x, dt, v);
        ck_add_scaled(v, dt / model->mass[i], force);
        if (mended) ck_add_scaled(x, dt, v);
        for (int j = 0; j < model->collider_count; j++)
            ck_seed_cloth_collide(&model->colliders[j], cloth->mended, dt, model->mass[i], force, x, v);
    }
}

static void destroy(void *state) {
    SeedCloth *cloth = state;
    if (!cloth) return;
    free(cloth->position);
    free(cloth->velocity);
    free(cloth->force);
    free(cloth->pinned);
    free(cloth);
}

static void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : SUBSTEPS_USUAL};
    ck_settings_take_own(used, wanted);
    uint32_t mended = (uint32_t)used->own[CK_CLOTH_MENDED];
    ck_own_ledger(ledger, model, used, "force -drag*m*v", CK_EXACT);
    ck_own_ledger_springs(ledger, model, "k", "k", CK_EXACT);
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "kd",
                                             model->springs[0].damping, "c along the spring", CK_EXACT});
    for (int i = 0; i < CK_CLOTH_QUIRK_COUNT; i++)
        ck_ledger_add(ledger, (ck_LedgerRow){"physics", 1, "1", ck_cloth_quirk_names[i], mended >> i & 1,
                                             "a quirk of the original; 1 where mended",
                                             mended >> i & 1 ? CK_EXACT : CK_IMPOSSIBLE});
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    translate(model, wanted, used, ledger);
    size_t count = (size_t)model->particle_count, bytes = 3 * count * sizeof(double);
    SeedCloth *cloth = calloc(1, sizeof *cloth);
    if (!cloth) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *cloth = (SeedCloth){.model = model,
                         .substeps = used->substeps,
                         .mended = (uint32_t)used->own[CK_CLOTH_MENDED],
                         .dt = model->step / used->substeps,
                         .position = malloc(bytes),
                         .velocity = malloc(bytes),
                         .force = malloc(bytes),
                         .pinned = malloc(count * sizeof(bool))};
    if (!cloth->position || !cloth->velocity || !cloth->force || !cloth->pinned) {
        destroy(cloth);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    memcpy(cloth->position, model->position, bytes);
    memcpy(cloth->velocity, model->velocity, bytes);
    memcpy(cloth->pinned, model->pinned, count * sizeof(bool));
    *state = cloth;
    return CK_OK;
}

static ck_StepResult step(void *state) {
    SeedCloth *cloth = state;
    double sum = 0;
    for (uint32_t i = 0; i < cloth->substeps; i++) substep(cloth);
    for (int i = 0; i < 3 * cloth->model->particle_count; i++) sum += cloth->position[i] * 0;
    return sum == 0 ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static void read_state(const void *state, double *position, double *velocity) {
    const SeedCloth *cloth = state;
    memcpy(position, cloth->position, 3 * sizeof(double) * (size_t)cloth->model->particle_count);
    memcpy(velocity, cloth->velocity, 3 * sizeof(double) * (size_t)cloth->model->particle_count);
}

static void release(void *state, int particle) {
    SeedCloth *cloth = state;
    cloth->pinned[particle] = false;
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "150",
     .help = "steps a frame"},
    {.name = "mended",
     .slot = CK_OWN + CK_CLOTH_MENDED,
     .is_whole = true,
     .least = 0,
     .most = 1e6,
     .unit = "1",
     .rule = "0: none",
     .help = "quirks to leave out, added up as clothcheck list counts them"},
    {0},
};

const ck_Engine ck_seed_cloth = {
    .name = "seed-cloth",
    .about = "the second origin as it was: damped springs, forward Euler, 150 substeps a frame",
    .family = "seed",
    .version = ck_own_version,
    .method = CK_METHOD_SEED,
    .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY |
             CK_TERM_PLANE | CK_TERM_SPHERE | CK_TERM_RELEASE,
    .settings = settings,
    .order = 1,
    .create = create,
    .step = step,
    .read = read_state,
    .release = release,
    .destroy = destroy,
};
