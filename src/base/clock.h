// What everything is timed with.
#ifndef CK_CLOCK_H
#define CK_CLOCK_H

#include <time.h>

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

#endif
