// What a scene's numbers come to in ODE's own.
#ifndef CK_ODE_TRANSLATION_H
#define CK_ODE_TRANSLATION_H

#include "engine.h"

// The engines' own settings, by their numbers.
enum { CK_ODE_ERP, CK_ODE_CFM };

// ERP and CFM of a spring, in the model's units; h: s, a substep; kg: the unit of mass of a scaled model.
double ck_ode_error_reduction(const ck_Spring *spring, double h, const ck_Settings *used);
double ck_ode_constraint_force_mixing(const ck_Model *model, const ck_Spring *spring, double h, const ck_Settings *used,
                                      double kg);

// Fills the settings that are used, where the caller leaves them to the rule, and the ledger.
void ck_ode_translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                      bool quick);

#endif
