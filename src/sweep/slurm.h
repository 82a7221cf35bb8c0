// A study on a cluster that Slurm runs: an array of parts, which share the cases among them, and a job that writes the
// results once they have ended, or submits the array again for what is left.
#ifndef CK_SLURM_H
#define CK_SLURM_H

#include "status.h"

typedef struct ck_SlurmOptions {
    const char *name;      // of the study
    const char *folder;    // where scripts and logs go
    const char *partition; // NULL: the cluster's own
    const char *time;      // of a part, as sbatch takes it; NULL: the partition's
    int array, limit;      // parts, and how many at a time; 0: any
    int cores;             // of a part
    const char *part;      // the command lines, quoted for a shell, but for the program
    const char *end;
} ck_SlurmOptions;

// The two scripts. NULL without memory. Free it.
char *ck_slurm_script(const ck_SlurmOptions *options, int is_end);

// Writes the scripts into the folder and submits them; jobs gets their numbers.
// Errors: CK_IO, with what sbatch says, CK_NO_MEMORY.
ck_Status ck_slurm_submit(const ck_SlurmOptions *options, long jobs[2], ck_Error *error);

#endif
