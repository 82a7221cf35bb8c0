// What the engines of this program have in common, natives and origins: their version, and the ledger's common rows.
#ifndef CK_OWN_LEDGER_H
#define CK_OWN_LEDGER_H

#include "engine.h"

const char *ck_own_version(void);

// Adds the rows that they all meet exactly: mass, gravity, force, time step; and drag.
void ck_own_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used, const char *drag_formula,
                   ck_Match drag_match);

// Adds a row for each kind of spring there is, whose stiffness the engine takes as it is or not at all.
void ck_own_ledger_springs(ck_Ledger *ledger, const ck_Model *model, const char *parameter, const char *formula,
                           ck_Match match);

#endif
