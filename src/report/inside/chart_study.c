// Charts of the studies' CSVs.
#include "chart.h"

#include <math.h>
#include <string.h>

// An engine that is further off than that, in sizes of the body, has blown up: it would flatten the picture.
#define MOST_ERROR 10
#define LEAST_EXCESS 1e-4
#define MOST_EXCESS 1e4

static double number(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_number(table, row, ck_layout_column(table->layout, column));
}

static const char *text(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_text(table, row, ck_layout_column(table->layout, column));
}

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
        if (ck_report_is_of(table, other, text(table, row, "scene")) &&
            !strcmp(text(table, other, "engine"), text(table, row, "engine")) &&
            number(table, other, "cpu_s") < number(table, row, "cpu_s") &&
            number(table, other, "error") <= number(table, row, "error"))
            return false;
    return true;
}

int ck_chart_select_precision(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_PRECISION);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double error = number(table, row, "error"), cost = number(table, row, "cpu_s");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(error) || error > MOST_ERROR || !is_drawn(cost)) continue;
        fprintf(out, "%s,%.9g,%.9g,%d,%d,%.9g\n", text(table, row, "engine"), cost, error, is_on_own_front(table, row),
                number(table, row, "on_front") > 0, uncertainty_of(data, scene));
        rows++;
    }
    return rows;
}

static bool varies_iterations(const ck_CsvTable *table, int row) {
    for (int other = 0; other < table->row_count; other++)
        if (ck_report_is_of(table, other, text(table, row, "scene")) &&
            !strcmp(text(table, other, "engine"), text(table, row, "engine")) &&
            number(table, other, "iterations") != number(table, row, "iterations"))
            return true;
    return false;
}

int ck_chart_select_iterations(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_PRECISION);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double error = number(table, row, "error"), cost = number(table, row, "cpu_s");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(error) || error > MOST_ERROR || !is_drawn(cost)) continue;
        if (!varies_iterations(table, row)) continue;
        fprintf(out, "%s,%g,%.9g,%.9g\n", text(table, row, "engine"), number(table, row, "iterations"), cost, error);
        rows++;
    }
    return rows;
}

// Cells of the map and the critical steps that were found; a method's limit stands in every cell.
int ck_chart_select_stability(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_STABILITY);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        bool is_cell = !strcmp(text(table, row, "case"), "map");
        double step = number(table, row, is_cell ? "time_step_s" : "critical_step_s");
        const char *status = text(table, row, "status");
        if (!ck_report_is_of(table, row, scene) || !is_drawn(step) ||
            !is_drawn(number(table, row, "stiffness_factor")) || strcmp(text(table, row, "damping"), "scene"))
            continue;
        if (!strcmp(status, "unsupported") || !strcmp(status, "refused")) continue;
        fprintf(out, "%s,%.9g,%.9g,%s,%.9g,%g\n", text(table, row, "engine"), step,
                number(table, row, "stiffness_factor"), is_cell ? status : "critical",
                number(table, row, "predicted_step_s"), number(table, row, "iterations"));
        rows++;
    }
    return rows;
}

// What leaving a term out changes, in units of the tolerance; what is beyond the axis, at its ends.
int ck_chart_select_needs(const ck_ReportData *data, const char *scene, FILE *out) {
    const ck_CsvTable *table = ck_report_table(data, CK_NEEDS);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        double excess = fabs(number(table, row, "change")) / number(table, row, "tolerance");
        if (!ck_report_is_of(table, row, scene) || isnan(excess)) continue;
        fprintf(out, "\"%s\",%s,%.9g\n", text(table, row, "left_out"), text(table, row, "metric"),
                fmax(LEAST_EXCESS, fmin(MOST_EXCESS, excess)));
        rows++;
    }
    return rows;
}

int ck_chart_select_size(const ck_ReportData *data, const char *scene, FILE *out) {
    (void)scene;
    const ck_CsvTable *table = ck_report_table(data, CK_BENCH);
    int rows = 0;
    for (int row = 0; table && row < table->row_count; row++) {
        const char *metric = text(table, row, "metric");
        bool is_growth = !strcmp(metric, "growth_step_time");
        bool is_cost = !strcmp(metric, "second_time") && !strcmp(text(table, row, "setup"), "automatic");
        double value = number(table, row, "value");
        if (strcmp(text(table, row, "body"), "cloth") || !is_drawn(value) || !(is_growth || is_cost)) continue;
        if (!is_drawn(number(table, row, "particles"))) continue;
        fprintf(out, "%s,%g,%.9g,%s\n", text(table, row, "engine"), number(table, row, "particles"), value, metric);
        rows++;
    }
    return rows;
}
