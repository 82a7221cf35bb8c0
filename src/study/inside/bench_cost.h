// Rows of what engines cost to be right: cloths that are let go, of one stiffness each.
#ifndef CK_BENCH_COST_H
#define CK_BENCH_COST_H

#include "bench.h"
#include "bench_body.h"

typedef struct ck_BenchCloth {
    ck_BenchBody body;
    double stiffness; // N/m
} ck_BenchCloth;

#define CK_BENCH_CLOTHS 3
extern const ck_BenchCloth ck_bench_cloths[CK_BENCH_CLOTHS];

// Each engine's cheapest settings within an error, by the same search; the reference and how well it is known first.
// Errors: CK_NO_MEMORY.
ck_Status ck_bench_add_costs(ck_Csv *csv, const ck_BenchCloth *cloth, const ck_BenchOptions *options, ck_Error *error);

#endif
