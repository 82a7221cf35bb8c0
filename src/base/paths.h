// Paths in the file system.
#ifndef CK_PATHS_H
#define CK_PATHS_H

#include <stdbool.h>
#include <stddef.h>

// directory/name. NULL when out of memory. Free the result.
char *ck_path_join(const char *directory, const char *name);

// A name beside directory/name that no other process writes to: what a file is called until it is whole.
// NULL when out of memory. Free the result.
char *ck_path_part(const char *directory, const char *name);

// Makes a directory and those above it. 0, or an errno.
int ck_path_make(const char *directory);

// The directory of what came with the program, which has scenes/ and reports/: share/clothcheck beside the bin/ that it
// is installed in, else its source tree. False where there is none.
bool ck_path_data(char *out, size_t size);

#endif
