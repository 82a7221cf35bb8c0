// A whole CSV file in memory, read through libcsv and held against its layout.
#ifndef CK_CSV_READER_H
#define CK_CSV_READER_H

#include "layout.h"
#include "status.h"

typedef struct ck_CsvTable {
    const ck_Layout *layout;     // NULL: not read
    int row_count, column_count; // of the layout
    int width;                   // columns of the file: those of a study follow, host, of_scene and a swept key each
    char **fields;               // [1 + row_count][width], the header first
    char *text;                  // that fields point into
} ck_CsvTable;

// Reads directory's file of a layout. Only what is whole and of that layout is taken: errors name file, line and
// column, and what would be right.
// Errors: CK_BAD_INPUT, CK_IO where it cannot be read, CK_NO_MEMORY. Free with ck_csv_table_free in any case.
ck_Status ck_csv_table_read(ck_CsvTable *table, const char *directory, const ck_Layout *layout, ck_Error *error);

// The same of a file of another name.
ck_Status ck_csv_table_read_file(ck_CsvTable *table, const char *path, const ck_Layout *layout, ck_Error *error);

// Accepts a zeroed table.
void ck_csv_table_free(ck_CsvTable *table);

const char *ck_csv_table_text(const ck_CsvTable *table, int row, int column);
// NaN where the field is empty.
double ck_csv_table_number(const ck_CsvTable *table, int row, int column);

// The place of a study's column after those of the layout, by its name; −1: there is none.
int ck_csv_table_extra(const ck_CsvTable *table, const char *name);

// The same of a column by its name, which the layout must have.
const char *ck_csv_text_of(const ck_CsvTable *table, int row, const char *column);
double ck_csv_number_of(const ck_CsvTable *table, int row, const char *column);

#endif
