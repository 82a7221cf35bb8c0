// Loaded before a program's libraries, it makes one thing go wrong at a moment that is counted, not timed:
//
//   DISTURB=kill:N:SIGNAL   at the N-th time that the program is about to change a file or to start a process
//   DISTURB=vanish:N        at that time the folder out gets the name gone
//   DISTURB=alloc:N         the N-th allocation finds no memory
//   DISTURB=count           nothing
//
// What is counted is the whole tree of processes that the program forks; signals go to its root. DISTURB_COUNT says
// where is written how many of both there were, and how many allocations the root has not freed at its end.
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

typedef struct Counts {
    atomic_long moments, allocations;
} Counts;

static Counts *counts;
static long kill_at, fail_at, vanish_at;
static int wanted_signal;
static pid_t root;
static atomic_long held; // of this process

__attribute__((constructor)) static void begin(void) {
    const char *what = getenv("DISTURB");
    void *shared = mmap(NULL, sizeof *counts, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (!what || shared == MAP_FAILED) return;
    sscanf(what, "kill:%ld:%d", &kill_at, &wanted_signal);
    sscanf(what, "alloc:%ld", &fail_at);
    sscanf(what, "vanish:%ld", &vanish_at);
    root = getpid();
    // programs that it runs are not disturbed
    unsetenv("LD_PRELOAD");
    counts = shared;
}

__attribute__((destructor)) static void end(void) {
    const char *path = getenv("DISTURB_COUNT");
    if (!counts || !path || getpid() != root) return;
    char text[60];
    const int length = snprintf(text, sizeof text, "%ld %ld %ld\n", counts->moments, counts->allocations, (long)held);
    Counts *of_this = counts;
    counts = NULL;
    const int file = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (file >= 0 && write(file, text, (size_t)length) == length) close(file);
    counts = of_this;
}

static void announce(void) {
    if (!counts) return;
    const long moment = atomic_fetch_add(&counts->moments, 1) + 1;
    if (moment == kill_at) kill(root, wanted_signal);
    if (moment == vanish_at) syscall(SYS_rename, "out", "gone");
}

static bool has_no_memory(void) {
    if (!counts) return false;
    if (atomic_fetch_add(&counts->allocations, 1) + 1 != fail_at) return false;
    errno = ENOMEM;
    return true;
}

// glibc's own, as dlsym allocates
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *memory, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

extern void __libc_free(void *memory);

static void *hold(void *memory) {
    if (memory) held++;
    return memory;
}

void *malloc(size_t size) {
    return has_no_memory() ? NULL : hold(__libc_malloc(size));
}

void *calloc(size_t count, size_t size) {
    return has_no_memory() ? NULL : hold(__libc_calloc(count, size));
}

void *realloc(void *memory, size_t size) {
    if (has_no_memory()) return NULL;
    void *larger = __libc_realloc(memory, size);
    if (!memory) hold(larger);
    if (memory && !size && !larger) held--;
    return larger;
}

void *aligned_alloc(size_t alignment, size_t size) {
    return has_no_memory() ? NULL : hold(__libc_memalign(alignment, size));
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    if (has_no_memory()) return ENOMEM;
    *memory = hold(__libc_memalign(alignment, size));
    return *memory ? 0 : ENOMEM;
}

void free(void *memory) {
    if (memory) held--;
    __libc_free(memory);
}

// The next library's function of that name and type.
#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

int open(const char *path, int flags, ...) {
    va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(arguments, mode_t) : 0;
    va_end(arguments);
    if (flags & O_CREAT) announce();
    return NEXT(open)(path, flags, mode);
}

FILE *fopen(const char *path, const char *mode) {
    if (*mode != 'r') announce();
    return NEXT(fopen)(path, mode);
}

int fflush(FILE *file) {
    announce();
    return NEXT(fflush)(file);
}

int rename(const char *from, const char *to) {
    announce();
    return NEXT(rename)(from, to);
}

int unlink(const char *path) {
    announce();
    return NEXT(unlink)(path);
}

int mkdir(const char *path, mode_t mode) {
    announce();
    return NEXT(mkdir)(path, mode);
}

int rmdir(const char *path) {
    announce();
    return NEXT(rmdir)(path);
}

int remove(const char *path) {
    announce();
    return NEXT(remove)(path);
}

int ftruncate(int file, off_t length) {
    announce();
    return NEXT(ftruncate)(file, length);
}

int fsync(int file) {
    announce();
    return NEXT(fsync)(file);
}

ssize_t write(int file, const void *bytes, size_t size) {
    announce();
    return NEXT(write)(file, bytes, size);
}

ssize_t pwrite(int file, const void *bytes, size_t size, off_t at) {
    announce();
    return NEXT(pwrite)(file, bytes, size, at);
}

pid_t fork(void) {
    announce();
    return NEXT(fork)();
}
