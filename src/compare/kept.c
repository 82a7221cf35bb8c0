#include "tables.h"

#include "csv_reader.h"

#include <string.h>

static bool has_scene(const ck_Kept *kept, const char *name) {
    for (int i = 0; i < kept->count; i++)
        if (!strcmp(kept->comparisons[i].model.name, name)) return true;
    return false;
}

static bool has_engine(const ck_Kept *kept, const char *name) {
    for (int i = 0; i < kept->options->engine_count; i++)
        if (!strcmp(kept->options->engines[i]->name, name)) return true;
    return false;
}

// Whether a row is of what will be written anew; else it may stay where others are kept. A truth is written with any
// engine of its scene.
static bool is_again(const ck_Kept *kept, const ck_CsvTable *table, int row) {
    if (!has_scene(kept, ck_csv_table_text(table, row, 0))) return false;
    bool is_again = !kept->by_engine;
    for (int i = 0; i < table->column_count && !is_again; i++) {
        const char *column = table->layout->columns[i].name, *engine = ck_csv_table_text(table, row, i);
        bool is_engine = !strcmp(column, "engine") || !strcmp(column, "other_engine");
        is_again = is_engine && (has_engine(kept, engine) || !strcmp(engine, "truth"));
    }
    return is_again;
}

// As ck_csv_table_read, but a file that is not there has no rows.
static ck_Status read_table(ck_CsvTable *table, const char *directory, const ck_Layout *layout, ck_Error *error) {
    ck_Error why = {0};
    ck_Status status = ck_csv_table_read(table, directory, layout, &why);
    if (!status || status == CK_IO) return CK_OK;
    return ck_fail(error, status, "%s%s", why.message,
                   status == CK_BAD_INPUT ? "; --force replaces what is there, another --out leaves it" : "");
}

static ck_Status check_lost(const ck_Kept *kept, const ck_Layout *layout, bool keeps_others, ck_Error *error) {
    ck_CsvTable table;
    ck_Status status = read_table(&table, kept->directory, layout, error);
    if (!status && table.width > table.column_count)
        status =
            ck_fail(error, CK_BAD_INPUT, "%s/%s: holds results of a study, which would be lost; give another --out",
                    kept->directory, layout->file);
    for (int i = 0; i < table.row_count && !status; i++) {
        const char *scene = ck_csv_table_text(&table, i, 0), *engine = ck_csv_text_of(&table, i, "engine");
        // a truth is found again with its scene
        if (has_scene(kept, scene) && (has_engine(kept, engine) || !strcmp(engine, "truth"))) continue;
        bool can_stay = !is_again(kept, &table, i);
        if (can_stay && keeps_others) continue;
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s/%s: holds results of %s by %s, which would be lost; %s--force replaces what is there, "
                         "another --out leaves it",
                         kept->directory, layout->file, scene, engine, can_stay ? "--append keeps them, " : "");
    }
    ck_csv_table_free(&table);
    return status;
}

typedef struct MachineCheck {
    ck_CsvTable there;
    const char *directory;
    ck_Status status;
    ck_Error *error;
} MachineCheck;

static void check_fact(void *context, const char *key, const char *value) {
    MachineCheck *check = context;
    bool is_same = false;
    for (int i = 0; i < check->there.row_count && !is_same; i++)
        is_same = !strcmp(ck_csv_table_text(&check->there, i, 0), key) &&
                  !strcmp(ck_csv_table_text(&check->there, i, 1), value);
    if (is_same || check->status) return;
    check->status = ck_fail(check->error, CK_BAD_INPUT,
                            "%s/%s: its %s is not '%s' as now, and timings would mix; give another --out",
                            check->directory, ck_layouts[CK_MACHINE].file, key, value);
}

// Timings of two machines, or of two builds, do not go into one table.
static ck_Status check_machine(const ck_Kept *kept, ck_Error *error) {
    MachineCheck check = {.directory = kept->directory, .error = error};
    check.status = read_table(&check.there, kept->directory, &ck_layouts[CK_MACHINE], error);
    if (!check.status && check.there.row_count) ck_machine_tell(check_fact, &check);
    ck_csv_table_free(&check.there);
    return check.status;
}

ck_Status ck_kept_check(const ck_Kept *kept, const ck_Layout *layout, bool keeps_others, ck_Error *error) {
    ck_Status status = check_lost(kept, layout, keeps_others, error);
    return status || !keeps_others ? status : check_machine(kept, error);
}

ck_Status ck_kept_copy(const ck_Kept *kept, ck_Csv *csv, const ck_Layout *layout, ck_Error *error) {
    ck_CsvTable table;
    ck_Status status = read_table(&table, kept->directory, layout, error);
    for (int row = 0; row < table.row_count && !status; row++)
        for (int i = 0; i < table.column_count && !is_again(kept, &table, row); i++)
            ck_csv_text(csv, ck_csv_table_text(&table, row, i));
    ck_csv_table_free(&table);
    return status;
}
