// What a user may set of an engine. 0 means: the engine's own documented rule decides.
#ifndef CK_SETTINGS_H
#define CK_SETTINGS_H

#include <stdint.h>

typedef struct ck_Settings {
    uint32_t substeps;   // steps of the engine per frame (time.step of the scene)
    uint32_t iterations; // solver iterations per substep, where the method has them
    double relaxation;   // over-relaxation of an iterative solver, usually 1 … 1.5
    uint32_t mended;     // quirks of an origin to leave out, bits as `clothcheck list` counts them
    uint32_t threads;    // that share a step, where the engine can; 0 and 1: none but the caller's
} ck_Settings;

#endif
