#include "bench_row.h"

#include "statistics.h"

#include <math.h>
#include <string.h>

void ck_bench_add_row(ck_Csv *csv, const ck_BenchBody *body, const ck_Model *model, const char *engine,
                      const char *setup, const char *metric, const char *unit, const double *quartiles, double scale,
                      const char *reason) {
    ck_csv_text(csv, body->name);
    ck_csv_count(csv, (uint64_t)model->particle_count);
    ck_csv_count(csv, (uint64_t)model->spring_count);
    ck_csv_text(csv, engine);
    ck_csv_text(csv, setup);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, unit);
    for (int i = 0; i < 3; i++) ck_csv_number(csv, quartiles ? scale * quartiles[i] : NAN);
    ck_csv_text(csv, reason ? reason : "");
}

void ck_bench_quartiles(const double *values, int count, double quartiles[3]) {
    double sorted[CK_BENCH_MAX_ROUNDS];
    memcpy(sorted, values, sizeof *sorted * (size_t)count);
    quartiles[0] = ck_median(sorted, count);
    quartiles[1] = ck_quantile(sorted, count, 0.25);
    quartiles[2] = ck_quantile(sorted, count, 0.75);
}
