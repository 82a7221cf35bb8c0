// Bullet's deformable world: implicit, which is backward Euler by Newton and conjugate gradient; and explicit, which is
// symplectic Euler with implicit damping.
#include "bullet_body.hpp"
#include "bullet_contact.hpp"
#include "bullet_drive.hpp"
#include "bullet_springs.hpp"
#include "collider.h"
#include "engine.h"
#include "time_scale.h"
#include "vector.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>
#include <cmath>

extern "C" const char ck_code_bullet_deformable[];

namespace {

class World : public btDeformableMultiBodyDynamicsWorld {
  public:
    using btDeformableMultiBodyDynamicsWorld::btDeformableMultiBodyDynamicsWorld;
    const ck_BulletBody *body = nullptr;
    const ck_BulletColliders *colliders = nullptr;
    bool was_clamped = false; // a speed, by Bullet, to what crosses the body's bounding box in a step

    // stepSimulation would only wrap profiling and interpolation around this
    void step_once(btScalar dt) {
        if (body->model->collider_count || body->model->rigid_count) {
            speed_before.resize(body->soft->m_nodes.size());
            for (int i = 0; i < body->soft->m_nodes.size(); i++) speed_before[i] = body->soft->m_nodes[i].m_v;
        }
        internalSingleStepSimulation(dt);
    }

  protected:
    void predictUnconstraintMotion(btScalar dt) override {
        btDeformableMultiBodyDynamicsWorld::predictUnconstraintMotion(dt);
        // Bullet has just scaled back what is faster than the bounds that it took then
        const btSoftBody &soft = *body->soft;
        double most =
            (soft.m_bounds[1] - soft.m_bounds[0]).length2() / (dt * dt) * (1 - btMax(1e-9, 16.0 * SIMD_EPSILON));
        for (int i = 0; i < soft.m_nodes.size() && !is_implicit && !was_clamped; i++)
            was_clamped = soft.m_nodes[i].m_v.length2() >= most;
    }

    // between the solve, after which a node in contact has lost its speed into the surface, and the motion
    void integrateTransforms(btScalar dt) override {
        for (int i = 0; i < body->soft->m_nodeRigidContacts.size(); i++)
            rebound(body->soft->m_nodeRigidContacts[i], dt);
        btDeformableMultiBodyDynamicsWorld::integrateTransforms(dt);
    }

  private:
    std::vector<btVector3> speed_before;

  public:
    bool is_implicit = true;

  private:
    void rebound(const btSoftBody::DeformableNodeRigidContact &contact, btScalar dt);
};

// Restitution and its friction. Bullet's own friction is that of an impact that stops, of which its explicit world,
// which looks ahead, only sees the part that is too fast to reach the surface: it is left out.
void World::rebound(const btSoftBody::DeformableNodeRigidContact &contact, btScalar dt) {
    const ck_Collider &collider =
        is_implicit ? colliders->at_start(contact.m_cti.m_colObj) : colliders->at_end(contact.m_cti.m_colObj);
    if (!(collider.restitution > 0)) return;
    btSoftBody::Node &node = *contact.m_node;
    const btVector3 carried = ck_BulletColliders::speed(contact.m_cti.m_colObj, node.m_q);
    double out[3], gap = ck_bullet_gap(collider, node.m_q, out);
    btVector3 normal(out[0], out[1], out[2]);
    double pull = -ck_bullet_field(*body, body->particle_of_node[node.index]).dot(normal);
    double speed = -(speed_before[node.index] - carried).dot(normal);
    // what cannot be told from rest
    if (speed <= 2 * btFabs(pull) * dt) return;
    double leaving = ck_collider_rebound(collider.restitution, -gap, speed, pull, dt);
    btVector3 before = speed_before[node.index] + ck_bullet_field(*body, body->particle_of_node[node.index]) * dt;
    before -= carried;
    btVector3 along = before - normal * before.dot(normal);
    double sliding = along.length();
    if (sliding > 0) along *= 1 - btMin(1.0, collider.friction * (speed + leaving) / sliding);
    const btVector3 solved = node.m_v;
    node.m_v = carried + along + normal * leaving;
    if (node.m_im > 0) colliders->strike(contact.m_cti.m_colObj, (solved - node.m_v) / node.m_im, node.m_q);
}

// Bullet keeps the count of Newton iterations to itself
class Solver : public btDeformableBodySolver {
  public:
    void set_newton_iterations(int count) {
        m_maxNewtonIterations = count;
    }
};

// Members are destroyed in reverse: the world before all that it points to.
struct Deformable {
    ck_BulletBody body;
    ck_BulletColliders colliders;
    std::unique_ptr<ck_BulletSprings> springs;
    std::unique_ptr<btDeformableGravityForce> gravity;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    Solver solver;
    btDeformableMultiBodyConstraintSolver constraint_solver;
    std::unique_ptr<World> world;

    ~Deformable() {
        // the world owns nothing: what was added is taken out before either goes
        if (world && body.soft) world->removeSoftBody(body.soft.get());
        if (world) colliders.remove(*world);
    }
};

struct DeformableState {
    ck_BulletModel scene;
    ck_Settings used;
    bool is_implicit;
    uint32_t frame = 0;
    bool is_too_far = false;
    std::unique_ptr<Deformable> now; // NULL: there was no memory for it
    DeformableState(const ck_Model *model, const ck_Settings &settings, bool implicit)
        : scene(model), used(settings), is_implicit(implicit) {}
};

// Time step: backward Euler is stable at any, and its damping is first order: at most 1/240 s. The explicit world is
// stable to 2/ω; half of that, so that a cloth that folds stays inside. In contact k·dt²/m ≤ 1 (k·dt²·W ≤ 2): a cloth
// dropped on a ball gains energy at 3.5, and does not at 0.9.
ck_Status time_step_limit(const ck_Model *model, bool is_implicit, double *limit) {
    *limit = 1.0 / 240;
    double frequency = 0;
    ck_Status status = is_implicit ? CK_OK : ck_stability_frequency(model, &frequency);
    if (frequency > 0) *limit = btMin(*limit, 1 / frequency);
    double rate = ck_stability_stiffness_rate(model);
    if ((model->collider_count || model->rigid_count) && rate > 0) *limit = std::fmin(*limit, std::sqrt(2 / rate));
    return status;
}

// What a metre is to Bullet, in m: its default margin is a quarter of that.
double unit_of(const ck_Model *model) {
    return std::ldexp(1, std::ilogb(model->size));
}

// The explicit world clamps speeds to the body's bounding box, margins and all, per step.
void ledger_speed(const ck_Model *model, const ck_Settings &used, ck_Ledger *ledger) {
    btVector3 low(BT_LARGE_FLOAT, BT_LARGE_FLOAT, BT_LARGE_FLOAT), high = -low;
    double fastest = 0,
           margin = model->collider_count || model->rigid_count ? ck_bullet_margin(model) : 0.25 * unit_of(model);
    for (int i = 0; i < model->particle_count; i++) {
        const double *at = model->position + 3 * i, *speed = model->velocity + 3 * i;
        low.setMin(btVector3(at[0], at[1], at[2]));
        high.setMax(btVector3(at[0], at[1], at[2]));
        fastest = std::fmax(fastest, btVector3(speed[0], speed[1], speed[2]).length());
    }
    double limit = (high - low + btVector3(2, 2, 2) * margin).length() * used.substeps / model->step;
    // what it can reach: a fall as long as the scene or, held by pins, as deep as the body
    double field[3];
    ck_model_mean_field(model, field);
    double pull = ck_length(field);
    double fall =
        model->pin_count && !model->release_count ? std::sqrt(2 * pull * model->size) : pull * model->duration;
    if (model->drag > 0) fall = btMin(fall, pull / model->drag);
    ck_ledger_add(ledger, {"speed", fastest + fall, "m/s", "Node::m_v", btMin(fastest + fall, limit),
                           "at most; Bullet clamps it to bounding box diagonal / dt",
                           fastest + fall <= limit ? CK_EXACT : CK_IMPOSSIBLE});
}

ck_Status translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                    bool is_implicit) {
    double limit;
    ck_Status status = time_step_limit(model, is_implicit, &limit);
    if (status) return status;
    *used = ck_Settings{};
    used->substeps = wanted->substeps;
    if (is_implicit) used->iterations = wanted->iterations ? wanted->iterations : 1;
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    ck_bullet_ledger(ledger, model, *used, "btDeformableLagrangianForce",
                     "kDF*friction, kDF = 1; the bridge adds that of the rebound");
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (spring)
            ck_ledger_add(
                ledger,
                {ck_stiffness_names[kind], spring->stiffness, "N/m", "btDeformableLagrangianForce", spring->stiffness,
                 is_implicit ? "k per link; (1 - L/l) clamped at 0 in the differential" : "k per link", CK_EXACT});
    }
    ck_ledger_add_wind(ledger, model, "btDeformableLagrangianForce", "by face, without a differential", CK_APPROXIMATE);
    ck_ledger_add_bending(ledger, model, "btDeformableLagrangianForce",
                          is_implicit ? "each hinge's force, and the differential of its vector" : "each hinge's force",
                          CK_EXACT);
    if (!is_implicit) ledger_speed(model, *used, ledger);
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, {"spring damping", model->springs[0].damping, "N*s/m", "btDeformableLagrangianForce",
                               model->springs[0].damping, "c along the link", CK_EXACT});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger, {"drag", model->drag, "1/s", "btDeformableLagrangianForce", model->drag,
                               "force -drag*m*v, implicit", CK_EXACT});
    return CK_OK;
}

std::unique_ptr<Deformable> build_world(const ck_Model *model, const ck_Settings &used, bool is_implicit) {
    auto state = std::make_unique<Deformable>();
    if (is_implicit) state->solver.set_newton_iterations(static_cast<int>(used.iterations));
    state->constraint_solver.setDeformableSolver(&state->solver);
    state->world = std::make_unique<World>(&state->dispatcher, &state->broadphase, &state->constraint_solver,
                                           &state->configuration, &state->solver);
    World &world = *state->world;
    world.body = &state->body;
    world.colliders = &state->colliders;
    world.is_implicit = is_implicit;
    // without projection the implicit world reads out of bounds, and nothing moves
    world.setImplicit(is_implicit);
    world.setUseProjection(true);
    world.setLineSearch(false);
    btVector3 gravity(model->gravity[0], model->gravity[1], model->gravity[2]);
    world.setGravity(gravity);
    world.getWorldInfo().m_gravity = gravity;
    world.getWorldInfo().m_sparsesdf.Initialize();

    ck_bullet_body_build(state->body, model, used.substeps, false, &world.getWorldInfo());
    state->colliders.add(world, state->body, world.getWorldInfo());
    btSoftBody *soft = state->body.soft.get();
    soft->m_cfg.kDF = 1;
    soft->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    soft->setActivationState(DISABLE_DEACTIVATION); // else it freezes below 0.04 m/s
    world.addSoftBody(soft);
    state->springs = std::make_unique<ck_BulletSprings>(state->body, is_implicit);
    world.addForce(soft, state->springs.get());
    // always there: the implicit world reads it even where there is no gravity
    state->gravity = std::make_unique<btDeformableGravityForce>(gravity);
    world.addForce(soft, state->gravity.get());
    return state;
}

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error, bool is_implicit) {
    return ck_bullet_guarded(error, [&] {
        ck_Status status = ck_bullet_check_rigid(model, error);
        if (status) return status;
        status = translate(model, wanted, used, ledger, is_implicit);
        if (status) throw std::bad_alloc();
        auto state = std::make_unique<DeformableState>(model, *used, is_implicit);
        state->now = build_world(state->scene.model(), *used, is_implicit);
        ck_bullet_check_reach(*state->now->world, *state->now->body.soft, state->now->body.dt);
        *out = state.release();
        return CK_OK;
    });
}

ck_Status create_implicit(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                          ck_Ledger *ledger, ck_Error *error) {
    return create(out, model, wanted, used, ledger, error, true);
}

ck_Status create_explicit(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                          ck_Ledger *ledger, ck_Error *error) {
    return create(out, model, wanted, used, ledger, error, false);
}

ck_StepResult step(void *out) {
    DeformableState &all = *static_cast<DeformableState *>(out);
    if (!all.now) return CK_STEP_NO_MEMORY;
    Deformable &state = *all.now;
    ck_Status status = ck_bullet_guarded(nullptr, [&] {
        state.colliders.follow(*state.world, state.body);
        const ck_BulletBody &body = state.body;
        const double start = all.frame++ * body.model->step;
        for (uint32_t i = 0; i < body.substeps; i++) {
            ck_bullet_drive(body.model, start + (i + 1) * body.dt, body.dt, [&](int particle) -> btSoftBody::Node & {
                return body.soft->m_nodes[body.node_of_particle[particle]];
            });
            state.colliders.move(*state.world, body, start + i * body.dt);
            ck_bullet_check_reach(*state.world, *body.soft, body.dt);
            state.world->step_once(body.dt);
        }
        return CK_OK;
    });
    all.is_too_far = status == CK_REFUSED;
    if (status) return ck_bullet_result(status);
    if (!state.colliders.rigid.is_finite()) return CK_STEP_DIVERGED;
    return ck_bullet_body_is_finite(state.body) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

void pace(void *out, double duration) {
    DeformableState &state = *static_cast<DeformableState *>(out);
    if (state.now) state.now->body.dt = duration / state.now->body.substeps;
}

void read_state(const void *out, double *position, double *velocity) {
    const DeformableState &state = *static_cast<const DeformableState *>(out);
    if (!state.now) return;
    ck_bullet_body_read(state.now->body, state.scene.length(), position, velocity);
    state.now->colliders.rigid.read(state.scene.model(), state.scene.length(), position, velocity);
}

void read_turn(const void *out, ck_Turn *turn) {
    const DeformableState &state = *static_cast<const DeformableState *>(out);
    if (state.now) state.now->colliders.rigid.read_turns(state.scene.first_rigid(), turn);
}

// Bullet keeps masses in many places: the world is built again.
void release(void *out, int particle) {
    DeformableState &state = *static_cast<DeformableState *>(out);
    ck_Status status = ck_bullet_guarded(nullptr, [&] {
        std::vector<double> position(3 * state.scene.model()->particle_count), velocity(position.size());
        read_state(out, position.data(), velocity.data());
        std::vector<ck_Turn> turn(static_cast<size_t>(state.scene.model()->rigid_count));
        read_turn(out, turn.data());
        state.scene.release(position.data(), velocity.data(), turn.data(), particle);
        state.now = build_world(state.scene.model(), state.used, state.is_implicit);
        return CK_OK;
    });
    if (status) state.now.reset();
}

const char *remark(const void *out) {
    const DeformableState &state = *static_cast<const DeformableState *>(out);
    if (state.is_too_far) return ck_bullet_too_far;
    return state.now && state.now->world->was_clamped
               ? "Bullet clamped speeds to what crosses the body's bounding box in a step"
               : nullptr;
}

void destroy(void *state) {
    delete static_cast<DeformableState *>(state);
}

ck_Status code(ck_Code *code, const ck_ScaledModel *scaled, bool is_implicit) {
    code->text = ck_code_bullet_deformable;
    code->extension = "cpp";
    ck_code_number(code, "margin", ck_bullet_margin(&scaled->model));
    ck_code_part(code, "is_implicit", is_implicit);
    ck_code_text(code, "implicit", is_implicit ? "true" : "false");
    ck_code_text(code, "obstacles", "cloth->obstacles");
    ck_code_text(code, "world", "*cloth->world");
    return CK_OK;
}

ck_Status code_implicit(ck_Code *out, const ck_ScaledModel *scaled, const ck_Settings *, ck_Error *) {
    return code(out, scaled, true);
}

ck_Status code_explicit(ck_Code *out, const ck_ScaledModel *scaled, const ck_Settings *, ck_Error *) {
    return code(out, scaled, false);
}

const unsigned terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG |
                       CK_TERM_VELOCITY | CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_BENDING | CK_TERM_WIND |
                       CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_JITTER;

const ck_Setting implicit_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "what one Newton iteration is good for",
     .help = "steps a frame"},
    {.name = "iterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1",
     .help = "Newton iterations a substep"},
    {},
};

const ck_Setting explicit_settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "half of the largest stable step",
     .help = "steps a frame"},
    {},
};

} // namespace

extern "C" const ck_Engine ck_bullet_implicit = {
    .name = "bullet-implicit" CK_BULLET_SUFFIX,
    .about = "deformable world: backward Euler, one Newton iteration, conjugate gradient",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_IMPLICIT_EULER,
    .terms = terms,
    .settings = implicit_settings,
    .is_single = CK_BULLET_IS_SINGLE,
    .order = 1,
    .rest_order = 0,
    .damped_rest_order = 0,
    .create = create_implicit,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = nullptr,
    .turn = read_turn,
    .remark = remark,
    .destroy = destroy,
    .code = code_implicit,
};

extern "C" const ck_Engine ck_bullet_explicit = {
    .name = "bullet-explicit" CK_BULLET_SUFFIX,
    .about = "deformable world: symplectic Euler, damping implicit",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_SYMPLECTIC_EULER,
    .terms = terms,
    .settings = explicit_settings,
    .is_single = CK_BULLET_IS_SINGLE,
    .order = 1,
    .rest_order = 0,
    .damped_rest_order = 0,
    .create = create_explicit,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = nullptr,
    .turn = read_turn,
    .remark = remark,
    .destroy = destroy,
    .code = code_explicit,
};
