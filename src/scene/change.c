#include "change.h"

#include "files.h"
#include "names.h"
#include "text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define KEY_LETTERS "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.[]"

// The next "@KEY=" of a text; NULL: none. length  of the key
static const char *find_change(const char *text, int *length) {
    for (const char *at = strchr(text, '@'); at; at = strchr(at + 1, '@')) {
        *length = (int)strspn(at + 1, KEY_LETTERS);
        if (*length && at[1 + *length] == '=') return at;
    }
    return NULL;
}

int ck_change_file_length(const char *word) {
    int length;
    const char *at = find_change(word, &length);
    return at ? (int)(at - word) : (int)strlen(word);
}

bool ck_change_next(const char *word, int *place, ck_Change *change) {
    int next_length;
    const char *at = find_change(word + *place, &change->key_length);
    if (!at) return false;
    change->key = at + 1;
    change->value = change->key + change->key_length + 1;
    const char *next = find_change(change->value, &next_length);
    change->value_length = next ? (int)(next - change->value) : (int)strlen(change->value);
    *place = (int)(change->value - word) + change->value_length;
    return true;
}

static bool has_key(const char *words, const ck_Change *of) {
    ck_Change change;
    for (int place = 0; ck_change_next(words, &place, &change);)
        if (change.key_length == of->key_length && !strncmp(change.key, of->key, (size_t)of->key_length)) return true;
    return false;
}

bool ck_change_merge(char **words, const char *more) {
    ck_Text text;
    ck_Change change;
    if (!ck_text_begin(&text)) return false;
    for (int place = 0; ck_change_next(*words, &place, &change);)
        if (!has_key(more, &change))
            fprintf(text.file, "@%.*s=%.*s", change.key_length, change.key, change.value_length, change.value);
    for (int place = 0; ck_change_next(more, &place, &change);)
        fprintf(text.file, "@%.*s=%.*s", change.key_length, change.key, change.value_length, change.value);
    if (!ck_text_end(&text)) return false;
    free(*words);
    *words = text.bytes;
    return true;
}

// The byte of a text at a mark, which counts characters from after the mark of byte order.
static size_t byte_at(const ck_Document *document, yaml_mark_t mark) {
    const unsigned char *text = document->text;
    size_t at = ck_text_mark((const char *)text, document->length);
    for (size_t left = mark.index; left && at < document->length; left--) {
        at++;
        while (at < document->length && (text[at] & 0xc0) == 0x80) at++;
    }
    return at;
}

// Puts a text in place of some bytes. False when out of memory.
static bool splice(ck_Document *document, size_t from, size_t to, const char *text) {
    const size_t length = strlen(text), rest = document->length - to;
    unsigned char *grown = malloc(from + length + rest + 1);
    if (!grown) return false;
    memcpy(grown, document->text, from);
    memcpy(grown + from, text, length);
    memcpy(grown + from + length, document->text + to, rest);
    free(document->text);
    document->text = grown;
    document->length = from + length + rest;
    return true;
}

// A mapping's new key: before what it has, so that its own lines stay whole.
static bool add_key(ck_Document *document, const yaml_node_t *mapping, const char *key, const char *value) {
    const size_t start = byte_at(document, mapping->start_mark);
    const bool is_flow = mapping->data.mapping.style == YAML_FLOW_MAPPING_STYLE;
    char *text;
    int made = is_flow ? asprintf(&text, "%s: %s, ", key, value)
                       : asprintf(&text, "%s: %s\n%*s", key, value, (int)mapping->start_mark.column, "");
    if (made < 0) return false;
    const bool fits = splice(document, start + is_flow, start + is_flow, text);
    free(text);
    return fits;
}

// The rest of a key that has no place yet, as a value: "a.b" of v is {b: v} under a. NULL without memory.
static char *nest(const char *keys, const char *value) {
    const char *dot = strchr(keys, '.');
    char *inner = dot ? nest(dot + 1, value) : strdup(value), *text = NULL;
    if (dot && inner && asprintf(&text, "{%.*s: %s}", (int)strcspn(dot + 1, "."), dot + 1, inner) < 0) text = NULL;
    if (dot) free(inner);
    return dot ? text : inner;
}

// How much of a key there is: the deepest node and what is left of the key below it.
static const yaml_node_t *deepest(const ck_Document *document, const char *key, const char **rest) {
    char part[200];
    const yaml_node_t *node = yaml_document_get_root_node((yaml_document_t *)&document->yaml);
    *rest = key;
    for (size_t at = 0; key[at];) {
        at += strcspn(key + at + 1, ".[") + 1;
        snprintf(part, sizeof part, "%.*s", (int)at, key);
        const yaml_node_t *found = ck_document_at(document, part);
        if (!found) break;
        node = found;
        *rest = key + at + (key[at] == '.');
    }
    return node;
}

static yaml_node_t *node_at(const ck_Document *document, int node) {
    return yaml_document_get_node((yaml_document_t *)&document->yaml, node);
}

// The byte after a node: the mark of a block's end is that of what follows it, lines below.
static size_t end_of(const ck_Document *document, const yaml_node_t *node) {
    if (node->type == YAML_MAPPING_NODE && node->data.mapping.style != YAML_FLOW_MAPPING_STYLE &&
        node->data.mapping.pairs.top > node->data.mapping.pairs.start)
        return end_of(document, node_at(document, node->data.mapping.pairs.top[-1].value));
    if (node->type == YAML_SEQUENCE_NODE && node->data.sequence.style != YAML_FLOW_SEQUENCE_STYLE &&
        node->data.sequence.items.top > node->data.sequence.items.start)
        return end_of(document, node_at(document, node->data.sequence.items.top[-1]));
    return byte_at(document, node->end_mark);
}

// The key whose value a node is; NULL: it is an entry of a list.
static const yaml_node_t *key_of(const ck_Document *document, const yaml_node_t *node) {
    for (int i = 1; node_at(document, i); i++) {
        const yaml_node_t *mapping = node_at(document, i);
        if (mapping->type != YAML_MAPPING_NODE) continue;
        for (yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < mapping->data.mapping.pairs.top; pair++)
            if (node_at(document, pair->value) == node) return node_at(document, pair->key);
    }
    return NULL;
}

// Puts a value in place of a node's: of a key's, from its colon on. False when out of memory.
static bool replace(ck_Document *document, const yaml_node_t *node, const char *value) {
    const yaml_node_t *key = key_of(document, node);
    size_t from = byte_at(document, node->start_mark), to = end_of(document, node);
    if (key) {
        size_t colon = byte_at(document, key->end_mark);
        while (colon < from && document->text[colon] != ':') colon++;
        if (colon < document->length && document->text[colon] == ':') from = colon + 1;
    }
    char *text;
    if (asprintf(&text, "%s%s", key ? " " : "", value) < 0) return false;
    const bool fits = splice(document, from, to > from ? to : from, text);
    free(text);
    return fits;
}

// What the document has in the place of a key that it lacks; NULL: nothing.
static const yaml_node_t *instead_of(const ck_Document *document, const char *key) {
    for (const char *const(*row)[2] = document->kind->instead; row && **row; row++)
        for (int i = 0; i < 2; i++)
            if (!strcmp((*row)[i], key)) return ck_document_at(document, (*row)[1 - i]);
    return NULL;
}

// Puts a key and its value in place of another's. False when out of memory.
static bool replace_key(ck_Document *document, const yaml_node_t *node, const char *key, const char *value) {
    const char *dot = strrchr(key, '.');
    char *text;
    if (asprintf(&text, "%s: %s", dot ? dot + 1 : key, value) < 0) return false;
    const bool fits =
        splice(document, byte_at(document, key_of(document, node)->start_mark), end_of(document, node), text);
    free(text);
    return fits;
}

ck_Status ck_change_apply(ck_Document *document, const ck_Change *change, ck_Error *error) {
    char key[200], *value = strndup(change->value, (size_t)change->value_length), *nested = NULL;
    const char *rest;
    snprintf(key, sizeof key, "%.*s", change->key_length, change->key);
    bool fits = value != NULL;
    ck_Status status = CK_OK;
    const yaml_node_t *node = deepest(document, key, &rest), *instead = *rest ? instead_of(document, key) : NULL;
    if (document->length > 1 && (document->text[0] == 0xff || document->text[0] == 0xfe))
        status =
            ck_fail(error, CK_BAD_INPUT, "%s: is in UTF-16; a scene with changes must be in UTF-8", document->path);
    else if (!change->value_length)
        status = ck_fail(error, CK_BAD_INPUT, "%s: %s has no value; it must read @KEY=VALUE", document->path, key);
    else if (!*rest)
        fits = fits && replace(document, node, value);
    else if (instead)
        fits = fits && replace_key(document, instead, key, value);
    else if (node->type != YAML_MAPPING_NODE || strchr(rest, '['))
        status = ck_document_fail(document, node, error, "there is no place for %s here", key);
    else if (fits) {
        char first[200];
        snprintf(first, sizeof first, "%.*s", (int)strcspn(rest, "."), rest);
        nested = nest(rest, value);
        fits = nested && add_key(document, node, first, nested);
    }
    free(nested);
    free(value);
    return fits || status ? status : ck_fail(error, CK_NO_MEMORY, "%s: out of memory", document->path);
}

// A letter of a value as a name has it; 0: it is left out, and -1 parts what stands around it.
static int plain_letter(char letter) {
    if (letter == '>') return 'g';
    if (letter == '<') return 'l';
    if (strchr(CK_PLAIN_LETTERS, letter)) return letter;
    return strchr("=, :[{", letter) ? -1 : 0;
}

// A name that does not fit is told by its end, which is a number of all of the word.
static void shorten(char *name, size_t size, const char *word) {
    snprintf(name + size - 10, 10, "-%08x", (unsigned)ck_hash(CK_HASH_START, word, strlen(word)));
}

char *ck_change_name(char *name, size_t size, const char *word) {
    ck_Change change;
    size_t used = 0;
    *name = 0;
    for (int place = 0; ck_change_next(word, &place, &change);) {
        // the last part of a key says enough
        int from = change.key_length;
        while (from > 0 && change.key[from - 1] != '.') from--;
        const int length = change.key_length + 1 + change.value_length;
        bool is_parted = false;
        if (used + 1 < size) name[used++] = '-';
        for (int i = from; i < length && used + 1 < size; i++) {
            const int letter = plain_letter(change.key[i]);
            is_parted |= letter < 0;
            if (letter <= 0) continue;
            if (is_parted && name[used - 1] != '-' && used + 2 < size) name[used++] = '_';
            name[used++] = (char)letter;
            is_parted = false;
        }
        name[used] = 0;
    }
    if (used + 1 == size) shorten(name, size, word);
    return name;
}
