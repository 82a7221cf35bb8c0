// The keys of a scene file, as one table that both the checker and libcyaml read.
#ifndef CK_SCENE_SCHEMA_H
#define CK_SCENE_SCHEMA_H

#include <cyaml/cyaml.h>

// What a number must be beyond its type.
typedef enum ck_Range {
    CK_RANGE_FINITE,
    CK_RANGE_POSITIVE,
    CK_RANGE_NOT_NEGATIVE,
    CK_RANGE_UNIT, // 0 … 1
} ck_Range;

typedef struct ck_RangeRule {
    const char *path; // as in "network.nodes[].mass"
    ck_Range range;
} ck_RangeRule;

extern const ck_RangeRule ck_scene_ranges[]; // ends with a NULL path

// The schema of a whole scene file; of settings only that there may be some.
extern const cyaml_schema_value_t ck_scene_schema;

#endif
