// What a function that may fail returns, and where it says why.
#ifndef CK_STATUS_H
#define CK_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ck_Status {
    CK_OK = 0,
    CK_BAD_INPUT, // the user's file or argument is wrong; the message says where and what would be right
    CK_NO_MEMORY, // an allocation failed
    CK_IO,        // a file or a pipe could not be read or written
    CK_REFUSED,   // the engine could, but would not finish or fit; the message says why
} ck_Status;

// Filled by the function that fails. A caller may pass NULL where it does not care.
typedef struct ck_Error {
    char message[512];
} ck_Error;

// Writes a formatted message into error (which may be NULL) and returns status, so that a failure is one line.
ck_Status ck_fail(ck_Error *error, ck_Status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

// What a run can end in, and its name in every CSV.

typedef enum ck_RunStatus {
    CK_RUN_OK,            // wherever it came to rest: its error grades that
    CK_RUN_UNSETTLED,     // still moves at the end of a scene whose truth is at rest
    CK_RUN_OVERSTRETCHED, // moves on with a spring of twice its length, more than its stiffness allows
    CK_RUN_ENERGY_GAIN,   // its motion gained more than a tenth of all the energy there was
    CK_RUN_DIVERGED,      // left the finite numbers
    CK_RUN_ABORTED,
    CK_RUN_TIMED_OUT,
    CK_RUN_TOO_SLOW, // would have cost more CPU time than the caller has patience for
    CK_RUN_OUT_OF_MEMORY,
    CK_RUN_UNSUPPORTED, // the scene needs a term that the engine lacks
    CK_RUN_REFUSED,
    CK_RUN_STATUS_COUNT,
} ck_RunStatus;
extern const char *const ck_run_status_names[CK_RUN_STATUS_COUNT];

#ifdef __cplusplus
}
#endif

#endif
