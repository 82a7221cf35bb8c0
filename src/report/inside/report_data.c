#include "report_data.h"

#include "engines.h"
#include "files.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LONGEST_NAME 100

// Metrics whose errors are shown: of what a run ends in, not of what is only ever small. A scene's error is that of the
// answer that most engines have an error of, the first where several do: energy, jitter, penetration, or that a ball
// carries a weight are conditions, and no answers.
static const struct {
    const char *metric;
    bool is_answer;
} shown[] = {
    {"position_rms", true},     {"sag", true},
    {"friction", true},         {"restitution", true},
    {"rest_height", true},      {"wrap_friction", true},
    {"stretch_max", false},     {"stretch_rms", false},
    {"sag_path", false},        {"energy_path", false},
    {"period", false},          {"tunnelled", false},
    {"penetration_max", false}, {"contact_force", false},
};
#define SHOWN ((int)(sizeof shown / sizeof *shown))

bool ck_report_shows(const char *metric) {
    for (int i = 0; i < SHOWN; i++)
        if (!strcmp(shown[i].metric, metric)) return true;
    return false;
}

const ck_CsvTable *ck_report_table(const ck_ReportData *data, ck_LayoutName name) {
    return data->tables[name].layout ? &data->tables[name] : NULL;
}

bool ck_report_is_of(const ck_CsvTable *table, int row, const char *scene) {
    return !strcmp(ck_csv_table_text(table, row, 0), scene);
}

int ck_report_engine(const ck_ReportData *data, const char *engine) {
    int index = 0;
    while (index < data->engine_count && strcmp(data->engines[index], engine)) index++;
    return index;
}

// Adds a name that is not among them. Errors: CK_NO_MEMORY.
static ck_Status add_name(const char ***names, int *count, const char *name, ck_Error *error) {
    for (int i = *count - 1; i >= 0; i--)
        if (!strcmp((*names)[i], name)) return CK_OK;
    const char **more = realloc(*names, sizeof *more * (size_t)(*count + 1));
    if (!more) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *names = more;
    more[(*count)++] = name;
    return CK_OK;
}

// Scenes and engines are parts of file names and of charts.
static bool is_plain(const char *name) {
    for (const char *letter = name; *letter; letter++)
        if (!isalnum((unsigned char)*letter) && !strchr("_-.", *letter)) return false;
    return *name != '.' && strlen(name) <= LONGEST_NAME;
}

static ck_Status add_column(ck_ReportData *data, const ck_CsvTable *table, const char *column_name, const char ***names,
                            int *count, ck_Error *error) {
    int column = 0;
    while (column < table->column_count && strcmp(table->layout->columns[column].name, column_name)) column++;
    if (column == table->column_count) return CK_OK;
    ck_Status status = CK_OK;
    for (int row = 0; row < table->row_count && !status; row++) {
        const char *name = ck_csv_table_text(table, row, column);
        // more are not shown one by one
        if (!column && table->width > table->column_count && *count > CK_REPORT_MOST_POINTS) break;
        if (row && !strcmp(name, ck_csv_table_text(table, row - 1, column))) continue;
        bool is_truth = !strcmp(column_name, "engine") && !strcmp(name, "truth");
        if (!*name || is_truth) continue;
        if (!is_plain(name))
            return ck_fail(error, CK_BAD_INPUT,
                           "%s/%s: row %d, column %d (%s): '%.60s' must be of at most 100 letters, digits, _, - and .",
                           data->directory, table->layout->file, row + 1, column + 1, column_name, name);
        status = add_name(names, count, name, error);
    }
    return status;
}

static ck_Status read_tables(ck_ReportData *data, ck_Error *error) {
    ck_Status status = CK_OK;
    int found = 0;
    if (access(data->directory, R_OK | X_OK))
        return ck_fail(error, ck_file_status(errno), "%s: %s", data->directory, strerror(errno));
    for (int i = 0; i < CK_REPORT_LAYOUTS && !status; i++) {
        char *path = ck_path_join(data->directory, ck_layouts[i].file);
        if (!path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
        bool is_there = access(path, F_OK) == 0;
        free(path);
        if (!is_there) continue;
        status = ck_csv_table_read(&data->tables[i], data->directory, &ck_layouts[i], error);
        found += i != CK_MACHINE;
    }
    if (!status && !found)
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: holds no CSV of a comparison or study, as %s; 'clothcheck compare --out %s' writes them",
                         data->directory, ck_layouts[CK_RUNS].file, data->directory);
    return status;
}

static ck_Status find_names(ck_ReportData *data, ck_Error *error) {
    ck_Status status = CK_OK;
    for (int i = 0; i < ck_engine_count() && !status; i++)
        status = add_name(&data->engines, &data->engine_count, ck_engine_at(i)->name, error);
    for (int i = 0; i < CK_REPORT_LAYOUTS && !status; i++) {
        const ck_CsvTable *table = ck_report_table(data, i);
        if (!table) continue;
        status = add_column(data, table, "scene", &data->scenes, &data->scene_count, error);
        if (!status) status = add_column(data, table, "engine", &data->engines, &data->engine_count, error);
    }
    return status;
}

static bool has_error(const ck_CsvTable *metrics, int row, const char *scene, const char *metric) {
    return ck_report_is_of(metrics, row, scene) && !strcmp(ck_csv_table_text(metrics, row, 2), metric) &&
           !isnan(ck_csv_number_of(metrics, row, "error"));
}

// The metric that stands for a scene's error; NULL: nothing has a truth.
static const char *answer_of(const ck_CsvTable *metrics, const char *scene) {
    const char *answer = NULL;
    for (int i = 0, most = 0; i < SHOWN; i++) {
        int count = 0;
        for (int row = 0; row < metrics->row_count && shown[i].is_answer; row++)
            count += has_error(metrics, row, scene, shown[i].metric);
        if (count > most) answer = shown[i].metric;
        if (count > most) most = count;
    }
    return answer;
}

// Its row of an engine; -1: none.
static int find_answer(const ck_CsvTable *metrics, const char *scene, const char *engine) {
    const char *answer = answer_of(metrics, scene);
    for (int row = 0; row < metrics->row_count && answer; row++)
        if (has_error(metrics, row, scene, answer) && !strcmp(ck_csv_table_text(metrics, row, 1), engine)) return row;
    return -1;
}

const char *ck_report_machine(const ck_ReportData *data, const ck_CsvTable *runs, int row) {
    const ck_CsvTable *study = ck_report_table(data, CK_STUDY);
    const int column = ck_csv_table_extra(runs, "host");
    const char *host = column < 0 ? "" : ck_csv_table_text(runs, row, column);
    for (int i = 0; study && i < study->row_count && *host; i++)
        if (!strcmp(ck_csv_text_of(study, i, "host"), host)) return ck_csv_text_of(study, i, "processor");
    return host;
}

static ck_Summary sum_up(const ck_ReportData *data, const ck_CsvTable *runs, int row) {
    const ck_CsvTable *metrics = ck_report_table(data, CK_METRICS);
    ck_Summary one = {
        .scene = ck_csv_table_text(runs, row, 0),
        .engine = ck_csv_table_text(runs, row, 1),
        .status = ck_csv_text_of(runs, row, "status"),
        .machine = ck_report_machine(data, runs, row),
        .metric = "",
        .error = NAN,
        .uncertainty = NAN,
        .told = NAN,
        .timed = ck_csv_number_of(runs, row, "simulated_s"),
        .cost = ck_csv_number_of(runs, row, "cpu_median_s") / ck_csv_number_of(runs, row, "simulated_s"),
    };
    int answer = metrics ? find_answer(metrics, one.scene, one.engine) : -1;
    if (answer < 0) return one;
    one.metric = ck_csv_table_text(metrics, answer, 2);
    one.error = ck_csv_number_of(metrics, answer, "error");
    one.uncertainty = ck_csv_number_of(metrics, answer, "truth_uncertainty");
    one.told = one.uncertainty > one.error ? one.uncertainty : one.error;
    return one;
}

// It moves nothing: it shows what the harness costs, and what an error is worth.
static bool is_still(const ck_Summary *one) {
    return !strcmp(one->engine, "still");
}

bool ck_summary_counts(const ck_Summary *one) {
    return !is_still(one) && one->is_better && !strcmp(one->status, "ok") && !isnan(one->told) && one->cost > 0;
}

// An error that is not half of what moving nothing has answers nothing, unless nothing is what should move.
static void set_beside(const ck_ReportData *data, ck_Summary *one) {
    one->duration = one->timed;
    one->is_better = true;
    for (int i = 0; i < data->summary_count; i++) {
        const ck_Summary *other = &data->summary[i];
        if (strcmp(other->scene, one->scene)) continue;
        one->duration = fmax(one->duration, other->timed);
        bool tells = is_still(other) && other->error > 1e-9 && !(other->error <= other->uncertainty);
        if (tells && one->error > 0.5 * other->error) one->is_better = is_still(one);
    }
}

// Errors within a twentieth of each other are alike: at the floor of a truth they differ by rounding.
static bool is_beaten(const ck_ReportData *data, const ck_Summary *one) {
    for (int i = 0; i < data->summary_count; i++) {
        const ck_Summary *other = &data->summary[i];
        if (other != one && ck_summary_counts(other) && !strcmp(other->scene, one->scene) &&
            !strcmp(other->machine, one->machine) && other->cost < one->cost && other->told <= 1.05 * one->told)
            return true;
    }
    return false;
}

static ck_Status check_runs(const ck_ReportData *data, ck_Error *error) {
    for (int i = 0; i < data->summary_count; i++)
        for (int j = 0; j < i; j++)
            if (!strcmp(data->summary[i].engine, data->summary[j].engine) &&
                !strcmp(data->summary[i].scene, data->summary[j].scene))
                return ck_fail(error, CK_BAD_INPUT, "%s/%s: rows %d and %d are both of %s on %s; keep one of them",
                               data->directory, ck_layouts[CK_RUNS].file, j + 1, i + 1, data->summary[i].engine,
                               data->summary[i].scene);
    return CK_OK;
}

static ck_Status find_summary(ck_ReportData *data, ck_Error *error) {
    const ck_CsvTable *runs = ck_report_table(data, CK_RUNS);
    if (!runs) return CK_OK;
    data->summary = calloc((size_t)runs->row_count + 1, sizeof *data->summary);
    if (!data->summary) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int row = 0; row < runs->row_count; row++) data->summary[data->summary_count++] = sum_up(data, runs, row);
    for (int i = 0; i < data->summary_count; i++) set_beside(data, &data->summary[i]);
    for (int i = 0; i < data->summary_count; i++)
        data->summary[i].on_front = ck_summary_counts(&data->summary[i]) && !is_beaten(data, &data->summary[i]);
    return check_runs(data, error);
}

ck_Status ck_report_data_read(ck_ReportData *data, const char *directory, ck_Error *error) {
    *data = (ck_ReportData){.directory = directory};
    ck_Status status = read_tables(data, error);
    if (!status) status = find_names(data, error);
    const ck_CsvTable *runs = ck_report_table(data, CK_RUNS);
    const bool is_study = runs && runs->width > runs->column_count;
    if (is_study && data->scene_count > CK_REPORT_MOST_POINTS) data->scene_count = 0;
    if (!status && data->scene_count) status = find_summary(data, error);
    return status;
}

void ck_report_data_free(ck_ReportData *data) {
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) ck_csv_table_free(&data->tables[i]);
    free(data->scenes);
    free(data->engines);
    free(data->summary);
    *data = (ck_ReportData){0};
}
