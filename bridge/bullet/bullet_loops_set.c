#include "bullet_loops.h"

#include "lanes.h"

#include <math.h>
#include <stdbool.h>
#include <stddef.h>

// Three coordinates and one that is 0.
typedef ck_BulletScalar Scalar;
typedef Scalar Vector __attribute__((vector_size(4 * sizeof(Scalar)), aligned(sizeof(Scalar)), may_alias));

CK_INLINE Vector load(const Scalar *from) {
    return *(const Vector *)from;
}

CK_INLINE void store(Scalar *to, Vector value) {
    *(Vector *)to = value;
}

CK_INLINE Scalar square_root(Scalar value) {
#ifdef CK_BULLET_FLOAT
    return sqrtf(value);
#else
    return sqrt(value);
#endif
}

CK_INLINE Scalar sum(Vector v) {
    return v[0] + v[1] + v[2];
}

// Each pass is made for every combination of what it may leave out, which then costs nothing.
CK_INLINE void pull_links(const ck_BulletLinks *links, const ck_BulletNodes *nodes, Scalar *restrict force,
                          Scalar scale, Scalar damping_scale, bool is_damped) {
    const int *restrict start = links->start, *restrict other = links->other;
    const Scalar *restrict rest = links->rest, *restrict stiffness = links->stiffness,
                           *restrict damping = links->damping;
    Scalar *restrict normal = links->normal, *restrict lengths = links->length;
    for (int i = 0, link = 0; i < links->nodes; i++) {
        const Vector x = load(nodes->position + i * nodes->stride), v = load(nodes->velocity + i * nodes->stride);
        Vector total = load(force + 4 * i);
        for (const int end = start[i + 1]; link < end; link++) {
            const ptrdiff_t there = other[link] * nodes->stride;
            const Vector d = load(nodes->position + there) - x;
            const Scalar length = square_root(sum(d * d));
            // ends that coincide have no direction
            const Vector n = d / (length > 0 ? length : 1);
            Scalar tension = scale * stiffness[link] * (length - rest[link]);
            if (is_damped) tension += damping_scale * damping[link] * sum(n * (load(nodes->velocity + there) - v));
            store(normal + 4 * link, n);
            lengths[link] = length;
            total += n * tension;
            Scalar *answer = force + 4 * other[link];
            store(answer, load(answer) - n * tension);
        }
        store(force + 4 * i, total);
    }
}

static void pull(const ck_BulletLinks *links, const ck_BulletNodes *nodes, Scalar *force, Scalar scale,
                 Scalar damping_scale) {
    if (damping_scale != 0)
        pull_links(links, nodes, force, scale, damping_scale, true);
    else
        pull_links(links, nodes, force, scale, 0, false);
}

CK_INLINE void multiply_links(const ck_BulletLinks *links, const Scalar *restrict along, const Scalar *restrict across,
                              const Scalar *restrict own, const Scalar *restrict d, Scalar *restrict result,
                              bool has_across) {
    const int *restrict start = links->start, *restrict other = links->other;
    const Scalar *restrict normal = links->normal;
    const int nodes = links->nodes;
    for (int i = 0, link = 0; i < nodes; i++) {
        const Vector here = load(d + 4 * i);
        Vector total = load(result + 4 * i) - here * own[i];
        for (const int end = start[i + 1]; link < end; link++) {
            const ptrdiff_t there = 4 * (ptrdiff_t)other[link];
            const Vector n = load(normal + 4 * link), away = load(d + there) - here;
            Vector answer = n * (along[link] * sum(n * away));
            if (has_across) answer += away * across[link];
            total += answer;
            store(result + there, load(result + there) - answer);
        }
        store(result + 4 * i, total);
    }
}

static void multiply(const ck_BulletLinks *links, const Scalar *along, const Scalar *across, const Scalar *own,
                     const Scalar *d, Scalar *result) {
    if (across)
        multiply_links(links, along, across, own, d, result, true);
    else
        multiply_links(links, along, NULL, own, d, result, false);
}

CK_INLINE void prepare_links(const ck_BulletLinks *links, const ck_BulletNodes *nodes, Scalar *force,
                             Scalar damping_scale, const ck_BulletHooke *hooke, bool is_damped, bool corrects) {
    const int *restrict start = links->start, *restrict other = links->other;
    const Scalar *restrict rest = links->rest, *restrict damping = links->damping;
    const Scalar *restrict of_one = corrects ? hooke->of_one : NULL, *restrict least = corrects ? hooke->least : NULL;
    const int *restrict slot = corrects ? hooke->slot : NULL;
    Scalar *restrict factor = corrects ? hooke->factor : NULL;
    const Scalar *position = nodes->position, *velocity = nodes->velocity;
    const ptrdiff_t stride = nodes->stride;
    const int count = links->nodes;
    for (int i = 0, link = 0; i < count; i++) {
        const ptrdiff_t here = i * stride;
        const Vector x = load(position + here), v = load(velocity + here);
        Vector total = {0};
        for (const int end = start[i + 1]; link < end; link++) {
            const ptrdiff_t there = other[link] * stride;
            const Vector d = load(position + there) - x;
            const Scalar squared = sum(d * d);
            if (corrects) {
                const Scalar length = square_root(squared),
                             h = length * (length + rest[link]) / (squared + rest[link] * rest[link]);
                factor[slot[link]] = of_one[link] * (h > least[link] ? h : least[link]);
            }
            if (!is_damped) continue;
            const Scalar speed = sum(d * (load(velocity + there) - v));
            // ends that coincide have no direction
            const Vector f = d * (damping_scale * damping[link] * speed / (squared > 0 ? squared : 1));
            total += f;
            store(force + there, load(force + there) - f);
        }
        if (is_damped) store(force + here, load(force + here) + total);
    }
}

static void prepare(const ck_BulletLinks *links, const ck_BulletNodes *nodes, Scalar *force, Scalar damping_scale,
                    const ck_BulletHooke *hooke) {
    const bool is_damped = damping_scale > 0;
    if (hooke && is_damped)
        prepare_links(links, nodes, force, damping_scale, hooke, true, true);
    else if (hooke)
        prepare_links(links, nodes, force, 0, hooke, false, true);
    else if (is_damped)
        prepare_links(links, nodes, force, damping_scale, NULL, true, false);
}

const ck_BulletLoops CK_LOOP(ck_bullet_loops) = {pull, multiply, prepare};
