// The passes over springs that the bridge adds to Bullet's steps, in C and compiled once for each kind of vectors: what
// they cost is not Bullet's, so it should be little. One register holds the three coordinates of a particle, as Bullet
// lays them out.
#ifndef CK_BULLET_LOOPS_H
#define CK_BULLET_LOOPS_H

#ifdef __cplusplus
extern "C" {
#endif

// Bullet's own numbers, of whichever of its libraries this is built for.
#ifdef CK_BULLET_FLOAT
typedef float ck_BulletScalar;
#else
typedef double ck_BulletScalar;
#endif

// Springs in the order of their first ends: those of node i are from start[i] to start[i + 1].
typedef struct ck_BulletLinks {
    int nodes;
    const int *start;                                  // [nodes + 1]
    const int *other;                                  // [links] the node at the other end
    const ck_BulletScalar *rest, *stiffness, *damping; // [links] m, N/m, N*s/m
    ck_BulletScalar *normal; // [4*links] unit, from the first end to the other; its fourth is 0
    ck_BulletScalar *length; // [links] m
} ck_BulletLinks;

// Vectors of the first node; the next node's are stride numbers further on.
typedef struct ck_BulletNodes {
    const ck_BulletScalar *position, *velocity;
    long stride;
} ck_BulletNodes;

// What makes of Bullet's correction Hooke's.
typedef struct ck_BulletHooke {
    const ck_BulletScalar *of_one; // [links] (w_a + w_b)/κ
    const ck_BulletScalar *least;  // [links]
    const int *slot;               // [links] where in factor a link's is
    ck_BulletScalar *factor;
} ck_BulletHooke;

typedef struct ck_BulletLoops {
    // Finds normals and lengths, and adds to force, [4*nodes], scale times the tension of springs and damping_scale
    // times what their damping answers to velocity with.
    void (*pull)(const ck_BulletLinks *links, const ck_BulletNodes *nodes, ck_BulletScalar *force,
                 ck_BulletScalar scale, ck_BulletScalar damping_scale);
    // With m the difference of d from a spring's first end to the other: adds along·(n·m)·n + across·m to result at the
    // first end and takes it off at the other; takes own·d off at each node. Normals are those of the last pull.
    //   along  [links]; across  [links], NULL: none; own  [nodes]; d, result  [4*nodes]
    void (*multiply)(const ck_BulletLinks *links, const ck_BulletScalar *along, const ck_BulletScalar *across,
                     const ck_BulletScalar *own, const ck_BulletScalar *d, ck_BulletScalar *result);
    // For the position-based world. of_one times h = l·(l + L)/(l² + L²), but at least least, is put into a link's slot
    // of factor; and force, of the stride of nodes, gets damping as in pull. hooke may be NULL, damping_scale 0.
    void (*prepare)(const ck_BulletLinks *links, const ck_BulletNodes *nodes, ck_BulletScalar *force,
                    ck_BulletScalar damping_scale, const ck_BulletHooke *hooke);
} ck_BulletLoops;

// Those of the widest vectors that this processor has.
const ck_BulletLoops *ck_bullet_loops(void);

#ifdef __cplusplus
}
#endif

#endif
