// The CSVs of a comparison or a study, as a report needs them: read, checked, and summed up.
#ifndef CK_REPORT_DATA_H
#define CK_REPORT_DATA_H

#include "csv_reader.h"

#include <stdbool.h>

// How one engine fared on one scene.
typedef struct ck_Summary {
    const char *scene, *engine, *status;
    const char *metric;        // that stands for its error; "" where nothing has a truth
    double error, uncertainty; // of that metric, in its unit; NaN: not known
    double told;               // the error, or the uncertainty where that is larger: what is known of it
    double cost;               // s of CPU per simulated second; NaN: not timed
    double timed, duration;    // s that the cost is of, and the longest that any engine on the scene was timed
    const char *machine;       // the processor that the cost is of, of a study: only those of one are alike; else ""
    bool is_better;            // than what moves nothing; true where there is no telling
    bool on_front;             // no engine is both cheaper and as near to the truth, of those that ended ok
} ck_Summary;

// A study of more points is shown by its charts alone: the CSVs have the points.
#define CK_REPORT_MOST_POINTS 24

typedef struct ck_ReportData {
    const char *directory;
    ck_CsvTable tables[CK_REPORT_LAYOUTS]; // layout NULL where the file is not there
    const char **scenes;                   // of all tables, in their order
    int scene_count;                       // 0 with more than CK_REPORT_MOST_POINTS: of a study
    const char **engines;                  // those of the engine table first; "truth" is none
    int engine_count;
    ck_Summary *summary; // a row for each of runs.csv
    int summary_count;
} ck_ReportData;

// Reads every CSV of a report that is in the directory.
// Errors: CK_BAD_INPUT where one is not whole or foreign, or where there is none; CK_IO, CK_NO_MEMORY. Free with
// ck_report_data_free in any case.
ck_Status ck_report_data_read(ck_ReportData *data, const char *directory, ck_Error *error);

// Accepts zeroed data.
void ck_report_data_free(ck_ReportData *data);

// NULL where the file is not there.
const ck_CsvTable *ck_report_table(const ck_ReportData *data, ck_LayoutName name);

// True where a run says something of its engine: it ended ok, its error is known and better than moving nothing, and it
// was timed.
bool ck_summary_counts(const ck_Summary *one);

// Whether the errors of a metric are shown.
bool ck_report_shows(const char *metric);

// True where a row is of a scene, which stands in the first column.
bool ck_report_is_of(const ck_CsvTable *table, int row, const char *scene);

// The processor of a study's row, by its host; "" where the row has none. Cost: the rows of study.csv before that
// host's first.
const char *ck_report_machine(const ck_ReportData *data, const ck_CsvTable *table, int row);

// Where the engine is in data->engines.
int ck_report_engine(const ck_ReportData *data, const char *engine);

#endif
