// What a scene can be scored against without trusting any engine.
#ifndef CK_TRUTH_H
#define CK_TRUTH_H

#include "metric.h"
#include "model.h"
#include "process.h"
#include "status.h"

struct ck_Truth;

// One way to the truth: a table row each. It has either at (a closed form) or solve (computed), or
// neither: then only what holds for every body is known.
typedef struct ck_TruthForm {
    const char *name;   // as a scene names it
    const char *kind;   // "closed form", "equilibrium", "trajectory"
    const char *source; // the formula or method, and where it is from
    bool is_static;
    unsigned terms; // of ck_Term: colliders, release, wind and slack springs, which most truths do not know

    // Writes the state at time s: [3*n] m, [3*n] m/s. A static form ignores time.
    // Errors: CK_BAD_INPUT where the model is not what the formula is for; the message says what it needs.
    ck_Status (*at)(const ck_Model *model, double time, double *position, double *velocity, ck_Error *error);
    // How far the formula itself is off, in units of size. NULL: it is exact.
    double (*off)(const ck_Model *model);
    // It is of small motions: where the scene can be integrated, that says how far it is off, in place of off.
    bool is_linear;

    // Beyond its horizon the paths are an ensemble, which bounds what is read off whole states.
    bool is_chaotic;
    // Moves the start by a share of the size, to one that the form is for as well. NULL: its answer is stable.
    void (*nudge)(ck_Model *model, double share);
    // Whether it is for such a model, in the words of "truth NAME needs …". NULL: what at says at time 0.
    ck_Status (*check)(const ck_Model *model, ck_Error *error);

    // Fills paths, path_count and the reference's horizon. Errors: CK_REFUSED where there is no such truth,
    // CK_NO_MEMORY.
    ck_Status (*solve)(struct ck_Truth *truth, const ck_Model *model, ck_Error *error);
    // How many springs and particles it evaluates at least, some 5 ns each: what would take longer than may be waited
    // is not begun.
    double (*work)(const ck_Model *model);
    // What a reader must know of it for such a model. NULL, of either: nothing.
    const char *(*leaves_open)(const ck_Model *model);
} ck_TruthForm;

#define CK_TRUTH_MAX_PATHS 8

typedef struct ck_Truth {
    const ck_TruthForm *form; // NULL: the scene has none
    char kind[128];           // form->kind, with what is to be known about it; without a path: why there is none
    ck_Trajectory paths[CK_TRUTH_MAX_PATHS]; // the truth, then others that are as good: their spread is its uncertainty
    int path_count;
    ck_Reference reference; // the first path; owned by paths
    double off;             // how far a closed form itself is off, in units of size
} ck_Truth;

int ck_truth_count(void);
const ck_TruthForm *ck_truth_form_at(int index);

// NULL where there is no such form.
const ck_TruthForm *ck_truth_form_find(const char *name);

// Whether the truth that the model names exists and is for such a model; cheap.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_truth_check(const ck_Model *model, ck_Error *error);

// The truth that the model names, at its frames. A computed one is taken from the cache when it is there and whole.
//   cache   directory, NULL: none
//   limits  a computed one is solved in a child that keeps them, or given up; NULL: here, without any
// Errors: CK_BAD_INPUT, CK_NO_MEMORY. That a computed truth does not exist is no error: kind says why. Free in any
// case.
ck_Status ck_truth_create(ck_Truth *truth, const ck_Model *model, const char *cache, const ck_Limits *limits,
                          ck_Error *error);

// Where it is known already that the truth the model names is not to be had, and why: as ck_truth_create ends then.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_truth_without(ck_Truth *truth, const ck_Model *model, const char *kind, ck_Error *error);

// How far the truth's value of a metric may be off, in the metric's unit: the spread over all paths of the truth,
// where a metric reads beyond the horizon twice the largest distance in an ensemble, and what reading it off frames
// costs. NaN where the metric has no truth.
double ck_truth_uncertainty(const ck_Truth *truth, const ck_Model *model, const ck_Metric *metric);

// Accepts a zeroed truth.
void ck_truth_free(ck_Truth *truth);

#endif
