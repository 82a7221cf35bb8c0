// Compiled once for each kind of vectors; see loops.h.
#include "lanes.h"
#include "loops.h"

#define CHAINS 12

// Chains that do not wait for each other: more than a processor can have in flight, as many as it has registers for.
ck_Peak CK_LOOP(ck_peak);
long CK_LOOP(ck_peak)(long rounds, double *result) {
    ck_Lanes chains[CHAINS];
    for (int i = 0; i < CHAINS; i++) chains[i] = ck_lanes_all(i);
    for (long round = 0; round < rounds; round++)
#pragma GCC unroll 12
        for (int i = 0; i < CHAINS; i++)
            chains[i] = ck_lanes_plus(ck_lanes_all((ck_Real)1e-6), chains[i], ck_lanes_all((ck_Real)0.999999));
    *result = 0;
    for (int i = 0; i < CHAINS; i++)
        for (int lane = 0; lane < CK_LANES; lane++) *result += chains[i][lane];
    return rounds * CHAINS * CK_LANES;
}
