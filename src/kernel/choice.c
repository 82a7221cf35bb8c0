#include "choice.h"

#include <math.h>

// What is left of the weight of a job when the next one is counted.
#define KEPT 0.875
// So many times what its way's jobs took, for as much work or on average, a job counts at most: it may have lost its
// processor for once.
#define MOST_COUNTED 3
// s that end a trial at once: a slice of time of others is longer.
#define MOST_LOST 1e-3
// Times what a trial cost, jobs take until the next one.
#define PAYS 50
// A way is left for another that takes less than this share of its time.
#define BETTER 0.95

static double rate_of(const ck_Choice *choice, bool is_alone) {
    return choice->amount[is_alone] > 0 ? choice->seconds[is_alone] / choice->amount[is_alone] : 0;
}

static void add(ck_Choice *choice, double seconds, double amount) {
    const bool way = choice->is_alone;
    const double mean = choice->jobs[way] > 0 ? choice->seconds[way] / choice->jobs[way] : INFINITY;
    const double most = MOST_COUNTED * fmax(rate_of(choice, way) * amount, mean);
    choice->seconds[way] = KEPT * choice->seconds[way] + fmin(seconds, most);
    choice->amount[way] = KEPT * choice->amount[way] + amount;
    choice->jobs[way] = KEPT * choice->jobs[way] + 1;
}

static void begin_trial(ck_Choice *choice) {
    choice->is_trial = true;
    choice->is_alone = !choice->is_alone;
    choice->seconds[choice->is_alone] = choice->amount[choice->is_alone] = choice->jobs[choice->is_alone] = 0;
    choice->done = 0;
    choice->lost = 0;
}

static void end_trial(ck_Choice *choice) {
    if (!(rate_of(choice, choice->is_alone) < BETTER * rate_of(choice, !choice->is_alone)))
        choice->is_alone = !choice->is_alone;
    choice->is_trial = false;
    choice->done = 0;
    choice->worked = 0;
}

void ck_choice_count(ck_Choice *choice, double seconds, double amount) {
    if (choice->done++ > 0) add(choice, seconds, amount);
    if (choice->is_trial) {
        choice->lost += seconds - rate_of(choice, !choice->is_alone) * amount;
        if (choice->done >= CK_CHOICE_TRIAL || (choice->done > 1 && choice->lost > MOST_LOST)) end_trial(choice);
    } else {
        choice->worked += seconds;
        if (choice->done >= CK_CHOICE_PAUSE && choice->worked > PAYS * fabs(choice->lost)) begin_trial(choice);
    }
}
