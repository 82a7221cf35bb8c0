#include "compliance.h"

double ck_compliance_of(const ck_Spring *spring, const ck_Settings *used) {
    return used->softness > 0 ? used->softness : 1 / spring->stiffness;
}

void ck_compliance_ledger(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used, const char *formula) {
    const double dt = model->step / used->substeps;
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, kind);
        if (!spring) continue;
        ck_ledger_add(ledger, (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m", "compliance",
                                             ck_compliance_of(spring, used) / (dt * dt),
                                             used->softness > 0 ? "as set, over dt^2" : formula, CK_APPROXIMATE});
    }
}

void ck_compliance_ledger_damping(ck_Ledger *ledger, const ck_Model *model, const ck_Settings *used) {
    const double dt = model->step / used->substeps;
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger,
                      (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "gamma",
                                     model->springs[0].damping * ck_compliance_of(&model->springs[0], used) / dt,
                                     "c*compliance/dt", CK_APPROXIMATE});
}
