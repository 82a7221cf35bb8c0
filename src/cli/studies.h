// What the commands that are studies of one scene share.
#ifndef CK_STUDIES_H
#define CK_STUDIES_H

#include "command.h"
#include "study.h"
#include "tables.h"

typedef struct ck_StudyCommand {
    ck_Arguments *arguments;
    ck_Answer *answer;
    const ck_Comparison *comparison; // with its truth
    char question[2400];
    ck_Kept kept;
} ck_StudyCommand;

// Reads arguments of one scene, finds its truth, calls run, and writes machine.csv. Returns the exit status, having
// told of an error.
//   layout  of the file that would lose other results
int ck_study_command(const ck_Command *command, ck_LayoutName layout, int argc, char **argv,
                     ck_Status (*run)(const ck_StudyCommand *command, ck_Error *error));

// Starts a file of the study, with the rows that stay in it.
ck_Status ck_study_command_open(const ck_StudyCommand *command, ck_Csv *csv, ck_LayoutName layout, ck_Error *error);

// Runs a study's cases; *rows [case_count] is the caller's to free.
//   jobs  where the user says nothing; 0: as many as there are cores
ck_Status ck_study_command_run(const ck_StudyCommand *command, const ck_Study *study, int jobs, ck_JournalRow **rows,
                               ck_Error *error);

// Once the CSVs are written: takes the journal away, but that of a part, and says where they are.
void ck_study_command_done(const ck_StudyCommand *command, const ck_Study *study, const char *files);

#endif
