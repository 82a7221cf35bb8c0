// Results that a directory holds already, of what is not run again.
#ifndef CK_KEPT_H
#define CK_KEPT_H

#include "comparison.h"
#include "csv_writer.h"

typedef struct ck_Kept {
    const char *directory;
    const ck_Comparison *comparisons; // that will be written into it
    int count;
    const ck_CompareOptions *options; // and of which engines
    bool by_engine; // results of the engines of a scene stand for themselves: those of others may stay
} ck_Kept;

// Whether results in a layout's file, of scene and engine, would be lost: those of other scenes, unless they are kept,
// and those of engines that are left out now. Kept ones must be of this machine and build. Errors: CK_BAD_INPUT, which
// says what is there and what to give, CK_NO_MEMORY.
ck_Status ck_kept_check(const ck_Kept *kept, const ck_Layout *layout, bool keeps_others, ck_Error *error);

// Copies the rows that stay. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_kept_copy(const ck_Kept *kept, ck_Csv *csv, const ck_Layout *layout, ck_Error *error);

#endif
