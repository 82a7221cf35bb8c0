// One CSV file that appears whole or not at all: written beside its name through libcsv, then renamed.
#ifndef CK_CSV_WRITER_H
#define CK_CSV_WRITER_H

#include "files.h"
#include "layout.h"
#include "status.h"

#include <stdint.h>

typedef struct ck_Csv {
    ck_WholeFile whole;
    int column_count, column;
} ck_Csv;

// Starts a layout's file in a directory, with its header.
// Errors: CK_IO, CK_NO_MEMORY. End with ck_csv_close or ck_csv_discard in any case.
ck_Status ck_csv_open(ck_Csv *csv, const char *directory, const ck_Layout *layout, ck_Error *error);

// Rows of a layout into a file of the caller's, without a header. It is the caller's to close.
void ck_csv_begin(ck_Csv *csv, FILE *file, const ck_Layout *layout);

// One field each. Rows end by themselves after the last column. Write errors are told by ck_csv_close.
// A number is written so that it reads back the same (%.17g); NaN is an empty field.
void ck_csv_text(ck_Csv *csv, const char *text);
void ck_csv_number(ck_Csv *csv, double number);
void ck_csv_count(ck_Csv *csv, uint64_t count);

// Gives the file its name. Errors: CK_IO, and then there is no file.
ck_Status ck_csv_close(ck_Csv *csv, ck_Error *error);

// Leaves nothing behind. Accepts a zeroed or closed csv.
void ck_csv_discard(ck_Csv *csv);

#endif
