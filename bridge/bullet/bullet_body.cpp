#include "bullet_body.hpp"

#include "path.h"
#include "sweep_order.h"
#include "vector.h"

#include <algorithm>
#include <cmath>
#include <numeric>

ck_BulletModel::ck_BulletModel(const ck_Model *scene) : scaled(), first(scene->rigid) {
    if (ck_scaled_model_create(&scaled, scene)) throw std::bad_alloc();
}

ck_BulletModel::~ck_BulletModel() {
    ck_scaled_model_free(&scaled);
}

void ck_BulletModel::release(const double *at, const double *speed, const ck_Turn *turn, int particle) {
    ck_Model &now = scaled.model;
    for (int i = 0; i < 3 * now.particle_count; i++) {
        now.position[i] = at[i] / scaled.length;
        now.velocity[i] = speed[i] / scaled.length;
    }
    for (int i = 0; i < now.rigid_count; i++) {
        ck_RigidBody &rigid = now.rigid[i];
        rigid.shape = ck_rigid_place(&rigid, now.position + 3 * rigid.particle, ck_rigid_start(&rigid).rotation);
        for (int k = 0; k < 3; k++) ck_rigid_rotate(rigid.shape.axes[k], turn[i].rotation, first[i].shape.axes[k]);
        std::copy_n(turn[i].spin, 3, rigid.spin);
    }
    if (!ck_driven_find(&now, particle, 0)) std::fill_n(now.velocity + 3 * particle, 3, 0.0);
    now.pinned[particle] = false;
}

ck_BulletLinks ck_BulletLinkTable::view() {
    return {static_cast<int>(start.size()) - 1,
            start.data(),
            other.data(),
            rest.data(),
            stiffness.data(),
            damping.data(),
            normal.data(),
            length.data()};
}

static btVector3 vector_at(const double *values, int index) {
    return btVector3(values[3 * index], values[3 * index + 1], values[3 * index + 2]);
}

static void add_links(ck_BulletBody &body, bool reordered) {
    btSoftBody *soft = body.soft.get();
    btSoftBody::Material *material = soft->appendMaterial();
    std::vector<int> order(body.model->spring_count);
    std::iota(order.begin(), order.end(), 0);
    if (reordered && ck_sweep_order(body.model, CK_PROJECT_SPRINGS, 1, order.data())) throw std::bad_alloc();
    for (int i : order) {
        const ck_Spring *spring = &body.model->springs[i];
        if (body.model->pinned[spring->a] && body.model->pinned[spring->b]) continue;
        // without the check for doubles, which searches all links for each one
        soft->appendLink(body.node_of_particle[spring->a], body.node_of_particle[spring->b], material, false);
        body.spring.push_back(spring);
    }
    // the order matters: Bullet's first step takes current lengths for rest lengths unless its flag is down
    soft->updateConstants();
    soft->m_bUpdateRtCst = false;
    for (int i = 0; i < soft->m_links.size(); i++) {
        soft->m_links[i].m_rl = body.spring[i]->rest;
        soft->m_links[i].m_c1 = body.spring[i]->rest * body.spring[i]->rest;
    }
}

// Sorted by counting.
static void fill_table(ck_BulletBody &body) {
    ck_BulletLinkTable &table = body.links;
    const btSoftBody &soft = *body.soft;
    const int links = soft.m_links.size();
    auto index = [&](int link, int end) { return static_cast<int>(soft.m_links[link].m_n[end] - &soft.m_nodes[0]); };
    table.start.assign(soft.m_nodes.size() + 1, 0);
    for (int i = 0; i < links; i++) table.start[index(i, 0) + 1]++;
    std::partial_sum(table.start.begin(), table.start.end(), table.start.begin());
    std::vector<int> next(table.start);
    table.other.resize(links);
    table.link.resize(links);
    for (auto *values : {&table.rest, &table.stiffness, &table.damping, &table.length}) values->resize(links);
    table.normal.assign(4 * static_cast<size_t>(links), 0);
    for (int i = 0; i < links; i++) {
        const int at = next[index(i, 0)]++;
        table.other[at] = index(i, 1);
        table.link[at] = i;
        table.rest[at] = body.spring[i]->rest;
        table.stiffness[at] = body.spring[i]->stiffness;
        table.damping[at] = body.spring[i]->damping;
    }
}

void ck_bullet_body_build(ck_BulletBody &body, const ck_Model *model, uint32_t substeps, bool reordered,
                          btSoftBodyWorldInfo *info) {
    body.model = model;
    body.substeps = substeps;
    body.dt = model->step / substeps;
    body.node_of_particle.resize(model->particle_count);
    std::vector<btVector3> position;
    std::vector<btScalar> mass;
    for (bool pinned : {false, true})
        for (int i = 0; i < ck_model_cloth_count(model); i++) {
            if (model->pinned[i] != pinned) continue;
            body.node_of_particle[i] = static_cast<int>(position.size());
            position.push_back(vector_at(model->position, i));
            body.particle_of_node.push_back(i);
            mass.push_back(pinned ? 0 : model->mass[i]);
        }
    body.soft = std::make_unique<btSoftBody>(info, static_cast<int>(position.size()), position.data(), mass.data());
    add_links(body, reordered);
    fill_table(body);
    for (int i = 0; i < ck_model_cloth_count(model); i++) {
        btSoftBody::Node &node = body.soft->m_nodes[body.node_of_particle[i]];
        node.m_v = node.m_vn = vector_at(model->velocity, i);
    }
}

ck_BulletNodes ck_bullet_nodes(const ck_BulletBody &body, btVector3 btSoftBody::Node::*position) {
    static_assert(sizeof(btSoftBody::Node) % sizeof(btScalar) == 0, "nodes are whole numbers apart");
    const btSoftBody::Node &first = body.soft->m_nodes[0];
    return {&(first.*position)[0], &first.m_v[0], sizeof first / sizeof(btScalar)};
}

void ck_bullet_body_read(const ck_BulletBody &body, double length, double *position, double *velocity) {
    for (int i = 0; i < ck_model_cloth_count(body.model); i++) {
        const btSoftBody::Node &node = body.soft->m_nodes[body.node_of_particle[i]];
        for (int axis = 0; axis < 3; axis++) {
            position[3 * i + axis] = length * node.m_x[axis];
            velocity[3 * i + axis] = length * node.m_v[axis];
        }
    }
}

ck_BulletOuter::ck_BulletOuter(const ck_BulletBody &owner) : body(owner) {
    if (!is_there()) return;
    const size_t count = 3 * static_cast<size_t>(body.model->particle_count);
    at.resize(count);
    speed.resize(count);
    force.resize(count);
    pull.resize(static_cast<size_t>(body.model->hinge_count));
}

void ck_BulletOuter::update(btVector3 btSoftBody::Node::*position) {
    for (int i = 0; i < ck_model_cloth_count(body.model); i++)
        for (int axis = 0; axis < 3; axis++) {
            at[static_cast<size_t>(3 * i + axis)] = (body.soft->m_nodes[node(i)].*position)[axis];
            speed[static_cast<size_t>(3 * i + axis)] = body.soft->m_nodes[node(i)].m_v[axis];
        }
    std::fill(force.begin(), force.end(), 0);
    ck_hinges_add_force(body.model, at.data(), 1, nullptr, force.data());
    ck_wind_add_force(body.model, at.data(), speed.data(), nullptr, force.data());
    for (int i = 0; i < body.model->hinge_count; i++)
        pull[static_cast<size_t>(i)] = std::fmax(0, ck_hinge_state(&body.model->hinges[i], at.data()).pull);
}

bool ck_bullet_body_is_finite(const ck_BulletBody &body) {
    for (int i = 0; i < body.soft->m_nodes.size(); i++) {
        const btSoftBody::Node &node = body.soft->m_nodes[i];
        if (!std::isfinite(node.m_x.length2()) || !std::isfinite(node.m_v.length2())) return false;
    }
    return true;
}

static void ledger_contact(ck_Ledger *ledger, const ck_Model *model, const char *friction_formula) {
    ck_ledger_add_colliders(ledger, model,
                            {"restitution", 0, "1", "none", 0,
                             "the bridge gives contact nodes e times the speed they met the surface with",
                             CK_APPROXIMATE},
                            {"friction", 0, "1", "setFriction", 0, friction_formula, CK_APPROXIMATE});
}

void ck_bullet_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings &used, const char *force_parameter,
                      const char *friction_formula) {
    ck_scaled_model_ledger(ledger, model);
    ck_ledger_add(ledger,
                  {"time step", model->step, "s", "dt", model->step / used.substeps, "step / substeps", CK_EXACT});
    ck_ledger_add_masses(ledger, model, {"mass", 0, "kg", "Node::m_im", 0, "1/m, 0 where pinned", CK_EXACT}, true);
    double gravity = ck_length(model->gravity), force = ck_length(model->force);
    if (model->terms & CK_TERM_GRAVITY)
        ck_ledger_add(ledger, {"gravity", gravity, "m/s2", "m_gravity", gravity, "g", CK_EXACT});
    if (model->terms & CK_TERM_FORCE)
        ck_ledger_add(ledger, {"force", force, "N", force_parameter, force, "F", CK_EXACT});
    ledger_contact(ledger, model, friction_formula);
}
