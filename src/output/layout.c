#include "layout.h"

#include <assert.h>
#include <string.h>

#define NAME(column)                                                                                                   \
    { column, CK_COLUMN_NAME }
#define TEXT(column)                                                                                                   \
    { column, CK_COLUMN_TEXT }
#define NUMBER(column)                                                                                                 \
    { column, CK_COLUMN_NUMBER }
#define STATUS(column)                                                                                                 \
    { column, CK_COLUMN_STATUS }

const ck_Layout ck_layouts[CK_LAYOUT_COUNT] = {
    [CK_RUNS] = {"runs.csv",
                 "how each run ended, its settings and its cost",
                 {NAME("scene"), NAME("engine"), STATUS("status"), NAME("reason"), NUMBER("time_step_s"),
                  NUMBER("substeps"), NUMBER("iterations"), NUMBER("simulated_s"), NUMBER("cpu_median_s"),
                  NUMBER("cpu_iqr_s"), NUMBER("cpu_low_s"), NUMBER("cpu_high_s"), NUMBER("repeats"),
                  NUMBER("cpu_worst_step_s"), NUMBER("realtime_factor"), NUMBER("peak_rss_bytes"),
                  TEXT("engine_version"), TEXT("method"), NAME("command")}},
    [CK_METRICS] = {"metrics.csv",
                    "what was measured, and how far from the truth it is",
                    {NAME("scene"), NAME("engine"), NAME("metric"), NAME("unit"), NUMBER("value"), NUMBER("truth"),
                     TEXT("truth_kind"), NUMBER("truth_uncertainty"), NUMBER("error"), NUMBER("predicted")}},
    [CK_DEVIATIONS] = {"deviations.csv",
                       "each engine against each other one",
                       {NAME("scene"), NAME("metric"), NAME("engine"), NAME("other_engine"), NUMBER("deviation"),
                        NAME("unit")}},
    [CK_LEDGER] = {"ledger.csv",
                   "what was asked of each engine, and what it got",
                   {NAME("scene"), NAME("engine"), NAME("quantity"), NUMBER("wanted"), TEXT("unit"),
                    TEXT("native_parameter"), NUMBER("native_value"), TEXT("formula"), NAME("match")}},
    [CK_SERIES] = {"series.csv",
                   "metrics at every frame, of the engines and of the truth",
                   {NAME("scene"), NAME("engine"), NUMBER("time_s"), NAME("metric"), NUMBER("value")}},
    [CK_MACHINE] = {"machine.csv", "where it ran", {NAME("key"), TEXT("value")}},
    [CK_PRECISION] = {"precision.csv",
                      "error against cost over time steps and iterations",
                      {NAME("scene"), NAME("engine"), NUMBER("substeps"), NUMBER("iterations"), NUMBER("sweeps"),
                       NUMBER("time_step_s"), NUMBER("simulated_s"), STATUS("status"), NAME("reason"), NUMBER("error"),
                       NUMBER("sag_error"), NUMBER("stretch_error"), NUMBER("cpu_s"), NUMBER("cpu_iqr_s"),
                       NUMBER("on_front"), NUMBER("rounding")}},
    [CK_PRECISION_SUMMARY] = {"precision_summary.csv",
                              "orders of convergence, least errors, cost to reach an error",
                              {NAME("scene"), NAME("engine"), NAME("quantity"), NAME("unit"), NUMBER("value"),
                               NUMBER("expected"), TEXT("reason")}},
    [CK_STABILITY] = {"stability.csv",
                      "where methods fail, and where theory says they do",
                      {NAME("scene"), NAME("engine"), NAME("case"), NAME("damping"), NUMBER("stiffness_factor"),
                       NUMBER("iterations"), NUMBER("time_step_s"), STATUS("status"), NAME("reason"),
                       NUMBER("strain_excess"), NUMBER("speed_m_s"), NUMBER("critical_step_s"),
                       NUMBER("predicted_step_s"), NUMBER("ratio"), NUMBER("rounding_step_s")}},
    [CK_TUNE] = {"tune.csv",
                 "settings that were tried, and the one chosen",
                 {NAME("scene"),          NAME("engine"),          NAME("role"),
                  NUMBER("substeps"),     NUMBER("iterations"),    NUMBER("relaxation"),
                  NUMBER("compliance"),   NUMBER("klst"),          NUMBER("stiffness_factor"),
                  STATUS("status"),       NAME("reason"),          NUMBER("error"),
                  NUMBER("static_error"), NUMBER("dynamic_error"), NUMBER("tolerance"),
                  NUMBER("stretch"),      TEXT("meets_tolerance"), NUMBER("work_per_s"),
                  NUMBER("cpu_s"),        TEXT("bounds_hit")}},
    [CK_NEEDS] = {"needs.csv",
                  "what the scene needs to be modelled, and what not",
                  {NAME("scene"), NAME("engine"), NAME("left_out"), TEXT("metric"), TEXT("unit"), NUMBER("with"),
                   NUMBER("without"), NUMBER("change"), NUMBER("tolerance"), TEXT("matters"), NUMBER("cpu_with_s"),
                   NUMBER("cpu_without_s"), STATUS("status"), NAME("reason")}},
    [CK_REFINE] = {"refine.csv",
                   "metrics at one, two and four times the resolution",
                   {NAME("scene"), NAME("engine"), NAME("metric"), NAME("unit"), NUMBER("particles"),
                    NUMBER("spacing_m"), NUMBER("value"), STATUS("status"), NAME("reason")}},
    [CK_REFINE_SUMMARY] = {"refine_summary.csv",
                           "which metrics converge with resolution, with which order, and to what",
                           {NAME("scene"), NAME("engine"), NAME("metric"), NAME("unit"), NUMBER("coarse"),
                            NUMBER("middle"), NUMBER("fine"), NUMBER("order"), NUMBER("limit"), NAME("verdict"),
                            TEXT("reason")}},
    [CK_BENCH] = {"bench.csv",
                  "how fast the engines are, and how cost grows",
                  {NAME("body"), NUMBER("particles"), NUMBER("springs"), TEXT("engine"), TEXT("setup"), NAME("metric"),
                   NAME("unit"), NUMBER("value"), NUMBER("low"), NUMBER("high"), TEXT("reason")}},
    [CK_CLAIMS] = {"claims.csv",
                   "what was claimed of the two origins",
                   {NAME("claim"), NAME("scene"), NAME("engine"), NUMBER("mended"), TEXT("parameter"),
                    NUMBER("parameter_value"), NAME("metric"), TEXT("unit"), NUMBER("value"), NUMBER("low"),
                    NUMBER("high")}},
    [CK_QUIRKS] = {"quirks.csv",
                   "what the quirks of the two origins cost",
                   {NAME("engine"), NAME("quirk"), NAME("experiment"), NAME("metric"), TEXT("unit"),
                    NUMBER("as_it_was"), NUMBER("mended"), NUMBER("physics")}},
    [CK_FIT] = {"fit.csv",
                "values that a measurement gives, each with its interval",
                {NAME("scene"), NAME("engine"), NAME("parameter"), NAME("unit"), NUMBER("value"), NUMBER("low"),
                 NUMBER("high"), NUMBER("start"), NUMBER("misfit")}},
    [CK_CONFORM] = {"conform.csv",
                    "what physics asks of any solver, and what each engine answers",
                    {NAME("engine"), NAME("property"), NAME("unit"), NUMBER("value"), NUMBER("tolerance"),
                     NAME("verdict"), TEXT("reason"), TEXT("command")}},
    [CK_STUDY] = {"study.csv",
                  "each case of a study: how it ended, and where it ran",
                  {NAME("scene"), NAME("engine"), STATUS("status"), NAME("reason"), NUMBER("cost_s"), NAME("host"),
                   NAME("processor"), NAME("version"), NUMBER("seed"), TEXT("command")}},
    [CK_STUDY_CHARTS] = {"study_charts.csv", "what a study's charts show", {NAME("x"), NAME("metric"), NAME("of")}},
    [CK_HISTORY] = {"history.csv",
                    "what check measured, version by version",
                    {NAME("date"), NAME("version"), NAME("scene"), NAME("engine"), NAME("metric"), NUMBER("value")}},
    [CK_BASELINE] = {"metrics.csv",
                     "what was measured before, and how far it may move",
                     {NAME("scene"), NAME("engine"), STATUS("status"), TEXT("metric"), NUMBER("value"),
                      NUMBER("band")}},
};

int ck_layout_column_count(const ck_Layout *layout) {
    int count = 0;
    while (layout->columns[count].name) count++;
    return count;
}

int ck_layout_column(const ck_Layout *layout, const char *name) {
    int column = 0;
    while (layout->columns[column].name && strcmp(layout->columns[column].name, name)) column++;
    assert(layout->columns[column].name);
    return column;
}
