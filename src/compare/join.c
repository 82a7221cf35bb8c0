#include "join.h"

#include "csv_reader.h"
#include "files.h"
#include "tables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// A part, and its scenes in order.
typedef struct Part {
    const char *directory;
    ck_CsvTable tables[CK_COMPARISON_LAYOUTS];
    const char **scenes; // [scene_count]
    int scene_count;
} Part;

static bool has_file(const char *directory, ck_LayoutName layout) {
    char path[4096];
    return snprintf(path, sizeof path, "%s/%s", directory, ck_layouts[layout].file) < (int)sizeof path &&
           !access(path, F_OK);
}

// The machine's file gets its name last.
bool ck_join_is_part(const char *directory) {
    return has_file(directory, CK_RUNS) && has_file(directory, CK_MACHINE);
}

static ck_Status read_part(Part *part, const char *directory, ck_Error *error) {
    ck_Status status = CK_OK;
    part->directory = directory;
    for (int i = 0; i < CK_COMPARISON_LAYOUTS && !status; i++)
        status = ck_csv_table_read(&part->tables[i], directory, &ck_layouts[i], error);
    const ck_CsvTable *runs = &part->tables[CK_RUNS];
    part->scenes = calloc((size_t)runs->row_count + 1, sizeof *part->scenes);
    if (!status && !part->scenes) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int row = 0; row < runs->row_count && !status; row++) {
        const char *scene = ck_csv_table_text(runs, row, 0);
        if (!part->scene_count || strcmp(part->scenes[part->scene_count - 1], scene))
            part->scenes[part->scene_count++] = scene;
    }
    return status;
}

static ck_Status check_machines(const Part *one, const Part *other, ck_Error *error) {
    const ck_CsvTable *a = &one->tables[CK_MACHINE], *b = &other->tables[CK_MACHINE];
    for (int i = 0; i < a->row_count; i++) {
        const char *key = ck_csv_table_text(a, i, 0);
        bool is_same = ck_machine_is_of_run(key);
        for (int k = 0; k < b->row_count && !is_same; k++)
            is_same = !strcmp(ck_csv_table_text(b, k, 0), key) &&
                      !strcmp(ck_csv_table_text(b, k, 1), ck_csv_table_text(a, i, 1));
        if (!is_same)
            return ck_fail(error, CK_BAD_INPUT,
                           "%s and %s: their %s is not the same, and timings would mix: a study keeps hosts apart "
                           "(clothcheck study)",
                           one->directory, other->directory, key);
    }
    return CK_OK;
}

// Which part of how many a folder holds, as its command says.
static bool read_shard(const Part *part, int *shard, int *shards) {
    const ck_CsvTable *machine = &part->tables[CK_MACHINE];
    for (int i = 0; i < machine->row_count; i++) {
        if (strcmp(ck_csv_table_text(machine, i, 0), "command")) continue;
        const char *option = strstr(ck_csv_table_text(machine, i, 1), "--shard");
        return option && sscanf(option + strlen("--shard"), "%*[ =]%d/%d", shard, shards) == 2;
    }
    return false;
}

// All parts of one comparison, each once.
static ck_Status check_whole(const Part *parts, int count, ck_Error *error) {
    for (int i = 0; i < count; i++) {
        int shard, shards;
        if (!read_shard(&parts[i], &shard, &shards))
            return ck_fail(error, CK_BAD_INPUT, "%s: was not written by compare --shard", parts[i].directory);
        if (shards != count || shard != i + 1)
            return ck_fail(error, CK_BAD_INPUT, "%s: is part %d of %d, and stands where part %d of %d should",
                           parts[i].directory, shard, shards, i + 1, count);
    }
    return CK_OK;
}

// How many engines a part ran: the rows of its first scene, which stand together.
static int count_engines(const Part *part) {
    const ck_CsvTable *runs = &part->tables[CK_RUNS];
    int count = 0;
    while (count < runs->row_count && !strcmp(ck_csv_table_text(runs, count, 0), part->scenes[0])) count++;
    return count;
}

static ck_Status check_engines(const Part *one, const Part *other, ck_Error *error) {
    const int count = count_engines(one);
    bool is_same = count == count_engines(other);
    for (int i = 0; i < count && is_same; i++)
        is_same = !strcmp(ck_csv_text_of(&one->tables[CK_RUNS], i, "engine"),
                          ck_csv_text_of(&other->tables[CK_RUNS], i, "engine"));
    return is_same ? CK_OK
                   : ck_fail(error, CK_BAD_INPUT, "%s and %s are of other engines; give parts of one comparison",
                             one->directory, other->directory);
}

static ck_Status check_scenes(const Part *parts, int count, ck_Error *error) {
    for (int i = 0; i < count; i++)
        for (int k = 0; k < i; k++)
            for (int m = 0; m < parts[i].scene_count * parts[k].scene_count; m++)
                if (!strcmp(parts[i].scenes[m / parts[k].scene_count], parts[k].scenes[m % parts[k].scene_count]))
                    return ck_fail(error, CK_BAD_INPUT, "%s and %s both have %s; give parts of one comparison",
                                   parts[k].directory, parts[i].directory, parts[i].scenes[m / parts[k].scene_count]);
    return CK_OK;
}

static void add_scene(ck_Tables *tables, const Part *part, const char *scene) {
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++)
        for (int row = 0; row < part->tables[i].row_count && i != CK_MACHINE; row++)
            for (int k = 0; k < part->tables[i].column_count; k++)
                if (!strcmp(ck_csv_table_text(&part->tables[i], row, 0), scene))
                    ck_csv_text(&tables->csv[i], ck_csv_table_text(&part->tables[i], row, k));
}

static ck_Status copy_replay(const char *directory, const Part *part, const char *scene, ck_Error *error) {
    char *from = ck_path_join(part->directory, CK_REPLAY_DIRECTORY), *to = ck_path_join(directory, CK_REPLAY_DIRECTORY);
    char *name = ck_replay_name(scene), *source = from && name ? ck_path_join(from, name) : NULL, *bytes = NULL;
    size_t size;
    ck_WholeFile whole = {0};
    ck_Status status = source && to ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !access(source, F_OK)) {
        status = ck_file_read(&bytes, &size, source, error);
        if (!status) status = ck_whole_file_open(&whole, to, name, error);
        if (!status) fwrite(bytes, 1, size, whole.file);
        if (!status) status = ck_whole_file_close(&whole, error);
    }
    ck_whole_file_discard(&whole);
    free(bytes);
    free(source);
    free(name);
    free(to);
    free(from);
    return status;
}

static ck_Status write_all(const char *directory, const Part *parts, int count, ck_Error *error) {
    ck_Tables tables = {0};
    ck_Status status = CK_OK;
    bool is_left = true;
    for (int i = 0; i < CK_COMPARISON_LAYOUTS && !status; i++)
        status = ck_csv_open(&tables.csv[i], directory, &ck_layouts[i], error);
    for (int place = 0; is_left && !status; place++) {
        is_left = false;
        for (int i = 0; i < count && !status; i++) {
            if (place >= parts[i].scene_count) continue;
            is_left = true;
            add_scene(&tables, &parts[i], parts[i].scenes[place]);
            status = copy_replay(directory, &parts[i], parts[i].scenes[place], error);
        }
    }
    if (!status) status = ck_tables_close(&tables, error);
    ck_tables_discard(&tables);
    return status;
}

ck_Status ck_join(const char *directory, char *const *parts, int part_count, ck_Error *error) {
    Part *read = calloc((size_t)part_count + 1, sizeof *read);
    ck_Status status = read ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    int count = 0;
    for (; count < part_count && !status; count++) {
        status = read_part(&read[count], parts[count], error);
        if (!status && count) status = check_machines(&read[0], &read[count], error);
        if (!status && count) status = check_engines(&read[0], &read[count], error);
    }
    if (!status) status = check_scenes(read, part_count, error);
    if (!status) status = check_whole(read, part_count, error);
    if (!status) status = write_all(directory, read, part_count, error);
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < CK_COMPARISON_LAYOUTS; k++) ck_csv_table_free(&read[i].tables[k]);
        free(read[i].scenes);
    }
    free(read);
    return status;
}
