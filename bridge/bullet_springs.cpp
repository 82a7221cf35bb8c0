#include "bullet_springs.hpp"

// the direction and length of a link at the current iterate; a zero direction where its ends coincide
static btVector3 direction(const btSoftBody::Link &link, double &length) {
    btVector3 d = link.m_n[1]->m_q - link.m_n[0]->m_q;
    length = d.length();
    return length > 0 ? d / length : btVector3(0, 0, 0);
}

void ck_BulletSprings::addScaledForces(btScalar scale, TVStack &force) {
    addScaledExplicitForce(scale, force);
    addScaledDampingForce(scale, force);
}

void ck_BulletSprings::addScaledExplicitForce(btScalar scale, TVStack &force) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_links.size(); i++) {
        const btSoftBody::Link &link = soft.m_links[i];
        double length;
        btVector3 n = direction(link, length);
        btVector3 tension = n * (scale * body.spring[i]->stiffness * (length - body.spring[i]->rest));
        force[link.m_n[0]->index] += tension;
        force[link.m_n[1]->index] -= tension;
    }
    if (!(body.model->terms & CK_TERM_FORCE)) return;
    btVector3 field(body.model->force[0], body.model->force[1], body.model->force[2]);
    for (int i = 0; i < soft.m_nodes.size(); i++)
        if (soft.m_nodes[i].m_im > 0) force[soft.m_nodes[i].index] += scale * field;
}

void ck_BulletSprings::addScaledDampingForce(btScalar scale, TVStack &force) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_links.size() && (body.model->terms & CK_TERM_DAMPING); i++) {
        const btSoftBody::Link &link = soft.m_links[i];
        double length;
        btVector3 n = direction(link, length);
        btVector3 tension = n * (scale * body.spring[i]->damping * n.dot(link.m_n[1]->m_v - link.m_n[0]->m_v));
        force[link.m_n[0]->index] += tension;
        force[link.m_n[1]->index] -= tension;
    }
    for (int i = 0; i < soft.m_nodes.size() && (body.model->terms & CK_TERM_DRAG); i++)
        if (soft.m_nodes[i].m_im > 0)
            force[soft.m_nodes[i].index] -= scale * body.model->drag / soft.m_nodes[i].m_im * soft.m_nodes[i].m_v;
}

void ck_BulletSprings::addScaledElasticForceDifferential(btScalar scale, const TVStack &dx, TVStack &df) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_links.size(); i++) {
        const btSoftBody::Link &link = soft.m_links[i];
        double length;
        btVector3 n = direction(link, length);
        if (!(length > 0)) continue;
        btVector3 relative = dx[link.m_n[1]->index] - dx[link.m_n[0]->index];
        btVector3 along = n * n.dot(relative);
        double transverse = btMax(0.0, 1 - body.spring[i]->rest / length);
        btVector3 change = scale * body.spring[i]->stiffness * (along + transverse * (relative - along));
        df[link.m_n[0]->index] += change;
        df[link.m_n[1]->index] -= change;
    }
}

void ck_BulletSprings::addScaledDampingForceDifferential(btScalar scale, const TVStack &dv, TVStack &df) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_links.size() && (body.model->terms & CK_TERM_DAMPING); i++) {
        const btSoftBody::Link &link = soft.m_links[i];
        double length;
        btVector3 n = direction(link, length);
        btVector3 change =
            n * (scale * body.spring[i]->damping * n.dot(dv[link.m_n[1]->index] - dv[link.m_n[0]->index]));
        df[link.m_n[0]->index] += change;
        df[link.m_n[1]->index] -= change;
    }
    for (int i = 0; i < soft.m_nodes.size() && (body.model->terms & CK_TERM_DRAG); i++) {
        const btSoftBody::Node &node = soft.m_nodes[i];
        if (node.m_im > 0) df[node.index] -= scale * body.model->drag / node.m_im * dv[node.index];
    }
}

// only the preconditioner reads it: what it leaves out costs iterations, not accuracy
void ck_BulletSprings::buildDampingForceDifferentialDiagonal(btScalar scale, TVStack &diagonal) {
    btSoftBody &soft = *body.soft;
    for (int i = 0; i < soft.m_nodes.size() && (body.model->terms & CK_TERM_DRAG); i++) {
        const btSoftBody::Node &node = soft.m_nodes[i];
        if (node.m_im > 0) diagonal[node.index] -= btVector3(1, 1, 1) * (scale * body.model->drag / node.m_im);
    }
}
