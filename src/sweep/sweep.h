// A study's cases: every scene at every value of every key, and what is run there.
#ifndef CK_SWEEP_H
#define CK_SWEEP_H

#include "comparison.h"
#include "study_file.h"

#include <stdio.h>

// A command line to be run in a child: its exit status.
typedef int ck_SweepCommand(int count, char **words);

typedef struct ck_SweepOptions {
    const ck_StudyFile *file;
    char *const *paths;               // of its scenes, [file->scene_count]
    const ck_CompareOptions *compare; // engines, limits, repeats, seed
    const char *directory;            // OUT
    ck_SweepCommand *command;         // for what is not compare
    char *const *words;               // options of it beside those of the file, [word_count]
    int word_count;
    int jobs;          // worker processes
    int shard, shards; // only every shards-th case, from the shard-th, counted from 1; 0: all
    double case_limit; // s of wall time of a case
    double timeout;    // s of wall time after which no case is begun; 0: none
    bool is_by_point;  // all engines of a point are one case
    bool is_part;      // others run cases, too: it does not wait for theirs
} ck_SweepOptions;

typedef struct ck_Sweep {
    const ck_SweepOptions *options;
    int point_count, engine_count; // of a point; engine_count 1 where all engines are one case
    int truth_count, case_count;   // truths first, then engines of the first point, of the second …
    bool is_by_engine;
    char **names;           // of the scenes
    char build[120];        // of the program
    uint64_t *point_hashes; // [points] of those that were loaded: of all that is in their models; else 0
    uint64_t *scene_hashes;
    uint64_t engine_hashes[CK_COMPARISON_MAX_ENGINES]; // of what those from outside are
    int *truth_of;                                     // [points] the case of its truth; −1: it needs none
    int *truth_at;                                     // [truths] a point that has it
    uint64_t *keys;                                    // [cases] hashes of all that they depend on
    uint64_t study;                                    // and of all of them
    double *work; // [points] that a run is in proportion to; 1 where it is not known
} ck_Sweep;

// Loads every scene at every value, one key changed at a time, and with at most 3,000 points at each of them.
//   options  must outlive it
// Errors: CK_BAD_INPUT, CK_NO_MEMORY, CK_IO. Free with ck_sweep_free in any case.
ck_Status ck_sweep_create(ck_Sweep *sweep, const ck_SweepOptions *options, ck_Error *error);
void ck_sweep_free(ck_Sweep *sweep);

// The word that names a point's scene with its changes; see change.h.
#define CK_SWEEP_WORD 8192
void ck_sweep_word(const ck_Sweep *sweep, int point, char word[CK_SWEEP_WORD]);

// The name that the scene has there.
#define CK_SWEEP_NAME 200
void ck_sweep_name(const ck_Sweep *sweep, int point, char name[CK_SWEEP_NAME]);

// The value of a key at a point, as YAML; NULL: of another axis. Keys are counted over all axes.
int ck_sweep_key_count(const ck_StudyFile *file);
const char *ck_sweep_key(const ck_StudyFile *file, int key);
const char *ck_sweep_value(const ck_Sweep *sweep, int point, int key);

// The scene of a point, by its number in the file.
int ck_sweep_scene(const ck_Sweep *sweep, int point);

// The point of a case, and the engine by its number; −1: the truth.
int ck_sweep_point(const ck_Sweep *sweep, int index, int *engine);

// OUT/study, where cases are kept. NULL without memory. Free it.
char *ck_sweep_folder(const char *directory);

// How far a study is.
typedef struct ck_SweepProgress {
    int done, all; // cases
} ck_SweepProgress;

// Runs the cases that are not there, longest first by what those that are have taken. Ends when all are, unless there
// is a timeout, a shard or a part. Errors: CK_IO, CK_NO_MEMORY, CK_BAD_INPUT.
ck_Status ck_sweep_run(const ck_Sweep *sweep, ck_SweepProgress *progress, ck_Error *error);

// Runs one case and gives its text, which the caller frees: sections "FILE BYTES\n" and rows of that file.
ck_Status ck_sweep_case(const ck_Sweep *sweep, int index, char **text, size_t *size, ck_Error *error);

// Writes the CSVs into OUT where all cases are there: in the order of the cases, whatever ran when and where, with
// columns for the scene, each key and the host after those of the contract. Memory: an entry of the store a case.
// Errors: CK_BAD_INPUT where some are missing, CK_IO, CK_NO_MEMORY.
ck_Status ck_sweep_write(const ck_Sweep *sweep, ck_Error *error);

// Copies the cases of other folders into OUT. Errors: CK_BAD_INPUT where one has none, CK_IO, CK_NO_MEMORY.
ck_Status ck_sweep_merge(const char *directory, char *const *parts, int part_count, ck_Error *error);

#endif
