// The folder that a command writes into, which nobody else writes into meanwhile.
#ifndef CK_OUT_FOLDER_H
#define CK_OUT_FOLDER_H

#include "status.h"

#include <stdbool.h>

typedef struct ck_OutFolder {
    const char *path; // NULL: none is claimed
    int file;         // the folder, open and locked; below 0: its file system has no locks
    int made;         // folders of the path that were not there
} ck_OutFolder;

// Makes the folder where it is missing and claims it until ck_out_folder_leave.
//   shares  with others that share it, too: processes that work on one study, and reports
// Errors: CK_BAD_INPUT where another process holds it for longer than the workers of a killed one do, or it is no
// folder; CK_IO.
ck_Status ck_out_folder_claim(ck_OutFolder *folder, const char *path, bool shares, ck_Error *error);

// Folders that were made and are still empty go. Accepts a zeroed folder.
void ck_out_folder_leave(ck_OutFolder *folder);

#endif
