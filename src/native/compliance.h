// What native engines with compliant constraints have in common.
#ifndef CK_COMPLIANCE_H
#define CK_COMPLIANCE_H

#include "engine.h"

// m/N, of a spring: as set, or 1/k.
double ck_compliance_of(const ck_Spring *spring, const ck_Settings *used);

// Adds a row for each kind of springs, α̃ = 1/(k·dt²); the formula is told where no compliance is set.
void ck_compliance_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used, const char *formula);

// Adds a row for damped springs, γ̃ = c/(k·dt).
void ck_compliance_ledger_damping(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used);

#endif
