// A model as a btSoftBody of nodes and links: what Bullet's two soft-body worlds share.
#ifndef CK_BULLET_BODY_HPP
#define CK_BULLET_BODY_HPP

#include "engine.h"

#include <BulletSoftBody/btSoftBody.h>
#include <memory>
#include <vector>

static_assert(sizeof(btScalar) == 8, "Bullet must be built in double precision: link bullet-float64");

// A model whose pins can be let go: what a world is built from again when they are.
class ck_BulletScene {
  public:
    explicit ck_BulletScene(const ck_Model *scene);
    const ck_Model *model() const {
        return &now;
    }
    // Goes on from that state, with one pin less, at rest.
    void release(const double *at, const double *speed, int particle);

  private:
    ck_Model now;
    std::vector<double> position, velocity;
    std::unique_ptr<bool[]> pinned;
};

struct ck_BulletBody {
    const ck_Model *model;
    double dt; // s, one substep
    uint32_t substeps;
    std::unique_ptr<btSoftBody> soft;
    std::vector<int>
        node_of_particle; // pinned particles come last, as the contact solver of the deformable world needs
    std::vector<int> particle_of_node;
    std::vector<const ck_Spring *> spring; // of each link
};

//   reordered  links in the order in which native sweeps over rows, in which neighbours do not wait for each other
// Builds nodes and links with the scene's rest lengths, which Bullet would overwrite on its first step if let.
void ck_bullet_body_build(ck_BulletBody &body, const ck_Model *model, uint32_t substeps, bool reordered,
                          btSoftBodyWorldInfo *info);

// Position and velocity in the model's particle order: [3*n] m, [3*n] m/s.
void ck_bullet_body_read(const ck_BulletBody &body, double *position, double *velocity);

// False where any node has left the finite numbers, or what Bullet can clamp them to.
bool ck_bullet_body_is_finite(const ck_BulletBody &body);

// Adds the rows that both worlds fill alike: time step, mass, gravity, force, contact.
//   force_parameter  where the world takes the force;  friction_formula  what it makes of friction
void ck_bullet_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings &used, const char *force_parameter,
                      const char *friction_formula);

extern "C" const char *ck_bullet_version(void);

#endif
