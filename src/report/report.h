// What people look at: charts and one page, of the CSVs of a comparison or a study and of nothing else.
#ifndef CK_REPORT_H
#define CK_REPORT_H

#include "status.h"

// Reads all CSVs and replays of a directory before it writes anything, draws directory/charts/, and writes
// directory/index.html. What was there stays when anything fails.
// Errors: CK_BAD_INPUT where a file is not whole or foreign, or there is none; CK_IO, CK_NO_MEMORY.
//   paper_width  cm, of each chart as PDF, too; 0: none
ck_Status ck_report_write(const char *directory, double paper_width, ck_Error *error);

#endif
