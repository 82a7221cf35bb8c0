// The charts of a study: a metric against a swept key.
#include "chart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// Panels of one picture; those of further charts and scenes are left to the CSVs.
#define MOST_PANELS 4
// An engine that is further off, in sizes of the body, has blown up: it would flatten the picture.
#define MOST_ERROR 10
// What an error of nothing is drawn at on a logarithmic axis.
#define LEAST_ERROR 1e-16

// A row of a chart: one engine at one point.
typedef struct Point {
    int panel, engine, row;
    double x, y;
} Point;

typedef struct Sweep {
    const ck_ReportData *data;
    const ck_CsvTable *metrics, *charts;
    int of_scene; // column
    Point *points;
    int count;
    const char *scenes[MOST_PANELS]; // of each panel
    int chart_of[MOST_PANELS];       // row of study_charts.csv
    int panel_count;
} Sweep;

static double number_at(const ck_CsvTable *table, int row, int column) {
    char *end;
    const char *text = ck_csv_table_text(table, row, column);
    const double number = strtod(text, &end);
    return *text && !*end ? number : NAN;
}

// The panel of a chart and a scene; −1: there is no room for it.
static int find_panel(Sweep *sweep, int chart, const char *scene) {
    for (int i = 0; i < sweep->panel_count; i++)
        if (sweep->chart_of[i] == chart && !strcmp(sweep->scenes[i], scene)) return i;
    if (sweep->panel_count == MOST_PANELS) return -1;
    sweep->scenes[sweep->panel_count] = scene;
    sweep->chart_of[sweep->panel_count] = chart;
    return sweep->panel_count++;
}

static void gather(Sweep *sweep, int chart) {
    const ck_CsvTable *metrics = sweep->metrics;
    const char *metric = ck_csv_text_of(sweep->charts, chart, "metric"),
               *of = ck_csv_text_of(sweep->charts, chart, "of");
    const int key = ck_csv_table_extra(metrics, ck_csv_text_of(sweep->charts, chart, "x"));
    const bool is_error = !strcmp(of, "error");
    for (int row = 0; row < metrics->row_count && key >= 0; row++) {
        if (strcmp(ck_csv_text_of(metrics, row, "metric"), metric)) continue;
        const char *engine = ck_csv_text_of(metrics, row, "engine");
        const double x = number_at(metrics, row, key), y = ck_csv_number_of(metrics, row, is_error ? "error" : "value");
        if (!isfinite(x) || !isfinite(y) || !strcmp(engine, "still") || (is_error && y > MOST_ERROR)) continue;
        const int panel = find_panel(sweep, chart, ck_csv_table_text(metrics, row, sweep->of_scene));
        if (panel < 0) continue;
        sweep->points[sweep->count++] =
            (Point){panel, ck_report_engine(sweep->data, engine), row, x, is_error ? fmax(y, LEAST_ERROR) : y};
    }
}

// The order of two rows in all swept keys but the chart's own: a line of its own for each.
static int compare_lines(const Sweep *sweep, const Point *one, const Point *other) {
    const int key = ck_csv_table_extra(sweep->metrics, ck_csv_text_of(sweep->charts, sweep->chart_of[one->panel], "x"));
    int order = 0;
    for (int i = sweep->of_scene + 1; i < sweep->metrics->width && !order; i++)
        if (i != key)
            order = strcmp(ck_csv_table_text(sweep->metrics, one->row, i),
                           ck_csv_table_text(sweep->metrics, other->row, i));
    return order;
}

static int compare_points(const void *a, const void *b, void *context) {
    const Point *one = a, *other = b;
    if (one->panel != other->panel) return one->panel - other->panel;
    if (one->engine != other->engine) return one->engine - other->engine;
    const int line = compare_lines(context, one, other);
    return line ? line : (one->x > other->x) - (one->x < other->x);
}

static bool is_next_line(const Sweep *sweep, int index) {
    const Point *one = &sweep->points[index - 1], *other = &sweep->points[index];
    return one->panel != other->panel || one->engine != other->engine || compare_lines(sweep, one, other);
}

int ck_chart_select_sweep(const ck_ReportData *data, const char *scene, FILE *out) {
    (void)scene;
    Sweep sweep = {
        .data = data, .metrics = ck_report_table(data, CK_METRICS), .charts = ck_report_table(data, CK_STUDY_CHARTS)};
    if (!sweep.metrics || !sweep.charts) return 0;
    sweep.of_scene = ck_csv_table_extra(sweep.metrics, "of_scene");
    if (sweep.of_scene < 0) return 0;
    sweep.points =
        malloc(sizeof *sweep.points * ((size_t)sweep.metrics->row_count * (size_t)sweep.charts->row_count + 1));
    for (int i = 0; i < sweep.charts->row_count && sweep.points; i++) gather(&sweep, i);
    if (sweep.count) qsort_r(sweep.points, (size_t)sweep.count, sizeof *sweep.points, compare_points, &sweep);
    for (int i = 0; i < sweep.count; i++) {
        const Point *point = &sweep.points[i];
        const int chart = sweep.chart_of[point->panel];
        // lines are told apart by an empty one
        if (i && is_next_line(&sweep, i)) fputc('\n', out);
        fprintf(out, "%s,%.9g,%.9g,%d,%s,%s,%s,%s\n", data->engines[point->engine], point->x, point->y, point->panel,
                ck_csv_text_of(sweep.charts, chart, "x"), ck_csv_text_of(sweep.charts, chart, "metric"),
                ck_csv_text_of(sweep.charts, chart, "of"), sweep.scenes[point->panel]);
    }
    free(sweep.points);
    return sweep.count;
}
