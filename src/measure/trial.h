// One engine at one setting on one scene, run, judged and reduced to the numbers that studies weigh or compare.
#ifndef CK_TRIAL_H
#define CK_TRIAL_H

#include "metric.h"
#include "runner.h"

typedef struct ck_Trial {
    ck_RunStatus status;
    char reason[256];
    ck_Settings used;
    double time_step;      // s
    double error;          // from the goal
    double stretch;        // the largest strain at the end
    double sag_error;      // at the end, |sag − truth|
    double stretch_error;  // at the end, |stretch_max − truth|
    double cpu, cpu_range; // s, median and interquartile range
} ck_Trial;

// What a trial's error is. None of it: the distance to the truth's positions, rms over particles and frames / size.
typedef struct ck_TrialGoal {
    const ck_Trajectory *path; // the distance to this path, of the same model's frames
    const ck_Metric *metric;   // or how far this metric is from value, in its unit
    double value;
} ck_TrialGoal;

// Runs and judges; times it repeats times, 0: the measured pass alone, below 0: until it is
// known. What a failed run lacks is NaN.
//   goal  NULL: the truth
// Errors: CK_NO_MEMORY, CK_IO.
ck_Status ck_trial_run(ck_Trial *trial, const ck_Model *model, const ck_Reference *truth, const ck_TrialGoal *goal,
                       const ck_Engine *engine, const ck_Settings *wanted, int repeats, const ck_Limits *limits,
                       ck_Error *error);

// All metrics of one run.
typedef struct ck_Measurement {
    ck_RunStatus status;
    char reason[256];
    double cpu, time_step;             // s of the measured pass, s
    double values[CK_METRIC_CAPACITY]; // in the order of the metric table; NaN where one does not apply
} ck_Measurement;

// Runs, judges and measures. Errors: CK_NO_MEMORY, CK_IO.
//   reference  the truth's; keep  NULL, or where the run goes, for the caller to free with ck_run_free
ck_Status ck_measurement_take(ck_Measurement *measurement, const ck_Model *model, const ck_Reference *reference,
                              const ck_Engine *engine, const ck_Settings *wanted, const ck_Limits *limits, ck_Run *keep,
                              ck_Error *error);

// How far an engine is from itself at a finer step. An engine can be consistent and wrong: this tells the two apart.

// The steps at which pieces are restarted, as multiples of the run's own.
#define CK_CONSISTENCY_STEPS 3
extern const int ck_consistency_multiples[CK_CONSISTENCY_STEPS]; // 1, 2, 4
extern const char *const ck_consistency_names[CK_CONSISTENCY_STEPS];

// Short pieces restarted from states of the engine's own finest run (an eighth of its step), at growing steps.
//   deviation  [CK_CONSISTENCY_STEPS] out: mean over pieces of the rms distance at their end / size; NaN where a step
//              cannot grow that far or the run would take too long, INFINITY where it blows up
//   budget     s of CPU time that it may take, judged by the method, steps and springs: the same on every machine
// Errors: CK_NO_MEMORY, CK_IO. Source: Erez, Tassa, Todorov 2015, Simulation tools for model-based robotics.
ck_Status ck_consistency_measure(double *deviation, const ck_Run *run, double budget, const ck_Limits *limits,
                                 ck_Error *error);

#endif
