// The bodies that engines are timed on.
#ifndef CK_BENCH_BODY_H
#define CK_BENCH_BODY_H

#include "model.h"

typedef enum ck_BenchKind {
    CK_BENCH_CLOTH,
    CK_BENCH_ON_BALL,
    CK_BENCH_MESH,
    CK_BENCH_ROPE,
    CK_BENCH_ROPES
} ck_BenchKind;

typedef struct ck_BenchBody {
    const char *name;
    ck_BenchKind kind;
    uint32_t rows, columns; // of ropes: particles of each, and how many; of one rope 1
} ck_BenchBody;

// Substeps of a frame: what an engine does once a frame is shared out, as in use.
#define CK_BENCH_SUBSTEPS 16

// 1 m and 0.2 kg in gravity, let go level: k = 1000 N/m along, 500 across. A mesh is a sheet of triangles, each square
// cut one way or the other and each inner node moved by up to a quarter of a spacing. A ball of 0.3 m holds a cloth by
// friction alone, which starts as native-verlet has it after 0.6 s, slung around it: an engine that is timed for longer
// does not meet more of it. A substep is half of the explicit bound without damping, so that every engine steps alike;
// what is damped has 0.02 N·s/m a spring, or less where that would narrow the bound down to the substep.
// Errors: CK_NO_MEMORY; CK_REFUSED where native-verlet diverges on the way there. Free with ck_model_free in any case.
ck_Status ck_bench_body_build(ck_Model *model, const ck_BenchBody *body, bool is_damped, ck_Error *error);

#endif
