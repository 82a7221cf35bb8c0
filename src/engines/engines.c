#include "engines.h"

#include "names.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// ends with NULL
extern const ck_Engine *const ck_engine_table[];

#define MOST_NAME 40

// Those from outside the program and those under a second name, after the table's own.
static const ck_Engine *added[16];
static int added_count;

typedef struct Copy {
    ck_Engine engine;
    char name[MOST_NAME + 1];
    const ck_Engine *of;
} Copy;

static Copy copies[sizeof added / sizeof *added];
static int copy_count;

static int own_count(void) {
    int count = 0;
    while (ck_engine_table[count]) count++;
    return count;
}

int ck_engine_count(void) {
    return own_count() + added_count;
}

const ck_Engine *ck_engine_at(int index) {
    int own = own_count();
    return index < own ? ck_engine_table[index] : added[index - own];
}

// In place of an engine's name: every one that has the setting.
#define EVERY "all"

const ck_Engine *ck_engine_find(const char *name) {
    for (int i = 0; i < ck_engine_count(); i++)
        if (!strcmp(ck_engine_at(i)->name, name)) return ck_engine_at(i);
    return NULL;
}

ck_Status ck_engines_add(const ck_Engine *engine, ck_Error *error) {
    size_t length = strlen(engine->name);
    if (!length || length > MOST_NAME || *engine->name == '.' || strspn(engine->name, CK_PLAIN_LETTERS) != length)
        return ck_fail(error, CK_BAD_INPUT, "an engine cannot be named '%.60s': take at most 40 of " CK_PLAIN_LETTERS,
                       engine->name);
    if (!strcmp(engine->name, "truth") || !strcmp(engine->name, EVERY) || ck_engine_find(engine->name))
        return ck_fail(error, CK_BAD_INPUT, "there is an engine %s already; give yours another name", engine->name);
    if (added_count == sizeof added / sizeof *added)
        return ck_fail(error, CK_BAD_INPUT, "at most %d engines can be added at once", added_count);
    added[added_count++] = engine;
    return CK_OK;
}

ck_Status ck_engines_add_copy(const ck_Engine **copy, const char *name, const ck_Engine *of, ck_Error *error) {
    if (copy_count == sizeof copies / sizeof *copies)
        return ck_fail(error, CK_BAD_INPUT, "at most %d engines can be added at once", copy_count);
    Copy *made = &copies[copy_count];
    *made = (Copy){.engine = *of, .of = of};
    made->engine.name = made->name;
    // one that is too long is refused as it stands
    const bool fits = snprintf(made->name, sizeof made->name, "%s", name) < (int)sizeof made->name;
    ck_Engine whole = {.name = name};
    ck_Status status = ck_engines_add(fits ? &made->engine : &whole, error);
    if (status) return status;
    copy_count++;
    *copy = &made->engine;
    return CK_OK;
}

const ck_Engine *ck_engine_original(const ck_Engine *engine) {
    for (int i = 0; i < copy_count; i++)
        if (engine == &copies[i].engine) return copies[i].of;
    return NULL;
}

const char *ck_engine_name(const void *table, int index) {
    (void)table;
    return index < ck_engine_count() ? ck_engine_at(index)->name : NULL;
}

static ck_Status check_setting_of_all(const ck_Scene *scene, const ck_SceneSetting *setting, ck_Error *error) {
    char wanted[100];
    const ck_Setting *any = NULL;
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Setting *row = ck_setting_find(ck_engine_at(i)->settings, setting->key);
        if (row) any = row;
        if (row && !ck_setting_takes(row, setting->value, wanted, sizeof wanted))
            return ck_document_fail(&scene->document, setting->value_at, error,
                                    "settings." EVERY ".%s is %.10g; for %s it must be %s", setting->key,
                                    setting->value, ck_engine_at(i)->name, wanted);
    }
    return any ? CK_OK
               : ck_document_fail(&scene->document, setting->key_at, error,
                                  "unknown key %s in settings." EVERY ": no engine has it", setting->key);
}

static ck_Status check_setting(const ck_Scene *scene, const ck_SceneSetting *setting, ck_Error *error) {
    char known[400], hint[80], wanted[100];
    if (!strcmp(setting->engine, EVERY)) return check_setting_of_all(scene, setting, error);
    const ck_Engine *engine = ck_engine_find(setting->engine);
    if (!engine)
        return ck_document_fail(&scene->document, setting->engine_at, error,
                                "unknown key %s in settings%s; known here: %s", setting->engine,
                                ck_name_hint(hint, sizeof hint, setting->engine, ck_engine_name, NULL),
                                ck_name_list(known, sizeof known, ck_engine_name, NULL));
    const ck_Setting *row = ck_setting_find(engine->settings, setting->key);
    if (!row)
        return ck_document_fail(
            &scene->document, setting->key_at, error, "unknown key %s in settings.%s%s; known here: %s", setting->key,
            engine->name, ck_name_hint(hint, sizeof hint, setting->key, ck_setting_name, engine->settings),
            engine->settings ? ck_name_list(known, sizeof known, ck_setting_name, engine->settings) : "none");
    if (!ck_setting_takes(row, setting->value, wanted, sizeof wanted))
        return ck_document_fail(&scene->document, setting->value_at, error, "settings.%s.%s is %.10g; it must be %s",
                                engine->name, setting->key, setting->value, wanted);
    return CK_OK;
}

ck_Status ck_engines_check(const ck_Scene *scene, ck_Error *error) {
    ck_Status status = CK_OK;
    for (int i = 0; i < scene->setting_count && !status; i++) status = check_setting(scene, &scene->settings[i], error);
    return status;
}

ck_Settings ck_engine_scene_settings(const ck_Engine *engine, const ck_Scene *scene) {
    ck_Settings settings = {0};
    const ck_Engine *original = ck_engine_original(engine);
    // the later of these count more
    const char *const names[] = {EVERY, original ? original->name : engine->name, engine->name};
    for (size_t k = 0; k < sizeof names / sizeof *names; k++)
        for (int i = 0; i < scene->setting_count; i++) {
            const ck_Setting *row = strcmp(scene->settings[i].engine, names[k])
                                        ? NULL
                                        : ck_setting_find(engine->settings, scene->settings[i].key);
            if (row) ck_settings_set(&settings, row->slot, scene->settings[i].value);
        }
    return settings;
}
