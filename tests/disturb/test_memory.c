// Commands of which one allocation finds no memory: none crashes or hangs; what cannot go on says that it is for a lack
// of memory, leaves no file in part and, at its end, no more memory than it holds undisturbed; and the same command
// ends as it would have. ALLOCATIONS says how many for each command, ONLY which, SEED which.
#include "commands.h"
#include "fixture.h"
#include "fixture_program.h"
#include "statistics.h"

#include <sys/wait.h>

#define ALLOCATIONS 2
#define ALL_ALLOCATIONS 8

static char directory[100], said[20000];

// How often it was told, and how often the command could go on.
typedef struct Ends {
    int told, went_on;
} Ends;

static void fail_once(const Command *command, const Snapshot *undisturbed, long allocation, long held, Ends *ends) {
    char disturbance[60], what[100];
    snprintf(disturbance, sizeof disturbance, "alloc:%ld", allocation);
    snprintf(what, sizeof what, "%s, without memory at allocation %ld", command->name, allocation);
    commands_prepare(directory, command);
    const int status = commands_run(directory, disturbance, command->line, said, sizeof said);
    if (!WIFEXITED(status) || WEXITSTATUS(status) > 2) fail_msg("%s: ended with %d: %s", what, status, said);
    // a run that had no memory is a row, or a deviation, and the command has gone on
    const bool is_told = strstr(said, "clothcheck:") != NULL;
    if (status && !is_told && WEXITSTATUS(status) != 1) fail_msg("%s: says '%s'", what, said);
    if (is_told && !strstr(said, "memory")) fail_msg("%s: says '%s'", what, said);
    const long left = commands_count().held;
    if (is_told && left > held) fail_msg("%s: holds %ld at its end, and %ld undisturbed: %s", what, left, held, said);
    ends->told += is_told;
    ends->went_on += !is_told;
    if (!is_told) commands_prepare(directory, command);
    commands_assert_mends(directory, command, undisturbed, what);
}

static void test_no_memory(void **state) {
    (void)state;
    const int wanted = number_of("ALLOCATIONS", ALLOCATIONS, ALL_ALLOCATIONS);
    ck_Random random = ck_random_seed((uint64_t)number_of("SEED", 1, 1));
    Ends all = {0};
    snprintf(directory, sizeof directory, "%s/starved", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        Snapshot undisturbed;
        if (!is_asked(&commands[i])) continue;
        const Counts counts = commands_watch(directory, &commands[i], &undisturbed);
        for (int k = 0; k < wanted; k++)
            fail_once(&commands[i], &undisturbed, 1 + (long)(ck_random_unit(&random) * (double)counts.allocations),
                      counts.held, &all);
        print_message("%s: %ld allocations\n", commands[i].name, counts.allocations);
        snapshot_free(&undisturbed);
    }
    print_message("%d told of it, %d went on\n", all.told, all.went_on);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_no_memory)};
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
