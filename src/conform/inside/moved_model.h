// The same physics elsewhere: a copy of a model that is moved, turned, mirrored, grown, or has its springs shuffled.
#ifndef CK_MOVED_MODEL_H
#define CK_MOVED_MODEL_H

#include "model.h"

typedef enum ck_Move { CK_MOVE_SHIFT, CK_MOVE_ROTATE, CK_MOVE_MIRROR, CK_MOVE_GROW, CK_MOVE_SHUFFLE } ck_Move;

// A copy whose particles and springs are its own; the rest is the other's, which must outlive it. Colliders are not
// moved: it is for models without.
//   by  m along x, of a shift; a factor, of growth: lengths and accelerations alike, so that the motion is the same
// Errors: CK_NO_MEMORY. Free with ck_moved_model_free in any case.
ck_Status ck_moved_model_create(ck_Model *moved, const ck_Model *model, ck_Move move, double by, ck_Error *error);
void ck_moved_model_free(ck_Model *moved);

#endif
