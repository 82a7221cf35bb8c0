// A scene compiled and, where it says so, at rest from the start: a curtain that has hung, a slinky held by its top.
#ifndef CK_START_H
#define CK_START_H

#include "model.h"
#include "scene.h"

// ck_model_build; then, with start: equilibrium, the positions where the body comes to rest under the pins of the
// start, let go as it is given, noise included, or a thousandth of its spacing beside it where it would end on a
// saddle. Pins that are let go later hold until then, and colliders are not there. Errors: those of ck_model_build;
// CK_BAD_INPUT at the scene's place where there is no such rest, or where it is inside a collider. Free with
// ck_model_free in any case.
ck_Status ck_start_build(ck_Model *model, const ck_Scene *scene, ck_Error *error);

#endif
