// Work in child processes with limits, so that a crash, a hang or a flood of memory costs the caller nothing but a
// result; work in threads; clocks; and the line that says how far it has come.
#ifndef CK_PROCESS_H
#define CK_PROCESS_H

#include "status.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>
#include <time.h>

typedef struct ck_Limits {
    double seconds;      // of wall time
    size_t memory_bytes; // of resident memory; 0: none
    double patience;     // s of CPU time that a whole run may cost; 0: any
    bool spawns;         // the child starts programs: what is left of them is ended with it
} ck_Limits;

// 15 minutes, 4 GiB.
ck_Limits ck_limits_default(void);

typedef enum ck_ChildEnd { CK_CHILD_DONE, CK_CHILD_ABORTED, CK_CHILD_TIMED_OUT, CK_CHILD_NO_MEMORY } ck_ChildEnd;

typedef struct ck_ChildResult {
    ck_ChildEnd end;
    char reason[256];      // empty when done; else the signal or limit, and the last line the child printed
    size_t peak_rss_bytes; // of the child, with what it inherited
} ck_ChildResult;

// Set by a signal handler: the current child is ended, and ck_child_run fails with CK_IO from then on.
extern volatile sig_atomic_t ck_child_interrupted;

// CK_IO with its message once a signal has come, else CK_OK: for long work in the parent.
ck_Status ck_child_check(ck_Error *error);

// Forks, runs work(context) in the child and waits for it, with what it starts, whatever either does to its
// descriptors. What the child prints does not reach the caller's streams; its end is kept. A child that ends before
// work has returned is aborted, whatever its exit status. Memory is limited by its resident size, and a quarter above
// that in the kernel. Results travel through memory that context shares with the child. Errors: CK_IO when no process
// can be started. How the child ended is a result, not an error.
ck_Status ck_child_run(ck_ChildResult *result, void (*work)(void *context), void *context, const ck_Limits *limits,
                       ck_Error *error);

// The resident memory of this process, bytes, which a child starts with.
size_t ck_process_memory(void);

// One thread a core at most, for work that does not share what it writes: work(context, index) of each index below
// count, at most jobs at a time and one a core, in no order; jobs 0: one a core. work may start children. The first
// error of the lowest index is returned; others go on to their end.
ck_Status ck_parallel(int count, int jobs, ck_Status (*work)(void *context, int index, ck_Error *error), void *context,
                      ck_Error *error);

// The jobs of work that starts children: one with the address sanitizer, as a child that is forked while a thread
// allocates would wait for the sanitizer's lock for ever.
int ck_parallel_with_children(int jobs);

// Zeroed memory that a child's writes are seen in. NULL when there is none. Free with ck_shared_free.
void *ck_shared_allocate(size_t bytes);
void ck_shared_free(void *memory, size_t bytes);

// What everything is timed with.

// CPU time of the calling thread, s.
static inline double ck_thread_cpu(void) {
    struct timespec time;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// CPU time of all threads of this process, s.
static inline double ck_process_cpu(void) {
    struct timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// Time on the wall, s, from an arbitrary start.
static inline double ck_wall(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// One line on the terminal that says how far a long command has come.

// Writes the line over the last one, on stderr; nothing where that is no terminal.
void ck_progress_show(const char *format, ...) __attribute__((format(printf, 1, 2)));

// Takes the line away.
void ck_progress_clear(void);

// Of a child, whose streams its parent takes: what it shows still reaches the terminal that the parent has.
void ck_progress_keep(void);

#endif
