// The finished cases of a study, appended row by row, so that a study which is killed goes on where it was.
//
// A journal is a CSV: first a row that says what the study was asked, then the names of its columns, then key, status,
// reason and values of each case. A row is written at once and ends in a newline: what a kill cut off is dropped.
#ifndef CK_JOURNAL_H
#define CK_JOURNAL_H

#include "status.h"

#include <stdbool.h>
#include <stddef.h>

#define CK_JOURNAL_VALUES 72

// Parts a question from where it was asked, which does not count: the same may be asked on another machine.
#define CK_JOURNAL_PLACE "\tat\t"

// What is kept of a case; the study names its values. NaN where there is none.
typedef struct ck_JournalRow {
    bool is_done;
    int status; // of ck_RunStatus
    char reason[256];
    double values[CK_JOURNAL_VALUES];
} ck_JournalRow;

// The name of a value of a row, by its place in it; false beyond the last.
typedef bool (*ck_ValueName)(int index, char *name, size_t size);

typedef struct ck_Journal {
    int file;
    char *path;
    ck_ValueName name_at;
} ck_Journal;

// Opens or starts directory/name, for one process and its children at a time.
//   question  what was asked: the same question has the same cases;  kept  called for each row that was there
// Errors: CK_BAD_INPUT where it holds another question's cases, or another process has it; CK_IO, CK_NO_MEMORY. End
// with ck_journal_close in any case.
ck_Status ck_journal_open(ck_Journal *journal, const char *directory, const char *name, const char *question,
                          ck_ValueName name_at, void (*kept)(void *context, const char *key, const ck_JournalRow *row),
                          void *context, ck_Error *error);

// Reads all rows again, those that other processes have added among them. Errors: CK_NO_MEMORY.
ck_Status ck_journal_read(const ck_Journal *journal, const char *question,
                          void (*kept)(void *context, const char *key, const ck_JournalRow *row), void *context,
                          ck_Error *error);

// Appends a case; several processes may, at the same time. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_journal_add(const ck_Journal *journal, const char *key, const ck_JournalRow *row, ck_Error *error);

// True where two questions are the same but for their places.
bool ck_journal_is_same(const char *question, const char *other);

// Reads the question of directory/name into text. Errors: CK_BAD_INPUT where there is none, CK_NO_MEMORY.
ck_Status ck_journal_question(const char *directory, const char *name, char *text, size_t size, ck_Error *error);

// Takes the file away with remove, else leaves it. Accepts a zeroed journal.
void ck_journal_close(ck_Journal *journal, bool remove);

#endif
