// Chains of compliant springs, each one line: native-lines on what is no cloth.
#ifndef CK_CHAIN_H
#define CK_CHAIN_H

#include "native.h"

typedef struct ck_Chain ck_Chain;

// For a model whose springs make chains: none branches or is closed. They may touch what there is, and hang bodies.
// Errors: CK_REFUSED, CK_NO_MEMORY. Free with ck_chain_destroy.
ck_Status ck_chain_create(ck_Chain **chain, const ck_Model *model, ck_Error *error);
// Accepts NULL.
void ck_chain_destroy(ck_Chain *chain);

// N, at most, of any: all that hangs on it, or what pins stretch it by.
double ck_chain_tension(const ck_Chain *chain, const ck_Model *model);

// Takes up how stiff springs are in a substep: before the first one, and when a particle is let go.
void ck_chain_soften(ck_Chain *chain, const ck_Native *native);

// What comes after a substep's flight; see CK_PROJECT_LINES and CK_LINES_KEPT. Cost: three passes over springs a sweep.
void ck_chain_solve(ck_Chain *chain, ck_Native *native);

#endif
