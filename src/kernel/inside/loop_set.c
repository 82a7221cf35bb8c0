// Compiled once for each kind of vectors; see loops.h. The loops of a kind, as they were compiled.
#include "lanes.h"
#include "loops.h"

ck_ExplicitStart CK_LOOP(ck_explicit_start);
ck_ExplicitRow CK_LOOP(ck_explicit_row);
ck_ProjectionVisits CK_LOOP(ck_projection_visits);
ck_Peak CK_LOOP(ck_peak);
ck_LineSubstep CK_LOOP(ck_line_substep);
ck_NearRow CK_LOOP(ck_near_row);
ck_LineFly CK_LOOP(ck_line_fly);
ck_LinePress CK_LOOP(ck_line_press);
ck_RowFly CK_LOOP(ck_row_fly);
ck_ClothPress CK_LOOP(ck_cloth_press);
#ifndef CK_SINGLE
ck_TouchSlide CK_LOOP(ck_touch_slide);
ck_TouchHold CK_LOOP(ck_touch_hold);
ck_ListStart CK_LOOP(ck_list_start);
ck_ListChunk CK_LOOP(ck_list_chunk);
ck_NearChunk CK_LOOP(ck_near_chunk);
ck_SweepPacks CK_LOOP(ck_sweep_packs);
ck_RowPress CK_LOOP(ck_row_press);
ck_RowMeets CK_LOOP(ck_row_meets);
#endif

extern const ck_Loops CK_LOOP(ck_loops);
const ck_Loops CK_LOOP(ck_loops) = {
    .vectors = CK_VECTORS_NAME,
    .lanes = CK_LANES,
    .fuses = CK_FUSES,
    .is_single = CK_IS_SINGLE,
    .explicit_start = CK_LOOP(ck_explicit_start),
    .explicit_row = CK_LOOP(ck_explicit_row),
    .projection_visits = CK_LOOP(ck_projection_visits),
    .peak = CK_LOOP(ck_peak),
    .line_substep = CK_LOOP(ck_line_substep),
    .near_row = CK_LOOP(ck_near_row),
    .line_fly = CK_LOOP(ck_line_fly),
    .line_press = CK_LOOP(ck_line_press),
    .row_fly = CK_LOOP(ck_row_fly),
    .cloth_press = CK_LOOP(ck_cloth_press),
#ifndef CK_SINGLE
    .touch_slide = CK_LOOP(ck_touch_slide),
    .touch_hold = CK_LOOP(ck_touch_hold),
    .list_start = CK_LOOP(ck_list_start),
    .list_chunk = CK_LOOP(ck_list_chunk),
    .near_chunk = CK_LOOP(ck_near_chunk),
    .sweep_packs = CK_LOOP(ck_sweep_packs),
    .row_press = CK_LOOP(ck_row_press),
    .row_meets = CK_LOOP(ck_row_meets),
#endif
};
