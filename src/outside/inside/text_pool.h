// Texts of an engine from outside, which end with its process: those that are told of it go through shared memory.
#ifndef CK_TEXT_POOL_H
#define CK_TEXT_POOL_H

#include "ledger.h"

// NULL when out of memory.
typedef struct ck_TextPool ck_TextPool;
ck_TextPool *ck_text_pool_new(void);

// Accepts NULL.
void ck_text_pool_free(ck_TextPool *pool);

// Makes room: what was kept for an earlier run is written over.
void ck_text_pool_clear(ck_TextPool *pool);

// A copy that outlives the process; "" where there is no room or no text.
const char *ck_text_pool_keep(ck_TextPool *pool, const char *text);

// A row with copies of its texts.
ck_LedgerRow ck_text_pool_keep_row(ck_TextPool *pool, ck_LedgerRow row);

#endif
