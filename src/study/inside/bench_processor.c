#include "bench_processor.h"

#include "bench_row.h"
#include "loops.h"
#include "process.h"
#include "waves.h"

#include <math.h>

#define PEAK_ROUNDS 200000
#define TRIPS 1000
#define TRIP_ROUNDS 25
#define MOST_SECONDS 2.0
// s: a mean beyond this is dropped, as one of them had lost its processor to others for some ms.
#define LONGEST_TRIP 2e-6

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

// s, or less than 0 where the threads did not run side by side.
static double time_trips(ck_Waves *waves) {
    // wakes the other one
    ck_waves_run_halves(waves, &(ck_HalvesWork){do_nothing, take_turns, NULL, 2, 2});
    const double start = ck_wall();
    ck_waves_run_halves(waves, &(ck_HalvesWork){do_nothing, take_turns, NULL, TRIPS, TRIPS});
    const double trip = (ck_wall() - start) / TRIPS;
    return trip < LONGEST_TRIP ? trip : -1;
}

// Each with threads of its own, whose first jobs are shared. Fewer where the processors are taken by others, as a trip
// then takes milliseconds.
static ck_Status find_round_trip(double quartiles[3], ck_Error *error) {
    double trips[TRIP_ROUNDS];
    const double end = ck_wall() + MOST_SECONDS;
    int count = 0;
    for (int i = 0; i < TRIP_ROUNDS && (i == 0 || ck_wall() < end); i++) {
        ck_Waves *waves;
        ck_Status status = ck_waves_create(&waves, 2, error);
        if (status) return status;
        const double trip = time_trips(waves);
        ck_waves_destroy(waves);
        if (trip > 0) trips[count++] = trip;
    }
    ck_bench_quartiles(trips, count, quartiles);
    return CK_OK;
}

ck_Status ck_bench_add_processor(ck_Csv *csv, double *operations_peak, ck_Error *error) {
    const ck_BenchBody processor = {.name = "processor"};
    const ck_Model none = {0};
    const double peak = find_peak(), each[3] = {peak, peak, peak};
    double trip[3];
    ck_Status status = find_round_trip(trip, error);
    if (status) return status;
    ck_bench_add_row(csv, &processor, &none, "", "", "operations_peak", "1/s", each, 1, NULL);
    ck_bench_add_row(csv, &processor, &none, "", "2 threads", "round_trip", "s", isnan(trip[0]) ? NULL : trip, 1,
                     isnan(trip[0]) ? "two threads did not run side by side" : NULL);
    *operations_peak = peak;
    return CK_OK;
}
