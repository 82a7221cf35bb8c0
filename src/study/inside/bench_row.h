// A row of bench.csv.
#ifndef CK_BENCH_ROW_H
#define CK_BENCH_ROW_H

#include "bench_body.h"
#include "csv_writer.h"
#include "model.h"

#define CK_BENCH_MAX_ROUNDS 99

// The median, the lower and the upper quartile of count values, CK_BENCH_MAX_ROUNDS at most.
void ck_bench_quartiles(const double *values, int count, double quartiles[3]);

// quartiles: NULL where there are none, for the reason, which may be NULL.
void ck_bench_add_row(ck_Csv *csv, const ck_BenchBody *body, const ck_Model *model, const char *engine,
                      const char *setup, const char *metric, const char *unit, const double *quartiles, double scale,
                      const char *reason);

#endif
