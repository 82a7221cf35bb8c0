#include "bullet_landing.hpp"

#include "collider.h"

#include <cmath>

void ck_BulletLandings::prepare(const ck_BulletBody &body) {
    links_of.resize(static_cast<size_t>(body.soft->m_nodes.size()));
    for (int i = 0; i < body.soft->m_links.size(); i++)
        for (const btSoftBody::Node *node : body.soft->m_links[i].m_n)
            links_of[static_cast<size_t>(node - &body.soft->m_nodes[0])].push_back(i);
}

// Share of a depth that is pushed out in a step: without speed, so that nothing bounces by it.
static const double push_share = 0.2;

// What a node does after meeting the surface from a gap, at way_in m in this step: rebounds, goes down to the surface,
// or slowly out of it.
static ck_BulletLanding land(const ck_Collider &collider, double gap, double way_in, double pull, double dt) {
    ck_BulletLanding landing = {};
    landing.incoming = way_in / dt;
    if (way_in > 2 * std::fabs(pull) * dt * dt && collider.restitution > 0) {
        landing.leaving = ck_collider_rebound(collider.restitution, -gap, way_in / dt - pull * dt, pull, dt);
        landing.shift = dt * landing.leaving;
    } else {
        landing.shift = gap >= 0 ? -gap : push_share * -gap;
    }
    return landing;
}

// N, of the springs on a node at the start of the substep; rigid bars have none that is known.
btVector3 ck_BulletLandings::tension_of(const ck_BulletBody &body, int index) const {
    btVector3 tension(0, 0, 0);
    for (int link : links_of[static_cast<size_t>(index)]) {
        const btSoftBody::Link &one = body.soft->m_links[link];
        const ck_Spring &spring = *body.spring[link];
        const btSoftBody::Node &node = body.soft->m_nodes[index];
        const btSoftBody::Node &other = one.m_n[0] == &node ? *one.m_n[1] : *one.m_n[0];
        btVector3 d = other.m_q - node.m_q;
        double length = d.length();
        if (length > 0 && std::isfinite(spring.stiffness))
            tension += d * (spring.stiffness * (length - spring.rest) / length);
    }
    return tension;
}

void ck_BulletLandings::edit_contacts(const ck_BulletBody &body, const ck_BulletColliders &colliders, btScalar dt) {
    landings.clear();
    for (int i = 0; i < body.soft->m_rcontacts.size(); i++) {
        btSoftBody::RContact &contact = body.soft->m_rcontacts[i];
        const ck_Collider &collider = colliders.at_start(contact.m_cti.m_colObj);
        const btSoftBody::Node &node = *contact.m_node;
        const btVector3 carried = ck_BulletColliders::speed(contact.m_cti.m_colObj, node.m_q);
        // Bullet's normals are slopes of a grid, off by a hundredth on a ball whose radius is sixty of its voxels
        double out[3], gap = ck_bullet_gap(collider, node.m_q, out);
        const btVector3 normal(out[0], out[1], out[2]);
        contact.m_cti.m_normal = normal;
        auto index = contact.m_node - &body.soft->m_nodes[0];
        btVector3 way = node.m_x - node.m_q - carried * dt;
        // what links will add, by their tension at the start of the substep: it presses and pulls along, too
        btVector3 foreseen = way + tension_of(body, static_cast<int>(index)) * (node.m_im * dt * dt);
        double way_in = -way.dot(normal), press = -foreseen.dot(normal);
        double slip = (foreseen + normal * press).length();
        double pull = -ck_bullet_field(body, body.particle_of_node[index]).dot(normal);
        ck_BulletLanding landing = land(collider, gap, way_in, pull, dt);
        landing.node = contact.m_node;
        landing.normal = normal;
        landing.carried = carried;
        landing.object = contact.m_cti.m_colObj;
        landings.push_back(landing);
        double push = std::fmax(0, press) + dt * landing.leaving;
        contact.m_c3 = slip > 0 ? 1 - std::fmin(1, collider.friction * push / slip) : 0;
        contact.m_c4 = 0;
    }
}

void ck_BulletLandings::finish(const ck_BulletColliders &colliders) const {
    for (const ck_BulletLanding &landing : landings) {
        btSoftBody::Node &node = *landing.node;
        // links may have pulled it off
        if ((node.m_v - landing.carried).dot(landing.normal) > 1e-6 * landing.incoming) continue;
        node.m_x += landing.normal * landing.shift;
        node.m_v += landing.normal * landing.leaving;
        if (landing.leaving > 0)
            colliders.strike(landing.object, landing.normal * (-landing.leaving / node.m_im), node.m_x);
    }
}
