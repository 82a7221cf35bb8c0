// How fast the engines are: per spring, per step, and as a cloth grows.
#ifndef CK_BENCH_H
#define CK_BENCH_H

#include "csv_writer.h"
#include "status.h"

typedef struct ck_BenchOptions {
    int rounds;       // interleaved repeats of every engine (default 7)
    double budget;    // CPU seconds that one repeat may take; what takes longer is left out with its reason
    int largest;      // side of the largest cloth, in particles (default 1024)
    const char *only; // a part, as steps, or a body, as on_ball; NULL: all
    void (*progress)(const char *body, const char *engine); // may be NULL
} ck_BenchOptions;

// Adds rows, value the median and low and high the quartiles, of CPU time but for threads' wall time. For cloths of
// 20², 64² and 256², those of 20² and 64² slung around a ball, meshes of 289, 3,025 and 29,929 nodes, a rope of 1000
// and 128 of 32, engines interleaved: time of a step, of an update (one spring in one iteration), its ratio to the
// native one's, share of what the processor could do, gain of two threads, cost of a simulated second at each engine's
// own settings. For the smaller cloths, sweeps and time from 10 % to 4 % strain. Then what it costs each engine to be
// within 1 % and 0.1 % of a fine reference: cost_to_1_percent, by the same search for all (bench_front.h). Then
// native-verlet as the cloth grows. Errors: CK_NO_MEMORY, CK_BAD_INPUT for an only that is neither.
ck_Status ck_bench_write(ck_Csv *csv, const ck_BenchOptions *options, ck_Error *error);

#endif
