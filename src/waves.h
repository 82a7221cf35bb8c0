// Passes over rows that threads share, with the same result as one thread's, bit for bit.
//
// A job is a sequence of blocks (a substep, say), each a sequence of waves (a row, say). Each thread has its part of
// every block: the next one goes on where the one before ends, while that one is in the next block already. Nothing is
// done in another order than by one thread where it matters, so that a Gauss-Seidel sweep stays what it is.
#ifndef CK_WAVES_H
#define CK_WAVES_H

#include "status.h"

// Bytes that a core's second cache surely holds.
#define CK_SECOND_CACHE (1 << 20)

typedef struct ck_WaveWork {
    void (*run)(void *state, long block, int wave);
    void *state;
    long blocks;
    int waves; // of a block
    int reach; // a wave needs this many waves after its own of the block before
} ck_WaveWork;

typedef struct ck_Waves ck_Waves;

// Starts threads - 1 threads that wait for work. One thread: *waves is NULL, which ck_waves_run takes.
// Errors: CK_NO_MEMORY. Free with ck_waves_destroy.
ck_Status ck_waves_create(ck_Waves **waves, int threads, ck_Error *error);
void ck_waves_destroy(ck_Waves *waves);

// How many of the passes over a cloth a block should hold, each bytes of rows behind the one before: as many as a
// second cache surely holds at once, for a cloth that is larger comes to it once a block. With several threads there
// are to be eight blocks: while the first half of the first is done the second thread waits. At least 1.
int ck_waves_depth(const ck_Waves *waves, long passes, long bytes);

// Returns when all is done. Parts of fewer than 3·reach waves are given to fewer threads. Cost: some atomic
// stores a block; a thread that waits burns its time, and gives way after a while; without a job it sleeps after 0.1
// ms.
void ck_waves_run(ck_Waves *waves, const ck_WaveWork *work);

#endif
