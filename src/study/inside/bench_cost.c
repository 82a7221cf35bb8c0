#include "bench_cost.h"

#include "bench_front.h"
#include "bench_row.h"
#include "engines.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

const ck_BenchCloth ck_bench_cloths[CK_BENCH_CLOTHS] = {{{"cloth", CK_BENCH_CLOTH, 20, 20}, 1e3},
                                                        {{"cloth", CK_BENCH_CLOTH, 64, 64}, 1e3},
                                                        {{"cloth", CK_BENCH_CLOTH, 64, 64}, 1e6}};
// CPU s of a run at most.
#define BUDGET 3

// What is not searched, and how a set-up says so.
typedef struct Base {
    ck_Settings settings;
    const char *precision;
} Base;

static void add_cost(ck_Csv *csv, const ck_BenchCloth *cloth, const ck_BenchFront *built, const ck_Engine *engine,
                     const Base *base, int target, const ck_BenchCost *cost, const char *reason, int rounds) {
    char setup[100], metric[40], why[200];
    double times[CK_BENCH_MAX_ROUNDS], quartiles[3];
    const bool is_found = !isnan(cost->seconds);
    times[0] = cost->seconds;
    for (int i = 1; i < rounds && is_found; i++)
        ck_bench_front_run(built, engine, &cost->settings, INFINITY, &times[i], why);
    if (is_found) ck_bench_quartiles(times, rounds, quartiles);
    int used = snprintf(setup, sizeof setup, "%g N/m", cloth->stiffness);
    if (is_found && used > 0)
        used += snprintf(setup + used, sizeof setup - (size_t)used, ", %u substeps", cost->settings.substeps);
    if (is_found && cost->settings.iterations)
        used += snprintf(setup + used, sizeof setup - (size_t)used, ", %u iterations", cost->settings.iterations);
    snprintf(setup + used, sizeof setup - (size_t)used, "%s", base->precision);
    snprintf(metric, sizeof metric, "cost_to_%g_percent", 100 * ck_bench_targets[target]);
    ck_bench_add_row(csv, &cloth->body, &built->model, engine->name, setup, metric, "s/s", is_found ? quartiles : NULL,
                     1,
                     is_found  ? NULL
                     : *reason ? reason
                               : "no settings within the budget get there");
}

static void add_costs_of(ck_Csv *csv, const ck_BenchCloth *cloth, const ck_BenchFront *built, const ck_Engine *engine,
                         const Base *base, int rounds) {
    ck_BenchCost costs[CK_BENCH_TARGETS];
    char reason[200];
    ck_bench_front_search(built, engine, &base->settings, BUDGET, costs, reason);
    for (int target = 0; target < CK_BENCH_TARGETS; target++)
        add_cost(csv, cloth, built, engine, base, target, &costs[target], reason, rounds < 3 ? rounds : 3);
}

ck_Status ck_bench_add_costs(ck_Csv *csv, const ck_BenchCloth *cloth, const ck_BenchOptions *options, ck_Error *error) {
    ck_BenchFront built;
    if (options->progress) options->progress(cloth->body.name, "reference");
    ck_Status status = ck_bench_front_build(&built, &cloth->body, cloth->stiffness, error);
    const double each[3] = {built.uncertainty, built.uncertainty, built.uncertainty};
    char setup[40];
    snprintf(setup, sizeof setup, "%g N/m", cloth->stiffness);
    if (!status)
        ck_bench_add_row(csv, &cloth->body, &built.model, "native-verlet", setup, "reference_uncertainty", "1", each, 1,
                         NULL);
    for (int i = 0; i < ck_engine_count() && !status; i++) {
        const ck_Engine *engine = ck_engine_at(i);
        const ck_Setting *single = ck_setting_find(engine->settings, "single");
        if (engine->method == CK_METHOD_STILL) continue;
        if (options->progress) options->progress(cloth->body.name, engine->name);
        add_costs_of(csv, cloth, &built, engine, &(Base){{0}, ""}, options->rounds);
        if (!single) continue;
        Base base = {{0}, ", single precision"};
        ck_settings_set(&base.settings, single->slot, 1);
        add_costs_of(csv, cloth, &built, engine, &base, options->rounds);
    }
    ck_bench_front_free(&built);
    return status;
}
