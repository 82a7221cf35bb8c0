#include "command.h"
#include "names.h"
#include "tables.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

// Adding a command is one file, one line here and one in command.h.
static const ck_Command *const commands[] = {
    &ck_command_demo,     &ck_command_list,   &ck_command_view,      &ck_command_film,       &ck_command_run,
    &ck_command_compare,  &ck_command_check,  &ck_command_precision, &ck_command_stability,  &ck_command_tune,
    &ck_command_needs,    &ck_command_refine, &ck_command_study,     &ck_command_fit,        &ck_command_conform,
    &ck_command_export,   &ck_command_score,  &ck_command_code,      &ck_command_new_engine, &ck_command_means,
    &ck_command_findings, &ck_command_diff,   &ck_command_merge,     &ck_command_report,     &ck_command_claims,
    &ck_command_bench,
};
#define COMMANDS ((int)(sizeof commands / sizeof *commands))

static const char *command_name(const void *table, int index) {
    (void)table;
    return index < COMMANDS ? commands[index]->name : NULL;
}

static const ck_Command *find_command(const char *name) {
    for (int i = 0; i < COMMANDS; i++)
        if (!strcmp(name, commands[i]->name)) return commands[i];
    return NULL;
}

static int fail_unknown(const char *name) {
    char known[200], hint[80];
    fprintf(stderr, "clothcheck: there is no command %s%s; known are %s\n", name,
            ck_name_hint(hint, sizeof hint, name, command_name, NULL),
            ck_name_list(known, sizeof known, command_name, NULL));
    return CK_EXIT_USAGE;
}

static void print_help(FILE *out) {
    fprintf(out,
            "clothcheck %s: which cloth solver, at which settings, is right for my scene, and what does it cost?\n\n",
            CK_VERSION);
    for (int i = 0; i < COMMANDS; i++)
        fprintf(out, "  clothcheck %-9s %-11s %s\n", commands[i]->name, commands[i]->arguments, commands[i]->about);
    fprintf(out, "\n'clothcheck COMMAND --help' tells a command's options. Exit status: 0 fine, 1 a check failed, 2 "
                 "wrong usage or input.\n");
}

static int print_command_help(const ck_Command *command) {
    printf("clothcheck %s%s%s%s\n\n%s\n\n", command->name, *command->arguments ? " " : "", command->arguments,
           command->groups ? " [options]" : "", command->help);
    ck_arguments_help(command);
    return CK_EXIT_OK;
}

static bool asks_help(int argc, char **argv) {
    for (int i = 1; i < argc; i++)
        if (!strcmp(argv[i], "--help") || !strcmp(argv[i], "-h")) return true;
    return false;
}

// A closed standard stream would lend its number to the first file that is written.
static void open_streams(void) {
    int file;
    do file = open("/dev/null", O_RDWR);
    while (file >= 0 && file <= STDERR_FILENO);
    if (file >= 0) close(file);
}

// What is made of the tables, for the manual and the READMEs. False where there is no such text.
static bool print_text(const char *name) {
    if (!strcmp(name, "--manual"))
        ck_manual_print(commands, COMMANDS);
    else if (!strcmp(name, "--completion"))
        ck_completion_print(commands, COMMANDS);
    else if (!strcmp(name, "--commands"))
        ck_commands_print(commands, COMMANDS);
    else if (!strcmp(name, "--columns"))
        ck_columns_print();
    else
        return false;
    return true;
}

static int run(int argc, char **argv) {
    const char *name = argc > 1 ? argv[1] : "";
    bool is_help = !strcmp(name, "help");
    if (!strcmp(name, "--version")) {
        printf("clothcheck %s\n", CK_VERSION);
        return CK_EXIT_OK;
    }
    if (!strcmp(name, "--help") || !strcmp(name, "-h") || (is_help && argc == 2)) {
        print_help(stdout);
        return CK_EXIT_OK;
    }
    if (is_help && print_text(argv[2])) return CK_EXIT_OK;
    if (!*name) {
        print_help(stderr);
        return CK_EXIT_USAGE;
    }
    const ck_Command *command = find_command(argv[1 + is_help]);
    if (!command) return fail_unknown(argv[1 + is_help]);
    if (is_help || asks_help(argc - 1, argv + 1)) return print_command_help(command);
    return command->run(command, argc - 1, argv + 1);
}

int main(int argc, char **argv) {
    open_streams();
    // a reader that is gone, as head is, and a file that may not grow fail the write, not the work
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    ck_machine_begin();
    int result = run(argc, argv);
    // what has failed has said so
    if ((!fflush(stdout) && !ferror(stdout)) || result) return result;
    fprintf(stderr, "clothcheck: what was printed did not reach its file: %s\n", strerror(errno));
    return CK_EXIT_FAILED;
}
