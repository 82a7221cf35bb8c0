#include "bench_processor.h"

#include "bench_row.h"
#include "loops.h"
#include "process.h"
#include "waves.h"

#include <math.h>

#define PEAK_ROUNDS 200000
#define TRIPS 10000
#define TRIP_ROUNDS 15

static double find_peak(void) {
    double best = 0;
    for (int i = 0; i < 20; i++) {
        double result, start = ck_thread_cpu();
        long count = ck_loops_at(0)->peak(PEAK_ROUNDS, &result);
        best = fmax(best, (double)count / (ck_thread_cpu() - start));
    }
    return best;
}

static void do_nothing(void *state, long step, bool runs_first, bool runs_second) {
    (void)state;
    (void)step;
    (void)runs_first;
    (void)runs_second;
}

// Each half's step waits for the other's last one.
static bool take_turns(void *state, long step, int half, long *needs) {
    (void)state;
    *needs = step + half;
    return true;
}

static ck_Status find_round_trip(double quartiles[3], ck_Error *error) {
    ck_Waves *waves;
    double trips[TRIP_ROUNDS];
    ck_Status status = ck_waves_create(&waves, 2, error);
    for (int i = 0; i < TRIP_ROUNDS && !status; i++) {
        const double start = ck_wall();
        ck_waves_run_halves(waves, &(ck_HalvesWork){do_nothing, take_turns, NULL, TRIPS});
        trips[i] = (ck_wall() - start) / TRIPS;
    }
    if (!status) ck_bench_quartiles(trips, TRIP_ROUNDS, quartiles);
    ck_waves_destroy(waves);
    return status;
}

ck_Status ck_bench_add_processor(ck_Csv *csv, double *operations_peak, ck_Error *error) {
    const ck_BenchBody processor = {.name = "processor"};
    const ck_Model none = {0};
    const double peak = find_peak(), each[3] = {peak, peak, peak};
    double trip[3];
    ck_Status status = find_round_trip(trip, error);
    if (status) return status;
    ck_bench_add_row(csv, &processor, &none, "", "", "operations_peak", "1/s", each, 1, NULL);
    ck_bench_add_row(csv, &processor, &none, "", "2 threads", "round_trip", "s", trip, 1, NULL);
    *operations_peak = peak;
    return CK_OK;
}
