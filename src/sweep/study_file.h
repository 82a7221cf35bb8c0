// A study as its file says it: scenes, the values of their keys to go through, engines, and what to run at each point.
#ifndef CK_STUDY_FILE_H
#define CK_STUDY_FILE_H

#include "document.h"
#include "status.h"

#include <stdbool.h>

// The most points, and the most cases.
#define CK_STUDY_MOST_POINTS 10000000

// What is run at each point.
typedef enum ck_StudyRun {
    CK_STUDY_COMPARE,
    CK_STUDY_PRECISION,
    CK_STUDY_STABILITY,
    CK_STUDY_TUNE,
    CK_STUDY_NEEDS,
    CK_STUDY_REFINE,
    CK_STUDY_CONFORM,
    CK_STUDY_RUNS
} ck_StudyRun;
extern const char *const ck_study_runs[CK_STUDY_RUNS];

// What becomes of the metrics at every frame.
typedef enum ck_StudySeries {
    CK_SERIES_NONE,
    CK_SERIES_CSV,  // all in series.csv
    CK_SERIES_GZIP, // series/POINT.ENGINE.csv.gz, one a case
} ck_StudySeries;

// Keys that change together, and the values that they take: each with each of every other axis.
typedef struct ck_StudyAxis {
    int key_count, value_count;
    char **keys;   // [key_count]
    char **values; // [value_count][key_count], as YAML
} ck_StudyAxis;

// A chart: a metric against a key.
typedef struct ck_StudyChart {
    char *x, *metric, *of; // of: error or value
} ck_StudyChart;

typedef struct ck_StudyFile {
    ck_Document document;
    char *name, *about;
    ck_StudyRun run;
    char **scenes, **engines, **options; // options: words for what is run
    int scene_count, engine_count, option_count;
    ck_StudyAxis *axes;
    int axis_count;
    char *settings; // of engines at every point, as changes of a scene: see change.h
    int repeats;    // timed; below 0: it is not said
    ck_StudySeries series;
    bool has_series; // it is said
    ck_StudyChart *charts;
    int chart_count;
} ck_StudyFile;

// Errors: CK_BAD_INPUT with file:line:column, CK_NO_MEMORY, CK_IO. Free with ck_study_file_free in any case.
ck_Status ck_study_file_load(ck_StudyFile *study, const char *path, ck_Error *error);
void ck_study_file_free(ck_StudyFile *study);

#endif
