#include "tool.h"

#include "process.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

bool ck_tool_is_there(const char *name) {
    const char *rest = getenv("PATH");
    char path[4096];
    while (rest && *rest) {
        const size_t length = strcspn(rest, ":");
        snprintf(path, sizeof path, "%.*s/%s", (int)length, rest, name);
        if (length && !access(path, X_OK)) return true;
        rest += length + (rest[length] == ':');
    }
    return false;
}

static _Noreturn void become(const char *const *words, const char *directory, const char *log) {
    // what it starts ends with it
    setpgid(0, 0);
    if ((directory && chdir(directory)) || !freopen(log, "w", stderr) || dup2(STDERR_FILENO, STDOUT_FILENO) < 0 ||
        !freopen("/dev/null", "r", stdin))
        _exit(126);
    execvp(words[0], (char *const *)words);
    _exit(CK_TOOL_MISSING);
}

ck_Status ck_tool_run(int *end, const char *const *words, const char *directory, const char *log, double seconds,
                      ck_Error *error) {
    const struct timespec pause = {.tv_nsec = 20000000};
    const double start = ck_wall();
    int state = 0;
    bool is_late = false;
    pid_t child = fork(), ended = 0;
    if (child == 0) become(words, directory, log);
    if (child < 0) return ck_fail(error, CK_IO, "%s cannot be started: %s", words[0], strerror(errno));
    while ((ended = waitpid(child, &state, WNOHANG)) == 0) {
        is_late = seconds > 0 && ck_wall() - start > seconds;
        if (ck_child_interrupted || is_late) kill(-child, SIGKILL);
        nanosleep(&pause, NULL);
    }
    *end = is_late ? CK_TOOL_LATE : ended == child && WIFEXITED(state) ? WEXITSTATUS(state) : -1;
    return ck_child_interrupted ? ck_fail(error, CK_IO, "interrupted; nothing was written") : CK_OK;
}
