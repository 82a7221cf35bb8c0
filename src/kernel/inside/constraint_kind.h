// What rows and lines do, in either precision: one row of functions each.
#ifndef CK_CONSTRAINT_KIND_H
#define CK_CONSTRAINT_KIND_H

#include "constraint_kernel.h"
#include "lane_surface.h"

//   touch        lets a cloth touch what its set-up says
//   particle_at  which particle is at a place beside the cloth; NULL: contact is not beside
typedef struct ck_ProjectionKind {
    ck_Status (*create)(ck_ProjectedCloth **cloth, const ck_ProjectionSetup *setup, ck_Error *error);
    void (*destroy)(ck_ProjectedCloth *cloth);
    void (*step)(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves);
    void (*read)(const ck_ProjectedCloth *cloth, double *position, double *velocity, double *before);
    ck_Status (*touch)(ck_ProjectedCloth *cloth, const ck_ProjectionSetup *setup, ck_Error *error);
    int (*particle_at)(const ck_ProjectedCloth *cloth, int place);
} ck_ProjectionKind;

// The first member of each kind's structure.
typedef struct ck_ProjectionHead {
    const ck_ProjectionKind *kind;
    struct ck_RowContact *contact; // NULL: there is nothing to touch
    ck_LaneSurface *seen;          // of its surfaces, in single precision; see sixteen.h
    ck_Follower follower;          // knows particles, where contact knows places beside them
} ck_ProjectionHead;

extern const ck_ProjectionKind ck_projection_rows, ck_projection_lines;
#ifndef CK_SINGLE
extern const ck_ProjectionKind ck_projection_rows_single, ck_projection_lines_single;
#endif

#ifdef CK_SINGLE
// The contact of a cloth in single precision, beside so many places, in a follower's numbers; masses are then set by
// the caller. Errors: CK_NO_MEMORY.
ck_Status ck_sixteens_create(ck_ProjectionHead *head, const struct ck_RowContact *beside, const ck_Follower *follower,
                             long places, ck_Error *error);
// Where its surfaces are from an origin; of a cloth without contact nothing.
void ck_sixteens_see(ck_ProjectionHead *head, const double origin[3], double size);
#endif

// Follows a cloth's places beside it by what follows its particles.
ck_Follower ck_projection_follower(ck_ProjectedCloth *cloth, const ck_Follower *follower);

// The step of a kind, in sweep_schedule.c.
void ck_projection_run(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves);

#endif
