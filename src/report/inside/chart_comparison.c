// Charts of a comparison's CSVs.
#include "chart.h"

#include <math.h>
#include <string.h>

// An error that is nothing has its place at the foot of a logarithmic axis.
#define LEAST_ERROR 1e-16
#define MOST_TIMES 240
#define MARKS 8 // on each line over time

// What moves nothing is of no interest beside what the others do.
static bool is_shown(const char *engine) {
    return strcmp(engine, "still") != 0;
}

static double on_axis(double error) {
    return fmax(error, LEAST_ERROR);
}

// 0 within 0.1 %, 1 within 1 %, 2 within 10 %, 3 beyond or no better than moving nothing, 4 no error known, 5 failed, 6
// not to be had.
static int class_of(const ck_Summary *one) {
    if (!strcmp(one->status, "unsupported") || !strcmp(one->status, "refused")) return 6;
    if (strcmp(one->status, "ok")) return 5;
    if (isnan(one->told) || !is_shown(one->engine)) return 4;
    if (!one->is_better) return 3;
    return one->told <= 1e-3 ? 0 : one->told <= 1e-2 ? 1 : one->told <= 1e-1 ? 2 : 3;
}

static bool is_cheapest(const ck_ReportData *data, const ck_Summary *one) {
    for (int i = 0; i < data->summary_count; i++) {
        const ck_Summary *other = &data->summary[i];
        if (!strcmp(other->scene, one->scene) && !strcmp(other->machine, one->machine) && class_of(other) <= 1 &&
            other->cost < one->cost)
            return false;
    }
    return class_of(one) <= 1 && one->cost > 0;
}

int ck_chart_select_summary(const ck_ReportData *data, const char *scene, FILE *out) {
    (void)scene;
    for (int i = 0; i < data->summary_count; i++) {
        const ck_Summary *one = &data->summary[i];
        fprintf(out, "%s,%s,%s,%s,%.9g,%.9g,%.9g,%.9g,%.9g,%d,%d,%d,%d,\"%s\"\n", one->scene, one->engine, one->status,
                one->metric, one->error, one->uncertainty, 1e3 * one->cost, one->timed, one->duration, class_of(one),
                is_cheapest(data, one), one->on_front, one->is_better, one->machine);
    }
    return data->summary_count;
}

// What moving nothing is off by; NaN: not known.
static double still_error(const ck_ReportData *data, const char *scene) {
    for (int i = 0; i < data->summary_count; i++)
        if (!strcmp(data->summary[i].scene, scene) && !is_shown(data->summary[i].engine)) return data->summary[i].error;
    return NAN;
}

static int count_timed(const ck_ReportData *data, const char *scene, const char *machine) {
    int count = 0;
    for (int i = 0; i < data->summary_count; i++)
        count += !strcmp(data->summary[i].scene, scene) && !strcmp(data->summary[i].machine, machine) &&
                 data->summary[i].cost > 0;
    return count;
}

// The machine that timed most engines on a scene: costs of another have no place beside its own.
static const char *machine_of(const ck_ReportData *data, const char *scene) {
    const char *machine = "";
    for (int i = 0, most = 0; i < data->summary_count; i++) {
        if (strcmp(data->summary[i].scene, scene)) continue;
        const int count = count_timed(data, scene, data->summary[i].machine);
        if (count > most) machine = data->summary[i].machine;
        if (count > most) most = count;
    }
    return machine;
}

int ck_chart_select_cost(const ck_ReportData *data, const char *scene, FILE *out) {
    int rows = 0;
    const char *machine = machine_of(data, scene);
    for (int i = 0; i < data->summary_count; i++) {
        const ck_Summary *one = &data->summary[i];
        if (strcmp(one->machine, machine)) continue;
        if (strcmp(one->scene, scene) || !is_shown(one->engine) || !isfinite(one->error) || !(one->cost > 0)) continue;
        fprintf(out, "%s,%.9g,%.9g,%.9g,%d,%s,%s,%.9g\n", one->engine, 1e3 * one->cost, on_axis(one->error),
                one->uncertainty, one->on_front, one->metric, one->status, still_error(data, scene));
        rows++;
    }
    return rows;
}

int ck_chart_select_errors(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *metrics = ck_report_table(data, CK_METRICS);
    int rows = 0;
    for (int row = 0; metrics && row < metrics->row_count; row++) {
        const char *metric = ck_csv_table_text(metrics, row, 2);
        double error = ck_csv_number_of(metrics, row, "error");
        if (!ck_report_is_of(metrics, row, scene) || !is_shown(ck_csv_table_text(metrics, row, 1)) ||
            !ck_report_shows(metric) || !isfinite(error))
            continue;
        double uncertainty = ck_csv_number_of(metrics, row, "truth_uncertainty");
        fprintf(out, "%s,%s,%.9g,%.9g\n", ck_csv_table_text(metrics, row, 1), metric, on_axis(error), uncertainty);
        rows++;
    }
    return rows;
}

// The distance of paths, both ways round: a matrix.
int ck_chart_select_deviations(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_DEVIATIONS);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        if (!ck_report_is_of(table, row, scene) || strcmp(ck_csv_table_text(table, row, 1), "position_rms")) continue;
        const char *one = ck_csv_table_text(table, row, 2), *other = ck_csv_table_text(table, row, 3);
        double deviation = ck_csv_number_of(table, row, "deviation");
        if (!is_shown(one) || !is_shown(other) || !isfinite(deviation)) continue;
        fprintf(out, "%s,%s,%.9g\n%s,%s,%.9g\n", one, other, deviation, other, one, deviation);
        rows += 2;
    }
    return rows;
}

// One engine's run of rows, thinned: of long series every k-th frame, for a chart has no more dots. Every so often one
// is marked, each engine's elsewhere, so that lines on each other are told apart.
static int write_series(const ck_ReportData *data, const ck_CsvTable *table, int first, int end, FILE *out) {
    const char *engine = ck_csv_table_text(table, first, 1);
    int stride = (end - first + MOST_TIMES - 1) / MOST_TIMES, rows = 0;
    int between = (end - first) / stride / MARKS + 1, offset = ck_report_engine(data, engine) * between / 12;
    for (int i = first; i < end && is_shown(engine); i++) {
        double time = ck_csv_table_number(table, i, 2), value = ck_csv_table_number(table, i, 4);
        if (((i - first) % stride && i != end - 1) || !isfinite(time) || !isfinite(value)) continue;
        fprintf(out, "%s,%.9g,%.9g,%d\n", engine, time, value, (i - first) / stride % between == offset % between);
        rows++;
    }
    return rows;
}

static int select_series(const ck_ReportData *data, const char *scene, const char *metric, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_SERIES);
    int rows = 0;
    for (int row = 0; table && row < table->row_count;) {
        const char *engine = ck_csv_table_text(table, row, 1);
        int end = row;
        while (end < table->row_count && ck_report_is_of(table, end, scene) &&
               !strcmp(ck_csv_table_text(table, end, 3), metric) && !strcmp(ck_csv_table_text(table, end, 1), engine))
            end++;
        if (end > row) rows += write_series(data, table, row, end, out);
        row = end > row ? end : row + 1;
    }
    return rows;
}

int ck_chart_select_sag(const ck_ReportData *data, const char *scene, FILE *out) {
    return select_series(data, scene, "sag", out);
}

int ck_chart_select_energy(const ck_ReportData *data, const char *scene, FILE *out) {
    return select_series(data, scene, "energy", out);
}

int ck_chart_select_height(const ck_ReportData *data, const char *scene, FILE *out) {
    return select_series(data, scene, "rest_height", out);
}
