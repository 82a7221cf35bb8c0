#include "process.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

volatile sig_atomic_t ck_child_interrupted;

ck_Status ck_child_check(ck_Error *error) {
    return ck_child_interrupted ? ck_fail(error, CK_IO, "interrupted; no CSV was written") : CK_OK;
}

ck_Limits ck_limits_default(void) {
    return (ck_Limits){.seconds = 900, .memory_bytes = (size_t)4 << 30};
}

void *ck_shared_allocate(size_t bytes) {
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return memory == MAP_FAILED ? NULL : memory;
}

void ck_shared_free(void *memory, size_t bytes) {
    if (memory) munmap(memory, bytes);
}

static double now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// Without memory of its own: another thread may start a child meanwhile, and the sanitizers' locks of memory would be
// held in that for ever.
static size_t resident_bytes(pid_t child) {
    char path[40], text[80] = "", *second;
    snprintf(path, sizeof path, "/proc/%d/statm", child);
    const int file = open(path, O_RDONLY | O_CLOEXEC);
    if (file < 0) return 0;
    const ssize_t got = read(file, text, sizeof text - 1);
    close(file);
    if (got <= 0) return 0;
    strtoul(text, &second, 10); // all that is mapped
    return strtoul(second, NULL, 10) * (size_t)sysconf(_SC_PAGESIZE);
}

size_t ck_process_memory(void) {
    return resident_bytes(getpid());
}

// In the environment of all programs that a child starts, with the child's number.
#define MARK "CLOTHCHECK_RUN"

// A child that has done its work says so by this exit status; one that ends by itself, as by exit(0), has not.
#define DONE 113

// Beyond the limit that is polled: what the kernel refuses to a child that asks for much at once.
#define HARD_LIMIT 1.25

// In the kernel, of all that it maps. The sanitizers map most of it, and so do programs of others.
static void limit_memory(const ck_Limits *limits) {
#ifndef __SANITIZE_ADDRESS__
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    const bool is_known = file && fscanf(file, "%lu", &pages) == 1;
    if (file) fclose(file);
    if (!is_known || !limits->memory_bytes || limits->spawns) return;
    const rlim_t most = pages * (rlim_t)sysconf(_SC_PAGESIZE) + (rlim_t)(HARD_LIMIT * (double)limits->memory_bytes);
    setrlimit(RLIMIT_AS, &(struct rlimit){most, most});
#else
    (void)limits;
#endif
}

static _Noreturn void be_child(void (*work)(void *), void *context, int output, const ck_Limits *limits) {
    char number[20];
    snprintf(number, sizeof number, "%d", (int)getpid());
    if (limits->spawns) setenv(MARK, number, 1);
    setpgid(0, 0);                    // what it starts ends with it
    prctl(PR_SET_PDEATHSIG, SIGKILL); // an interrupted comparison leaves no solver running
    prctl(PR_SET_NAME, "clothcheck-run");
    // in a group of its own it would be stopped for reading from a terminal
    const int nothing = open("/dev/null", O_RDONLY);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    ck_progress_keep();
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    signal(SIGHUP, SIG_DFL);
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_DFL);
    // a crash is a result here, not worth a core file
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    limit_memory(limits);
    work(context);
    fflush(NULL);
    _exit(DONE);
}

// The end of what a child printed; more is not kept.
typedef struct Tail {
    char text[1 << 16];
    size_t length;
} Tail;

static void drain(Tail *tail, int output) {
    char block[8192];
    ssize_t got;
    // who prints faster than it is read does not keep anybody from looking at the clock
    for (int i = 0; i < 64 && (got = read(output, block, sizeof block)) > 0; i++) {
        const size_t size = (size_t)got, room = sizeof tail->text - tail->length;
        if (size > room) {
            const size_t drop = size - room;
            memmove(tail->text, tail->text + drop, tail->length - drop);
            tail->length -= drop;
        }
        memcpy(tail->text + tail->length, block, size);
        tail->length += size;
    }
}

static bool has_ended(pid_t child) {
    siginfo_t info = {0};
    return !waitid(P_PID, (id_t)child, &info, WEXITED | WNOHANG | WNOWAIT) && info.si_pid == child;
}

// Waits until the child has ended, whatever it did to its descriptors, or passes a limit.
static ck_ChildEnd watch(pid_t child, int output, Tail *tail, const ck_Limits *limits) {
    const double end = now() + limits->seconds;
    // without such a descriptor its end is looked for more often
    const int ended = (int)syscall(SYS_pidfd_open, child, 0);
    ck_ChildEnd result = CK_CHILD_DONE;
    for (bool is_open = true;;) {
        struct pollfd ready[2] = {{.fd = is_open ? output : -1, .events = POLLIN}, {.fd = ended, .events = POLLIN}};
        poll(ready, 2, ended < 0 ? 2 : 20);
        if (ready[0].revents) drain(tail, output);
        // once all have closed it, it is ready for ever
        if (ready[0].revents & POLLHUP) is_open = false;
        if (has_ended(child)) break;
        if (ck_child_interrupted) result = CK_CHILD_ABORTED;
        if (limits->memory_bytes && resident_bytes(child) > limits->memory_bytes) result = CK_CHILD_NO_MEMORY;
        if (now() > end) result = CK_CHILD_TIMED_OUT;
        if (result != CK_CHILD_DONE) break;
    }
    if (ended >= 0) close(ended);
    return result;
}

static void last_line(char *line, size_t size, Tail *tail) {
    while (tail->length && strchr("\n ", tail->text[tail->length - 1])) tail->length--;
    size_t start = tail->length;
    while (start && tail->text[start - 1] != '\n') start--;
    snprintf(line, size, "%.*s", (int)(tail->length - start), tail->text + start);
}

// True where a process was started with the mark of a child, however much else is in its environment.
static bool has_mark(const char *process, const char *mark) {
    char path[64], *word = NULL;
    size_t room = 0;
    bool has = false;
    snprintf(path, sizeof path, "/proc/%.20s/environ", process);
    FILE *file = fopen(path, "re");
    while (file && !has && getdelim(&word, &room, 0, file) > 0) has = !strcmp(word, mark);
    if (file) fclose(file);
    free(word);
    return has;
}

// Rounds that find nothing until there is nothing: a process that just becomes another program has no environment for a
// moment.
#define QUIET_ROUNDS 3

// Ends what programs of a child have left running, whoever its parent is by now, and waits until it is gone. What it
// starts meanwhile is found in the next round.
static void end_strays(pid_t child) {
    char mark[40];
    snprintf(mark, sizeof mark, MARK "=%d", (int)child);
    for (int round = 0, quiet = 0; round < 200 && quiet < QUIET_ROUNDS; round++) {
        if (round) nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        DIR *processes = opendir("/proc");
        int found = 0;
        for (struct dirent *entry; processes && (entry = readdir(processes));) {
            if (entry->d_name[0] < '1' || entry->d_name[0] > '9' || !has_mark(entry->d_name, mark)) continue;
            found += !kill((pid_t)atoi(entry->d_name), SIGKILL);
        }
        if (processes) closedir(processes);
        quiet = found ? 0 : quiet + 1;
    }
}

// How near the limit a child that crashed was when that is taken for a lack of memory.
#define NEAR_LIMIT 0.8

static void describe(ck_ChildResult *result, int status, const ck_Limits *limits, Tail *tail) {
    if (result->end == CK_CHILD_DONE && WIFEXITED(status) && WEXITSTATUS(status) == DONE) return;
    char line[120];
    last_line(line, sizeof line, tail);
    const char *colon = *line ? ": " : "";
    const bool is_near = limits->memory_bytes && !limits->spawns &&
                         (double)result->peak_rss_bytes > NEAR_LIMIT * (double)limits->memory_bytes;
    if (result->end == CK_CHILD_DONE && WIFSIGNALED(status) && is_near) result->end = CK_CHILD_NO_MEMORY;
    if (result->end == CK_CHILD_TIMED_OUT)
        snprintf(result->reason, sizeof result->reason, "still running after the limit of %g s", limits->seconds);
    else if (result->end == CK_CHILD_NO_MEMORY)
        snprintf(result->reason, sizeof result->reason, "took more than the limit of %zu MiB",
                 limits->memory_bytes >> 20);
    else if (WIFSIGNALED(status))
        snprintf(result->reason, sizeof result->reason, "signal %d, %s%s%s", WTERMSIG(status),
                 strsignal(WTERMSIG(status)), colon, line);
    else
        snprintf(result->reason, sizeof result->reason, "exit status %d%s%s%s", WEXITSTATUS(status),
                 WEXITSTATUS(status) ? "" : " before its end", colon, line);
    if (result->end == CK_CHILD_DONE) result->end = CK_CHILD_ABORTED;
}

// Another child that is forked meanwhile would hold the writing end of this one's pipe.
static pthread_mutex_t starting = PTHREAD_MUTEX_INITIALIZER;

// The child's number; below 0: none, and errno says why.
static pid_t start(void (*work)(void *), void *context, const ck_Limits *limits, int *output) {
    int ends[2];
    pthread_mutex_lock(&starting);
    pid_t child = -1;
    if (!pipe2(ends, O_NONBLOCK | O_CLOEXEC)) {
        fcntl(ends[1], F_SETFL, 0); // the child waits until what it prints is read
        // else what is buffered here would be printed twice
        fflush(NULL);
        child = fork();
        // what work runs may start children of its own
        if (child == 0) pthread_mutex_unlock(&starting);
        if (child == 0) be_child(work, context, ends[1], limits);
        const int why = errno;
        if (child > 0) setpgid(child, child);
        close(ends[1]);
        if (child < 0) close(ends[0]);
        *output = ends[0];
        errno = why;
    }
    pthread_mutex_unlock(&starting);
    return child;
}

ck_Status ck_child_run(ck_ChildResult *result, void (*work)(void *), void *context, const ck_Limits *limits,
                       ck_Error *error) {
    *result = (ck_ChildResult){0};
    int output = -1, wait_status = 0;
    struct rusage usage = {0};
    // on the stack: see resident_bytes
    Tail tail;
    tail.length = 0;
    const pid_t child = start(work, context, limits, &output);
    if (child < 0) return ck_fail(error, CK_IO, "cannot start a run: %s", strerror(errno));
    result->end = watch(child, output, &tail, limits);
    // it is no longer waited for where it is stopped, and its group is its own as long as it is not waited for
    kill(-child, SIGKILL);
    kill(child, SIGKILL);
    while (wait4(child, &wait_status, 0, &usage) < 0 && errno == EINTR) continue;
    if (limits->spawns) end_strays(child);
    drain(&tail, output);
    close(output);
    result->peak_rss_bytes = (size_t)usage.ru_maxrss << 10;
    describe(result, wait_status, limits, &tail);
    return ck_child_check(error);
}

typedef struct Crew {
    int count;
    atomic_int next;
    ck_Status (*work)(void *context, int index, ck_Error *error);
    void *context;
    pthread_mutex_t lock;
    int failed; // the lowest index that did; count: none
    ck_Status status;
    ck_Error error;
} Crew;

static void *join_crew(void *context) {
    Crew *crew = context;
    for (int i; (i = atomic_fetch_add(&crew->next, 1)) < crew->count;) {
        ck_Error error = {0};
        ck_Status status = crew->work(crew->context, i, &error);
        pthread_mutex_lock(&crew->lock);
        if (status && i < crew->failed) {
            crew->failed = i;
            crew->status = status;
            crew->error = error;
        }
        pthread_mutex_unlock(&crew->lock);
    }
    return NULL;
}

#define MOST_THREADS 64

int ck_parallel_with_children(int jobs) {
#ifdef __SANITIZE_ADDRESS__
    jobs = 1;
#endif
    return jobs;
}

ck_Status ck_parallel(int count, int jobs, ck_Status (*work)(void *context, int index, ck_Error *error), void *context,
                      ck_Error *error) {
    Crew crew = {.count = count, .work = work, .context = context, .failed = count};
    pthread_t threads[MOST_THREADS];
    // more than there are cores would only make each one wait
    int cores = (int)sysconf(_SC_NPROCESSORS_ONLN), most = jobs > 0 && jobs < cores ? jobs : cores, started = 0;
    if (most > count) most = count;
    if (most > MOST_THREADS) most = MOST_THREADS;
    pthread_mutex_init(&crew.lock, NULL);
    // the caller is one of the crew, so that all is done where no thread can be started
    while (started + 1 < most && !pthread_create(&threads[started], NULL, join_crew, &crew)) started++;
    join_crew(&crew);
    for (int i = 0; i < started; i++) pthread_join(threads[i], NULL);
    pthread_mutex_destroy(&crew.lock);
    if (crew.status && error) *error = crew.error;
    return crew.status;
}
