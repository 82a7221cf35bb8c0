// CSV files as they are read: only whole files of their layout, and an error says where they are not.
#include "fixture.h"

#include "csv_reader.h"
#include "csv_writer.h"

#include <unistd.h>

#define HEADER "scene,engine,status,metric,value,band\n"

static char directory[] = "/tmp/clothcheck-csv-XXXXXX", path[100];

static int make_directory(void **state) {
    (void)state;
    if (!mkdtemp(directory)) return -1;
    snprintf(path, sizeof path, "%s/metrics.csv", directory);
    return 0;
}

static int remove_directory(void **state) {
    (void)state;
    unlink(path);
    return rmdir(directory);
}

static ck_Status read_text(ck_CsvTable *table, const char *text, size_t size, ck_Error *error) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    fwrite(text, 1, size, file);
    fclose(file);
    return ck_csv_table_read(table, directory, &ck_layouts[CK_BASELINE], error);
}

static void test_bad_files(void **state) {
    (void)state;
    static const struct {
        const char *text, *wanted;
    } cases[] = {
        {"", "metrics.csv:1: the file is empty; its first line must begin with scene"},
        {"scene,engine,status,metric,value\n", "metrics.csv:1: 5 columns where there must be 6"},
        {"scene,engine,state,metric,value,band\n", "metrics.csv:1: column 3 is 'state' where it must be status"},
        {HEADER "a,b,ok,sag,1\n", "metrics.csv:2: 5 columns where there must be 6"},
        {HEADER "a,b,ok,sag,1,2,3\n", "metrics.csv:2: 7 columns"},
        {HEADER "a,b,ok,sag,high,1\n", "metrics.csv:2: column 5 (value): must be a number or empty, not 'high'"},
        {HEADER "a,b,ok,sag,1e,1\n", "metrics.csv:2: column 5 (value): must be a number"},
        {HEADER "a,b,ok,sag,1,1\n,b,ok,sag,1,1\n", "metrics.csv:3: column 1 (scene): must not be empty"},
        {HEADER "a,b,fine,sag,1,1\n", "metrics.csv:2: column 3 (status): must be what a run can end in"},
        {HEADER "a,b,ok,sag,1,1\na,b,ok,sag,1", "metrics.csv:3: the line has no end: the file is cut off"},
        {HEADER "a,b,ok,\"sag,1,1\n", "metrics.csv:2: a quoted field has no end: the file is cut off"},
        {HEADER "a,b\"c,ok,sag,1,1\n", "metrics.csv:2: column 2: "},
        {"\n", "metrics.csv:1: the line is empty"},
        {HEADER "\na,b,ok,sag,1,1\n", "metrics.csv:2: the line is empty"},
        {HEADER "a,b,ok,sag,1,1\r\n", "metrics.csv:2: there is a carriage return"},
        {HEADER "a,b,ok,sag,0x10,1\n", "metrics.csv:2: column 5 (value): must be a number"},
        {HEADER "a,b,ok,sag, 1,1\n", "metrics.csv:2: column 5 (value): must be a number"},
        {HEADER "a,b,ok,sag,nan,1\n", "metrics.csv:2: column 5 (value): must be a number"},
        {"PK\003\004 no table\n", "metrics.csv:1: column 1 is 'PK"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_CsvTable table;
        ck_Error error = {0};
        ck_Status status = read_text(&table, cases[i].text, strlen(cases[i].text), &error);
        if (status != CK_BAD_INPUT || !strstr(error.message, cases[i].wanted))
            fail_msg("case %zu: status %d, %s", i, status, error.message);
        assert_int_equal(table.row_count, 0);
        ck_csv_table_free(&table);
    }
}

// A file cut off anywhere is never taken for a whole one with other numbers in it.
static void test_cut_off(void **state) {
    (void)state;
    const char text[] = HEADER "a,b,ok,sag,1.25,0.5\n\"c,d\",e,diverged,,,\n";
    for (size_t size = 0; size < sizeof text - 1; size++) {
        ck_CsvTable table;
        ck_Status status = read_text(&table, text, size, NULL);
        bool ends_in_line = size > 0 && text[size - 1] == '\n';
        assert_int_equal(status, ends_in_line ? CK_OK : CK_BAD_INPUT);
        ck_csv_table_free(&table);
    }
}

static void test_missing(void **state) {
    (void)state;
    ck_CsvTable table;
    ck_Error error = {0};
    assert_int_equal(ck_csv_table_read(&table, directory, &ck_layouts[CK_RUNS], &error), CK_IO);
    assert_non_null(strstr(error.message, "runs.csv: No such file"));
    ck_csv_table_free(&table);
}

// What was written is read back the same, to the last bit, with commas, quotes and newlines in texts.
static void test_round_trip(void **state) {
    (void)state;
    static const double numbers[] = {0.1, -0.0, 1e-320, 1.7976931348623157e308, INFINITY, -INFINITY, NAN, 1.0 / 3};
    static const char *const texts[] = {"plain", "a, b", "say \"no\"", "two\nlines"};
    ck_Csv csv;
    assert_int_equal(ck_csv_open(&csv, directory, &ck_layouts[CK_BASELINE], NULL), CK_OK);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        ck_csv_text(&csv, texts[i % 4]);
        ck_csv_text(&csv, "engine");
        ck_csv_text(&csv, "ok");
        ck_csv_text(&csv, "");
        ck_csv_number(&csv, numbers[i]);
        ck_csv_count(&csv, i);
    }
    assert_int_equal(ck_csv_close(&csv, NULL), CK_OK);
    ck_CsvTable table;
    ck_Error error = {0};
    if (ck_csv_table_read(&table, directory, &ck_layouts[CK_BASELINE], &error)) fail_msg("%s", error.message);
    assert_int_equal(table.row_count, sizeof numbers / sizeof *numbers);
    for (int i = 0; i < table.row_count; i++) {
        double number = ck_csv_table_number(&table, i, 4);
        assert_string_equal(ck_csv_table_text(&table, i, 0), texts[i % 4]);
        assert_true(isnan(numbers[i]) ? isnan(number) : memcmp(&number, &numbers[i], sizeof number) == 0);
        assert_true(ck_csv_table_number(&table, i, 5) == i);
    }
    ck_csv_table_free(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_cut_off),
        cmocka_unit_test(test_missing),
        cmocka_unit_test(test_round_trip),
    };
    return cmocka_run_group_tests(tests, make_directory, remove_directory);
}
