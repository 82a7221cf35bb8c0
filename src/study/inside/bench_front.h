// What engines cost to be right: the cheapest settings within an error.
#ifndef CK_BENCH_FRONT_H
#define CK_BENCH_FRONT_H

#include "bench_body.h"
#include "engine.h"

// Errors, rms position over all frames / size, that are asked for.
#define CK_BENCH_TARGETS 2
extern const double ck_bench_targets[CK_BENCH_TARGETS];

// A cloth as it is let go, with drag and dampers, and where it is to be after each frame.
typedef struct ck_BenchFront {
    ck_Model model;
    int frames;
    double *reference;  // [frames][3*n] m
    double uncertainty; // of it: how far native-verlet is off with steps twice as long
} ck_BenchFront;

// stiffness: N/m along, half of it across. Cost: native-verlet at a quarter of its largest stable step, and at a half.
// Errors: CK_NO_MEMORY. Free with ck_bench_front_free in any case.
ck_Status ck_bench_front_build(ck_BenchFront *front, const ck_BenchBody *body, double stiffness, ck_Error *error);
void ck_bench_front_free(ck_BenchFront *front);

// Settings, and CPU seconds a simulated second; NaN: none within the budget.
typedef struct ck_BenchCost {
    ck_Settings settings;
    double seconds;
} ck_BenchCost;

// The cheapest of an engine for each target, [CK_BENCH_TARGETS], over 2, 3, 4, 6, 8 … substeps and several numbers of
// sweeps, and then over the number of substeps halfway to the next lower one of those.
//   base    the settings that are not searched
//   budget  CPU s of a run at most
// An error that is not there says why in words.
void ck_bench_front_search(const ck_BenchFront *front, const ck_Engine *engine, const ck_Settings *base, double budget,
                           ck_BenchCost *costs, char reason[200]);

// The error of a run, and its CPU seconds a simulated second; NaN where it fails, takes longer than the budget or is
// beyond every target.
double ck_bench_front_run(const ck_BenchFront *front, const ck_Engine *engine, const ck_Settings *wanted, double budget,
                          double *seconds, char reason[200]);

#endif
