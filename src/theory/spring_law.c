#include "spring_law.h"

#include <math.h>

typedef struct Oscillator {
    ck_Method method;
    double mass, stiffness, damping, dt;
    double share; // of a position-based method: of an error that a substep removes; else 0
} Oscillator;

// One step of x and v, the deviation from rest: linear in both, and in the acceleration that native-verlet keeps.
static void advance(const Oscillator *of, double *x, double *v, double *pull) {
    const double h = of->dt, k = of->stiffness / of->mass, c = of->damping / of->mass, before = *x;
    if (of->share > 0) {
        *x = (1 - of->share) * (*x + h * *v);
        *v = (*x - before) / h;
    } else if (of->method == CK_METHOD_XPBD) {
        // Macklin and others, XPBD (2016), equation 26: γ = c/(k·h), α = 1/(k·h²)
        double ahead = *x + h * *v, gamma = c / (k * h);
        *x = ahead - (ahead + gamma * (ahead - before)) / (1 + gamma + 1 / (k * h * h));
        *v = (*x - before) / h;
    } else if (of->method == CK_METHOD_VELOCITY_VERLET) {
        const double ahead = *v + h * *pull;
        *x += h * *v + 0.5 * h * h * *pull;
        *v += 0.5 * h * *pull;
        *pull = -k * *x - c * ahead;
        *v += 0.5 * h * *pull;
    } else {
        bool is_implicit = of->method != CK_METHOD_SYMPLECTIC_EULER;
        *v = (*v - h * k * *x) / (1 + h * c + (is_implicit ? h * h * k : 0));
        *x += h * *v;
    }
}

void ck_spring_law_of_recurrence(ck_SpringLaw *law, double a, double b, double mass, double dt) {
    // λ² = a·λ + b; of two roots λ the rates are s = −ln λ/dt, and k = m·s₁·s₂, c = m·(s₁ + s₂)
    const double half = 0.5 * a, root = half * half + b;
    law->moving = law->damping = NAN;
    if (root < 0) {
        double rate = -0.5 * log(-b) / dt, turn = atan2(sqrt(-root), half) / dt;
        law->moving = mass * (rate * rate + turn * turn);
        law->damping = 2 * mass * rate;
    } else if (half - sqrt(root) > 0) {
        double slow = -log(half + sqrt(root)) / dt, fast = -log(half - sqrt(root)) / dt;
        law->moving = mass * slow * fast;
        law->damping = mass * (slow + fast);
    }
    // what rounding leaves of none
    if (fabs(law->damping) < 1e-9 * sqrt(law->moving * mass)) law->damping = 0;
}

static double own(const ck_Engine *engine, const ck_Settings *used, const char *name) {
    const ck_Setting *row = ck_setting_find(engine->settings, name);
    return row && ck_settings_has(used, row->slot) ? ck_settings_get(used, row->slot) : NAN;
}

// What the engine's own settings make of the scene's spring. False where nothing is known of it.
static bool translate(Oscillator *of, const ck_Engine *engine, const ck_Settings *used) {
    const bool is_share = engine->method == CK_METHOD_BULLET_PBD || engine->is_stock;
    switch (of->method) {
    case CK_METHOD_VELOCITY_VERLET:
    case CK_METHOD_SYMPLECTIC_EULER:
    case CK_METHOD_IMPLICIT_EULER: return true;
    case CK_METHOD_XPBD:
        if (used->softness > 0) of->stiffness = 1 / used->softness;
        return true;
    case CK_METHOD_SEMI_IMPLICIT_ODE: {
        // ODE's manual, "How to use ERP and CFM": ERP = h·k/(h·k + c), CFM = 1/(h·k + c)
        double erp = own(engine, used, "erp"), cfm = own(engine, used, "cfm");
        if (isnan(erp)) erp = of->dt * of->stiffness / (of->dt * of->stiffness + of->damping);
        if (isnan(cfm)) cfm = 1 / (of->dt * of->stiffness + of->damping);
        of->stiffness = erp / (of->dt * cfm);
        of->damping = (1 - erp) / cfm;
        return cfm > 0;
    }
    default:
        // what n sweeps leave of an error is what one leaves to the power of n
        if (is_share && used->softness > 0) of->share = 1 - pow(1 - used->softness, used->iterations);
        return of->share > 0;
    }
}

// Four positions in turn say a and b. The third root, of the acceleration that is kept, is small, and soon gone.
static void find_recurrence(ck_SpringLaw *law, const Oscillator *of) {
    const int skipped = of->method == CK_METHOD_VELOCITY_VERLET && of->damping > 0 ? 30 : 0;
    double x[4], v = 0, pull = -of->stiffness / of->mass, at = 1;
    for (int i = 0; i < skipped + 4; i++) {
        if (i >= skipped) x[i - skipped] = at;
        advance(of, &at, &v, &pull);
    }
    const double det = x[1] * x[1] - x[0] * x[2];
    ck_spring_law_of_recurrence(law, (x[1] * x[2] - x[0] * x[3]) / det, (x[1] * x[3] - x[2] * x[2]) / det, of->mass,
                                of->dt);
}

void ck_spring_law_predict(ck_SpringLaw *law, const ck_Engine *engine, const ck_Settings *used, double mass,
                           double stiffness, double damping, double dt) {
    Oscillator of = {engine->method, mass, stiffness, damping, dt, 0};
    *law = (ck_SpringLaw){NAN, NAN, NAN};
    if (!translate(&of, engine, used)) return;
    find_recurrence(law, &of);
    // a share s of an error is removed after g·dt² was added: at rest (1 − s)·(e + g·dt²) = e
    law->at_rest = of.share > 0 ? of.share < 1 ? mass * of.share / ((1 - of.share) * dt * dt) : INFINITY : of.stiffness;
}
