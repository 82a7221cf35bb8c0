// Paths in the file system, and whole files.
#ifndef CK_FILES_H
#define CK_FILES_H

#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

// Reads a whole file, and a zero after it. Errors: CK_IO, CK_NO_MEMORY. Free *bytes in any case.
ck_Status ck_file_read(char **bytes, size_t *size, const char *path, ck_Error *error);

// How many bytes at the start of a text are the byte-order mark that spreadsheets put there: 0 or 3.
size_t ck_text_mark(const char *bytes, size_t size);

// Paths in the file system.

// directory/name. NULL when out of memory. Free the result.
char *ck_path_join(const char *directory, const char *name);

// A name beside directory/name that no other process writes to: what a file is called until it is whole.
// NULL when out of memory. Free the result.
char *ck_path_part(const char *directory, const char *name);

// Makes a directory and those above it. 0, or an errno.
int ck_path_make(const char *directory);

// Removes a file, or a directory with all that is in it. What cannot be removed stays.
void ck_path_remove(const char *path);

// The directory of what came with the program, which has scenes/ and reports/: share/clothcheck beside the bin/ that it
// is installed in, else its source tree. False where there is none.
bool ck_path_data(char *out, size_t size);

// The directory of programs that came with this one and are talked to: adapters/ beside it, or
// libexec/clothcheck/adapters where it is installed. False where there is none.
bool ck_path_adapters(char *out, size_t size);

// What an errno of opening a file to read is: CK_BAD_INPUT where it is its name or its rights, CK_NO_MEMORY, or CK_IO.
ck_Status ck_file_status(int why);

// A folder to work in, directory/name.NUMBER.part: it is locked, so that it is nobody's once this process is dead.
typedef struct ck_PartFolder {
    char *path; // NULL: none
    int lock;
} ck_PartFolder;

// Removes what killed processes have left of directory/name, files and folders of its parts.
void ck_path_sweep(const char *directory, const char *name);

// Sweeps, and makes the folder and those above it. Errors: CK_IO, CK_NO_MEMORY. End with ck_part_folder_close in any
// case.
ck_Status ck_part_folder_open(ck_PartFolder *folder, const char *directory, const char *name, ck_Error *error);

// Removes it, unless it has another name by now. Accepts a zeroed one.
void ck_part_folder_close(ck_PartFolder *folder);

// What tells two inputs apart.

#define CK_HASH_START 0xcbf29ce484222325u

// Source: Fowler, Noll, Vo, FNV-1a 64 bit.
static inline uint64_t ck_hash(uint64_t start, const void *data, size_t bytes) {
    const unsigned char *byte = data;
    for (size_t i = 0; i < bytes; i++) start = (start ^ byte[i]) * 0x100000001b3u;
    return start;
}

// Writes all bytes at a file's place. False where it cannot, and errno says why: a disk that is full takes what still
// fits and says so the next time.
bool ck_file_write(int file, const void *bytes, size_t size);

// Locks an open file or folder for this process and its children, or with shares for all that share it. False where
// another process holds it for two seconds: the workers of one that was killed do until they are dead, too. Where a
// file system has no locks, nothing is locked.
bool ck_file_lock(int file, bool shares);

// Whether an open file is still what its path names: another process may have removed it between opening and locking.
bool ck_file_is_named(int file, const char *path);

// A file that appears whole or not at all: written beside its name under a lock, then renamed. What killed processes
// have left of it is removed when it is begun again.
typedef struct ck_WholeFile {
    FILE *file;        // to write to
    char *path, *part; // the name it gets, and the one it is written under
} ck_WholeFile;

// Starts directory/name; the directory is made where it is missing. Errors: CK_IO, CK_NO_MEMORY. End with
// ck_whole_file_close or ck_whole_file_discard in any case.
ck_Status ck_whole_file_open(ck_WholeFile *whole, const char *directory, const char *name, ck_Error *error);

// Gives the file its name, once it is on the disk. Errors: CK_IO, and then there is no file.
ck_Status ck_whole_file_close(ck_WholeFile *whole, ck_Error *error);

// Leaves nothing behind. Accepts a zeroed or closed one.
void ck_whole_file_discard(ck_WholeFile *whole);

#endif
