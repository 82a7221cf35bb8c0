// Programs of others that are run for one task: gnuplot, a browser, ffmpeg.
#ifndef CK_TOOL_H
#define CK_TOOL_H

#include "status.h"

#include <stdbool.h>

// Of what is no program.
#define CK_TOOL_MISSING 127
// Of what was not done in its time.
#define CK_TOOL_LATE (-2)

// True where the search path has an executable file of the name.
bool ck_tool_is_there(const char *name);

// Runs a program to its end, and ends it where a signal asks for that.
//   end        its exit status; CK_TOOL_MISSING: there is none; CK_TOOL_LATE: it was ended; -1: a signal ended it
//   words      of its command line, NULL behind the last
//   directory  where it runs; NULL: here
//   log        a file there for all that it says
//   seconds    that it may take; 0: any
// Errors: CK_IO where it cannot be started, or a signal came.
ck_Status ck_tool_run(int *end, const char *const *words, const char *directory, const char *log, double seconds,
                      ck_Error *error);

#endif
