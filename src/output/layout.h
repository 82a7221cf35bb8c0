// The CSV contract: every file, its columns, and what they hold. What writes and what reads go by it.
#ifndef CK_LAYOUT_H
#define CK_LAYOUT_H

#define CK_LAYOUT_MOST_COLUMNS 24

typedef enum ck_ColumnKind {
    CK_COLUMN_NAME,   // text that is never empty
    CK_COLUMN_TEXT,   // may be empty
    CK_COLUMN_NUMBER, // empty where there is none; "inf" and "-inf" are numbers
    CK_COLUMN_STATUS, // one of ck_run_status_names
} ck_ColumnKind;

typedef struct ck_Column {
    const char *name; // NULL: there are no more
    ck_ColumnKind kind;
} ck_Column;

typedef enum ck_LayoutName {
    // of a comparison
    CK_RUNS,
    CK_METRICS,
    CK_DEVIATIONS,
    CK_LEDGER,
    CK_SERIES,
    CK_MACHINE,
    CK_COMPARISON_LAYOUTS,
    // of studies
    CK_PRECISION = CK_COMPARISON_LAYOUTS,
    CK_PRECISION_SUMMARY,
    CK_STABILITY,
    CK_TUNE,
    CK_NEEDS,
    CK_REFINE,
    CK_REFINE_SUMMARY,
    CK_BENCH,
    CK_CLAIMS,
    CK_QUIRKS,
    CK_FIT,
    CK_CONFORM,
    CK_STUDY,
    CK_STUDY_CHARTS,
    CK_HISTORY,
    CK_REPORT_LAYOUTS, // those above are in a report
    CK_BASELINE = CK_REPORT_LAYOUTS,
    CK_LAYOUT_COUNT
} ck_LayoutName;

typedef struct ck_Layout {
    const char *file, *about;
    ck_Column columns[CK_LAYOUT_MOST_COLUMNS + 1];
} ck_Layout;

extern const ck_Layout ck_layouts[CK_LAYOUT_COUNT];

int ck_layout_column_count(const ck_Layout *layout);

// The column of that name, which must be there.
int ck_layout_column(const ck_Layout *layout, const char *name);

#endif
