// A scene as it is stepped, now: engines in lockstep, each in a child of its own with limits, and what is changed on
// the way, which is kept so that the same can be run again.
#ifndef CK_LIVE_H
#define CK_LIVE_H

#include "metric.h"
#include "model.h"
#include "process.h"
#include "runner.h"
#include "scene.h"

#define CK_LIVE_ENGINES 16

// One engine, as it is at the frame.
typedef struct ck_LiveEngine {
    const ck_Engine *engine;
    ck_Trajectory shown; // of a single frame
    bool runs;           // false once it has ended, and status says how
    ck_RunStatus status;
    char reason[600];
    double cpu, wall; // s, of the last frame
} ck_LiveEngine;

typedef struct ck_Live ck_Live;

// Starts children and builds their worlds. What the scene changes itself on the way is left out.
//   file  with its words
// Errors: CK_BAD_INPUT where the scene is none, CK_NO_MEMORY, CK_IO. An engine that refuses it is there, and does not
// run. End with ck_live_end in any case.
ck_Status ck_live_start(ck_Live **live, const char *file, const ck_Engine *const *engines, const ck_Settings *wanted,
                        int count, const ck_Limits *limits, ck_Error *error);
void ck_live_end(ck_Live *live);

// Starts over with so many frames a second; *live is another then. Errors: as ck_live_start; then *live is as it was.
ck_Status ck_live_set_rate(ck_Live **live, double rate, ck_Error *error);

int ck_live_count(const ck_Live *live);
const ck_LiveEngine *ck_live_engine(const ck_Live *live, int index);
// The scene as it is now, with the particles where it began; and how it was then.
const ck_Model *ck_live_model(const ck_Live *live);
const ck_Scene *ck_live_scene(const ck_Live *live);
// Frames done.
int ck_live_frame(const ck_Live *live);

// Changes the scene before the next frame: @KEY=VALUE@KEY=VALUE. What was changed before stays changed. Errors:
// CK_BAD_INPUT where it cannot be so, and nothing is changed; CK_NO_MEMORY.
ck_Status ck_live_change(ck_Live *live, const char *words, ck_Error *error);

// One frame in all engines that run. One that takes longer than a frame may is ended.
void ck_live_step(ck_Live *live);

// Back to the start, without what was changed.
void ck_live_reset(ck_Live *live);

// Writes folder/name, a scene that does the same as was done so far, to the last bit. Errors: CK_IO, CK_NO_MEMORY,
// CK_BAD_INPUT before the first frame.
ck_Status ck_live_save(const ck_Live *live, const char *folder, const char *name, ck_Error *error);

#endif
