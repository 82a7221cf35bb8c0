// Where methods fail: time step against stiffness around a scene's rest, and the critical step beside what theory says.
#ifndef CK_STABILITY_STUDY_H
#define CK_STABILITY_STUDY_H

#include "comparison.h"
#include "csv_writer.h"
#include "prediction.h"
#include "study.h"

typedef struct ck_StabilityCase {
    const ck_Engine *engine;
    bool is_critical;    // bisects the critical step; else one cell of the map
    bool is_undamped;    // without spring damping and drag
    double stiffness;    // times the scene's
    double share;        // of a cell: its step in units of the undamped explicit limit at that stiffness
    uint32_t iterations; // of a cell; 0: the engine's own
} ck_StabilityCase;

// A scene's rest at one stiffness.
typedef struct ck_StabilityRest {
    double stiffness;
    double *position;     // [3*n] m
    ck_Vibration fastest; // of all; damped by springs alone
    ck_Vibration across;  // the fastest by tension across springs alone, which no spring damps; frequency 0: none
    double strain;        // the largest
} ck_StabilityRest;

#define CK_STABILITY_RESTS 3

typedef struct ck_StabilityMap {
    const ck_Comparison *comparison; // with its truth, outlives this
    const ck_CompareOptions *options;
    ck_StabilityRest rests[CK_STABILITY_RESTS];
    ck_StabilityCase *cases;
    int case_count;
} ck_StabilityMap;

// Lists the cases and finds the rests. Errors: CK_BAD_INPUT where the scene has no truth at rest, colliders or rigid
// bars; CK_REFUSED where no rest is found; CK_NO_MEMORY. Free with ck_stability_map_free in any case.
ck_Status ck_stability_map_create(ck_StabilityMap *map, const ck_Comparison *comparison,
                                  const ck_CompareOptions *options, ck_Error *error);
void ck_stability_map_free(ck_StabilityMap *map);

ck_Study ck_stability_map_study(const ck_StabilityMap *map);
void ck_stability_map_write(const ck_StabilityMap *map, const ck_JournalRow *rows, ck_Csv *csv);

// The names of the values of its journal; signature of ck_ValueName.
bool ck_stability_value(int index, char *name, size_t size);

#endif
