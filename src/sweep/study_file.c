#include "study_file.h"

#include "names.h"
#include "values.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const ck_study_runs[CK_STUDY_RUNS] = {"compare", "precision", "stability", "tune",
                                                  "needs",   "refine",    "conform"};

static const ck_DocumentKind kind = {"study", "study, its name, and scenes", NULL};

// What a key's value goes through.
typedef struct Reader {
    ck_StudyFile *study;
    ck_Error *error;
} Reader;

static ck_Status fail_memory(const Reader *reader) {
    return ck_fail(reader->error, CK_NO_MEMORY, "%s: out of memory", reader->study->document.path);
}

static yaml_node_t *node_at(const Reader *reader, int node) {
    return yaml_document_get_node(&reader->study->document.yaml, node);
}

static int entries_of(const yaml_node_t *list) {
    return (int)(list->data.sequence.items.top - list->data.sequence.items.start);
}

static ck_Status read_text(const Reader *reader, yaml_node_t *node, const char *key, char **text) {
    if (node->type != YAML_SCALAR_NODE || !node->data.scalar.length ||
        strlen((char *)node->data.scalar.value) != node->data.scalar.length)
        return ck_document_fail(&reader->study->document, node, reader->error, "%s must be a text", key);
    free(*text);
    *text = strdup((char *)node->data.scalar.value);
    return *text ? CK_OK : fail_memory(reader);
}

static ck_Status read_texts(const Reader *reader, yaml_node_t *node, const char *key, char ***texts, int *count) {
    if (node->type != YAML_SEQUENCE_NODE || !entries_of(node))
        return ck_document_fail(&reader->study->document, node, reader->error, "%s must be a list of texts", key);
    *texts = calloc((size_t)entries_of(node), sizeof **texts);
    if (!*texts) return fail_memory(reader);
    ck_Status status = CK_OK;
    for (int i = 0; i < entries_of(node) && !status; i++) {
        status = read_text(reader, node_at(reader, node->data.sequence.items.start[i]), key, &(*texts)[i]);
        *count = i + 1;
    }
    return status;
}

// One of some words, by its number.
static ck_Status read_word(const Reader *reader, yaml_node_t *node, const char *key, const char *const *words,
                           int count, int *number) {
    char *text = NULL, known[300] = "";
    ck_Status status = read_text(reader, node, key, &text);
    *number = 0;
    while (!status && *number < count && strcmp(words[*number], text)) ++*number;
    for (int i = 0; i < count; i++)
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", i ? ", " : "", words[i]);
    if (!status && *number == count)
        status = ck_document_fail(&reader->study->document, node, reader->error, "%s is %s; it must be one of %s", key,
                                  text, known);
    free(text);
    return status;
}

static ck_Status read_name(const Reader *reader, yaml_node_t *node) {
    ck_StudyFile *study = reader->study;
    ck_Status status = read_text(reader, node, "study", &study->name);
    if (!status &&
        (*study->name == '.' || study->name[strspn(study->name, CK_PLAIN_LETTERS)] || strlen(study->name) > 80))
        status = ck_document_fail(&study->document, node, reader->error,
                                  "study must be a name of at most 80 letters, digits, _, - and .");
    return status;
}

static ck_Status read_about(const Reader *reader, yaml_node_t *node) {
    return read_text(reader, node, "about", &reader->study->about);
}

static ck_Status read_scenes(const Reader *reader, yaml_node_t *node) {
    return read_texts(reader, node, "scenes", &reader->study->scenes, &reader->study->scene_count);
}

static ck_Status read_engines(const Reader *reader, yaml_node_t *node) {
    return read_texts(reader, node, "engines", &reader->study->engines, &reader->study->engine_count);
}

static ck_Status read_options(const Reader *reader, yaml_node_t *node) {
    return read_texts(reader, node, "options", &reader->study->options, &reader->study->option_count);
}

static ck_Status read_run(const Reader *reader, yaml_node_t *node) {
    int run = 0;
    ck_Status status = read_word(reader, node, "run", ck_study_runs, CK_STUDY_RUNS, &run);
    if (!status) reader->study->run = (ck_StudyRun)run;
    return status;
}

static ck_Status read_series(const Reader *reader, yaml_node_t *node) {
    reader->study->has_series = true;
    static const char *const words[] = {"none", "csv", "gzip"};
    int series = 0;
    ck_Status status = read_word(reader, node, "series", words, 3, &series);
    if (!status) reader->study->series = (ck_StudySeries)series;
    return status;
}

static ck_Status read_repeats(const Reader *reader, yaml_node_t *node) {
    char *text = NULL, *end = NULL;
    ck_Status status = read_text(reader, node, "repeats", &text);
    const long repeats = text ? strtol(text, &end, 10) : 0;
    if (!status && (*end || repeats < 0 || repeats > 99))
        status = ck_document_fail(&reader->study->document, node, reader->error,
                                  "repeats is %s; it must be a whole number from 0 to 99", text);
    reader->study->repeats = (int)repeats;
    free(text);
    return status;
}

// Engines with their settings, as a scene has them: each becomes a change of every scene.
static ck_Status read_settings(const Reader *reader, yaml_node_t *node) {
    ck_StudyFile *study = reader->study;
    ck_Status status = CK_OK;
    char *all = strdup("");
    const char *wrong = "settings must be engines with their settings, as {ode-quick: {substeps: 16}}";
    if (node->type != YAML_MAPPING_NODE) status = ck_document_fail(&study->document, node, reader->error, "%s", wrong);
    for (yaml_node_pair_t *engine = node->data.mapping.pairs.start;
         !status && all && engine < node->data.mapping.pairs.top; engine++) {
        yaml_node_t *name = node_at(reader, engine->key), *keys = node_at(reader, engine->value);
        if (name->type != YAML_SCALAR_NODE || keys->type != YAML_MAPPING_NODE) {
            status = ck_document_fail(&study->document, keys, reader->error, "%s", wrong);
            break;
        }
        for (yaml_node_pair_t *pair = keys->data.mapping.pairs.start; all && pair < keys->data.mapping.pairs.top;
             pair++) {
            if (node_at(reader, pair->key)->type != YAML_SCALAR_NODE) {
                status = ck_document_fail(&study->document, keys, reader->error, "%s", wrong);
                break;
            }
            char *more = NULL, *value = ck_value_text(&study->document, node_at(reader, pair->value));
            if (!value || asprintf(&more, "%s@settings.%s.%s=%s", all, (char *)name->data.scalar.value,
                                   (char *)node_at(reader, pair->key)->data.scalar.value, value) < 0)
                more = NULL;
            free(value);
            free(all);
            all = more;
        }
    }
    free(study->settings);
    study->settings = all;
    return status ? status : all ? CK_OK : fail_memory(reader);
}

// The values of an axis's keys, which go together: [value][key].
static ck_Status read_axis(const Reader *reader, yaml_node_t *node, ck_StudyAxis *axis) {
    const ck_Document *document = &reader->study->document;
    if (node->type != YAML_MAPPING_NODE || node->data.mapping.pairs.top == node->data.mapping.pairs.start)
        return ck_document_fail(document, node, reader->error,
                                "an entry of sweep must be keys with their values, as {drag: [1, 2, 4]}");
    const int keys = (int)(node->data.mapping.pairs.top - node->data.mapping.pairs.start);
    axis->keys = calloc((size_t)keys, sizeof *axis->keys);
    if (!axis->keys) return fail_memory(reader);
    axis->key_count = keys;
    ck_Status status = CK_OK;
    for (int k = 0; k < keys && !status; k++) {
        yaml_node_t *key = node_at(reader, node->data.mapping.pairs.start[k].key),
                    *values = node_at(reader, node->data.mapping.pairs.start[k].value);
        int count = 0;
        char **texts = NULL;
        status = read_text(reader, key, "a key of sweep", &axis->keys[k]);
        if (!status) status = ck_values_read(document, values, axis->keys[k], &texts, &count, reader->error);
        if (!status && k && count != axis->value_count) {
            status = ck_document_fail(document, values, reader->error,
                                      "%s has %d values and %s has %d; keys of one entry go together", axis->keys[k],
                                      count, axis->keys[0], axis->value_count);
        } else if (!status) {
            axis->value_count = count;
            if (!axis->values) axis->values = calloc((size_t)(keys * count) + 1, sizeof *axis->values);
            if (!axis->values) status = fail_memory(reader);
            for (int i = 0; i < count && !status; i++) axis->values[i * keys + k] = texts[i], texts[i] = NULL;
        }
        ck_values_free(texts, count);
    }
    return status;
}

// The axis read last must have keys of its own, and leave no more points than a study has.
static ck_Status check_axis(const Reader *reader, const yaml_node_t *node) {
    const ck_StudyFile *study = reader->study;
    const ck_StudyAxis *last = &study->axes[study->axis_count - 1];
    double points = 1;
    for (int i = 0; i < study->axis_count; i++) {
        points *= study->axes[i].value_count;
        for (int k = 0; k < study->axes[i].key_count; k++)
            for (int m = 0; m < last->key_count; m++)
                if ((&study->axes[i] != last || k != m) && !strcmp(study->axes[i].keys[k], last->keys[m]))
                    return ck_document_fail(&study->document, node, reader->error, "%s is swept twice; keep one",
                                            last->keys[m]);
    }
    if (points <= CK_STUDY_MOST_POINTS) return CK_OK;
    return ck_document_fail(&study->document, node, reader->error, "it has %.0f points by now; a study has at most %d",
                            points, CK_STUDY_MOST_POINTS);
}

static ck_Status read_sweep(const Reader *reader, yaml_node_t *node) {
    ck_StudyFile *study = reader->study;
    if (node->type != YAML_SEQUENCE_NODE)
        return ck_document_fail(&study->document, node, reader->error,
                                "sweep must be a list of keys with their values, as [{drag: [1, 2, 4]}]");
    study->axes = calloc((size_t)entries_of(node) + 1, sizeof *study->axes);
    if (!study->axes) return fail_memory(reader);
    ck_Status status = CK_OK;
    for (int i = 0; i < entries_of(node) && !status; i++) {
        study->axis_count = i + 1;
        const yaml_node_t *axis = node_at(reader, node->data.sequence.items.start[i]);
        status = read_axis(reader, (yaml_node_t *)axis, &study->axes[i]);
        if (!status) status = check_axis(reader, axis);
    }
    return status;
}

static ck_Status read_chart(const Reader *reader, yaml_node_t *node, ck_StudyChart *chart) {
    const ck_Document *document = &reader->study->document;
    static const char *const ofs[] = {"error", "value"};
    if (node->type != YAML_MAPPING_NODE)
        return ck_document_fail(document, node, reader->error, "a chart must read {x: KEY, metric: METRIC}");
    ck_Status status = CK_OK;
    int of = 0;
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top && !status;
         pair++) {
        yaml_node_t *key = node_at(reader, pair->key), *value = node_at(reader, pair->value);
        const char *name = key->type == YAML_SCALAR_NODE ? (const char *)key->data.scalar.value : "";
        if (!strcmp(name, "x"))
            status = read_text(reader, value, "x", &chart->x);
        else if (!strcmp(name, "metric"))
            status = read_text(reader, value, "metric", &chart->metric);
        else if (!strcmp(name, "of"))
            status = read_word(reader, value, "of", ofs, 2, &of);
        else
            status = ck_document_fail(document, key, reader->error,
                                      "unknown key %s in a chart; known here: x, metric, of", name);
    }
    if (!status && !(chart->x && chart->metric))
        status = ck_document_fail(document, node, reader->error, "a chart needs x, a key, and metric");
    if (status) return status;
    chart->of = strdup(ofs[of]);
    return chart->of ? CK_OK : fail_memory(reader);
}

static ck_Status read_charts(const Reader *reader, yaml_node_t *node) {
    ck_StudyFile *study = reader->study;
    if (node->type != YAML_SEQUENCE_NODE)
        return ck_document_fail(&study->document, node, reader->error,
                                "charts must be a list, as [{x: drag, metric: sag}]");
    study->charts = calloc((size_t)entries_of(node) + 1, sizeof *study->charts);
    if (!study->charts) return fail_memory(reader);
    ck_Status status = CK_OK;
    for (int i = 0; i < entries_of(node) && !status; i++) {
        study->chart_count = i + 1;
        status = read_chart(reader, node_at(reader, node->data.sequence.items.start[i]), &study->charts[i]);
    }
    return status;
}

// A key of the file is one row here.
static const struct Key {
    const char *name;
    ck_Status (*read)(const Reader *reader, yaml_node_t *node);
} keys[] = {{"study", read_name},      {"about", read_about},     {"scenes", read_scenes}, {"engines", read_engines},
            {"run", read_run},         {"options", read_options}, {"sweep", read_sweep},   {"settings", read_settings},
            {"repeats", read_repeats}, {"series", read_series},   {"charts", read_charts}};
#define KEYS ((int)(sizeof keys / sizeof *keys))

static const char *key_at(const void *table, int index) {
    (void)table;
    return index < KEYS ? keys[index].name : NULL;
}

static ck_Status read_key(const Reader *reader, yaml_node_pair_t *pair, bool *seen) {
    yaml_node_t *key = node_at(reader, pair->key);
    const char *name = key->type == YAML_SCALAR_NODE ? (const char *)key->data.scalar.value : "";
    char known[300], hint[80];
    int found = 0;
    while (found < KEYS && strcmp(keys[found].name, name)) found++;
    if (found == KEYS)
        return ck_document_fail(&reader->study->document, key, reader->error, "unknown key %s%s; known here: %s", name,
                                ck_name_hint(hint, sizeof hint, name, key_at, NULL),
                                ck_name_list(known, sizeof known, key_at, NULL));
    if (seen[found])
        return ck_document_fail(&reader->study->document, key, reader->error, "%s is given twice; keep one", name);
    seen[found] = true;
    return keys[found].read(reader, node_at(reader, pair->value));
}

// What several keys must agree on.
static ck_Status check(const Reader *reader, yaml_node_t *root) {
    const ck_StudyFile *study = reader->study;
    const ck_Document *document = &study->document;
    if (!study->name) return ck_document_fail(document, root, reader->error, "the study lacks the key study, its name");
    if (!study->scene_count && study->run != CK_STUDY_CONFORM)
        return ck_document_fail(document, root, reader->error, "the study lacks the key scenes");
    if (study->run == CK_STUDY_CONFORM && (study->scene_count || study->axis_count))
        return ck_document_fail(document, root, reader->error,
                                "conform has scenes of its own; leave out scenes and sweep");
    if (study->run != CK_STUDY_COMPARE && (study->repeats >= 0 || study->has_series))
        return ck_document_fail(document, root, reader->error,
                                "repeats and series are of compare; %s takes them in options, as [--repeats, 3]",
                                ck_study_runs[study->run]);
    for (int i = 0; i < study->chart_count; i++) {
        bool is_swept = false;
        for (int k = 0; k < study->axis_count; k++)
            for (int m = 0; m < study->axes[k].key_count; m++)
                is_swept |= !strcmp(study->axes[k].keys[m], study->charts[i].x);
        if (!is_swept)
            return ck_document_fail(document, ck_document_find(document, "charts"), reader->error,
                                    "a chart's x is %s, which is not swept", study->charts[i].x);
    }
    return CK_OK;
}

ck_Status ck_study_file_load(ck_StudyFile *study, const char *path, ck_Error *error) {
    *study = (ck_StudyFile){.repeats = -1};
    const Reader reader = {study, error};
    bool seen[KEYS] = {false};
    ck_Status status = ck_document_load(&study->document, path, &kind, error);
    if (status) return status;
    yaml_node_t *root = yaml_document_get_root_node(&study->document.yaml);
    if (root->type != YAML_MAPPING_NODE)
        return ck_document_fail(&study->document, root, error, "a study must be a mapping, as of study and scenes");
    for (yaml_node_pair_t *pair = root->data.mapping.pairs.start; pair < root->data.mapping.pairs.top && !status;
         pair++)
        status = read_key(&reader, pair, seen);
    return status ? status : check(&reader, root);
}

static void free_axis(ck_StudyAxis *axis) {
    ck_values_free(axis->values, axis->value_count * axis->key_count);
    ck_values_free(axis->keys, axis->key_count);
}

void ck_study_file_free(ck_StudyFile *study) {
    for (int i = 0; i < study->axis_count; i++) free_axis(&study->axes[i]);
    for (int i = 0; i < study->chart_count; i++) {
        free(study->charts[i].x);
        free(study->charts[i].metric);
        free(study->charts[i].of);
    }
    ck_values_free(study->scenes, study->scene_count);
    ck_values_free(study->engines, study->engine_count);
    ck_values_free(study->options, study->option_count);
    free(study->axes);
    free(study->charts);
    free(study->name);
    free(study->about);
    free(study->settings);
    ck_document_free(&study->document);
    *study = (ck_StudyFile){0};
}
