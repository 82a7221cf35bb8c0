// A scene that changes while it runs: in its parts, each a model of its own that goes on from where all is.
#ifndef CK_SEGMENT_H
#define CK_SEGMENT_H

#include "model.h"
#include "rigid.h"

#ifdef __cplusplus
extern "C" {
#endif

// From a frame on the scene is another one, with as many particles.
typedef struct ck_Segment {
    int frame;      // the first that is stepped so
    char *words;    // the changes since the start, as @KEY=VALUE@KEY=VALUE
    ck_Model model; // as if it had been so from the start
} ck_Segment;

// Builds what a scene's changes make of it at each of their times. Errors: CK_BAD_INPUT at the change, CK_NO_MEMORY.
ck_Status ck_model_build_segments(ck_Model *model, const struct ck_Scene *scene, ck_Error *error);

// The scene of a file with such words at a frame. Errors: CK_BAD_INPUT, also where it has other particles than base;
// CK_NO_MEMORY. Free with ck_segment_free in any case.
ck_Status ck_segment_build(ck_Segment *segment, const ck_Model *base, const char *file, const char *words, int frame,
                           ck_Error *error);
void ck_segment_free(ck_Segment *segment);

// The segment that begins with a frame; NULL: none does.
const ck_Segment *ck_model_segment_at(const ck_Model *model, int frame);

// A model that goes on from a state at a frame, whose time is its 0: what moves along paths is as far on, and what was
// let go is. What is pinned anew rests where it is.
//   position, velocity  [3*n] m and m/s;  turn  [rigid_count]
// Errors: CK_NO_MEMORY. Free with ck_model_end_resumed in any case; the segment must outlive it.
ck_Status ck_model_resume(ck_Model *resumed, const ck_Segment *segment, const double *position, const double *velocity,
                          const ck_Turn *turn);
void ck_model_end_resumed(ck_Model *resumed);

#ifdef __cplusplus
}
#endif

#endif
