#include "command.h"

#include <stdio.h>
#include <string.h>

static void show_ledger(ck_Answer *answer, const ck_Run *run) {
    static const ck_AnswerColumn columns[] = {
        {"engine", "engine", -15, NULL}, {"quantity", "quantity", -20, NULL},   {"wanted", "wanted", 10, "%.4g"},
        {"unit", "", -6, NULL},          {"native_parameter", "as", -18, NULL}, {"native_value", "=", 12, "%.6g"},
        {"match", "match", -11, NULL},   {"formula", "by", -20, NULL},          {NULL, NULL, 0, NULL}};
    char title[800], iterations[40] = "";
    if (run->used.iterations) snprintf(iterations, sizeof iterations, ", %u iterations", run->used.iterations);
    snprintf(title, sizeof title, "%s: %s; %u substeps%s", run->engine->name, run->reason, run->used.substeps,
             iterations);
    ck_answer_gap(answer);
    ck_answer_table(answer, "ledger", title, columns);
    for (int row = 0; row < run->ledger.count; row++) {
        const ck_LedgerRow *entry = &run->ledger.rows[row];
        ck_answer_text(answer, run->engine->name);
        ck_answer_text(answer, entry->quantity);
        ck_answer_number(answer, entry->wanted);
        ck_answer_text(answer, entry->unit);
        ck_answer_text(answer, entry->native_parameter);
        ck_answer_number(answer, entry->native_value);
        ck_answer_text(answer, ck_match_names[entry->match]);
        ck_answer_text(answer, entry->formula);
    }
}

static void show(ck_Arguments *arguments, const ck_Comparison *comparison) {
    ck_Answer *answer = &arguments->answer;
    ck_answer_summary(arguments, comparison);
    ck_answer_cheapest(arguments, comparison);
    for (int i = 0; i < comparison->run_count; i++) show_ledger(answer, &comparison->runs[i]);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    if (!status && arguments.scene_count != 1)
        status = ck_fail(&error, CK_BAD_INPUT,
                         arguments.scene_count ? "run takes one SCENE; %d are given; compare takes several"
                                               : "run takes one SCENE; none is given; 'clothcheck list' tells them",
                         arguments.scene_count);
    // it is only written to CSVs
    if (!arguments.out) arguments.options.consistency_budget = 0;
    if (!status) status = ck_command_compare_scenes(&arguments, show, &error);
    if (!status) ck_answer_gap(&arguments.answer);
    if (!status)
        ck_answer_line(&arguments.answer, CK_ANSWER_NEXT, "clothcheck compare %s --out out, then clothcheck report out",
                       arguments.scenes[0]);
    return ck_command_end(&arguments, status, &error);
}

const ck_Command ck_command_run = {
    .name = "run",
    .arguments = "SCENE",
    .about = "one scene, chosen engines: summary and ledger; CSVs with --out",
    .help = "Runs one scene and prints a summary and what each engine made of the scene.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_TIMING | CK_TAKES_PATIENCE | CK_TAKES_JOBS |
              CK_TAKES_KEEPING,
    .seconds = 900,
    .patience = 10,
    .run = run,
};
