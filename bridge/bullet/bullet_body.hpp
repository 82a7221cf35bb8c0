// A model as a btSoftBody of nodes and links: what Bullet's two soft-body worlds share.
#ifndef CK_BULLET_BODY_HPP
#define CK_BULLET_BODY_HPP

#include "bullet_guard.hpp"
#include "bullet_loops.h"
#include "engine.h"
#include "hinges.h"
#include "rigid.h"
#include "scaled_model.h"
#include "wind.h"

#include <BulletSoftBody/btSoftBody.h>
#include <memory>
#include <new>
#include <vector>

static_assert(sizeof(btScalar) == sizeof(ck_BulletScalar), "the loops must be of the precision of the Bullet linked");

// A model in units of its own, whose pins can be let go: what a world is built from again when they are.
class ck_BulletModel {
  public:
    explicit ck_BulletModel(const ck_Model *scene);
    ~ck_BulletModel();
    ck_BulletModel(const ck_BulletModel &) = delete;
    ck_BulletModel &operator=(const ck_BulletModel &) = delete;
    const ck_Model *model() const {
        return &scaled.model;
    }
    double length() const {
        return scaled.length;
    }
    // Goes on from that state, [3*n] m and m/s of the scene, with one pin less: at rest, or with
    // the speed that it is moved with.
    //   turn  [rigid_count]
    void release(const double *at, const double *speed, const ck_Turn *turn, int particle);
    // Rigid bodies as they were at the start of the scene.
    const ck_RigidBody *first_rigid() const {
        return first;
    }

  private:
    ck_ScaledModel scaled;
    const ck_RigidBody *first;
};

// The springs of a body sorted by their first ends, for the passes that the bridge adds.
struct ck_BulletLinkTable {
    std::vector<int> start, other;
    std::vector<int> link; // of the soft body, that each of them is
    std::vector<btScalar> rest, stiffness, damping, normal, length;
    ck_BulletLinks view();
};

struct ck_BulletBody {
    const ck_Model *model; // in units of its own
    double dt;             // s, one substep
    uint32_t substeps;
    std::unique_ptr<btSoftBody> soft;
    std::vector<int>
        node_of_particle; // pinned particles come last, as the contact solver of the deformable world needs
    std::vector<int> particle_of_node;
    std::vector<const ck_Spring *> spring; // of each link
    ck_BulletLinkTable links;
};

//   reordered  links in the order of native-xpbd's sweeps, in which neighbours do not wait for each other
// Builds nodes and links with the scene's rest lengths, which Bullet would overwrite on its first step if let.
void ck_bullet_body_build(ck_BulletBody &body, const ck_Model *model, uint32_t substeps, bool reordered,
                          btSoftBodyWorldInfo *info);

// Positions and velocities of all nodes. position: which of a node's, m_x or m_q.
ck_BulletNodes ck_bullet_nodes(const ck_BulletBody &body, btVector3 btSoftBody::Node::*position);

// Forces of hinges and air on the nodes, in units of the model.
class ck_BulletOuter {
  public:
    explicit ck_BulletOuter(const ck_BulletBody &owner);
    bool is_there() const {
        return body.model->hinge_count > 0 || body.model->wind.face_count > 0;
    }
    // Takes the nodes' velocities and positions, m_x or m_q, and what each hinge pulls with.
    void update(btVector3 btSoftBody::Node::*position);
    // Gives add(node, force) each node's.
    template <class Add> void add_forces(Add add) const {
        for (size_t i = 0; i < body.particle_of_node.size(); i++) {
            const double *f = &force[3 * static_cast<size_t>(body.particle_of_node[i])];
            add(static_cast<int>(i),
                btVector3(static_cast<btScalar>(f[0]), static_cast<btScalar>(f[1]), static_cast<btScalar>(f[2])));
        }
    }
    // Adds scale times the change of force by a move of nodes, −Σ pull·w·wᵀ·move; a pull that pushes is left out, so
    // that the system stays definite.
    template <class Moves, class Result> void multiply(double scale, const Moves &moves, Result &result) const {
        for (int i = 0; i < body.model->hinge_count; i++) {
            const ck_Hinge &hinge = body.model->hinges[i];
            btVector3 sum(0, 0, 0);
            for (int k = 0; k < 4; k++)
                if (hinge.particles[k] >= 0)
                    sum += static_cast<btScalar>(hinge.weights[k]) * moves[node(hinge.particles[k])];
            for (int k = 0; k < 4; k++)
                if (hinge.particles[k] >= 0)
                    result[node(hinge.particles[k])] -=
                        static_cast<btScalar>(scale * hinge.weights[k] * pull[static_cast<size_t>(i)]) * sum;
        }
    }

  private:
    int node(int particle) const {
        return body.node_of_particle[static_cast<size_t>(particle)];
    }
    const ck_BulletBody &body;
    std::vector<double> at, speed, force, pull;
};

// Position and velocity in the scene's particle order and units: [3*n] m, [3*n] m/s. length: of a unit, m.
void ck_bullet_body_read(const ck_BulletBody &body, double length, double *position, double *velocity);

// False where any node has left the finite numbers, or what Bullet can clamp them to.
bool ck_bullet_body_is_finite(const ck_BulletBody &body);

// Adds the rows that both worlds fill alike: units, time step, mass, gravity, force, contact.
//   force_parameter  where the world takes the force;  friction_formula  what it makes of friction
void ck_bullet_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings &used, const char *force_parameter,
                      const char *friction_formula);

#endif
