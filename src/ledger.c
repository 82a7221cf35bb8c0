#include "ledger.h"

#include <assert.h>
#include <stddef.h>

const char *const ck_match_names[] = {"exact", "approximate", "impossible"};

void ck_ledger_add(ck_Ledger *ledger, ck_LedgerRow row) {
    if (!ledger) return;
    assert(ledger->count < CK_LEDGER_CAPACITY);
    ledger->rows[ledger->count++] = row;
}
