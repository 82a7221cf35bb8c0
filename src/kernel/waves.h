// Passes over rows that threads share, with the same result as one thread's, bit for bit.
//
// A job is a sequence of blocks (a substep, say), each a sequence of waves (a row, say). Each thread has its part of
// every block: the next one goes on where the one before ends, while that one is in the next block already. Nothing is
// done in another order than by one thread where it matters, so that a Gauss-Seidel sweep stays what it is.
#ifndef CK_WAVES_H
#define CK_WAVES_H

#include "status.h"

#include <stdbool.h>
#include <stddef.h>

//   amount  of work, in a unit of its owner's, by which the times of jobs are compared
typedef struct ck_WaveWork {
    void (*run)(void *state, long block, int wave);
    void *state;
    long blocks;
    int waves; // of a block
    int reach; // a wave needs this many waves after its own of the block before
    long amount;
} ck_WaveWork;

typedef struct ck_Waves ck_Waves;

// Starts threads - 1 threads that wait for work. One thread: *waves is NULL, which ck_waves_run takes.
// Errors: CK_NO_MEMORY. Free with ck_waves_destroy.
ck_Status ck_waves_create(ck_Waves **waves, int threads, ck_Error *error);
void ck_waves_destroy(ck_Waves *waves);

// True where the next job is for all threads that its work is enough for, as the first CK_CHOICE_PAUSE are: see
// choice.h.
bool ck_waves_are_shared(const ck_Waves *waves);

// How many passes over rows of so many bytes a block should hold, each lag rows behind the one before, at least 1. A
// cloth that a second cache cannot hold comes to it once a block: as many as keep half of it busy. With several threads
// there are to be eight blocks, as the others wait while the first is in its first one, and parts enough for all.
int ck_waves_depth(const ck_Waves *waves, long passes, int rows, int lag, size_t row_bytes);

// Passes over rows, of which several run interleaved where a cloth is beyond the second cache.
//   reach  rows below its own that a pass finds as the pass before left them
typedef struct ck_Passes {
    void (*run)(void *state, long pass, int row);
    void *state;
    long passes;
    int rows, reach;
    size_t row_bytes;
} ck_Passes;

void ck_passes_run(ck_Waves *waves, const ck_Passes *passes);

// Two halves of a job that go through the same steps, each by itself but where they come to what both share.
//   meets   true where a half comes there in a step; *needs: steps that the other must have done before, 0 for none
//   amount  as above
typedef struct ck_HalvesWork {
    void (*run)(void *state, long step, bool runs_first, bool runs_second);
    bool (*meets)(void *state, long step, int half, long *needs);
    void *state;
    long steps, amount;
} ck_HalvesWork;

// Returns when all is done, by one thread or by two.
void ck_waves_run_halves(ck_Waves *waves, const ck_HalvesWork *work);

// Returns when all is done. Parts of fewer than 3·reach waves are given to fewer threads, and one block to one. Cost:
// some atomic stores a block; a thread that waits burns its time, and gives way after a while; without a job it sleeps
// after 0.1 ms. Where threads do not gain, the caller runs the job alone but for trials, which changes no result.
void ck_waves_run(ck_Waves *waves, const ck_WaveWork *work);

#endif
