#include "sweep.h"

#include "change.h"
#include "files.h"
#include "process.h"
#include "tables.h"
#include "time_scale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

// With more points than that each is loaded only where it is run.
#define MOST_CHECKED 3000
// And of an axis with more values so many, which lie evenly.
#define MOST_VALUES 64

// Whether each engine of a point is a case of its own: what compares engines with each other needs them together.
static const bool is_by_engine[CK_STUDY_RUNS] = {[CK_STUDY_COMPARE] = true,
                                                 [CK_STUDY_STABILITY] = true,
                                                 [CK_STUDY_TUNE] = true,
                                                 [CK_STUDY_NEEDS] = true,
                                                 [CK_STUDY_CONFORM] = true};

static uint64_t hash_text(uint64_t value, const char *text) {
    return ck_hash(value, text ? text : "", text ? strlen(text) + 1 : 1);
}

int ck_sweep_key_count(const ck_StudyFile *file) {
    int count = 0;
    for (int i = 0; i < file->axis_count; i++) count += file->axes[i].key_count;
    return count;
}

// The axis of a key, and its number there.
static int axis_of(const ck_StudyFile *file, int key, int *inner) {
    int axis = 0;
    while (key >= file->axes[axis].key_count) key -= file->axes[axis++].key_count;
    *inner = key;
    return axis;
}

const char *ck_sweep_key(const ck_StudyFile *file, int key) {
    int inner, axis = axis_of(file, key, &inner);
    return file->axes[axis].keys[inner];
}

int ck_sweep_scene(const ck_Sweep *sweep, int point) {
    for (int i = 0; i < sweep->options->file->axis_count; i++) point /= sweep->options->file->axes[i].value_count;
    return point;
}

// The number of an axis's value at a point: the last axis changes first.
static int index_on(const ck_StudyFile *file, int point, int axis) {
    for (int i = file->axis_count - 1; i > axis; i--) point /= file->axes[i].value_count;
    return point % file->axes[axis].value_count;
}

const char *ck_sweep_value(const ck_Sweep *sweep, int point, int key) {
    const ck_StudyFile *file = sweep->options->file;
    int inner, axis = axis_of(file, key, &inner);
    const ck_StudyAxis *at = &file->axes[axis];
    return at->values[index_on(file, point, axis) * at->key_count + inner];
}

// Adds the changes of an axis's value to a word.
static size_t add_changes(char *word, size_t used, const ck_StudyAxis *axis, int value) {
    for (int k = 0; k < axis->key_count && used < CK_SWEEP_WORD; k++)
        used += (size_t)snprintf(word + used, CK_SWEEP_WORD - used, "@%s=%s", axis->keys[k],
                                 axis->values[value * axis->key_count + k]);
    return used;
}

void ck_sweep_word(const ck_Sweep *sweep, int point, char word[CK_SWEEP_WORD]) {
    const ck_StudyFile *file = sweep->options->file;
    *word = 0;
    if (!file->scene_count) return;
    const int scene = ck_sweep_scene(sweep, point);
    size_t used = (size_t)snprintf(word, CK_SWEEP_WORD, "%s", sweep->options->paths[scene]);
    // names tell what is swept, and not what is the same everywhere
    if (file->settings && used < CK_SWEEP_WORD)
        used += (size_t)snprintf(word + used, CK_SWEEP_WORD - used, "%s@name=%s", file->settings, sweep->names[scene]);
    for (int i = 0; i < file->axis_count && used < CK_SWEEP_WORD; i++)
        used = add_changes(word, used, &file->axes[i], index_on(file, point, i));
}

void ck_sweep_name(const ck_Sweep *sweep, int point, char name[CK_SWEEP_NAME]) {
    char changes[CK_SWEEP_WORD], suffix[CK_SCENE_SUFFIX];
    size_t used = 0;
    const ck_StudyFile *file = sweep->options->file;
    *changes = 0;
    for (int i = 0; i < file->axis_count && used < sizeof changes; i++)
        used = add_changes(changes, used, &file->axes[i], index_on(file, point, i));
    ck_change_name(suffix, sizeof suffix, changes);
    snprintf(name, CK_SWEEP_NAME, "%.79s%s", file->scene_count ? sweep->names[ck_sweep_scene(sweep, point)] : "none",
             suffix);
}

int ck_sweep_point(const ck_Sweep *sweep, int index, int *engine) {
    *engine = -1;
    if (index < sweep->truth_count) return sweep->truth_at[index];
    *engine = (index - sweep->truth_count) % sweep->engine_count;
    return (index - sweep->truth_count) / sweep->engine_count;
}

char *ck_sweep_folder(const char *directory) {
    return ck_path_join(directory, "study");
}

// Loads a scene with changes, as a check, and hashes it with the files that it names.
static ck_Status check_word(const char *word, uint64_t *hash, bool *solves, char **name, ck_Error *error) {
    ck_Comparison comparison;
    ck_Status status = ck_comparison_load(&comparison, word, error);
    if (!status) {
        const ck_TruthForm *form = comparison.model.truth ? ck_truth_form_find(comparison.model.truth) : NULL;
        if (solves) *solves = form && form->solve;
        *hash =
            ck_hash(ck_model_hash(&comparison.model), comparison.scene.document.text, comparison.scene.document.length);
        if (name) *name = strdup(comparison.model.name);
        if (name && !*name) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    ck_comparison_free(&comparison);
    return status;
}

static bool names_file(const char *key, const char *value) {
    const size_t length = strlen(key);
    return !strcmp(key, "file") || (length > 5 && !strcmp(key + length - 5, ".file")) || strstr(value, "file:");
}

// One key after the other at its values, the others as the scene has them: what a file holds belongs to the case.
static ck_Status check_axes(ck_Sweep *sweep, int scene, ck_Error *error) {
    const ck_StudyFile *file = sweep->options->file;
    char word[CK_SWEEP_WORD];
    ck_Status status = CK_OK;
    for (int i = 0; i < file->axis_count && !status; i++) {
        const ck_StudyAxis *axis = &file->axes[i];
        bool has_file = false;
        for (int k = 0; k < axis->key_count * axis->value_count; k++)
            has_file |= names_file(axis->keys[k % axis->key_count], axis->values[k]);
        const int stride = has_file || axis->value_count <= MOST_VALUES ? 1 : axis->value_count / MOST_VALUES;
        // with few points each is loaded as a whole: there keys may need one another
        if (!has_file && sweep->point_count <= MOST_CHECKED) continue;
        for (int value = 0; value < axis->value_count && !status; value += stride) {
            uint64_t hash = 0;
            size_t used = (size_t)snprintf(word, sizeof word, "%s", sweep->options->paths[scene]);
            used = add_changes(word, used, axis, value);
            status = check_word(word, &hash, NULL, NULL, error);
            if (has_file) sweep->scene_hashes[scene] = ck_hash(sweep->scene_hashes[scene], &hash, sizeof hash);
        }
    }
    return status;
}

// Springs, frames, and the substeps that stiffness asks for; and a hash of what a truth depends on, files and all.
static ck_Status find_work(const char *word, double *work, uint64_t *hash, ck_Error *error) {
    ck_Scene scene;
    ck_Model model = {0};
    double frequency = 0;
    ck_Status status = ck_scene_load(&scene, word, error);
    if (!status) status = ck_engines_check(&scene, error);
    if (!status) status = ck_model_build(&model, &scene, error);
    ck_Error why = {0};
    if (!status && !model.starts_settled) status = ck_truth_check(&model, &why);
    if (*why.message) ck_fail(error, status, "%s: %s", word, why.message);
    if (!status) ck_stability_frequency(&model, &frequency);
    if (!status) *hash = hash_text(ck_model_hash(&model), model.truth);
    if (!status) *work = (model.spring_count + 1.0) * model.frame_count * fmax(1, frequency * model.step);
    ck_model_free(&model);
    ck_scene_free(&scene);
    return status;
}

// A point and what it is sorted by.
typedef struct PointKey {
    uint64_t hash;
    int point;
} PointKey;

static int compare_keys(const void *a, const void *b) {
    const PointKey *one = a, *other = b;
    if (one->hash != other->hash) return one->hash < other->hash ? -1 : 1;
    return one->point - other->point;
}

// The form of a point's truth is solved, not told: by the scene's, or the value of a swept one.
static bool is_solved(const ck_Sweep *sweep, int point, const bool *solves) {
    for (int k = 0; k < ck_sweep_key_count(sweep->options->file); k++) {
        if (strcmp(ck_sweep_key(sweep->options->file, k), "truth")) continue;
        const ck_TruthForm *form = ck_truth_form_find(ck_sweep_value(sweep, point, k));
        return form && form->solve;
    }
    return solves[ck_sweep_scene(sweep, point)];
}

// All that a truth depends on: of points that were loaded the model, else what is changed. A setting of an engine is
// none of it.
static uint64_t hash_truth(const ck_Sweep *sweep, int point) {
    const ck_StudyFile *file = sweep->options->file;
    const ck_Limits *limits = &sweep->options->compare->limits;
    const double numbers[] = {limits->seconds, (double)limits->memory_bytes};
    uint64_t hash = hash_text(ck_hash(CK_HASH_START, numbers, sizeof numbers), sweep->build);
    if (sweep->point_hashes[point]) return ck_hash(hash, &sweep->point_hashes[point], sizeof(uint64_t));
    hash = ck_hash(hash, &sweep->scene_hashes[ck_sweep_scene(sweep, point)], sizeof(uint64_t));
    for (int k = 0; k < ck_sweep_key_count(file); k++) {
        if (!strncmp(ck_sweep_key(file, k), "settings.", 9)) continue;
        hash = hash_text(hash_text(hash, ck_sweep_key(file, k)), ck_sweep_value(sweep, point, k));
    }
    return hash;
}

// What a file holds, where a word is the name of one.
static uint64_t hash_file(uint64_t hash, const char *word) {
    struct stat about;
    char *bytes = NULL;
    size_t size;
    if (!*word || stat(word, &about) || !S_ISREG(about.st_mode)) return hash;
    if (!ck_file_read(&bytes, &size, word, NULL)) hash = ck_hash(hash, bytes, size);
    free(bytes);
    return hash;
}

// An engine from outside is what the files hold that the words which name it are.
static uint64_t hash_outside(uint64_t hash, const ck_Outside *outside) {
    char *words = outside && outside->arguments ? strdup(outside->arguments) : NULL, *rest = words;
    hash = hash_text(hash, words);
    for (char *word; words && (word = strsep(&rest, " =\t'\""));) hash = hash_file(hash, word);
    free(words);
    return hash;
}

// Program and commit; where that does not tell what is built, what the program is made of.
static void find_build(ck_Sweep *sweep) {
    const char *build = ck_machine_build();
    const bool is_known = !strstr(build, "-dirty") && !strstr(build, "unknown");
    snprintf(sweep->build, sizeof sweep->build, "%s %016llx", build,
             (unsigned long long)(is_known ? 0 : hash_file(CK_HASH_START, "/proc/self/exe")));
}

static uint64_t hash_case(const ck_Sweep *sweep, int point, int engine) {
    const ck_SweepOptions *options = sweep->options;
    const ck_StudyFile *file = options->file;
    const ck_CompareOptions *compare = options->compare;
    uint64_t hash = file->scene_count ? sweep->scene_hashes[ck_sweep_scene(sweep, point)] : CK_HASH_START;
    for (int k = 0; k < ck_sweep_key_count(file); k++)
        hash = hash_text(hash_text(hash, ck_sweep_key(file, k)), ck_sweep_value(sweep, point, k));
    for (int i = 0; i < compare->engine_count; i++) {
        if (sweep->is_by_engine && i != engine) continue;
        hash = hash_text(hash_text(hash, compare->engines[i]->name), ck_engine_version(compare->engines[i]));
        hash = ck_hash(hash, &sweep->engine_hashes[i], sizeof sweep->engine_hashes[i]);
    }
    hash = ck_hash(hash, &sweep->point_hashes[point], sizeof sweep->point_hashes[point]);
    for (int i = 0; i < file->option_count; i++) hash = hash_file(hash_text(hash, file->options[i]), file->options[i]);
    for (int i = 0; i < options->word_count; i++) hash = hash_text(hash, options->words[i]);
    hash = hash_text(hash_text(hash, file->settings), sweep->build);
    const double numbers[] = {file->run,
                              compare->repeats,
                              file->series,
                              compare->limits.seconds,
                              (double)compare->limits.memory_bytes,
                              compare->limits.patience,
                              (double)compare->seed,
                              file->run == CK_STUDY_COMPARE ? 0 : options->case_limit};
    return ck_hash(hash, numbers, sizeof numbers);
}

// Truths, each once, whatever points share it.
static ck_Status find_truths(ck_Sweep *sweep, const bool *solves, ck_Error *error) {
    PointKey *truths = malloc(((size_t)sweep->point_count + 1) * sizeof *truths);
    sweep->truth_of = malloc(((size_t)sweep->point_count + 1) * sizeof *sweep->truth_of);
    sweep->truth_at = malloc(((size_t)sweep->point_count + 1) * sizeof *sweep->truth_at);
    if (!truths || !sweep->truth_of || !sweep->truth_at) {
        free(truths);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    int count = 0;
    for (int point = 0; point < sweep->point_count; point++) {
        sweep->truth_of[point] = -1;
        if (sweep->options->file->run == CK_STUDY_COMPARE && is_solved(sweep, point, solves))
            truths[count++] = (PointKey){hash_truth(sweep, point), point};
    }
    qsort(truths, (size_t)count, sizeof *truths, compare_keys);
    for (int i = 0; i < count; i++) {
        if (!i || truths[i].hash != truths[i - 1].hash) sweep->truth_at[sweep->truth_count++] = truths[i].point;
        sweep->truth_of[truths[i].point] = sweep->truth_count - 1;
    }
    free(truths);
    return CK_OK;
}

static ck_Status find_keys(ck_Sweep *sweep, ck_Error *error) {
    const double cases = sweep->truth_count + (double)sweep->point_count * sweep->engine_count;
    if (cases > CK_STUDY_MOST_POINTS)
        return ck_fail(error, CK_BAD_INPUT, "%s: it has %.0f cases; a study has at most %d",
                       sweep->options->file->document.path, cases, CK_STUDY_MOST_POINTS);
    sweep->case_count = (int)cases;
    sweep->keys = malloc((size_t)sweep->case_count * sizeof *sweep->keys);
    if (!sweep->keys) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    sweep->study = CK_HASH_START;
    for (int i = 0; i < sweep->case_count; i++) {
        int engine, point = ck_sweep_point(sweep, i, &engine);
        sweep->keys[i] = engine < 0 ? hash_truth(sweep, point) : hash_case(sweep, point, engine);
        sweep->study = ck_hash(sweep->study, &sweep->keys[i], sizeof sweep->keys[i]);
    }
    return CK_OK;
}

// Two points of one name would be one in the CSVs.
static ck_Status check_names(const ck_Sweep *sweep, ck_Error *error) {
    PointKey *names = malloc(((size_t)sweep->point_count + 1) * sizeof *names);
    char name[CK_SWEEP_NAME];
    ck_Status status = names ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < sweep->point_count && names; i++) {
        ck_sweep_name(sweep, i, name);
        names[i] = (PointKey){hash_text(CK_HASH_START, name), i};
    }
    if (names) qsort(names, (size_t)sweep->point_count, sizeof *names, compare_keys);
    for (int i = 1; i < sweep->point_count && !status; i++) {
        if (names[i].hash != names[i - 1].hash) continue;
        ck_sweep_name(sweep, names[i].point, name);
        status = ck_fail(error, CK_BAD_INPUT,
                         "%s: its points %d and %d are both named %s; give no scene and no value twice, and scenes "
                         "names of their own (SCENE@name=NAME)",
                         sweep->options->file->document.path, names[i - 1].point + 1, names[i].point + 1, name);
    }
    free(names);
    return status;
}

// A word that does not fit would be another scene.
static ck_Status check_length(const ck_Sweep *sweep, ck_Error *error) {
    const ck_StudyFile *file = sweep->options->file;
    size_t longest = file->settings ? strlen(file->settings) + 100 : 0, most = 0;
    for (int i = 0; i < file->scene_count; i++) most = fmax(most, strlen(sweep->options->paths[i]));
    for (int i = 0; i < file->axis_count; i++) {
        size_t axis = 0;
        for (int v = 0; v < file->axes[i].value_count; v++) {
            size_t one = 0;
            for (int k = 0; k < file->axes[i].key_count; k++)
                one +=
                    strlen(file->axes[i].keys[k]) + strlen(file->axes[i].values[v * file->axes[i].key_count + k]) + 2;
            if (one > axis) axis = one;
        }
        longest += axis;
    }
    if (longest + most < CK_SWEEP_WORD) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "%s: a point's changes take %zu letters, of at most %d", file->document.path,
                   longest + most, CK_SWEEP_WORD);
}

static ck_Status check_points(ck_Sweep *sweep, ck_Error *error) {
    char word[CK_SWEEP_WORD];
    ck_Status status = CK_OK;
    for (int i = 0; i < sweep->point_count && !status; i++) {
        sweep->work[i] = 1;
        if (sweep->point_count > MOST_CHECKED || !sweep->options->file->scene_count) continue;
        ck_sweep_word(sweep, i, word);
        status = find_work(word, &sweep->work[i], &sweep->point_hashes[i], error);
        if (i % 100 == 99) ck_progress_show("looking at %d of %d points", i + 1, sweep->point_count);
    }
    ck_progress_clear();
    return status;
}

static ck_Status count_points(ck_Sweep *sweep, ck_Error *error) {
    const ck_StudyFile *file = sweep->options->file;
    double points = file->scene_count ? file->scene_count : 1;
    for (int i = 0; i < file->axis_count; i++) points *= file->axes[i].value_count;
    if (points > CK_STUDY_MOST_POINTS)
        return ck_fail(error, CK_BAD_INPUT, "%s: it has %.0f points; a study has at most %d", file->document.path,
                       points, CK_STUDY_MOST_POINTS);
    sweep->point_count = (int)points;
    return CK_OK;
}

ck_Status ck_sweep_create(ck_Sweep *sweep, const ck_SweepOptions *options, ck_Error *error) {
    const ck_StudyFile *file = options->file;
    *sweep = (ck_Sweep){.options = options, .is_by_engine = is_by_engine[file->run] && !options->is_by_point};
    sweep->engine_count = sweep->is_by_engine ? options->compare->engine_count : 1;
    ck_Status status = count_points(sweep, error);
    if (status) return status;
    sweep->scene_hashes = calloc((size_t)file->scene_count + 1, sizeof *sweep->scene_hashes);
    sweep->work = malloc(((size_t)sweep->point_count + 1) * sizeof *sweep->work);
    sweep->names = calloc((size_t)file->scene_count + 1, sizeof *sweep->names);
    sweep->point_hashes = calloc((size_t)sweep->point_count + 1, sizeof *sweep->point_hashes);
    find_build(sweep);
    bool *solves = calloc((size_t)file->scene_count + 1, sizeof *solves);
    if (!sweep->scene_hashes || !sweep->work || !sweep->names || !sweep->point_hashes || !solves)
        status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    for (int i = 0; i < file->scene_count && !status; i++) {
        status = check_word(options->paths[i], &sweep->scene_hashes[i], &solves[i], &sweep->names[i], error);
        if (!status) status = check_axes(sweep, i, error);
    }
    for (int i = 0; i < options->compare->engine_count; i++)
        sweep->engine_hashes[i] = hash_outside(CK_HASH_START, options->compare->engines[i]->outside);
    if (!status) status = check_length(sweep, error);
    if (!status) status = check_names(sweep, error);
    if (!status) status = check_points(sweep, error);
    if (!status) status = find_truths(sweep, solves, error);
    if (!status) status = find_keys(sweep, error);
    free(solves);
    return status;
}

void ck_sweep_free(ck_Sweep *sweep) {
    for (int i = 0; sweep->names && i < sweep->options->file->scene_count; i++) free(sweep->names[i]);
    free(sweep->names);
    free(sweep->scene_hashes);
    free(sweep->point_hashes);
    free(sweep->truth_of);
    free(sweep->truth_at);
    free(sweep->keys);
    free(sweep->work);
    *sweep = (ck_Sweep){0};
}
