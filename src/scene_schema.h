// The keys of a scene file, as one table that both the checker and libcyaml read.
#ifndef CK_SCENE_SCHEMA_H
#define CK_SCENE_SCHEMA_H

#include <cyaml/cyaml.h>

// What a number must be beyond its type.
typedef enum ck_Range {
    CK_RANGE_FINITE,
    CK_RANGE_POSITIVE,
    CK_RANGE_NOT_NEGATIVE,
    CK_RANGE_UNIT,    // 0 … 1
    CK_RANGE_SETTING, // 0 … 1000000
    CK_RANGE_UP_TO_64,
} ck_Range;

typedef struct ck_RangeRule {
    const char *path; // as in "network.nodes[].mass"; one that begins with a star stands for any path that ends like it
    ck_Range range;
} ck_RangeRule;

extern const ck_RangeRule ck_scene_ranges[]; // ends with a NULL path

// The schema of a whole scene file. Its settings part lists the engines of the engine table.
// Not thread-safe on the first call, which completes the table.
const cyaml_schema_value_t *ck_scene_schema(void);

#endif
