// Bullet's classic soft body as its demos and documentation use it: nothing is corrected. Beside bullet-pbd it shows
// what the corrections buy, and what games that ship it get.
#include "bullet_contact.hpp"
#include "bullet_drive.hpp"
#include "bullet_guard.hpp"
#include "collider.h"
#include "engine.h"
#include "time_scale.h"
#include "vector.h"

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <memory>
#include <vector>

namespace {

// Its own settings, by their numbers.
enum { OWN_DAMPING, OWN_FRICTION, OWN_MARGIN };

// The half side of the box that stands for a plane, m, as the demos' ground; a box is right up to 2 km.
const double half_side = 200;

// Members are destroyed in reverse: the world before what it points to.
struct Stock {
    ck_Model model; // the caller's, but for its pins
    ck_Settings used;
    btScalar fixed_step; // s
    btScalar frame;      // s, of the next calls
    uint64_t done = 0;   // steps
    bool is_too_far = false;
    std::vector<std::unique_ptr<btCollisionShape>> shapes;
    std::vector<std::unique_ptr<btRigidBody>> bodies;
    ck_BulletRigid rigid;
    std::unique_ptr<btSoftBody> soft;
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver constraints;
    btDefaultSoftBodySolver solver;
    btSoftRigidDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration, &solver};

    ~Stock() {
        if (soft) world.removeSoftBody(soft.get());
        for (auto &body : bodies) world.removeRigidBody(body.get());
        rigid.remove(world);
    }
};

double weight_of(const ck_Model *model, const ck_Spring &spring) {
    return ck_model_inverse_mass(model, spring.a) + ck_model_inverse_mass(model, spring.b);
}

// What a user who knows a stiffness would take for kLST: exact for one free mass, 1 − (1 + q)^(−1/n), q = k·dt²·W.
double share_of(const ck_Model *model, const ck_Spring &spring, const ck_Settings &used) {
    if (used.softness > 0) return used.softness;
    double dt = model->step / used.substeps, q = spring.stiffness * dt * dt * weight_of(model, spring);
    return std::isinf(spring.stiffness) ? 1 : 1 - std::pow(1 + q, -1.0 / used.iterations);
}

double speed_taken(const ck_Model *model, const ck_Settings &used) {
    return ck_settings_own(&used, OWN_DAMPING, 1 - 1 / (1 + model->drag * model->step / used.substeps));
}

// Four substeps of one iteration a frame: what is done where stretch is minded at all.
void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = ck_Settings{};
    used->substeps = wanted->substeps ? wanted->substeps : 4;
    used->iterations = wanted->iterations ? wanted->iterations : 1;
    used->softness = wanted->softness;
    ck_settings_take_own(used, wanted);
    double dt = model->step / used->substeps;
    ck_ledger_add(ledger, {"time step", model->step, "s", "fixedTimeStep", dt,
                           "step / substeps, cast to float for soft bodies", CK_APPROXIMATE});
    ck_ledger_add_masses(ledger, model, {"mass", 0, "kg", "Node::m_im", 0, "1/m, 0 where pinned", CK_EXACT}, true);
    if (model->terms & CK_TERM_GRAVITY)
        ck_ledger_add(ledger, {"gravity", ck_length(model->gravity), "m/s2", "m_gravity", ck_length(model->gravity),
                               "g", CK_EXACT});
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (!spring) continue;
        ck_ledger_add(ledger, {ck_stiffness_names[kind], spring->stiffness, "N/m", "Material::m_kLST",
                               share_of(model, *spring, *used),
                               used->softness > 0 ? "as set: no stiffness in N/m"
                                                  : "1 - (1 + q)^(-1/n), q = k*dt^2*(wa + wb): right for one free mass",
                               CK_APPROXIMATE});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, {"spring damping", model->springs[0].damping, "N*s/m", "none", 0,
                               "there is no damping per spring", CK_IMPOSSIBLE});
    if ((model->terms & CK_TERM_DRAG) || ck_settings_has(used, CK_OWN + OWN_DAMPING))
        ck_ledger_add(ledger,
                      {"drag", model->drag, "1/s", "m_cfg.kDP", speed_taken(model, *used),
                       ck_settings_has(used, CK_OWN + OWN_DAMPING) ? "as set" : "1 - 1/(1 + drag*dt)", CK_APPROXIMATE});
    ck_ledger_add_colliders(ledger, model,
                            {"restitution", 0, "1", "setRestitution", 0, "has no effect on soft bodies", CK_IMPOSSIBLE},
                            {"friction", 0, "1", "setFriction, m_cfg.kDF", 0,
                             "a share kDF*friction of the tangential motion each iteration: no cone", CK_IMPOSSIBLE});
}

void add_soft_body(Stock &stock) {
    const ck_Model *model = &stock.model;
    std::vector<btVector3> position;
    std::vector<btScalar> mass;
    for (int i = 0; i < ck_model_cloth_count(model); i++) {
        const double *at = model->position + 3 * i;
        position.push_back(btVector3(at[0], at[1], at[2]));
        mass.push_back(model->pinned[i] ? 0 : model->mass[i]);
    }
    btSoftBodyWorldInfo &info = stock.world.getWorldInfo();
    stock.soft = std::make_unique<btSoftBody>(&info, ck_model_cloth_count(model), position.data(), mass.data());
    btSoftBody &soft = *stock.soft;
    // a material a kind, as kLST is a material's; of springs with values of their own, one each
    for (int i = 0; i < model->spring_count; i++) {
        btSoftBody::Material *material = i && stock.used.softness > 0 ? soft.m_materials[0] : soft.appendMaterial();
        material->m_kLST = share_of(model, model->springs[i], stock.used);
        soft.appendLink(model->springs[i].a, model->springs[i].b, material, false);
    }
    soft.m_cfg.piterations = static_cast<int>(stock.used.iterations);
    soft.m_cfg.kDP = speed_taken(model, stock.used);
    soft.m_cfg.kDF = ck_settings_own(&stock.used, OWN_FRICTION, soft.m_cfg.kDF);
    double margin = ck_settings_own(&stock.used, OWN_MARGIN, 0);
    if (margin > 0) soft.getCollisionShape()->setMargin(margin);
    for (int i = 0; i < ck_model_cloth_count(model); i++) {
        const double *speed = model->velocity + 3 * i;
        soft.m_nodes[i].m_v = btVector3(speed[0], speed[1], speed[2]);
    }
    stock.world.addSoftBody(&soft);
}

btTransform place_of(const ck_Collider &collider) {
    const btVector3 point(collider.point[0], collider.point[1], collider.point[2]);
    return ck_bullet_place(collider, point, 0, half_side);
}

void add_colliders(Stock &stock) {
    const ck_Model *model = &stock.model;
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider &collider = model->colliders[i];
        stock.shapes.push_back(ck_bullet_shape(collider, 0, half_side));
        btRigidBody::btRigidBodyConstructionInfo construction(0, nullptr, stock.shapes.back().get());
        construction.m_startWorldTransform = place_of(collider);
        construction.m_friction = collider.friction;
        construction.m_restitution = collider.restitution;
        stock.bodies.push_back(std::make_unique<btRigidBody>(construction));
        stock.world.addRigidBody(stock.bodies.back().get());
    }
}

// So that a frame has as many of them as it should: stepSimulation counts by a quotient that may be rounded down.
btScalar fixed_step_of(btScalar step, uint32_t substeps) {
    btScalar fixed = step / static_cast<btScalar>(substeps);
    while (static_cast<int>(step / fixed) < static_cast<int>(substeps)) fixed = std::nextafter(fixed, btScalar(0));
    return fixed;
}

// Before each step of stepSimulation.
void drive(btDynamicsWorld *world, btScalar dt) {
    Stock &stock = *static_cast<Stock *>(world->getWorldUserInfo());
    const double step = stock.model.step / stock.used.substeps;
    const double end = static_cast<double>(++stock.done) * step;
    ck_bullet_drive(&stock.model, end, dt,
                    [&](int particle) -> btSoftBody::Node & { return stock.soft->m_nodes[particle]; });
    for (int i = 0; i < stock.model.collider_count; i++) {
        double moved[3], speed[3], acceleration[3];
        if (!stock.model.colliders[i].path) continue;
        ck_path_at(stock.model.colliders[i].path, end, -1, moved, speed, acceleration);
        btTransform place = place_of(stock.model.colliders[i]);
        place.setOrigin(place.getOrigin() + btVector3(moved[0], moved[1], moved[2]));
        stock.bodies[i]->setWorldTransform(place);
        stock.bodies[i]->setLinearVelocity(btVector3(speed[0], speed[1], speed[2]));
        stock.world.updateSingleAabb(stock.bodies[i].get());
    }
}

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error) {
    return ck_bullet_guarded(error, [&] {
        ck_Status status = ck_bullet_check_rigid(model, error);
        if (status) return status;
        translate(model, wanted, used, ledger);
        auto stock = std::make_unique<Stock>();
        stock->model = *model;
        stock->used = *used;
        stock->frame = static_cast<btScalar>(model->step);
        stock->fixed_step = fixed_step_of(static_cast<btScalar>(model->step), used->substeps);
        const btVector3 gravity(model->gravity[0], model->gravity[1], model->gravity[2]);
        btSoftBodyWorldInfo &info = stock->world.getWorldInfo();
        stock->world.setGravity(gravity);
        info.m_gravity = gravity;
        info.m_broadphase = &stock->broadphase;
        info.m_dispatcher = &stock->dispatcher;
        info.m_sparsesdf.Initialize();
        add_soft_body(*stock);
        add_colliders(*stock);
        stock->rigid.add(stock->world, &stock->model, 0, model->collider_count, 0, true);
        if (model->path_count) stock->world.setInternalTickCallback(drive, stock.get(), true);
        ck_bullet_check_reach(stock->world, *stock->soft, stock->frame);
        *out = stock.release();
        return CK_OK;
    });
}

ck_StepResult step(void *state) {
    Stock &stock = *static_cast<Stock *>(state);
    ck_Status status = ck_bullet_guarded(nullptr, [&] {
        ck_bullet_check_reach(stock.world, *stock.soft, stock.frame);
        stock.world.stepSimulation(stock.frame, static_cast<int>(stock.used.substeps), stock.fixed_step);
        return CK_OK;
    });
    stock.is_too_far = status == CK_REFUSED;
    if (status) return ck_bullet_result(status);
    for (int i = 0; i < stock.soft->m_nodes.size(); i++)
        if (!std::isfinite(stock.soft->m_nodes[i].m_x.length2())) return CK_STEP_DIVERGED;
    return stock.rigid.is_finite() ? CK_STEP_OK : CK_STEP_DIVERGED;
}

// It takes fixed steps, as many as fit; what is left waits for the next call.
void pace(void *state, double duration) {
    static_cast<Stock *>(state)->frame = static_cast<btScalar>(duration);
}

void read_state(const void *state, double *position, double *velocity) {
    const Stock &stock = *static_cast<const Stock *>(state);
    for (int i = 0; i < stock.soft->m_nodes.size(); i++)
        for (int axis = 0; axis < 3; axis++) {
            position[3 * i + axis] = stock.soft->m_nodes[i].m_x[axis];
            velocity[3 * i + axis] = stock.soft->m_nodes[i].m_v[axis];
        }
    stock.rigid.read(&stock.model, 1, position, velocity);
}

void read_turn(const void *state, ck_Turn *turn) {
    const Stock &stock = *static_cast<const Stock *>(state);
    stock.rigid.read_turns(stock.model.rigid, turn);
}

// setMass also takes the lengths of that moment for lengths at rest: as anybody's who calls it.
void release(void *state, int particle) {
    Stock &stock = *static_cast<Stock *>(state);
    stock.soft->setMass(particle, stock.model.mass[particle]);
    if (!ck_driven_find(&stock.model, particle, 0)) stock.soft->m_nodes[particle].m_v = btVector3(0, 0, 0);
}

const char *remark(const void *state) {
    const Stock &stock = *static_cast<const Stock *>(state);
    if (stock.is_too_far) return ck_bullet_too_far;
    return stock.model.release_count
               ? "setMass, which lets a pin go, takes the lengths of that moment for lengths at rest"
               : nullptr;
}

void destroy(void *state) {
    delete static_cast<Stock *>(state);
}

const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "4",
     .help = "stepSimulation's steps a frame"},
    {.name = "piterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1",
     .help = "m_cfg.piterations: sweeps over links a step",
     .also = "iterations"},
    {.name = "kLST",
     .slot = CK_SOFTNESS,
     .least = 1e-9,
     .most = 1,
     .unit = "1",
     .rule = "1 - (1 + k*dt^2*W)^(-1/n)",
     .help = "Material::m_kLST of every link",
     .also = "klst"},
    {.name = "kDP",
     .slot = CK_OWN + OWN_DAMPING,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "1 - 1/(1 + drag*dt)",
     .help = "m_cfg.kDP: share of speed taken in each step"},
    {.name = "kDF",
     .slot = CK_OWN + OWN_FRICTION,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "0.2, Bullet's own",
     .help = "m_cfg.kDF: share of a collider's friction"},
    {.name = "margin",
     .slot = CK_OWN + OWN_MARGIN,
     .least = 0,
     .most = 100,
     .unit = "m",
     .rule = "0.25, Bullet's own",
     .help = "of the soft body's collision shape"},
    {},
};

} // namespace

extern "C" const ck_Engine ck_bullet_stock = {
    .name = "bullet-stock" CK_BULLET_SUFFIX,
    .about = "classic btSoftBody as its demos use it: stepSimulation, nothing corrected",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_UNKNOWN,
    .terms = CK_TERM_SPRINGS | CK_TERM_RIGID | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_DRAG | CK_TERM_VELOCITY |
             CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_MOVES | CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES |
             CK_TERM_JITTER,
    .settings = settings,
    .is_single = CK_BULLET_IS_SINGLE,
    .is_stock = true,
    .create = create,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = nullptr,
    .turn = read_turn,
    .remark = remark,
    .destroy = destroy,
};
