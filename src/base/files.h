// Whole files in memory.
#ifndef CK_FILES_H
#define CK_FILES_H

#include "status.h"

#include <stddef.h>

// Reads a whole file, and a zero after it. Errors: CK_IO, CK_NO_MEMORY. Free *bytes in any case.
ck_Status ck_file_read(char **bytes, size_t *size, const char *path, ck_Error *error);

#endif
