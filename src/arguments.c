#include "command.h"

#include <errno.h>
#include <getopt.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char ck_arguments_help[] =
    "  --out DIR            write the CSVs into DIR\n"
    "  --engine NAME        run this engine only; may be given several times\n"
    "  --set ENGINE.KEY=N   substeps, iterations, relaxation, compliance, klst, mended, reordered or threads of an\n"
    "                       engine, over the scene's own\n"
    "  --threads N          that share a step of native-verlet, native-bars and native-xpbd on regular cloths\n"
    "  --repeats N          timed repeats, 0 to 99 (usually 5)\n"
    "  --budget S           CPU seconds per timed repeat at most (usually 2)\n"
    "  --time-limit S       wall seconds that one run may take (usually 900)\n"
    "  --memory-limit MIB   memory that one run may take (usually 4096)\n"
    "  --seed N             of the order in which engines are timed (usually 1)\n"
    "  --help               this text\n"
    "\nA SCENE is a path, or a bare name that stands for scenes/NAME.yaml.\n";

enum { OUT, ENGINE, SET, REPEATS, BUDGET, TIME_LIMIT, MEMORY_LIMIT, SEED, THREADS };

static const struct option option_table[] = {
    {"out", required_argument, NULL, OUT},
    {"engine", required_argument, NULL, ENGINE},
    {"set", required_argument, NULL, SET},
    {"repeats", required_argument, NULL, REPEATS},
    {"budget", required_argument, NULL, BUDGET},
    {"time-limit", required_argument, NULL, TIME_LIMIT},
    {"memory-limit", required_argument, NULL, MEMORY_LIMIT},
    {"seed", required_argument, NULL, SEED},
    {"threads", required_argument, NULL, THREADS},
    {NULL, 0, NULL, 0},
};

static ck_Status read_number(double *number, const char *text, double low, double high, const char *option,
                             ck_Error *error) {
    char *end;
    *number = strtod(text, &end);
    if (end == text || *end || !(*number >= low && *number <= high))
        return ck_fail(error, CK_BAD_INPUT, "%s %s: it must be a number from %g to %g", option, text, low, high);
    return CK_OK;
}

static ck_Status find_engine(const ck_Engine **engine, const char *name, ck_Error *error) {
    *engine = ck_engine_find(name);
    if (*engine) return CK_OK;
    char known[400] = "";
    for (int i = 0, used = 0; i < ck_engine_count(); i++)
        used += snprintf(known + used, sizeof known - (size_t)used, "%s%s", i ? ", " : "", ck_engine_at(i)->name);
    return ck_fail(error, CK_BAD_INPUT, "there is no engine %s; known are %s", name, known);
}

static ck_Status add_engine(ck_Arguments *arguments, const char *name, ck_Error *error) {
    const ck_Engine *engine;
    ck_Status status = find_engine(&engine, name, error);
    if (status) return status;
    ck_CompareOptions *options = &arguments->options;
    if (options->engines != arguments->engines) options->engine_count = 0;
    options->engines = arguments->engines;
    for (int i = 0; i < options->engine_count; i++)
        if (arguments->engines[i] == engine) return CK_OK;
    arguments->engines[options->engine_count++] = engine;
    return CK_OK;
}

static ck_Status fail_unknown_key(const char *text, ck_Error *error) {
    char known[200] = "";
    for (int i = 0, used = 0; i < CK_SETTING_COUNT; i++)
        used += snprintf(known + used, sizeof known - (size_t)used, "%s%s", i ? ", " : "", ck_setting_keys[i].name);
    return ck_fail(error, CK_BAD_INPUT, "--set %s: the key must be one of %s", text, known);
}

static ck_Status add_override(ck_Arguments *arguments, const char *text, ck_Error *error) {
    char name[64], key[32];
    int used = 0;
    ck_CompareOptions *options = &arguments->options;
    if (sscanf(text, "%63[^.=].%31[^.=]=%n", name, key, &used) != 2 || !used)
        return ck_fail(error, CK_BAD_INPUT, "--set %s: it must read ENGINE.KEY=NUMBER, as in ode-quick.substeps=16",
                       text);
    if (options->override_count == sizeof arguments->overrides / sizeof *arguments->overrides)
        return ck_fail(error, CK_BAD_INPUT, "--set is given more than %d times", options->override_count);
    ck_Override *override = &arguments->overrides[options->override_count++];
    *override = (ck_Override){0};
    double number;
    ck_Status status = find_engine(&override->engine, name, error);
    ck_Setting setting = ck_setting_find(key);
    if (!status && setting == CK_SETTING_COUNT) status = fail_unknown_key(text, error);
    if (!status) status = read_number(&number, text + used, 0, ck_setting_keys[setting].largest, "--set", error);
    if (status) return status;
    if (ck_setting_keys[setting].is_whole && floor(number) != number)
        return ck_fail(error, CK_BAD_INPUT, "--set %s: %s must be a whole number", text, key);
    ck_setting_set(&override->settings, setting, number);
    return CK_OK;
}

// As --set ENGINE.threads=N of every engine that can share its steps.
static ck_Status set_threads(ck_Arguments *arguments, int engine, double threads, ck_Error *error) {
    char text[64];
    if (!ck_engine_at(engine)->shares_steps) return CK_OK;
    snprintf(text, sizeof text, "%s.threads=%g", ck_engine_at(engine)->name, threads);
    return add_override(arguments, text, error);
}

static ck_Status read_option(ck_Arguments *arguments, int option, const char *value, ck_Error *error) {
    ck_CompareOptions *options = &arguments->options;
    double number;
    ck_Status status = CK_OK;
    switch (option) {
    case OUT: arguments->out = value; break;
    case ENGINE: status = add_engine(arguments, value, error); break;
    case SET: status = add_override(arguments, value, error); break;
    case REPEATS:
        status = read_number(&number, value, 0, CK_MAX_REPEATS, "--repeats", error);
        if (!status) options->repeats = (int)number;
        break;
    case BUDGET: status = read_number(&options->budget, value, 0, 1e6, "--budget", error); break;
    case TIME_LIMIT: status = read_number(&options->limits.seconds, value, 0, 1e9, "--time-limit", error); break;
    case MEMORY_LIMIT:
        status = read_number(&number, value, 0, 1e9, "--memory-limit", error);
        if (!status) options->limits.memory_bytes = (size_t)(number * 1048576);
        break;
    case SEED:
        status = read_number(&number, value, 0, 1e15, "--seed", error);
        if (!status) options->seed = (uint64_t)number;
        break;
    case THREADS:
        status = read_number(&number, value, 1, ck_setting_keys[CK_SET_THREADS].largest, "--threads", error);
        for (int i = 0; i < ck_engine_count() && !status; i++) status = set_threads(arguments, i, number, error);
        break;
    default: return CK_BAD_INPUT;
    }
    return status;
}

static ck_Status add_scene(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    bool bare = !strchr(scene, '/') && !strchr(scene, '.');
    size_t size = strlen(scene) + sizeof "scenes/.yaml";
    char *path = malloc(size);
    char **scenes = realloc(arguments->scenes, sizeof *scenes * (size_t)(arguments->scene_count + 1));
    if (scenes) arguments->scenes = scenes;
    if (!path || !scenes) {
        free(path);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    snprintf(path, size, bare ? "scenes/%s.yaml" : "%s", scene);
    arguments->scenes[arguments->scene_count++] = path;
    return CK_OK;
}

static ck_Status add_all_scenes(ck_Arguments *arguments, ck_Error *error) {
    glob_t found;
    if (glob("scenes/*.yaml", 0, NULL, &found))
        return ck_fail(error, CK_BAD_INPUT,
                       "no SCENE is given and there is none in scenes/; give the paths of scene files");
    ck_Status status = CK_OK;
    for (size_t i = 0; i < found.gl_pathc && !status; i++) status = add_scene(arguments, found.gl_pathv[i], error);
    globfree(&found);
    return status;
}

ck_Status ck_arguments_read(ck_Arguments *arguments, int argc, char **argv, ck_Error *error) {
    *arguments = (ck_Arguments){.options = ck_compare_options_default()};
    arguments->options.overrides = arguments->overrides;
    ck_Status status = CK_OK;
    optind = 0; // start anew, whoever parsed before
    opterr = 0;
    for (int option; !status && (option = getopt_long(argc, argv, ":", option_table, NULL)) != -1;) {
        if (option == '?' || option == ':')
            return ck_fail(error, CK_BAD_INPUT, "%s: %s; 'clothcheck %s --help' tells what there is", argv[optind - 1],
                           option == ':' ? "needs a value" : "no such option", argv[0]);
        status = read_option(arguments, option, optarg, error);
    }
    for (int i = optind; i < argc && !status; i++) status = add_scene(arguments, argv[i], error);
    if (!status && !arguments->scene_count) status = add_all_scenes(arguments, error);
    return status;
}

void ck_arguments_free(ck_Arguments *arguments) {
    for (int i = 0; i < arguments->scene_count; i++) free(arguments->scenes[i]);
    free(arguments->scenes);
    *arguments = (ck_Arguments){0};
}
