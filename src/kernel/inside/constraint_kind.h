// What rows in either precision do, and lines: one row of functions each.
#ifndef CK_CONSTRAINT_KIND_H
#define CK_CONSTRAINT_KIND_H

#include "constraint_kernel.h"

typedef struct ck_ProjectionKind {
    ck_Status (*create)(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error);
    void (*destroy)(ck_ProjectedCloth *cloth);
    void (*step)(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves);
    void (*read)(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before);
} ck_ProjectionKind;

extern const ck_ProjectionKind ck_projection_rows;
#ifndef CK_SINGLE
extern const ck_ProjectionKind ck_projection_lines;
extern const ck_ProjectionKind ck_projection_rows_single;
#endif

// The step of a kind, in sweep_schedule.c.
void ck_projection_run(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves);

#endif
