// Commands in surroundings that are not as they expect: a folder that another process writes into, that may not be
// written, that goes away; few descriptors, closed streams, a reader that has gone; and names that a shell, a page, a
// chart or a table could take for more than a name. ONLY says which command.
#include "commands.h"
#include "fixture.h"
#include "fixture_program.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static char directory[100], said[20000];

static bool writes_out(const Command *command) {
    return strstr(command->line, "out") && strcmp(command->name, "new-engine");
}

static bool shares_out(const Command *command) {
    return !strcmp(command->name, "study") || !strcmp(command->name, "report");
}

// Runs a command in a shell of its own, as its words say.
static int run_words(const char *format, const Command *command) {
    char words[2000], path[200];
    snprintf(words, sizeof words, format, directory, PROGRAM, command->line, fixture_directory);
    const int status = system(words);
    snprintf(path, sizeof path, "%s/said", fixture_directory);
    FILE *file = fopen(path, "r");
    said[file ? fread(said, 1, sizeof said - 1, file) : 0] = 0;
    if (file) fclose(file);
    return status;
}

// A file of a command's folder in the folder of all.
static void place_of(char *path, size_t size, const Command *command, const char *file) {
    snprintf(path, size, "%s/%s/%s", directory, command->name, file);
}

// Says how a command ended that was started beside others.
static void judge_held(const Command *command, bool may_share) {
    char path[300];
    int status = -1;
    place_of(path, sizeof path, command, "said");
    FILE *file = fopen(path, "r");
    said[file ? fread(said, 1, sizeof said - 1, file) : 0] = 0;
    if (file) fclose(file);
    place_of(path, sizeof path, command, "status");
    file = fopen(path, "r");
    if (!file || fscanf(file, "%d", &status) != 1) fail_msg("%s: did not end", command->name);
    fclose(file);
    if (may_share && status) fail_msg("%s does not share: %s", command->name, said);
    if (!may_share && (status != 2 || !strstr(said, "another clothcheck is writing there")))
        fail_msg("%s: %d, %s", command->name, status, said);
}

// Somebody else's lock, of a kind of flock's: each command is refused, unless both share. They wait side by side.
static void hold_folders(int kind) {
    char path[300], *words;
    size_t size;
    int locks[64], count = 0;
    FILE *script = open_memstream(&words, &size);
    snprintf(directory, sizeof directory, "%s/held", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        const Command *command = &commands[i];
        if (!is_asked(command) || !writes_out(command)) continue;
        snprintf(path, sizeof path, "%s/%s", directory, command->name);
        commands_prepare(path, command);
        fprintf(script, "(cd %s; %s %s >said 2>&1; echo $? >status) &\n", path, PROGRAM, command->line);
        place_of(path, sizeof path, command, "out");
        mkdir(path, 0777);
        locks[count] = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        assert_int_equal(flock(locks[count++], kind), 0);
    }
    fprintf(script, "wait");
    fclose(script);
    assert_int_equal(system(words), 0);
    free(words);
    while (count) close(locks[--count]);
    for (size_t i = 0; i < command_count; i++)
        if (is_asked(&commands[i]) && writes_out(&commands[i]))
            judge_held(&commands[i], kind == LOCK_SH && shares_out(&commands[i]));
}

static void test_held(void **state) {
    (void)state;
    hold_folders(LOCK_EX);
    hold_folders(LOCK_SH);
}

// %s: the folder, the program, its words, and where it is to say what it says.
static const struct {
    const char *name, *words;
    const char *reason; // that a command may give up for; NULL: none
} surroundings[] = {
    {"sixteen descriptors", "cd %1$s && exec >%4$s/said 2>&1 && ulimit -n 16 && exec %2$s %3$s", "Too many open files"},
    {"closed streams", "cd %s && exec %s %s <&- >&- 2>&- # %s", NULL},
    {"a reader that has gone", "cd %s && { %s %s 2>%s/said; true; } | true", NULL},
    {"a decimal comma", "cd %s && LC_ALL=de_DE.UTF-8 LC_NUMERIC=de_DE.UTF-8 exec %s %s >%s/said 2>&1", NULL},
};

static void test_surroundings(void **state) {
    (void)state;
    snprintf(directory, sizeof directory, "%s/odd", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        const Command *command = &commands[i];
        Snapshot undisturbed;
        if (!is_asked(command)) continue;
        commands_watch(directory, command, &undisturbed);
        const size_t kinds = sizeof surroundings / sizeof *surroundings;
        // of ten minutes one for each command, in turn
        for (size_t k = fixture_asks_all() ? 0 : i % kinds; k < (fixture_asks_all() ? kinds : i % kinds + 1); k++) {
            char what[200];
            snprintf(what, sizeof what, "%s, %s", command->name, surroundings[k].name);
            commands_prepare(directory, command);
            const int status = run_words(surroundings[k].words, command);
            if (!WIFEXITED(status) || WEXITSTATUS(status) > 2) fail_msg("%s: ended with %d: %s", what, status, said);
            const bool may_fail = surroundings[k].reason && strstr(said, surroundings[k].reason);
            if (status && !may_fail) fail_msg("%s: %d, %s", what, status, said);
            commands_assert_mends(directory, command, &undisturbed, what);
        }
        snapshot_free(&undisturbed);
    }
}

// At the moments that are counted.
static void test_vanishing(void **state) {
    (void)state;
    const int wanted = number_of("VANISHINGS", 1, 2);
    snprintf(directory, sizeof directory, "%s/gone", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        const Command *command = &commands[i];
        Snapshot undisturbed;
        if (!is_asked(command) || !writes_out(command)) continue;
        const long moments = commands_watch(directory, command, &undisturbed).moments;
        for (int k = 0; k < wanted; k++) {
            char disturbance[60], what[100], line[300];
            const long moment = 1 + k * (moments - 1) / wanted;
            snprintf(disturbance, sizeof disturbance, "vanish:%ld", moment);
            snprintf(what, sizeof what, "%s, its folder gone at moment %ld", command->name, moment);
            commands_prepare(directory, command);
            const int status = commands_run(directory, disturbance, command->line, said, sizeof said);
            if (!WIFEXITED(status) || WEXITSTATUS(status) > 2) fail_msg("%s: ended with %d: %s", what, status, said);
            if (status && !strstr(said, "clothcheck: ")) fail_msg("%s: says '%s'", what, said);
            snprintf(line, sizeof line, "rm -rf %s/gone", directory);
            // what a command needs of it is made again
            if (!system(line) && command->before) commands_prepare(directory, command);
            commands_assert_mends(directory, command, &undisturbed, what);
        }
        snapshot_free(&undisturbed);
    }
}

// A disk that may not be written, of this process and its children alone.
static void test_read_only(void **state) {
    (void)state;
    snprintf(directory, sizeof directory, "%s/read", fixture_directory);
    mkdir(directory, 0777);
    if (unshare(CLONE_NEWNS) || mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL)) {
        print_message("no disk that may not be written: that takes root\n");
        return;
    }
    for (size_t i = 0; i < command_count; i++) {
        const Command *command = &commands[i];
        if (!is_asked(command)) continue;
        assert_int_equal(mount("clothcheck-test", directory, "tmpfs", 0, NULL), 0);
        commands_prepare(directory, command);
        assert_int_equal(mount("clothcheck-test", directory, "tmpfs", MS_REMOUNT | MS_RDONLY, NULL), 0);
        const int status = commands_run(directory, NULL, command->line, said, sizeof said);
        assert_int_equal(umount(directory), 0);
        const bool writes = writes_out(command) || !strcmp(command->name, "new-engine");
        if (writes ? !WEXITSTATUS(status) || !strstr(said, "Read-only file system") : status)
            fail_msg("%s: %d, %s", command->name, status, said);
    }
}

static const char *const names[] = {
    "two words",
    "it's",
    "a\"b",
    "<script>alert(1)</script>",
    "</script><b>",
    "$(touch x)",
    "`touch x`",
    "a;touch x",
    "a|touch x&",
    "%n%s%d",
    "../up",
    "a/b",
    "'.system('touch x').'",
    "=1+1",
    "@SUM(1)",
    "a,b",
    "new\nline",
    "tab\there",
    "\\n\\t",
    "*?[a]",
    "-e",
    "--help",
    "CON",
    "\xc3\xa4\xe2\x82\xac",
    "\xff\xfe",
    "&amp;&lt;",
    "]]>",
    "{}",
};

// A name as it stands in YAML.
static void quote(char *out, const char *name) {
    *out++ = '"';
    for (; *name; name++) {
        if (*name == '"' || *name == '\\') *out++ = '\\';
        if (*name == '\n' || *name == '\t') {
            *out++ = '\\';
            *out++ = *name == '\n' ? 'n' : 't';
        } else {
            *out++ = *name;
        }
    }
    *out++ = '"';
    *out = 0;
}

static void write_named(const char *name) {
    char path[200], quoted[200], text[1000], *end;
    Snapshot files;
    snapshot_take(&files, directory);
    const char *small = NULL;
    for (int i = 0; i < files.count; i++)
        if (!strcmp(files.files[i].path, "small.yaml")) small = files.files[i].bytes;
    quote(quoted, name);
    end = strchr(small, '\n');
    snprintf(text, sizeof text, "name: %s%s", quoted, end);
    snapshot_free(&files);
    snprintf(path, sizeof path, "%s/named.yaml", directory);
    FILE *file = fopen(path, "w");
    assert_true(file && fputs(text, file) >= 0 && !fclose(file));
}

// A word of a shell.
static void quote_word(char *out, const char *name) {
    *out++ = '\'';
    for (; *name; name++) {
        if (*name == '\'') {
            memcpy(out, "'\\'", 3);
            out += 3;
        }
        *out++ = *name;
    }
    *out++ = '\'';
    *out = 0;
}

// All that was written: nothing ran, nothing is elsewhere, no page or table is broken.
static void assert_text(const char *name) {
    Snapshot out;
    snapshot_take(&out, directory);
    for (int i = 0; i < out.count; i++) {
        const SnapshotFile *file = &out.files[i];
        const char *slash = strrchr(file->path, '/'), *ending = strrchr(file->path, '.');
        if (!strcmp(slash ? slash + 1 : file->path, "x")) fail_msg("'%s' made %s", name, file->path);
        const bool is_markup =
            ending && (!strcmp(ending, ".html") || !strcmp(ending, ".xml") || !strcmp(ending, ".svg"));
        if (is_markup && strpbrk(name, "<>") && strstr(file->bytes, name))
            fail_msg("'%s' stands in %s", name, file->path);
    }
    snapshot_free(&out);
}

// %1$s is a scene's file, %2$s a folder, both of that name.
static const char *const named_lines[] = {
    "compare %1$s -e native-verlet -e native-xpbd --repeats 1 --out %2$s",
    "report %2$s",
    "check %1$s --baseline %2$s/base.csv --update -e native-verlet --out %2$s",
    "check %1$s --baseline %2$s/base.csv -e native-verlet --out %2$s",
    "findings %2$s",
    "diff %2$s %2$s",
    "precision %1$s -e native-verlet --repeats 1 --out %2$s",
    "export %1$s",
    "code %1$s -e bullet-pbd",
};

static void try_path(const char *name) {
    static const Command none = {.name = "names"};
    char file[200], folder[200], plain[150], line[900];
    commands_prepare(directory, &none);
    snprintf(plain, sizeof plain, "./%s.yaml", name);
    quote_word(file, plain);
    snprintf(plain, sizeof plain, "./%s", name);
    quote_word(folder, plain);
    snprintf(line, sizeof line, "cd %s && cp small.yaml %s", directory, file);
    if (system(line)) fail_msg("'%s' is no name of a file", name);
    for (size_t i = 0; i < sizeof named_lines / sizeof *named_lines; i++) {
        snprintf(line, sizeof line, named_lines[i], file, folder);
        const int status = commands_run(directory, NULL, line, said, sizeof said);
        // a name that cannot be kept in a table is refused before anything is written
        if (!i && WEXITSTATUS(status) == 2 && strstr(said, "clothcheck: ")) break;
        if (status) fail_msg("'%s': %s: %d, %s", name, line, status, said);
    }
    assert_text(name);
}

// As the name that a scene has for itself.
static bool try_scene(const char *name) {
    static const Command none = {.name = "names"};
    commands_prepare(directory, &none);
    write_named(name);
    const int status =
        commands_run(directory, NULL, "compare named.yaml -e native-verlet --repeats 1 --out out", said, sizeof said);
    if (WEXITSTATUS(status) == 2 && strstr(said, "named.yaml:1:")) return false;
    if (status || commands_run(directory, NULL, "report out", said, sizeof said)) fail_msg("'%s': %s", name, said);
    assert_text(name);
    return true;
}

static void test_names(void **state) {
    (void)state;
    int taken = 0;
    snprintf(directory, sizeof directory, "%s/named", fixture_directory);
    // each as the name of a scene and of a file; of ten minutes some of them
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const bool is_path = !strchr(names[i], '/');
        if (fixture_asks_all() || i % 2 || !is_path) taken += try_scene(names[i]);
        if (is_path && (fixture_asks_all() || i % 6 == 0)) try_path(names[i]);
    }
    print_message("%d names are taken for a scene, the others refused\n", taken);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_held),  cmocka_unit_test(test_surroundings), cmocka_unit_test(test_vanishing),
        cmocka_unit_test(test_names), cmocka_unit_test(test_read_only),
    };
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
