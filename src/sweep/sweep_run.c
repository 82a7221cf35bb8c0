#include "sweep.h"

#include "files.h"
#include "process.h"
#include "provenance.h"
#include "queue.h"
#include "store.h"
#include "tables.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

// What the workers of a process share.
typedef struct Shared {
    ck_Costs costs;
    ck_Status status; // of the first that failed
    ck_Error error;
} Shared;

typedef struct Run {
    const ck_Sweep *sweep;
    char *folder;
    Shared *shared;
    double start, deadline; // of ck_wall
    pid_t parent;
    pid_t *workers;
} Run;

static ck_Status run_one(const Run *run, const ck_StoreWriter *writer, const ck_Board *board, int index,
                         ck_Error *error) {
    char *text = NULL;
    size_t size;
    const double start = ck_wall();
    ck_Status status = ck_sweep_case(run->sweep, index, &text, &size, error);
    const double cost = ck_wall() - start;
    if (!status) status = ck_store_add(writer, run->sweep->keys[index], cost, text, size, error);
    ck_board_end(board, index, !status);
    free(text);
    if (status) return status;
    int engine, point = ck_sweep_point(run->sweep, index, &engine);
    ck_costs_learn(&run->shared->costs, run->sweep, point, engine, cost);
    return CK_OK;
}

static bool waits(const Run *run) {
    return !run->sweep->options->is_part && run->sweep->options->shards <= 1;
}

static ck_Status take_cases(const Run *run, ck_Queue *queue, const ck_StoreWriter *writer, const ck_Board *board,
                            ck_Error *error) {
    ck_Status status = CK_OK;
    while (!status && !run->shared->status && ck_wall() < run->deadline && !ck_child_interrupted) {
        int index;
        const ck_Next next = ck_queue_next(queue, &index);
        if (next == CK_NEXT_CASE) status = run_one(run, writer, board, index, error);
        if (next == CK_NEXT_NO_LOCKS)
            status = ck_fail(error, CK_IO,
                             "%s: this file system has no locks (fcntl); give each process a part of its own: --shard "
                             "I/N with an --out of its own, and clothcheck merge",
                             board->path);
        if (next == CK_NEXT_NONE || (next == CK_NEXT_WAIT && !waits(run) && !queue->waits_for_truth)) break;
        // others have what is left, or the truth of it: they may end without having done it
        if (next == CK_NEXT_WAIT) nanosleep(&(struct timespec){.tv_nsec = 20000000}, NULL);
    }
    return status;
}

static _Noreturn void work(const Run *run) {
    ck_Error error = {0};
    ck_Board board = {.file = -1};
    ck_StoreWriter writer = {.file = -1};
    ck_Queue queue = {0};
    prctl(PR_SET_PDEATHSIG, SIGKILL); // no worker goes on without its study
    if (getppid() != run->parent) _exit(0);
    ck_Status status = ck_board_open(&board, run->folder, run->sweep->study, &error);
    if (!status) status = ck_store_writer_open(&writer, run->folder, &error);
    if (!status) status = ck_queue_create(&queue, run->sweep, &board, &run->shared->costs, &error);
    if (!status) status = take_cases(run, &queue, &writer, &board, &error);
    ck_store_writer_close(&writer);
    if (status && !run->shared->status && !ck_child_interrupted) {
        run->shared->error = error;
        run->shared->status = status;
    }
    _exit(0);
}

// How many of the cases are done, by the board.
static int count_done(const Run *run, const ck_Board *board, unsigned char *marks) {
    int done = 0;
    if (!ck_board_read(board, marks, run->sweep->case_count)) return 0;
    for (int i = 0; i < run->sweep->case_count; i++) done += marks[i] != 0;
    return done;
}

static void show(const Run *run, int done, int before) {
    char left[60] = "";
    const int all = run->sweep->case_count;
    if (done > before)
        snprintf(left, sizeof left, ", about %.0f s more", (ck_wall() - run->start) / (done - before) * (all - done));
    ck_progress_show("%s: %d of %d cases%s", run->sweep->options->file->name, done, all, left);
}

// Waits for all workers, and ends them when a signal has come.
static ck_Status wait_for_workers(const Run *run, int count, const ck_Board *board, unsigned char *marks,
                                  ck_Error *error) {
    ck_Status status = CK_OK;
    const int before = count_done(run, board, marks);
    for (int left = count, turns = 0; left > 0; turns++) {
        int how;
        const pid_t ended = waitpid(-1, &how, WNOHANG);
        if (ended <= 0) {
            nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
            if (turns % 50 == 49) show(run, count_done(run, board, marks), before);
            for (int i = 0; i < count && ck_child_interrupted; i++)
                if (run->workers[i] > 0) kill(run->workers[i], SIGKILL);
            continue;
        }
        for (int i = 0; i < count; i++)
            if (run->workers[i] == ended) run->workers[i] = -1;
        left--;
        if (!status && !ck_child_interrupted && (!WIFEXITED(how) || WEXITSTATUS(how)))
            status = ck_fail(error, CK_IO, "%s: a worker ended before its case; what is done is kept",
                             run->sweep->options->file->name);
    }
    ck_progress_clear();
    if (ck_child_interrupted) return ck_fail(error, CK_IO, "interrupted; the same command goes on where it was");
    return status;
}

static ck_Status run_workers(Run *run, int count, const ck_Board *board, unsigned char *marks, ck_Error *error) {
    int started = 0;
    ck_Status status = CK_OK;
    run->workers = calloc((size_t)count + 1, sizeof *run->workers);
    if (!run->workers) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    fflush(NULL);
    for (; started < count && !status; started++) {
        run->workers[started] = fork();
        if (run->workers[started] == 0) work(run);
        if (run->workers[started] < 0) status = ck_fail(error, CK_IO, "cannot start a worker: %s", strerror(errno));
    }
    if (status) started--;
    ck_Status waited = wait_for_workers(run, started, board, marks, status ? NULL : error);
    free(run->workers);
    status = status ? status : waited;
    if (status || !run->shared->status) return status;
    if (error) *error = run->shared->error;
    return run->shared->status;
}

// What the store holds: marks on the board, and costs to go by.
//   marks  [cases], for its use
static ck_Status take_stock(const Run *run, const ck_Board *board, unsigned char *marks, int *missing,
                            ck_Error *error) {
    ck_Store store = {0};
    // a case is marked after it is kept: one that is marked before the store is read, and not there, was removed
    ck_board_read(board, marks, run->sweep->case_count);
    ck_Status status = ck_store_open(&store, run->folder, error);
    *missing = 0;
    for (int i = 0; i < run->sweep->case_count && !status; i++) {
        const ck_StoreEntry *entry = ck_store_find(&store, run->sweep->keys[i]);
        if (!entry) {
            ++*missing;
            if (marks[i]) ck_board_mark(board, i, false);
            continue;
        }
        int engine, point = ck_sweep_point(run->sweep, i, &engine);
        if (!marks[i]) ck_board_mark(board, i, true);
        ck_costs_learn(&run->shared->costs, run->sweep, point, engine, entry->cost);
    }
    ck_store_free(&store);
    return status;
}

// A file of this host's facts, for machine.csv.
static ck_Status tell_machine(const char *folder, ck_Error *error) {
    char *machines = ck_path_join(folder, "machines"), *host = machines ? ck_path_join(machines, ck_host()) : NULL;
    ck_Status status = host ? ck_machine_save(host, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    free(host);
    free(machines);
    return status;
}

// What processes of this host that were killed have left: folders of work, and files without a case.
static void sweep_up(const char *folder) {
    DIR *directory = opendir(folder);
    const size_t length = strlen(ck_host());
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        const char *name = entry->d_name, *ending = strrchr(name, '.');
        if (strncmp(name, ck_host(), length) || name[length] != '.' || !ending) continue;
        const int process = atoi(name + length + 1);
        struct stat about;
        char *path = ck_path_join(folder, name);
        const bool is_gone = process > 0 && kill(process, 0) && errno == ESRCH;
        const bool is_left =
            !strcmp(ending, ".work") || (!strcmp(ending, ".cases") && path && !stat(path, &about) && !about.st_size);
        if (path && is_gone && is_left) ck_path_remove(path);
        free(path);
    }
    if (directory) closedir(directory);
}

static ck_Status start(Run *run, ck_Board *board, ck_Error *error) {
    if (!run->folder || !run->shared) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    const int failed = ck_path_make(run->folder);
    if (failed) return ck_fail(error, CK_IO, "%s: %s", run->folder, strerror(failed));
    sweep_up(run->folder);
    ck_Status status = tell_machine(run->folder, error);
    return status ? status : ck_board_open(board, run->folder, run->sweep->study, error);
}

ck_Status ck_sweep_run(const ck_Sweep *sweep, ck_SweepProgress *progress, ck_Error *error) {
    const ck_SweepOptions *options = sweep->options;
    Run run = {.sweep = sweep,
               .folder = ck_sweep_folder(options->directory),
               .shared = ck_shared_allocate(sizeof(Shared)),
               .start = ck_wall(),
               .parent = getpid(),
               .deadline = options->timeout > 0 ? ck_wall() + options->timeout : INFINITY};
    ck_Board board = {.file = -1};
    int missing = 0;
    unsigned char *marks = malloc((size_t)sweep->case_count + 1);
    ck_Status status = marks ? start(&run, &board, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = take_stock(&run, &board, marks, &missing, error);
    const int jobs = options->jobs < missing ? options->jobs : missing;
    if (!status && jobs) status = run_workers(&run, jobs, &board, marks, error);
    // what is marked and is not there, as of a file that was removed, is run in another round
    const int done = status ? 0 : count_done(&run, &board, marks);
    *progress = (ck_SweepProgress){.done = done, .all = sweep->case_count};
    ck_board_close(&board);
    ck_shared_free(run.shared, sizeof(Shared));
    free(run.folder);
    free(marks);
    return status;
}
