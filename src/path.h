// Paths in the file system.
#ifndef CK_PATH_H
#define CK_PATH_H

// directory/name + suffix; with an empty suffix just that, and with a name that begins with a dot no slash between.
// NULL when out of memory. Free the result.
char *ck_path_join(const char *directory, const char *name, const char *suffix);

// Makes a directory and those above it. 0, or an errno.
int ck_path_make(const char *directory);

#endif
