// Where a body comes to rest that is let go: its way there is only a start for the equilibrium that is near.
#ifndef CK_SETTLING_H
#define CK_SETTLING_H

#include "model.h"

#include <stdint.h>

// Steps a copy of the model, nudged, until it stays still or its duration ends. Without damping it has the drag that is
// critical for a pendulum of its size; dampers beyond twice what is critical for its stiffest motion are weakened to
// that.
//   nudge      m, the largest offset of a particle at the start
//   stiffness  N/m, of what pushes out of surfaces
//   position   [3*n] out, m
// Errors: CK_REFUSED where it diverges, CK_IO after a signal, CK_NO_MEMORY.
ck_Status ck_settle(const ck_Model *model, double nudge, uint64_t seed, double stiffness, double *position,
                    ck_Error *error);

#endif
