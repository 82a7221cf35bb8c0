#include "process.h"

#include <dirent.h>
#include <errno.h>
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

static size_t resident_bytes(pid_t child) {
    char path[40];
    snprintf(path, sizeof path, "/proc/%d/statm", child);
    FILE *file = fopen(path, "r");
    if (!file) return 0;
    unsigned long total, resident;
    if (fscanf(file, "%lu %lu", &total, &resident) != 2) resident = 0;
    fclose(file);
    return resident * (size_t)sysconf(_SC_PAGESIZE);
}

size_t ck_process_memory(void) {
    return resident_bytes(getpid());
}

// In the environment of all programs that a child starts, with the child's number.
#define MARK "CLOTHCHECK_RUN"

static _Noreturn void be_child(void (*work)(void *), void *context, int output, int alive, bool spawns) {
    char number[20];
    snprintf(number, sizeof number, "%d", (int)getpid());
    if (spawns) setenv(MARK, number, 1);
    prctl(PR_SET_PDEATHSIG, SIGKILL); // an interrupted comparison leaves no solver running
    prctl(PR_SET_NAME, "clothcheck-run");
    dup2(output, STDOUT_FILENO);
    dup2(output, STDERR_FILENO);
    signal(SIGINT, SIG_DFL);
    signal(SIGTERM, SIG_DFL);
    // a crash is a result here, not worth a core file
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
    work(context);
    fflush(NULL);
    close(alive);
    _exit(0);
}

// Waits until the child closes its end of the pipe, by exit or death, or passes a limit.
static ck_ChildEnd watch(pid_t child, int alive, const ck_Limits *limits) {
    double end = now() + limits->seconds;
    for (;;) {
        struct pollfd ready = {.fd = alive, .events = POLLIN};
        if (poll(&ready, 1, 20) > 0) return CK_CHILD_DONE;
        if (ck_child_interrupted) return CK_CHILD_ABORTED;
        if (limits->memory_bytes && resident_bytes(child) > limits->memory_bytes) return CK_CHILD_NO_MEMORY;
        if (now() > end) return CK_CHILD_TIMED_OUT;
    }
}

static void read_last_line(char *line, size_t size, int output) {
    char text[1024];
    off_t length = lseek(output, 0, SEEK_END);
    off_t start = length > (off_t)sizeof text - 1 ? length - (off_t)sizeof text + 1 : 0;
    ssize_t got = pread(output, text, sizeof text - 1, start);
    while (got > 0 && (text[got - 1] == '\n' || text[got - 1] == ' ')) got--;
    text[got > 0 ? got : 0] = 0;
    char *last = strrchr(text, '\n');
    snprintf(line, size, "%.*s", (int)size - 1, last ? last + 1 : text);
}

// True where a process was started with the mark of a child.
static bool has_mark(const char *process, const char *mark) {
    char path[64], text[16384];
    snprintf(path, sizeof path, "/proc/%.20s/environ", process);
    FILE *file = fopen(path, "r");
    size_t length = file ? fread(text, 1, sizeof text, file) : 0, size = strlen(mark) + 1;
    if (file) fclose(file);
    for (size_t i = 0; i + size <= length; i++)
        if ((!i || !text[i - 1]) && !memcmp(text + i, mark, size)) return true;
    return false;
}

// Ends what programs of a child have left running, whoever its parent is by now, and waits until it is gone. What it
// starts meanwhile is found in the next round.
static void end_strays(pid_t child) {
    char mark[40];
    snprintf(mark, sizeof mark, MARK "=%d", (int)child);
    for (int round = 0, found = 1; round < 200 && found; round++) {
        if (round) nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
        DIR *processes = opendir("/proc");
        found = 0;
        for (struct dirent *entry; processes && (entry = readdir(processes));) {
            if (entry->d_name[0] < '1' || entry->d_name[0] > '9' || !has_mark(entry->d_name, mark)) continue;
            found += !kill((pid_t)atoi(entry->d_name), SIGKILL);
        }
        if (processes) closedir(processes);
    }
}

static void describe(ck_ChildResult *result, int status, const ck_Limits *limits, int output) {
    if (result->end == CK_CHILD_DONE && WIFEXITED(status) && WEXITSTATUS(status) == 0) return;
    char line[120];
    read_last_line(line, sizeof line, output);
    const char *colon = *line ? ": " : "";
    if (result->end == CK_CHILD_TIMED_OUT)
        snprintf(result->reason, sizeof result->reason, "still running after the limit of %g s", limits->seconds);
    else if (result->end == CK_CHILD_NO_MEMORY)
        snprintf(result->reason, sizeof result->reason, "took more than the limit of %zu MiB",
                 limits->memory_bytes >> 20);
    else if (WIFSIGNALED(status))
        snprintf(result->reason, sizeof result->reason, "signal %d, %s%s%s", WTERMSIG(status),
                 strsignal(WTERMSIG(status)), colon, line);
    else
        snprintf(result->reason, sizeof result->reason, "exit status %d%s%s", WEXITSTATUS(status), colon, line);
    if (result->end == CK_CHILD_DONE) result->end = CK_CHILD_ABORTED;
}

// A child must not inherit the writing end of another one's pipe, whose end would then not be seen.
static pthread_mutex_t starting = PTHREAD_MUTEX_INITIALIZER;

ck_Status ck_child_run(ck_ChildResult *result, void (*work)(void *), void *context, const ck_Limits *limits,
                       ck_Error *error) {
    *result = (ck_ChildResult){0};
    int output = memfd_create("output", MFD_CLOEXEC), alive[2] = {-1, -1};
    ck_Status status = CK_OK;
    pthread_mutex_lock(&starting);
    if (output < 0 || pipe(alive)) {
        status = ck_fail(error, CK_IO, "cannot start a run: %s", strerror(errno));
        pthread_mutex_unlock(&starting);
        goto cleanup;
    }
    // else what is buffered here would be printed twice
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) be_child(work, context, output, alive[1], limits->spawns);
    close(alive[1]);
    alive[1] = -1;
    pthread_mutex_unlock(&starting);
    if (child < 0) {
        status = ck_fail(error, CK_IO, "cannot start a run: %s", strerror(errno));
        goto cleanup;
    }
    result->end = watch(child, alive[0], limits);
    if (result->end != CK_CHILD_DONE) kill(child, SIGKILL);
    int wait_status = 0;
    struct rusage usage = {0};
    while (wait4(child, &wait_status, 0, &usage) < 0 && errno == EINTR) continue;
    result->peak_rss_bytes = (size_t)usage.ru_maxrss << 10;
    if (limits->spawns) end_strays(child);
    describe(result, wait_status, limits, output);
    if (!status) status = ck_child_check(error);
cleanup:
    if (output >= 0) close(output);
    if (alive[0] >= 0) close(alive[0]);
    if (alive[1] >= 0) close(alive[1]);
    return status;
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
