// Commands whose disk is full, at each so many kilobytes, and whose files may not grow beyond each so many: what cannot
// be written is told with the reason, no file is there in part, and with room the same command ends as it would have.
// The disk is a small one in memory, which takes root: without, files that may not grow are all that is tried. DISKS
// says how many for each command, ONLY which.
#include "commands.h"
#include "fixture.h"
#include "fixture_program.h"

#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/wait.h>

#define DISKS 2
#define ALL_DISKS 4
#define LARGE (64 << 20)

static char directory[100], said[20000];

static bool set_size(long bytes, unsigned long flags) {
    char options[60];
    snprintf(options, sizeof options, "size=%ld", bytes);
    return !mount("clothcheck-test", directory, "tmpfs", flags, options);
}

// Seen by this process and its children alone.
static bool has_disk(void) {
    return !unshare(CLONE_NEWNS) && !mount("none", "/", NULL, MS_REC | MS_PRIVATE, NULL) && set_size(LARGE, 0);
}

static long used_bytes(void) {
    struct statvfs about;
    assert_int_equal(statvfs(directory, &about), 0);
    return (long)((about.f_blocks - about.f_bfree) * about.f_frsize);
}

static void allow_files(rlim_t bytes) {
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void judge(const Command *command, const Snapshot *undisturbed, int status, const char *reason,
                  const char *what) {
    if (!WIFEXITED(status) || WEXITSTATUS(status) > 2) fail_msg("%s: ended with %d: %s", what, status, said);
    if (status && !strstr(said, reason)) fail_msg("%s: says '%s'", what, said);
    commands_assert_mends(directory, command, undisturbed, what);
}

static int fill_disk(const Command *command, const Snapshot *undisturbed, long bytes) {
    char what[100];
    snprintf(what, sizeof what, "%s, with %ld bytes left on the disk", command->name, bytes);
    commands_prepare(directory, command);
    if (!set_size(used_bytes() + bytes, MS_REMOUNT)) fail_msg("%s: the disk stays as it is", what);
    const int status = commands_run(directory, NULL, command->line, said, sizeof said);
    assert_true(set_size(LARGE, MS_REMOUNT));
    judge(command, undisturbed, status, "No space left", what);
    return status != 0;
}

static int hold_files(const Command *command, const Snapshot *undisturbed, long bytes) {
    char what[100];
    snprintf(what, sizeof what, "%s, with files of %ld bytes", command->name, bytes);
    commands_prepare(directory, command);
    allow_files((rlim_t)bytes);
    const int status = commands_run(directory, NULL, command->line, said, sizeof said);
    allow_files(RLIM_INFINITY);
    judge(command, undisturbed, status, "File too large", what);
    return status != 0;
}

static long largest_of(const Snapshot *snapshot) {
    size_t largest = 0;
    for (int i = 0; i < snapshot->count; i++)
        if (snapshot->files[i].size > largest) largest = snapshot->files[i].size;
    return (long)largest;
}

static void test_full_disks(void **state) {
    (void)state;
    const int wanted = number_of("DISKS", DISKS, ALL_DISKS);
    int full = 0, held = 0, disks = 0;
    snprintf(directory, sizeof directory, "%s/full", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        Snapshot undisturbed;
        if (!is_asked(&commands[i])) continue;
        commands_prepare(directory, &commands[i]);
        static int is_disk = -1;
        if (is_disk < 0 && !(is_disk = has_disk())) print_message("no small disk: that takes root\n");
        commands_prepare(directory, &commands[i]);
        const long before = is_disk ? used_bytes() : 0;
        commands_watch(directory, &commands[i], &undisturbed);
        const long taken = is_disk ? used_bytes() - before : 0, largest = largest_of(&undisturbed);
        for (int k = 0; k < wanted && undisturbed.count; k++) {
            if (is_disk) full += fill_disk(&commands[i], &undisturbed, 4096 + k * taken / wanted);
            held += hold_files(&commands[i], &undisturbed, 64 + k * largest / wanted);
            disks += is_disk;
        }
        snapshot_free(&undisturbed);
    }
    umount(directory);
    print_message("%d disks, of which %d were too small, and %d limits\n", disks, full, held);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_full_disks)};
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
