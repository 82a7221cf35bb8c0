// The CSVs that reports and studies read: the first byte chooses which.
#include "fuzz.h"

#include "csv_reader.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40];
    ck_CsvTable table;
    if (!size) return 0;
    const ck_Layout *layout = &ck_layouts[*data % CK_LAYOUT_COUNT];
    const int file = fuzz_file(path, data + 1, size - 1);
    if (!ck_csv_table_read_file(&table, path, layout, NULL))
        for (int row = 0; row < table.row_count; row++)
            for (int i = 0; i < ck_layout_column_count(layout); i++) {
                if (layout->columns[i].kind == CK_COLUMN_NUMBER) (void)ck_csv_table_number(&table, row, i);
                if (layout->columns[i].kind == CK_COLUMN_NAME && !*ck_csv_table_text(&table, row, i)) abort();
            }
    ck_csv_table_free(&table);
    close(file);
    return 0;
}
