#include "talk.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

static _Noreturn void fail(const char *what) {
    fprintf(stderr, "%s: %s\n", what, strerror(errno));
    _exit(1);
}

static _Noreturn void be_command(const char *command, const int *to, const int *from) {
    char *line;
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    setpgid(0, 0);
    if (dup2(to[0], STDIN_FILENO) < 0 || dup2(from[1], STDOUT_FILENO) < 0) fail("cannot start the command");
    // nothing of this process's stays open in what may outlive it
    close_range(STDERR_FILENO + 1, ~0u, 0);
    // the shell only splits words: the command has its process, so that its CPU time is told
    if (asprintf(&line, "exec %s", command) < 0) fail("cannot start the command");
    execl("/bin/sh", "sh", "-c", line, (char *)NULL);
    fail("cannot start a shell");
}

void ck_talk_start(ck_Talk *talk, const char *command) {
    int to[2], from[2];
    signal(SIGPIPE, SIG_IGN); // a command that is gone is told by what it does not say
    if (pipe(to) || pipe(from)) fail("cannot start the command");
    fflush(NULL);
    talk->process = fork();
    if (talk->process < 0) fail("cannot start the command");
    if (!talk->process) be_command(command, to, from);
    close(to[0]);
    close(from[1]);
    talk->to = fdopen(to[1], "w");
    talk->from = fdopen(from[0], "r");
    if (!talk->to || !talk->from || clock_getcpuclockid(talk->process, &talk->clock))
        fail("cannot talk to the command");
}

// Ends as the command has ended, so that its status and its last words are told.
static _Noreturn void end_alike(ck_Talk *talk) {
    int status = 0;
    fclose(talk->to);
    while (waitpid(talk->process, &status, 0) < 0 && errno == EINTR) continue;
    if (WIFSIGNALED(status)) {
        signal(WTERMSIG(status), SIG_DFL);
        raise(WTERMSIG(status));
    }
    if (!WEXITSTATUS(status)) fprintf(stderr, "it ended before its scene did\n");
    _exit(WEXITSTATUS(status) ? WEXITSTATUS(status) : 1);
}

_Noreturn void ck_talk_refuse(ck_Talk *talk, const char *said, const char *wanted) {
    kill(-talk->process, SIGKILL);
    fflush(stderr);
    fprintf(stderr, "\nit said '%.60s' where it must say %s\n", said, wanted);
    _exit(1);
}

void ck_talk_line(ck_Talk *talk, char *line, size_t size) {
    fflush(talk->to);
    if (!fgets(line, (int)size, talk->from)) end_alike(talk);
    size_t length = strlen(line);
    if (!length || line[length - 1] != '\n') ck_talk_refuse(talk, line, "a line of words");
    line[--length] = 0;
    if (length && line[length - 1] == '\r') line[length - 1] = 0;
}

int ck_talk_ask(ck_Talk *talk, const char *yes, const char *no) {
    char line[200], wanted[80];
    ck_talk_line(talk, line, sizeof line);
    if (!strcmp(line, yes)) return 1;
    if (no && !strcmp(line, no)) return 0;
    snprintf(wanted, sizeof wanted, "%s%s%s", yes, no ? " or " : "", no ? no : "");
    ck_talk_refuse(talk, line, wanted);
}

void ck_talk_bytes(ck_Talk *talk, void *bytes, size_t count) {
    fflush(talk->to);
    if (fread(bytes, 1, count, talk->from) != count) end_alike(talk);
}

double ck_talk_cpu(const ck_Talk *talk) {
    struct timespec time;
    if (clock_gettime(talk->clock, &time)) return NAN;
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

// Given to a command that was told to quit, ms.
#define PATIENCE 200

void ck_talk_end(ck_Talk *talk) {
    fprintf(talk->to, "quit\n");
    fclose(talk->to);
    bool has_ended = false;
    for (int i = 0; i < PATIENCE && !has_ended; i++) {
        has_ended = waitpid(talk->process, NULL, WNOHANG) != 0;
        if (!has_ended) nanosleep(&(struct timespec){.tv_nsec = 1000000}, NULL);
    }
    kill(-talk->process, SIGKILL);
    if (!has_ended) waitpid(talk->process, NULL, 0);
    fclose(talk->from);
}
