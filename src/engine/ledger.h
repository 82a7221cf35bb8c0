// The equivalence ledger: what a scene asked of an engine, and what the engine could make of it.
#ifndef CK_LEDGER_H
#define CK_LEDGER_H

#include <stdbool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum ck_Match { CK_EXACT, CK_APPROXIMATE, CK_IMPOSSIBLE } ck_Match;
extern const char *const ck_match_names[];

// All strings are literals: a row crosses from a child process to its parent by value.
typedef struct ck_LedgerRow {
    const char *quantity; // as the scene knows it: "structural stiffness"
    double wanted;
    const char *unit;
    const char *native_parameter; // as the engine's manual knows it: "Material::m_kLST"
    double native_value;
    const char *formula; // how one follows from the other
    ck_Match match;
} ck_LedgerRow;

// Room for every quantity of a scene, for the quirks of an origin and for so many different colliders and masses.
#define CK_LEDGER_CAPACITY 48
#define CK_LEDGER_COLLIDERS 8
#define CK_LEDGER_MASSES 4

typedef struct ck_Ledger {
    ck_LedgerRow rows[CK_LEDGER_CAPACITY];
    int count;
} ck_Ledger;

// Adds a row. ledger may be NULL: then nobody asked. A full ledger takes no more.
void ck_ledger_add(ck_Ledger *ledger, ck_LedgerRow row);

// Adds the rows restitution and friction of every collider that differs from those before, of the first
// CK_LEDGER_COLLIDERS such: both rows say what the engine makes of them, the values are
// the colliders'.
struct ck_Model;
void ck_ledger_add_colliders(ck_Ledger *ledger, const struct ck_Model *model, ck_LedgerRow restitution,
                             ck_LedgerRow friction);

// Adds a row for every mass that differs from those before, of the first CK_LEDGER_MASSES such. takes_inverse: the
// engine keeps 1/m.
void ck_ledger_add_masses(ck_Ledger *ledger, const struct ck_Model *model, ck_LedgerRow mass, bool takes_inverse);

// Rows on the material that a scene's springs are made of: Young's modulus times thickness, and Poisson's ratio.
void ck_ledger_add_material(ck_Ledger *ledger, const struct ck_Model *model);

// A row on air, where there is any: its drag coefficient.
void ck_ledger_add_wind(ck_Ledger *ledger, const struct ck_Model *model, const char *parameter, const char *formula,
                        ck_Match match);

// A row on bending, where the model bends: what the stiffness is of the first hinge, N*m.
void ck_ledger_add_bending(ck_Ledger *ledger, const struct ck_Model *model, const char *parameter, const char *formula,
                           ck_Match match);

#ifdef __cplusplus
}
#endif

#endif
