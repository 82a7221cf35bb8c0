// An engine's conformance card: what physics asks of any solver, each with a number, a tolerance by its precision and
// order, and a verdict. The scenes are scenes/conform/*.yaml.
#ifndef CK_CONFORM_H
#define CK_CONFORM_H

#include "comparison.h"
#include "csv_writer.h"

typedef enum ck_ConformVerdict {
    CK_CONFORM_PASS,
    CK_CONFORM_FAIL,
    CK_CONFORM_NONE // the engine cannot be asked: it does not model the scene, or has no such setting
} ck_ConformVerdict;
extern const char *const ck_conform_verdicts[];

// What one property came to.
typedef struct ck_ConformResult {
    double value, tolerance; // of the property's unit; NaN: none
    ck_ConformVerdict verdict;
    char reason[256]; // the tolerance's theory, or why there is no verdict
} ck_ConformResult;

// What all properties are asked with.
typedef struct ck_Conform {
    const char *directory; // of the scenes
    ck_Limits limits;
    ck_Comparison net, drift, fall, turn; // loaded
    char paths[4][4200];
} ck_Conform;

// Loads the scenes. Errors: CK_BAD_INPUT where they are not there, CK_NO_MEMORY. Free with ck_conform_close in any
// case.
ck_Status ck_conform_open(ck_Conform *conform, const ck_Limits *limits, ck_Error *error);
void ck_conform_close(ck_Conform *conform);

int ck_conform_property_count(void);
const char *ck_conform_property(int index); // "translation 1 km"
const char *ck_conform_unit(int index);

// Asks an engine for a property. Errors: CK_NO_MEMORY, CK_IO. How the engine fares is a result.
ck_Status ck_conform_ask(ck_ConformResult *result, const ck_Conform *conform, const ck_Engine *engine, int property,
                         ck_Error *error);

// Adds its row.
void ck_conform_add(const ck_ConformResult *result, const ck_Engine *engine, int property, ck_Csv *csv);

#endif
