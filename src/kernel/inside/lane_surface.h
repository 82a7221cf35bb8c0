// Surfaces as vectors of particles see them, in the precision of the files that include this.
#ifndef CK_LANE_SURFACE_H
#define CK_LANE_SURFACE_H

#include "loops.h"
#include "rows.h"

#include <math.h>

#ifdef CK_SINGLE
// From the origin of what places are told from. What single precision rounds is in the margin: it says which particles
// a surface may be in reach of, and doubles say the rest.
typedef struct ck_LaneSurface {
    bool is_plane;
    int axis_count;
    ck_Real point[3], normal[3], axes[3][3], half[3], radius, margin;
} ck_LaneSurface;

// A distance from a surface is told by a few numbers as large as a cloth or the surface, each rounded by 2^-24 of
// itself: this is some sixteen of those.
#define CK_LANE_ROUNDING 1e-6

// Of what has no end the point next to the origin, or one far along it would cost digits.
//   size  m, within which places are told
CK_INLINE ck_LaneSurface ck_lane_surface(const ck_NearSurface *surface, const double origin[3], double size) {
    ck_LaneSurface seen = {
        .is_plane = surface->is_plane, .axis_count = surface->axis_count, .radius = (ck_Real)surface->radius};
    double out[3], off = 0, extent = size + surface->radius;
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = surface->point[axis] - origin[axis];
        off += out[axis] * surface->normal[axis];
    }
    for (int k = 0; k < surface->axis_count; k++) {
        const double *axis = surface->axes[k],
                     along = isinf(surface->half[k]) ? out[0] * axis[0] + out[1] * axis[1] + out[2] * axis[2] : 0;
        for (int i = 0; i < 3; i++) out[i] -= along * axis[i];
        extent += isinf(surface->half[k]) ? 0 : surface->half[k];
    }
    for (int axis = 0; axis < 3; axis++) {
        seen.point[axis] = (ck_Real)(surface->is_plane ? off * surface->normal[axis] : out[axis]);
        seen.normal[axis] = (ck_Real)surface->normal[axis];
        seen.half[axis] = (ck_Real)surface->half[axis];
        for (int k = 0; k < 3; k++) seen.axes[axis][k] = (ck_Real)surface->axes[axis][k];
    }
    seen.margin = (ck_Real)(surface->margin + CK_LANE_ROUNDING * extent);
    return seen;
}
#else
typedef ck_NearSurface ck_LaneSurface;
#endif

#endif
