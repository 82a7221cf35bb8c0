#include "prediction.h"

#include "time_scale.h"

#include <math.h>

// For λ = −1 of one mode. Symplectic Euler with implicit damping: Ω² = 4 + 2·g, with Ω = ω·dt, g = damping·dt.
static double limit_of(ck_Method method, ck_Vibration motion) {
    double squared = motion.frequency * motion.frequency, damping = motion.damping;
    if (!(squared > 0)) return INFINITY;
    return method == CK_METHOD_VELOCITY_VERLET ? ck_stability_verlet_limit(motion.frequency, damping)
                                               : (damping + sqrt(damping * damping + 4 * squared)) / squared;
}

double ck_stability_limit(ck_Method method, ck_Vibration fastest, ck_Vibration across) {
    switch (method) {
    case CK_METHOD_VELOCITY_VERLET:
    case CK_METHOD_SYMPLECTIC_EULER: return fmin(limit_of(method, fastest), limit_of(method, across));
    // only tension across springs is stepped explicitly
    case CK_METHOD_SEMI_IMPLICIT_ODE: return across.frequency > 0 ? 2 / across.frequency : NAN;
    default: return NAN;
    }
}
