// The charts of a report: each a row of a table, a function that selects its numbers from the CSVs, and a gnuplot
// script of its name in reports/charts/.
#ifndef CK_CHART_H
#define CK_CHART_H

#include "report_data.h"

#include <stdio.h>

#define CK_CHART_DIRECTORY "charts"

typedef struct ck_Chart {
    const char *name;
    const char *title;   // what it shows
    const char *columns; // of its own CSV, which the script reads
    int width, height;   // px
    bool is_of_all;      // one for all scenes, named as the chart is; else one a scene, SCENE.NAME
    bool is_dense;       // of more letters than a column of a paper has room for
    // Writes the chart's rows, of a scene where it is not of all. Returns how many; 0: there is nothing to show.
    int (*select)(const ck_ReportData *data, const char *scene, FILE *out);
} ck_Chart;

int ck_chart_count(void);
const ck_Chart *ck_chart_at(int index);

// The name of a chart's files without their ending, into name. scene may be NULL for one of all.
void ck_chart_file(char *name, size_t size, const ck_Chart *chart, const char *scene);

// Draws all charts that there are numbers for, as SVG and PNG with their numbers beside them, into directory, which is
// made. drawn gets [scene_count + 1][chart count], row scene_count for those of all.
//   sources      directory that holds the scripts, charts/NAME.gp
//   paper_width  cm, of each as PDF, too; 0: none
// Errors: CK_IO with what gnuplot says, CK_NO_MEMORY.
ck_Status ck_charts_draw(const ck_ReportData *data, const char *directory, const char *sources, double paper_width,
                         bool *drawn, ck_Error *error);

// Selections, by the CSVs that they are made of.
int ck_chart_select_summary(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_cost(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_errors(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_deviations(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_sag(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_energy(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_height(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_precision(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_iterations(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_stability(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_needs(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_refine(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_sweep(const ck_ReportData *data, const char *scene, FILE *out);
int ck_chart_select_size(const ck_ReportData *data, const char *scene, FILE *out);

#endif
