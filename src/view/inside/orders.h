// What a viewer asks for, as JSON: {"do": WORD, …}.
#ifndef CK_ORDERS_H
#define CK_ORDERS_H

#include "live.h"

// The fastest that a hand drags, sizes of the body a second: a jump would tear what it holds.
#define CK_STAGE_FASTEST 20

// A session as viewers see it.
typedef struct ck_Stage {
    ck_Live *live;
    const char *folder;
    bool plays;
    int steps;        // to be done though it does not play
    double real_time; // times; 0: as fast as it can
    bool *pinned;     // [n] as it is now
    int held;         // the particle that is dragged, −1: none
    bool was_pinned;  // what is dragged
    double goal[3];   // m, where it is dragged to
    bool moves;       // the last frame had a path of it
} ck_Stage;

// Errors: CK_NO_MEMORY.
ck_Status ck_stage_begin(ck_Stage *stage, ck_Live *live);
void ck_stage_end(ck_Stage *stage);

// Does what a message asks, and writes an answer, or an empty one. A message that is none is refused in the answer, and
// does nothing. True where the answer is for all viewers, not for the one alone that asked.
bool ck_stage_obey(ck_Stage *stage, const char *message, size_t length, char *answer, size_t size);

// A frame, with what is dragged on its way.
void ck_stage_step(ck_Stage *stage);

#endif
