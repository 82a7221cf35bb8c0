#include "ledger.h"

#include "hinges.h"
#include "model.h"

#include <math.h>
#include <stddef.h>

const char *const ck_match_names[] = {"exact", "approximate", "impossible"};

void ck_ledger_add(ck_Ledger *ledger, ck_LedgerRow row) {
    if (!ledger) return;
    if (ledger->count == CK_LEDGER_CAPACITY) return;
    ledger->rows[ledger->count++] = row;
}

static bool is_like_an_earlier(const ck_Model *model, int index) {
    for (int i = 0; i < index; i++)
        if (model->colliders[i].restitution == model->colliders[index].restitution &&
            model->colliders[i].friction == model->colliders[index].friction)
            return true;
    return false;
}

void ck_ledger_add_colliders(ck_Ledger *ledger, const ck_Model *model, ck_LedgerRow restitution,
                             ck_LedgerRow friction) {
    for (int i = 0, kinds = 0; i < model->collider_count && kinds < CK_LEDGER_COLLIDERS; i++) {
        if (is_like_an_earlier(model, i)) continue;
        kinds++;
        restitution.wanted = restitution.native_value = model->colliders[i].restitution;
        friction.wanted = friction.native_value = model->colliders[i].friction;
        ck_ledger_add(ledger, restitution);
        ck_ledger_add(ledger, friction);
    }
}

static bool has_mass_before(const ck_Model *model, int index) {
    for (int i = 0; i < index; i++)
        if (model->mass[i] == model->mass[index]) return true;
    return false;
}

void ck_ledger_add_masses(ck_Ledger *ledger, const ck_Model *model, ck_LedgerRow mass, bool takes_inverse) {
    const int last = model->particle_count - 1;
    for (int i = 0, kinds = 0; i <= last && kinds < CK_LEDGER_MASSES; i++) {
        if (i && model->mass[i] == model->mass[i - 1]) continue; // most are, and a large cloth has many
        if (has_mass_before(model, i)) continue;
        kinds++;
        mass.quantity = i ? i == last && model->body == CK_ROPE ? "mass of the last" : "mass of others" : "mass";
        mass.wanted = model->mass[i];
        mass.native_value = takes_inverse ? 1 / model->mass[i] : model->mass[i];
        ck_ledger_add(ledger, mass);
    }
}

void ck_ledger_add_bending(ck_Ledger *ledger, const ck_Model *model, const char *parameter, const char *formula,
                           ck_Match match) {
    if (model->hinge_count)
        ck_ledger_add(ledger, (ck_LedgerRow){"bending stiffness", model->bending, ck_hinges_unit(model), parameter,
                                             model->hinges[0].stiffness, formula, match});
}

void ck_ledger_add_material(ck_Ledger *ledger, const ck_Model *model) {
    if (!(model->membrane > 0)) return;
    const bool is_grid = model->columns > 0, is_isotropic = fabs(model->poisson - 1.0 / 3) < 0.01;
    double stiffest = 0;
    for (int i = 0; i < model->spring_count; i++)
        if (model->springs[i].kind == CK_STRUCTURAL) stiffest = fmax(stiffest, model->springs[i].stiffness);
    ck_ledger_add(ledger, (ck_LedgerRow){"membrane stiffness", model->membrane, "N/m", "stiffness", stiffest,
                                         is_grid ? "k = Eh/(1 + nu) of rows and columns, half at borders"
                                                 : "k = Eh*(A + A')/l^2 of an edge, sqrt(3)/2*Eh of equilateral faces",
                                         CK_EXACT});
    ck_ledger_add(ledger,
                  (ck_LedgerRow){"Poisson's ratio", model->poisson, "1", "shear stiffness",
                                 is_grid ? model->poisson * model->membrane / (1 - model->poisson * model->poisson) : 0,
                                 !is_grid       ? "1/3 of triangles, whatever k"
                                 : is_isotropic ? "kd = nu*Eh/(1 - nu^2): isotropic"
                                                : "kd = nu*Eh/(1 - nu^2): along the threads; isotropic at 1/3 only",
                                 is_grid && !is_isotropic ? CK_APPROXIMATE : CK_EXACT});
}

void ck_ledger_add_wind(ck_Ledger *ledger, const ck_Model *model, const char *parameter, const char *formula,
                        ck_Match match) {
    if (model->wind.face_count)
        ck_ledger_add(ledger,
                      (ck_LedgerRow){"air drag", model->wind.drag, "1", parameter, model->wind.drag, formula, match});
}
