#include "values.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static yaml_node_t *node_at(const ck_Document *document, int node) {
    return yaml_document_get_node((yaml_document_t *)&document->yaml, node);
}

char *ck_value_text(const ck_Document *document, yaml_node_t *node) {
    if (node->type == YAML_SCALAR_NODE) return strdup((char *)node->data.scalar.value);
    char *text = strdup(node->type == YAML_SEQUENCE_NODE ? "[" : "{");
    for (int i = 0; text && node->type == YAML_SEQUENCE_NODE &&
                    node->data.sequence.items.start + i < node->data.sequence.items.top;
         i++) {
        char *entry = ck_value_text(document, node_at(document, node->data.sequence.items.start[i])), *more = NULL;
        if (!entry || asprintf(&more, "%s%s%s", text, i ? ", " : "", entry) < 0) more = NULL;
        free(entry);
        free(text);
        text = more;
    }
    for (int i = 0;
         text && node->type == YAML_MAPPING_NODE && node->data.mapping.pairs.start + i < node->data.mapping.pairs.top;
         i++) {
        const yaml_node_pair_t *pair = &node->data.mapping.pairs.start[i];
        char *key = ck_value_text(document, node_at(document, pair->key)),
             *value = ck_value_text(document, node_at(document, pair->value)), *more = NULL;
        if (!key || !value || asprintf(&more, "%s%s%s: %s", text, i ? ", " : "", key, value) < 0) more = NULL;
        free(key);
        free(value);
        free(text);
        text = more;
    }
    char *closed = NULL;
    if (text && asprintf(&closed, "%s%s", text, node->type == YAML_SEQUENCE_NODE ? "]" : "}") < 0) closed = NULL;
    free(text);
    return closed;
}

void ck_values_free(char **texts, int count) {
    for (int i = 0; texts && i < count; i++) free(texts[i]);
    free(texts);
}

// A rule: numbers from low to high.
typedef struct Rule {
    bool is_log;
    double low, high;
    int count;
} Rule;

static bool read_number(const yaml_node_t *node, double *number) {
    char *end;
    if (node->type != YAML_SCALAR_NODE || !node->data.scalar.length) return false;
    *number = strtod((char *)node->data.scalar.value, &end);
    return !*end && isfinite(*number);
}

// {log: [low, high], count: n}, {linear: …} or {seeds: n}. False where it is none of them.
static bool read_rule(const ck_Document *document, const yaml_node_t *node, Rule *rule) {
    double count = 0;
    bool has_range = false, has_count = false;
    *rule = (Rule){0};
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
        const yaml_node_t *key = node_at(document, pair->key), *value = node_at(document, pair->value);
        const char *name = key->type == YAML_SCALAR_NODE ? (const char *)key->data.scalar.value : "";
        if (!strcmp(name, "log") || !strcmp(name, "linear")) {
            if (has_range || value->type != YAML_SEQUENCE_NODE ||
                value->data.sequence.items.top - value->data.sequence.items.start != 2 ||
                !read_number(node_at(document, value->data.sequence.items.start[0]), &rule->low) ||
                !read_number(node_at(document, value->data.sequence.items.start[1]), &rule->high))
                return false;
            rule->is_log = name[1] == 'o';
            has_range = true;
        } else if (!strcmp(name, "count") || !strcmp(name, "seeds")) {
            if (has_count || !read_number(value, &count)) return false;
            has_count = true;
            if (*name != 's') continue;
            if (has_range) return false;
            has_range = true;
            rule->low = 1;
            rule->high = count;
        } else
            return false;
    }
    const bool is_count = count >= 1 && count <= CK_VALUES_MOST && floor(count) == count;
    if (is_count) rule->count = (int)count;
    return has_range && has_count && is_count && (!rule->is_log || (rule->low > 0 && rule->high > 0));
}

static double rule_value(const Rule *rule, int index) {
    const double share = rule->count > 1 ? index / (rule->count - 1.0) : 0;
    return rule->is_log ? rule->low * pow(rule->high / rule->low, share) : rule->low + share * (rule->high - rule->low);
}

// Of six digits, where they tell a value from the next: they are names, too.
static char *rule_text(const Rule *rule, int index) {
    const double value = rule_value(rule, index), next = rule_value(rule, index + 1);
    const bool is_near = fabs(next - value) < 1e-4 * fmax(fabs(rule->low), fabs(rule->high));
    char *text;
    return asprintf(&text, is_near ? "%.12g" : "%.6g", value) < 0 ? NULL : text;
}

ck_Status ck_values_read(const ck_Document *document, yaml_node_t *node, const char *key, char ***texts, int *count,
                         ck_Error *error) {
    Rule rule = {0};
    const bool is_list =
        node->type == YAML_SEQUENCE_NODE && node->data.sequence.items.top > node->data.sequence.items.start;
    *count = 0;
    *texts = NULL;
    if (!is_list && (node->type != YAML_MAPPING_NODE || !read_rule(document, node, &rule)))
        return ck_document_fail(document, node, error,
                                "%s must have a list of values, as [1, 2], or {log: [1e2, 1e6], count: 9}, {linear: "
                                "[0, 1], count: 5} or {seeds: 10}",
                                key);
    const int wanted = is_list ? (int)(node->data.sequence.items.top - node->data.sequence.items.start) : rule.count;
    *texts = calloc((size_t)wanted + 1, sizeof **texts);
    ck_Status status = *texts ? CK_OK : CK_NO_MEMORY;
    for (int i = 0; i < wanted && !status; i++) {
        (*texts)[i] = is_list ? ck_value_text(document, node_at(document, node->data.sequence.items.start[i]))
                              : rule_text(&rule, i);
        *count = i + 1;
        if (!(*texts)[i]) status = CK_NO_MEMORY;
    }
    return status ? ck_fail(error, status, "%s: out of memory", document->path) : CK_OK;
}
