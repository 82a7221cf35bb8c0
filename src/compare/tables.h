// The six CSV files of a comparison.
#ifndef CK_TABLES_H
#define CK_TABLES_H

#include "comparison.h"
#include "csv_writer.h"
#include "replay_file.h"

typedef struct ck_Tables {
    ck_Csv csv[CK_COMPARISON_LAYOUTS];
} ck_Tables;

// What becomes of results that a directory holds already.
typedef enum ck_Keeping {
    CK_KEEP_OR_FAIL, // an error where any would be lost
    CK_KEEP_OTHERS,  // those of other scenes stay
    CK_KEEP_NONE,
} ck_Keeping;

// Starts all six in a directory, which is made where it is missing. The comparisons are those that will be added, each
// of the engines of options.
//   by_engine  others are those of other engines on the same scene, too
// Errors: CK_BAD_INPUT where results would be lost, CK_IO, CK_NO_MEMORY. End with ck_tables_close or ck_tables_discard
// in any case.
ck_Status ck_tables_open(ck_Tables *tables, const char *directory, ck_Keeping keeping, bool by_engine,
                         const ck_Comparison *comparisons, int count, const ck_CompareOptions *options,
                         ck_Error *error);

// Adds the rows of one finished comparison. options are those it ran with.
void ck_tables_add(ck_Tables *tables, const ck_Comparison *comparison, const ck_CompareOptions *options);

typedef enum ck_SeriesRows { CK_SERIES_ROWS_NONE, CK_SERIES_ROWS_ENGINES, CK_SERIES_ROWS_ALL } ck_SeriesRows;

// The rows of a finished comparison's layouts as text, without their headers: [CK_COMPARISON_LAYOUTS], but those of
// machine.csv, and of series.csv those that are asked for: the truth's among them, or not. Errors: CK_NO_MEMORY. Free
// each of rows in any case.
ck_Status ck_tables_text(char **rows, const ck_Comparison *comparison, const ck_CompareOptions *options,
                         ck_SeriesRows series, ck_Error *error);

// Adds what is known of the machine, and gives the six files their names. Errors: CK_IO.
ck_Status ck_tables_close(ck_Tables *tables, ck_Error *error);

void ck_tables_discard(ck_Tables *tables);

// What a timing depends on beside the code: processor, compiler, versions, how libraries were built, date.

// Tells one fact after the other.
typedef void (*ck_MachineFact)(void *context, const char *key, const char *value);
void ck_machine_tell(ck_MachineFact tell, void *context);

// The program with the commit that it is built of.
const char *ck_machine_build(void);

// Notes the machine's load before a command begins.
void ck_machine_begin(void);

// True for a fact of one run, as the command or the load, which is none of the machine and the build.
bool ck_machine_is_of_run(const char *key);

// Adds rows of key and value: what is told above, and the command, the load before and after it, and the date.
void ck_machine_write(ck_Csv *csv);

// Writes machine.csv into a directory. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_machine_save(const char *directory, ck_Error *error);

// Results that a directory holds already, of what is not run again.

typedef struct ck_Kept {
    const char *directory;
    const ck_Comparison *comparisons; // that will be written into it
    int count;
    const ck_CompareOptions *options; // and of which engines
    bool by_engine; // results of the engines of a scene stand for themselves: those of others may stay
} ck_Kept;

// Whether results in a layout's file, of scene and engine, would be lost: those of other scenes, unless they are kept,
// and those of engines that are left out now. Kept ones must be of this machine and build. Errors: CK_BAD_INPUT, which
// says what is there and what to give, CK_NO_MEMORY.
ck_Status ck_kept_check(const ck_Kept *kept, const ck_Layout *layout, bool keeps_others, ck_Error *error);

// Copies the rows that stay. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_kept_copy(const ck_Kept *kept, ck_Csv *csv, const ck_Layout *layout, ck_Error *error);

// The paths of a comparison's runs and of its truth, thinned to what is worth looking at. One file a scene;
// replay_file.h has its format.

// Frames of a replay for a page: at most so many, and some 4 MiB of them.
#define CK_REPLAY_FRAMES 61

// Writes a finished comparison's replay below a directory: every k-th frame and the last. Errors: CK_IO, CK_NO_MEMORY,
// and then there is none.
//   joins        the paths of other engines that a replay of the scene holds already stay, at its frames
//   most_frames  that are kept, of which a file of 61 has some 4 MiB at most
ck_Status ck_replay_write(const ck_Comparison *comparison, const char *directory, bool joins, int most_frames,
                          ck_Error *error);

#endif
