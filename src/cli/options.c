#include "asked_engines.h"
#include "asked_settings.h"
#include "command.h"
#include "picture_options.h"

#include "names.h"

#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What a value is, and so where it goes: a bool, a const char *, a double, an int; or what read makes of it.
typedef enum Kind { FLAG, TEXT, NUMBER, COUNT, OTHER } Kind;

typedef struct Option {
    const char *name, *value; // as in --name VALUE
    char letter;              // -x; 0: none
    unsigned groups;          // of commands that take it
    Kind kind;
    size_t place;         // in ck_Arguments
    double least, most;   // of a number
    const char *fallback; // where it is not given; NULL: nothing to say
    const char *help;
    ck_Status (*read)(ck_Arguments *arguments, const char *text, ck_Error *error);
    bool is_way; // it says how to come to the answer, not what is asked
} Option;

static ck_Status set_full(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status set_memory(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status set_seed(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status set_threads(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status read_shard(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status add_variable(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status add_tolerance(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status set_json(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status set_markdown(ck_Arguments *arguments, const char *text, ck_Error *error);
static ck_Status add_validation(ck_Arguments *arguments, const char *text, ck_Error *error);

#define PLACE(member) offsetof(ck_Arguments, member)

// Adding an option is one row here, and a member of ck_Arguments.
static const Option table[] = {
    {"out", "DIR", 'o', CK_TAKES_OUT, TEXT, PLACE(out), .help = "write the CSVs into DIR", .is_way = true},
    {"engine", "NAME", 'e', CK_TAKES_RUNS | CK_TAKES_STUDY, OTHER, .fallback = "all", .read = ck_arguments_add_engines,
     .help =
         "only this engine, or those of a pattern as 'bullet-*', or one of your own: a command as 'mine=./adapter "
         "--fast', or a library as ./libmine.so; or one under a second name, for other settings: 'fine=native-xpbd'; "
         "may be given several times"},
    {"set", "[ENGINE.]KEY=N", 's', CK_TAKES_RUNS, OTHER, .read = ck_arguments_add_setting,
     .help = "a setting of an engine, over the scene's own; 'clothcheck list ENGINE' tells them"},
    {"threads", "N", 't', CK_TAKES_RUNS, OTHER, .fallback = "1", .read = set_threads,
     .help = "threads a step, where an engine can share one: regular cloths, any springs of native-verlet, and meshes "
             "where a substep has several sweeps"},
    {"time-limit", "S", 0, CK_TAKES_RUNS | CK_TAKES_STUDY, NUMBER, PLACE(options.limits.seconds), 0, 1e9,
     .help = "wall seconds that one run may take"},
    {"memory-limit", "MIB", 0, CK_TAKES_RUNS | CK_TAKES_STUDY, OTHER, .fallback = "4096", .read = set_memory,
     .help = "memory that one run may take"},
    {"repeats", "N", 'r', CK_TAKES_TIMING, COUNT, PLACE(options.repeats), 0, CK_MAX_REPEATS,
     .fallback = "until the median is known to 2 %, or --enough", .help = "timed repeats, 0 to 99"},
    {"enough", "S", 0, CK_TAKES_TIMING, NUMBER, PLACE(options.enough), 0, 1e6, .fallback = "1",
     .help = "wall seconds for all repeats of an engine, where --repeats does not say how many"},
    {"patience", "S", 'p', CK_TAKES_PATIENCE, NUMBER, PLACE(options.limits.patience), 0, 1e9,
     .help = "CPU seconds that a whole run may cost, or it is cut and scored as far as it came; 0: any"},
    {"full", NULL, 0, CK_TAKES_TIMING, OTHER, .read = set_full,
     .help = "all the depth: any cost, five repeats of up to 2 s, self-consistency of costly engines, too"},
    {"rank-without", "PATTERN", 0, CK_TAKES_TIMING, TEXT, PLACE(rank_without), .is_way = true,
     .help = "engines that the answer does not name, as 'native-*': those of the host of the table"},
    {"budget", "S", 0, CK_TAKES_TIMING, NUMBER, PLACE(options.budget), 0, 1e6, .fallback = "0.5",
     .help = "CPU seconds a timed repeat at most"},
    {"seed", "N", 0, CK_TAKES_TIMING, OTHER, .fallback = "1", .read = set_seed,
     .help = "for the order in which engines are timed"},
    {"jobs", "N", 'j', CK_TAKES_JOBS, COUNT, PLACE(options.jobs), 1, 1024,
     .fallback = "one a core; one where time counts", .help = "worker processes", .is_way = true},
    {"shard", "I/N", 0, CK_TAKES_SHARD | CK_TAKES_PART, OTHER, .read = read_shard, .is_way = true,
     .help = "only every N-th case, from the I-th; 'clothcheck merge' joins the parts"},
    {"kept", NULL, 0, CK_TAKES_SHARD, FLAG, PLACE(runs_nothing), .is_way = true,
     .help = "run nothing: write what the journal in --out holds, or fail"},
    {"case-limit", "S", 0, CK_TAKES_STUDY, NUMBER, PLACE(case_limit), 0, 1e9, .fallback = "3600",
     .help = "wall seconds that a case may take, where it is more than a run"},
    {"timeout", "S", 0, CK_TAKES_STUDY, NUMBER, PLACE(study_timeout), 0, 1e9, .fallback = "none", .is_way = true,
     .help = "begin no case after so many wall seconds; the same command goes on there"},
    {"part", NULL, 0, CK_TAKES_STUDY, FLAG, PLACE(is_part), .is_way = true,
     .help = "as one of several processes, on one machine or on many, that share the cases in --out: end when there is "
             "none left to take, and write no CSVs"},
    {"slurm", NULL, 0, CK_TAKES_STUDY, FLAG, PLACE(uses_slurm), .is_way = true,
     .help = "submit an array of parts to Slurm, and a job that writes the CSVs when they have ended"},
    {"partition", "NAME", 0, CK_TAKES_STUDY, TEXT, PLACE(partition), .is_way = true, .help = "of --slurm"},
    {"array", "N", 0, CK_TAKES_STUDY, COUNT, PLACE(array), 1, 10000, .fallback = "8", .is_way = true,
     .help = "of --slurm: parts"},
    {"array-limit", "N", 0, CK_TAKES_STUDY, COUNT, PLACE(array_limit), 1, 10000, .fallback = "all", .is_way = true,
     .help = "of --slurm: parts at a time"},
    {"cores", "N", 0, CK_TAKES_STUDY, COUNT, PLACE(cores), 1, 1024, .fallback = "1", .is_way = true,
     .help = "of --slurm: cores of a part"},
    {"slurm-time", "TIME", 0, CK_TAKES_STUDY, TEXT, PLACE(slurm_time), .is_way = true,
     .help = "of --slurm: what a part may take, as 2:00:00; what is left is submitted again"},
    {"dry-run", NULL, 0, CK_TAKES_STUDY, FLAG, PLACE(is_dry), .is_way = true,
     .help = "say what would be run, with --slurm the scripts, and run nothing"},
    {"finish", NULL, 0, CK_TAKES_STUDY, FLAG, PLACE(finishes), .is_way = true,
     .help = "the last job of --slurm: write the CSVs where all cases are there, else submit again what is left, as "
             "long as that gets further"},
    {"error", "X", 0, CK_TAKES_GOAL | CK_TAKES_ERROR, NUMBER, PLACE(error), 0, 1e6,
     .help = "a tolerance, in units of size"},
    {"timeout", "S", 0, CK_TAKES_GOAL, NUMBER, PLACE(timeout), 0, 1e9, .fallback = "60", .is_way = true,
     .help = "wall seconds for the whole search; 0: any"},
    {"stretch", "X", 0, CK_TAKES_GOAL, NUMBER, PLACE(stretch), 1e-12, 1e6,
     .help = "the largest strain at the end that is fine, as 0.05"},
    {"max-frame-ms", "MS", 0, CK_TAKES_GOAL, NUMBER, PLACE(frame), 1e-9, 1e9,
     .help = "CPU milliseconds that 1/60 s of the scene may cost"},
    {"like", "ENGINE|FILE", 0, CK_TAKES_GOAL, TEXT, PLACE(like),
     .help = "come close to that engine's path, or to a recorded one, instead of the truth"},
    {"target", "METRIC=VALUE", 0, CK_TAKES_GOAL, TEXT, PLACE(target),
     .help = "come close to that value instead, as sag=0.12, or sag=0.3m in metres"},
    {"vary", "KEY", 0, CK_TAKES_GOAL | CK_TAKES_FIT, OTHER, .read = add_variable,
     .help = "what is searched for: of tune stiffness, compliance or kLST, of fit stiffness, damping or drag; may be "
             "given several times"},
    {"validate", "SCENE", 0, CK_TAKES_GOAL, OTHER, .read = add_validation,
     .help = "try the result on that scene, too; may be given several times"},
    {"points", "FILE", 0, CK_TAKES_FIT, TEXT, PLACE(points),
     .help = "where particles were seen: a CSV with the header time_s,particle,x,y,z; s and m"},
    {"uncertainty", "M", 0, CK_TAKES_FIT, NUMBER, PLACE(uncertainty), 1e-12, 1e6, .fallback = "0.0003",
     .help = "of each coordinate of --points, standard, m; the default is that of rounding to 1 mm"},
    {"path", "FILE", 0, CK_TAKES_RECORDING, TEXT, PLACE(path),
     .help = "the recording: a CSV with time_s, particle, x, y, z, or time_s, x0, y0, z0, x1 ..., with vx, vy, vz or "
             "without; or a .npy of [frames][particles][3]; s and m"},
    {"name", "NAME", 0, CK_TAKES_RECORDING, TEXT, PLACE(name), .fallback = "recorded",
     .help = "the solver's name in tables and charts"},
    {"cost-ms", "MS", 0, CK_TAKES_RECORDING, NUMBER, PLACE(frame_cost), 0, 1e9,
     .help = "CPU milliseconds that a frame of the scene cost the solver"},
    {"interval", "S", 0, CK_TAKES_RECORDING, NUMBER, PLACE(interval), 1e-12, 1e9, .fallback = "the scene's step",
     .help = "seconds between the frames of a .npy"},
    {"format", "FORMAT", 0, CK_TAKES_FORMAT, TEXT, PLACE(format), .fallback = "json", .help = "json, csv or obj"},
    {"baseline", "FILE", 0, CK_TAKES_UPDATE, TEXT, PLACE(baseline), .fallback = CK_BASELINE_PATH,
     .help = "what was measured before"},
    {"history", "DIR", 0, CK_TAKES_UPDATE, TEXT, PLACE(history), .is_way = true,
     .help = "add what is measured to DIR/history.csv, which 'clothcheck report DIR' draws over time"},
    {"tolerance", "X%|METRIC=X", 0, CK_TAKES_UPDATE, OTHER, .read = add_tolerance,
     .help = "how far results may move besides their bands: a share of every metric, as 1%, or of one in its unit, as "
             "stretch_max=0.01; may be given several times"},
    {"format", "FORMAT", 0, CK_TAKES_PAPER, OTHER, .read = ck_picture_paper, .fallback = "svg and png",
     .help = "pdf: each chart also as PDF, for a paper"},
    {"width", "WIDTH", 0, CK_TAKES_PAPER, OTHER, .read = ck_picture_width, .fallback = "8.5cm",
     .help = "of a chart as PDF, as 8.5cm, 85mm or 3.35in"},
    {"out", "FILE", 'o', CK_TAKES_FILM, TEXT, PLACE(film), .fallback = "SCENE.mp4",
     .help = "the film: FILE.mp4 or FILE.gif"},
    {"color", "QUANTITY", 0, CK_TAKES_FILM, OTHER, .read = ck_picture_color, .fallback = "strain",
     .help = "strain, distance (to the truth), speed or engine"},
    {"fps", "N", 0, CK_TAKES_FILM, COUNT, PLACE(film_fps), 1, 120, .fallback = "30", .help = "frames a second"},
    {"size", "WxH", 0, CK_TAKES_FILM, OTHER, .read = ck_picture_size, .fallback = "1280x720",
     .help = "px, even numbers"},
    {"port", "N", 0, CK_TAKES_VIEW, COUNT, PLACE(port), 0, 65535, .fallback = "one that is free",
     .help = "where the page is served, on 127.0.0.1"},
    {"speed", "X", 0, CK_TAKES_VIEW, NUMBER, PLACE(speed), 0, 100, .fallback = "1",
     .help = "times as fast as real time; 0: as fast as the engines can"},
    {"paused", NULL, 0, CK_TAKES_VIEW, FLAG, PLACE(begins_paused), .help = "wait for Play"},
    {"no-browser", NULL, 0, CK_TAKES_VIEW, FLAG, PLACE(opens_nothing), .help = "only print the address"},
    {"update", NULL, 0, CK_TAKES_UPDATE, FLAG, PLACE(is_update),
     .help = "write the baseline anew, and print what moved"},
    {"append", NULL, 'a', CK_TAKES_KEEPING, FLAG, PLACE(appends), .is_way = true,
     .help = "keep the results of other scenes that --out holds; of tune, of other engines, too"},
    {"force", NULL, 'f', CK_TAKES_KEEPING | CK_TAKES_STUDY, FLAG, PLACE(forces), .is_way = true,
     .help = "replace whatever results --out holds"},
    {"json", NULL, 0, CK_TAKES_FORM, OTHER, .read = set_json, .is_way = true, .help = "the answer as JSON"},
    {"markdown", NULL, 0, CK_TAKES_FORM, OTHER, .read = set_markdown, .is_way = true,
     .help = "the answer as Markdown, as for a pull request"},
    {"fps", "N", 0, CK_TAKES_SPRING, NUMBER, PLACE(fps), 1e-3, 1e6, .fallback = "60", .help = "frames a second"},
    {"mass", "KG", 0, CK_TAKES_SPRING, NUMBER, PLACE(mass), 1e-12, 1e9, .fallback = "0.05",
     .help = "mass of each particle"},
    {"stiffness", "N/M", 0, CK_TAKES_SPRING, NUMBER, PLACE(stiffness), 1e-9, 1e15, .fallback = "1000",
     .help = "of the spring, where no setting stands for it"},
    {"damping", "N*S/M", 0, CK_TAKES_SPRING, NUMBER, PLACE(damping), 0, 1e12, .fallback = "0",
     .help = "of the spring, where no setting stands for it"},
    {"rounds", "N", 0, CK_TAKES_BENCH, COUNT, PLACE(rounds), 1, 99, .fallback = "7", .help = "repeats, 1 to 99"},
    {"only", "WHAT", 0, CK_TAKES_BENCH, TEXT, PLACE(only),
     .help = "a part, steps, seconds, strain, costs or growth; or a body, cloth, rope, ropes, mesh or on_ball"},
    {"largest", "N", 0, CK_TAKES_BENCH, COUNT, PLACE(largest), 16, 2048, .fallback = "1024",
     .help = "side of the largest cloth, 16 to 2048"},
};
#define OPTIONS ((int)(sizeof table / sizeof *table))

ck_OptionText ck_option_text(const ck_Command *command, int index) {
    for (int i = 0; i < OPTIONS; i++) {
        const Option *option = &table[i];
        if (!(option->groups & command->groups) || index--) continue;
        ck_OptionText text = {
            .name = option->name, .value = option->value, .letter = option->letter, .help = option->help};
        if (option->fallback) snprintf(text.fallback, sizeof text.fallback, "%s", option->fallback);
        if (option->place == PLACE(out) && command->out)
            snprintf(text.fallback, sizeof text.fallback, "%s", command->out);
        if (option->place == PLACE(options.limits.seconds) && option->kind == NUMBER)
            snprintf(text.fallback, sizeof text.fallback, "%g", command->seconds);
        if (option->place == PLACE(options.limits.patience) && option->kind == NUMBER)
            snprintf(text.fallback, sizeof text.fallback, "%g", command->patience);
        return text;
    }
    return (ck_OptionText){0};
}

void ck_arguments_help(const ck_Command *command) {
    ck_OptionText text;
    for (int i = 0; (text = ck_option_text(command, i)).name; i++) {
        char left[60];
        snprintf(left, sizeof left, "--%s%s%s", text.name, text.value ? " " : "", text.value ? text.value : "");
        printf("  %c%c%c %-20s  %s", text.letter ? '-' : ' ', text.letter ? text.letter : ' ', text.letter ? ',' : ' ',
               left, text.help);
        printf(*text.fallback ? " (default: %s)\n" : "\n", text.fallback);
    }
    printf("  -h, --help                this text\n");
    if (strstr(command->arguments, "SCENE"))
        printf("\nA SCENE is a path, or a bare name: scenes/NAME.yaml of this folder, or else one that came with the "
               "program.\n");
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

// As --set ENGINE.threads=N of every engine that can share its steps.
static ck_Status set_threads(ck_Arguments *arguments, const char *text, ck_Error *error) {
    double number;
    char set[64];
    ck_Status status = read_count(&number, text, 1, 64, "--threads", error);
    for (int i = 0; i < ck_engine_count() && !status; i++) {
        if (!ck_engine_setting(ck_engine_at(i), CK_THREADS)) continue;
        snprintf(set, sizeof set, "%s.threads=%g", ck_engine_at(i)->name, number);
        status = ck_arguments_add_setting(arguments, set, error);
    }
    return status;
}

static ck_Status set_full(ck_Arguments *arguments, const char *text, ck_Error *error) {
    (void)text, (void)error;
    ck_CompareOptions *options = &arguments->options;
    options->repeats = 5;
    options->budget = 2;
    options->consistency_budget = 10;
    options->limits.patience = arguments->command->full_patience;
    return CK_OK;
}

static ck_Status set_memory(ck_Arguments *arguments, const char *text, ck_Error *error) {
    double number;
    ck_Status status = read_number(&number, text, 0, 1e9, "--memory-limit", error);
    if (!status) arguments->options.limits.memory_bytes = (size_t)(number * 1048576);
    return status;
}

static ck_Status set_seed(ck_Arguments *arguments, const char *text, ck_Error *error) {
    double number;
    ck_Status status = read_count(&number, text, 0, 1e15, "--seed", error);
    if (!status) arguments->options.seed = (uint64_t)number;
    return status;
}

static ck_Status read_shard(ck_Arguments *arguments, const char *text, ck_Error *error) {
    int used = 0;
    if (sscanf(text, "%d/%d%n", &arguments->shard, &arguments->shards, &used) == 2 && !text[used] &&
        arguments->shard >= 1 && arguments->shard <= arguments->shards && arguments->shards <= 10000)
        return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "--shard %s: it must read I/N with 1 <= I <= N, as in 2/4", text);
}

static ck_Status add_tolerance(ck_Arguments *arguments, const char *text, ck_Error *error) {
    const char *equals = strchr(text, '=');
    char name[40], *end;
    snprintf(name, sizeof name, "%.*s", equals ? (int)(equals - text) : 0, text);
    const ck_Metric *metric = equals ? ck_metric_find(name) : NULL;
    double value = strtod(equals ? equals + 1 : text, &end);
    bool is_share = !strcmp(end, "%");
    if (!(value >= 0) || !isfinite(value) || end == (equals ? equals + 1 : text) || (*end && !is_share) ||
        (equals ? !metric : !is_share))
        return ck_fail(error, CK_BAD_INPUT,
                       "--tolerance %s: it must read X%%, METRIC=X or METRIC=X%%, as in 1%% or stretch_max=0.01", text);
    if (arguments->tolerance_count == sizeof arguments->tolerances / sizeof *arguments->tolerances)
        return ck_fail(error, CK_BAD_INPUT, "--tolerance is given more than %d times", arguments->tolerance_count);
    arguments->tolerances[arguments->tolerance_count++] =
        (ck_Tolerance){metric ? metric->name : NULL, is_share ? value / 100 : value, is_share};
    return CK_OK;
}

static ck_Status set_form(ck_Arguments *arguments, ck_AnswerForm form, ck_Error *error) {
    if (arguments->answer.form && arguments->answer.form != form)
        return ck_fail(error, CK_BAD_INPUT, "--json and --markdown: an answer has one form; give one of them");
    arguments->answer.form = form;
    return CK_OK;
}

static ck_Status set_json(ck_Arguments *arguments, const char *text, ck_Error *error) {
    (void)text;
    return set_form(arguments, CK_ANSWER_JSON, error);
}

static ck_Status set_markdown(ck_Arguments *arguments, const char *text, ck_Error *error) {
    (void)text;
    return set_form(arguments, CK_ANSWER_MARKDOWN, error);
}

static ck_Status add_variable(ck_Arguments *arguments, const char *text, ck_Error *error) {
    if (arguments->vary_count == sizeof arguments->varies / sizeof *arguments->varies)
        return ck_fail(error, CK_BAD_INPUT, "--vary is given more than %d times", arguments->vary_count);
    arguments->varies[arguments->vary_count++] = text;
    return CK_OK;
}

static ck_Status add_validation(ck_Arguments *arguments, const char *text, ck_Error *error) {
    const int most = sizeof arguments->validate / sizeof *arguments->validate;
    if (arguments->validate_count == most)
        return ck_fail(error, CK_BAD_INPUT, "--validate is given more than %d times", most);
    ck_Status status = ck_scene_path(&arguments->validate[arguments->validate_count], text, error);
    if (!status) arguments->validate_count++;
    return status;
}

static ck_Status read_option(ck_Arguments *arguments, const Option *option, const char *text, ck_Error *error) {
    char *place = (char *)arguments + option->place, name[40];
    double number;
    snprintf(name, sizeof name, "--%s", option->name);
    ck_Status status = CK_OK;
    switch (option->kind) {
    case FLAG: *(bool *)(void *)place = true; break;
    case TEXT: *(const char **)(void *)place = text; break;
    case NUMBER: return read_number((double *)(void *)place, text, option->least, option->most, name, error);
    case COUNT:
        status = read_count(&number, text, option->least, option->most, name, error);
        if (!status) *(int *)(void *)place = (int)number;
        break;
    default: status = option->read(arguments, text, error);
    }
    return status;
}

// Adds an option and its value, or a word alone.
static ck_Status add_to_question(ck_Arguments *arguments, const char *option, const char *value, ck_Error *error) {
    size_t size = sizeof arguments->question, used = strlen(arguments->question);
    used += (size_t)snprintf(arguments->question + used, size - used, "%s%s%s%s%s", used ? "\t" : "",
                             option ? "--" : "", option ? option : "", option && value ? "\t" : "", value ? value : "");
    return used < size ? CK_OK : ck_fail(error, CK_BAD_INPUT, "the command line is longer than %zu characters", size);
}

static const char *option_name(const void *command, int index) {
    return ck_option_text(command, index).name;
}

static ck_Status fail_option(const ck_Command *command, int option, const char *text, ck_Error *error) {
    const char *name = text + strspn(text, "-"), *nearest = ck_name_nearest(name, option_name, command);
    char hint[80] = "";
    if (option != ':' && nearest) snprintf(hint, sizeof hint, "; did you mean --%s?", nearest);
    return ck_fail(error, CK_BAD_INPUT, "%s: %s%s; 'clothcheck %s --help' tells what there is", text,
                   option == ':' ? "needs a value" : "no such option", hint, command->name);
}

// A word that is no option: a scene, or what the command makes of it.
static ck_Status add_word(ck_Arguments *arguments, const ck_Command *command, char *word, ck_Error *error) {
    if (strstr(command->arguments, "SCENE")) return ck_arguments_add_scene(arguments, word, error);
    if (!*command->arguments) return ck_fail(error, CK_BAD_INPUT, "%s: %s takes no SCENE", word, command->name);
    if (arguments->word_count == sizeof arguments->words / sizeof *arguments->words)
        return ck_fail(error, CK_BAD_INPUT, "%s takes at most %d arguments", command->name, arguments->word_count);
    arguments->words[arguments->word_count++] = word;
    return CK_OK;
}

// The numbers of long options must not be letters.
#define FIRST_LONG 256

// What getopt_long reads by; letters begins with a colon, so that a missing value is told from an unknown option.
static void list_options(const ck_Command *command, struct option *options, char *letters) {
    *letters++ = ':';
    for (int i = 0; i < OPTIONS; i++) {
        if (!(table[i].groups & command->groups)) continue;
        *options++ =
            (struct option){table[i].name, table[i].value ? required_argument : no_argument, NULL, FIRST_LONG + i};
        if (!table[i].letter) continue;
        *letters++ = table[i].letter;
        if (table[i].value) *letters++ = ':';
    }
    *options = (struct option){0};
    *letters = 0;
}

static const Option *option_of(const ck_Command *command, int found) {
    for (int i = 0; found < FIRST_LONG && i < OPTIONS; i++)
        if (table[i].letter == found && table[i].groups & command->groups) return &table[i];
    return &table[found - FIRST_LONG];
}

// A session that is watched writes one file, and when it is told to.
static ck_Status claim(ck_Arguments *arguments, ck_Error *error) {
    const ck_Command *command = arguments->command;
    if (!arguments->out || !(command->groups & CK_TAKES_OUT) || command->groups & CK_TAKES_VIEW) return CK_OK;
    return ck_out_folder_claim(&arguments->folder, arguments->out, command->shares_out && arguments->scene_count != 1,
                               error);
}

ck_Status ck_arguments_read(ck_Arguments *arguments, const ck_Command *command, int argc, char **argv,
                            ck_Error *error) {
    *arguments = (ck_Arguments){.options = ck_compare_options_default(),
                                .error = NAN,
                                .stretch = NAN,
                                .frame = NAN,
                                .timeout = 60,
                                .speed = 1,
                                .paper_width = 8.5,
                                .film_fps = 30,
                                .film_width = 1280,
                                .film_height = 720,
                                .uncertainty = 0.0003,
                                .frame_cost = NAN,
                                .fps = 60,
                                .mass = 0.05,
                                .stiffness = 1000,
                                .rounds = 7,
                                .largest = 1024,
                                .case_limit = 3600,
                                .array = 8,
                                .cores = 1,
                                .baseline = CK_BASELINE_PATH,
                                .out = command->out};
    arguments->options.overrides = arguments->overrides;
    arguments->command = command;
    arguments->options.limits.patience = command->patience;
    if (command->seconds > 0) arguments->options.limits.seconds = command->seconds;
    struct option options[OPTIONS + 1];
    char letters[2 * OPTIONS + 2];
    list_options(command, options, letters);
    ck_Status status = add_to_question(arguments, NULL, argv[0], error);
    optind = 0; // start anew, whoever parsed before
    opterr = 0;
    for (int found; !status && (found = getopt_long(argc, argv, letters, options, NULL)) != -1;) {
        if (found == '?' || found == ':') {
            char letter[3] = {'-', (char)optopt};
            bool is_letter = optopt > ' ' && optopt < 127;
            return fail_option(command, found, is_letter ? letter : argv[optind - 1], error);
        }
        const Option *option = option_of(command, found);
        status = read_option(arguments, option, optarg, error);
        if (!status && !option->is_way) status = add_to_question(arguments, option->name, optarg, error);
    }
    for (int i = optind; i < argc && !status; i++) status = add_word(arguments, command, argv[i], error);
    ck_answer_open(&arguments->answer, arguments->answer.form, command->name);
    return status ? status : claim(arguments, error);
}

void ck_arguments_free(ck_Arguments *arguments) {
    for (int i = 0; i < arguments->scene_count; i++) free(arguments->scenes[i]);
    for (int i = 0; i < arguments->validate_count; i++) free(arguments->validate[i]);
    free(arguments->scenes);
    ck_out_folder_leave(&arguments->folder);
    ck_answer_discard(&arguments->answer);
    *arguments = (ck_Arguments){0};
}
