// Charts of the studies' CSVs.
#include "chart.h"

#include <math.h>
#include <string.h>

// An engine that is further off than that, in sizes of the body, has blown up: it would flatten the picture.
#define MOST_ERROR 10
#define LEAST_EXCESS 1e-4
#define MOST_EXCESS 1e4

// What has a place on a logarithmic axis.
static bool is_drawn(double value) {
    return value > 0 && isfinite(value);
}

// Of positions on a scene; NaN: not known.
static double uncertainty_of(const ck_ReportData *data, const char *scene) {
    for (int i = 0; i < data->summary_count; i++)
        if (!strcmp(data->summary[i].scene, scene) && !strcmp(data->summary[i].metric, "position_rms"))
            return data->summary[i].uncertainty;
    return NAN;
}

// True where no other row of the same engine is both cheaper and nearer to the truth.
static bool is_on_own_front(const ck_CsvTable *table, int row) {
    for (int other = 0; other < table->row_count; other++)
        if (ck_report_is_of(table, other, ck_csv_text_of(table, row, "scene")) &&
            !strcmp(ck_csv_text_of(table, other, "engine"), ck_csv_text_of(table, row, "engine")) &&
            ck_csv_number_of(table, other, "cpu_s") < ck_csv_number_of(table, row, "cpu_s") &&
            ck_csv_number_of(table, other, "error") <= ck_csv_number_of(table, row, "error"))
            return false;
    return true;
}

int ck_chart_select_precision(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_PRECISION);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double error = ck_csv_number_of(table, row, "error"), cost = ck_csv_number_of(table, row, "cpu_s");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(error) || error > MOST_ERROR || !is_drawn(cost)) continue;
        fprintf(out, "%s,%.9g,%.9g,%d,%d,%.9g,%.9g\n", ck_csv_text_of(table, row, "engine"), cost, error,
                is_on_own_front(table, row), ck_csv_number_of(table, row, "on_front") > 0, uncertainty_of(data, scene),
                ck_csv_number_of(table, row, "rounding"));
        rows++;
    }
    return rows;
}

static bool varies_iterations(const ck_CsvTable *table, int row) {
    for (int other = 0; other < table->row_count; other++)
        if (ck_report_is_of(table, other, ck_csv_text_of(table, row, "scene")) &&
            !strcmp(ck_csv_text_of(table, other, "engine"), ck_csv_text_of(table, row, "engine")) &&
            ck_csv_number_of(table, other, "iterations") != ck_csv_number_of(table, row, "iterations"))
            return true;
    return false;
}

int ck_chart_select_iterations(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_PRECISION);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double error = ck_csv_number_of(table, row, "error"), cost = ck_csv_number_of(table, row, "cpu_s");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(error) || error > MOST_ERROR || !is_drawn(cost)) continue;
        if (!varies_iterations(table, row)) continue;
        fprintf(out, "%s,%g,%.9g,%.9g\n", ck_csv_text_of(table, row, "engine"),
                ck_csv_number_of(table, row, "iterations"), cost, error);
        rows++;
    }
    return rows;
}

// Cells of the map and the critical steps that were found; a method's limit stands in every cell.
int ck_chart_select_stability(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_STABILITY);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        bool is_cell = !strcmp(ck_csv_text_of(table, row, "case"), "map");
        double step = ck_csv_number_of(table, row, is_cell ? "time_step_s" : "critical_step_s");
        const char *status = ck_csv_text_of(table, row, "status");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(step) ||
            !is_drawn(ck_csv_number_of(table, row, "stiffness_factor")) ||
            strcmp(ck_csv_text_of(table, row, "damping"), "scene"))
            continue;
        if (!strcmp(status, "unsupported") || !strcmp(status, "refused")) continue;
        fprintf(out, "%s,%.9g,%.9g,%s,%.9g,%g,%.9g\n", ck_csv_text_of(table, row, "engine"), step,
                ck_csv_number_of(table, row, "stiffness_factor"), is_cell ? status : "critical",
                ck_csv_number_of(table, row, "predicted_step_s"), ck_csv_number_of(table, row, "iterations"),
                ck_csv_number_of(table, row, "rounding_step_s"));
        rows++;
    }
    return rows;
}

// What leaving a term out changes, in units of the tolerance; what is beyond the axis, at its ends.
int ck_chart_select_needs(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_NEEDS);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double excess = fabs(ck_csv_number_of(table, row, "change")) / ck_csv_number_of(table, row, "tolerance");
        if (!ck_report_is_of(table, row, scene) || isnan(excess)) continue;
        fprintf(out, "\"%s\",%s,%.9g\n", ck_csv_text_of(table, row, "left_out"), ck_csv_text_of(table, row, "metric"),
                fmax(LEAST_EXCESS, fmin(MOST_EXCESS, excess)));
        rows++;
    }
    return rows;
}

// Metrics of shape at each resolution.
int ck_chart_select_refine(const ck_ReportData *data, const char *scene, FILE *out) {
    static const char *const drawn[] = {"sag", "stretch_max", "stretch_rms"};
    const ck_CsvTable *table = ck_report_table(data, CK_REFINE);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        bool is_shown = false;
        for (size_t i = 0; i < sizeof drawn / sizeof *drawn; i++)
            is_shown |= !strcmp(ck_csv_text_of(table, row, "metric"), drawn[i]);
        const double spacing = ck_csv_number_of(table, row, "spacing_m"), value = ck_csv_number_of(table, row, "value");
        if (!ck_report_is_of(table, row, scene) || !is_shown || !is_drawn(spacing) || !isfinite(value)) continue;
        if (strcmp(ck_csv_text_of(table, row, "status"), "ok")) continue;
        fprintf(out, "%s,%.9g,%.9g,%s\n", ck_csv_text_of(table, row, "engine"), spacing, value,
                ck_csv_text_of(table, row, "metric"));
        rows++;
    }
    return rows;
}

int ck_chart_select_size(const ck_ReportData *data, const char *scene, FILE *out) {
    (void)scene;
    const ck_CsvTable *table = ck_report_table(data, CK_BENCH);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        const char *metric = ck_csv_text_of(table, row, "metric");
        bool is_growth = !strcmp(metric, "growth_step_time");
        bool is_cost = !strcmp(metric, "second_time") && !strcmp(ck_csv_text_of(table, row, "setup"), "automatic");
        double value = ck_csv_number_of(table, row, "value");
        if (strcmp(ck_csv_text_of(table, row, "body"), "cloth") || !is_drawn(value) || !(is_growth || is_cost))
            continue;
        if (!is_drawn(ck_csv_number_of(table, row, "particles"))) continue;
        fprintf(out, "%s,%g,%.9g,%s\n", ck_csv_text_of(table, row, "engine"), ck_csv_number_of(table, row, "particles"),
                value, metric);
        rows++;
    }
    return rows;
}
