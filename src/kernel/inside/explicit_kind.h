// What a layout of explicit.h does: one row of functions for rows, one for lists.
#ifndef CK_EXPLICIT_KIND_H
#define CK_EXPLICIT_KIND_H

#include "explicit.h"

typedef struct ck_ExplicitKind {
    ck_Status (*create)(ck_Explicit **body, const ck_ExplicitSetup *setup, ck_Error *error);
    void (*place)(ck_Explicit *body, const ck_ExplicitSetup *setup);
    void (*pace)(ck_Explicit *body, const ck_ExplicitSetup *setup);
    const double *(*acceleration)(const ck_Explicit *body, size_t *count);
    void (*destroy)(ck_Explicit *body);
    void (*step)(ck_Explicit *body, uint32_t substeps, ck_Waves *waves);
    // anew: nothing is loose yet
    void (*drift)(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose, bool is_anew);
    void (*turn)(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose);
    void (*kick)(ck_Explicit *body);
    void (*take)(const ck_Explicit *body, const ck_Loose *loose, int count); // accelerations of the first ones
    void (*put)(const ck_Explicit *body, const ck_Loose *loose, bool is_kicked);
    void (*leave)(ck_Explicit *body, const ck_Loose *loose, int which); // one is loose no longer
    void (*read)(const ck_Explicit *body, double *position, double *velocity);
} ck_ExplicitKind;

// In single precision there are rows alone, without what steps that adapt ask for.
extern const ck_ExplicitKind ck_explicit_rows, ck_explicit_list;
#ifndef CK_SINGLE
extern const ck_ExplicitKind ck_explicit_rows_single;
#endif

// From a tile's place, or to it, to where the coordinates of loose ones stand so far apart. Read first, as stores might
// be to where the rest is.
CK_INLINE void ck_tile_take(double *to, long stride, const ck_Real *tile) {
    const ck_Real x = tile[0], y = tile[CK_STRIPE], z = tile[2 * CK_STRIPE];
    to[0] = x;
    to[stride] = y;
    to[2 * stride] = z;
}

CK_INLINE void ck_tile_put(ck_Real *tile, const double *from, long stride) {
    const ck_Real x = (ck_Real)from[0], y = (ck_Real)from[stride], z = (ck_Real)from[2 * stride];
    tile[0] = x;
    tile[CK_STRIPE] = y;
    tile[2 * CK_STRIPE] = z;
}

// The first member of every layout's own structure.
struct ck_Explicit {
    const ck_ExplicitKind *kind;
    bool is_placed; // since what was loose was taken
};

#endif
