// The finished scenes of a comparison of several, kept below its directory until all are there: one that is killed goes
// on where it was.
#ifndef CK_UNFINISHED_H
#define CK_UNFINISHED_H

#include "tables.h"

// OUT/unfinished: question, which is locked, scenes, with a folder of CSVs each, and replays.
typedef struct ck_Unfinished {
    char *directory; // NULL: nothing is kept
    const char *out;
    int question; // the file that is locked
    int kept;     // scenes that were there when it was opened
} ck_Unfinished;

// Opens or begins what is kept below out for one question, all that results depend on. What another question has left
// is removed.
//   dropped  how many finished scenes that were
// Errors: CK_BAD_INPUT where another process writes there; CK_IO, CK_NO_MEMORY. End with ck_unfinished_close in any
// case.
ck_Status ck_unfinished_open(ck_Unfinished *unfinished, const char *out, const char *question, int *dropped,
                             ck_Error *error);

// Copies a scene's rows to tables; false where it is not there whole.
bool ck_unfinished_take(const ck_Unfinished *unfinished, const ck_Comparison *comparison, ck_Tables *tables);

// Keeps a finished scene, with its replay. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_unfinished_keep(const ck_Unfinished *unfinished, const ck_Comparison *comparison,
                             const ck_CompareOptions *options, ck_Error *error);

// Gives replays their place in out once all tables are closed, and removes the rest. Errors: CK_IO.
ck_Status ck_unfinished_finish(ck_Unfinished *unfinished, ck_Error *error);

// Leaves what is kept. Accepts a zeroed one.
void ck_unfinished_close(ck_Unfinished *unfinished);

#endif
