// Paths in the file system.
#ifndef CK_PATH_H
#define CK_PATH_H

// directory/name. NULL when out of memory. Free the result.
char *ck_path_join(const char *directory, const char *name);

// A name beside directory/name that no other process writes to: what a file is called until it is whole.
// NULL when out of memory. Free the result.
char *ck_path_part(const char *directory, const char *name);

// Makes a directory and those above it. 0, or an errno.
int ck_path_make(const char *directory);

#endif
