// Bullet's classic soft body: position-based, set up to answer to a physical stiffness.
//
// Without colliders the world around it has nothing to do, and only its cost and its float time step would be added:
// the body is stepped by the same three calls that the world would make.
#include "bullet_body.hpp"
#include "engine_list.h"
#include "stability.h"

#include <cmath>

namespace {

struct ClassicState {
    btSoftBodyWorldInfo info;
    ck_BulletBody body;
    std::vector<double> kappa_over_weight; // of each link: κ/(w_a + w_b)
    std::vector<btVector3> field_force;    // N on each node
};

// The share κ = kLST of a link's error that one iteration removes.
// n = 1: the static map κ = q/(1 + q/2), q = k·dt²·W, which hangs a chain within 0.2 % for k·dt²/m ≤ 0.02.
// n > 1: κ = 1 − (1 + q)^(−1/n), exact for one free mass. Both end at 1, beyond which a link is unsafe.
double kappa(const ck_Spring &spring, double weight, double dt, uint32_t iterations) {
    if (std::isinf(spring.stiffness)) return 1;
    double q = spring.stiffness * dt * dt * weight;
    return iterations == 1 ? std::fmin(1, q / (1 + q / 2)) : 1 - std::pow(1 + q, -1.0 / iterations);
}

double spring_weight(const ck_Model *model, const ck_Spring &spring) {
    return ck_model_inverse_mass(model, spring.a) + ck_model_inverse_mass(model, spring.b);
}

// Time step: k·dt²/m ≤ 0.1 (k·dt²·W ≤ 0.2), where the static map is good to 1 %; rigid bars as for native-bars;
// damping, a force before the step, takes at most half of a relative speed; drag, first order, 2 % of a speed.
void translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger) {
    *used = ck_Settings{wanted->substeps, wanted->iterations ? wanted->iterations : 1, 0};
    double rate = ck_stability_stiffness_rate(model), limit = rate > 0 ? std::sqrt(0.2 / rate) : INFINITY;
    if (model->terms & CK_TERM_RIGID) limit = ck_stability_bar_time(model, used->iterations);
    for (int i = 0; i < model->spring_count; i++)
        limit = std::fmin(limit, 0.5 / (model->springs[i].damping * spring_weight(model, model->springs[i])));
    limit = std::fmin(limit, ck_stability_drag_time(model, 0.02));
    if (!used->substeps) used->substeps = ck_stability_substeps(model, limit);
    double dt = model->step / used->substeps;
    ck_bullet_ledger(ledger, model, *used, "Node::m_f");
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, static_cast<ck_SpringKind>(kind));
        if (!spring) continue;
        double value = kappa(*spring, spring_weight(model, *spring), dt, used->iterations);
        ck_ledger_add(ledger,
                      {ck_stiffness_names[kind], spring->stiffness, "N/m", "Material::m_kLST", value,
                       used->iterations == 1
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

ck_Status create(void **out, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                 ck_Error *error) try {
    translate(model, wanted, used, ledger);
    auto state = std::make_unique<ClassicState>();
    state->info.m_gravity = btVector3(model->gravity[0], model->gravity[1], model->gravity[2]);
    state->info.m_sparsesdf.Initialize();
    ck_bullet_body_build(state->body, model, used->substeps, &state->info);
    btSoftBody &soft = *state->body.soft;
    soft.m_cfg.piterations = static_cast<int>(used->iterations);
    soft.m_cfg.kDF = 1;
    soft.m_cfg.kDP = 1 - 1 / (1 + model->drag * state->body.dt);
    for (const ck_Spring *spring : state->body.spring) {
        double weight = spring_weight(model, *spring);
        state->kappa_over_weight.push_back(kappa(*spring, weight, state->body.dt, used->iterations) / weight);
    }
    state->field_force.assign(soft.m_nodes.size(), btVector3(model->force[0], model->force[1], model->force[2]));
    *out = state.release();
    return CK_OK;
} catch (const std::bad_alloc &) {
    return ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// Before each step: Bullet's correction k·l(l² − L²)/(l² + L²) becomes Hooke's k·(l − L), and damping is added as a
// force.
void prepare_links(ClassicState &state) {
    btSoftBody &soft = *state.body.soft;
    for (int i = 0; i < soft.m_links.size(); i++) {
        btSoftBody::Link &link = soft.m_links[i];
        const ck_Spring &spring = *state.body.spring[i];
        btVector3 d = link.m_n[1]->m_x - link.m_n[0]->m_x;
        double length = d.length(), rest = spring.rest;
        link.m_c0 = length * (length + rest) / (length * length + rest * rest) / state.kappa_over_weight[i];
        if (spring.damping > 0 && length > 0) {
            btVector3 force = d * (spring.damping * d.dot(link.m_n[1]->m_v - link.m_n[0]->m_v) / (length * length));
            link.m_n[0]->m_f += force;
            link.m_n[1]->m_f -= force;
        }
    }
}

ck_StepResult step(void *out) {
    ClassicState &state = *static_cast<ClassicState *>(out);
    btSoftBody &soft = *state.body.soft;
    for (uint32_t i = 0; i < state.body.substeps; i++) {
        prepare_links(state);
        if (state.body.model->terms & CK_TERM_FORCE)
            for (int node = 0; node < soft.m_nodes.size(); node++) soft.addForce(state.field_force[node], node);
        soft.predictMotion(state.body.dt);
        soft.solveConstraints();
    }
    return ck_bullet_body_is_finite(state.body) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

void read_state(const void *state, double *position, double *velocity) {
    ck_bullet_body_read(static_cast<const ClassicState *>(state)->body, position, velocity);
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
             CK_TERM_VELOCITY,
    .order = 1,
    .create = create,
    .step = step,
    .read = read_state,
    .destroy = destroy,
};
