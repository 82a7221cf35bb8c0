// Text that is written as to a file, and grows in memory.
#ifndef CK_TEXT_H
#define CK_TEXT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

typedef struct ck_Text {
    FILE *file;  // to write to
    char *bytes; // once it is ended: size of them, and a zero; the caller frees them
    size_t size;
} ck_Text;

// False when out of memory.
bool ck_text_begin(ck_Text *text);

// Closes the file. False where any of the text found no memory: then there are no bytes. Accepts one that was not
// begun.
bool ck_text_end(ck_Text *text);

#endif
