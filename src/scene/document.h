// A YAML file with the place of every value, so that an error can say line and column.
#ifndef CK_DOCUMENT_H
#define CK_DOCUMENT_H

#include "status.h"

#include <stddef.h>
#include <yaml.h>

// The largest scene file that is read, and the most values in it, each of which takes up to 350 bytes as a tree:
// together 200 MB. A 100×100 network with every bar listed is below 1 MB and has 150,000 values.
#define CK_DOCUMENT_MAX_BYTES (16u << 20)
#define CK_DOCUMENT_MAX_VALUES 500000

// What a file is of, in the words of an error.
typedef struct ck_DocumentKind {
    const char *name;                // "scene"
    const char *needs;               // "name, a body and time"
    const char *const (*instead)[2]; // keys that stand for one another, to a row of NULL; NULL: there are none
} ck_DocumentKind;

typedef struct ck_Document {
    char *path; // as it was given, with its changes
    char *file; // without them
    const ck_DocumentKind *kind;
    unsigned char *text;
    size_t length;
    yaml_document_t yaml;
    int has_yaml;
} ck_Document;

// Reads and parses a file, with the changes that its path has: see change.h. Refuses what is not a regular file, is
// empty, or is larger than CK_DOCUMENT_MAX_BYTES or CK_DOCUMENT_MAX_VALUES. Errors: CK_BAD_INPUT with file:line:column,
// CK_NO_MEMORY, CK_IO. Free with ck_document_free in any case.
ck_Status ck_document_load(ck_Document *document, const char *path, const ck_DocumentKind *kind, ck_Error *error);
// Parses the text again, once it has been changed. Errors: as those of ck_document_load.
ck_Status ck_document_parse(ck_Document *document, ck_Error *error);
void ck_document_free(ck_Document *document);

// The node at a dotted path, or NULL.
yaml_node_t *ck_document_at(const ck_Document *document, const char *path);

// The node at a dotted path such as "network.bars[3]". Where the path ends early, its deepest existing part.
yaml_node_t *ck_document_find(const ck_Document *document, const char *path);

// Fails with "file:line:column: message", the place being that of node (NULL: the file alone).
ck_Status ck_document_fail(const ck_Document *document, const yaml_node_t *node, ck_Error *error, const char *format,
                           ...) __attribute__((format(printf, 4, 5)));

#endif
