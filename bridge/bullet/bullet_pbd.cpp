// Bullet's classic soft body: position-based, set up to answer to a physical stiffness.
//
// Without colliders the world around it has nothing to do, and only its cost and its float time step would be added:
// the body is stepped by the same calls that the world would make.
#include "bullet_contact.hpp"
#include "bullet_drive.hpp"
#include "bullet_landing.hpp"
#include "collider.h"
#include "engine.h"
#include "sweep_order.h"
#include "time_scale.h"

#include <BulletSoftBody/btDefaultSoftBodySolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <algorithm>
#include <btBulletDynamicsCommon.h>
#include <cmath>
#include <cstdlib>
#include <numeric>

extern "C" const char ck_code_bullet_pbd[];

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

// Without colliders there are no surroundings.
struct Classic {
    btSoftBodyWorldInfo info;
    std::unique_ptr<Surroundings> around;
    ck_BulletBody body;
    const ck_BulletLoops *loops = ck_bullet_loops();
    bool corrects;    // to Hooke's law: springs, whose share is not the user's own
    uint32_t substep; // since the start
    std::unique_ptr<ck_BulletOuter> outer;
    uint32_t apart;                      // substeps from one damping force to the next
    std::vector<btScalar> of_one, least; // of each link of the table: (w_a + w_b)/κ, and κ
    std::vector<int> slot;               // where its m_c0 is, in numbers from the first link's
    btVector3 field_force;               // N on each node
    ck_BulletLandings landings;          // of this substep

    ~Classic() {
        if (!around) return;
        around->world.removeSoftBody(body.soft.get());
        around->colliders.remove(around->world);
    }
};

// Its own settings, by their numbers.
enum { OWN_DAMPING, OWN_REORDERED };

struct ClassicState {
    ck_BulletModel scene;
    ck_Settings used;
    uint32_t frame = 0;
    bool is_too_far = false;
    std::unique_ptr<Classic> now; // NULL: there was no memory for it
    ClassicState(const ck_Model *model, const ck_Settings &settings) : scene(model), used(settings) {}
};

// The share κ = kLST of a link's error that one iteration removes.
// n = 1: the static map κ = q/(1 + q/2), q = k·dt²·W, which hangs a chain within 0.2 % for k·dt²/m ≤ 0.02.
// n > 1: κ = 1 − (1 + q)^(−1/n), exact for one free mass. Both end at 1, beyond which a link is unsafe.
double kappa(const ck_Spring &spring, double weight, double dt, const ck_Settings &used) {
    if (used.softness > 0) return used.softness;
    if (std::isinf(spring.stiffness)) return 1;
    uint32_t iterations = used.iterations;
    double q = spring.stiffness * dt * dt * weight;
    return iterations == 1 ? std::fmin(1, q / (1 + q / 2)) : 1 - std::pow(1 + q, -1.0 / iterations);
}

// The share of speed that damping takes in a substep.
double speed_taken(const ck_Model *model, const ck_Settings &used, double dt) {
    return ck_settings_own(&used, OWN_DAMPING, 1 - 1 / (1 + model->drag * dt));
}

double spring_weight(const ck_Model *model, const ck_Spring &spring) {
    return ck_model_inverse_mass(model, spring.a) + ck_model_inverse_mass(model, spring.b);
}

// How many substeps a damping force stands for: two, which halves what it costs, but one where it would take more than
// a relative speed. The correction to Hooke's law stands for twice as many.
uint32_t substeps_apart(const ck_Model *model, double dt) {
    return 2 * dt * ck_stability_damping_rate(model) > 1 ? 1 : 2;
}

// Time step: k·dt²/m ≤ 0.1 (k·dt²·W ≤ 0.2), where the static map is good to 1 %; rigid bars as for native-bars;
// damping, a force before every second step, half of what is stable; drag, first order, 2 % of a speed; where there is
// contact 1/240 s.
void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    uint32_t sweeps = model->terms & CK_TERM_RIGID ? ck_stability_sweeps(model) : 1;
    *used = ck_Settings{};
    used->substeps = wanted->substeps;
    used->iterations = wanted->iterations ? wanted->iterations : sweeps;
    used->softness = wanted->softness;
    ck_settings_take_own(used, wanted);
    double rate = ck_stability_stiffness_rate(model), limit = rate > 0 ? std::sqrt(0.2 / rate) : INFINITY;
    if (model->terms & CK_TERM_RIGID) limit = ck_stability_bar_time(model, used->iterations);
    limit = std::fmin(limit, 0.5 / ck_stability_damping_rate(model));
    limit = std::fmin(limit, ck_stability_drag_time(model, 0.02));
    if (model->collider_count || model->rigid_count) limit = std::fmin(limit, 1.0 / 240);
    limit = std::fmin(limit, ck_stability_bending_time(model));
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    double dt = model->step / used->substeps;
    ck_bullet_ledger(
        ledger, model, *used, "Node::m_f",
        "RContact::m_c3 edited to a cone of what presses: way into the surface and the tension of springs");
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (!spring) continue;
        double value = kappa(*spring, spring_weight(model, *spring), dt, *used);
        ck_ledger_add(ledger, {ck_stiffness_names[kind], spring->stiffness, "N/m", "Material::m_kLST", value,
                               used->softness > 0             ? "as set"
                               : model->terms & CK_TERM_RIGID ? "1: all of a bar's error in each iteration"
                               : used->iterations == 1
                                   ? "min(1, q/(1 + q/2)), q = k*dt^2*(wa + wb); Link::m_c0 corrected to Hooke"
                                   : "1 - (1 + q)^(-1/n), q = k*dt^2*(wa + wb); Link::m_c0 corrected to Hooke",
                               CK_APPROXIMATE});
    }
    ck_ledger_add_wind(ledger, model, "Node::m_f", "by face, before each step", CK_APPROXIMATE);
    ck_ledger_add_bending(ledger, model, "Node::m_f", "each hinge's force before each step: explicit", CK_APPROXIMATE);
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger,
                      {"spring damping", model->springs[0].damping, "N*s/m", "Node::m_f", model->springs[0].damping,
                       "c*(dv.n) before every second step: explicit", CK_APPROXIMATE});
    if ((model->terms & CK_TERM_DRAG) || ck_settings_has(used, CK_OWN + OWN_DAMPING))
        ck_ledger_add(ledger,
                      {"drag", model->drag, "1/s", "m_cfg.kDP", speed_taken(model, *used, dt),
                       ck_settings_has(used, CK_OWN + OWN_DAMPING) ? "as set" : "1 - 1/(1 + drag*dt)", CK_APPROXIMATE});
}

void edit_contacts(btDynamicsWorld *world, btScalar dt) {
    Classic &state = *static_cast<Classic *>(world->getWorldUserInfo());
    state.landings.edit_contacts(state.body, state.around->colliders, dt);
}

void surround(Classic &state) {
    state.around = std::make_unique<Surroundings>();
    state.landings.prepare(state.body);
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

// What goes by the substep, s: how much of a speed and of a link's error is taken.
void set_step(Classic &state, const ck_Settings &used, double dt) {
    const ck_Model *model = state.body.model;
    state.body.dt = dt;
    state.body.soft->m_cfg.kDP = speed_taken(model, used, dt);
    state.apart = substeps_apart(model, dt);
    state.of_one.clear();
    state.least.clear();
    for (int link : state.body.links.link) {
        const ck_Spring &spring = *state.body.spring[link];
        double weight = spring_weight(model, spring), share = kappa(spring, weight, dt, used);
        state.of_one.push_back(weight / share);
        state.least.push_back(share);
        state.body.soft->m_links[link].m_c0 = weight / share;
    }
}

std::unique_ptr<Classic> build(const ck_Model *model, const ck_Settings &used) {
    auto state = std::make_unique<Classic>();
    state->info.m_gravity = btVector3(model->gravity[0], model->gravity[1], model->gravity[2]);
    state->info.m_sparsesdf.Initialize();
    ck_bullet_body_build(state->body, model, used.substeps, ck_settings_own(&used, OWN_REORDERED, 0) > 0, &state->info);
    state->outer = std::make_unique<ck_BulletOuter>(state->body);
    btSoftBody &soft = *state->body.soft;
    soft.m_cfg.piterations = static_cast<int>(used.iterations);
    soft.m_cfg.kDF = 1;
    state->corrects = !(used.softness > 0) && !(model->terms & CK_TERM_RIGID);
    for (int link : state->body.links.link)
        state->slot.push_back(link * static_cast<int>(sizeof(btSoftBody::Link) / sizeof(btScalar)));
    set_step(*state, used, state->body.dt);
    state->field_force = btVector3(model->force[0], model->force[1], model->force[2]);
    if (model->collider_count || model->rigid_count) surround(*state);
    return state;
}

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error) {
    return ck_bullet_guarded(error, [&] {
        ck_Status status = ck_bullet_check_rigid(model, error);
        if (status) return status;
        translate(model, wanted, used, ledger);
        auto state = std::make_unique<ClassicState>(model, *used);
        state->now = build(state->scene.model(), *used);
        const Classic &now = *state->now;
        if (now.around) ck_bullet_check_reach(now.around->world, *now.body.soft, now.body.dt);
        *out = state.release();
        return CK_OK;
    });
}

// Before a step: Bullet's correction k·l(l² − L²)/(l² + L²) becomes Hooke's k·(l − L), but of no link more than its
// whole error is taken, which would explode; and damping is added as a force.
void prepare_links(Classic &state) {
    ck_BulletBody &body = state.body;
    btSoftBody &soft = *body.soft;
    bool corrects = state.corrects && state.substep % (2 * state.apart) == 0;
    bool is_damped = (body.model->terms & CK_TERM_DAMPING) && state.substep % state.apart == 0;
    state.substep++;
    if (!soft.m_links.size() || !(corrects || is_damped)) return;
    const ck_BulletLinks links = body.links.view();
    const ck_BulletNodes nodes = ck_bullet_nodes(body, &btSoftBody::Node::m_x);
    const ck_BulletHooke hooke = {state.of_one.data(), state.least.data(), state.slot.data(), &soft.m_links[0].m_c0};
    state.loops->prepare(&links, &nodes, &soft.m_nodes[0].m_f[0], is_damped ? state.apart : 0,
                         corrects ? &hooke : nullptr);
}

//   end  s, of the step
void step_once(Classic &state, double end) {
    btSoftBody &soft = *state.body.soft;
    ck_bullet_drive(state.body.model, end, state.body.dt, [&](int particle) -> btSoftBody::Node & {
        return soft.m_nodes[state.body.node_of_particle[particle]];
    });
    prepare_links(state);
    if (state.outer && state.outer->is_there()) {
        state.outer->update(&btSoftBody::Node::m_x);
        state.outer->add_forces([&](int node, const btVector3 &force) { soft.addForce(force, node); });
    }
    if (state.body.model->terms & CK_TERM_FORCE)
        for (int node = 0; node < soft.m_nodes.size(); node++) soft.addForce(state.field_force, node);
    if (state.around) {
        state.around->colliders.move(state.around->world, state.body, end - state.body.dt);
        state.around->colliders.rigid.push();
        ck_bullet_check_reach(state.around->world, soft, state.body.dt);
        state.around->world.step_once(state.body.dt);
        state.landings.finish(state.around->colliders);
        return;
    }
    soft.predictMotion(state.body.dt);
    soft.solveConstraints();
}

ck_StepResult step(void *out) {
    ClassicState &all = *static_cast<ClassicState *>(out);
    if (!all.now) return CK_STEP_NO_MEMORY;
    Classic &state = *all.now;
    ck_Status status = ck_bullet_guarded(nullptr, [&] {
        if (state.around) state.around->colliders.follow(state.around->world, state.body);
        const double start = all.frame++ * state.body.model->step;
        for (uint32_t i = 0; i < state.body.substeps; i++) step_once(state, start + (i + 1) * state.body.dt);
        return CK_OK;
    });
    all.is_too_far = status == CK_REFUSED;
    if (status) return ck_bullet_result(status);
    if (state.around && !state.around->colliders.rigid.is_finite()) return CK_STEP_DIVERGED;
    return ck_bullet_body_is_finite(state.body) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

void pace(void *out, double duration) {
    ClassicState &state = *static_cast<ClassicState *>(out);
    if (state.now) set_step(*state.now, state.used, duration / state.used.substeps);
}

void read_state(const void *out, double *position, double *velocity) {
    const ClassicState &state = *static_cast<const ClassicState *>(out);
    if (!state.now) return;
    ck_bullet_body_read(state.now->body, state.scene.length(), position, velocity);
    if (state.now->around)
        state.now->around->colliders.rigid.read(state.scene.model(), state.scene.length(), position, velocity);
}

void read_turn(const void *out, ck_Turn *turn) {
    const ClassicState &state = *static_cast<const ClassicState *>(out);
    if (state.now && state.now->around) state.now->around->colliders.rigid.read_turns(state.scene.first_rigid(), turn);
}

// Bullet keeps masses in many places: the body is built again.
void release(void *out, int particle) {
    ClassicState &state = *static_cast<ClassicState *>(out);
    ck_Status status = ck_bullet_guarded(nullptr, [&] {
        std::vector<double> position(3 * state.scene.model()->particle_count), velocity(position.size());
        read_state(out, position.data(), velocity.data());
        std::vector<ck_Turn> turn(static_cast<size_t>(state.scene.model()->rigid_count));
        read_turn(out, turn.data());
        state.scene.release(position.data(), velocity.data(), turn.data(), particle);
        state.now = build(state.scene.model(), state.used);
        return CK_OK;
    });
    if (status) state.now.reset();
}

const char *remark(const void *out) {
    return static_cast<const ClassicState *>(out)->is_too_far ? ck_bullet_too_far : nullptr;
}

void destroy(void *state) {
    delete static_cast<ClassicState *>(state);
}

ck_Status code(ck_Code *code, const ck_ScaledModel *scaled, const ck_Settings *used, ck_Error *error) {
    const ck_Model *model = &scaled->model;
    bool corrects = !(used->softness > 0) && !(model->terms & CK_TERM_RIGID);
    code->text = ck_code_bullet_pbd;
    code->extension = "cpp";
    ck_code_number(code, "kdp", speed_taken(model, *used, model->step / used->substeps));
    ck_code_number(code, "share", used->softness);
    ck_code_number(code, "apart", substeps_apart(model, model->step / used->substeps));
    ck_code_number(code, "margin", ck_bullet_margin(model));
    ck_code_part(code, "softness", used->softness > 0);
    ck_code_part(code, "corrects", corrects);
    ck_code_part(code, "prepares", corrects || model->terms & CK_TERM_DAMPING);
    ck_code_text(code, "obstacles", "cloth->around->obstacles");
    ck_code_text(code, "world", "cloth->around->world");
    if (!(ck_settings_own(used, OWN_REORDERED, 0) > 0)) return CK_OK;
    code->order = static_cast<int *>(std::malloc(sizeof(int) * static_cast<size_t>(model->spring_count) + 1));
    if (!code->order) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    std::iota(code->order, code->order + model->spring_count, 0);
    ck_Status status = ck_sweep_order(model, CK_PROJECT_SPRINGS, 1, code->order);
    return status ? ck_fail(error, status, "out of memory") : CK_OK;
}

const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "k*dt^2/m <= 0.1, and what damping and contact ask for",
     .help = "steps a frame"},
    {.name = "piterations",
     .slot = CK_ITERATIONS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "1; of rigid bars 4 where they outnumber freedoms",
     .help = "m_cfg.piterations: sweeps over links a substep",
     .also = "iterations"},
    {.name = "kLST",
     .slot = CK_SOFTNESS,
     .least = 1e-9,
     .most = 1,
     .unit = "1",
     .rule = "a map of each spring's k, corrected to Hooke's law",
     .help = "Material::m_kLST of every link, as it is",
     .also = "klst"},
    {.name = "kDP",
     .slot = CK_OWN + OWN_DAMPING,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "1 - 1/(1 + drag*dt)",
     .help = "m_cfg.kDP: share of speed taken in each substep",
     .leaves_theory = true},
    {.name = "reordered",
     .slot = CK_OWN + OWN_REORDERED,
     .is_whole = true,
     .least = 0,
     .most = 1,
     .unit = "1",
     .rule = "0: the scene's order",
     .help = "1: links in an order in which neighbours do not wait for each other"},
    {},
};

} // namespace

extern "C" const ck_Engine ck_bullet_pbd = {
    .name = "bullet-pbd" CK_BULLET_SUFFIX,
    .about = "classic btSoftBody: position-based links, Hooke correction, static stiffness map",
    .family = "Bullet",
    .version = ck_bullet_version,
    .method = CK_METHOD_BULLET_PBD,
    .terms = CK_TERM_SPRINGS | CK_TERM_RIGID | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG |
             CK_TERM_VELOCITY | CK_TERM_COLLIDERS | CK_TERM_RELEASE | CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_MOVES |
             CK_TERM_MOVING_COLLIDERS | CK_TERM_BODIES | CK_TERM_JITTER,
    .settings = settings,
    .is_single = CK_BULLET_IS_SINGLE,
    .order = 1,
    .rest_order = 2,
    .damped_rest_order = 2,
    .create = create,
    .step = step,
    .pace = pace,
    .read = read_state,
    .release = release,
    .contact = nullptr,
    .turn = read_turn,
    .remark = remark,
    .destroy = destroy,
    .code = code,
};
