// Commands that are killed, or asked to end, each time that they are about to change a file or to start a process: no
// file is there in part, and the same command ends as it would have, and leaves nothing behind. KILLS says how many for
// each command, ONLY which.
#include "commands.h"
#include "fixture.h"
#include "fixture_program.h"

#include <signal.h>
#include <sys/wait.h>

#define KILLS 3
#define ALL_KILLS 10

static char directory[100], said[20000];

static void kill_once(const Command *command, const Snapshot *undisturbed, long moment, int which) {
    char disturbance[60], what[100];
    snprintf(disturbance, sizeof disturbance, "kill:%ld:%d", moment, which);
    snprintf(what, sizeof what, "%s, %s at moment %ld", command->name, strsignal(which), moment);
    commands_prepare(directory, command);
    const int status = commands_run(directory, disturbance, command->line, said, sizeof said);
    // what catches a signal ends by itself and says so
    if (WIFEXITED(status) && WEXITSTATUS(status) && !*said) fail_msg("%s: says nothing", what);
    commands_assert_mends(directory, command, undisturbed, what);
}

static void test_kills(void **state) {
    static const int signals[] = {SIGKILL, SIGTERM, SIGKILL, SIGINT, SIGKILL, SIGHUP};
    (void)state;
    const int kills = number_of("KILLS", KILLS, ALL_KILLS);
    int all = 0;
    snprintf(directory, sizeof directory, "%s/killed", fixture_directory);
    for (size_t i = 0; i < command_count; i++) {
        Snapshot undisturbed;
        if (!is_asked(&commands[i])) continue;
        const long moments = commands_watch(directory, &commands[i], &undisturbed).moments;
        for (int k = 0; k < kills && k < moments; k++, all++) {
            const long moment = moments <= kills ? k + 1 : 1 + k * (moments - 1) / (kills - 1);
            kill_once(&commands[i], &undisturbed, moment,
                      signals[((size_t)k + i) % (sizeof signals / sizeof *signals)]);
        }
        print_message("%s: %ld moments, %d files\n", commands[i].name, moments, undisturbed.count);
        snapshot_free(&undisturbed);
    }
    print_message("%d kills\n", all);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_kills)};
    return cmocka_run_group_tests(tests, fixture_make_directory, fixture_remove_directory);
}
