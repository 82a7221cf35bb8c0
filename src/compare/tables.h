// The six CSV files of a comparison.
#ifndef CK_TABLES_H
#define CK_TABLES_H

#include "comparison.h"
#include "csv_writer.h"

typedef struct ck_Tables {
    ck_Csv csv[CK_COMPARISON_LAYOUTS];
} ck_Tables;

// What becomes of results that a directory holds already.
typedef enum ck_Keeping {
    CK_KEEP_OR_FAIL, // an error where any would be lost
    CK_KEEP_OTHERS,  // those of other scenes stay
    CK_KEEP_NONE,
} ck_Keeping;

// Starts all six in a directory, which is made where it is missing. The comparisons are those that will be added, each
// of the engines of options.
// Errors: CK_BAD_INPUT where results would be lost, CK_IO, CK_NO_MEMORY. End with ck_tables_close or ck_tables_discard
// in any case.
ck_Status ck_tables_open(ck_Tables *tables, const char *directory, ck_Keeping keeping, const ck_Comparison *comparisons,
                         int count, const ck_CompareOptions *options, ck_Error *error);

// Adds the rows of one finished comparison. options are those it ran with.
void ck_tables_add(ck_Tables *tables, const ck_Comparison *comparison, const ck_CompareOptions *options);

// Adds what is known of the machine, and gives the six files their names. Errors: CK_IO.
ck_Status ck_tables_close(ck_Tables *tables, ck_Error *error);

void ck_tables_discard(ck_Tables *tables);

#endif
