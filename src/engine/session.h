// An engine's world along a scene that may change: where it does, the world is built again from where all is.
#ifndef CK_SESSION_H
#define CK_SESSION_H

#include "engine.h"
#include "segment.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ck_Session {
    const ck_Engine *engine;
    const ck_Model *model; // as the scene begins
    ck_Settings wanted;
    void *state;
    ck_Model *now;    // from the last change on; NULL: there was none
    int begun;        // the frame of that
    ck_Error refusal; // why a change of the scene could not be had; else empty
} ck_Session;

// Builds the world of the scene's beginning. Arguments and errors are those of ck_engine_create. End with
// ck_session_end where it is begun.
ck_Status ck_session_begin(ck_Session *session, const ck_Engine *engine, const ck_Model *model,
                           const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger, ck_Error *error);

// Lets the scene change before a frame. Settings that the words set of the engine count from then on. The segment must
// outlive the next change. Errors: those of ck_engine_create; the world of before stays.
ck_Status ck_session_change(ck_Session *session, const ck_Segment *segment, ck_Error *error);

// Advances by a frame, with the change that the scene has there. An engine that refuses it has diverged.
ck_StepResult ck_session_advance(ck_Session *session, int frame);

// As ck_engine_read.
void ck_session_read(const ck_Session *session, const ck_Trajectory *trajectory, int frame);

void ck_session_end(ck_Session *session);

#ifdef __cplusplus
}
#endif

#endif
