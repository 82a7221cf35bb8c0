// Bullet's classic soft body: position-based, set up to answer to a physical stiffness.
//
// Without colliders the world around it has nothing to do, and only its cost and its float time step would be added:
// the body is stepped by the same calls that the world would make.
#include "bullet_contact.hpp"
#include "collider.h"
#include "engine_list.h"
#include "stability.h"

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cmath>

namespace {

class World : public btSoftRigidDynamicsWorld {
  public:
    World(btDispatcher *dispatcher, btBroadphaseInterface *broadphase, btConstraintSolver *constraint_solver,
          btCollisionConfiguration *configuration, btDefaultSoftBodySolver *soft_solver)
        : btSoftRigidDynamicsWorld(dispatcher, broadphase, constraint_solver, configuration, soft_solver),
          solver(soft_solver) {}
    void step_once(btScalar dt) {
        internalSingleStepSimulation(dt);
    }

  protected:
    // Bullet's own casts dt to float
    void predictUnconstraintMotion(btScalar dt) override {
        btDiscreteDynamicsWorld::predictUnconstraintMotion(dt);
        solver->predictMotion(dt);
    }

  private:
    btDefaultSoftBodySolver *solver;
};

// The world around a body that meets colliders. Members are destroyed in reverse: the world before what it points to.
struct Surroundings {
    btSoftBodyRigidBodyCollisionConfiguration configuration;
    btCollisionDispatcher dispatcher{&configuration};
    btDbvtBroadphase broadphase;
    btSequentialImpulseConstraintSolver constraint_solver;
    btDefaultSoftBodySolver solver;
    ck_BulletColliders colliders;
    World world{&dispatcher, &broadphase, &constraint_solver, &configuration, &solver};
};

// What is left to do for a node in contact once links and contacts are solved, which leaves it without normal motion.
struct Landing {
    btSoftBody::Node *node;
    btVector3 normal;
    double shift, leaving; // m and m/s along the normal
    double incoming;       // m/s against it
};

// Without colliders there are no surroundings.
struct Classic {
    btSoftBodyWorldInfo info;
    std::unique_ptr<Surroundings> around;
    ck_BulletBody body;
    std::vector<double> kappa_over_weight; // of each link: κ/(w_a + w_b)
    std::vector<btVector3> field_force;    // N on each node
    std::vector<Landing> landings;         // of this substep
    std::vector<btVector3> tension;        // N, of the springs on each node; empty without colliders

    ~Classic() {
        if (!around) return;
        around->world.removeSoftBody(body.soft.get());
        around->colliders.remove(around->world);
    }
};

struct ClassicState {
    ck_BulletScene scene;
    ck_Settings used;
    std::unique_ptr<Classic> now;
};

// The share κ = kLST of a link's error that one iteration removes.
// n = 1: the static map κ = q/(1 + q/2), q = k·dt²·W, which hangs a chain within 0.2 % for k·dt²/m ≤ 0.02.
// n > 1: κ = 1 − (1 + q)^(−1/n), exact for one free mass. Both end at 1, beyond which a link is unsafe.
double kappa(const ck_Spring &spring, double weight, double dt, const ck_Settings &used) {
    if (used.klst > 0) return used.klst;
    if (std::isinf(spring.stiffness)) return 1;
    uint32_t iterations = used.iterations;
    double q = spring.stiffness * dt * dt * weight;
    return iterations == 1 ? std::fmin(1, q / (1 + q / 2)) : 1 - std::pow(1 + q, -1.0 / iterations);
}

double spring_weight(const ck_Model *model, const ck_Spring &spring) {
    return ck_model_inverse_mass(model, spring.a) + ck_model_inverse_mass(model, spring.b);
}

// Time step: k·dt²/m ≤ 0.1 (k·dt²·W ≤ 0.2), where the static map is good to 1 %; rigid bars as for native-bars;
// damping, a force before the step, takes at most half of a relative speed; drag, first order, 2 % of a speed; where
// there is contact 1/240 s.
void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    uint32_t sweeps = model->terms & CK_TERM_RIGID ? ck_stability_sweeps(model) : 1;
    *used = ck_Settings{};
    used->substeps = wanted->substeps;
    used->iterations = wanted->iterations ? wanted->iterations : sweeps;
    used->klst = wanted->klst;
    used->reordered = wanted->reordered;
    double rate = ck_stability_stiffness_rate(model), limit = rate > 0 ? std::sqrt(0.2 / rate) : INFINITY;
    if (model->terms & CK_TERM_RIGID) limit = ck_stability_bar_time(model, used->iterations);
    for (int i = 0; i < model->spring_count; i++)
        limit = std::fmin(limit, 0.5 / (model->springs[i].damping * spring_weight(model, model->springs[i])));
    limit = std::fmin(limit, ck_stability_drag_time(model, 0.02));
    if (model->collider_count) limit = std::fmin(limit, 1.0 / 240);
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    double dt = model->step / used->substeps;
    ck_bullet_ledger(
        ledger, model, *used, "Node::m_f",
        "RContact::m_c3 edited to a cone of what presses: way into the surface and the tension of springs");
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (!spring) continue;
        double value = kappa(*spring, spring_weight(model, *spring), dt, *used);
        ck_ledger_add(ledger,
                      {ck_stiffness_names[kind], spring->stiffness, "N/m", "Material::m_kLST", value,
                       used->klst > 0 ? "as set; Link::m_c0 corrected to Hooke each step"
                       : used->iterations == 1
                           ? "min(1, q/(1 + q/2)), q = k*dt^2*(wa + wb); Link::m_c0 corrected to Hooke each step"
                           : "1 - (1 + q)^(-1/n), q = k*dt^2*(wa + wb); Link::m_c0 corrected to Hooke each step",
                       CK_APPROXIMATE});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger, {"spring damping", model->springs[0].damping, "N*s/m", "Node::m_f",
                               model->springs[0].damping, "c*(dv.n) added before each step: explicit", CK_APPROXIMATE});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger, {"drag", model->drag, "1/s", "m_cfg.kDP", 1 - 1 / (1 + model->drag * dt),
                               "1 - 1/(1 + drag*dt)", CK_APPROXIMATE});
}

// Share of a depth that is pushed out in a step: without speed, so that nothing bounces by it.
const double push_share = 0.2;

// What a node does after meeting the surface from a gap, at way_in m in this step: rebounds, goes down to the surface,
// or slowly out of it.
Landing land(const ck_Collider &collider, double gap, double way_in, double pull, double dt) {
    Landing landing = {};
    landing.incoming = way_in / dt;
    if (way_in > 2 * std::fabs(pull) * dt * dt && collider.restitution > 0) {
        landing.leaving = ck_collider_rebound(collider.restitution, -gap, way_in / dt - pull * dt, pull, dt);
        landing.shift = dt * landing.leaving;
    } else {
        landing.shift = gap >= 0 ? -gap : push_share * -gap;
    }
    return landing;
}

// After detection, before links and contacts are solved: Coulomb's cone in place of a share of the speed, and nothing
// of Bullet's hardness, which would answer to what links do to the node. Bullet then removes n·way + (1 − c3)·slip.
void edit_contacts(btDynamicsWorld *world, btScalar dt) {
    Classic &state = *static_cast<Classic *>(world->getWorldUserInfo());
    const ck_BulletBody &body = state.body;
    state.landings.clear();
    for (int i = 0; i < body.soft->m_rcontacts.size(); i++) {
        btSoftBody::RContact &contact = body.soft->m_rcontacts[i];
        const ck_Collider &collider = ck_BulletColliders::of(body.model, contact.m_cti.m_colObj);
        const btVector3 &normal = contact.m_cti.m_normal;
        const btSoftBody::Node &node = *contact.m_node;
        auto index = contact.m_node - &body.soft->m_nodes[0];
        btVector3 way = node.m_x - node.m_q;
        // what links will add, by their tension at the start of the substep: it presses and pulls along, too
        btVector3 foreseen = way + state.tension[index] * (node.m_im * dt * dt);
        double way_in = -way.dot(normal), press = -foreseen.dot(normal);
        double slip = (foreseen + normal * press).length();
        double gap = node.m_q.dot(normal) + contact.m_cti.m_offset;
        double pull = -ck_bullet_field(body, body.particle_of_node[index]).dot(normal);
        Landing landing = land(collider, gap, way_in, pull, dt);
        landing.node = contact.m_node;
        landing.normal = normal;
        state.landings.push_back(landing);
        double push = std::fmax(0, press) + dt * landing.leaving;
        contact.m_c3 = slip > 0 ? 1 - std::fmin(1, collider.friction * push / slip) : 0;
        contact.m_c4 = 0;
    }
}

// Restitution, which Bullet lacks, and the way to the surface.
void finish_landings(Classic &state) {
    for (const Landing &landing : state.landings) {
        btSoftBody::Node &node = *landing.node;
        // links may have pulled it off
        if (node.m_v.dot(landing.normal) > 1e-6 * landing.incoming) continue;
        node.m_x += landing.normal * landing.shift;
        node.m_v += landing.normal * landing.leaving;
    }
}

void surround(Classic &state) {
    state.around = std::make_unique<Surroundings>();
    state.tension.resize(state.body.soft->m_nodes.size());
    World &world = state.around->world;
    world.setGravity(state.info.m_gravity);
    state.info.m_broadphase = &state.around->broadphase;
    state.info.m_dispatcher = &state.around->dispatcher;
    state.around->colliders.add(world, state.body, state.info);
    world.setInternalTickCallback(edit_contacts, &state);
    btSoftBody &soft = *state.body.soft;
    soft.m_cfg.collisions = btSoftBody::fCollision::SDF_RS;
    soft.setActivationState(DISABLE_DEACTIVATION);
    // contacts last: the other way round, links push nodes back in
    soft.m_cfg.m_psequence.clear();
    soft.m_cfg.m_psequence.push_back(btSoftBody::ePSolver::Linear);
    soft.m_cfg.m_psequence.push_back(btSoftBody::ePSolver::RContacts);
    world.addSoftBody(&soft);
}

std::unique_ptr<Classic> build(const ck_Model *model, const ck_Settings &used) {
    auto state = std::make_unique<Classic>();
    state->info.m_gravity = btVector3(model->gravity[0], model->gravity[1], model->gravity[2]);
    state->info.m_sparsesdf.Initialize();
    ck_bullet_body_build(state->body, model, used.substeps, used.reordered, &state->info);
    btSoftBody &soft = *state->body.soft;
    soft.m_cfg.piterations = static_cast<int>(used.iterations);
    soft.m_cfg.kDF = 1;
    soft.m_cfg.kDP = 1 - 1 / (1 + model->drag * state->body.dt);
    for (const ck_Spring *spring : state->body.spring) {
        double weight = spring_weight(model, *spring);
        state->kappa_over_weight.push_back(kappa(*spring, weight, state->body.dt, used) / weight);
    }
    state->field_force.assign(soft.m_nodes.size(), btVector3(model->force[0], model->force[1], model->force[2]));
    if (model->collider_count) surround(*state);
    return state;
}

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error) try {
    translate(model, wanted, used, ledger);
    auto state = std::make_unique<ClassicState>(ClassicState{ck_BulletScene(model), *used, nullptr});
    state->now = build(state->scene.model(), *used);
    *out = state.release();
    return CK_OK;
} catch (const std::bad_alloc &) {
    return ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// Before each step: Bullet's correction k·l(l² − L²)/(l² + L²) becomes Hooke's k·(l − L), and damping is added as a
// force.
void prepare_links(Classic &state) {
    btSoftBody &soft = *state.body.soft;
    std::fill(state.tension.begin(), state.tension.end(), btVector3(0, 0, 0));
    for (int i = 0; i < soft.m_links.size(); i++) {
        btSoftBody::Link &link = soft.m_links[i];
        const ck_Spring &spring = *state.body.spring[i];
        btVector3 d = link.m_n[1]->m_x - link.m_n[0]->m_x;
        double length = d.length(), rest = spring.rest;
        if (state.around && length > 0 && std::isfinite(spring.stiffness)) {
            btVector3 tension = d * (spring.stiffness * (length - rest) / length);
            state.tension[link.m_n[0] - &soft.m_nodes[0]] += tension;
            state.tension[link.m_n[1] - &soft.m_nodes[0]] -= tension;
        }
        link.m_c0 = length * (length + rest) / (length * length + rest * rest) / state.kappa_over_weight[i];
        if (spring.damping > 0 && length > 0) {
            btVector3 force = d * (spring.damping * d.dot(link.m_n[1]->m_v - link.m_n[0]->m_v) / (length * length));
            link.m_n[0]->m_f += force;
            link.m_n[1]->m_f -= force;
        }
    }
}

ck_StepResult step(void *out) {
    Classic &state = *static_cast<ClassicState *>(out)->now;
    btSoftBody &soft = *state.body.soft;
    for (uint32_t i = 0; i < state.body.substeps; i++) {
        prepare_links(state);
        if (state.body.model->terms & CK_TERM_FORCE)
            for (int node = 0; node < soft.m_nodes.size(); node++) soft.addForce(state.field_force[node], node);
        if (state.around) {
            state.around->world.step_once(state.body.dt);
            finish_landings(state);
            continue;
        }
        soft.predictMotion(state.body.dt);
        soft.solveConstraints();
    }
    return ck_bullet_body_is_finite(state.body) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

void read_state(const void *state, double *position, double *velocity) {
    ck_bullet_body_read(static_cast<const ClassicState *>(state)->now->body, position, velocity);
}

// Bullet keeps masses in many places: the body is built again.
void release(void *out, int particle) {
    ClassicState &state = *static_cast<ClassicState *>(out);
    std::vector<double> position(3 * state.scene.model()->particle_count), velocity(position.size());
    read_state(out, position.data(), velocity.data());
    state.scene.release(position.data(), velocity.data(), particle);
    state.now = build(state.scene.model(), state.used);
}

void destroy(void *state) {
    delete static_cast<ClassicState *>(state);
}

} // namespace

extern "C" const ck_Engine ck_bullet_pbd = {
    .name = "bullet-pbd",
    .about = "classic btSoftBody: position-based links, Hooke correction, static stiffness map",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_BULLET_PBD,
    .terms = CK_TERM_SPRINGS | CK_TERM_RIGID | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG |
             CK_TERM_VELOCITY | CK_TERM_PLANE | CK_TERM_SPHERE | CK_TERM_RELEASE,
    .shares_steps = false,
    .order = 1,
    .create = create,
    .step = step,
    .read = read_state,
    .release = release,
    .contact = nullptr,
    .destroy = destroy,
};
