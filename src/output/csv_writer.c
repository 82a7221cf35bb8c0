#include "csv_writer.h"

#include "files.h"

#include <assert.h>
#include <csv.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

ck_Status ck_csv_open(ck_Csv *csv, const char *directory, const ck_Layout *layout, ck_Error *error) {
    const char *name = layout->file;
    *csv = (ck_Csv){.path = ck_path_join(directory, name), .part = ck_path_part(directory, name)};
    if (!csv->path || !csv->part) return ck_fail(error, CK_NO_MEMORY, "%s/%s: out of memory", directory, name);
    csv->file = fopen(csv->part, "w");
    if (!csv->file) return ck_fail(error, CK_IO, "%s: %s", csv->part, strerror(errno));
    csv->column_count = ck_layout_column_count(layout);
    for (int i = 0; i < csv->column_count; i++) ck_csv_text(csv, layout->columns[i].name);
    return CK_OK;
}

static void next_column(ck_Csv *csv) {
    csv->column = (csv->column + 1) % csv->column_count;
    fputc(csv->column ? ',' : '\n', csv->file);
}

void ck_csv_text(ck_Csv *csv, const char *text) {
    // quotes only where they are needed: a quoted number or name is harder on scripts
    if (strpbrk(text, ",\"\r\n") || *text == ' ')
        csv_fwrite(csv->file, text, strlen(text));
    else
        fputs(text, csv->file);
    next_column(csv);
}

void ck_csv_number(ck_Csv *csv, double number) {
    if (!isnan(number)) fprintf(csv->file, "%.17g", number);
    next_column(csv);
}

void ck_csv_count(ck_Csv *csv, uint64_t count) {
    fprintf(csv->file, "%" PRIu64, count);
    next_column(csv);
}

ck_Status ck_csv_close(ck_Csv *csv, ck_Error *error) {
    assert(csv->column == 0); // a row was left unfinished
    int failed = fflush(csv->file) || ferror(csv->file) || fsync(fileno(csv->file));
    failed |= fclose(csv->file);
    csv->file = NULL;
    if (!failed) failed = rename(csv->part, csv->path);
    ck_Status status = failed ? ck_fail(error, CK_IO, "%s: %s", csv->path, strerror(errno)) : CK_OK;
    if (failed) unlink(csv->part);
    free(csv->path);
    free(csv->part);
    *csv = (ck_Csv){0};
    return status;
}

void ck_csv_discard(ck_Csv *csv) {
    if (csv->file) fclose(csv->file);
    if (csv->file) unlink(csv->part);
    free(csv->path);
    free(csv->part);
    *csv = (ck_Csv){0};
}
