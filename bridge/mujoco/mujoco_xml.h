// A model as MJCF, the XML that MuJoCo compiles.
#ifndef CK_MUJOCO_XML_H
#define CK_MUJOCO_XML_H

#include "model.h"

// The mass of a ball that moves, a particle of the body, in units of a scaled model.
#define CK_MUJOCO_HEAVY 1e6

#include <stddef.h>

// Steps that an impact with restitution lasts, about: it is followed by that many.
#define CK_MUJOCO_BOUNCE_STEPS 8

// What it holds besides the model.
typedef struct ck_MujocoOptions {
    double step;            // s
    const char *integrator; // "Euler", "implicit", "RK4"
    double radius;          // m, of the geoms that stand for particles where there are colliders
    int meets;              // what the geoms that are written meet: the writer's own
} ck_MujocoOptions;

// The radius of a particle's geom, m: a tenth of the spacing and of every solid or, where there are rigid bodies, a
// hundredth.
double ck_mujoco_radius(const ck_Model *model);

// The text and its length. A particle is a body of that number with three slide joints or, pinned, a site of the world.
// NULL when out of memory. Free the result.
char *ck_mujoco_xml(const ck_Model *model, const ck_MujocoOptions *options, size_t *length);

// Numbers that its steps may keep at once, found by trying: the implicit integrator takes ten for each spring's pull on
// each joint, and contact the square of joints and contact rows, should all particles touch.
int ck_mujoco_stack(const ck_Model *model, const char *integrator);

#endif
