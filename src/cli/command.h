// The command line: one table row and one file a command.
#ifndef CK_COMMAND_H
#define CK_COMMAND_H

#include "answer.h"
#include "check.h"
#include "comparison.h"
#include "out_folder.h"

#define CK_EXIT_OK 0
#define CK_EXIT_FAILED 1 // a check failed
#define CK_EXIT_USAGE 2  // wrong usage or input

// Where check has its baseline, where --baseline does not say.
#define CK_BASELINE_PATH "tests/baseline/metrics.csv"

// What a command takes on its command line.
typedef enum ck_ArgumentGroup {
    CK_TAKES_OUT = 1,
    CK_TAKES_RUNS = 2, // --engine, --set, --threads and the limits
    CK_TAKES_TIMING = 4,
    CK_TAKES_JOBS = 8,
    CK_TAKES_SHARD = 16,
    CK_TAKES_GOAL = 32,
    CK_TAKES_ERROR = 64,
    CK_TAKES_UPDATE = 128,
    CK_TAKES_KEEPING = 256, // --append, --force
    CK_TAKES_BENCH = 512,
    CK_TAKES_PATIENCE = 1024,
    CK_TAKES_FIT = 2048,
    CK_TAKES_FORM = 4096, // --json, --markdown
    CK_TAKES_RECORDING = 8192,
    CK_TAKES_FORMAT = 16384,
    CK_TAKES_SPRING = 32768,
    CK_TAKES_STUDY = 65536,
    CK_TAKES_PART = 131072, // --shard, of scenes
    CK_TAKES_VIEW = 262144,
    CK_TAKES_PAPER = 524288, // --format pdf, --width
    CK_TAKES_FILM = 1048576
} ck_ArgumentGroup;

typedef struct ck_Command ck_Command;
struct ck_Command {
    const char *name, *arguments, *about;
    const char *help;     // what it does, in some lines
    unsigned groups;      // of options
    const char *out;      // where it writes to, where --out does not say; NULL: nowhere
    bool shares_out;      // several processes may work there, where they are not asked of one scene alone
    double seconds;       // of wall time that a run may take, where --time-limit does not say
    double patience;      // s of CPU time that a run may cost, where --patience does not say; 0: any
    double full_patience; // the same with --full
    // argv[0] is the command's name. Returns the exit status.
    int (*run)(const ck_Command *command, int argc, char **argv);
};

extern const ck_Command ck_command_demo, ck_command_fit, ck_command_list, ck_command_run, ck_command_compare,
    ck_command_check, ck_command_precision, ck_command_stability, ck_command_tune, ck_command_needs, ck_command_refine,
    ck_command_merge, ck_command_report, ck_command_claims, ck_command_bench, ck_command_code, ck_command_score,
    ck_command_export, ck_command_conform, ck_command_diff, ck_command_new_engine, ck_command_means,
    ck_command_findings, ck_command_study, ck_command_view, ck_command_film;

// What stands on a command line.
typedef struct ck_Arguments {
    const ck_Command *command;
    ck_CompareOptions options;
    const ck_Engine *engines[CK_COMPARISON_MAX_ENGINES];
    ck_Override overrides[64];
    const char *out;          // directory; NULL: none
    ck_OutFolder folder;      // it, claimed, of a command that writes there
    const char *points;       // of fit; NULL: none
    double uncertainty;       // of each of its coordinates, m
    const char *format;       // of export; NULL: json
    bool is_pdf, has_width;   // charts for a paper
    double paper_width;       // cm
    const char *film, *color; // NULL: the scene's name .mp4; strain
    int film_fps, film_width, film_height;
    const char *path, *name; // of a recording; NULL: none
    double frame_cost,
        interval;             // ms that a frame of it cost, NaN: not known; s between frames of .npy, 0: as the scene
    const char *rank_without; // pattern of engines that no answer names; NULL: none
    bool by_engine;           // results of one engine of a scene stand for themselves
    int shard, shards;
    bool runs_nothing;
    bool appends, forces;             // into a directory that holds other results: keeps them, replaces them
    int rounds, largest;              // of bench
    const char *only;                 // of bench: a part or a body; NULL: all
    double case_limit, study_timeout; // of study: s of wall time of a case, and of all; 0: any
    bool is_part, uses_slurm, finishes, is_dry;
    const char *partition, *slurm_time;   // as sbatch takes them; NULL: not given
    int array, array_limit, cores;        // parts, at a time, and of each
    double fps, mass, stiffness, damping; // of means: frames a second, kg, N/m, N*s/m
    char question[2048];                  // what is asked, without the scene, where to and how fast; words between tabs
    double error;                         // a tolerance; NAN: none
    double stretch;                       // a bound of strain; NAN: none
    double frame;                         // ms of CPU a frame of 1/60 s; NAN: any
    double timeout;                       // s of a search; 0: any
    const char *like;                     // an engine or a file; NULL: none
    const char *target;                   // METRIC=VALUE; NULL: none
    const char *varies[4];                // of --vary
    int vary_count;
    char *words[128]; // of a command without scenes
    int word_count;
    char *validate[16]; // paths, owned
    int validate_count;
    int port;     // of view; 0: any that is free
    double speed; // times real time; 0: as fast as it can
    bool opens_nothing, begins_paused;
    bool is_update;
    const char *baseline; // of check
    const char *history;  // directory; NULL: none
    ck_Tolerance tolerances[16];
    int tolerance_count;
    ck_Answer answer; // begun
    char **scenes;    // paths, owned with their texts
    int scene_count;
} ck_Arguments;

// An option of a command as its help tells it.
typedef struct ck_OptionText {
    const char *name, *value; // as in --name VALUE; value NULL: it has none. name NULL: there is no more
    char letter;              // -x; 0: none
    const char *help;
    char fallback[48]; // where it is not given; empty: nothing to say
} ck_OptionText;

// The options that a command takes, by their number.
ck_OptionText ck_option_text(const ck_Command *command, int index);

// The path of a scene: as it is, or for a bare name scenes/NAME.yaml, of this folder or of what came with the program.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. Free *path.
ck_Status ck_scene_path(char **path, const char *scene, ck_Error *error);

// Reads options and scene arguments.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. Free with ck_arguments_free in any case.
ck_Status ck_arguments_read(ck_Arguments *arguments, const ck_Command *command, int argc, char **argv, ck_Error *error);
// Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_arguments_add_scene(ck_Arguments *arguments, const char *scene, ck_Error *error);
// All scenes there are where none was given. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_arguments_all_scenes(ck_Arguments *arguments, ck_Error *error);
void ck_arguments_free(ck_Arguments *arguments);

// Print the manual page, and the completion of bash.
void ck_manual_print(const ck_Command *const *commands, int count);
void ck_completion_print(const ck_Command *const *commands, int count);
// Print the tables that README.md and reports/README.md hold.
void ck_commands_print(const ck_Command *const *commands, int count);
void ck_columns_print(void);

// Prints what the options are, for --help.
void ck_arguments_help(const ck_Command *command);

// Shows a scene while its runs are in memory.
typedef void ck_Show(ck_Arguments *arguments, const ck_Comparison *comparison);

// Loads every scene before any runs, runs them, writes the CSVs where an --out is given, and calls show for each.
// Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_command_compare_scenes(ck_Arguments *arguments, ck_Show *show, ck_Error *error);

// The exit status of a command that has done its work: its answer is ended, or an error is told on stderr; arguments
// are freed in any case.
int ck_command_end(ck_Arguments *arguments, ck_Status status, ck_Error *error);

// One row an engine: status, error and cost; how well the truth is known; and why an engine failed.
ck_Show ck_answer_summary;

// Which engine is the cheapest within 1 % of the truth, and which comes next; without those of --rank-without.
ck_Show ck_answer_cheapest;

// What the CSVs in --out say that a person should know, as many as a screen has room for; of a scene, or NULL: of all.
// Errors: those of ck_findings_read.
ck_Status ck_answer_findings(ck_Arguments *arguments, const char *scene, ck_Error *error);

// What a study of a scene came to, of the CSVs in a directory. Errors: CK_BAD_INPUT, CK_IO, CK_NO_MEMORY.
ck_Status ck_answer_precision(ck_Arguments *arguments, const char *scene, ck_Error *error);
ck_Status ck_answer_stability(ck_Answer *answer, const char *directory, const char *scene, ck_Error *error);
ck_Status ck_answer_needs(ck_Answer *answer, const char *directory, const char *scene, ck_Error *error);
ck_Status ck_answer_bench(ck_Answer *answer, const char *directory, ck_Error *error);
ck_Status ck_answer_quirks(ck_Answer *answer, const char *directory, ck_Error *error);

// Asks for signals to end what runs, so that whole files or none are left.
void ck_command_catch_signals(void);

// Tells of an error on stderr and returns the exit status that goes with it.
int ck_command_fail(ck_Status status, const ck_Error *error);

#endif
