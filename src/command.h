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
int ck_command_precision(int argc, char **argv);
int ck_command_stability(int argc, char **argv);
int ck_command_tune(int argc, char **argv);
int ck_command_needs(int argc, char **argv);
int ck_command_check(int argc, char **argv);
int ck_command_merge(int argc, char **argv);
int ck_command_report(int argc, char **argv);

// What run and compare have in common on their command lines.
typedef struct ck_Arguments {
    ck_CompareOptions options;
    const ck_Engine *engines[CK_SCENE_MAX_ENGINES];
    ck_Override overrides[64];
    const char *out; // directory; NULL: none
    int jobs;        // worker processes of a study; 0: as many as suit it
    int shard, shards;
    bool has_time_limit, runs_nothing;
    char question[2048];               // what is asked, without where to and how fast; words between tabs
    double error;                      // a tolerance; NAN: none
    const ck_Engine *like;             // NULL: none
    bool varies[CK_SETTING_COUNT + 1]; // of --vary; the last is stiffness
    char *validate[16];                // paths, owned
    int validate_count;
    bool is_update;
    char **scenes; // paths, owned with their texts
    int scene_count;
} ck_Arguments;

// What a command takes beside --out, --engine, --set, the limits and --threads.
typedef enum ck_ArgumentGroup {
    CK_TAKES_TIMING = 1,
    CK_TAKES_JOBS = 2,
    CK_TAKES_SHARD = 32,
    CK_TAKES_GOAL = 4,
    CK_TAKES_ERROR = 8,
    CK_TAKES_UPDATE = 16
} ck_ArgumentGroup;

// Reads options and scene arguments; a scene is a path, or a bare name that stands for scenes/NAME.yaml.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. Free with ck_arguments_free in any case.
ck_Status ck_arguments_read(ck_Arguments *arguments, int argc, char **argv, unsigned groups, ck_Error *error);
// All of scenes/ where none was given. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_arguments_all_scenes(ck_Arguments *arguments, ck_Error *error);
void ck_arguments_free(ck_Arguments *arguments);

// Prints what the options are, for --help.
void ck_arguments_help(unsigned groups);

// Loads every scene before any runs, runs them, writes the CSVs where an --out is given, and calls show for each while
// its runs are in memory. Returns the exit status, having told of an error on stderr.
int ck_command_study(const ck_Arguments *arguments, void (*show)(const ck_Comparison *comparison));

// Prints one line per engine: status, error and cost. With a header when first is true.
void ck_print_summary(const ck_Comparison *comparison);

// Asks for signals to end what runs, so that whole files or none are left.
void ck_command_catch_signals(void);

// Tells of an error on stderr and returns the exit status that goes with it.
int ck_command_fail(ck_Status status, const ck_Error *error);

#endif
