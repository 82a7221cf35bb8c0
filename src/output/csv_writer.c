#include "csv_writer.h"

#include <assert.h>
#include <csv.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

ck_Status ck_csv_open(ck_Csv *csv, const char *directory, const ck_Layout *layout, ck_Error *error) {
    *csv = (ck_Csv){0};
    ck_Status status = ck_whole_file_open(&csv->whole, directory, layout->file, error);
    if (status) return status;
    csv->column_count = ck_layout_column_count(layout);
    for (int i = 0; i < csv->column_count; i++) ck_csv_text(csv, layout->columns[i].name);
    return CK_OK;
}

void ck_csv_begin(ck_Csv *csv, FILE *file, const ck_Layout *layout) {
    *csv = (ck_Csv){.whole.file = file, .column_count = ck_layout_column_count(layout)};
}

static void next_column(ck_Csv *csv) {
    csv->column = (csv->column + 1) % csv->column_count;
    fputc(csv->column ? ',' : '\n', csv->whole.file);
}

void ck_csv_text(ck_Csv *csv, const char *text) {
    // quotes only where they are needed: a quoted number or name is harder on scripts
    if (strpbrk(text, ",\"\r\n") || *text == ' ')
        csv_fwrite(csv->whole.file, text, strlen(text));
    else
        fputs(text, csv->whole.file);
    next_column(csv);
}

void ck_csv_number(ck_Csv *csv, double number) {
    if (!isnan(number)) fprintf(csv->whole.file, "%.17g", number);
    next_column(csv);
}

void ck_csv_count(ck_Csv *csv, uint64_t count) {
    fprintf(csv->whole.file, "%" PRIu64, count);
    next_column(csv);
}

ck_Status ck_csv_close(ck_Csv *csv, ck_Error *error) {
    assert(csv->column == 0); // a row was left unfinished
    return ck_whole_file_close(&csv->whole, error);
}

void ck_csv_discard(ck_Csv *csv) {
    ck_whole_file_discard(&csv->whole);
    *csv = (ck_Csv){0};
}
