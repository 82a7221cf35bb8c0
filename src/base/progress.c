#include "process.h"

#include <fcntl.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <unistd.h>

static int terminal = STDERR_FILENO;
static bool is_shown;

void ck_progress_keep(void) {
    const int kept = isatty(terminal) ? fcntl(terminal, F_DUPFD_CLOEXEC, STDERR_FILENO + 1) : -1;
    if (kept >= 0) terminal = kept;
}

void ck_progress_show(const char *format, ...) {
    if (!isatty(terminal)) return;
    va_list arguments;
    va_start(arguments, format);
    dprintf(terminal, "\r\033[K");
    vdprintf(terminal, format, arguments);
    va_end(arguments);
    is_shown = true;
}

void ck_progress_clear(void) {
    if (is_shown) dprintf(terminal, "\r\033[K");
    is_shown = false;
}
