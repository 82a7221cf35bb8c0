// How far an engine is from itself at a finer step. An engine can be consistent and wrong: this tells the two apart.
#ifndef CK_CONSISTENCY_H
#define CK_CONSISTENCY_H

#include "runner.h"

// The steps at which pieces are restarted, as multiples of the run's own.
#define CK_CONSISTENCY_STEPS 3
extern const int ck_consistency_multiples[CK_CONSISTENCY_STEPS]; // 1, 2, 4
extern const char *const ck_consistency_names[CK_CONSISTENCY_STEPS];

// Short pieces restarted from states of the engine's own finest run (an eighth of its step), at growing steps.
//   deviation  [CK_CONSISTENCY_STEPS] out: mean over pieces of the rms distance at their end / size; NaN where a step
//              cannot grow that far or the run would take too long
//   budget     s of CPU time that it may take, judged by the measured pass
// Errors: CK_NO_MEMORY, CK_IO. Source: Erez, Tassa, Todorov 2015, Simulation tools for model-based robotics.
ck_Status ck_consistency_measure(double *deviation, const ck_Run *run, double budget, const ck_Limits *limits,
                                 ck_Error *error);

#endif
