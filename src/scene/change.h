// A scene with some of its values changed, in one word: FILE@KEY=VALUE@KEY=VALUE, as
// scenes/cloth_flag.yaml@springs.stiffness=100@resolution=2. A value is YAML, and may be that of a key that the file
// lacks.
#ifndef CK_CHANGE_H
#define CK_CHANGE_H

#include "document.h"
#include "status.h"

#include <stdbool.h>

// One of a word's changes, whose texts are parts of the word.
typedef struct ck_Change {
    const char *key, *value;
    int key_length, value_length;
} ck_Change;

// How many letters of a word are the file's name.
int ck_change_file_length(const char *word);

// The change after the letter at *place, which is 0 for the first; false beyond the last.
bool ck_change_next(const char *word, int *place, ck_Change *change);

// Adds the changes of other words behind *words, in place of those of the same keys. False when out of memory; then
// *words is as it was.
bool ck_change_merge(char **words, const char *more);

// Puts a value in place of that of a key, or of the key that stands for it, or beside what a mapping has already, into
// the document's text, whose lines stay as they are but for the value. The tree is that of before: parse the text
// again. Errors: CK_BAD_INPUT where there is no such place, CK_NO_MEMORY.
ck_Status ck_change_apply(ck_Document *document, const ck_Change *change, ck_Error *error);

// What a word's changes add to its scene's name, of plain letters: "-stiffness_100-resolution_2". Returns name.
char *ck_change_name(char *name, size_t size, const char *word);

#endif
