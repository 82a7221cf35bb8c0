// A program that does what an engine does on a scene, to paste: a text with gaps, and what fills them.
#ifndef CK_CODE_H
#define CK_CODE_H

#include "model.h"
#include "settings.h"
#include "status.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

// A gap @name@, or the name of a part that is left out unless it has a text.
typedef struct ck_CodeValue {
    char name[24], text[120];
} ck_CodeValue;

// The text's lines //: if NAME, //: else and //: end hold parts, which may nest; //: data is the model's tables.
typedef struct ck_Code {
    const char *text;      // the program's, with gaps
    const char *extension; // of its file: "c", "cpp"
    ck_CodeValue values[64];
    int value_count;
    int *order; // of springs, [spring_count], owned; NULL: the model's
} ck_Code;

void ck_code_free(ck_Code *code);

// A number in the fewest digits that read back the same.
void ck_code_number(ck_Code *code, const char *name, double number);
void ck_code_text(ck_Code *code, const char *name, const char *text);
// A part that is in the program, or not.
void ck_code_part(ck_Code *code, const char *name, bool is_in);

// Writes a text with its gaps filled; of //: data nothing.
void ck_code_fill(FILE *out, const ck_Code *code);

struct ck_Engine;

// True where an engine has a program that knows all of a scene.
bool ck_code_knows(const struct ck_Engine *engine, const ck_Model *model);

// Writes the program of an engine on a scene's model with settings that the engine has used.
//   path  of the scene, for its comments
// Errors: CK_BAD_INPUT where the engine has no such program; CK_NO_MEMORY, CK_IO.
ck_Status ck_code_write(FILE *out, const struct ck_Engine *engine, const ck_Model *model, const ck_Settings *used,
                        const char *path, ck_Error *error);

#ifdef __cplusplus
}
#endif

#endif
