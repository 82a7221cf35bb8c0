// Engines that are no part of the program: a recording, a command that is talked to, a shared library.
#ifndef CK_OUTSIDE_H
#define CK_OUTSIDE_H

#include "engine.h"

// Plays a recording of a scene, made at a cost of frame_cost s of CPU a frame; NaN: not known.
//   path  of a file that ck_recording_read takes;  interval  s, of .npy; 0: the scene's step
// Errors: those of ck_recording_read and ck_recording_path. Free with ck_outside_free.
ck_Status ck_outside_recording(ck_Engine **engine, const char *name, const char *path, double interval,
                               double frame_cost, const ck_Model *model, ck_Error *error);

// Starts a command and asks what it is; runs start it again.
//   line  as a shell reads it;  is_known  it is found by its name alone, as those that came with the program
// Errors: CK_BAD_INPUT where it does not answer as it must, with its last words; CK_IO, CK_NO_MEMORY. Free with
// ck_outside_free.
ck_Status ck_outside_command(ck_Engine **engine, const char *name, const char *line, bool is_known, ck_Error *error);

// Loads a shared library that has a ck_Plugin (plugin.h), in processes of their own.
//   name  NULL: its engine's
// Errors: CK_BAD_INPUT where it cannot be loaded or is of another interface; CK_IO, CK_NO_MEMORY. Free with
// ck_outside_free.
ck_Status ck_outside_library(ck_Engine **engine, const char *name, const char *path, ck_Error *error);

// Writes a directory of that name, to begin an engine with. Errors: CK_BAD_INPUT where the name will not do or is
// taken; CK_IO, CK_NO_MEMORY.
ck_Status ck_outside_new_engine(const char *name, ck_Error *error);

// Accepts NULL.
void ck_outside_free(ck_Engine *engine);

#endif
