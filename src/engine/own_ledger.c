#include "own_ledger.h"

#include "vector.h"

const char *ck_own_version(void) {
    return CK_VERSION " double";
}

static void ledger_contact(ck_Ledger *ledger, const ck_Model *model) {
    ck_ledger_add_colliders(ledger, model,
                            (ck_LedgerRow){"restitution", 0, "1", "impulse", 0,
                                           "(1 + e)*v_n at the time of impact; 0 below 2*a_n*dt, which is rest",
                                           CK_EXACT},
                            (ck_LedgerRow){"friction", 0, "1", "impulse", 0,
                                           "Coulomb cone: at most mu*(1 + e)*v_n, mu*a_n at rest", CK_EXACT});
}

void ck_own_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used, const char *drag_formula,
                   ck_Match drag_match) {
    double dt = model->step / used->substeps;
    ck_ledger_add(ledger, (ck_LedgerRow){"time step", model->step, "s", "dt", dt, "step / substeps", CK_EXACT});
    ck_ledger_add_masses(
        ledger, model,
        (ck_LedgerRow){
            .unit = "kg", .native_parameter = "inverse_mass", .formula = "1/m, 0 where pinned", .match = CK_EXACT},
        true);
    if (model->terms & CK_TERM_GRAVITY)
        ck_ledger_add(ledger, (ck_LedgerRow){"gravity", ck_length(model->gravity), "m/s2", "acceleration",
                                             ck_length(model->gravity), "g", CK_EXACT});
    if (model->terms & CK_TERM_FORCE)
        ck_ledger_add(ledger, (ck_LedgerRow){"force", ck_length(model->force), "N", "acceleration",
                                             ck_length(model->force) / model->mass[0], "F/m", CK_EXACT});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger,
                      (ck_LedgerRow){"drag", model->drag, "1/s", "drag", model->drag, drag_formula, drag_match});
    ledger_contact(ledger, model);
}

void ck_own_ledger_springs(ck_Ledger *ledger, const ck_Model *model, const char *parameter, const char *formula,
                           ck_Match match) {
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, kind);
        if (spring)
            ck_ledger_add(ledger, (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m", parameter,
                                                 spring->stiffness, formula, match});
    }
}
