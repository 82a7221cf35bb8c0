// The ledger backwards: an engine's own settings as the stiffness and damping that they act like.
#ifndef CK_MEANS_H
#define CK_MEANS_H

#include "runner.h"
#include "spring_law.h"

// Of the chain, links.
#define CK_MEANS_LINKS 10

typedef struct ck_MeansQuestion {
    const ck_Engine *engine;
    ck_Settings settings;      // over its rule
    double mass;               // kg of each particle
    double frame;              // s
    double stiffness, damping; // of the scene's spring, N/m and N·s/m, where settings do not stand for them
    ck_Limits limits;
} ck_MeansQuestion;

typedef struct ck_Means {
    ck_Settings used;
    double dt;             // s, a substep
    ck_SpringLaw measured; // of one mass on one spring
    ck_SpringLaw theory;   // NaN where there is none
    double chain;          // N/m that each link of a hanging chain of equal masses acts with at rest
} ck_Means;

// Measures one mass on a spring, step by step, and a chain. Errors: CK_REFUSED where the engine fails, with its
// reason; CK_NO_MEMORY, CK_IO.
ck_Status ck_means_measure(ck_Means *means, const ck_MeansQuestion *question, ck_Error *error);

// What an engine makes of a spring of that stiffness and damping by its own rule: its ledger. Errors as above.
ck_Status ck_means_alike(ck_Ledger *ledger, const ck_Engine *engine, const ck_MeansQuestion *question, double stiffness,
                         double damping, ck_Error *error);

#endif
