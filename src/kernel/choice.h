// Whether jobs are shared by threads or run by one: where processors share no cache, or others take them, threads may
// cost more than they gain. Jobs go the way that took less time for its work. The other one is tried again as soon as
// jobs have taken fifty times what the last trial cost, so that trials cost a fiftieth of the time, whatever they find.
#ifndef CK_CHOICE_H
#define CK_CHOICE_H

#include <stdbool.h>

// Jobs before the first trial: so many are shared, or go the way that has just been chosen.
#define CK_CHOICE_PAUSE 8
// Jobs of a trial.
#define CK_CHOICE_TRIAL 4

// Zeroed: nothing is known, and jobs are shared.
typedef struct ck_Choice {
    bool is_alone, is_trial;
    int done; // jobs since the way changed; the first one is not counted, as it wakes threads
    double seconds[2], amount[2], jobs[2]; // of the latest that were counted, shared and alone
    double worked;                         // s since the last trial
    // s that the last trial took more than the other way; less than 0: what one back would take more
    double lost;
} ck_Choice;

// Counts a job: how long it took, s, and how much work it was, in any unit, more than 0.
void ck_choice_count(ck_Choice *choice, double seconds, double amount);

#endif
