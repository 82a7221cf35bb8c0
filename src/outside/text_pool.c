#include "text_pool.h"

#include "process.h"

#include <string.h>

// Bytes, of a full ledger and a remark.
#define ROOM 16384

struct ck_TextPool {
    size_t used;
    char text[ROOM];
};

ck_TextPool *ck_text_pool_new(void) {
    return ck_shared_allocate(sizeof(ck_TextPool));
}

void ck_text_pool_free(ck_TextPool *pool) {
    if (pool) ck_shared_free(pool, sizeof *pool);
}

void ck_text_pool_clear(ck_TextPool *pool) {
    pool->used = 0;
}

const char *ck_text_pool_keep(ck_TextPool *pool, const char *text) {
    size_t length = text ? strlen(text) + 1 : 0;
    if (!length || pool->used + length > sizeof pool->text) return "";
    char *kept = memcpy(pool->text + pool->used, text, length);
    pool->used += length;
    return kept;
}

ck_LedgerRow ck_text_pool_keep_row(ck_TextPool *pool, ck_LedgerRow row) {
    row.quantity = ck_text_pool_keep(pool, row.quantity);
    row.unit = ck_text_pool_keep(pool, row.unit);
    row.native_parameter = ck_text_pool_keep(pool, row.native_parameter);
    row.formula = ck_text_pool_keep(pool, row.formula);
    return row;
}
