// The bodies of a scene: their particles, springs and the names of their pins.
#ifndef CK_BODY_H
#define CK_BODY_H

#include "model.h"
#include "scene.h"

// Fills the particles and springs of a model whose time and labels are set.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_model_build_body(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// Moves the particles that are not pinned out of the body's plane as the scene asks. Rest lengths stay those of the
// flat body.
void ck_model_add_noise(ck_Model *model, const ck_Scene *scene);

// The particles that a pin's name stands for: a corner, an edge, first, last, row:column or a number.
//   chosen  [particle_count] out;  count  out
// Errors: CK_BAD_INPUT at path.
ck_Status ck_model_resolve_pin(int *chosen, int *count, const ck_Model *model, const ck_Scene *scene, const char *pin,
                               const char *path, ck_Error *error);

// Scales from to length 1. Errors: CK_BAD_INPUT at path where it has no direction.
ck_Status ck_model_unit(double *out, const double *from, const ck_Scene *scene, const char *path, ck_Error *error);

#endif
