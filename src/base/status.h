// What a function that may fail returns, and where it says why.
#ifndef CK_STATUS_H
#define CK_STATUS_H

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ck_Status {
    CK_OK = 0,
    CK_BAD_INPUT,   // the user's file or argument is wrong; the message says where and what would be right
    CK_NO_MEMORY,   // an allocation failed
    CK_IO,          // a file or a pipe could not be read or written
    CK_UNSUPPORTED, // the engine lacks a term that the scene needs
    CK_REFUSED,     // the engine could, but would not finish or fit; the message says why
} ck_Status;

// Filled by the function that fails. A caller may pass NULL where it does not care.
typedef struct ck_Error {
    char message[512];
} ck_Error;

// Writes a formatted message into error (which may be NULL) and returns status, so that a failure is one line.
ck_Status ck_fail(ck_Error *error, ck_Status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

#ifdef __cplusplus
}
#endif

#endif
