// Engines by what a command line calls them: those of the program, programs beside it, and a user's own.
#include "asked_engines.h"

#include "files.h"
#include "names.h"
#include "outside.h"

#include <dirent.h>
#include <fnmatch.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

ck_Status ck_engine_unknown(const char *name, ck_Error *error) {
    char known[400], hint[80];
    return ck_fail(error, CK_BAD_INPUT, "there is no engine %s%s; known are %s", name,
                   ck_name_hint(hint, sizeof hint, name, ck_engine_name, NULL),
                   ck_name_list(known, sizeof known, ck_engine_name, NULL));
}

static void add_engine(ck_Arguments *arguments, const ck_Engine *engine) {
    ck_CompareOptions *options = &arguments->options;
    if (options->engines != arguments->engines) options->engine_count = 0;
    options->engines = arguments->engines;
    for (int i = 0; i < options->engine_count; i++)
        if (arguments->engines[i] == engine) return;
    arguments->engines[options->engine_count++] = engine;
}

static bool is_library(const char *text) {
    size_t length = strlen(text);
    return length > 3 && !strcmp(text + length - 3, ".so") && !strchr(text, ' ');
}

// Adds an engine from outside to the table, which keeps it, and to those that are asked for.
static ck_Status take_outside(ck_Arguments *arguments, ck_Engine *engine, ck_Error *error) {
    ck_Status status = ck_engines_add(engine, error);
    if (!status)
        add_engine(arguments, engine);
    else
        ck_outside_free(engine);
    return status;
}

// NAME=ENGINE, of the table.
static ck_Status add_copy(ck_Arguments *arguments, const char *name, const ck_Engine *of, ck_Error *error) {
    const ck_Engine *copy;
    ck_Status status = ck_engines_add_copy(&copy, name, of, error);
    if (!status) add_engine(arguments, copy);
    return status;
}

// NAME=ENGINE, NAME=COMMAND, NAME=LIBRARY.so or LIBRARY.so.
static ck_Status add_outside(ck_Arguments *arguments, const char *text, ck_Error *error) {
    char name[64];
    ck_Engine *engine;
    const char *equals = strchr(text, '='), *rest = equals ? equals + 1 : text;
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - text) : 0, text);
    const ck_Engine *of = equals ? ck_engine_find(rest) : NULL;
    if (of) return add_copy(arguments, name, of, error);
    ck_Status status = is_library(rest) ? ck_outside_library(&engine, equals ? name : NULL, rest, error)
                                        : ck_outside_command(&engine, name, rest, false, error);
    return status ? status : take_outside(arguments, engine, error);
}

static int is_shown(const struct dirent *entry) {
    return entry->d_name[0] != '.';
}

int ck_adapters_visit(const char *pattern, bool (*visit)(void *context, const char *name, const char *path),
                      void *context) {
    char directory[4096];
    struct dirent **entries;
    int visited = 0,
        count = ck_path_adapters(directory, sizeof directory) ? scandir(directory, &entries, is_shown, alphasort) : -1;
    bool goes_on = true;
    for (int i = 0; i < count; i++) {
        char *path = ck_path_join(directory, entries[i]->d_name);
        if (goes_on && path && !fnmatch(pattern, entries[i]->d_name, 0) && !access(path, X_OK)) {
            visited++;
            goes_on = visit(context, entries[i]->d_name, path);
        }
        free(path);
        free(entries[i]);
    }
    if (count >= 0) free(entries);
    return visited;
}

ck_Status ck_adapter_open(ck_Engine **engine, const char *name, const char *path, ck_Error *error) {
    char *line;
    *engine = NULL;
    if (asprintf(&line, "'%s'", path) < 0) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = ck_outside_command(engine, name, line, true, error);
    free(line);
    return status;
}

typedef struct Search {
    ck_Arguments *arguments;
    ck_Error *error;
    ck_Status status;
} Search;

static bool take_adapter(void *context, const char *name, const char *path) {
    Search *search = context;
    ck_Engine *engine;
    search->status = ck_adapter_open(&engine, name, path, search->error);
    if (!search->status) search->status = take_outside(search->arguments, engine, search->error);
    return !search->status;
}

ck_Status ck_arguments_add_engines(ck_Arguments *arguments, const char *text, ck_Error *error) {
    if (strchr(text, '=') || is_library(text)) return add_outside(arguments, text, error);
    int found = 0;
    for (int i = 0; i < ck_engine_count(); i++)
        if (!fnmatch(text, ck_engine_at(i)->name, 0)) {
            add_engine(arguments, ck_engine_at(i));
            found++;
        }
    if (found) return CK_OK;
    Search search = {.arguments = arguments, .error = error};
    return ck_adapters_visit(text, take_adapter, &search) ? search.status : ck_engine_unknown(text, error);
}
