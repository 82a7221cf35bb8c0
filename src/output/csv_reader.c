#include "csv_reader.h"

#include "files.h"
#include "status.h"

#include <csv.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Reader {
    ck_CsvTable *table;
    const char *path;
    char *free_text; // where the next field goes
    size_t capacity; // of fields
    size_t count;    // fields, those of the header among them
    int column, line;
    ck_Status status;
    ck_Error *error;
} Reader;

static void take_field(void *text, size_t length, void *context) {
    Reader *reader = context;
    ck_CsvTable *table = reader->table;
    if (reader->status) return;
    if (reader->count == reader->capacity) {
        reader->capacity = reader->capacity ? 2 * reader->capacity : 1024;
        char **fields = realloc(table->fields, reader->capacity * sizeof *fields);
        if (!fields) {
            reader->status = ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->path);
            return;
        }
        table->fields = fields;
    }
    // a field and the zero that ends it are never longer than the field and what parts it from the next
    memcpy(reader->free_text, text, length);
    reader->free_text[length] = 0;
    table->fields[reader->count++] = reader->free_text;
    reader->free_text += length + 1;
    reader->column++;
}

// As clothcheck writes numbers: strtod would also take hexadecimal ones and words that other readers do not.
static bool is_number(const char *text) {
    char *end;
    if (!strcmp(text, "inf") || !strcmp(text, "-inf")) return true;
    strtod(text, &end);
    return end != text && !*end && strspn(text, "+-.0123456789eE") == strlen(text);
}

// What a run can end in, and what a map of stability knows besides.
static bool is_status(const char *text) {
    for (int i = 0; i < CK_RUN_STATUS_COUNT; i++)
        if (!strcmp(ck_run_status_names[i], text)) return true;
    return !strcmp(text, "frozen") || !strcmp(text, "clamped");
}

// What is wrong with a field; NULL: nothing.
static const char *fault_of(ck_ColumnKind kind, const char *text) {
    switch (kind) {
    case CK_COLUMN_NAME: return *text ? NULL : "must not be empty";
    case CK_COLUMN_NUMBER: return !*text || is_number(text) ? NULL : "must be a number or empty";
    case CK_COLUMN_STATUS: return is_status(text) ? NULL : "must be what a run can end in, as ok or diverged";
    case CK_COLUMN_TEXT: break;
    }
    return NULL;
}

static void check_header(Reader *reader, char *const *row) {
    const ck_Column *columns = reader->table->layout->columns;
    const int own = reader->table->column_count;
    // a study's columns
    if (reader->column > own && (!strcmp(row[own], "host") || !strcmp(row[own], "of_scene")))
        reader->table->width = reader->column;
    for (int i = 0; i < reader->table->column_count && i < reader->column && !reader->status; i++)
        if (strcmp(row[i], columns[i].name))
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:1: column %d is '%.60s' where it must be %s",
                                     reader->path, i + 1, row[i], columns[i].name);
}

static void check_row(Reader *reader, char *const *row) {
    const ck_Column *columns = reader->table->layout->columns;
    for (int i = 0; i < reader->table->column_count && !reader->status; i++) {
        const char *fault = fault_of(columns[i].kind, row[i]);
        if (fault)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: column %d (%s): %s, not '%.60s'",
                                     reader->path, reader->line, i + 1, columns[i].name, fault, row[i]);
    }
}

static void end_row(int end, void *context) {
    (void)end;
    Reader *reader = context;
    if (reader->status) return;
    bool is_header = reader->count == (size_t)reader->column;
    char *const *row = reader->table->fields + reader->count - reader->column;
    if (is_header) check_header(reader, row);
    const int wanted = reader->table->width;
    if (!reader->status && reader->column != wanted)
        reader->status =
            ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: %d columns where there must be %d: %s ... %s", reader->path,
                    reader->line, reader->column, wanted, reader->table->layout->columns[0].name,
                    reader->table->layout->columns[reader->table->column_count - 1].name);
    if (!reader->status && !is_header) check_row(reader, row);
    reader->column = 0;
}

// Blanks belong to a field, whose readers do not agree on them elsewhere.
static int is_space(unsigned char letter) {
    (void)letter;
    return 0;
}

// What readers of CSV do not agree on; NULL: there is none of it.
static const char *oddity_of(const char *line, size_t length) {
    if (memchr(line, 0, length)) return "there is a zero byte";
    if (memchr(line, '\r', length)) return "there is a carriage return; a line must end with a newline alone";
    return length == 1 ? "the line is empty" : NULL;
}

// Line by line, so that an error knows where it is.
static ck_Status parse(Reader *reader, const char *bytes, size_t size) {
    struct csv_parser parser;
    if (csv_init(&parser, CSV_STRICT | CSV_STRICT_FINI)) return ck_fail(reader->error, CK_NO_MEMORY, "out of memory");
    csv_set_space_func(&parser, is_space);
    for (size_t at = 0; at < size && !reader->status;) {
        const char *newline = memchr(bytes + at, '\n', size - at);
        size_t length = newline ? (size_t)(newline - bytes) + 1 - at : size - at;
        reader->line++;
        const char *oddity = oddity_of(bytes + at, length);
        if (oddity)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: %s", reader->path, reader->line, oddity);
        else if (!newline)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: the line has no end: the file is cut off",
                                     reader->path, reader->line);
        else if (csv_parse(&parser, bytes + at, length, take_field, end_row, reader) != length)
            reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: column %d: %s", reader->path, reader->line,
                                     reader->column + 1, csv_strerror(csv_error(&parser)));
        at += length;
    }
    if (!reader->status && csv_fini(&parser, take_field, end_row, reader))
        reader->status = ck_fail(reader->error, CK_BAD_INPUT, "%s:%d: a quoted field has no end: the file is cut off",
                                 reader->path, reader->line);
    csv_free(&parser);
    return reader->status;
}

ck_Status ck_csv_table_read(ck_CsvTable *table, const char *directory, const ck_Layout *layout, ck_Error *error) {
    *table = (ck_CsvTable){0};
    char *path = ck_path_join(directory, layout->file);
    ck_Status status =
        path ? ck_csv_table_read_file(table, path, layout, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    free(path);
    return status;
}

ck_Status ck_csv_table_read_file(ck_CsvTable *table, const char *path, const ck_Layout *layout, ck_Error *error) {
    *table = (ck_CsvTable){.layout = layout, .column_count = ck_layout_column_count(layout)};
    table->width = table->column_count;
    char *bytes = NULL;
    size_t size;
    ck_Status status = ck_file_read(&bytes, &size, path, error);
    if (!status && !size)
        status = ck_fail(error, CK_BAD_INPUT, "%s:1: the file is empty; its first line must begin with %s", path,
                         layout->columns[0].name);
    if (!status && !(table->text = malloc(size + 1))) status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    if (!status) {
        Reader reader = {.table = table, .path = path, .free_text = table->text, .error = error};
        status = parse(&reader, bytes, size);
        // the header is no row
        table->row_count = status ? 0 : (int)(reader.count / (size_t)table->width) - 1;
    }
    free(bytes);
    return status;
}

void ck_csv_table_free(ck_CsvTable *table) {
    free(table->fields);
    free(table->text);
    *table = (ck_CsvTable){0};
}

const char *ck_csv_table_text(const ck_CsvTable *table, int row, int column) {
    return table->fields[(size_t)(row + 1) * (size_t)table->width + (size_t)column];
}

int ck_csv_table_extra(const ck_CsvTable *table, const char *name) {
    for (int i = table->column_count; i < table->width; i++)
        if (!strcmp(table->fields[i], name)) return i;
    return -1;
}

double ck_csv_table_number(const ck_CsvTable *table, int row, int column) {
    const char *text = ck_csv_table_text(table, row, column);
    return *text ? strtod(text, NULL) : NAN;
}

const char *ck_csv_text_of(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_text(table, row, ck_layout_column(table->layout, column));
}

double ck_csv_number_of(const ck_CsvTable *table, int row, const char *column) {
    return ck_csv_table_number(table, row, ck_layout_column(table->layout, column));
}
