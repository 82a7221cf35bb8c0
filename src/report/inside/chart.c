#include "chart.h"

#include "files.h"
#include "look.h"
#include "tool.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const ck_Chart charts[] = {
    {"summary", "Which engine for which scene: error, and the cheapest within 1 %",
     "scene,engine,status,metric,error,uncertainty,cpu_ms_per_s,timed_s,duration_s,class,is_cheapest,on_front,is_"
     "better,machine",
     1300, 900, true, true, ck_chart_select_summary},
    {"cost", "error against cost at automatic settings",
     "engine,cpu_ms_per_s,error,uncertainty,on_front,metric,status,still_error", 760, 470, false, false,
     ck_chart_select_cost},
    {"precision", "error against cost over time steps and iterations",
     "engine,cpu_s,error,on_own_front,on_front,uncertainty,rounding", 760, 520, false, false,
     ck_chart_select_precision},
    {"iterations", "iterations against substeps at equal cost", "engine,iterations,cpu_s,error", 980, 640, false, true,
     ck_chart_select_iterations},
    {"errors", "errors, and how well the truth is known", "engine,metric,error,uncertainty", 860, 470, false, false,
     ck_chart_select_errors},
    {"sag", "sag against time", "engine,time_s,value,is_marked", 760, 430, false, false, ck_chart_select_sag},
    {"energy", "energy against time", "engine,time_s,value,is_marked", 760, 430, false, false, ck_chart_select_energy},
    {"height", "height above the colliders against time", "engine,time_s,value,is_marked", 760, 430, false, false,
     ck_chart_select_height},
    {"deviations", "how far the engines are from each other", "engine,other_engine,deviation", 760, 640, false, true,
     ck_chart_select_deviations},
    {"stability", "where methods fail (of two rows the upper one has more iterations)",
     "engine,time_step_s,stiffness_factor,status,predicted_step_s,iterations,rounding_step_s", 1080, 1100, false, true,
     ck_chart_select_stability},
    {"needs", "what the scene needs", "left_out,metric,excess", 860, 430, false, false, ck_chart_select_needs},
    {"refine", "what converges as the mesh gets finer", "engine,spacing_m,value,metric", 1080, 430, false, true,
     ck_chart_select_refine},
    {"sweep", "The study", "engine,x,y,panel,key,metric,of,scene", 1080, 860, true, true, ck_chart_select_sweep},
    {"size", "Cost against size", "engine,particles,time_s,metric", 1080, 480, true, true, ck_chart_select_size},
};
#define CHARTS ((int)(sizeof charts / sizeof *charts))

int ck_chart_count(void) {
    return CHARTS;
}

const ck_Chart *ck_chart_at(int index) {
    return &charts[index];
}

void ck_chart_file(char *name, size_t size, const ck_Chart *chart, const char *scene) {
    if (chart->is_of_all)
        snprintf(name, size, "%s", chart->name);
    else
        snprintf(name, size, "%s.%s", scene, chart->name);
}

// As gnuplot reads it between single quotes.
static void write_quoted(FILE *file, const char *text) {
    for (const char *letter = text; *letter; letter++) fprintf(file, *letter == '\'' ? "''" : "%c", *letter);
}

static void write_looks(FILE *file, const ck_ReportData *data) {
    fprintf(file, "# The engines of this report, and how each looks in every chart.\nengines = '");
    for (int i = 0; i < data->engine_count; i++) fprintf(file, "%s ", data->engines[i]);
    fprintf(file, "truth'\nplace(name) = (sum [i = 1:words(engines)] (word(engines, i) eq name ? i : 0))\n");
    for (int i = 0; i < data->engine_count; i++) {
        ck_Look look = ck_chart_look(i);
        fprintf(file, "set linetype %d linecolor rgb '%s' pointtype %d dashtype %s linewidth 1.5\n", i + 1, look.color,
                look.mark, look.dash);
    }
    fprintf(file, "set linetype %d linecolor rgb '#000000' pointtype 0 dashtype '-' linewidth 3\n",
            data->engine_count + 1);
}

// Of gnuplot.
static const char screen_svg[] = "svg", screen_png[] = "pngcairo", paper_pdf[] = "pdfcairo";

#define POINTS_PER_CM (72 / 2.54)
#define COLUMN_GAP 0.8     // cm, between two columns of a paper
#define PAPER_LETTERS 0.46 // of 12 pt

// On paper a chart is as wide as a column, its letters legible and its key below; or, where it has many letters, as two
// columns, in the proportions of the screen.
static void write_paper(FILE *file, const ck_Chart *chart, double column) {
    const double width = chart->is_dense ? 2 * column + COLUMN_GAP : column,
                 shape = (double)chart->height / chart->width;
    const double scale = chart->is_dense ? width * POINTS_PER_CM / chart->width : PAPER_LETTERS;
    fprintf(file,
            "is_column = %d\nset terminal %s size %gcm,%gcm font 'sans,12' fontscale %g linewidth %g pointscale %g "
            "background rgb 'white'\n",
            !chart->is_dense, paper_pdf, width, width * (chart->is_dense ? shape : fmax(0.8, shape)), scale, scale,
            scale);
}

static void write_terminal(FILE *file, const ck_Chart *chart, const char *terminal, double paper_width) {
    if (terminal == paper_pdf)
        write_paper(file, chart, paper_width);
    else
        fprintf(file, "is_column = 0\nset terminal %s size %d,%d font 'sans,12' background rgb 'white'\n", terminal,
                chart->width, chart->height);
}

static void write_plot(FILE *file, const ck_Chart *chart, const char *scene, const char *terminal, const char *ending,
                       double paper_width) {
    char name[200];
    ck_chart_file(name, sizeof name, chart, scene);
    fprintf(file, "print 'chart %s'\nreset\nload 'looks.gp'\ndata = '%s.csv'\ntitle = '%s%s%s'\n", name, name,
            chart->is_of_all ? "" : scene, chart->is_of_all ? "" : ": ", chart->title);
    write_terminal(file, chart, terminal, paper_width);
    fprintf(file, "set output '%s.%s'\naxes = '%s%s'\nheight = %d.0\n", name, ending,
            terminal == screen_svg ? name : "", terminal == screen_svg ? ".axes" : "", chart->height);
    fprintf(file, "load sources.'/common.gp'\nload sources.'/%s.gp'\n", chart->name);
    fprintf(file, "if (!has_panels) { load sources.'/axes.gp' }\nunset output\n");
}

// Writes a chart's CSV. Returns its rows, and without any takes it away; -1: it cannot be written.
static int write_numbers(const ck_ReportData *data, const ck_Chart *chart, const char *scene, const char *directory) {
    char name[200], file_name[220];
    ck_chart_file(name, sizeof name, chart, scene);
    snprintf(file_name, sizeof file_name, "%s.csv", name);
    char *path = ck_path_join(directory, file_name);
    FILE *file = path ? fopen(path, "w") : NULL;
    int rows = -1;
    if (file) {
        fprintf(file, "%s\n", chart->columns);
        rows = chart->select(data, scene, file);
        bool failed = ferror(file);
        if (fclose(file) || failed) rows = -1;
    }
    if (file && !rows) unlink(path);
    free(path);
    return rows;
}

// What gnuplot said of the chart that it ended in.
static void read_complaint(char *text, size_t size, const char *directory) {
    char *path = ck_path_join(directory, "gnuplot.log"), *log = NULL;
    size_t length;
    snprintf(text, size, "it said nothing");
    if (path && !ck_file_read(&log, &length, path, NULL)) {
        const char *last = log;
        for (const char *next = log; (next = strstr(next, "chart ")); next++)
            if (next == log || next[-1] == '\n') last = next;
        snprintf(text, size, "%s", last);
    }
    for (char *letter = text; *letter; letter++)
        if (*letter == '\n') *letter = ' ';
    free(log);
    free(path);
}

static void forget_log(const char *directory) {
    char *path = ck_path_join(directory, "gnuplot.log");
    if (path) unlink(path);
    free(path);
}

// Runs gnuplot on charts.gp in the directory. What it says goes to gnuplot.log there, which stays only where it failed.
static ck_Status run_gnuplot(const char *directory, ck_Error *error) {
    static const char *const words[] = {"gnuplot", "-d", "charts.gp", NULL};
    int end;
    ck_Status status = ck_tool_run(&end, words, directory, "gnuplot.log", 0, error);
    if (!status && end == 0) forget_log(directory);
    if (status || end == 0) return status;
    if (end == CK_TOOL_MISSING)
        return ck_fail(error, CK_IO, "gnuplot is not there; charts need Debian's package gnuplot-nox or its like");
    char complaint[400];
    read_complaint(complaint, sizeof complaint, directory);
    return ck_fail(error, CK_IO, "gnuplot failed: %s", complaint);
}

static FILE *open_script(const char *directory, const char *name) {
    char *path = ck_path_join(directory, name);
    FILE *file = path ? fopen(path, "w") : NULL;
    free(path);
    return file;
}

static ck_Status write_script(FILE *file, const ck_ReportData *data, const char *directory, const char *sources,
                              double paper_width, bool *drawn, ck_Error *error) {
    fprintf(file, "sources = '");
    write_quoted(file, sources);
    fprintf(file, "/charts'\n");
    for (int scene = 0; scene <= data->scene_count; scene++)
        for (int i = 0; i < CHARTS; i++) {
            const char *name = scene < data->scene_count ? data->scenes[scene] : NULL;
            if (charts[i].is_of_all != !name) continue;
            int rows = write_numbers(data, &charts[i], name, directory);
            if (rows < 0) return ck_fail(error, CK_IO, "%s: %s", directory, strerror(errno));
            drawn[scene * CHARTS + i] = rows > 0;
            if (!rows) continue;
            write_plot(file, &charts[i], name, screen_svg, "svg", 0);
            write_plot(file, &charts[i], name, screen_png, "png", 0);
            if (paper_width > 0) write_plot(file, &charts[i], name, paper_pdf, "pdf", paper_width);
        }
    return CK_OK;
}

ck_Status ck_charts_draw(const ck_ReportData *data, const char *directory, const char *sources, double paper_width,
                         bool *drawn, ck_Error *error) {
    int failed = ck_path_make(directory);
    FILE *looks = failed ? NULL : open_script(directory, "looks.gp"),
         *script = looks ? open_script(directory, "charts.gp") : NULL;
    ck_Status status = script ? CK_OK : ck_fail(error, CK_IO, "%s: %s", directory, strerror(failed ? failed : errno));
    if (!status) write_looks(looks, data);
    if (!status) status = write_script(script, data, directory, sources, paper_width, drawn, error);
    if (looks && fclose(looks) && !status) status = ck_fail(error, CK_IO, "%s: %s", directory, strerror(errno));
    if (script && fclose(script) && !status) status = ck_fail(error, CK_IO, "%s: %s", directory, strerror(errno));
    return status ? status : run_gnuplot(directory, error);
}
