// Runs one engine on one model in a child process: once measured, and several times timed.
#ifndef CK_RUNNER_H
#define CK_RUNNER_H

#include "engine.h"
#include "metric.h"
#include "process.h"
#include "status.h"
#include "trajectory.h"

// The most timed repeats of one run.
#define CK_MAX_REPEATS 99

typedef struct ck_Timing {
    int frames;                 // timed per repeat
    double cpu[CK_MAX_REPEATS]; // s of the stepping thread, for those frames
    int repeat_count;
    double worst_step; // s of the slowest frame of any repeat
    bool has_failed;   // a repeat did not get to its end: the next would not, either
    double spent;      // s of wall time for all repeats, with what starting them takes
} ck_Timing;

typedef struct ck_Run {
    const ck_Model *model;
    const ck_Engine *engine;
    ck_Settings wanted, used;
    ck_RunStatus status;
    char reason[600]; // never empty: also an ok run says why it is
    char remark[240]; // what the engine itself says of the run; empty: nothing
    ck_Ledger ledger;
    ck_Trajectory trajectory;
    double measured_cpu; // s of the measured pass
    ck_Timing timing;
    size_t peak_rss_bytes;
} ck_Run;

// True where the run wrote all its frames, so that it can be measured.
bool ck_run_has_all_frames(const ck_Run *run);

// The measured pass: fills trajectory, ledger, settings, status and reason.
// Errors: CK_NO_MEMORY, CK_IO. How the engine fared is in run->status. Free with ck_run_free in any case.
ck_Status ck_run_measure(ck_Run *run, const ck_Model *model, const ck_Engine *engine, const ck_Settings *wanted,
                         const ck_Limits *limits, ck_Error *error);

// What an engine makes of settings by its own rules, asked in a child, as an engine may hang or crash in that, too.
// Errors: CK_REFUSED where it lacks a term of the scene, refuses it or does not come back within the limits;
// CK_NO_MEMORY, CK_IO.
ck_Status ck_run_automatic(const ck_Engine *engine, const ck_Model *model, const ck_Settings *wanted,
                           const ck_Limits *limits, ck_Settings *used, ck_Error *error);

// One timed repeat, in which nothing is read. Does nothing for a run that has no result to time.
// Times all frames, or as many as fit into budget seconds by the measured pass, but at least one.
// Errors: CK_NO_MEMORY, CK_IO.
ck_Status ck_run_time(ck_Run *run, double budget, const ck_Limits *limits, ck_Error *error);

// Accepts a zeroed run.
void ck_run_free(ck_Run *run);

// Median and interquartile range of the repeats; NaN without any, the range with one, too.
double ck_timing_median(const ck_Timing *timing);
double ck_timing_iqr(const ck_Timing *timing);

// Between these the median lies with 95 %, by order statistics; the least and the most where repeats are fewer than
// six.
void ck_timing_interval(const ck_Timing *timing, double *low, double *high);

// True where another repeat would not say more: the interval is within 2 % of the median, or enough is spent, s of wall
// time.
bool ck_timing_is_known(const ck_Timing *timing, double enough);
// What is enough where nobody says.
#define CK_TIMING_ENOUGH 1.0

// Judges a run that reached its end: blow-ups stay finite in some engines, and are then seen by energy and strain.

// Replaces an ok status by unsettled, overstretched or energy_gain where the path says so, and gives the reason.
void ck_verdict(ck_Run *run, const ck_Reference *reference);

// The time, s, in which drag takes a swing to where a body counts as settled; INFINITY without drag.
double ck_settling_time(const ck_Model *model);

// The measured pass and its verdict. An engine whose own rule chose a step that blows up steps finer, by halves, at
// most three times, and the reason says so. Arguments and errors are those of ck_run_measure.
ck_Status ck_verdict_run(ck_Run *run, const ck_Model *model, const ck_Reference *reference, const ck_Engine *engine,
                         const ck_Settings *wanted, const ck_Limits *limits, ck_Error *error);

#endif
