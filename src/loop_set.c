// Compiled once for each kind of vectors; see loops.h. The loops of a kind, as they were compiled.
#include "lanes.h"
#include "loops.h"

ck_ExplicitRow CK_LOOP(ck_explicit_row);
ck_ProjectionWave CK_LOOP(ck_projection_wave);
ck_Peak CK_LOOP(ck_peak);

extern const ck_Loops CK_LOOP(ck_loops);
const ck_Loops CK_LOOP(ck_loops) = {
    CK_VECTORS_NAME, CK_LANES, CK_FUSES, CK_LOOP(ck_explicit_row), CK_LOOP(ck_projection_wave), CK_LOOP(ck_peak)};
