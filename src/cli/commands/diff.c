// What moved between two results.
#include "command.h"
#include "csv_reader.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Values are told apart where they differ by more than the truths' uncertainties, and by more than rounding.
#define ROUNDING 1e-9

typedef struct Result {
    const char *directory;
    ck_CsvTable runs, metrics;
} Result;

// A table's rows in the order of some columns, so that one is found among many.
typedef struct Index {
    const ck_CsvTable *table;
    const char *const *columns;
    int *rows; // [row_count]
} Index;

static int compare_rows(const ck_CsvTable *one, int row, const ck_CsvTable *other, int with,
                        const char *const *columns) {
    int order = 0;
    for (; *columns && !order; columns++)
        order = strcmp(ck_csv_text_of(one, row, *columns), ck_csv_text_of(other, with, *columns));
    return order;
}

static int compare_indexed(const void *a, const void *b, void *context) {
    const Index *index = context;
    const int one = *(const int *)a, other = *(const int *)b,
              order = compare_rows(index->table, one, index->table, other, index->columns);
    return order ? order : one - other;
}

static bool index_table(Index *index, const ck_CsvTable *table, const char *const *columns) {
    *index = (Index){table, columns, malloc(sizeof *index->rows * ((size_t)table->row_count + 1))};
    for (int i = 0; i < table->row_count && index->rows; i++) index->rows[i] = i;
    if (index->rows) qsort_r(index->rows, (size_t)table->row_count, sizeof *index->rows, compare_indexed, index);
    return index->rows != NULL;
}

// The first row that has the same in the index's columns; negative: none.
static int find_row(const Index *index, const ck_CsvTable *table, int row) {
    int low = 0, high = index->table->row_count;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (compare_rows(index->table, index->rows[middle], table, row, index->columns) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    const bool is_there =
        low < index->table->row_count && !compare_rows(index->table, index->rows[low], table, row, index->columns);
    return is_there ? index->rows[low] : -1;
}

typedef struct Diff {
    Result old, new;
    Index old_runs, new_runs, old_metrics;
    ck_Answer *answer;
    int moved, changed, faster, slower, only_old, only_new;
} Diff;

static const char *const run_key[] = {"scene", "engine", NULL};
static const char *const metric_key[] = {"scene", "engine", "metric", NULL};

static ck_Status read_result(Result *result, const char *directory, ck_Error *error) {
    result->directory = directory;
    ck_Status status = ck_csv_table_read(&result->runs, directory, &ck_layouts[CK_RUNS], error);
    if (!status) status = ck_csv_table_read(&result->metrics, directory, &ck_layouts[CK_METRICS], error);
    return status;
}

static void show_statuses(Diff *diff) {
    const ck_CsvTable *old = &diff->old.runs, *new = &diff->new.runs;
    for (int i = 0; i < new->row_count; i++) {
        int before = find_row(&diff->old_runs, new, i);
        const char *was = before < 0 ? "" : ck_csv_text_of(old, before, "status"),
                   *is = ck_csv_text_of(new, i, "status");
        diff->only_new += before < 0;
        if (before < 0 || !strcmp(was, is)) continue;
        diff->changed++;
        ck_answer_line(diff->answer, CK_ANSWER_NOTE, "%s %s: %s, was %s: %s", ck_csv_text_of(new, i, "scene"),
                       ck_csv_text_of(new, i, "engine"), is, was, ck_csv_text_of(new, i, "reason"));
    }
    for (int i = 0; i < old->row_count; i++) diff->only_old += find_row(&diff->new_runs, old, i) < 0;
}

static bool has_moved(double was, double is, double uncertainty) {
    if (isnan(was) || isnan(is)) return isnan(was) != isnan(is);
    return fabs(is - was) > fmax(uncertainty, ROUNDING * fmax(fabs(was), fabs(is)));
}

static void show_metrics(Diff *diff) {
    static const ck_AnswerColumn columns[] = {{"scene", "scene", -20, NULL},
                                              {"engine", "engine", -16, NULL},
                                              {"metric", "metric", -16, NULL},
                                              {"was", "was", 14, "%.9g"},
                                              {"is", "is", 14, "%.9g"},
                                              {"error_was", "error was", 10, "%.2g"},
                                              {"error_is", "error is", 10, "%.2g"},
                                              {"uncertainty", "known to", 9, "%.1g"},
                                              {NULL, NULL, 0, NULL}};
    const ck_CsvTable *old = &diff->old.metrics, *new = &diff->new.metrics;
    for (int i = 0; i < new->row_count; i++) {
        int before = find_row(&diff->old_metrics, new, i);
        if (before < 0) continue;
        double was = ck_csv_number_of(old, before, "value"), is = ck_csv_number_of(new, i, "value");
        double uncertainty =
            fmax(ck_csv_number_of(old, before, "truth_uncertainty"), ck_csv_number_of(new, i, "truth_uncertainty"));
        if (!has_moved(was, is, isnan(uncertainty) ? 0 : uncertainty)) continue;
        if (!diff->moved++) ck_answer_table(diff->answer, "moved", "Values that moved:", columns);
        ck_answer_text(diff->answer, ck_csv_text_of(new, i, "scene"));
        ck_answer_text(diff->answer, ck_csv_text_of(new, i, "engine"));
        ck_answer_text(diff->answer, ck_csv_text_of(new, i, "metric"));
        const double numbers[] = {was, is, ck_csv_number_of(old, before, "error"), ck_csv_number_of(new, i, "error"),
                                  uncertainty};
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) ck_answer_number(diff->answer, numbers[k]);
    }
}

// Costs differ where their intervals have nothing in common.
static void show_costs(Diff *diff) {
    static const ck_AnswerColumn columns[] = {
        {"scene", "scene", -20, NULL},     {"engine", "engine", -16, NULL}, {"cpu_was_s", "CPU was, s", 12, "%.4g"},
        {"cpu_is_s", "is, s", 12, "%.4g"}, {"ratio", "ratio", 8, "%.3f"},   {NULL, NULL, 0, NULL}};
    const ck_CsvTable *old = &diff->old.runs, *new = &diff->new.runs;
    for (int i = 0; i < new->row_count; i++) {
        int before = find_row(&diff->old_runs, new, i);
        if (before < 0 || ck_csv_number_of(old, before, "simulated_s") != ck_csv_number_of(new, i, "simulated_s"))
            continue;
        bool is_faster = ck_csv_number_of(new, i, "cpu_high_s") < ck_csv_number_of(old, before, "cpu_low_s");
        bool is_slower = ck_csv_number_of(new, i, "cpu_low_s") > ck_csv_number_of(old, before, "cpu_high_s");
        if (!is_faster && !is_slower) continue;
        if (!(diff->faster + diff->slower))
            ck_answer_table(diff->answer, "costs", "Costs whose intervals do not meet:", columns);
        diff->faster += is_faster;
        diff->slower += is_slower;
        double was = ck_csv_number_of(old, before, "cpu_median_s"), is = ck_csv_number_of(new, i, "cpu_median_s");
        ck_answer_text(diff->answer, ck_csv_text_of(new, i, "scene"));
        ck_answer_text(diff->answer, ck_csv_text_of(new, i, "engine"));
        ck_answer_number(diff->answer, was);
        ck_answer_number(diff->answer, is);
        ck_answer_number(diff->answer, is / was);
    }
}

static void show(Diff *diff) {
    show_metrics(diff);
    show_costs(diff);
    show_statuses(diff);
    if (diff->only_old || diff->only_new)
        ck_answer_line(diff->answer, CK_ANSWER_NOTE, "%d runs are in %s alone, %d in %s", diff->only_old,
                       diff->old.directory, diff->only_new, diff->new.directory);
    ck_answer_line(diff->answer, CK_ANSWER_SAYS,
                   "%d values moved, %d runs ended otherwise; %d runs are faster, %d slower", diff->moved,
                   diff->changed, diff->faster, diff->slower);
}

static int run(const ck_Command *command, int argc, char **argv) {
    ck_Error error = {0};
    ck_Arguments arguments;
    ck_Status status = ck_arguments_read(&arguments, command, argc, argv, &error);
    Diff diff = {.answer = &arguments.answer};
    if (!status && arguments.word_count != 2)
        status = ck_fail(&error, CK_BAD_INPUT, "diff takes OLD and NEW, two directories of results; %d are given",
                         arguments.word_count);
    if (!status) status = read_result(&diff.old, arguments.words[0], &error);
    if (!status) status = read_result(&diff.new, arguments.words[1], &error);
    const bool is_indexed = !status && index_table(&diff.old_runs, &diff.old.runs, run_key) &&
                            index_table(&diff.new_runs, &diff.new.runs, run_key) &&
                            index_table(&diff.old_metrics, &diff.old.metrics, metric_key);
    if (!status && !is_indexed) status = ck_fail(&error, CK_NO_MEMORY, "out of memory");
    if (!status) show(&diff);
    free(diff.old_runs.rows);
    free(diff.new_runs.rows);
    free(diff.old_metrics.rows);
    Result *const results[] = {&diff.old, &diff.new};
    for (int i = 0; i < 2; i++) {
        ck_csv_table_free(&results[i]->runs);
        ck_csv_table_free(&results[i]->metrics);
    }
    int ended = ck_command_end(&arguments, status, &error);
    return !ended && diff.moved + diff.changed ? CK_EXIT_FAILED : ended;
}

const ck_Command ck_command_diff = {
    .name = "diff",
    .arguments = "OLD NEW",
    .about = "what moved between two results, fit for a pull request with --markdown",
    .help = "Compares two directories that compare wrote. A value has moved where it differs by more than the truth's "
            "uncertainty\nand by more than 1e-9 of it; a cost where the intervals of the medians do not meet. Exit "
            "status 1 "
            "where a value moved\nor a run ended otherwise.",
    .groups = CK_TAKES_FORM,
    .run = run,
};
