// Bullet's deformable world, implicit: backward Euler by Newton and conjugate gradient.
#include "bullet_body.hpp"
#include "bullet_springs.hpp"
#include "engine_list.h"
#include "stability.h"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

namespace {

// stepSimulation would only wrap profiling and interpolation around this
class World : public btDeformableMultiBodyDynamicsWorld {
  public:
    using btDeformableMultiBodyDynamicsWorld::btDeformableMultiBodyDynamicsWorld;
    void step_once(btScalar dt) {
        internalSingleStepSimulation(dt);
    }
};

// Bullet keeps the count of Newton iterations to itself
class Solver : public btDeformableBodySolver {
  public:
    void set_newton_iterations(int count) {
        m_maxNewtonIterations = count;
    }
};

// Members are destroyed in reverse: the world before all that it points to.
struct DeformableState {
    ck_BulletBody body;
    std::unique_ptr<ck_BulletSprings> springs;
    std::unique_ptr<btDeformableGravityForce> gravity;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    Solver solver;
    btDeformableMultiBodyConstraintSolver constraint_solver;
    std::unique_ptr<World> world;

    ~DeformableState() {
        // the world owns nothing: what was added is taken out before either goes
        if (world && body.soft) world->removeSoftBody(body.soft.get());
    }
};

// Time step: backward Euler is stable at any, and its damping is first order: at most 1/240 s.
void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = ck_Settings{wanted->substeps, wanted->iterations ? wanted->iterations : 1, 0};
    if (!used->substeps) used->substeps = ck_stability_substeps(model, 1.0 / 240);
    ck_bullet_ledger(ledger, model, *used, "btDeformableLagrangianForce");
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (spring)
            ck_ledger_add(ledger,
                          {ck_stiffness_names[kind], spring->stiffness, "N/m", "btDeformableLagrangianForce",
                           spring->stiffness, "k per link; (1 - L/l) clamped at 0 in the differential", CK_EXACT});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, {"spring damping", model->springs[0].damping, "N*s/m", "btDeformableLagrangianForce",
                               model->springs[0].damping, "c along the link", CK_EXACT});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger, {"drag", model->drag, "1/s", "btDeformableLagrangianForce", model->drag,
                               "force -drag*m*v, implicit", CK_EXACT});
}

void build_world(DeformableState &state, const ck_Model *model, const ck_Settings &used) {
    state.solver.set_newton_iterations(static_cast<int>(used.iterations));
    state.constraint_solver.setDeformableSolver(&state.solver);
    state.world = std::make_unique<World>(&state.dispatcher, &state.broadphase, &state.constraint_solver,
                                          &state.configuration, &state.solver);
    World &world = *state.world;
    // without projection the implicit world reads out of bounds, and nothing moves
    world.setImplicit(true);
    world.setUseProjection(true);
    world.setLineSearch(false);
    btVector3 gravity(model->gravity[0], model->gravity[1], model->gravity[2]);
    world.setGravity(gravity);
    world.getWorldInfo().m_gravity = gravity;
    world.getWorldInfo().m_sparsesdf.Initialize();

    ck_bullet_body_build(state.body, model, used.substeps, &world.getWorldInfo());
    btSoftBody *soft = state.body.soft.get();
    soft->m_cfg.kDF = 1;
    soft->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN;
    soft->setActivationState(DISABLE_DEACTIVATION); // else it freezes below 0.04 m/s
    world.addSoftBody(soft);
    state.springs = std::make_unique<ck_BulletSprings>(state.body);
    world.addForce(soft, state.springs.get());
    // always there: the implicit world reads it even where there is no gravity
    state.gravity = std::make_unique<btDeformableGravityForce>(gravity);
    world.addForce(soft, state.gravity.get());
}

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error) try {
    translate(model, wanted, used, ledger);
    auto state = std::make_unique<DeformableState>();
    build_world(*state, model, *used);
    *out = state.release();
    return CK_OK;
} catch (const std::bad_alloc &) {
    return ck_fail(error, CK_NO_MEMORY, "out of memory");
}

ck_StepResult step(void *out) {
    DeformableState &state = *static_cast<DeformableState *>(out);
    for (uint32_t i = 0; i < state.body.substeps; i++) state.world->step_once(state.body.dt);
    return ck_bullet_body_is_finite(state.body) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

void read_state(const void *state, double *position, double *velocity) {
    ck_bullet_body_read(static_cast<const DeformableState *>(state)->body, position, velocity);
}

void destroy(void *state) {
    delete static_cast<DeformableState *>(state);
}

} // namespace

extern "C" const ck_Engine ck_bullet_implicit = {
    .name = "bullet-implicit",
    .about = "deformable world: backward Euler, one Newton iteration, conjugate gradient",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_IMPLICIT_EULER,
    .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY,
    .order = 1,
    .create = create,
    .step = step,
    .read = read_state,
    .destroy = destroy,
};
