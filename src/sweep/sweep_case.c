#include "sweep.h"

#include "change.h"
#include "files.h"
#include "layout.h"
#include "names.h"
#include "process.h"
#include "provenance.h"
#include "tables.h"
#include "text.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// What a case comes to: its own row of study.csv, and rows of others.
typedef struct Case {
    const ck_Sweep *sweep;
    int index, point, engine;
    char word[CK_SWEEP_WORD], scene[256]; // the scene's name
    const char *status;
    char reason[600], command[CK_SWEEP_WORD + 512];
    double start; // of ck_wall
    FILE *out;    // to its text
} Case;

const char *ck_host(void) {
    static char host[65];
    if (!*host && (gethostname(host, sizeof host - 1) || !*host)) strcpy(host, "unknown");
    for (char *letter = host; *letter; letter++)
        if (!isalnum((unsigned char)*letter)) *letter = '_';
    return host;
}

static void take_processor(void *context, const char *key, const char *value) {
    if (!strcmp(key, "processor")) snprintf(context, 256, "%s", value);
}

const char *ck_processor(void) {
    static char name[256];
    if (!*name) ck_machine_tell(take_processor, name);
    return name;
}

static void add_section(FILE *out, const char *file, const char *rows, size_t size) {
    if (!size) return;
    fprintf(out, "%s %zu\n", file, size);
    fwrite(rows, 1, size, out);
}

static const char *engine_name(const Case *one) {
    if (one->engine < 0) return "truth";
    return one->sweep->is_by_engine ? one->sweep->options->compare->engines[one->engine]->name : "all";
}

// False when out of memory.
static bool add_own_row(const Case *one) {
    ck_Text row;
    ck_Csv csv;
    if (!ck_text_begin(&row)) return false;
    ck_csv_begin(&csv, row.file, &ck_layouts[CK_STUDY]);
    ck_csv_text(&csv, one->scene);
    ck_csv_text(&csv, engine_name(one));
    ck_csv_text(&csv, one->status);
    ck_csv_text(&csv, one->reason);
    ck_csv_number(&csv, ck_wall() - one->start);
    ck_csv_text(&csv, ck_host());
    ck_csv_text(&csv, ck_processor());
    ck_csv_text(&csv, ck_machine_build());
    ck_csv_count(&csv, one->sweep->options->compare->seed);
    ck_csv_text(&csv, one->command);
    if (!ck_text_end(&row)) return false;
    add_section(one->out, ck_layouts[CK_STUDY].file, row.bytes, row.size);
    free(row.bytes);
    return true;
}

// Says that a case could not be run, which is a result. What a command of ours said is told without its own name.
static void refuse(Case *one, const char *reason) {
    const char *said = strstr(reason, "clothcheck: ");
    if (said) reason = said + strlen("clothcheck: ");
    one->status = ck_run_status_names[CK_RUN_REFUSED];
    snprintf(one->reason, sizeof one->reason, "%s", reason);
    ck_text_plain(one->reason);
    for (char *letter = one->reason; *letter; letter++)
        if (*letter == '\n') *letter = ' ';
}

// Why a truth is not to be had: OUT/study/none/KEY.
static char *none_folder(const Case *one) {
    char *study = ck_sweep_folder(one->sweep->options->directory), *folder = study ? ck_path_join(study, "none") : NULL;
    free(study);
    return folder;
}

static ck_Status keep_none(const Case *one, const char *kind, ck_Error *error) {
    char name[40], *folder = none_folder(one);
    ck_WholeFile whole = {0};
    snprintf(name, sizeof name, "%016llx", (unsigned long long)one->sweep->keys[one->index]);
    ck_Status status =
        folder ? ck_whole_file_open(&whole, folder, name, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) fputs(kind, whole.file);
    if (!status) status = ck_whole_file_close(&whole, error);
    ck_whole_file_discard(&whole);
    free(folder);
    return status;
}

static char *none_path(const Case *one, int truth) {
    char *folder = none_folder(one), *path = NULL;
    if (folder && asprintf(&path, "%s/%016llx", folder, (unsigned long long)one->sweep->keys[truth]) < 0) path = NULL;
    free(folder);
    return path;
}

static ck_Status run_truth(Case *one, ck_Comparison *comparison, const char *cache, ck_Error *error) {
    const ck_CompareOptions *options = one->sweep->options->compare;
    ck_Status status = ck_truth_create(&comparison->truth, &comparison->model, cache, &options->limits, error);
    if (status) return status;
    snprintf(one->reason, sizeof one->reason, "%s", comparison->truth.kind);
    if (comparison->truth.path_count || !comparison->truth.form) return CK_OK;
    refuse(one, comparison->truth.kind);
    return keep_none(one, comparison->truth.kind, error);
}

// The truth that its own case has found, or why there is none.
static ck_Status take_truth(const Case *one, ck_Comparison *comparison, const char *cache, ck_Error *error) {
    const int truth = one->sweep->truth_of[one->point];
    char *path = truth >= 0 ? none_path(one, truth) : NULL, *kind = NULL;
    size_t size;
    ck_Status status = CK_OK;
    if (path && !access(path, F_OK)) {
        status = ck_file_read(&kind, &size, path, error);
        if (!status) status = ck_truth_without(&comparison->truth, &comparison->model, kind, error);
    } else
        status = ck_truth_create(&comparison->truth, &comparison->model, cache, &one->sweep->options->compare->limits,
                                 error);
    free(kind);
    free(path);
    return status;
}

static ck_Status add_rows(const Case *one, const ck_Comparison *comparison, const ck_CompareOptions *options,
                          ck_Error *error) {
    char *rows[CK_COMPARISON_LAYOUTS];
    const ck_StudySeries series = one->sweep->options->file->series;
    // the truth of a point stands beside its first engine
    const ck_SeriesRows wanted = series == CK_SERIES_NONE ? CK_SERIES_ROWS_NONE
                                 : one->engine            ? CK_SERIES_ROWS_ENGINES
                                                          : CK_SERIES_ROWS_ALL;
    ck_Status status = ck_tables_text(rows, comparison, options, wanted, error);
    for (int i = 0; i < CK_COMPARISON_LAYOUTS; i++) {
        if (!status && rows[i]) add_section(one->out, ck_layouts[i].file, rows[i], strlen(rows[i]));
        free(rows[i]);
    }
    return status;
}

// One engine on one scene, as compare runs it.
static ck_Status run_engine(Case *one, ck_Comparison *comparison, const char *cache, ck_Error *error) {
    ck_CompareOptions options = *one->sweep->options->compare;
    const ck_Engine *engines[] = {options.engines[one->engine]};
    options.engines = engines;
    options.engine_count = 1;
    options.jobs = 1;
    options.cache = cache;
    // its rows would come and go with the machine's speed
    options.consistency_budget = 0;
    ck_Status status = take_truth(one, comparison, cache, error);
    if (!status) status = ck_comparison_run(comparison, &options, error);
    if (status) return status;
    one->status = ck_run_status_names[comparison->runs[0].status];
    snprintf(one->reason, sizeof one->reason, "%s", comparison->runs[0].reason);
    return add_rows(one, comparison, &options, error);
}

static ck_Status run_compare(Case *one, ck_Error *error) {
    ck_Comparison comparison;
    ck_Error why = {0};
    char *cache = ck_path_join(one->sweep->options->directory, "truths"), path[CK_SWEEP_WORD];
    ck_Status status =
        cache ? ck_comparison_load(&comparison, one->word, &why) : ck_fail(&why, CK_NO_MEMORY, "out of memory");
    ck_text_shell(path, sizeof path, one->word);
    if (one->engine >= 0) {
        const ck_Outside *outside = one->sweep->options->compare->engines[one->engine]->outside;
        snprintf(one->command, sizeof one->command, "clothcheck run %s %s%s", path, outside ? "" : "--engine ",
                 outside ? outside->arguments : engine_name(one));
    }
    if (cache && !status) {
        snprintf(one->scene, sizeof one->scene, "%s", comparison.model.name);
        status = one->engine < 0 ? run_truth(one, &comparison, cache, &why) : run_engine(one, &comparison, cache, &why);
    }
    if (cache) ck_comparison_free(&comparison);
    free(cache);
    if (status != CK_BAD_INPUT) return status ? ck_fail(error, status, "%s", why.message) : CK_OK;
    refuse(one, why.message);
    return CK_OK;
}

// What each command writes.
static const ck_LayoutName written[CK_STUDY_RUNS][3] = {
    [CK_STUDY_PRECISION] = {CK_PRECISION, CK_PRECISION_SUMMARY},
    [CK_STUDY_STABILITY] = {CK_STABILITY},
    [CK_STUDY_TUNE] = {CK_TUNE},
    [CK_STUDY_NEEDS] = {CK_NEEDS},
    [CK_STUDY_REFINE] = {CK_REFINE, CK_REFINE_SUMMARY},
    [CK_STUDY_CONFORM] = {CK_CONFORM},
};

#define MOST_WORDS 200

typedef struct Line {
    ck_SweepCommand *command;
    char *words[MOST_WORDS];
    int count, most_result; // exit statuses up to that are fine
} Line;

static void run_line(void *context) {
    Line *line = context;
    const int result = line->command(line->count, line->words);
    fflush(NULL);
    // where a check failed the CSV says so
    if (result > line->most_result) _exit(result);
}

// Adds a word to what is run, and to the command that repeats it.
//   typed  in its place there; NULL: the word, quoted; "": nothing
static void add_word(Line *line, Case *one, char *word, const char *typed) {
    const size_t used = strlen(one->command), size = sizeof one->command;
    line->words[line->count++] = word;
    if (used + 2 >= size || (typed && !*typed)) return;
    one->command[used] = ' ';
    one->command[used + 1] = 0;
    if (typed)
        snprintf(one->command + used + 1, size - used - 1, "%s", typed);
    else
        ck_text_shell(one->command + used + 1, size - used - 1, word);
}

// A command line of the case, but for where to. Engines come first: some options are of the one that is asked for.
static bool make_line(Line *line, Case *one) {
    const ck_SweepOptions *options = one->sweep->options;
    const ck_StudyFile *file = options->file;
    if (2 * options->compare->engine_count + file->option_count + options->word_count + 12 > MOST_WORDS) return false;
    *line = (Line){.command = options->command, .most_result = file->run == CK_STUDY_CONFORM};
    snprintf(one->command, sizeof one->command, "clothcheck");
    add_word(line, one, (char *)ck_study_runs[file->run], NULL);
    for (int i = 0; i < options->compare->engine_count; i++) {
        if (one->sweep->is_by_engine && i != one->engine) continue;
        // one from outside is told by its own words, and here known by its name
        const ck_Outside *outside = options->compare->engines[i]->outside;
        add_word(line, one, "-e", outside ? "" : NULL);
        add_word(line, one, (char *)options->compare->engines[i]->name, outside ? outside->arguments : NULL);
    }
    for (int i = 0; i < file->option_count; i++) add_word(line, one, file->options[i], NULL);
    for (int i = 0; i < options->word_count; i++) add_word(line, one, options->words[i], NULL);
    if (*one->word) add_word(line, one, one->word, NULL);
    add_word(line, one, "--jobs", "");
    add_word(line, one, "1", "");
    if (file->run != CK_STUDY_CONFORM) add_word(line, one, "--force", "");
    return true;
}

// Rows of a CSV without its header. False where it is not there.
static bool add_file(const Case *one, const char *directory, const ck_Layout *layout) {
    char *path = ck_path_join(directory, layout->file), *text = NULL;
    size_t size;
    const bool is_there = path && !access(path, F_OK) && !ck_file_read(&text, &size, path, NULL);
    const char *rows = is_there ? strchr(text, '\n') : NULL;
    if (rows) add_section(one->out, layout->file, rows + 1, size - (size_t)(rows + 1 - text));
    free(text);
    free(path);
    return rows != NULL;
}

// Any other command, in a child, with a folder of its own.
static ck_Status run_command(Case *one, ck_Error *error) {
    const ck_SweepOptions *options = one->sweep->options;
    char *folder = ck_sweep_folder(options->directory), *work = NULL;
    Line line;
    ck_ChildResult child = {0};
    ck_Scene scene = {0};
    ck_Status status = CK_OK;
    if (!folder || asprintf(&work, "%s/%s.%d.work", folder, ck_host(), (int)getpid()) < 0) work = NULL;
    if (!work || !make_line(&line, one)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        line.words[line.count++] = "--out";
        line.words[line.count++] = work;
        const ck_Limits limits = {.seconds = options->case_limit};
        status = ck_child_run(&child, run_line, &line, &limits, error);
    }
    // its name is what its own CSVs say
    if (!status && *one->word && !ck_scene_load(&scene, one->word, NULL))
        snprintf(one->scene, sizeof one->scene, "%s", scene.file->name);
    ck_scene_free(&scene);
    if (!status && child.end != CK_CHILD_DONE) refuse(one, child.reason);
    for (int i = 0; i < 3 && !status && child.end == CK_CHILD_DONE; i++) {
        const ck_LayoutName layout = written[options->file->run][i];
        if (layout && !add_file(one, work, &ck_layouts[layout])) refuse(one, "it wrote no result");
    }
    if (work) ck_path_remove(work);
    free(work);
    free(folder);
    return status;
}

ck_Status ck_sweep_case(const ck_Sweep *sweep, int index, char **text, size_t *size, ck_Error *error) {
    Case *one = calloc(1, sizeof *one);
    *text = NULL;
    if (!one) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    one->sweep = sweep;
    one->index = index;
    one->point = ck_sweep_point(sweep, index, &one->engine);
    one->status = ck_run_status_names[CK_RUN_OK];
    one->start = ck_wall();
    snprintf(one->reason, sizeof one->reason, "finished");
    ck_sweep_word(sweep, one->point, one->word);
    snprintf(one->scene, sizeof one->scene, "%.250s", *one->word ? one->word : "none");
    ck_Text own;
    const bool is_begun = ck_text_begin(&own);
    one->out = own.file;
    ck_Status status = is_begun ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status)
        status = sweep->options->file->run == CK_STUDY_COMPARE ? run_compare(one, error) : run_command(one, error);
    bool has_row = status || add_own_row(one);
    if (!(ck_text_end(&own) && has_row) && !status) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    *text = own.bytes;
    *size = own.size;
    free(one);
    return status;
}
