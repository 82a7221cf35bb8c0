// The finished cases of studies in a folder: each a record of text under a hash of all that it depends on, so that a
// study which is killed, or given more values, runs what is missing. Many processes may write at once, on many
// machines.
//
// OUT/study/HOST.NUMBER.cases, one a process: records of
//     case KEY BYTES COST CHECK\n, so many bytes, \n
// What a kill cut off, and what is damaged, is not there. OUT/study/board-STUDY: a byte a case, 1 where it is done,
// locked (fcntl, as it also works between machines) by who runs it: a lock ends with its process, however that ends.
#ifndef CK_STORE_H
#define CK_STORE_H

#include "status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct ck_StoreEntry {
    uint64_t key;
    int64_t place; // byte of its file where the text begins
    uint32_t file, bytes;
    double cost; // s that it took
} ck_StoreEntry;

typedef struct ck_Store {
    char *directory;
    char **files; // names
    int file_count;
    ck_StoreEntry *entries; // [capacity], by key; bytes 0: none
    size_t capacity, count;
} ck_Store;

// Reads what there is. Memory: 40 bytes a case, and at most twice that. Errors: CK_IO, CK_NO_MEMORY. Free with
// ck_store_free in any case.
ck_Status ck_store_open(ck_Store *store, const char *directory, ck_Error *error);
void ck_store_free(ck_Store *store);

// NULL: it is not there.
const ck_StoreEntry *ck_store_find(const ck_Store *store, uint64_t key);

// The text of an entry, with a zero after it; NULL with an error. Free it. Cost: one open file at a time is kept.
//   file  in-out: the open file of the entry before and its number, or −1
typedef struct ck_StoreFile {
    int file, number;
} ck_StoreFile;
char *ck_store_text(const ck_Store *store, const ck_StoreEntry *entry, ck_StoreFile *file, ck_Error *error);

// A process's own file of records.
typedef struct ck_StoreWriter {
    int file;
    char *path;
} ck_StoreWriter;

ck_Status ck_store_writer_open(ck_StoreWriter *writer, const char *directory, ck_Error *error);
// Adds a record: whole, or not at all. Errors: CK_IO.
ck_Status ck_store_add(const ck_StoreWriter *writer, uint64_t key, double cost, const char *text, size_t bytes,
                       ck_Error *error);
// Accepts a zeroed one.
void ck_store_writer_close(ck_StoreWriter *writer);

// The board of a study's cases, which each worker opens for itself.
typedef struct ck_Board {
    int file;
    char *path;
} ck_Board;

ck_Status ck_board_open(ck_Board *board, const char *directory, uint64_t study, ck_Error *error);
// Accepts a zeroed one.
void ck_board_close(ck_Board *board);

typedef enum ck_Claim { CK_CLAIM_MINE, CK_CLAIM_DONE, CK_CLAIM_TAKEN, CK_CLAIM_NO_LOCKS } ck_Claim;
// Takes a case where nobody has it. NO_LOCKS: the file system has none.
ck_Claim ck_board_claim(const ck_Board *board, int index);
// Ends that: done or not.
void ck_board_end(const ck_Board *board, int index, bool is_done);
// Marks what the store holds already, or no longer.
void ck_board_mark(const ck_Board *board, int index, bool is_done);
// Reads all marks, [count].
bool ck_board_read(const ck_Board *board, unsigned char *marks, int count);
// True where nobody has any case.
bool ck_board_is_free(const ck_Board *board);
// Waits for the right to write the results, which lies beyond all cases.
bool ck_board_lock_results(const ck_Board *board, int count);

#endif
