#include "scene_check.h"

#include "names.h"
#include "scene_schema.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Check {
    const ck_Document *document;
    yaml_document_t *yaml;
    ck_Error *error;
} Check;

static ck_Status check_value(const Check *check, yaml_node_t *node, const cyaml_schema_value_t *schema,
                             const char *path);

static const char *scalar_text(const yaml_node_t *node) {
    return node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;
}

static const char *kind_of(const yaml_node_t *node) {
    switch (node->type) {
    case YAML_MAPPING_NODE: return "a mapping";
    case YAML_SEQUENCE_NODE: return "a list";
    default: return *scalar_text(node) ? scalar_text(node) : "empty";
    }
}

static const char *key_at(const void *fields, int index) {
    return ((const cyaml_schema_field_t *)fields)[index].key;
}

static const char *list_keys(char *out, size_t size, const cyaml_schema_field_t *fields) {
    ck_name_list(out, size, key_at, fields);
    return *out ? out : "none";
}

static const cyaml_schema_field_t *find_field(const cyaml_schema_field_t *fields, const char *key) {
    for (; fields->key; fields++)
        if (!strcmp(fields->key, key)) return fields;
    return NULL;
}

static ck_Status check_range(const Check *check, yaml_node_t *node, double value, const char *path) {
    ck_Range range = CK_RANGE_FINITE;
    for (const ck_RangeRule *rule = ck_scene_ranges; rule->path; rule++)
        if (!strcmp(rule->path, path)) range = rule->range;
    const char *wanted = NULL;
    if (!isfinite(value)) wanted = "a finite number";
    if (range == CK_RANGE_POSITIVE && !(value > 0)) wanted = "a number above 0";
    if (range == CK_RANGE_NOT_NEGATIVE && !(value >= 0)) wanted = "0 or a number above it";
    if (range == CK_RANGE_UNIT && !(value >= 0 && value <= 1)) wanted = "a number from 0 to 1";
    if (!wanted) return CK_OK;
    return ck_document_fail(check->document, node, check->error, "%s is %s; it must be %s", path, scalar_text(node),
                            wanted);
}

static ck_Status check_number(const Check *check, yaml_node_t *node, bool whole, const char *path) {
    const char *text = scalar_text(node), *wanted = whole ? "a whole number, 0 or above" : "a number";
    char *end = NULL;
    double value = 0;
    errno = 0;
    if (text && *text && whole) {
        // strtoul would take "-1" for a very large number
        unsigned long count = strtoul(text, &end, 0);
        if (count > UINT32_MAX || strchr(text, '-')) end = NULL;
        value = (double)count;
    } else if (text && *text) {
        value = strtod(text, &end);
        errno = 0; // an overflow is inf, which the range refuses; an underflow is as good as 0
    }
    if (!end || *end || errno)
        return ck_document_fail(check->document, node, check->error, "%s is %s; it must be %s", path, kind_of(node),
                                wanted);
    return check_range(check, node, value, path);
}

static ck_Status check_boolean(const Check *check, yaml_node_t *node, const char *path) {
    const char *text = scalar_text(node);
    if (text && (!strcmp(text, "true") || !strcmp(text, "false"))) return CK_OK;
    return ck_document_fail(check->document, node, check->error, "%s is %s; it must be true or false", path,
                            kind_of(node));
}

static ck_Status check_text(const Check *check, yaml_node_t *node, const cyaml_schema_value_t *schema,
                            const char *path) {
    const char *text = scalar_text(node);
    if (!text)
        return ck_document_fail(check->document, node, check->error, "%s is %s; it must be text", path, kind_of(node));
    if (strlen(text) != node->data.scalar.length)
        return ck_document_fail(check->document, node, check->error, "%s has a zero byte; it must be text", path);
    for (const char *letter = text; *letter && !strcmp(path, "name"); letter++)
        if (!strchr(CK_PLAIN_LETTERS, *letter))
            return ck_document_fail(
                check->document, node, check->error,
                "name has a letter that is not plain; it must be made of letters, digits, _, - and .");
    // files that begin so are hidden
    if (!strcmp(path, "name") && *text == '.')
        return ck_document_fail(check->document, node, check->error, "name begins with a dot; begin it with a letter");
    if (strlen(text) < schema->string.min || strlen(text) > schema->string.max)
        return ck_document_fail(check->document, node, check->error, "%s has %zu characters; it must have %u to %u",
                                path, strlen(text), schema->string.min, schema->string.max);
    return CK_OK;
}

static ck_Status check_once(const Check *check, yaml_node_t *mapping, yaml_node_pair_t *pair) {
    yaml_node_t *key = yaml_document_get_node(check->yaml, pair->key);
    const char *name = scalar_text(key);
    if (!name)
        return ck_document_fail(check->document, key, check->error, "%s is no key; it must be a name", kind_of(key));
    for (yaml_node_pair_t *earlier = mapping->data.mapping.pairs.start; earlier < pair; earlier++)
        if (!strcmp(scalar_text(yaml_document_get_node(check->yaml, earlier->key)), name))
            return ck_document_fail(check->document, key, check->error, "%s is given twice; keep one", name);
    return CK_OK;
}

static ck_Status check_key(const Check *check, yaml_node_t *mapping, yaml_node_pair_t *pair,
                           const cyaml_schema_field_t *fields, const char *path) {
    yaml_node_t *key = yaml_document_get_node(check->yaml, pair->key);
    const char *name = scalar_text(key);
    const cyaml_schema_field_t *field = name ? find_field(fields, name) : NULL;
    if (!field) {
        char known[400], hint[80];
        return ck_document_fail(check->document, key, check->error, "unknown key %s%s%s%s; known here: %s",
                                kind_of(key), *path ? " in " : "", path,
                                ck_name_hint(hint, sizeof hint, name ? name : "", key_at, fields),
                                list_keys(known, sizeof known, fields));
    }
    ck_Status status = check_once(check, mapping, pair);
    if (status) return status;
    char inner[200];
    snprintf(inner, sizeof inner, "%s%s%s", path, *path ? "." : "", name);
    return check_value(check, yaml_document_get_node(check->yaml, pair->value), &field->value, inner);
}

static ck_Status check_mapping(const Check *check, yaml_node_t *node, const cyaml_schema_field_t *fields,
                               const char *path) {
    char known[400];
    const char *what = *path ? path : "the scene";
    if (node->type != YAML_MAPPING_NODE)
        return ck_document_fail(check->document, node, check->error,
                                "%s is %s; it must be a mapping with keys among %s", what, kind_of(node),
                                list_keys(known, sizeof known, fields));
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
        ck_Status status = check_key(check, node, pair, fields, path);
        if (status) return status;
    }
    for (; fields->key; fields++) {
        if (fields->value.flags & CYAML_FLAG_OPTIONAL) continue;
        bool found = false;
        for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++)
            found |= !strcmp(scalar_text(yaml_document_get_node(check->yaml, pair->key)), fields->key);
        if (!found)
            return ck_document_fail(check->document, node, check->error, "%s lacks the key %s", what, fields->key);
    }
    return CK_OK;
}

static ck_Status check_sequence(const Check *check, yaml_node_t *node, const cyaml_schema_value_t *schema,
                                const char *path) {
    if (node->type != YAML_SEQUENCE_NODE)
        return ck_document_fail(check->document, node, check->error, "%s is %s; it must be a list", path,
                                kind_of(node));
    size_t count = (size_t)(node->data.sequence.items.top - node->data.sequence.items.start);
    if (count < schema->sequence.min || count > schema->sequence.max) {
        char wanted[60];
        if (schema->sequence.min == schema->sequence.max)
            snprintf(wanted, sizeof wanted, "%u", schema->sequence.min);
        else
            snprintf(wanted, sizeof wanted, "%u to %u", schema->sequence.min, schema->sequence.max);
        return ck_document_fail(check->document, node, check->error, "%s has %zu entries; it must have %s", path, count,
                                wanted);
    }
    char inner[200];
    bool vector = schema->type == CYAML_SEQUENCE_FIXED;
    snprintf(inner, sizeof inner, "%s%s", path, vector ? "" : "[]");
    for (size_t i = 0; i < count; i++) {
        yaml_node_t *entry = yaml_document_get_node(check->yaml, node->data.sequence.items.start[i]);
        ck_Status status = check_value(check, entry, schema->sequence.entry, inner);
        if (status) return status;
    }
    return CK_OK;
}

// Engines, each with keys that are numbers.
// depth  0: engines, 1: their keys, 2: a number
static ck_Status check_settings(const Check *check, yaml_node_t *node, int depth, const char *path) {
    if (depth == 2) return check_number(check, node, false, path);
    if (node->type != YAML_MAPPING_NODE)
        return ck_document_fail(check->document, node, check->error, "%s is %s; it must be a mapping of %s", path,
                                kind_of(node), depth ? "settings" : "engines");
    ck_Status status = CK_OK;
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top && !status;
         pair++) {
        yaml_node_t *key = yaml_document_get_node(check->yaml, pair->key);
        char inner[200];
        status = check_once(check, node, pair);
        snprintf(inner, sizeof inner, "%.90s.%.90s", path, scalar_text(key) ? scalar_text(key) : "");
        if (!status) status = check_settings(check, yaml_document_get_node(check->yaml, pair->value), depth + 1, inner);
    }
    return status;
}

static ck_Status check_value(const Check *check, yaml_node_t *node, const cyaml_schema_value_t *schema,
                             const char *path) {
    switch (schema->type) {
    case CYAML_UINT: return check_number(check, node, true, path);
    case CYAML_FLOAT: return check_number(check, node, false, path);
    case CYAML_BOOL: return check_boolean(check, node, path);
    case CYAML_STRING: return check_text(check, node, schema, path);
    case CYAML_MAPPING: return check_mapping(check, node, schema->mapping.fields, path);
    case CYAML_IGNORE: return check_settings(check, node, 0, path);
    default: return check_sequence(check, node, schema, path);
    }
}

static ck_Status check_one_of(const Check *check, yaml_node_t *mapping, const char *const *keys, const char *where,
                              const char *wanted) {
    const char *first = NULL;
    for (yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top; pair++) {
        yaml_node_t *key = yaml_document_get_node(check->yaml, pair->key);
        for (const char *const *known = keys; *known; known++) {
            if (strcmp(scalar_text(key), *known)) continue;
            if (first)
                return ck_document_fail(check->document, key, check->error, "%s has both %s and %s; keep one", where,
                                        first, *known);
            first = *known;
        }
    }
    if (first) return CK_OK;
    return ck_document_fail(check->document, mapping, check->error, "%s has none of %s", where, wanted);
}

// The same of each entry of a list, where the scene has it.
static ck_Status check_each(const Check *check, const char *list, const char *const *keys, const char *where,
                            const char *wanted) {
    yaml_node_t *entries = ck_document_find(check->document, list);
    ck_Status status = CK_OK;
    if (entries->type != YAML_SEQUENCE_NODE) return CK_OK;
    for (yaml_node_item_t *item = entries->data.sequence.items.start;
         item < entries->data.sequence.items.top && !status; item++)
        status = check_one_of(check, yaml_document_get_node(check->yaml, *item), keys, where, wanted);
    return status;
}

ck_Status ck_scene_check(const ck_Document *document, const cyaml_schema_value_t *schema, ck_Error *error) {
    Check check = {.document = document, .yaml = (yaml_document_t *)&document->yaml, .error = error};
    yaml_node_t *root = yaml_document_get_root_node(check.yaml);
    ck_Status status = check_value(&check, root, schema, "");
    static const char *const bodies[] = {"cloth", "rope", "network", "mesh", NULL};
    if (!status)
        status = check_one_of(&check, root, bodies, "the scene", "cloth, rope, network and mesh; it needs one body");

    static const char *const clocks[] = {"step", "fps", NULL};
    if (!status)
        status = check_one_of(&check, ck_document_find(document, "time"), clocks, "time",
                              "step and fps; it needs one of the two");
    static const char *const shapes[] = {"plane", "sphere", "capsule", "cylinder", "box", NULL};
    static const char *const solids[] = {"sphere", "box", NULL};
    if (!status)
        status = check_each(&check, "colliders", shapes, "a collider", "plane, sphere, capsule, cylinder and box");
    if (!status) status = check_each(&check, "bodies", solids, "a rigid body", "sphere and box");
    return status;
}
