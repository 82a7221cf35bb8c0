// Engines that are no part of the program: a recording, a command that is talked to, a shared library.
#ifndef CK_OUTSIDE_H
#define CK_OUTSIDE_H

#include "engine.h"

// Plays a recording of a scene, made at a cost of frame_cost s of CPU a frame; NaN: not known.
//   path  of a file that ck_recording_read takes;  interval  s, of .npy; 0: the scene's step
// Errors: those of ck_recording_read and ck_recording_path. Free with ck_outside_free.
ck_Status ck_outside_recording(ck_Engine **engine, const char *name, const char *path, double interval,
                               double frame_cost, const ck_Model *model, ck_Error *error);

// Accepts NULL.
void ck_outside_free(ck_Engine *engine);

#endif
