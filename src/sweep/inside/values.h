// The values that a swept key takes: a list, or a rule.
#ifndef CK_VALUES_H
#define CK_VALUES_H

#include "document.h"

// The most values of a key.
#define CK_VALUES_MOST 1000000

// [1, 2, 4] or [[0, -9.81, 0], [0, -1.6, 0]]; {log: [1e2, 1e6], count: 9}; {linear: [0, 1], count: 5}; {seeds: 10}.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. Free texts with ck_values_free in any case.
ck_Status ck_values_read(const ck_Document *document, yaml_node_t *node, const char *key, char ***texts, int *count,
                         ck_Error *error);

void ck_values_free(char **texts, int count);

// A node's value on one line, as YAML; NULL without memory.
char *ck_value_text(const ck_Document *document, yaml_node_t *node);

#endif
