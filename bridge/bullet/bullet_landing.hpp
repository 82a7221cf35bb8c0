// How nodes of the classic soft body meet surfaces: Coulomb's cone and restitution, in place of what Bullet does.
#ifndef CK_BULLET_LANDING_HPP
#define CK_BULLET_LANDING_HPP

#include "bullet_contact.hpp"

// What is left to do for a node in contact once links and contacts are solved, which leaves it without normal motion.
struct ck_BulletLanding {
    btSoftBody::Node *node;
    btVector3 normal;
    btVector3 carried; // m/s of the collider
    const btCollisionObject *object;
    double shift, leaving; // m and m/s along the normal
    double incoming;       // m/s against it
};

class ck_BulletLandings {
  public:
    // Once, before the first step.
    void prepare(const ck_BulletBody &body);
    // After detection, before links and contacts are solved: Coulomb's cone in place of a share of the speed, and
    // nothing of Bullet's hardness, which would answer to what links do to the node. Bullet then removes
    // n·way + (1 − c3)·slip.
    void edit_contacts(const ck_BulletBody &body, const ck_BulletColliders &colliders, btScalar dt);
    // Restitution, which Bullet lacks, and the way to the surface.
    void finish(const ck_BulletColliders &colliders) const;

  private:
    btVector3 tension_of(const ck_BulletBody &body, int index) const;
    std::vector<ck_BulletLanding> landings; // of this substep
    std::vector<std::vector<int>> links_of; // of each node
};

#endif
