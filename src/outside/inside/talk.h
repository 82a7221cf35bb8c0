// Talking to a command through its standard input and output. All of this is for a child process: where the command
// says what it should not, or ends, that child ends, too, and its last words are the reason.
#ifndef CK_TALK_H
#define CK_TALK_H

#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>
#include <time.h>

typedef struct ck_Talk {
    pid_t process;
    FILE *to, *from;
    clockid_t clock; // of its CPU time
} ck_Talk;

// Starts a command, as a shell reads it. Its standard error stays this process's.
void ck_talk_start(ck_Talk *talk, const char *command);

// The next line, without its end, in room for size; words beyond that are an error.
void ck_talk_line(ck_Talk *talk, char *line, size_t size);

// Ends this process: what was said is not what was to come.
_Noreturn void ck_talk_refuse(ck_Talk *talk, const char *said, const char *wanted);

// Sends what was written, and reads the word that answers it: true for yes, false for no; anything else is refused.
int ck_talk_ask(ck_Talk *talk, const char *yes, const char *no);

// So many bytes.
void ck_talk_bytes(ck_Talk *talk, void *bytes, size_t count);

// s of CPU time of all its threads so far.
double ck_talk_cpu(const ck_Talk *talk);

// Says quit, and ends it where it does not end by itself.
void ck_talk_end(ck_Talk *talk);

#endif
