// The program as a user runs it, in a directory of the test's own.
#ifndef FIXTURE_PROGRAM_H
#define FIXTURE_PROGRAM_H

#include <sys/types.h>

// Where a test group writes; made and removed by the two functions after it, which are for cmocka.
extern char fixture_directory[];
int fixture_make_directory(void **state);
int fixture_remove_directory(void **state);

// Starts the program in the source tree; both its streams go to output in the directory.
pid_t fixture_start(const char *arguments);

// The same to its end: its exit status. Fails the test where a signal ended it.
int fixture_program(const char *arguments);

// Fails the test where the last program did not print that.
void fixture_assert_output(const char *wanted);

// A file of the directory, which the caller frees; NULL where there is none.
char *fixture_read(const char *name);

#endif
