#include "command.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const ck_Command commands[] = {
    {"list", "", "engines, scenes, metrics and truths", ck_command_list},
    {"run", "SCENE", "one scene, chosen engines: summary and ledger; CSVs with --out", ck_command_run},
    {"compare", "[SCENE...]", "all engines on all scenes: the six CSVs of a comparison", ck_command_compare},
    {"check", "[SCENE...]", "regression: what was measured before, within bands; exit status 1", ck_command_check},
    {"precision", "SCENE", "error against cost over time steps and iterations: precision.csv", ck_command_precision},
    {"stability", "SCENE", "where methods fail: time step against stiffness: stability.csv", ck_command_stability},
    {"tune", "SCENE", "the cheapest settings within an error, or the closest to a goal: tune.csv", ck_command_tune},
    {"needs", "SCENE", "what the scene needs to be modelled, and what not: needs.csv", ck_command_needs},
    {"merge", "OUT DIR...", "joins the parts of a study that was run with --shard", ck_command_merge},
    {"report", "DIR", "charts and one page of the CSVs in DIR", ck_command_report},
    {"claims", "", "what was claimed of the two origins, and what their quirks cost", ck_command_claims},
    {"bench", "", "how fast the engines are: per spring, per step, and as a cloth grows", ck_command_bench},
};
#define COMMANDS (sizeof commands / sizeof *commands)

static void print_help(FILE *out) {
    fprintf(out,
            "clothcheck %s: which cloth solver, at which settings, is right for my scene, and what does it cost?\n\n",
            CK_VERSION);
    for (size_t i = 0; i < COMMANDS; i++)
        fprintf(out, "  clothcheck %-9s %-11s %s\n", commands[i].name, commands[i].arguments, commands[i].about);
    fprintf(out, "\n'clothcheck COMMAND --help' tells a command's options. Exit status: 0 fine, 1 a check failed, 2 "
                 "wrong usage or input.\n");
}

// A closed standard stream would lend its number to the first file that is written.
static void open_streams(void) {
    int file;
    do file = open("/dev/null", O_RDWR);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0) close(file);
}

static int run(int argc, char **argv) {
    if (argc > 1 && !strcmp(argv[1], "--version")) {
        printf("clothcheck %s\n", CK_VERSION);
        return CK_EXIT_OK;
    }
    if (argc > 1 && (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h"))) {
        print_help(stdout);
        return CK_EXIT_OK;
    }
    for (size_t i = 0; argc > 1 && i < COMMANDS; i++)
        if (!strcmp(argv[1], commands[i].name)) return commands[i].run(argc - 1, argv + 1);
    if (argc > 1) fprintf(stderr, "clothcheck: there is no command %s\n\n", argv[1]);
    print_help(stderr);
    return CK_EXIT_USAGE;
}

int main(int argc, char **argv) {
    open_streams();
    int result = run(argc, argv);
    if (!fflush(stdout) && !ferror(stdout)) return result;
    fprintf(stderr, "clothcheck: what was printed did not reach its file: %s\n", strerror(errno));
    return result ? result : CK_EXIT_FAILED;
}
