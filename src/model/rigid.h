// Rigid bodies that move freely, a sphere or a box each: where they are, how they turn and what they touch. Their
// centres are the last particles of a model.
#ifndef CK_RIGID_H
#define CK_RIGID_H

#include "model.h"

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

// How a body is turned from its start, a unit quaternion w, x, y, z; and its angular velocity, rad/s.
typedef struct ck_Turn {
    double rotation[4], spin[3];
} ck_Turn;

ck_Turn ck_rigid_start(const ck_RigidBody *rigid);

// A vector turned by a rotation.
void ck_rigid_rotate(double *out, const double *rotation, const double *vector);

// The rotation that brings a body's axes at the start to these.
void ck_rigid_rotation(double *rotation, const ck_RigidBody *rigid, double (*axes)[3]);

// The body's shape where it is.
//   center  [3] m
ck_Collider ck_rigid_place(const ck_RigidBody *rigid, const double *center, const double *rotation);

// I·spin, kg·m²/s, of a body that is where the shape is; and the other way round.
void ck_rigid_momentum(double *momentum, const ck_RigidBody *rigid, const ck_Collider *now, const double *spin);
void ck_rigid_spin(double *spin, const ck_RigidBody *rigid, const ck_Collider *now, const double *momentum);

// Turns a body on which nothing acts by dt, s: its angular momentum, [3] kg·m²/s, stays. By the spin at the middle:
// second order for a box, and exact for a sphere.
void ck_rigid_turn(double *rotation, const ck_RigidBody *rigid, const double *momentum, double dt);

// One place where a body meets cloth, a collider or another body. The normal points from b to a.
typedef struct ck_Touch {
    int particle;       // a: of the cloth, or a body's centre
    int rigid;          // a's number among bodies; −1: it is the cloth's
    int other;          // b's number among bodies; −1: it is a collider
    int collider;       // b's number among those; −1: it is a body
    double point[3];    // m, where both push
    double normal[3];   // unit
    double gap;         // m, negative inside
    double restitution; // of two with their own the larger
    double friction;    // so, too
} ck_Touch;

// Room for all touches that there can be.
size_t ck_rigid_most_touches(const ck_Model *model);

// Finds what is no farther apart than reach, m. Returns how many.
//   position    [3*n] m
//   bodies      [rigid_count] where they are
//   colliders   [collider_count] where they are
//   touches     out, [ck_rigid_most_touches]
// Cost: one gap for each particle and body.
int ck_rigid_find_touches(const ck_Model *model, const double *position, const ck_Collider *bodies,
                          const ck_Collider *colliders, double reach, ck_Touch *touches);

// True for what never meets, as the model does not say how: a box and a capsule, a cylinder or a box.
bool ck_rigid_is_unknown(const ck_Collider *one, const ck_Collider *other);

#ifdef __cplusplus
}
#endif

#endif
