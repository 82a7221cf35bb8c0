#include "check.h"

#include "csv_reader.h"
#include "files.h"
#include "names.h"
#include "statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define NUDGE 1e-12
// A float has 24 bits, and a coordinate may be as large as the size: some ten units in its last place.
#define SINGLE_NUDGE 1e-6
// Starts that are nudged: one alone may leave a chaotic run's metric by chance where it was.
#define NUDGES 3

// Where a study's row holds what.
// After the cost a value and a band of each metric.
enum { CPU, VALUES };

static int value_at(int metric) {
    return VALUES + 2 * metric;
}

static int band_at(int metric) {
    return VALUES + 2 * metric + 1;
}

static bool value_name(int index, char *name, size_t size) {
    int metric = (index - VALUES) / 2;
    if (index >= value_at(ck_metric_count())) return false;
    if (index == CPU)
        snprintf(name, size, "cpu_s");
    else
        snprintf(name, size, "%s%s", ck_metric_at(metric)->name, index == band_at(metric) ? " band" : "");
    return true;
}
_Static_assert(VALUES + 2 * CK_METRIC_CAPACITY <= CK_JOURNAL_VALUES, "raise CK_JOURNAL_VALUES");

ck_Status ck_baseline_read(ck_Baseline *baseline, const char *path, ck_Error *error) {
    *baseline = (ck_Baseline){0};
    ck_CsvTable table;
    ck_Status status = ck_csv_table_read_file(&table, path, &ck_layouts[CK_BASELINE], error);
    if (status == CK_IO)
        status = ck_fail(error, CK_BAD_INPUT, "%s: cannot be read; 'clothcheck check --update' writes it", path);
    if (!status && !table.row_count)
        status = ck_fail(error, CK_BAD_INPUT, "%s: holds no rows; 'clothcheck check --update' writes it", path);
    if (!status && !(baseline->rows = calloc((size_t)table.row_count, sizeof *baseline->rows)))
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < table.row_count && !status; i++) {
        ck_BaselineRow *row = &baseline->rows[baseline->count++];
        snprintf(row->scene, sizeof row->scene, "%s", ck_csv_table_text(&table, i, 0));
        snprintf(row->engine, sizeof row->engine, "%s", ck_csv_table_text(&table, i, 1));
        snprintf(row->status, sizeof row->status, "%s", ck_csv_table_text(&table, i, 2));
        snprintf(row->metric, sizeof row->metric, "%s", ck_csv_table_text(&table, i, 3));
        row->value = ck_csv_table_number(&table, i, 4);
        row->band = ck_csv_table_number(&table, i, 5);
        // a row without a metric is for its status alone
        if (*row->metric && !(isfinite(row->band) && row->band >= 0))
            status = ck_fail(error, CK_BAD_INPUT,
                             "%s: row %d, %s of %s on %s: the band is %g; it must be a number that is not negative; "
                             "'clothcheck check --update' writes it",
                             path, i + 2, row->metric, row->engine, row->scene, row->band);
    }
    ck_csv_table_free(&table);
    return status;
}

void ck_baseline_free(ck_Baseline *baseline) {
    free(baseline->rows);
    *baseline = (ck_Baseline){0};
}

void ck_baseline_add(const ck_BaselineRow *row, ck_Csv *csv) {
    ck_csv_text(csv, row->scene);
    ck_csv_text(csv, row->engine);
    ck_csv_text(csv, row->status);
    ck_csv_text(csv, row->metric);
    ck_csv_number(csv, row->value);
    ck_csv_number(csv, row->band);
}

static void describe(const void *context, int index, char *key, size_t size) {
    const ck_CheckCase *one = &((const ck_Check *)context)->cases[index];
    snprintf(key, size, "%s %s", one->comparison->model.name, one->engine->name);
}

double ck_check_band(double value, double nudged, bool is_single) {
    return 10 * fabs(nudged - value) + (is_single ? 1e-5 : 1e-10) * fabs(value) + (is_single ? 1e-8 : 1e-13);
}

static ck_Status measure(const ck_Check *check, const ck_CheckCase *one, const ck_Model *model,
                         ck_Measurement *measurement, ck_Error *error) {
    const ck_Settings wanted = ck_comparison_settings(one->engine, &one->comparison->scene, check->options);
    return ck_measurement_take(measurement, model, &one->comparison->truth.reference, one->engine, &wanted,
                               &check->options->limits, NULL, error);
}

// The same from a start that is off by what stands for rounding.
static ck_Status measure_nudged(const ck_Check *check, const ck_CheckCase *one, uint64_t seed,
                                ck_Measurement *measurement, ck_Error *error) {
    ck_Model model = one->comparison->model;
    size_t count = 3 * (size_t)model.particle_count;
    double *position = malloc(count * sizeof *position);
    if (!position) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Random random = ck_random_seed(seed);
    for (size_t i = 0; i < count; i++) {
        double off = (one->engine->is_single ? SINGLE_NUDGE : NUDGE) * model.size * (2 * ck_random_unit(&random) - 1);
        position[i] = model.position[i] + (model.pinned[i / 3] ? 0 : off);
    }
    model.position = position;
    ck_Status status = measure(check, one, &model, measurement, error);
    free(position);
    return status;
}

static ck_Status run(const void *context, int index, ck_JournalRow *row, ck_Error *error) {
    const ck_Check *check = context;
    const ck_CheckCase *one = &check->cases[index];
    ck_Measurement now, nudged;
    ck_Status status = measure(check, one, &one->comparison->model, &now, error);
    if (status) return status;
    row->status = (int)now.status;
    snprintf(row->reason, sizeof row->reason, "%s", now.reason);
    row->values[CPU] = now.cpu;
    for (int i = 0; i < ck_metric_count(); i++) row->values[value_at(i)] = now.values[i];
    if (!check->is_update || isnan(now.cpu)) return CK_OK;
    for (int nudge = 0; nudge < NUDGES && !status; nudge++) {
        status = measure_nudged(check, one, 3 + (uint64_t)nudge, &nudged, error);
        for (int i = 0; i < ck_metric_count() && !status; i++) {
            double *widest = &row->values[band_at(i)],
                   band = ck_check_band(now.values[i], nudged.values[i], one->engine->is_single);
            if (nudge == 0 || isnan(band) || band > *widest) *widest = band;
        }
    }
    return status;
}

ck_Study ck_check_study(const ck_Check *check) {
    return (ck_Study){"check", value_name, check->case_count, (void *)check, describe, run};
}

static int compare_deviations(const void *a, const void *b) {
    double x = ((const ck_Deviation *)a)->excess, y = ((const ck_Deviation *)b)->excess;
    return (x < y) - (x > y);
}

// The most that a metric may have moved.
static double allowed_of(const ck_Check *check, const ck_BaselineRow *was) {
    double allowed = was->band;
    for (int i = 0; i < check->tolerance_count; i++) {
        const ck_Tolerance *tolerance = &check->tolerances[i];
        if (tolerance->metric && strcmp(tolerance->metric, was->metric)) continue;
        allowed = fmax(allowed, tolerance->value * (tolerance->is_relative ? fabs(was->value) : 1));
    }
    return allowed;
}

int ck_check_compare(const ck_Check *check, int index, const ck_JournalRow *row, const ck_Baseline *baseline,
                     ck_Deviation *deviations) {
    int count = 0;
    const ck_CheckCase *one = &check->cases[index];
    const char *status = ck_run_status_names[row->status];
    for (int i = 0; i < baseline->count; i++) {
        const ck_BaselineRow *was = &baseline->rows[i];
        if (strcmp(was->scene, one->comparison->model.name) || strcmp(was->engine, one->engine->name)) continue;
        double value = NAN, excess = 0, allowed = allowed_of(check, was);
        for (int k = 0; k < ck_metric_count(); k++)
            if (!strcmp(ck_metric_at(k)->name, was->metric)) value = row->values[value_at(k)];
        if (strcmp(was->status, status) || isnan(value) != isnan(was->value))
            excess = INFINITY;
        else if (!isnan(value) && value != was->value)
            excess = fabs(value - was->value) / allowed;
        if (!(excess <= 1)) deviations[count++] = (ck_Deviation){was, value, status, allowed, excess};
    }
    qsort(deviations, (size_t)count, sizeof *deviations, compare_deviations);
    return count;
}

bool ck_check_add(const ck_CheckCase *one, const ck_JournalRow *row, double seconds, ck_Csv *csv) {
    if (row->values[CPU] > seconds || row->status == CK_RUN_TIMED_OUT) return false;
    bool has_any = false;
    for (int i = 0; i <= ck_metric_count(); i++) {
        // a run that measures nothing has one row, for its status
        bool is_bare = i == ck_metric_count();
        if (is_bare ? has_any : isnan(row->values[value_at(i)]) || !isfinite(row->values[band_at(i)])) continue;
        has_any = true;
        ck_BaselineRow made = {.value = is_bare ? NAN : row->values[value_at(i)],
                               .band = is_bare ? NAN : row->values[band_at(i)]};
        snprintf(made.scene, sizeof made.scene, "%s", one->comparison->model.name);
        snprintf(made.engine, sizeof made.engine, "%s", one->engine->name);
        snprintf(made.status, sizeof made.status, "%s", ck_run_status_names[row->status]);
        snprintf(made.metric, sizeof made.metric, "%s", is_bare ? "" : ck_metric_at(i)->name);
        ck_baseline_add(&made, csv);
    }
    return true;
}

static void add_history(ck_Csv *csv, const ck_CheckCase *one, const ck_JournalRow *row, const char *date) {
    for (int i = 0; i < ck_metric_count(); i++) {
        if (isnan(row->values[value_at(i)])) continue;
        ck_csv_text(csv, date);
        ck_csv_text(csv, ck_engine_version(one->engine));
        ck_csv_text(csv, one->comparison->model.name);
        ck_csv_text(csv, one->engine->name);
        ck_csv_text(csv, ck_metric_at(i)->name);
        ck_csv_number(csv, row->values[value_at(i)]);
    }
}

ck_Status ck_check_remember(const char *directory, const ck_Check *check, const ck_JournalRow *rows, ck_Error *error) {
    const ck_Layout *layout = &ck_layouts[CK_HISTORY];
    ck_CsvTable table = {0};
    ck_Csv csv = {0};
    char date[40], *path = ck_path_join(directory, layout->file);
    time_t now = time(NULL);
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime(&now));
    if (!path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = access(path, F_OK) ? CK_OK : ck_csv_table_read_file(&table, path, layout, error);
    if (!status) status = ck_csv_open(&csv, directory, layout, error);
    for (int row = 0; row < table.row_count && !status; row++)
        for (int i = 0; i < table.column_count; i++) ck_csv_text(&csv, ck_csv_table_text(&table, row, i));
    for (int i = 0; i < check->case_count && !status; i++) add_history(&csv, &check->cases[i], &rows[i], date);
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    ck_csv_table_free(&table);
    free(path);
    return status;
}

// Text between XML tags and in attributes.
static void write_escaped(FILE *file, const char *text) {
    char plain[1024];
    snprintf(plain, sizeof plain, "%s", text);
    ck_text_plain(plain);
    for (const char *letter = plain; *letter; letter++) switch (*letter) {
        case '<': fputs("&lt;", file); break;
        case '>': fputs("&gt;", file); break;
        case '&': fputs("&amp;", file); break;
        case '"': fputs("&quot;", file); break;
        default: fputc((unsigned char)*letter < 0x20 || *letter == 0x7f ? ' ' : *letter, file);
        }
}

static void write_case(FILE *file, const ck_CheckCase *one, const ck_JournalRow *row, const ck_Deviation *deviations,
                       int count) {
    fprintf(file, "  <testcase classname=\"");
    write_escaped(file, one->comparison->model.name);
    fprintf(file, "\" name=\"");
    write_escaped(file, one->engine->name);
    fprintf(file, "\"%s", count ? ">\n" : "/>\n");
    if (!count) return;
    fprintf(file, "    <failure message=\"%d deviations from the baseline\">", count);
    for (int i = 0; i < count; i++) {
        write_escaped(file, deviations[i].row->metric);
        fprintf(file, ": %.9g, was %.9g within %.3g, status %s, was ", deviations[i].value, deviations[i].row->value,
                deviations[i].allowed, deviations[i].status);
        write_escaped(file, deviations[i].row->status);
        fprintf(file, "\n");
    }
    write_escaped(file, row->reason);
    fprintf(file, "</failure>\n  </testcase>\n");
}

ck_Status ck_check_write_junit(const char *directory, const ck_Check *check, const ck_JournalRow *rows,
                               const ck_Baseline *baseline, ck_Error *error) {
    ck_Deviation *deviations = calloc((size_t)baseline->count + 1, sizeof *deviations);
    ck_WholeFile whole = {0};
    ck_Status status = deviations ? ck_whole_file_open(&whole, directory, "check.xml", error)
                                  : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (status) {
        ck_whole_file_discard(&whole);
        free(deviations);
        return status;
    }
    FILE *file = whole.file;
    int failed = 0;
    for (int i = 0; i < check->case_count; i++)
        failed += ck_check_compare(check, i, &rows[i], baseline, deviations) > 0;
    fprintf(
        file,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"clothcheck\" tests=\"%d\" failures=\"%d\">\n",
        check->case_count, failed);
    for (int i = 0; i < check->case_count; i++) {
        int count = ck_check_compare(check, i, &rows[i], baseline, deviations);
        write_case(file, &check->cases[i], &rows[i], deviations, count);
    }
    fprintf(file, "</testsuite>\n");
    free(deviations);
    return ck_whole_file_close(&whole, error);
}
