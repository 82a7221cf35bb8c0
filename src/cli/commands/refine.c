// The same material at one, two and four times the resolution.
#include "refine.h"

#include "csv_reader.h"
#include "files.h"
#include "studies.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The metrics that the terminal shows.
static bool is_shown(const ck_CsvTable *table, int row, const char *scene) {
    static const char *const shown[] = {"sag", "stretch_max", "stretch_rms", "period"};
    bool is = false;
    for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
        is |= !strcmp(ck_csv_text_of(table, row, "metric"), shown[i]);
    return is && !strcmp(ck_csv_text_of(table, row, "scene"), scene);
}

// How many of an engine's metrics converge, and the first one that does not.
static void say_engine(ck_Answer *answer, const ck_CsvTable *table, int first, const char *scene) {
    const char *engine = ck_csv_text_of(table, first, "engine"), *not = NULL;
    int converging = 0, known = 0;
    double coarse = NAN, limit = NAN;
    for (int i = first; i < table->row_count; i++) {
        if (!is_shown(table, i, scene) || strcmp(ck_csv_text_of(table, i, "engine"), engine)) continue;
        const char *verdict = ck_csv_text_of(table, i, "verdict");
        if (!strcmp(verdict, "unknown")) continue;
        known++;
        const bool converges = strcmp(verdict, "does not converge") != 0;
        converging += converges;
        if (!converges && !not ) not = ck_csv_text_of(table, i, "metric");
        if (strcmp(ck_csv_text_of(table, i, "metric"), "sag")) continue;
        coarse = ck_csv_number_of(table, i, "coarse");
        limit = ck_csv_number_of(table, i, "limit");
    }
    if (!known)
        ck_answer_line(answer, CK_ANSWER_NOTE, "%s: %s", engine, ck_csv_text_of(table, first, "reason"));
    else if (isnan(limit))
        ck_answer_line(answer, CK_ANSWER_SAYS, "%s, %s: %d of %d metrics converge%s%s", scene, engine, converging,
                       known, not ? "; not " : "", not ? not : "");
    else
        ck_answer_line(
            answer, CK_ANSWER_SAYS,
            "%s, %s: %d of %d metrics converge%s%s; as it is its sag is %.2g %% off that of the finest limit", scene,
            engine, converging, known, not ? "; not " : "", not ? not : "", 100 * fabs(coarse / limit - 1));
}

static ck_Status answer_refine(ck_Answer *answer, const char *directory, const char *scene, ck_Error *error) {
    static const ck_AnswerColumn columns[] = {
        {"engine", "engine", -16, NULL}, {"metric", "metric", -12, NULL},   {"coarse", "n", 11, "%.6g"},
        {"middle", "2n", 11, "%.6g"},    {"fine", "4n", 11, "%.6g"},        {"order", "order", 6, "%.2f"},
        {"limit", "limit", 11, "%.6g"},  {"verdict", "verdict", -18, NULL}, {NULL, NULL, 0, NULL}};
    static const char *const numbers[] = {"coarse", "middle", "fine", "order", "limit"};
    ck_CsvTable table = {0};
    ck_Status status = ck_csv_table_read(&table, directory, &ck_layouts[CK_REFINE_SUMMARY], error);
    if (!status) ck_answer_table(answer, "refine", NULL, columns);
    for (int i = 0; i < table.row_count && !status; i++) {
        if (!is_shown(&table, i, scene) || !strcmp(ck_csv_text_of(&table, i, "verdict"), "unknown")) continue;
        ck_answer_text(answer, ck_csv_text_of(&table, i, "engine"));
        ck_answer_text(answer, ck_csv_text_of(&table, i, "metric"));
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++)
            ck_answer_number(answer, ck_csv_number_of(&table, i, numbers[k]));
        ck_answer_text(answer, ck_csv_text_of(&table, i, "verdict"));
    }
    for (int i = 0, last = -1; i < table.row_count && !status; i++) {
        if (!is_shown(&table, i, scene)) continue;
        if (last < 0 || strcmp(ck_csv_text_of(&table, last, "engine"), ck_csv_text_of(&table, i, "engine")))
            say_engine(answer, &table, i, scene);
        last = i;
    }
    ck_csv_table_free(&table);
    return status;
}

static ck_Status run_refine(const ck_StudyCommand *command, ck_Error *error) {
    ck_Refine refine = {0};
    ck_Csv csv = {0}, summary = {0};
    ck_JournalRow *rows = NULL;
    char *cache = ck_path_join(command->arguments->out, "truths");
    ck_Status status = cache
                           ? ck_refine_create(&refine, command->comparison, &command->arguments->options, cache, error)
                           : ck_fail(error, CK_NO_MEMORY, "out of memory");
    const ck_Study study = ck_refine_study(&refine);
    if (!status) status = ck_study_command_run(command, &study, 0, &rows, error);
    if (!status) status = ck_study_command_open(command, &csv, CK_REFINE, error);
    if (!status) status = ck_study_command_open(command, &summary, CK_REFINE_SUMMARY, error);
    if (!status) ck_refine_write(&refine, rows, &csv, &summary);
    if (!status) status = ck_csv_close(&csv, error);
    if (!status) status = ck_csv_close(&summary, error);
    if (!status)
        status = answer_refine(command->answer, command->arguments->out, command->comparison->model.name, error);
    if (!status) ck_study_command_done(command, &study, "refine.csv, refine_summary.csv");
    ck_csv_discard(&csv);
    ck_csv_discard(&summary);
    free(rows);
    free(cache);
    ck_refine_free(&refine);
    return status;
}

static int refine(const ck_Command *command, int argc, char **argv) {
    return ck_study_command(command, CK_REFINE, argc, argv, run_refine);
}

const ck_Command ck_command_refine = {
    .name = "refine",
    .arguments = "SCENE...",
    .about = "the same material at n, 2n and 4n: what converges, and to what: refine.csv",
    .help =
        "Runs every engine, and solves the truth, on a cloth or rope of one, two and four times as many segments a "
        "row, "
        "of the\nsame mass and material; writes refine.csv with every metric, and refine_summary.csv with the order in "
        "which each\nconverges and its limit. A scene with a 'material' is the same sheet at each; fixed springs keep "
        "their k.",
    .groups = CK_TAKES_FORM | CK_TAKES_OUT | CK_TAKES_RUNS | CK_TAKES_KEEPING | CK_TAKES_PATIENCE | CK_TAKES_JOBS |
              CK_TAKES_SHARD,
    .out = "out",
    .seconds = 300,
    .patience = 30,
    .full_patience = 300,
    .shares_out = true,
    .run = refine,
};
