#include "command.h"

#include <errno.h>
#include <getopt.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    OUT,
    ENGINE,
    SET,
    REPEATS,
    BUDGET,
    TIME_LIMIT,
    MEMORY_LIMIT,
    SEED,
    THREADS,
    JOBS,
    SHARD,
    ERROR,
    LIKE,
    VARY,
    VALIDATE,
    UPDATE,
    KEPT
};

// Options, what they are, and the groups of commands that take them; 0: all.
static const struct {
    const char *name;
    unsigned groups;
    const char *help;
} known_options[] = {
    [OUT] = {"out", 0, "--out DIR            write the CSVs into DIR"},
    [ENGINE] = {"engine", 0, "--engine NAME        run this engine only; may be given several times"},
    [SET] = {"set", 0,
             "--set ENGINE.KEY=N   substeps, iterations, relaxation, compliance, klst, mended, reordered, threads or "
             "vectors\n                       of an engine, over the scene's own"},
    [REPEATS] = {"repeats", CK_TAKES_TIMING, "--repeats N          timed repeats, 0 to 99 (default 5)"},
    [BUDGET] = {"budget", CK_TAKES_TIMING, "--budget S           CPU seconds per timed repeat at most (default 2)"},
    [TIME_LIMIT] = {"time-limit", 0, "--time-limit S       wall seconds that one run may take (default 900)"},
    [MEMORY_LIMIT] = {"memory-limit", 0, "--memory-limit MIB   memory that one run may take (default 4096)"},
    [SEED] = {"seed", CK_TAKES_TIMING, "--seed N             of the order in which engines are timed (default 1)"},
    [THREADS] =
        {"threads", 0,
         "--threads N          that share a step of native-verlet, native-bars and native-xpbd on regular cloths"},
    [JOBS] = {"jobs", CK_TAKES_JOBS,
              "--jobs N             worker processes (default one a core; one where time counts)"},
    [SHARD] = {"shard", CK_TAKES_SHARD,
               "--shard I/N          only every N-th case, from the I-th; 'clothcheck merge' joins the parts"},
    [ERROR] = {"error", CK_TAKES_GOAL | CK_TAKES_ERROR, "--error X            a tolerance, in units of size"},
    [LIKE] = {"like", CK_TAKES_GOAL, "--like ENGINE        come close to that engine's path instead of the truth"},
    [VARY] = {"vary", CK_TAKES_GOAL,
              "--vary KEY           search compliance, klst or stiffness, too; may be given several times"},
    [VALIDATE] = {"validate", CK_TAKES_GOAL,
                  "--validate SCENE     try the result on that scene, too; may be given several times"},
    [UPDATE] = {"update", CK_TAKES_UPDATE, "--update             write the baseline anew, and print what moved"},
    [KEPT] = {"kept", CK_TAKES_SHARD,
              "--kept               run nothing: write what the journal in --out holds, or fail"},
};
#define OPTIONS ((int)(sizeof known_options / sizeof *known_options))

void ck_arguments_help(unsigned groups) {
    for (int i = 0; i < OPTIONS; i++)
        if (!known_options[i].groups || (known_options[i].groups & groups)) printf("  %s\n", known_options[i].help);
    printf("  --help               this text\n\nA SCENE is a path, or a bare name that stands for scenes/NAME.yaml.\n");
}

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

static ck_Status read_shard(ck_Arguments *arguments, const char *text, ck_Error *error) {
    int used = 0;
    if (sscanf(text, "%d/%d%n", &arguments->shard, &arguments->shards, &used) == 2 && !text[used] &&
        arguments->shard >= 1 && arguments->shard <= arguments->shards && arguments->shards <= 10000)
        return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "--shard %s: it must read I/N with 1 <= I <= N, as in 2/4", text);
}

static ck_Status add_variable(ck_Arguments *arguments, const char *key, ck_Error *error) {
    int variable = strcmp(key, "stiffness") ? (int)ck_setting_find(key) : CK_SETTING_COUNT;
    if (variable != CK_SET_COMPLIANCE && variable != CK_SET_KLST && strcmp(key, "stiffness"))
        return ck_fail(error, CK_BAD_INPUT, "--vary %s: the key must be compliance, klst or stiffness", key);
    arguments->varies[variable] = true;
    return CK_OK;
}

// The path of a scene: as it is, or scenes/NAME.yaml for a bare name. NULL without memory.
static char *path_of(const char *scene) {
    bool bare = !strchr(scene, '/') && !strchr(scene, '.');
    size_t size = strlen(scene) + sizeof "scenes/.yaml";
    char *path = malloc(size);
    if (path) snprintf(path, size, bare ? "scenes/%s.yaml" : "%s", scene);
    return path;
}

static ck_Status add_validation(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    const int most = sizeof arguments->validate / sizeof *arguments->validate;
    if (arguments->validate_count == most)
        return ck_fail(error, CK_BAD_INPUT, "--validate is given more than %d times", most);
    char *path = path_of(scene);
    if (!path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    arguments->validate[arguments->validate_count++] = path;
    return CK_OK;
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
    case TIME_LIMIT:
        arguments->has_time_limit = true;
        status = read_number(&options->limits.seconds, value, 0, 1e9, "--time-limit", error);
        break;
    case MEMORY_LIMIT:
        status = read_number(&number, value, 0, 1e9, "--memory-limit", error);
        if (!status) options->limits.memory_bytes = (size_t)(number * 1048576);
        break;
    case SEED:
        status = read_number(&number, value, 0, 1e15, "--seed", error);
        if (!status) options->seed = (uint64_t)number;
        break;
    case JOBS:
        status = read_number(&number, value, 1, 1024, "--jobs", error);
        if (!status) arguments->jobs = (int)number;
        break;
    case SHARD: status = read_shard(arguments, value, error); break;
    case ERROR: status = read_number(&arguments->error, value, 0, 1e6, "--error", error); break;
    case LIKE: status = find_engine(&arguments->like, value, error); break;
    case KEPT: arguments->runs_nothing = true; break;
    case UPDATE: arguments->is_update = true; break;
    case VARY: status = add_variable(arguments, value, error); break;
    case VALIDATE: status = add_validation(arguments, value, error); break;
    case THREADS:
        status = read_number(&number, value, 1, ck_setting_keys[CK_SET_THREADS].largest, "--threads", error);
        for (int i = 0; i < ck_engine_count() && !status; i++) status = set_threads(arguments, i, number, error);
        break;
    default: return CK_BAD_INPUT;
    }
    return status;
}

static ck_Status add_scene(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    char *path = path_of(scene);
    char **scenes = realloc(arguments->scenes, sizeof *scenes * (size_t)(arguments->scene_count + 1));
    if (scenes) arguments->scenes = scenes;
    if (!path || !scenes) {
        free(path);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    arguments->scenes[arguments->scene_count++] = path;
    return CK_OK;
}

ck_Status ck_arguments_all_scenes(ck_Arguments *arguments, ck_Error *error) {
    glob_t found;
    if (arguments->scene_count) return CK_OK;
    if (glob("scenes/*.yaml", 0, NULL, &found))
        return ck_fail(error, CK_BAD_INPUT,
                       "no SCENE is given and there is none in scenes/; give the paths of scene files");
    ck_Status status = CK_OK;
    for (size_t i = 0; i < found.gl_pathc && !status; i++) status = add_scene(arguments, found.gl_pathv[i], error);
    globfree(&found);
    return status;
}

// Adds an option and its value, or a word alone.
static ck_Status add_to_question(ck_Arguments *arguments, const char *option, const char *value, ck_Error *error) {
    size_t size = sizeof arguments->question, used = strlen(arguments->question);
    used += (size_t)snprintf(arguments->question + used, size - used, "%s%s%s%s%s", used ? "\t" : "",
                             option ? "--" : "", option ? option : "", option && value ? "\t" : "", value ? value : "");
    return used < size ? CK_OK : ck_fail(error, CK_BAD_INPUT, "the command line is longer than %zu characters", size);
}

ck_Status ck_arguments_read(ck_Arguments *arguments, int argc, char **argv, unsigned groups, ck_Error *error) {
    *arguments = (ck_Arguments){.options = ck_compare_options_default(), .error = NAN};
    arguments->options.overrides = arguments->overrides;
    struct option table[OPTIONS + 1] = {0};
    int count = 0;
    for (int i = 0; i < OPTIONS; i++)
        if (!known_options[i].groups || (known_options[i].groups & groups))
            table[count++] = (struct option){known_options[i].name,
                                             i == UPDATE || i == KEPT ? no_argument : required_argument, NULL, i};
    ck_Status status = add_to_question(arguments, NULL, argv[0], error);
    optind = 0; // start anew, whoever parsed before
    opterr = 0;
    for (int option; !status && (option = getopt_long(argc, argv, ":", table, NULL)) != -1;) {
        if (option == '?' || option == ':')
            return ck_fail(error, CK_BAD_INPUT, "%s: %s; 'clothcheck %s --help' tells what there is", argv[optind - 1],
                           option == ':' ? "needs a value" : "no such option", argv[0]);
        status = read_option(arguments, option, optarg, error);
        if (!status && option != OUT && option != JOBS && option != SHARD && option != KEPT)
            status = add_to_question(arguments, known_options[option].name, optarg, error);
    }
    for (int i = optind; i < argc && !status; i++) {
        status = add_scene(arguments, argv[i], error);
        if (!status) status = add_to_question(arguments, NULL, argv[i], error);
    }
    return status;
}

void ck_arguments_free(ck_Arguments *arguments) {
    for (int i = 0; i < arguments->scene_count; i++) free(arguments->scenes[i]);
    for (int i = 0; i < arguments->validate_count; i++) free(arguments->validate[i]);
    free(arguments->scenes);
    *arguments = (ck_Arguments){0};
}
