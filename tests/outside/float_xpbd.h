// A solver as somebody else might have it: XPBD in single precision, written once and reached in every way there is.
#ifndef FLOAT_XPBD_H
#define FLOAT_XPBD_H

#include "model.h"

typedef struct FloatXpbd FloatXpbd;

// NULL when out of memory. substeps  a frame
FloatXpbd *float_xpbd_new(const ck_Model *model, int substeps);
void float_xpbd_step(FloatXpbd *solver); // one frame
void float_xpbd_read(const FloatXpbd *solver, double *position, double *velocity);
void float_xpbd_let_go(FloatXpbd *solver, int particle);
void float_xpbd_free(FloatXpbd *solver);

// Substeps where nobody says.
#define FLOAT_XPBD_SUBSTEPS 40
// What it models, of ck_Term.
#define FLOAT_XPBD_TERMS                                                                                               \
    (CK_TERM_SPRINGS | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY | CK_TERM_RELEASE)

#endif
