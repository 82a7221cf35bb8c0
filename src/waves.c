#include "waves.h"

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>

// Looks at another thread's progress before this one gives way, some 10 µs.
#define LOOKS 2000

typedef struct Worker {
    _Alignas(64) atomic_long done; // waves of all blocks so far, counted from the first of the first block
    struct ck_Waves *waves;
    int index;
    pthread_t thread;
    sem_t start, end;
} Worker;

struct ck_Waves {
    int threads, parts; // parts: threads that have work in this job
    const ck_WaveWork *work;
    bool stops;
    Worker workers[]; // the first is the caller
};

static void wait_for(Worker *worker, long done) {
    for (int looks = 0; atomic_load_explicit(&worker->done, memory_order_acquire) < done; looks++)
        if (looks >= LOOKS) sched_yield();
}

static int part_start(const ck_Waves *waves, int part) {
    return (int)((long)waves->work->waves * part / waves->parts);
}

// The part of every block that is this thread's.
static void run_part(ck_Waves *waves, int part) {
    const ck_WaveWork *work = waves->work;
    const int first = part_start(waves, part), end = part_start(waves, part + 1);
    Worker *self = &waves->workers[part];
    for (long block = 0; block < work->blocks; block++) {
        if (part > 0) wait_for(self - 1, block * work->waves + first);
        for (int wave = first; wave < end; wave++) {
            int needed = wave + work->reach < work->waves ? wave + work->reach : work->waves - 1;
            if (block > 0 && needed >= end) wait_for(self + 1, (block - 1) * work->waves + needed + 1);
            work->run(work->state, block, wave);
            atomic_store_explicit(&self->done, block * work->waves + wave + 1, memory_order_release);
        }
    }
}

static void *serve(void *argument) {
    Worker *worker = argument;
    for (;;) {
        sem_wait(&worker->start);
        if (worker->waves->stops) return NULL;
        run_part(worker->waves, worker->index);
        sem_post(&worker->end);
    }
}

ck_Status ck_waves_create(ck_Waves **out, int threads, ck_Error *error) {
    *out = NULL;
    if (threads <= 1) return CK_OK;
    size_t bytes = sizeof(ck_Waves) + sizeof(Worker) * (size_t)threads;
    ck_Waves *waves = aligned_alloc(_Alignof(ck_Waves), (bytes + 63) / 64 * 64);
    if (!waves) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    waves->threads = 1;
    waves->stops = false;
    atomic_init(&waves->workers[0].done, 0);
    for (int i = 1; i < threads; i++) {
        Worker *worker = &waves->workers[i];
        worker->waves = waves;
        worker->index = i;
        sem_init(&worker->start, 0, 0);
        sem_init(&worker->end, 0, 0);
        if (pthread_create(&worker->thread, NULL, serve, worker)) {
            ck_waves_destroy(waves);
            return ck_fail(error, CK_NO_MEMORY, "no thread %d of %d", i + 1, threads);
        }
        waves->threads++;
    }
    *out = waves;
    return CK_OK;
}

void ck_waves_destroy(ck_Waves *waves) {
    if (!waves) return;
    waves->stops = true;
    for (int i = 1; i < waves->threads; i++) {
        sem_post(&waves->workers[i].start);
        pthread_join(waves->workers[i].thread, NULL);
        sem_destroy(&waves->workers[i].start);
        sem_destroy(&waves->workers[i].end);
    }
    free(waves);
}

void ck_waves_run(ck_Waves *waves, const ck_WaveWork *work) {
    int parts = waves ? work->waves / (2 * work->reach) : 1;
    if (waves && parts > waves->threads) parts = waves->threads;
    if (parts <= 1) {
        for (long block = 0; block < work->blocks; block++)
            for (int wave = 0; wave < work->waves; wave++) work->run(work->state, block, wave);
        return;
    }
    waves->work = work;
    waves->parts = parts;
    for (int i = 0; i < parts; i++) atomic_store(&waves->workers[i].done, 0);
    for (int i = 1; i < parts; i++) sem_post(&waves->workers[i].start);
    run_part(waves, 0);
    for (int i = 1; i < parts; i++) sem_wait(&waves->workers[i].end);
}
