#include "command.h"
#include "comparison.h"

#include <stdio.h>
#include <string.h>

// Which engine stands apart, if any does.
static void show_outliers(ck_Answer *answer, const ck_Comparison *comparison) {
    for (int i = 0; i < ck_metric_count(); i++) {
        const ck_Metric *metric = ck_metric_at(i);
        if (!metric->at || !ck_metric_is_wanted(metric, &comparison->model)) continue;
        ck_Outlier outlier = ck_outlier_find(comparison, metric);
        if (outlier.run < 0) continue;
        const char *name = comparison->runs[outlier.run].engine->name;
        if (outlier.has_truth)
            ck_answer_line(answer, CK_ANSWER_NOTE, "farthest from the truth in %s: %s, %.1e; the others %.1e",
                           metric->name, name, outlier.distance, outlier.rest);
        else
            ck_answer_line(answer, CK_ANSWER_NOTE, "outlier in %s: %s, %.1e from the others, which are %.1e apart",
                           metric->name, name, outlier.distance, outlier.rest);
    }
}

static void show(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    ck_answer_summary(arguments, comparison);
    show_outliers(answer, comparison);
    ck_answer_cheapest(arguments, comparison);
    ck_answer_gap(answer);
}

// Only every shards-th scene, from the shard-th.
static ck_Status take_part(ck_Arguments *arguments, ck_Error *error) {
    int count = 0;
    if (arguments->shards <= 1) return CK_OK;
    for (int i = 0; i < arguments->scene_count; i++) {
        if (i % arguments->shards == arguments->shard - 1)
            arguments->scenes[count++] = arguments->scenes[i];
        else
            free(arguments->scenes[i]);
    }
    if (!count)
        ck_fail(error, CK_BAD_INPUT, "--shard %d/%d: there are only %d scenes", arguments->shard, arguments->shards,
                arguments->scene_count);
    arguments->scene_count = count;
    return count ? CK_OK : CK_BAD_INPUT;
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status) status = ck_arguments_all_scenes(&arguments, &error);
    if (!status) status = take_part(&arguments, &error);
    if (!status) status = ck_command_compare_scenes(&arguments, show, &error);
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_NOTE,
                       "sag is / size, errors are distances to the truth / size, ms CPU/s is CPU time per simulated "
                       "second (median), ms/frame that of 1/60 s");
        status = ck_answer_findings(&arguments, NULL, &error);
    }
    if (!status) {
        ck_answer_line(&arguments.answer, CK_ANSWER_FILES, "%s", arguments.out);
        if (arguments.shards > 1)
            ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck merge OUT %s ...", arguments.out);
        else
            ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck report %s", arguments.out);
    }
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_compare = {
    .name = "compare",
    .arguments = "[SCENE...]",
    .about = "all engines on all scenes: the six CSVs of a comparison",
    .help = "Runs all engines on all scenes (without SCENE: scenes/*.yaml) and writes runs.csv, metrics.csv, "
            "deviations.csv,\nledger.csv, series.csv and machine.csv into --out. Results there that this "
            "comparison would not\nreplace stop it: --append keeps those of other scenes, --force replaces all.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS |
              CK_TAKES_KEEPING | CK_TAKES_PART,
    .out = "out",
    .seconds = 900,
    .patience = 10,
    .run = run,
};
