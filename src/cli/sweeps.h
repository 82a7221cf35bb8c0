// A study over many scenes as commands run it: cases, results, answer.
#ifndef CK_SWEEPS_H
#define CK_SWEEPS_H

#include "command.h"
#include "sweep.h"

typedef struct ck_Sweeps {
    ck_Arguments *arguments;
    ck_StudyFile file;
    char *const *paths;            // of its scenes
    bool is_by_point;              // all engines of a point are one case
    char again[CK_SWEEP_WORD];     // what goes on with it
    char *words[4], limits[2][40]; // options of what is run
    ck_SweepOptions options;
    ck_Sweep sweep;
} ck_Sweeps;

// Lists the cases of file, and checks that no other results in --out would be lost.
// Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY. Free with ck_sweeps_free in any case.
ck_Status ck_sweeps_open(ck_Sweeps *sweeps, ck_Error *error);
void ck_sweeps_free(ck_Sweeps *sweeps);

// After ck_sweep_run: writes and tells the results where all cases are there, else how far it is.
ck_Status ck_sweeps_end(ck_Sweeps *sweeps, const ck_SweepProgress *progress, ck_Error *error);

// Writes and tells them, or fails where cases are missing.
ck_Status ck_sweeps_write(ck_Sweeps *sweeps, ck_Error *error);

// The scenes of a command that takes one, each as a case: returns the exit status.
int ck_sweeps_of_scenes(ck_Arguments *arguments, ck_StudyRun run);

#endif
