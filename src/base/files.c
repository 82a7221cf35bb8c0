#include "files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_file_read(char **bytes, size_t *size, const char *path, ck_Error *error) {
    *bytes = NULL;
    *size = 0;
    FILE *file = fopen(path, "rb");
    if (!file) return ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    size_t capacity = 0;
    ck_Status status = CK_OK;
    do {
        if (capacity - *size < 2) {
            capacity = capacity ? 2 * capacity : 1 << 16;
            char *more = realloc(*bytes, capacity);
            if (!more) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
            if (more) *bytes = more;
        }
        if (!status) *size += fread(*bytes + *size, 1, capacity - *size - 1, file);
    } while (!status && !feof(file) && !ferror(file));
    if (!status && ferror(file)) status = ck_fail(error, CK_IO, "%s: %s", path, strerror(errno));
    if (!status) (*bytes)[*size] = 0;
    fclose(file);
    return status;
}
