// Rows that a child process finds and writes, so that one which crashes or hangs costs its rows and nothing else.
#ifndef CK_CSV_CHILD_H
#define CK_CSV_CHILD_H

#include "csv_writer.h"
#include "process.h"

// Writes rows of csv's layout. Anything else that it changes is changed in the child alone.
typedef ck_Status (*ck_CsvWork)(ck_Csv *csv, void *context, ck_Error *error);

// Runs work in a child within limits, and adds its rows where it came to its end. Errors: those of work; CK_REFUSED
// where the child crashed, left or passed a limit, with the reason, and then there are no rows of it; CK_IO,
// CK_NO_MEMORY.
ck_Status ck_csv_from_child(ck_Csv *csv, ck_CsvWork work, void *context, const ck_Limits *limits, ck_Error *error);

#endif
