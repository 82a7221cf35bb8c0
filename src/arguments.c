#include "command.h"

#include "names.h"

#include <errno.h>
#include <getopt.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
    KEPT,
    APPEND,
    FORCE,
    ROUNDS,
    LARGEST
};

// Options, what they are, and the groups of commands that take them. One without a value is marked so.
static const struct {
    const char *name;
    unsigned groups;
    bool is_flag;
    const char *help;
} known_options[] = {
    [OUT] = {"out", CK_TAKES_OUT, false, "--out DIR            write the CSVs into DIR"},
    [ENGINE] = {"engine", CK_TAKES_RUNS, false,
                "--engine NAME        run this engine only; may be given several times"},
    [SET] = {"set", CK_TAKES_RUNS, false,
             "--set ENGINE.KEY=N   substeps, iterations, relaxation, compliance, klst, mended, reordered, threads or "
             "vectors\n                       of an engine that has it, over the scene's own"},
    [REPEATS] = {"repeats", CK_TAKES_TIMING, false, "--repeats N          timed repeats, 0 to 99 (default 5)"},
    [BUDGET] = {"budget", CK_TAKES_TIMING, false,
                "--budget S           CPU seconds per timed repeat at most (default 2)"},
    [TIME_LIMIT] = {"time-limit", CK_TAKES_RUNS, false, "--time-limit S       wall seconds that one run may take"},
    [MEMORY_LIMIT] = {"memory-limit", CK_TAKES_RUNS, false,
                      "--memory-limit MIB   memory that one run may take (default 4096)"},
    [SEED] = {"seed", CK_TAKES_TIMING, false,
              "--seed N             of the order in which engines are timed (default 1)"},
    [THREADS] =
        {"threads", CK_TAKES_RUNS, false,
         "--threads N          that share a step of native-verlet, native-bars and native-xpbd on regular cloths"},
    [JOBS] = {"jobs", CK_TAKES_JOBS, false,
              "--jobs N             worker processes (default one a core; one where time counts)"},
    [SHARD] = {"shard", CK_TAKES_SHARD, false,
               "--shard I/N          only every N-th case, from the I-th; 'clothcheck merge' joins the parts"},
    [ERROR] = {"error", CK_TAKES_GOAL | CK_TAKES_ERROR, false, "--error X            a tolerance, in units of size"},
    [LIKE] = {"like", CK_TAKES_GOAL, false,
              "--like ENGINE        come close to that engine's path instead of the truth"},
    [VARY] = {"vary", CK_TAKES_GOAL, false,
              "--vary KEY           search compliance, klst or stiffness, too; may be given several times"},
    [VALIDATE] = {"validate", CK_TAKES_GOAL, false,
                  "--validate SCENE     try the result on that scene, too; may be given several times"},
    [UPDATE] = {"update", CK_TAKES_UPDATE, true, "--update             write the baseline anew, and print what moved"},
    [KEPT] = {"kept", CK_TAKES_SHARD, true,
              "--kept               run nothing: write what the journal in --out holds, or fail"},
    [APPEND] =
        {"append", CK_TAKES_KEEPING, true,
         "--append             keep the results of other scenes that --out holds; of tune, of other engines, too"},
    [FORCE] = {"force", CK_TAKES_KEEPING, true, "--force              replace whatever results --out holds"},
    [ROUNDS] = {"rounds", CK_TAKES_BENCH, false, "--rounds N           repeats, 1 to 99 (default 7)"},
    [LARGEST] = {"largest", CK_TAKES_BENCH, false,
                 "--largest N          side of the largest cloth in the growth, 16 to 2048 (default 1024)"},
};
#define OPTIONS ((int)(sizeof known_options / sizeof *known_options))

void ck_arguments_help(const ck_Command *command) {
    for (int i = 0; i < OPTIONS; i++) {
        if (!(known_options[i].groups & command->groups)) continue;
        printf("  ");
        if (i == TIME_LIMIT)
            printf("--time-limit S       wall seconds that one run may take (default %g)", command->seconds);
        else
            printf("%s", known_options[i].help);
        printf("\n");
    }
    printf("  --help               this text\n");
    if (strstr(command->arguments, "SCENE"))
        printf("\nA SCENE is a path, or a bare name that stands for scenes/NAME.yaml.\n");
}

static ck_Status read_number(double *number, const char *text, double low, double high, const char *option,
                             ck_Error *error) {
    char *end;
    *number = strtod(text, &end);
    if (end == text || *end || !(*number >= low && *number <= high))
        return ck_fail(error, CK_BAD_INPUT, "%s %s: it must be a number from %g to %g", option, text, low, high);
    return CK_OK;
}

static ck_Status read_count(double *number, const char *text, double low, double high, const char *option,
                            ck_Error *error) {
    ck_Status status = read_number(number, text, low, high, option, NULL);
    if (!status && floor(*number) == *number) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "%s %s: it must be a whole number from %g to %.16g", option, text, low, high);
}

static ck_Status find_engine(const ck_Engine **engine, const char *name, ck_Error *error) {
    char known[400], hint[80];
    *engine = ck_engine_find(name);
    if (*engine) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "there is no engine %s%s; known are %s", name,
                   ck_name_hint(hint, sizeof hint, name, ck_engine_name, NULL),
                   ck_name_list(known, sizeof known, ck_engine_name, NULL));
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

// The settings of an engine, by their number among those that it has.
static const char *setting_name(const void *table, int index) {
    const ck_Engine *engine = table;
    for (int key = 0; key < CK_SETTING_COUNT; key++)
        if ((engine->settings & CK_HAS(key)) && index-- == 0) return ck_setting_keys[key].name;
    return NULL;
}

static ck_Status fail_unknown_key(const char *text, const char *key, const ck_Engine *engine, ck_Error *error) {
    char known[200], hint[80];
    return ck_fail(error, CK_BAD_INPUT, "--set %s: %s has no %s%s; it has %s", text, engine->name, key,
                   ck_name_hint(hint, sizeof hint, key, setting_name, engine),
                   engine->settings ? ck_name_list(known, sizeof known, setting_name, engine) : "no settings");
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
    if (status) return status;
    ck_Setting setting = ck_setting_find(key);
    if (setting == CK_SETTING_COUNT || !(override->engine->settings & CK_HAS(setting)))
        return fail_unknown_key(text, key, override->engine, error);
    char option[120];
    snprintf(option, sizeof option, "--set %s.%s =", name, key);
    const ck_SettingKey *known = &ck_setting_keys[setting];
    status = (known->is_whole ? read_count : read_number)(&number, text + used, 0, known->largest, option, error);
    if (status) return status;
    ck_setting_set(&override->settings, setting, number);
    return CK_OK;
}

// As --set ENGINE.threads=N of every engine that can share its steps.
static ck_Status set_threads(ck_Arguments *arguments, int engine, double threads, ck_Error *error) {
    char text[64];
    if (!(ck_engine_at(engine)->settings & CK_HAS(CK_SET_THREADS))) return CK_OK;
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

static const char *scene_name(const void *table, int index) {
    const glob_t *found = table;
    return index < (int)found->gl_pathc ? found->gl_pathv[index] + strlen("scenes/") : NULL;
}

static ck_Status fail_scene(const char *name, ck_Error *error) {
    glob_t found = {0};
    char hint[240] = "";
    if (!glob("scenes/*.yaml", 0, NULL, &found)) {
        for (size_t i = 0; i < found.gl_pathc; i++) *strrchr(found.gl_pathv[i], '.') = 0;
        ck_name_hint(hint, sizeof hint, name, scene_name, &found);
    }
    globfree(&found);
    return ck_fail(error, CK_BAD_INPUT,
                   "there is no scenes/%s.yaml%s; give a path, or a name that 'clothcheck list' tells", name, hint);
}

// The path of a scene: as it is, or scenes/NAME.yaml for a bare name. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
static ck_Status find_path(char **path, const char *scene, ck_Error *error) {
    bool is_bare = !strchr(scene, '/') && !strchr(scene, '.');
    size_t size = strlen(scene) + sizeof "scenes/.yaml";
    *path = malloc(size);
    if (!*path) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    snprintf(*path, size, is_bare ? "scenes/%s.yaml" : "%s", scene);
    if (!is_bare || !access(*path, F_OK)) return CK_OK;
    free(*path);
    *path = NULL;
    return fail_scene(scene, error);
}

static ck_Status add_validation(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    const int most = sizeof arguments->validate / sizeof *arguments->validate;
    if (arguments->validate_count == most)
        return ck_fail(error, CK_BAD_INPUT, "--validate is given more than %d times", most);
    ck_Status status = find_path(&arguments->validate[arguments->validate_count], scene, error);
    if (!status) arguments->validate_count++;
    return status;
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
        status = read_count(&number, value, 0, CK_MAX_REPEATS, "--repeats", error);
        if (!status) options->repeats = (int)number;
        break;
    case BUDGET: status = read_number(&options->budget, value, 0, 1e6, "--budget", error); break;
    case TIME_LIMIT: status = read_number(&options->limits.seconds, value, 0, 1e9, "--time-limit", error); break;
    case MEMORY_LIMIT:
        status = read_number(&number, value, 0, 1e9, "--memory-limit", error);
        if (!status) options->limits.memory_bytes = (size_t)(number * 1048576);
        break;
    case SEED:
        status = read_count(&number, value, 0, 1e15, "--seed", error);
        if (!status) options->seed = (uint64_t)number;
        break;
    case JOBS:
        status = read_count(&number, value, 1, 1024, "--jobs", error);
        if (!status) arguments->jobs = (int)number;
        break;
    case SHARD: status = read_shard(arguments, value, error); break;
    case ERROR: status = read_number(&arguments->error, value, 0, 1e6, "--error", error); break;
    case LIKE: status = find_engine(&arguments->like, value, error); break;
    case KEPT: arguments->runs_nothing = true; break;
    case UPDATE: arguments->is_update = true; break;
    case APPEND: arguments->appends = true; break;
    case FORCE: arguments->forces = true; break;
    case ROUNDS:
        status = read_count(&number, value, 1, 99, "--rounds", error);
        if (!status) arguments->rounds = (int)number;
        break;
    case LARGEST:
        status = read_count(&number, value, 16, 2048, "--largest", error);
        if (!status) arguments->largest = (int)number;
        break;
    case VARY: status = add_variable(arguments, value, error); break;
    case VALIDATE: status = add_validation(arguments, value, error); break;
    case THREADS:
        status = read_count(&number, value, 1, ck_setting_keys[CK_SET_THREADS].largest, "--threads", error);
        for (int i = 0; i < ck_engine_count() && !status; i++) status = set_threads(arguments, i, number, error);
        break;
    default: return CK_BAD_INPUT;
    }
    return status;
}

static ck_Status add_scene(ck_Arguments *arguments, const char *scene, ck_Error *error) {
    char **scenes = realloc(arguments->scenes, sizeof *scenes * (size_t)(arguments->scene_count + 1));
    if (!scenes) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    arguments->scenes = scenes;
    ck_Status status = find_path(&scenes[arguments->scene_count], scene, error);
    if (!status) arguments->scene_count++;
    return status;
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

static const char *option_name(const void *table, int index) {
    const ck_Command *command = table;
    for (int i = 0; i < OPTIONS; i++)
        if ((known_options[i].groups & command->groups) && index-- == 0) return known_options[i].name;
    return NULL;
}

static ck_Status fail_option(const ck_Command *command, int option, const char *text, ck_Error *error) {
    const char *name = text + strspn(text, "-"), *nearest = ck_name_nearest(name, option_name, command);
    char hint[80] = "";
    if (option != ':' && nearest) snprintf(hint, sizeof hint, "; did you mean --%s?", nearest);
    return ck_fail(error, CK_BAD_INPUT, "%s: %s%s; 'clothcheck %s --help' tells what there is", text,
                   option == ':' ? "needs a value" : "no such option", hint, command->name);
}

// What is asked, in which the way to the answer does not count.
static bool is_of_question(int option) {
    return option != OUT && option != JOBS && option != SHARD && option != KEPT && option != APPEND && option != FORCE;
}

ck_Status ck_arguments_read(ck_Arguments *arguments, const ck_Command *command, int argc, char **argv,
                            ck_Error *error) {
    *arguments = (ck_Arguments){.options = ck_compare_options_default(), .error = NAN, .rounds = 7, .largest = 1024};
    arguments->options.overrides = arguments->overrides;
    if (command->seconds > 0) arguments->options.limits.seconds = command->seconds;
    struct option table[OPTIONS + 1] = {0};
    int count = 0;
    for (int i = 0; i < OPTIONS; i++)
        if (known_options[i].groups & command->groups)
            table[count++] = (struct option){known_options[i].name,
                                             known_options[i].is_flag ? no_argument : required_argument, NULL, i};
    ck_Status status = add_to_question(arguments, NULL, argv[0], error);
    optind = 0; // start anew, whoever parsed before
    opterr = 0;
    for (int option; !status && (option = getopt_long(argc, argv, ":", table, NULL)) != -1;) {
        if (option == '?' || option == ':') return fail_option(command, option, argv[optind - 1], error);
        status = read_option(arguments, option, optarg, error);
        if (!status && is_of_question(option))
            status = add_to_question(arguments, known_options[option].name, optarg, error);
    }
    bool takes_scenes = strstr(command->arguments, "SCENE") != NULL;
    for (int i = optind; i < argc && !status; i++)
        status = takes_scenes ? add_scene(arguments, argv[i], error)
                              : ck_fail(error, CK_BAD_INPUT, "%s: %s takes no SCENE", argv[i], command->name);
    return status;
}

void ck_arguments_free(ck_Arguments *arguments) {
    for (int i = 0; i < arguments->scene_count; i++) free(arguments->scenes[i]);
    for (int i = 0; i < arguments->validate_count; i++) free(arguments->validate[i]);
    free(arguments->scenes);
    *arguments = (ck_Arguments){0};
}
