#include "scene.h"

#include "change.h"
#include "resize.h"
#include "scene_check.h"
#include "scene_schema.h"

#include <cyaml/cyaml.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Aliases could make a small file describe an enormous scene; nobody needs them in one.
static const cyaml_config_t cyaml = {.mem_fn = cyaml_mem, .flags = CYAML_CFG_NO_ALIAS};

static const char *const instead[][2] = {{"time.step", "time.fps"}, {NULL, NULL}};
static const ck_DocumentKind scene_kind = {"scene", "name, a body (cloth, rope, network or mesh) and time", instead};

static const char *text_of(yaml_document_t *yaml, int node) {
    return (const char *)yaml_document_get_node(yaml, node)->data.scalar.value;
}

// Of a checked document. False when out of memory.
static bool read_settings(ck_Scene *scene) {
    yaml_document_t *yaml = &scene->document.yaml;
    yaml_node_t *engines = ck_document_find(&scene->document, "settings");
    if (engines == yaml_document_get_root_node(yaml)) return true;
    for (yaml_node_pair_t *engine = engines->data.mapping.pairs.start; engine < engines->data.mapping.pairs.top;
         engine++) {
        yaml_node_t *keys = yaml_document_get_node(yaml, engine->value);
        size_t more = (size_t)(keys->data.mapping.pairs.top - keys->data.mapping.pairs.start);
        ck_SceneSetting *grown =
            realloc(scene->settings, ((size_t)scene->setting_count + more + 1) * sizeof *scene->settings);
        if (!grown) return false;
        scene->settings = grown;
        for (yaml_node_pair_t *key = keys->data.mapping.pairs.start; key < keys->data.mapping.pairs.top; key++)
            grown[scene->setting_count++] = (ck_SceneSetting){.engine = text_of(yaml, engine->key),
                                                              .key = text_of(yaml, key->key),
                                                              .value = strtod(text_of(yaml, key->value), NULL),
                                                              .engine_at = yaml_document_get_node(yaml, engine->key),
                                                              .key_at = yaml_document_get_node(yaml, key->key),
                                                              .value_at = yaml_document_get_node(yaml, key->value)};
    }
    return true;
}

// The file's body at its resolution, in its own place.
static ck_Status resize(ck_Scene *scene, ck_Error *error) {
    ck_SceneFile *file = scene->file;
    if (!(file->resolution > 0) || file->resolution == 1) return CK_OK;
    const char *refusal = ck_scene_resize_refusal(file, file->resolution);
    if (refusal)
        return ck_scene_fail(scene, "resolution", error, "resolution is %g, which it cannot have: %s", file->resolution,
                             refusal);
    ck_SceneResized resized = {0};
    ck_scene_resize(&resized, file, file->resolution);
    if (file->cloth) *file->cloth = resized.cloth;
    if (file->rope) *file->rope = resized.rope;
    if (file->springs) *file->springs = resized.springs;
    if (file->force) memcpy(file->force, resized.force, sizeof resized.force);
    return CK_OK;
}

// A changed scene is another one, and its name says which: by what is changed after the name, where that is.
static bool rename_changed(ck_SceneFile *file, const char *path) {
    char name[200], suffix[CK_SCENE_SUFFIX];
    ck_Change change;
    int from = 0;
    for (int place = 0; ck_change_next(path, &place, &change);)
        if (change.key_length == 4 && !strncmp(change.key, "name", 4)) from = place;
    if (!*ck_change_name(suffix, sizeof suffix, path + from)) return true;
    snprintf(name, sizeof name, "%.79s%s", file->name, suffix);
    char *longer = strdup(name);
    if (!longer) return false;
    free(file->name);
    file->name = longer;
    return true;
}

ck_Status ck_scene_load(ck_Scene *scene, const char *path, ck_Error *error) {
    *scene = (ck_Scene){0};
    ck_Status status = ck_document_load(&scene->document, path, &scene_kind, error);
    if (!status) status = ck_scene_check(&scene->document, &ck_scene_schema, error);
    if (status) return status;
    cyaml_err_t result = cyaml_load_data(scene->document.text, scene->document.length, &cyaml, &ck_scene_schema,
                                         (cyaml_data_t **)&scene->file, NULL);
    // libyaml has read this text before: what it cannot do now is for a lack of memory
    if (result == CYAML_ERR_OOM || result == CYAML_ERR_LIBYAML_PARSER || result == CYAML_ERR_LIBYAML_PARSER_INIT)
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    if (result) return ck_fail(error, CK_BAD_INPUT, "%s: %s", path, cyaml_strerror(result));
    ck_SceneTime *time = &scene->file->time;
    if (time->fps > 0) time->step = 1 / time->fps;
    if (!read_settings(scene) || !rename_changed(scene->file, path))
        return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    return resize(scene, error);
}

void ck_scene_free(ck_Scene *scene) {
    cyaml_free(&cyaml, &ck_scene_schema, scene->file, 0);
    free(scene->settings);
    ck_document_free(&scene->document);
    *scene = (ck_Scene){0};
}

ck_Status ck_scene_fail(const ck_Scene *scene, const char *path, ck_Error *error, const char *format, ...) {
    char message[sizeof error->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return ck_document_fail(&scene->document, ck_document_find(&scene->document, path), error, "%s", message);
}
