#include "document.h"

#include "change.h"
#include "files.h"

#include <ctype.h>
#include <errno.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static ck_Status read_text(ck_Document *document, ck_Error *error) {
    const char *path = document->file, *kind = document->kind->name;
    struct stat info;
    if (stat(path, &info))
        return ck_fail(error, ck_file_status(errno), "%s: %s; give the path of a %s file", path, strerror(errno), kind);
    if (!S_ISREG(info.st_mode))
        return ck_fail(error, CK_BAD_INPUT, "%s: is not a file; give the path of a %s file", path, kind);
    if (info.st_size > CK_DOCUMENT_MAX_BYTES)
        return ck_fail(error, CK_BAD_INPUT, "%s: is %lld bytes long; a %s file has at most %u", path,
                       (long long)info.st_size, kind, CK_DOCUMENT_MAX_BYTES);
    FILE *file = fopen(path, "rb");
    if (!file) return ck_fail(error, ck_file_status(errno), "%s: %s", path, strerror(errno));
    document->text = malloc((size_t)info.st_size + 1);
    if (document->text) document->length = fread(document->text, 1, (size_t)info.st_size, file);
    ck_Status status = CK_OK;
    if (!document->text)
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    else if (ferror(file))
        status = ck_fail(error, CK_IO, "%s: cannot be read", path);
    fclose(file);
    return status;
}

// The deepest nesting that a scene has use for is 5.
#define MAX_DEPTH 16

typedef struct Seen {
    int depth, documents, values;
} Seen;

// What would make a file slow, large in memory or ambiguous: deep nesting, aliases, more than one document, more values
// than a scene has use for.
static const char *object(Seen *seen, yaml_event_type_t type) {
    const bool begins = type == YAML_MAPPING_START_EVENT || type == YAML_SEQUENCE_START_EVENT;
    seen->depth += begins;
    seen->depth -= type == YAML_MAPPING_END_EVENT || type == YAML_SEQUENCE_END_EVENT;
    seen->documents += type == YAML_DOCUMENT_START_EVENT;
    seen->values += begins || type == YAML_SCALAR_EVENT;
    if (seen->depth > MAX_DEPTH) return "is nested too deep; a few levels are all it needs";
    if (type == YAML_ALIAS_EVENT) return "an alias is not supported; write the value out";
    if (seen->documents > 1) return "begins a second document; a file has one";
    if (seen->values > CK_DOCUMENT_MAX_VALUES)
        return "has more values than the 500000 that are read; a large body comes from a mesh file, a long path from a "
               "CSV";
    return NULL;
}

// Reads the events once before a tree is built of them.
static ck_Status scan(const ck_Document *document, ck_Error *error) {
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", document->path);
    yaml_parser_set_input_string(&parser, document->text, document->length);
    ck_Status status = CK_OK;
    Seen seen = {0};
    for (bool done = false; !done && !status;) {
        yaml_event_t event;
        if (!yaml_parser_parse(&parser, &event)) break; // the tree's parser will say why
        const char *wrong = object(&seen, event.type);
        if (wrong)
            status = ck_fail(error, CK_BAD_INPUT, "%s:%zu:%zu: %s", document->path, event.start_mark.line + 1,
                             event.start_mark.column + 1, wrong);
        done = event.type == YAML_STREAM_END_EVENT;
        yaml_event_delete(&event);
    }
    yaml_parser_delete(&parser);
    return status;
}

static ck_Status parse(ck_Document *document, ck_Error *error) {
    ck_Status status = scan(document, error);
    if (status) return status;
    yaml_parser_t parser;
    if (!yaml_parser_initialize(&parser)) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", document->path);
    yaml_parser_set_input_string(&parser, document->text, document->length);
    document->has_yaml = yaml_parser_load(&parser, &document->yaml);
    // without memory it says so, or nothing
    if (!document->has_yaml && (parser.error == YAML_MEMORY_ERROR || !parser.problem))
        status = ck_fail(error, CK_NO_MEMORY, "%s: out of memory", document->path);
    else if (!document->has_yaml)
        status = ck_fail(error, CK_BAD_INPUT, "%s:%zu:%zu: is not YAML: %s", document->path,
                         parser.problem_mark.line + 1, parser.problem_mark.column + 1, parser.problem);
    else if (!yaml_document_get_root_node(&document->yaml))
        status = ck_fail(error, CK_BAD_INPUT, "%s:1:1: is empty; a %s needs %s", document->path, document->kind->name,
                         document->kind->needs);
    yaml_parser_delete(&parser);
    return status;
}

ck_Status ck_document_parse(ck_Document *document, ck_Error *error) {
    if (document->has_yaml) yaml_document_delete(&document->yaml);
    document->has_yaml = false;
    return parse(document, error);
}

ck_Status ck_document_load(ck_Document *document, const char *path, const ck_DocumentKind *kind, ck_Error *error) {
    ck_Change change;
    *document =
        (ck_Document){.kind = kind, .path = strdup(path), .file = strndup(path, (size_t)ck_change_file_length(path))};
    if (!document->path || !document->file) return ck_fail(error, CK_NO_MEMORY, "%s: out of memory", path);
    ck_Status status = read_text(document, error);
    if (!status) status = parse(document, error);
    for (int place = 0; !status && ck_change_next(path, &place, &change);) {
        status = ck_change_apply(document, &change, error);
        if (!status) status = ck_document_parse(document, error);
    }
    return status;
}

void ck_document_free(ck_Document *document) {
    if (document->has_yaml) yaml_document_delete(&document->yaml);
    free(document->text);
    free(document->path);
    free(document->file);
    *document = (ck_Document){0};
}

static yaml_node_t *child_by_key(yaml_document_t *yaml, yaml_node_t *node, const char *key, size_t length) {
    if (node->type != YAML_MAPPING_NODE) return NULL;
    for (yaml_node_pair_t *pair = node->data.mapping.pairs.start; pair < node->data.mapping.pairs.top; pair++) {
        yaml_node_t *name = yaml_document_get_node(yaml, pair->key);
        if (name->type == YAML_SCALAR_NODE && name->data.scalar.length == length &&
            !memcmp(name->data.scalar.value, key, length))
            return yaml_document_get_node(yaml, pair->value);
    }
    return NULL;
}

static yaml_node_t *child_by_index(yaml_document_t *yaml, yaml_node_t *node, long index) {
    if (node->type != YAML_SEQUENCE_NODE) return NULL;
    long count = node->data.sequence.items.top - node->data.sequence.items.start;
    if (index < 0 || index >= count) return NULL;
    return yaml_document_get_node(yaml, node->data.sequence.items.start[index]);
}

// The node at a path, or where that ends early its deepest part; is_whole: out, whether it does not.
static yaml_node_t *walk(const ck_Document *document, const char *path, bool *is_whole) {
    // libyaml's readers take a non-const document but do not write to it
    yaml_document_t *yaml = (yaml_document_t *)&document->yaml;
    yaml_node_t *node = yaml_document_get_root_node(yaml);
    *is_whole = true;
    while (node && *path) {
        yaml_node_t *child;
        if (*path == '[') {
            char *end;
            child = child_by_index(yaml, node, strtol(path + 1, &end, 10));
            path = *end ? end + 1 : end;
        } else {
            path += *path == '.';
            size_t length = strcspn(path, ".[");
            child = child_by_key(yaml, node, path, length);
            path += length;
        }
        *is_whole = child != NULL;
        if (!child) break;
        node = child;
    }
    return node;
}

yaml_node_t *ck_document_find(const ck_Document *document, const char *path) {
    bool is_whole;
    return walk(document, path, &is_whole);
}

yaml_node_t *ck_document_at(const ck_Document *document, const char *path) {
    bool is_whole;
    yaml_node_t *node = walk(document, path, &is_whole);
    return is_whole ? node : NULL;
}

ck_Status ck_document_fail(const ck_Document *document, const yaml_node_t *node, ck_Error *error, const char *format,
                           ...) {
    char message[sizeof error->message];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    if (!node) return ck_fail(error, CK_BAD_INPUT, "%s: %s", document->path, message);
    return ck_fail(error, CK_BAD_INPUT, "%s:%zu:%zu: %s", document->path, node->start_mark.line + 1,
                   node->start_mark.column + 1, message);
}
