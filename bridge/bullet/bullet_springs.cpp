#include "bullet_springs.hpp"

ck_BulletSprings::ck_BulletSprings(ck_BulletBody &owner, bool implicit)
    : body(owner), loops(ck_bullet_loops()), outer(owner), is_implicit(implicit),
      is_damped(owner.model->terms & (CK_TERM_DAMPING | CK_TERM_DRAG)), has_force(owner.model->terms & CK_TERM_FORCE),
      along(owner.links.rest.size()), across(owner.links.rest.size()), own(owner.soft->m_nodes.size()), made_for{0, 0},
      is_stale(true), damping_scale_before(0) {}

// Normals and lengths are those of the current iterate, m_q.
void ck_BulletSprings::add_forces(btScalar elastic_scale, btScalar damping_scale, TVStack &force) {
    btSoftBody &soft = *body.soft;
    const ck_BulletLinks links = body.links.view();
    double damps = body.model->terms & CK_TERM_DAMPING ? damping_scale : 0;
    const ck_BulletNodes nodes = ck_bullet_nodes(body, &btSoftBody::Node::m_q);
    loops->pull(&links, &nodes, &force[0][0], elastic_scale, damps);
    is_stale = true;
    if (outer.is_there() && elastic_scale != 0) {
        outer.update(&btSoftBody::Node::m_q);
        outer.add_forces([&](int node, const btVector3 &pull) { force[node] += elastic_scale * pull; });
    }
    const btVector3 field(body.model->force[0], body.model->force[1], body.model->force[2]);
    for (int i = 0; i < soft.m_nodes.size() && has_force && elastic_scale != 0; i++)
        if (soft.m_nodes[i].m_im > 0) force[i] += elastic_scale * field;
    for (int i = 0; i < soft.m_nodes.size() && body.model->drag > 0 && damping_scale != 0; i++)
        if (soft.m_nodes[i].m_im > 0)
            force[i] -= damping_scale * body.model->drag / soft.m_nodes[i].m_im * soft.m_nodes[i].m_v;
}

void ck_BulletSprings::addScaledForces(btScalar scale, TVStack &force) {
    add_forces(scale, scale, force);
}

void ck_BulletSprings::addScaledExplicitForce(btScalar scale, TVStack &force) {
    add_forces(scale, 0, force);
}

void ck_BulletSprings::addScaledDampingForce(btScalar scale, TVStack &force) {
    if (is_damped) add_forces(0, scale, force);
}

// Bullet asks for both differentials in turn, some hundred times a step: they are answered in one pass, with all that
// does not change from one to the next made before.
void ck_BulletSprings::multiply(btScalar elastic_scale, btScalar damping_scale, const TVStack &d, TVStack &result) {
    const ck_BulletLinks links = body.links.view();
    // damping alone does not depend on lengths
    bool is_new = made_for[0] != elastic_scale || made_for[1] != damping_scale;
    if (is_new || (is_stale && elastic_scale != 0)) {
        for (size_t i = 0; i < along.size(); i++) {
            double length = links.length[i], stiffness = elastic_scale * links.stiffness[i];
            double transverse = length > 0 ? btMax(0.0, 1 - links.rest[i] / length) : 0;
            along[i] = stiffness * (1 - transverse) + damping_scale * links.damping[i];
            across[i] = stiffness * transverse;
        }
        for (size_t i = 0; i < own.size(); i++) {
            double weight = body.soft->m_nodes[static_cast<int>(i)].m_im;
            own[i] = weight > 0 ? damping_scale * body.model->drag / weight : 0;
        }
        made_for[0] = elastic_scale;
        made_for[1] = damping_scale;
        is_stale = false;
    }
    if (outer.is_there() && elastic_scale != 0) outer.multiply(elastic_scale, d, result);
    loops->multiply(&links, along.data(), elastic_scale != 0 ? across.data() : nullptr, own.data(), &d[0][0],
                    &result[0][0]);
}

void ck_BulletSprings::addScaledDampingForceDifferential(btScalar scale, const TVStack &dv, TVStack &df) {
    // the elastic one follows, and answers for both
    damping_scale_before = is_damped ? scale : 0;
    if (!is_implicit && is_damped) multiply(0, scale, dv, df);
}

void ck_BulletSprings::addScaledElasticForceDifferential(btScalar scale, const TVStack &dx, TVStack &df) {
    multiply(scale, damping_scale_before, dx, df);
}

// only the preconditioner reads it: what it leaves out costs iterations, not accuracy
void ck_BulletSprings::buildDampingForceDifferentialDiagonal(btScalar scale, TVStack &diagonal) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_nodes.size() && body.model->drag > 0; i++) {
        const btSoftBody::Node &node = soft.m_nodes[i];
        if (node.m_im > 0) diagonal[i] -= btVector3(1, 1, 1) * (scale * body.model->drag / node.m_im);
    }
}
