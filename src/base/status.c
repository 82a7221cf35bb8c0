#include "status.h"

#include <stdarg.h>
#include <stdio.h>

ck_Status ck_fail(ck_Error *error, ck_Status status, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        vsnprintf(error->message, sizeof error->message, format, arguments);
        va_end(arguments);
    }
    return status;
}

const char *const ck_run_status_names[CK_RUN_STATUS_COUNT] = {
    "ok",        "unsettled", "overstretched", "energy_gain", "diverged", "aborted",
    "timed_out", "too_slow",  "out_of_memory", "unsupported", "refused",
};
