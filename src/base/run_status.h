// What a run can end in, and its name in every CSV.
#ifndef CK_RUN_STATUS_H
#define CK_RUN_STATUS_H

typedef enum ck_RunStatus {
    CK_RUN_OK,            // wherever it came to rest: its error grades that
    CK_RUN_UNSETTLED,     // still moves at the end of a scene whose truth is at rest
    CK_RUN_OVERSTRETCHED, // moves on with a spring of twice its length, more than its stiffness allows
    CK_RUN_ENERGY_GAIN,   // its motion gained more than a tenth of all the energy there was
    CK_RUN_DIVERGED,      // left the finite numbers
    CK_RUN_ABORTED,
    CK_RUN_TIMED_OUT,
    CK_RUN_OUT_OF_MEMORY,
    CK_RUN_UNSUPPORTED, // the scene needs a term that the engine lacks
    CK_RUN_REFUSED,
    CK_RUN_STATUS_COUNT,
} ck_RunStatus;
extern const char *const ck_run_status_names[CK_RUN_STATUS_COUNT];

#endif
