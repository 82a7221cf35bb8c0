#include "path_file.h"

#include "files.h"

#include <csv.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#define MOST_BYTES 100000000
#define MOST_COLUMNS 256

static const char *const names[4] = {"time_s", "x", "y", "z"};

typedef struct Reader {
    const char *path;
    double (*points)[4];
    int count, capacity, line, column;
    int meaning[MOST_COLUMNS]; // of each column: which of names; −1: another
    int found;                 // of a row's values
    ck_Status status;
    ck_Error *error;
} Reader;

static void take_name(Reader *reader, const char *text) {
    reader->meaning[reader->column] = -1;
    for (int i = 0; i < 4; i++)
        if (!strcmp(text, names[i])) reader->meaning[reader->column] = i;
}

static void take_value(Reader *reader, const char *text) {
    const int meaning = reader->meaning[reader->column];
    char *end = NULL;
    if (meaning < 0) return;
    double value = strtod(text, &end);
    if (!*text || *end || !isfinite(value))
        reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: %s is '%.40s'; it must be a number", reader->path,
                                 reader->line, names[meaning], text);
    reader->points[reader->count][meaning] = value;
    reader->found |= 1 << meaning;
}

static void take_field(void *data, size_t length, void *context) {
    Reader *reader = context;
    char text[64];
    if (reader->status) return;
    snprintf(text, sizeof text, "%.*s", (int)length, (const char *)data);
    if (reader->column >= MOST_COLUMNS)
        reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: more than %d columns", reader->path, reader->line,
                                 MOST_COLUMNS);
    else if (reader->line == 1)
        take_name(reader, text);
    else
        take_value(reader, text);
    reader->column++;
}

static void make_room(Reader *reader) {
    if (reader->count < reader->capacity || reader->status) return;
    const int capacity = reader->capacity ? 2 * reader->capacity : 256;
    double(*more)[4] = realloc(reader->points, (size_t)capacity * sizeof *more);
    if (!more) {
        reader->status = ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->path);
        return;
    }
    reader->points = more;
    reader->capacity = capacity;
}

static void take_row(int end, void *context) {
    Reader *reader = context;
    (void)end;
    if (reader->status) return;
    if (reader->line == 1) {
        int found = 0;
        for (int i = 0; i < reader->column; i++)
            if (reader->meaning[i] >= 0) found |= 1 << reader->meaning[i];
        for (int i = reader->column; i < MOST_COLUMNS; i++) reader->meaning[i] = -1;
        if (found != 15)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT,
                                     "%s:1: its first line must name columns time_s, x, y and z", reader->path);
    } else if (reader->found != 15) {
        reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: a value is missing", reader->path, reader->line);
    } else {
        reader->count++;
    }
    reader->line++;
    reader->column = reader->found = 0;
    make_room(reader);
}

static void parse(Reader *reader, FILE *file) {
    struct csv_parser parser;
    char block[8192];
    size_t length, mark;
    if (csv_init(&parser, CSV_APPEND_NULL)) {
        reader->status = ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->path);
        return;
    }
    for (bool is_first = true; !reader->status && (length = fread(block, 1, sizeof block, file)) > 0;
         is_first = false) {
        mark = is_first ? ck_text_mark(block, length) : 0;
        if (csv_parse(&parser, block + mark, length - mark, take_field, take_row, reader) != length - mark)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: %s", reader->path, reader->line,
                                     csv_strerror(csv_error(&parser)));
    }
    if (!reader->status) csv_fini(&parser, take_field, take_row, reader);
    csv_free(&parser);
}

ck_Status ck_path_file_read(double (**points)[4], int *count, const char *path, ck_Error *error) {
    Reader reader = {.path = path, .line = 1, .error = error};
    struct stat info;
    FILE *file = stat(path, &info) ? NULL : fopen(path, "rb");
    if (!file) return ck_fail(error, ck_file_status(errno), "%s: %s", path, strerror(errno));
    if (!S_ISREG(info.st_mode) || info.st_size > MOST_BYTES)
        reader.status = ck_fail(error, CK_BAD_INPUT, "%s: must be a file of at most %d bytes", path, MOST_BYTES);
    make_room(&reader);
    if (!reader.status) parse(&reader, file);
    fclose(file);
    if (!reader.status && reader.count < 2)
        reader.status = ck_fail(error, CK_BAD_INPUT, "%s: has %d points; a path has at least two", path, reader.count);
    *points = reader.points;
    *count = reader.count;
    return reader.status;
}
