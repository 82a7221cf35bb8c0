// Commands as a user runs them, each on a few small scenes: what is disturbed.
#ifndef COMMANDS_H
#define COMMANDS_H

#include "snapshot.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct Command {
    const char *name;
    const char *before; // what is run first, undisturbed, one a line; NULL: nothing
    const char *line;   // writes into out
    bool goes_on;       // run again when it is done; else it refuses what is there
} Command;

extern const Command commands[];
extern const size_t command_count;

// Makes a folder anew with the files that a command reads, and runs what comes before it. Fails the test where that
// cannot be done.
void commands_prepare(const char *directory, const Command *command);

// Runs a command line of the program in a folder, with its output in said, of the size given: the status as of waitpid.
//   disturbance  as DISTURB takes it; NULL: none
int commands_run(const char *directory, const char *disturbance, const char *line, char *said, size_t size);

// What was counted of a run.
typedef struct Counts {
    long moments, allocations, held;
} Counts;

Counts commands_count(void);

// What a command leaves in out, as of two undisturbed runs, and their counts.
Counts commands_watch(const char *directory, const Command *command, Snapshot *undisturbed);

// After a disturbance: the files that are there are whole; the same command ends as it would have, and leaves nothing
// behind. what: the disturbance, for who reads of a failure.
void commands_assert_mends(const char *directory, const Command *command, const Snapshot *undisturbed,
                           const char *what);

// A number of the environment; without it few, or where all is asked for that.
int number_of(const char *name, int few, int all);

// False where ONLY names another command.
bool is_asked(const Command *command);

#endif
