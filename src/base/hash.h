// What tells two inputs apart.
#ifndef CK_HASH_H
#define CK_HASH_H

#include <stddef.h>
#include <stdint.h>

#define CK_HASH_START 0xcbf29ce484222325u

// Source: Fowler, Noll, Vo, FNV-1a 64 bit.
static inline uint64_t ck_hash(uint64_t start, const void *data, size_t bytes) {
    const unsigned char *byte = data;
    for (size_t i = 0; i < bytes; i++) start = (start ^ byte[i]) * 0x100000001b3u;
    return start;
}

#endif
