// The command line: one table row and one file a command.
#ifndef CK_COMMAND_H
#define CK_COMMAND_H

#include "comparison.h"

#define CK_EXIT_OK 0
#define CK_EXIT_FAILED 1 // a check failed
#define CK_EXIT_USAGE 2  // wrong usage or input

typedef struct ck_Command {
    const char *name, *arguments, *about;
    int (*run)(int argc, char **argv); // argv[0] is the command's name
} ck_Command;

int ck_command_list(int argc, char **argv);
int ck_command_run(int argc, char **argv);
int ck_command_compare(int argc, char **argv);
int ck_command_claims(int argc, char **argv);
int ck_command_bench(int argc, char **argv);

// What run and compare have in common on their command lines.
typedef struct ck_Arguments {
    ck_CompareOptions options;
    const ck_Engine *engines[CK_SCENE_MAX_ENGINES];
    ck_Override overrides[64];
    const char *out; // directory; NULL: none
    char **scenes;   // paths, owned with their texts
    int scene_count;
} ck_Arguments;

// Reads options and scene arguments; a scene is a path, or a bare name that stands for scenes/NAME.yaml.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. Free with ck_arguments_free in any case.
ck_Status ck_arguments_read(ck_Arguments *arguments, int argc, char **argv, ck_Error *error);
void ck_arguments_free(ck_Arguments *arguments);

// What the options are, for --help.
extern const char ck_arguments_help[];

// Loads every scene before any runs, runs them, writes the CSVs where an --out is given, and calls show for each while
// its runs are in memory. Returns the exit status, having told of an error on stderr.
int ck_command_study(const ck_Arguments *arguments, void (*show)(const ck_Comparison *comparison));

// Prints one line per engine: status, error and cost. With a header when first is true.
void ck_print_summary(const ck_Comparison *comparison);

// Tells of an error on stderr and returns the exit status that goes with it.
int ck_command_fail(ck_Status status, const ck_Error *error);

#endif
