#include "process.h"

#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <unistd.h>

static bool is_shown;

void ck_progress_show(const char *format, ...) {
    if (!isatty(STDERR_FILENO)) return;
    va_list arguments;
    va_start(arguments, format);
    fputs("\r\033[K", stderr);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    is_shown = true;
}

void ck_progress_clear(void) {
    if (is_shown) fputs("\r\033[K", stderr);
    is_shown = false;
}
