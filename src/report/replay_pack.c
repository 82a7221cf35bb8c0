#include "replay_pack.h"

#include <assert.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define CODE_BITS 24
#define CODE_MASK ((1u << CODE_BITS) - 1)
#define NO_POSITION (1u << 21)
#define BOX_BYTES (6 * sizeof(float))

// [paths][frames][3*n], at any alignment.
static float position_at(const ck_Replay *replay, size_t index) {
    float value;
    const char *positions = replay->bytes + replay->header_size + sizeof(float) * (size_t)replay->frame_count +
                            ck_replay_body_bytes(replay);
    memcpy(&value, positions + sizeof value * index, sizeof value);
    return value;
}

// The corners of what a path fills, of positions within a distance of the origin, and half as much again on either
// side.
static void find_box(const ck_Replay *replay, size_t path, float farthest, float box[2][3]) {
    size_t codes = ck_replay_path_numbers(replay);
    float least[3] = {INFINITY, INFINITY, INFINITY}, largest[3] = {-INFINITY, -INFINITY, -INFINITY}, width = 0;
    for (size_t i = 0; i < codes; i++) {
        float at = position_at(replay, path * codes + i);
        if (!(fabsf(at) < farthest)) continue;
        least[i % 3] = fminf(least[i % 3], at);
        largest[i % 3] = fmaxf(largest[i % 3], at);
    }
    for (int k = 0; k < 3; k++) width = fmaxf(width, largest[k] - least[k]);
    if (!(width > 0)) width = 1;
    for (int k = 0; k < 3; k++) {
        box[0][k] = isfinite(least[k]) ? least[k] - width / 2 : -width;
        box[1][k] = isfinite(largest[k]) ? largest[k] + width / 2 : width;
    }
}

// The first path that is there all the time; 0 where there is none.
static size_t find_whole(const ck_Replay *replay) {
    size_t codes = ck_replay_path_numbers(replay);
    for (size_t path = 0; path < (size_t)replay->path_count; path++) {
        bool is_whole = true;
        for (size_t i = 0; i < codes && is_whole; i++) is_whole = fabsf(position_at(replay, path * codes + i)) < 1e6f;
        if (is_whole) return path;
    }
    return 0;
}

// True where all of a path's positions are in the box, but for those that are none.
static bool fits(const ck_Replay *replay, size_t path, const float box[2][3]) {
    size_t codes = ck_replay_path_numbers(replay);
    for (size_t i = 0; i < codes; i++) {
        float at = position_at(replay, path * codes + i);
        if (at < box[0][i % 3] || at > box[1][i % 3]) return false;
    }
    return true;
}

static uint32_t code_of(float at, const float box[2][3], size_t axis) {
    float share = (at - box[0][axis]) / (box[1][axis] - box[0][axis]);
    // also false where it is no number
    return share >= 0 && share <= 1 ? (uint32_t)lrintf(share * (float)(NO_POSITION - 1)) : NO_POSITION;
}

static uint32_t zigzag(uint32_t difference) {
    bool is_negative = difference >> (CODE_BITS - 1) & 1;
    return (difference << 1 ^ (is_negative ? CODE_MASK : 0)) & CODE_MASK;
}

// The change of a path's code since the frame before, less the first path's where it is led by it.
static uint32_t change_at(const uint32_t *codes, const uint32_t *first, size_t index, size_t width) {
    uint32_t change = codes[index] - (index < width ? 0 : codes[index - width]);
    if (first) change -= first[index] - (index < width ? 0 : first[index - width]);
    return zigzag(change & CODE_MASK);
}

// Writes a path in whichever way has smaller numbers: beside the first one's changes, which may be NULL, or alone.
// Returns what follows.
static char *pack_path(char *out, const uint32_t *codes, const uint32_t *first, const float box[2][3], size_t count,
                       size_t width) {
    double alone = 0, led = 0;
    for (size_t i = 0; i < count && first; i++) {
        alone += change_at(codes, NULL, i, width);
        led += change_at(codes, first, i, width);
    }
    const uint32_t *leader = led < alone ? first : NULL;
    *out++ = leader != NULL;
    memcpy(out, box, BOX_BYTES);
    out += BOX_BYTES;
    for (size_t i = 0; i < count; i++) {
        uint32_t change = change_at(codes, leader, i, width);
        for (size_t byte = 0; byte < CODE_BITS / 8; byte++) out[byte * count + i] = (char)(change >> 8 * byte & 0xff);
    }
    return out + CODE_BITS / 8 * count;
}

ck_Status ck_replay_pack(char **packed, size_t *size, const ck_Replay *replay, ck_Error *error) {
    size_t before = replay->header_size + sizeof(float) * (size_t)replay->frame_count + ck_replay_body_bytes(replay);
    size_t count = ck_replay_path_numbers(replay), width = 3 * (size_t)replay->particle_count;
    size_t paths = (size_t)replay->path_count;
    *size = before + paths * (1 + BOX_BYTES + CODE_BITS / 8 * count);
    *packed = malloc(*size);
    uint32_t *first = malloc(2 * (count + 1) * sizeof *first), *codes = first + count;
    if (!*packed || !first) {
        free(first);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    memcpy(*packed, replay->bytes, before);
    char *out = *packed + before;
    float common[2][3], own[2][3];
    if (paths) find_box(replay, find_whole(replay), 1e6f, common);
    for (size_t path = 0; path < paths; path++) {
        bool is_near = fits(replay, path, common);
        // what blows up is followed for a hundred times the size of what does not
        if (!is_near) find_box(replay, path, 100 * (common[1][0] - common[0][0]), own);
        const float(*box)[3] = is_near ? common : own;
        uint32_t *now = path ? codes : first;
        for (size_t i = 0; i < count; i++) now[i] = code_of(position_at(replay, path * count + i), box, i % 3);
        out = pack_path(out, now, path && is_near ? first : NULL, box, count, width);
    }
    assert(out == *packed + *size);
    free(first);
    return CK_OK;
}
