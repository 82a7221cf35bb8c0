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

// Swept keys that are looked at, and values of one.
#define MOST_KEYS 32
#define MOST_VALUES 256

// A row of a chart: one engine at one point.
typedef struct Point {
    int panel, engine, row;
    double x, y;
} Point;

// Where a chart's numbers are: the CSV, its column of names, and those of values; without names the metric is a column,
// of rows that filters let through where there are any.
typedef struct Source {
    ck_LayoutName layout;
    const char *names, *value, *error;
    const char *filters[2][2]; // columns, and what they must be
} Source;
static const Source sources[] = {{CK_METRICS, .names = "metric", .value = "value", .error = "error"},
                                 {CK_PRECISION_SUMMARY, .names = "quantity", .value = "value", .error = "value"},
                                 {CK_REFINE_SUMMARY, .names = "metric", .value = "limit", .error = "order"},
                                 {CK_TUNE, .filters = {{"role", "best"}}},
                                 {CK_STABILITY, .filters = {{"case", "critical"}, {"damping", "scene"}}},
                                 {CK_RUNS}};
#define SOURCES ((int)(sizeof sources / sizeof *sources))

// A chart that is drawn, of one scene.
typedef struct Panel {
    const char *scene, *x, *metric, *of;
    const Source *source;
    const ck_CsvTable *table;
    int key; // column of x
    bool is_cost;
    bool parts[MOST_KEYS]; // of the columns behind of_scene: rows that differ there are not of one line
} Panel;

typedef struct Sweep {
    const ck_ReportData *data;
    Panel panels[MOST_PANELS];
    int panel_count;
    Point *points;
    int count, capacity;
} Sweep;

static double number_at(const ck_CsvTable *table, int row, int column) {
    char *end;
    const char *text = ck_csv_table_text(table, row, column);
    const double number = strtod(text, &end);
    return *text && !*end ? number : NAN;
}

// Cost is a metric of its own: milliseconds of CPU per simulated second.
static bool is_own_cost(const Panel *panel) {
    return panel->source->layout == CK_RUNS && !strcmp(panel->metric, "cost");
}

static bool has_column(const ck_Layout *layout, const char *name) {
    for (int i = 0; i < ck_layout_column_count(layout); i++)
        if (!strcmp(layout->columns[i].name, name)) return layout->columns[i].kind == CK_COLUMN_NUMBER;
    return false;
}

// Which of the CSVs has a chart's metric.
static bool find_source(Panel *panel, const ck_ReportData *data) {
    for (int i = 0; i < SOURCES; i++) {
        const ck_CsvTable *table = ck_report_table(data, sources[i].layout);
        if (!table || (panel->key = ck_csv_table_extra(table, panel->x)) < 0) continue;
        panel->source = &sources[i];
        panel->table = table;
        panel->is_cost = !strncmp(panel->metric, "cost", 4) || !strncmp(panel->metric, "cpu", 3);
        bool has = !sources[i].names && (is_own_cost(panel) || has_column(table->layout, panel->metric));
        for (int row = 0; row < table->row_count && !has && sources[i].names; row++)
            has = !strcmp(ck_csv_text_of(table, row, sources[i].names), panel->metric);
        if (has) return true;
    }
    return false;
}

// True where a row is one of the chart's.
static bool is_of(const Panel *panel, int row) {
    const Source *source = panel->source;
    if (source->names) return !strcmp(ck_csv_text_of(panel->table, row, source->names), panel->metric);
    for (int i = 0; i < 2 && source->filters[i][0]; i++)
        if (strcmp(ck_csv_text_of(panel->table, row, source->filters[i][0]), source->filters[i][1])) return false;
    return true;
}

// True where a key goes with the chart's: each value of the one has one of the other.
static bool is_tied(const Panel *panel, int column) {
    const ck_CsvTable *table = panel->table;
    int rows[MOST_VALUES], count = 0;
    for (int row = 0; row < table->row_count; row++) {
        int k = 0;
        while (k < count &&
               strcmp(ck_csv_table_text(table, rows[k], panel->key), ck_csv_table_text(table, row, panel->key)))
            k++;
        if (k == MOST_VALUES) return false;
        if (k == count)
            rows[count++] = row;
        else if (strcmp(ck_csv_table_text(table, rows[k], column), ck_csv_table_text(table, row, column)))
            return false;
    }
    return true;
}

static void find_parting(Panel *panel) {
    const int first = ck_csv_table_extra(panel->table, "of_scene") + 1;
    for (int i = first; i < panel->table->width && i - first < MOST_KEYS; i++)
        panel->parts[i - first] = i != panel->key && !is_tied(panel, i);
}

// The panel of a scene, beside those of a chart that begin at first; −1: there is no room for it.
static int find_panel(Sweep *sweep, const Panel *of, int first, const char *scene) {
    for (int i = first; i < sweep->panel_count; i++)
        if (!strcmp(sweep->panels[i].scene, scene)) return i;
    if (sweep->panel_count == MOST_PANELS) return -1;
    sweep->panels[sweep->panel_count] = *of;
    sweep->panels[sweep->panel_count].scene = scene;
    return sweep->panel_count++;
}

static double value_at(const Panel *panel, int row) {
    const ck_CsvTable *table = panel->table;
    const bool is_error = !strcmp(panel->of, "error") && panel->source->layout == CK_METRICS;
    if (is_own_cost(panel))
        return 1e3 * ck_csv_number_of(table, row, "cpu_median_s") / ck_csv_number_of(table, row, "simulated_s");
    if (!panel->source->names) return ck_csv_number_of(table, row, panel->metric);
    const double value =
        ck_csv_number_of(table, row, !strcmp(panel->of, "error") ? panel->source->error : panel->source->value);
    if (!is_error) return value;
    return value > MOST_ERROR ? NAN : fmax(value, LEAST_ERROR);
}

static bool add_point(Sweep *sweep, const Point *point) {
    if (sweep->count == sweep->capacity) {
        const int more = sweep->capacity ? 2 * sweep->capacity : 1024;
        Point *grown = realloc(sweep->points, sizeof *grown * (size_t)more);
        if (!grown) return false;
        sweep->points = grown;
        sweep->capacity = more;
    }
    sweep->points[sweep->count++] = *point;
    return true;
}

static bool gather(Sweep *sweep, Panel *of) {
    const int first = sweep->panel_count;
    if (!find_source(of, sweep->data)) return true;
    find_parting(of);
    const ck_CsvTable *table = of->table;
    const int of_scene = ck_csv_table_extra(table, "of_scene");
    for (int row = 0; row < table->row_count; row++) {
        const char *engine = ck_csv_text_of(table, row, "engine");
        if (!is_of(of, row)) continue;
        const double x = number_at(table, row, of->key), y = value_at(of, row);
        if (!isfinite(x) || !isfinite(y) || !strcmp(engine, "still")) continue;
        const int panel = find_panel(sweep, of, first, ck_csv_table_text(table, row, of_scene));
        if (panel >= 0 && !add_point(sweep, &(Point){panel, ck_report_engine(sweep->data, engine), row, x, y}))
            return false;
    }
    return true;
}

// The order of two rows in all swept keys but the chart's own, and of costs in the machine: a line of its own for each.
static int compare_lines(const Sweep *sweep, const Point *one, const Point *other) {
    const Panel *panel = &sweep->panels[one->panel];
    const ck_CsvTable *table = panel->table;
    const int first = ck_csv_table_extra(table, "of_scene") + 1;
    int order = 0;
    for (int i = first; i < table->width && i - first < MOST_KEYS && !order; i++)
        if (panel->parts[i - first])
            order = strcmp(ck_csv_table_text(table, one->row, i), ck_csv_table_text(table, other->row, i));
    if (order || !panel->is_cost) return order;
    return strcmp(ck_report_machine(sweep->data, table, one->row), ck_report_machine(sweep->data, table, other->row));
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
    const ck_CsvTable *charts = ck_report_table(data, CK_STUDY_CHARTS);
    Sweep sweep = {.data = data};
    for (int i = 0; charts && i < charts->row_count; i++) {
        Panel panel = {.x = ck_csv_text_of(charts, i, "x"),
                       .metric = ck_csv_text_of(charts, i, "metric"),
                       .of = ck_csv_text_of(charts, i, "of")};
        if (!gather(&sweep, &panel)) break;
    }
    if (sweep.count) qsort_r(sweep.points, (size_t)sweep.count, sizeof *sweep.points, compare_points, &sweep);
    for (int i = 0; i < sweep.count; i++) {
        const Point *point = &sweep.points[i];
        const Panel *panel = &sweep.panels[point->panel];
        // lines are told apart by an empty one
        if (i && is_next_line(&sweep, i)) fputc('\n', out);
        fprintf(out, "%s,%.9g,%.9g,%d,%s,%s,%s,%s\n", data->engines[point->engine], point->x, point->y, point->panel,
                panel->x, panel->metric,
                panel->is_cost                        ? "cost"
                : panel->source->layout == CK_METRICS ? panel->of
                                                      : "value",
                panel->scene);
    }
    free(sweep.points);
    return sweep.count;
}
