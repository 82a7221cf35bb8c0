// Points of a path from a CSV file.
#ifndef CK_PATH_FILE_H
#define CK_PATH_FILE_H

#include "status.h"

// Reads columns time_s, x, y and z, in any order, among others; s and m. At least two rows.
//   points  [count][4], owned by the caller in any case
// Errors: CK_BAD_INPUT with line, CK_NO_MEMORY.
ck_Status ck_path_file_read(double (**points)[4], int *count, const char *path, ck_Error *error);

#endif
