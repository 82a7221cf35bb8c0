#include "study.h"

#include "files.h"
#include "process.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define MAX_KEY 512

// What workers share.
typedef struct Board {
    atomic_int next, done;
    ck_Status status; // of the first case that failed
    ck_Error error;
} Board;

typedef struct Job {
    const ck_Study *study;
    const ck_StudyOptions *options;
    const ck_Journal *journal;
    ck_JournalRow *rows;
    Board *board;
} Job;

static void name_journal(char *name, size_t size, const char *study) {
    snprintf(name, size, "%s.journal", study);
}

static bool is_mine(const ck_StudyOptions *options, int index) {
    return options->shards <= 1 || index % options->shards == options->shard - 1;
}

static void keep(void *context, const char *key, const ck_JournalRow *row) {
    const Job *job = context;
    char text[MAX_KEY];
    for (int i = 0; i < job->study->case_count; i++) {
        if (job->rows[i].is_done) continue;
        job->study->describe(job->study->context, i, text, sizeof text);
        if (strcmp(text, key)) continue;
        job->rows[i] = *row;
        return;
    }
}

static ck_Status run_case(const Job *job, int index, ck_Error *error) {
    ck_JournalRow row = {.is_done = true};
    char key[MAX_KEY];
    for (int i = 0; i < CK_JOURNAL_VALUES; i++) row.values[i] = NAN;
    job->study->describe(job->study->context, index, key, sizeof key);
    ck_Status status = job->study->run(job->study->context, index, &row, error);
    return status ? status : ck_journal_add(job->journal, key, &row, error);
}

static _Noreturn void work(const Job *job) {
    Board *board = job->board;
    prctl(PR_SET_PDEATHSIG, SIGKILL); // no worker goes on without its study
    for (int i; !board->status && (i = atomic_fetch_add(&board->next, 1)) < job->study->case_count;) {
        if (job->rows[i].is_done || !is_mine(job->options, i)) continue;
        ck_Error error = {0};
        ck_Status status = run_case(job, i, &error);
        if (status && !board->status) {
            board->error = error;
            board->status = status;
        }
        atomic_fetch_add(&board->done, 1);
    }
    _exit(0);
}

static void show(const Job *job, int wanted, double start) {
    int done = atomic_load(&job->board->done);
    double spent = ck_wall() - start;
    char left[40] = "";
    if (done > 0) snprintf(left, sizeof left, ", about %.0f s more", spent / done * (wanted - done));
    ck_progress_show("%s: %d of %d cases%s", job->study->name, done, wanted, left);
}

// Waits for all workers; ends them when a signal has come.
static ck_Status wait_for_workers(const Job *job, pid_t *workers, int count, int wanted, ck_Error *error) {
    ck_Status status = CK_OK;
    double start = ck_wall();
    for (int left = count; left > 0;) {
        int how;
        pid_t ended = waitpid(-1, &how, WNOHANG);
        if (ended <= 0) {
            struct timespec pause = {.tv_nsec = 20000000};
            nanosleep(&pause, NULL);
            show(job, wanted, start);
            for (int i = 0; i < count && ck_child_interrupted; i++)
                if (workers[i] > 0) kill(workers[i], SIGKILL);
            continue;
        }
        for (int i = 0; i < count; i++)
            if (workers[i] == ended) workers[i] = -1;
        left--;
        if (!status && !ck_child_interrupted && (!WIFEXITED(how) || WEXITSTATUS(how)))
            status =
                ck_fail(error, CK_IO, "%s: a worker ended before its case; what is done is kept", job->study->name);
    }
    ck_progress_clear();
    if (ck_child_interrupted) return ck_fail(error, CK_IO, "interrupted; the same command goes on where it was");
    return status;
}

static ck_Status run_workers(const Job *job, int wanted, ck_Error *error) {
    int count = job->options->jobs < wanted ? job->options->jobs : wanted, started = 0;
    pid_t *workers = calloc((size_t)count + 1, sizeof *workers);
    if (!workers) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_Status status = CK_OK;
    fflush(NULL);
    for (; started < count && !status; started++) {
        workers[started] = fork();
        if (workers[started] == 0) work(job);
        if (workers[started] < 0) status = ck_fail(error, CK_IO, "cannot start a worker: %s", strerror(errno));
    }
    if (status) started--;
    ck_Status waited = wait_for_workers(job, workers, started, wanted, status ? NULL : error);
    free(workers);
    return status ? status : waited;
}

ck_Status ck_study_run(const ck_Study *study, const ck_StudyOptions *options, ck_JournalRow *rows, ck_Error *error) {
    char name[64];
    name_journal(name, sizeof name, study->name);
    ck_Journal journal = {.file = -1};
    Board *board = ck_shared_allocate(sizeof *board);
    if (!board) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    memset(rows, 0, sizeof *rows * (size_t)study->case_count);
    Job job = {study, options, &journal, rows, board};
    ck_Status status =
        ck_journal_open(&journal, options->directory, name, options->question, study->name_at, keep, &job, error);
    int wanted = 0;
    for (int i = 0; i < study->case_count; i++) wanted += !rows[i].is_done && is_mine(options, i);
    if (!status && wanted && options->runs_nothing)
        status = ck_fail(error, CK_BAD_INPUT, "%d of %d cases are missing; give all parts", wanted, study->case_count);
    if (!status && wanted) status = run_workers(&job, wanted, error);
    if (!status && board->status) {
        status = board->status;
        if (error) *error = board->error;
    }
    // what the workers have added
    memset(rows, 0, sizeof *rows * (size_t)study->case_count);
    if (!status) status = ck_journal_read(&journal, options->question, keep, &job, error);
    int missing = 0;
    for (int i = 0; i < study->case_count; i++) missing += !rows[i].is_done && is_mine(options, i);
    if (!status && missing)
        status = ck_fail(error, CK_IO, "%s: %d cases were run and are not there; remove the file and start again",
                         journal.path, missing);
    ck_journal_close(&journal, false);
    ck_shared_free(board, sizeof *board);
    return status;
}

void ck_study_forget(const ck_Study *study, const ck_StudyOptions *options) {
    char name[64];
    name_journal(name, sizeof name, study->name);
    char *path = ck_path_join(options->directory, name);
    if (path) unlink(path);
    free(path);
}

typedef struct Copy {
    ck_Journal all;
    ck_Status status;
    ck_Error *error;
} Copy;

static void copy_row(void *context, const char *key, const ck_JournalRow *row) {
    Copy *copy = context;
    if (!copy->status) copy->status = ck_journal_add(&copy->all, key, row, copy->error);
}

ck_Status ck_study_merge(const char *directory, const char *study, ck_ValueName name_at, const char *const *parts,
                         int part_count, ck_Error *error) {
    char name[64], question[4096], other[4096];
    name_journal(name, sizeof name, study);
    ck_Journal part = {.file = -1};
    Copy copy = {.all = {.file = -1}, .error = error};
    ck_Status status = ck_journal_question(parts[0], name, question, sizeof question, error);
    for (int i = 1; i < part_count && !status; i++) {
        status = ck_journal_question(parts[i], name, other, sizeof other, error);
        if (!status && !ck_journal_is_same(other, question))
            status = ck_fail(error, CK_BAD_INPUT, "%s and %s are not parts of one study: they were asked '%s' and '%s'",
                             parts[0], parts[i], question, other);
    }
    if (!status) status = ck_journal_open(&copy.all, directory, name, question, name_at, NULL, NULL, error);
    for (int i = 0; i < part_count && !status; i++) {
        status = ck_journal_open(&part, parts[i], name, question, name_at, copy_row, &copy, error);
        if (!status) status = copy.status;
        ck_journal_close(&part, false);
    }
    ck_journal_close(&copy.all, false);
    return status;
}
