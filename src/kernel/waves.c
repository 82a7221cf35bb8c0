#include "waves.h"

#include "choice.h"
#include "process.h"

#include <pthread.h>
#include <sched.h>
#include <semaphore.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

// Looks at another thread's progress before this one gives way, some 10 µs.
#define LOOKS 20000
// Looks for a next job before a thread sleeps, some 100 µs: to wake it takes as long as a frame of a small cloth.
#define IDLE_LOOKS 200000

// Waves of a thread's part at least, times the reach.
#define LEAST_PART 3
// Bytes that a core's second cache holds at least.
#define LEAST_SECOND_CACHE (1 << 19)

typedef enum Call { IDLE, ASLEEP, CALLED } Call;

typedef struct Worker {
    _Alignas(64) atomic_long done; // waves of all blocks so far, counted from the first of the first block
    atomic_int call;
    struct ck_Waves *waves;
    int index;
    pthread_t thread;
    sem_t wake;
} Worker;

struct ck_Waves {
    int threads, parts; // parts: threads that have work in this job
    ck_WaveWork work;
    const ck_HalvesWork *halves; // NULL: the job is of waves
    bool stops;
    ck_Choice choice;
    double begun;     // s: this job
    Worker workers[]; // the first is the caller
};

static void wait_for(const Worker *other, long done) {
    for (long looks = 0; atomic_load_explicit(&other->done, memory_order_acquire) < done; looks++)
        if (looks >= LOOKS) sched_yield();
}

bool ck_waves_are_shared(const ck_Waves *waves) {
    return waves && !waves->choice.is_alone;
}

static void begin_job(ck_Waves *waves) {
    if (waves) waves->begun = ck_wall();
}

static void end_job(ck_Waves *waves, long amount) {
    if (waves) ck_choice_count(&waves->choice, ck_wall() - waves->begun, (double)amount);
}

static int part_start(const ck_WaveWork *work, int parts, int part) {
    return (int)((long)work->waves * part / parts);
}

// The part of every block that is this thread's. Nothing of the job is touched once the last wave is told to be done.
static void run_part(ck_Waves *waves, int part) {
    const ck_WaveWork work = waves->work;
    const int first = part_start(&work, waves->parts, part), end = part_start(&work, waves->parts, part + 1);
    Worker *self = &waves->workers[part];
    for (long block = 0; block < work.blocks; block++) {
        if (part > 0) wait_for(self - 1, block * work.waves + first);
        for (int wave = first; wave < end; wave++) {
            int needed = wave + work.reach < work.waves ? wave + work.reach : work.waves - 1;
            if (block > 0 && needed >= end) wait_for(self + 1, (block - 1) * work.waves + needed + 1);
            work.run(work.state, block, wave);
            // what the neighbours wait for; each time told takes the line away from one that looks
            if (wave < first + work.reach || wave + 1 == end)
                atomic_store_explicit(&self->done, block * work.waves + wave + 1, memory_order_release);
        }
    }
}

// Told are the steps that the other half may wait for: each time takes the line away from one that looks.
static void run_half(ck_Waves *waves, int half) {
    const ck_HalvesWork work = *waves->halves;
    Worker *self = &waves->workers[half], *other = &waves->workers[1 - half];
    for (long step = 0; step < work.steps; step++) {
        long needs = 0;
        const bool meets = work.meets(work.state, step, half, &needs);
        if (meets) wait_for(other, needs);
        work.run(work.state, step, half == 0, half == 1);
        // the last one is told once: the caller may then begin another job
        if (meets && step + 1 < work.steps) atomic_store_explicit(&self->done, step + 1, memory_order_release);
    }
    atomic_store_explicit(&self->done, work.steps, memory_order_release);
}

static void call(Worker *worker) {
    if (atomic_exchange(&worker->call, CALLED) == ASLEEP) sem_post(&worker->wake);
}

static void wait_for_call(Worker *worker) {
    int idle = IDLE;
    for (int looks = 0; looks < IDLE_LOOKS && atomic_load(&worker->call) != CALLED; looks++) continue;
    if (atomic_compare_exchange_strong(&worker->call, &idle, ASLEEP))
        while (sem_wait(&worker->wake)) continue; // a signal may end it
    atomic_store(&worker->call, IDLE);
}

static void *serve(void *argument) {
    Worker *worker = argument;
    for (;;) {
        wait_for_call(worker);
        if (worker->waves->stops) return NULL;
        if (worker->waves->halves)
            run_half(worker->waves, worker->index);
        else
            run_part(worker->waves, worker->index);
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
    waves->choice = (ck_Choice){0};
    atomic_init(&waves->workers[0].done, 0);
    for (int i = 1; i < threads; i++) {
        Worker *worker = &waves->workers[i];
        worker->waves = waves;
        worker->index = i;
        atomic_init(&worker->call, IDLE);
        sem_init(&worker->wake, 0, 0);
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
        call(&waves->workers[i]);
        pthread_join(waves->workers[i].thread, NULL);
        sem_destroy(&waves->workers[i].wake);
    }
    free(waves);
}

static size_t second_cache(void) {
#ifdef _SC_LEVEL2_CACHE_SIZE
    const long bytes = sysconf(_SC_LEVEL2_CACHE_SIZE);
#else
    const long bytes = 0;
#endif
    return bytes > LEAST_SECOND_CACHE ? (size_t)bytes : LEAST_SECOND_CACHE;
}

int ck_waves_depth(const ck_Waves *waves, long passes, int rows, int lag, size_t row_bytes) {
    const size_t cache = second_cache();
    if (rows * row_bytes <= cache) return 1;
    long depth = (long)(cache / 2 / (lag * row_bytes)), most = passes;
    if (waves) {
        const int parted = rows / (LEAST_PART * lag * waves->threads);
        most = parted < passes / 8 ? parted : passes / 8;
    }
    if (depth > most) depth = most;
    return depth > 1 ? (int)depth : 1;
}

typedef struct Interleaved {
    const ck_Passes *passes;
    int depth;
} Interleaved;

static void run_wave(void *state, long block, int wave) {
    const Interleaved *interleaved = state;
    const ck_Passes *passes = interleaved->passes;
    for (int i = 0; i < interleaved->depth; i++) {
        const long pass = block * interleaved->depth + i;
        const int row = wave - passes->reach * i;
        if (pass < passes->passes && row >= 0 && row < passes->rows) passes->run(passes->state, pass, row);
    }
}

void ck_passes_run(ck_Waves *waves, const ck_Passes *passes) {
    const int reach = passes->reach, depth = ck_waves_depth(ck_waves_are_shared(waves) ? waves : NULL, passes->passes,
                                                            passes->rows, reach, passes->row_bytes);
    ck_waves_run(waves, &(ck_WaveWork){run_wave, &(Interleaved){passes, depth}, (passes->passes + depth - 1) / depth,
                                       passes->rows + reach * (depth - 1), reach * depth, passes->passes});
}

static void run_shared(ck_Waves *waves, const ck_WaveWork *work, int parts) {
    waves->work = *work;
    waves->halves = NULL;
    waves->parts = parts;
    for (int i = 0; i < parts; i++) atomic_store(&waves->workers[i].done, 0);
    for (int i = 1; i < parts; i++) call(&waves->workers[i]);
    run_part(waves, 0);
    for (int i = 1; i < parts; i++)
        wait_for(&waves->workers[i], (work->blocks - 1) * work->waves + part_start(work, parts, i + 1));
}

static void run_alone(const ck_WaveWork *work) {
    for (long block = 0; block < work->blocks; block++)
        for (int wave = 0; wave < work->waves; wave++) work->run(work->state, block, wave);
}

void ck_waves_run(ck_Waves *waves, const ck_WaveWork *work) {
    int parts = waves && work->blocks > 1 ? work->waves / (LEAST_PART * work->reach) : 1;
    if (waves && parts > waves->threads) parts = waves->threads;
    begin_job(waves);
    if (parts > 1 && ck_waves_are_shared(waves))
        run_shared(waves, work, parts);
    else
        run_alone(work);
    end_job(waves, work->amount);
}

static void run_halves_alone(const ck_HalvesWork *work) {
    for (long step = 0; step < work->steps; step++) work->run(work->state, step, true, true);
}

static void run_halves_shared(ck_Waves *waves, const ck_HalvesWork *work) {
    waves->halves = work;
    for (int i = 0; i < 2; i++) atomic_store(&waves->workers[i].done, 0);
    call(&waves->workers[1]);
    run_half(waves, 0);
    wait_for(&waves->workers[1], work->steps);
}

void ck_waves_run_halves(ck_Waves *waves, const ck_HalvesWork *work) {
    begin_job(waves);
    if (ck_waves_are_shared(waves))
        run_halves_shared(waves, work);
    else
        run_halves_alone(work);
    end_job(waves, work->amount);
}
