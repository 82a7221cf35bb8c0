#include "commands.h"

#include "fixture.h"
#include "fixture_program.h"

#include <ftw.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#define COMPARE "compare small.yaml other.yaml -e native-verlet -e native-xpbd --repeats 1 -j 1 --out "

const Command commands[] = {
    {"run", NULL, "run small.yaml -e native-verlet --repeats 1 --out out", true},
    {"compare", NULL, COMPARE "out", true},
    {"check", "check small.yaml --baseline base.csv --update -e native-verlet --out base",
     "check small.yaml --baseline base.csv -e native-verlet -j 1 --out out", true},
    {"update", NULL, "check small.yaml --baseline out/base.csv --update -e native-verlet -j 1 --out out", true},
    {"precision", NULL, "precision small.yaml -e native-verlet --repeats 1 --out out", true},
    {"stability", NULL, "stability small.yaml -e native-verlet -j 1 --out out", true},
    {"tune", NULL, "tune small.yaml -e native-verlet --error 0.01 -j 1 --out out", true},
    {"needs", NULL, "needs small.yaml -j 1 --out out", true},
    {"refine", NULL, "refine small.yaml -e native-verlet -j 1 --out out", true},
    {"study", NULL, "study sweep.yaml -j 1 --out out", true},
    {"fit", NULL, "fit measured.yaml --vary stiffness --out out", true},
    {"conform", NULL, "conform -e native-rope -j 1 --out out", true},
    {"export", NULL, "export small.yaml --format csv --out out", true},
    {"score", NULL, "score small.yaml --path path.csv --out out", true},
    {"new-engine", NULL, "new-engine out", false},
    {"merge", COMPARE "one --shard 1/2\n" COMPARE "two --shard 2/2", "merge out one two", false},
    {"report", COMPARE "out", "report out", true},
    {"code", NULL, "code small.yaml -e bullet-pbd", true},
    {"means", NULL, "means -e native-verlet", true},
    {"findings", COMPARE "other", "findings other", true},
    {"diff", COMPARE "other", "diff other other", true},
    {"list", NULL, "list", true},
};
const size_t command_count = sizeof commands / sizeof *commands;

static const char *const files[][2] = {
    {"small.yaml", "name: small\nrope: {particles: 4, spacing: 0.1, mass: 0.1, along: [0, -1, 0]}\n"
                   "springs: {stiffness: 100, damping: 0.5}\npins: [first]\ngravity: [0, -9.81, 0]\ndrag: 20\n"
                   "time: {duration: 1, fps: 10}\ntruth: vertical_chain\n"},
    {"sweep.yaml", "study: sweep\nscenes: [small.yaml]\nengines: [native-verlet, native-xpbd]\n"
                   "sweep:\n  - springs.stiffness: [50, 100]\n"},
};

static int remove_below(const char *path, const struct stat *status, int kind, struct FTW *walk) {
    (void)status;
    (void)kind;
    return walk->level > 0 && remove(path);
}

// The folder itself may be a disk's root, and stays.
static void empty(const char *directory) {
    char line[700];
    snprintf(line, sizeof line, "mkdir -p %s", directory);
    if (access(directory, F_OK) && system(line)) fail_msg("%s cannot be made", directory);
    if (nftw(directory, remove_below, 16, FTW_DEPTH | FTW_PHYS | FTW_MOUNT)) fail_msg("%s stays", directory);
}

static void copy(const char *from, const char *to) {
    char line[800];
    snprintf(line, sizeof line, "mkdir -p %s && cp -a %s/. %s", to, from, to);
    if (system(line)) fail_msg("%s cannot be copied to %s", from, to);
}

static void write_file(const char *directory, const char *name, const char *text) {
    char path[300];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "w");
    if (!file || fputs(text, file) < 0 || fclose(file)) fail_msg("%s cannot be written", path);
}

// The rope at rest, frame by frame.
static void write_path(const char *directory) {
    char text[4000] = "time_s,particle,x,y,z\n";
    size_t used = strlen(text);
    for (int frame = 0; frame <= 10; frame++)
        for (int i = 0; i < 4; i++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%g,%d,0,%g,0\n", 0.1 * frame, i, -0.1 * i);
    write_file(directory, "path.csv", text);
}

static void fill(const char *directory) {
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) write_file(directory, files[i][0], files[i][1]);
    char text[600], *name;
    snprintf(text, sizeof text, "%s", files[0][1]);
    name = strstr(text, "small");
    memcpy(name, "other", 5);
    write_file(directory, "other.yaml", text);
    snprintf(text, sizeof text, "%smeasured: {sag: {value: 0.35, uncertainty: 0.001}}\n", files[0][1]);
    write_file(directory, "measured.yaml", text);
    write_path(directory);
}

// Once for each command: then its files are kept.
static void run_before(const char *directory, const Command *command) {
    char said[400], line[400], kept[300];
    snprintf(kept, sizeof kept, "%s/before-%s", fixture_directory, command->name);
    if (!access(kept, F_OK)) {
        copy(kept, directory);
        return;
    }
    for (const char *next = command->before; *next; next += *next == '\n') {
        const size_t length = strcspn(next, "\n");
        snprintf(line, sizeof line, "%.*s", (int)length, next);
        if (commands_run(directory, NULL, line, said, sizeof said)) fail_msg("%s: %s", line, said);
        next += length;
    }
    copy(directory, kept);
}

void commands_prepare(const char *directory, const Command *command) {
    empty(directory);
    fill(directory);
    if (command->before) run_before(directory, command);
}

int commands_run(const char *directory, const char *disturbance, const char *line, char *said, size_t size) {
    char words[2000], path[300], environment[900] = "";
    if (disturbance)
        snprintf(environment, sizeof environment, "LD_PRELOAD=%s DISTURB=%s DISTURB_COUNT=%s/count", DISTURB,
                 disturbance, fixture_directory);
    // what it says goes elsewhere: to another disk
    snprintf(path, sizeof path, "%s/said", fixture_directory);
    snprintf(words, sizeof words, "cd %s && exec env %s %s %s >%s 2>&1", directory, environment, PROGRAM, line, path);
    const int status = system(words);
    FILE *file = fopen(path, "r");
    const size_t length = file ? fread(said, 1, size - 1, file) : 0;
    said[length] = 0;
    if (file) fclose(file);
    return status;
}

Counts commands_count(void) {
    Counts counts = {0};
    char *text = fixture_read("count");
    if (!text || sscanf(text, "%ld %ld %ld", &counts.moments, &counts.allocations, &counts.held) != 3)
        fail_msg("nothing was counted: %s", text ? text : "");
    free(text);
    return counts;
}

static void take(Snapshot *snapshot, const char *directory) {
    char out[300];
    snprintf(out, sizeof out, "%s/out", directory);
    snapshot_take(snapshot, out);
}

Counts commands_watch(const char *directory, const Command *command, Snapshot *undisturbed) {
    static char said[20000];
    Snapshot again;
    for (int i = 0; i < 2; i++) {
        commands_prepare(directory, command);
        if (commands_run(directory, "count", command->line, said, sizeof said)) fail_msg("%s: %s", command->line, said);
        take(i ? &again : undisturbed, directory);
    }
    snapshot_mark(undisturbed, &again);
    snapshot_free(&again);
    return commands_count();
}

void commands_assert_mends(const char *directory, const Command *command, const Snapshot *undisturbed,
                           const char *what) {
    static char said[20000];
    Snapshot left;
    take(&left, directory);
    snapshot_assert_whole(&left, undisturbed, what);
    const bool is_done = left.count == undisturbed->count;
    snapshot_free(&left);
    const int rerun = commands_run(directory, NULL, command->line, said, sizeof said);
    if (rerun && (command->goes_on || !is_done)) fail_msg("%s: again %d: %s", what, rerun, said);
    take(&left, directory);
    snapshot_assert_same(&left, undisturbed, what);
    snapshot_free(&left);
}

int number_of(const char *name, int few, int all) {
    const char *text = getenv(name);
    return text ? atoi(text) : fixture_asks_all() ? all : few;
}

bool is_asked(const Command *command) {
    const char *only = getenv("ONLY");
    return !only || !strcmp(only, command->name);
}
