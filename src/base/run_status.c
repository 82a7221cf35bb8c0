#include "run_status.h"

const char *const ck_run_status_names[CK_RUN_STATUS_COUNT] = {
    "ok",      "unsettled", "overstretched", "energy_gain", "diverged",
    "aborted", "timed_out", "out_of_memory", "unsupported", "refused",
};
