// A list of independent cases, run in worker processes, resumed after a kill, and shared between machines.
#ifndef CK_STUDY_H
#define CK_STUDY_H

#include "journal.h"

typedef struct ck_Study {
    const char *name;     // of its journal, NAME.journal
    ck_ValueName name_at; // of the values of its rows
    int case_count;
    void *context;
    // What a case is, in words that no other case of the study has.
    void (*describe)(const void *context, int index, char *key, size_t size);
    // Runs a case in a worker process. Errors end the study; how an engine fares is in the row.
    ck_Status (*run)(const void *context, int index, ck_JournalRow *row, ck_Error *error);
} ck_Study;

typedef struct ck_StudyOptions {
    const char *directory; // of the journal
    const char *question;  // what was asked, the same for every part of it
    int jobs;              // worker processes
    int shard, shards;     // only every shards-th case, from the shard-th, counted from 1
    bool runs_nothing;     // every case must be in the journal, or it is an error
} ck_StudyOptions;

// Runs the cases that the journal does not hold; rows [case_count] get all there are, is_done false for the others.
// The journal stays: ck_study_forget takes it away once the results are written.
// Errors: CK_IO, CK_NO_MEMORY, and what a case returns.
ck_Status ck_study_run(const ck_Study *study, const ck_StudyOptions *options, ck_JournalRow *rows, ck_Error *error);

void ck_study_forget(const ck_Study *study, const ck_StudyOptions *options);

// Joins the journals of name, whose rows have values of those names, in several directories, all of one question, into
// one of directory. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_study_merge(const char *directory, const char *name, ck_ValueName name_at, const char *const *parts,
                         int part_count, ck_Error *error);

#endif
