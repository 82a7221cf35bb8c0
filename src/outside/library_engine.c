// A shared library as an engine: it is loaded in the process of a run, never in the program's own.
#include "outside_engine.h"
#include "plugin.h"
#include "process.h"
#include "text_pool.h"

#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define LOAD_SECONDS 10
#define MOST_SETTINGS (CK_OWN + CK_OWN_SETTINGS)

typedef struct SettingTexts {
    char name[32], also[32], unit[16], rule[100], help[120];
    ck_Setting row; // its texts are those above
} SettingTexts;

// What a library's engine is, without what it does.
typedef struct Profile {
    char error[200]; // empty: it can be used
    char name[64], about[160], version[80];
    ck_Engine engine; // its numbers; functions only say whether there are any
    SettingTexts settings[MOST_SETTINGS];
    int setting_count;
} Profile;

typedef struct Library {
    char path[PATH_MAX];
    Profile profile;
    ck_Setting settings[MOST_SETTINGS + 1];
    ck_TextPool *pool;
} Library;

typedef struct Loaded {
    void *handle;
    const Library *library;
    const ck_Engine *engine;
    void *state;
} Loaded;

// The engine of a library; NULL with the reason.
static const ck_Engine *load(const char *path, void **handle, char *reason, size_t size) {
    *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const ck_Plugin *plugin = *handle ? dlsym(*handle, CK_PLUGIN_SYMBOL) : NULL;
    if (!plugin)
        snprintf(reason, size, "%.199s", dlerror());
    else if (plugin->version != CK_PLUGIN_VERSION)
        snprintf(reason, size, "it is of version %u of the interface, and this program has %d: compile it anew",
                 plugin->version, CK_PLUGIN_VERSION);
    else if (plugin->engine_size != sizeof(ck_Engine) || plugin->model_size != sizeof(ck_Model) ||
             plugin->settings_size != sizeof(ck_Settings))
        snprintf(reason, size, "it was compiled with other headers than this program: compile it anew");
    else if (!plugin->engine || !plugin->engine->create || !plugin->engine->step || !plugin->engine->read ||
             !plugin->engine->destroy)
        snprintf(reason, size, "its engine lacks create, step, read or destroy");
    else
        return plugin->engine;
    return NULL;
}

static void take_settings(Profile *profile, const ck_Setting *rows) {
    for (; rows && rows->name && profile->setting_count < MOST_SETTINGS; rows++) {
        SettingTexts *texts = &profile->settings[profile->setting_count++];
        texts->row = *rows;
        snprintf(texts->name, sizeof texts->name, "%s", rows->name);
        snprintf(texts->also, sizeof texts->also, "%s", rows->also ? rows->also : "");
        snprintf(texts->unit, sizeof texts->unit, "%s", rows->unit ? rows->unit : "1");
        snprintf(texts->rule, sizeof texts->rule, "%s", rows->rule ? rows->rule : "its own");
        snprintf(texts->help, sizeof texts->help, "%s", rows->help ? rows->help : "");
    }
}

typedef struct Question {
    const char *path;
    Profile *profile;
} Question;

// In a child process.
static void look_at(void *context) {
    const Question *question = context;
    Profile *profile = question->profile;
    void *handle;
    const ck_Engine *engine = load(question->path, &handle, profile->error, sizeof profile->error);
    if (!engine) return;
    profile->engine = *engine;
    snprintf(profile->name, sizeof profile->name, "%s", engine->name ? engine->name : "");
    snprintf(profile->about, sizeof profile->about, "%s", engine->about ? engine->about : "a shared library");
    snprintf(profile->version, sizeof profile->version, "%s", engine->version ? engine->version() : "");
    take_settings(profile, engine->settings);
}

static ck_Status open_library(const void *source, void **state, const ck_Model *model, const ck_Settings *wanted,
                              ck_Settings *used, ck_Ledger *ledger, ck_Error *error) {
    const Library *library = source;
    char reason[200];
    Loaded *loaded = calloc(1, sizeof *loaded);
    if (!loaded) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    loaded->library = library;
    loaded->engine = load(library->path, &loaded->handle, reason, sizeof reason);
    ck_Status status = loaded->engine ? loaded->engine->create(&loaded->state, model, wanted, used, ledger, error)
                                      : ck_fail(error, CK_REFUSED, "%s", reason);
    if (status) {
        free(loaded);
        return status;
    }
    ck_text_pool_clear(library->pool);
    for (int i = 0; ledger && i < ledger->count; i++)
        ledger->rows[i] = ck_text_pool_keep_row(library->pool, ledger->rows[i]);
    *state = loaded;
    return CK_OK;
}

static ck_StepResult step(void *state) {
    Loaded *loaded = state;
    return loaded->engine->step(loaded->state);
}

static void read_state(const void *state, double *position, double *velocity) {
    const Loaded *loaded = state;
    loaded->engine->read(loaded->state, position, velocity);
}

static void pace(void *state, double duration) {
    Loaded *loaded = state;
    loaded->engine->pace(loaded->state, duration);
}

static void turn(const void *state, ck_Turn *turn) {
    const Loaded *loaded = state;
    loaded->engine->turn(loaded->state, turn);
}

static void release(void *state, int particle) {
    Loaded *loaded = state;
    loaded->engine->release(loaded->state, particle);
}

static void contact(const void *state, double *force) {
    const Loaded *loaded = state;
    loaded->engine->contact(loaded->state, force);
}

static const char *remark(const void *state) {
    const Loaded *loaded = state;
    const char *text = loaded->engine->remark(loaded->state);
    return text ? ck_text_pool_keep(loaded->library->pool, text) : NULL;
}

// The library stays loaded: its process is about to end, and some do not like to be taken out.
static void destroy(void *state) {
    Loaded *loaded = state;
    loaded->engine->destroy(loaded->state);
    free(loaded);
}

static void free_library(void *source) {
    Library *library = source;
    ck_text_pool_free(library->pool);
    free(library);
}

static ck_Status ask(Library *library, ck_Error *error) {
    Profile *profile = ck_shared_allocate(sizeof *profile);
    ck_ChildResult result;
    if (!profile) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    const ck_Limits limits = {.seconds = LOAD_SECONDS};
    ck_Status status = ck_child_run(&result, look_at, &(Question){library->path, profile}, &limits, error);
    const char *why = result.end != CK_CHILD_DONE ? result.reason : profile->error;
    if (!status && *why)
        status = ck_fail(error, CK_BAD_INPUT, "%s: cannot be used as an engine: %s", library->path, why);
    library->profile = *profile;
    ck_shared_free(profile, sizeof *profile);
    return status;
}

static void make_settings(Library *library) {
    for (int i = 0; i < library->profile.setting_count; i++) {
        SettingTexts *texts = &library->profile.settings[i];
        library->settings[i] = texts->row;
        library->settings[i].name = texts->name;
        library->settings[i].also = *texts->also ? texts->also : NULL;
        library->settings[i].unit = texts->unit;
        library->settings[i].rule = texts->rule;
        library->settings[i].help = texts->help;
    }
}

// What a library's engine is, and in place of what it does, the way to it.
static void make_engine(ck_OutsideEngine *made, Library *library) {
    const Profile *profile = &library->profile;
    const ck_Engine *of = &profile->engine;
    made->engine.method = of->method;
    made->engine.terms = of->terms;
    made->engine.is_single = of->is_single;
    made->engine.order = of->order;
    made->engine.rest_order = of->rest_order;
    made->engine.damped_rest_order = of->damped_rest_order;
    made->engine.settings = library->settings;
    made->engine.step = step;
    made->engine.read = read_state;
    made->engine.release = of->release ? release : NULL;
    made->engine.pace = of->pace ? pace : NULL;
    made->engine.turn = of->turn ? turn : NULL;
    made->engine.contact = of->contact ? contact : NULL;
    made->engine.remark = of->remark ? remark : NULL;
    made->engine.destroy = destroy;
    made->outside.open = open_library;
    made->outside.source = library;
    snprintf(made->about, sizeof made->about, "%s", profile->about);
    snprintf(made->version, sizeof made->version, "%s", profile->version);
}

ck_Status ck_outside_library(ck_Engine **engine, const char *name, const char *path, ck_Error *error) {
    *engine = NULL;
    Library *library = calloc(1, sizeof *library);
    if (library) library->pool = ck_text_pool_new();
    ck_Status status = library && library->pool ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status && !realpath(path, library->path))
        status = ck_fail(error, CK_BAD_INPUT, "%s: there is no such library", path);
    if (!status) status = ask(library, error);
    ck_OutsideEngine *made = status ? NULL : ck_outside_new(name ? name : library->profile.name);
    if (!status && !made) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (status) {
        if (library) free_library(library);
        return status;
    }
    make_settings(library);
    made->source = library;
    made->free_source = free_library;
    make_engine(made, library);
    ck_outside_option(made, name, path);
    *engine = &made->engine;
    return CK_OK;
}
