#include "ode_translation.h"

#include "scaled_model.h"
#include "shape.h"
#include "time_scale.h"
#include "vector.h"

#include <math.h>

// A spring as ODE knows it: the joint pushes with k(L − l) − (h·k + c)·l̇ along the direction at the start of the step.
double ck_ode_error_reduction(const ck_Spring *spring, double h, const ck_Settings *used) {
    if (ck_settings_has(used, CK_OWN + CK_ODE_ERP)) return used->own[CK_ODE_ERP];
    return isinf(spring->stiffness) ? 0.8 : h * spring->stiffness / (h * spring->stiffness + spring->damping);
}

// A rigid bar keeps a little softness, as a share of what its ends' masses make of a force: dWorldStep aborts on
// redundant constraints without.
#define BAR_SOFTNESS 2.5e-10

// In the model's units; kg: the unit of mass of a scaled model.
double ck_ode_constraint_force_mixing(const ck_Model *model, const ck_Spring *spring, double h, const ck_Settings *used,
                                      double kg) {
    if (ck_settings_has(used, CK_OWN + CK_ODE_CFM)) return used->own[CK_ODE_CFM] * kg;
    double weight = ck_model_inverse_mass(model, spring->a) + ck_model_inverse_mass(model, spring->b);
    return isinf(spring->stiffness) ? BAR_SOFTNESS * weight : 1 / (h * spring->stiffness + spring->damping);
}

static void translate_springs(const ck_Model *model, double h, const ck_Settings *used, ck_Ledger *ledger,
                              ck_Match match) {
    bool has_cfm = ck_settings_has(used, CK_OWN + CK_ODE_CFM), has_erp = ck_settings_has(used, CK_OWN + CK_ODE_ERP);
    for (int kind = 0; kind < CK_SPRING_KINDS; kind++) {
        const ck_Spring *spring = ck_model_spring_of_kind(model, kind);
        if (!spring) continue;
        bool rigid = isinf(spring->stiffness);
        ck_ledger_add(ledger, (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m", "dParamCFM",
                                             ck_ode_constraint_force_mixing(model, spring, h, used, 1),
                                             has_cfm ? "as set"
                                             : rigid ? "2.5e-10*(wa + wb): softest that is safe"
                                                     : "1/(h*k + c)",
                                             rigid || has_cfm ? CK_APPROXIMATE : match});
        ck_ledger_add(ledger, (ck_LedgerRow){ck_stiffness_names[kind], spring->stiffness, "N/m", "dParamERP",
                                             ck_ode_error_reduction(spring, h, used),
                                             has_erp ? "as set"
                                             : rigid ? "0.8 of the error per step"
                                                     : "h*k/(h*k + c)",
                                             rigid || has_erp ? CK_APPROXIMATE : match});
    }
    if (model->terms & CK_TERM_DAMPING)
        ck_ledger_add(ledger,
                      (ck_LedgerRow){"spring damping", model->springs[0].damping, "N*s/m", "dParamERP, dParamCFM",
                                     model->springs[0].damping, "in both of the above", match});
}

static void translate_contact(const ck_Model *model, ck_Ledger *ledger) {
    ck_ledger_add_colliders(
        ledger, model,
        (ck_LedgerRow){"restitution", 0, "1", "motionN", 0,
                       "e*v_n at the surface, in the step after the impact; rests below 2*g*h", CK_APPROXIMATE},
        (ck_LedgerRow){"friction", 0, "1", "mu", 0, "dContactApprox1, fdir1 along the slip: a cone", CK_APPROXIMATE});
}

// Time step: h ≤ √(m·L/T) for the spring across its line, which ODE steps explicitly, with the whole load for T, which
// is the limit itself for a rope, so that half of it is taken there; at most 1/120 s, 1/240 s where there is contact,
// and a tenth of drag's time. For QuickStep also k·h²/m ≤ 5 (k·h²·W ≤ 10), where 50 iterations leave 1e-9 of a spring's
// error; ≤ 2 where there is contact, with whose friction it converges more slowly: a cloth on a ball shakes at 2.2 and
// lies still at 1.5.
void ck_ode_translate(const ck_Model *model, const ck_Settings *wanted, ck_Settings *used, ck_Ledger *ledger,
                      bool quick) {
    double across = (ck_shape_is_chain(model) ? 0.5 : 1) * ck_stability_transverse_time(model);
    double limit =
        fmin(fmin(model->collider_count ? 1.0 / 240 : 1.0 / 120, across), ck_stability_drag_time(model, 0.1));
    double rate = model->terms & CK_TERM_RIGID ? 0 : ck_stability_stiffness_rate(model);
    if (quick && rate > 0) limit = fmin(limit, sqrt((model->collider_count ? 4 : 10) / rate));
    limit = fmin(limit, ck_stability_bending_time(model));
    *used = (ck_Settings){.substeps = wanted->substeps ? wanted->substeps : ck_stability_substeps(model, limit)};
    ck_settings_take_own(used, wanted);
    if (quick) used->iterations = wanted->iterations ? wanted->iterations : 50;
    if (quick) used->relaxation = wanted->relaxation > 0 ? wanted->relaxation : 1.3;
    double h = model->step / used->substeps;
    ck_scaled_model_ledger(ledger, model);
    ck_ledger_add(ledger, (ck_LedgerRow){"time step", model->step, "s", "h", h, "step / substeps", CK_EXACT});
    ck_ledger_add_masses(
        ledger, model,
        (ck_LedgerRow){
            .unit = "kg", .native_parameter = "dMass", .formula = "m; kinematic where pinned", .match = CK_EXACT},
        false);
    if (model->terms & CK_TERM_GRAVITY)
        ck_ledger_add(ledger, (ck_LedgerRow){"gravity", ck_length(model->gravity), "m/s2", "dWorldSetGravity",
                                             ck_length(model->gravity), "g", CK_EXACT});
    if (model->terms & CK_TERM_FORCE)
        ck_ledger_add(ledger, (ck_LedgerRow){"force", ck_length(model->force), "N", "dBodyAddForce",
                                             ck_length(model->force), "F before each step", CK_EXACT});
    if (model->terms & CK_TERM_DRAG)
        ck_ledger_add(ledger, (ck_LedgerRow){"drag", model->drag, "1/s", "dBodySetLinearDamping", model->drag * h,
                                             "h*drag, threshold 0: first order", CK_APPROXIMATE});
    // QuickStep's iterations leave a rest of each spring's error; the direct solver leaves none
    translate_springs(model, h, used, ledger, quick ? CK_APPROXIMATE : CK_EXACT);
    ck_ledger_add_wind(ledger, model, "dBodyAddForce", "by face, before each step", CK_APPROXIMATE);
    ck_ledger_add_bending(ledger, model, "dBodyAddForce", "each hinge's force before each step: explicit",
                          CK_APPROXIMATE);
    translate_contact(model, ledger);
}
