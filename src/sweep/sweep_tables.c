#include "sweep.h"

#include "csv_reader.h"
#include "files.h"
#include "process.h"
#include "store.h"
#include "tables.h"
#include "text.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

// The CSVs that are being written: of each layout that any case has rows of.
typedef struct Results {
    const ck_Sweep *sweep;
    ck_WholeFile files[CK_REPORT_LAYOUTS];
    char *columns;        // what follows every row of the case at hand: its host first
    const char *but_host; // the same of study.csv, which has the host already
    ck_Error why;         // a section could not be written
} Results;

static ck_Status fail_memory(ck_Error *error) {
    return ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// A field as it stands in a CSV.
static void add_field(FILE *out, const char *text) {
    fputc(',', out);
    if (!strpbrk(text, ",\"\r\n") && *text != ' ') {
        fputs(text, out);
        return;
    }
    fputc('"', out);
    for (; *text; text++) fprintf(out, *text == '"' ? "\"\"" : "%c", *text);
    fputc('"', out);
}

// The scene that a point is of, the value of each key, and for rows but those of study.csv the host.
static bool set_columns(Results *results, int point, const char *host) {
    const ck_Sweep *sweep = results->sweep;
    const ck_StudyFile *file = sweep->options->file;
    ck_Text text;
    free(results->columns);
    results->columns = NULL;
    if (!ck_text_begin(&text)) return false;
    add_field(text.file, host);
    add_field(text.file, file->scene_count ? sweep->names[ck_sweep_scene(sweep, point)] : "");
    for (int k = 0; k < ck_sweep_key_count(file); k++) add_field(text.file, ck_sweep_value(sweep, point, k));
    if (!ck_text_end(&text)) return false;
    results->columns = text.bytes;
    // a host's name has nothing that is quoted
    results->but_host = results->columns + 1 + strlen(host);
    return true;
}

static ck_Status begin_file(Results *results, int layout, ck_Error *error) {
    const ck_Layout *of = &ck_layouts[layout];
    const ck_StudyFile *file = results->sweep->options->file;
    ck_WholeFile *whole = &results->files[layout];
    ck_Status status = ck_whole_file_open(whole, results->sweep->options->directory, of->file, error);
    if (status) return status;
    for (int i = 0; i < ck_layout_column_count(of); i++)
        fprintf(whole->file, "%s%s", i ? "," : "", of->columns[i].name);
    fprintf(whole->file, layout == CK_STUDY ? ",of_scene" : ",host,of_scene");
    for (int k = 0; k < ck_sweep_key_count(file); k++) add_field(whole->file, ck_sweep_key(file, k));
    fputc('\n', whole->file);
    return CK_OK;
}

// Rows of a case, each with its columns: a row ends with a newline that is in no quotes.
static void copy_rows(FILE *out, const char *rows, size_t size, const char *columns) {
    bool is_quoted = false;
    for (size_t at = 0; at < size;) {
        const char *newline = memchr(rows + at, '\n', size - at);
        const size_t length = newline ? (size_t)(newline - rows) - at : size - at;
        for (const char *quote = rows + at; (quote = memchr(quote, '"', (size_t)(rows + at + length - quote))); quote++)
            is_quoted = !is_quoted;
        fwrite(rows + at, 1, length, out);
        if (newline && !is_quoted) fputs(columns, out);
        if (newline) fputc('\n', out);
        at += length + 1;
    }
}

static int find_layout(const char *name, size_t length) {
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++)
        if (strlen(ck_layouts[i].file) == length && !memcmp(ck_layouts[i].file, name, length)) return i;
    return -1;
}

// Calls take for each section of a case's text. False where the text is not what a case has.
static bool visit_sections(const char *text, void *context,
                           ck_Status (*take)(void *context, int layout, const char *rows, size_t size)) {
    while (*text) {
        const char *space = strchr(text, ' '), *newline = space ? strchr(space, '\n') : NULL;
        const size_t size = newline ? (size_t)strtoull(space, NULL, 10) : 0;
        if (!size || strlen(newline + 1) < size) return false;
        const int layout = find_layout(text, (size_t)(space - text));
        if (layout < 0 || take(context, layout, newline + 1, size)) return false;
        text = newline + 1 + size;
    }
    return true;
}

// The sixth field of study.csv's row, which comes last.
static ck_Status take_host(void *context, int layout, const char *rows, size_t size) {
    char *host = context;
    if (layout != CK_STUDY) return CK_OK;
    int column = 0;
    size_t length = 0;
    bool is_quoted = false;
    for (size_t i = 0; i < size && column <= 5; i++) {
        if (rows[i] == '"') is_quoted = !is_quoted;
        if (rows[i] == ',' && !is_quoted)
            column++;
        else if (column == 5 && length < 64)
            host[length++] = rows[i];
    }
    host[length] = 0;
    return CK_OK;
}

// A case's series as OUT/series/SCENE.ENGINE.csv.gz, by the names in its first row.
static ck_Status pack_series(const Results *results, const char *rows, size_t size, ck_Error *error) {
    char name[400], *folder = ck_path_join(results->sweep->options->directory, "series");
    ck_WholeFile whole = {0};
    const int scene = (int)strcspn(rows, ","), engine = (int)strcspn(rows + scene + 1, ",");
    snprintf(name, sizeof name, "%.*s.%.*s.csv.gz", scene, rows, engine, rows + scene + 1);
    ck_Status status = folder ? ck_whole_file_open(&whole, folder, name, error) : fail_memory(error);
    const int file = status ? -1 : dup(fileno(whole.file));
    gzFile packed = file >= 0 ? gzdopen(file, "wb6") : NULL;
    const ck_Layout *layout = &ck_layouts[CK_SERIES];
    bool has_failed = !packed;
    for (int i = 0; packed && i < ck_layout_column_count(layout); i++)
        has_failed |= gzprintf(packed, "%s%s", i ? "," : "", layout->columns[i].name) <= 0;
    if (packed) {
        has_failed |= gzputs(packed, "\n") < 0 || gzwrite(packed, rows, (unsigned)size) != (int)size;
        has_failed |= gzclose(packed) != Z_OK;
    }
    if (!status && has_failed) status = ck_fail(error, CK_IO, "%s: cannot be packed: %s", name, strerror(errno));
    if (!status) status = ck_whole_file_close(&whole, error);
    ck_whole_file_discard(&whole);
    free(folder);
    return status;
}

static ck_Status take_rows(void *context, int layout, const char *rows, size_t size) {
    Results *results = context;
    if (layout == CK_SERIES && results->sweep->options->file->series == CK_SERIES_GZIP)
        return pack_series(results, rows, size, &results->why);
    if (!results->files[layout].file) {
        ck_Status status = begin_file(results, layout, &results->why);
        if (status) return status;
    }
    copy_rows(results->files[layout].file, rows, size, layout == CK_STUDY ? results->but_host : results->columns);
    return CK_OK;
}

static ck_Status add_case(Results *results, const char *text, int index, ck_Error *error) {
    char host[65] = "";
    int engine, point = ck_sweep_point(results->sweep, index, &engine);
    if (!visit_sections(text, host, take_host))
        return ck_fail(error, CK_IO, "%s: case %d is not whole", results->sweep->options->directory, index);
    if (!set_columns(results, point, host)) return fail_memory(error);
    if (!visit_sections(text, results, take_rows))
        return ck_fail(error, CK_IO, "case %d cannot be written: %s", index, results->why.message);
    return CK_OK;
}

static ck_Status add_cases(Results *results, const ck_Store *store, ck_Error *error) {
    ck_StoreFile file = {-1, -1};
    ck_Status status = CK_OK;
    for (int i = 0; i < results->sweep->case_count && !status; i++) {
        const ck_StoreEntry *entry = ck_store_find(store, results->sweep->keys[i]);
        char *text = ck_store_text(store, entry, &file, error);
        status = text ? add_case(results, text, i, error) : CK_IO;
        free(text);
        if (!status && ck_child_interrupted) status = ck_fail(error, CK_IO, "interrupted; the same command goes on");
        if (i % 1000 == 999) ck_progress_show("writing: %d of %d cases", i + 1, results->sweep->case_count);
    }
    ck_progress_clear();
    if (file.file >= 0) close(file.file);
    return status;
}

static int is_shown(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

// The facts of each host that ran a case; of several, with its name before each.
static ck_Status write_machines(const char *directory, const char *folder, ck_Error *error) {
    char *machines = ck_path_join(folder, "machines");
    struct dirent **hosts = NULL;
    const int count = machines ? scandir(machines, &hosts, is_shown, alphasort) : -1;
    ck_Csv csv = {0};
    ck_Status status = !machines || (count < 0 && errno == ENOMEM)
                           ? fail_memory(error)
                           : ck_csv_open(&csv, directory, &ck_layouts[CK_MACHINE], error);
    for (int i = 0; i < count; i++) {
        char *path = ck_path_join(machines, hosts[i]->d_name), key[520];
        ck_CsvTable table = {0};
        if (!status && !path) status = fail_memory(error);
        if (!status) status = ck_csv_table_read(&table, path, &ck_layouts[CK_MACHINE], error);
        for (int row = 0; row < table.row_count && !status; row++) {
            snprintf(key, sizeof key, "%s%s%s", count > 1 ? hosts[i]->d_name : "", count > 1 ? ": " : "",
                     ck_csv_table_text(&table, row, 0));
            ck_csv_text(&csv, key);
            ck_csv_text(&csv, ck_csv_table_text(&table, row, 1));
        }
        ck_csv_table_free(&table);
        free(path);
        free(hosts[i]);
    }
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    free(hosts);
    free(machines);
    return status;
}

static bool is_numeric(const ck_StudyAxis *axis, int key) {
    bool is = axis->value_count > 1;
    for (int i = 0; i < axis->value_count && is; i++) {
        char *end;
        const char *text = axis->values[i * axis->key_count + key];
        strtod(text, &end);
        is = end != text && !*end;
    }
    return is;
}

static void add_chart(ck_Csv *csv, const char *x, const char *metric, const char *of) {
    ck_csv_text(csv, x);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, of);
}

// What charts show where the file asks for none; NULL: there are none.
static const char *const default_charts[CK_STUDY_RUNS][2] = {
    [CK_STUDY_COMPARE] = {"position_rms", "cost"}, [CK_STUDY_PRECISION] = {"cost_to_1_percent", "floor"},
    [CK_STUDY_TUNE] = {"cpu_s", "error"},          [CK_STUDY_STABILITY] = {"critical_step_s", "predicted_step_s"},
    [CK_STUDY_REFINE] = {"sag", "stretch_max"},
};

static bool has_charts(const ck_Sweep *sweep) {
    return default_charts[sweep->options->file->run][0] != NULL;
}

// What the file asks for, or what is off against each swept number.
static ck_Status write_charts(const ck_Sweep *sweep, ck_Error *error) {
    const ck_StudyFile *file = sweep->options->file;
    ck_Csv csv = {0};
    if (!has_charts(sweep)) return CK_OK;
    ck_Status status = ck_csv_open(&csv, sweep->options->directory, &ck_layouts[CK_STUDY_CHARTS], error);
    for (int i = 0; i < file->chart_count && !status; i++)
        add_chart(&csv, file->charts[i].x, file->charts[i].metric, file->charts[i].of);
    for (int i = 0; i < file->axis_count && !file->chart_count && !status; i++)
        for (int k = 0; k < file->axes[i].key_count; k++)
            for (int m = 0; m < 2 && is_numeric(&file->axes[i], k); m++)
                add_chart(&csv, file->axes[i].keys[k], default_charts[file->run][m],
                          file->run == CK_STUDY_REFINE ? "value" : "error");
    if (!status) status = ck_csv_close(&csv, error);
    ck_csv_discard(&csv);
    return status;
}

static ck_Status check_whole(const ck_Sweep *sweep, const ck_Store *store, ck_Error *error) {
    int missing = 0;
    for (int i = 0; i < sweep->case_count; i++) missing += !ck_store_find(store, sweep->keys[i]);
    if (!missing) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "%s: %d of %d cases are missing; without --kept they are run",
                   sweep->options->directory, missing, sweep->case_count);
}

// Results of another study that was there before: two together would be neither.
static void remove_others(const Results *results, const bool *written) {
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) {
        char *path = ck_path_join(results->sweep->options->directory, ck_layouts[i].file), line[4096] = "";
        FILE *file = path && !written[i] ? fopen(path, "re") : NULL;
        const bool is_study =
            file && fgets(line, sizeof line, file) && (strstr(line, ",of_scene") || i == CK_STUDY_CHARTS);
        if (file) fclose(file);
        if (is_study) unlink(path);
        free(path);
    }
}

ck_Status ck_sweep_write(const ck_Sweep *sweep, ck_Error *error) {
    const char *directory = sweep->options->directory;
    char *folder = ck_sweep_folder(directory);
    ck_Store store = {0};
    Results results = {.sweep = sweep};
    ck_Status status = folder ? ck_store_open(&store, folder, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = check_whole(sweep, &store, error);
    if (!status) status = add_cases(&results, &store, error);
    if (!status) status = write_charts(sweep, error);
    if (!status) status = write_machines(directory, folder, error);
    bool written[CK_REPORT_LAYOUTS] = {[CK_STUDY_CHARTS] = has_charts(sweep)};
    for (int i = 0; i < CK_REPORT_LAYOUTS; i++) {
        written[i] |= results.files[i].file != NULL;
        if (results.files[i].file && !status) status = ck_whole_file_close(&results.files[i], error);
        ck_whole_file_discard(&results.files[i]);
    }
    if (!status) remove_others(&results, written);
    free(results.columns);
    ck_store_free(&store);
    free(folder);
    return status;
}

// Copies one folder's records that are not there yet.
static ck_Status merge_part(const ck_StoreWriter *writer, const ck_Store *all, const char *part, ck_Error *error) {
    char *folder = ck_sweep_folder(part);
    ck_Store store = {0};
    ck_StoreFile file = {-1, -1};
    ck_Status status = folder ? ck_store_open(&store, folder, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !store.count)
        status =
            ck_fail(error, CK_BAD_INPUT, "%s: holds no cases of a study; give a folder that --shard wrote into", part);
    for (size_t i = 0; i < store.capacity && !status; i++) {
        const ck_StoreEntry *entry = &store.entries[i];
        if (!entry->bytes || ck_store_find(all, entry->key)) continue;
        char *text = ck_store_text(&store, entry, &file, error);
        status = text ? ck_store_add(writer, entry->key, entry->cost, text, entry->bytes, error) : CK_IO;
        free(text);
    }
    if (file.file >= 0) close(file.file);
    ck_store_free(&store);
    free(folder);
    return status;
}

// The hosts' facts of a part, of hosts that are not there yet.
static ck_Status merge_machines(const char *folder, const char *part, ck_Error *error) {
    char *from = NULL, *to = ck_path_join(folder, "machines");
    if (asprintf(&from, "%s/study/machines", part) < 0) from = NULL;
    struct dirent **hosts = NULL;
    const int count = from && to ? scandir(from, &hosts, is_shown, alphasort) : -1;
    ck_Status status = CK_OK;
    for (int i = 0; i < count; i++) {
        char *source = ck_path_join(from, hosts[i]->d_name), *target = ck_path_join(to, hosts[i]->d_name);
        ck_CsvTable table = {0};
        ck_Csv csv = {0};
        if (!status && source && target) status = ck_csv_table_read(&table, source, &ck_layouts[CK_MACHINE], error);
        if (!status) status = ck_csv_open(&csv, target, &ck_layouts[CK_MACHINE], error);
        for (int row = 0; row < 2 * table.row_count && !status; row++)
            ck_csv_text(&csv, ck_csv_table_text(&table, row / 2, row % 2));
        if (!status) status = ck_csv_close(&csv, error);
        ck_csv_discard(&csv);
        ck_csv_table_free(&table);
        free(source);
        free(target);
        free(hosts[i]);
    }
    free(hosts);
    free(from);
    free(to);
    return status;
}

ck_Status ck_sweep_merge(const char *directory, char *const *parts, int part_count, ck_Error *error) {
    char *folder = ck_sweep_folder(directory);
    ck_StoreWriter writer = {.file = -1};
    ck_Status status = folder ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    const int failed = folder ? ck_path_make(folder) : 0;
    if (failed) status = ck_fail(error, CK_IO, "%s: %s", folder, strerror(failed));
    if (!status) status = ck_store_writer_open(&writer, folder, error);
    for (int i = 0; i < part_count && !status; i++) {
        ck_Store all = {0};
        status = ck_store_open(&all, folder, error);
        if (!status) status = merge_part(&writer, &all, parts[i], error);
        if (!status) status = merge_machines(folder, parts[i], error);
        ck_store_free(&all);
    }
    ck_store_writer_close(&writer);
    free(folder);
    return status;
}
