// The passes over springs that the bridge adds to Bullet's steps, in C and compiled once for each kind of vectors: what
// they cost is not Bullet's, so it should be little. One register holds the three coordinates of a particle, as Bullet
// lays them out.
#ifndef CK_BULLET_LOOPS_H
#define CK_BULLET_LOOPS_H

#ifdef __cplusplus
extern "C" {
#endif

// Springs in the order of their first ends: those of node i are from start[i] to start[i + 1].
typedef struct ck_BulletLinks {
    int nodes;
    const int *start;                         // [nodes + 1]
    const int *other;                         // [links] the node at the other end
    const double *rest, *stiffness, *damping; // [links] m, N/m, N*s/m
    double *normal;                           // [4*links] unit, from the first end to the other; its fourth is 0
    double *length;                           // [links] m
} ck_BulletLinks;

// Vectors of the first node; the next node's are stride doubles further on.
typedef struct ck_BulletNodes {
    const double *position, *velocity;
    long stride;
} ck_BulletNodes;

// What makes of Bullet's correction Hooke's.
typedef struct ck_BulletHooke {
    const double *of_one; // [links] (w_a + w_b)/κ
    const double *least;  // [links]
    const int *slot;      // [links] where in factor a link's is
    double *factor;
} ck_BulletHooke;

typedef struct ck_BulletLoops {
    // Finds normals and lengths, and adds to force, [4*nodes], scale times the tension of springs and damping_scale
    // times what their damping answers to velocity with.
    void (*pull)(const ck_BulletLinks *links, const ck_BulletNodes *nodes, double *force, double scale,
                 double damping_scale);
    // With m the difference of d from a spring's first end to the other: adds along·(n·m)·n + across·m to result at the
    // first end and takes it off at the other; takes own·d off at each node. Normals are those of the last pull.
    //   along  [links]; across  [links], NULL: none; own  [nodes]; d, result  [4*nodes]
    void (*multiply)(const ck_BulletLinks *links, const double *along, const double *across, const double *own,
                     const double *d, double *result);
    // For the position-based world. of_one times h = l·(l + L)/(l² + L²), but at least least, is put into a link's slot
    // of factor; and force, of the stride of nodes, gets damping as in pull. hooke may be NULL, damping_scale 0.
    void (*prepare)(const ck_BulletLinks *links, const ck_BulletNodes *nodes, double *force, double damping_scale,
                    const ck_BulletHooke *hooke);
} ck_BulletLoops;

// Those of the widest vectors that this processor has.
const ck_BulletLoops *ck_bullet_loops(void);

#ifdef __cplusplus
}
#endif

#endif
