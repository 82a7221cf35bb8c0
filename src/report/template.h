// A page of its parts: reports/page/NAME with what it includes.
#ifndef CK_TEMPLATE_H
#define CK_TEMPLATE_H

#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

// The directory of the pages' and charts' sources. Errors: CK_IO where there is none.
ck_Status ck_template_sources(char *sources, size_t size, ck_Error *error);

// Writes sources/page/NAME line by line: "@include FILE" is that file's text, of three.js where it begins with three/;
// "@nonce" within a line is the nonce; and "@WORD" alone is what part writes for the word.
//   part  NULL: there is none. Errors: its own, CK_IO, CK_NO_MEMORY.
ck_Status ck_template_write(FILE *file, const char *sources, const char *name, const char *nonce,
                            ck_Status (*part)(void *context, const char *word, ck_Error *error), void *context,
                            ck_Error *error);

#endif
