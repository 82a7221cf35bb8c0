// The innermost loops of the row kernels, compiled once for each kind of vectors that processors have, those over rows
// in single precision, too.
//
// Those for vectors of eight and of four doubles give the same bits: both fuse products and sums, and alike. The plain
// ones, on x86 for processors older than 2013, cannot, and round otherwise.
#ifndef CK_LOOPS_H
#define CK_LOOPS_H

#include <stdbool.h>
#include <stdint.h>

struct ck_ExplicitCloth;
struct ck_ExplicitList;
struct ck_LinedCloth;
struct ck_ProjectedCloth;
struct ck_RowContact;
struct ck_SweepList;
struct ck_Visits;

// A row's way to the first substep's forces; see spring_loop.h.
typedef void ck_ExplicitStart(const struct ck_ExplicitCloth *cloth, int row);
// One row's part of a substep; see spring_loop.h.
typedef void ck_ExplicitRow(const struct ck_ExplicitCloth *cloth, int row, bool advances);
// A surface that particles may come to touch: a half-space, or what is no farther than a radius from a core, a point, a
// line or a box of half lengths along axes.
typedef struct ck_NearSurface {
    bool is_plane;
    int axis_count;
    double point[3], normal[3], axes[3][3], half[3], radius; // m
    double margin; // m, closer than which is touching, and how far it moves in a substep
    double friction;
    bool moves;
    double velocity[3], acceleration[3], way[3]; // m/s and m/s² from there on, m in the whole substep
} ck_NearSurface;

// Particles that are followed by themselves, coordinate by coordinate: [3*stride], and [stride] of what is one number.
typedef struct ck_Loose {
    int count, strays;        // strays: stand behind where their place would be, so that the cache finds them badly
    long *place;              // where the body has it
    long stride;              // a multiple of CK_STRIPE
    double *x, *v, *a;        // m, m/s, m/s²
    double *predicted, *mass; // m/s, kg
    double *normal;           // of the surface that is touched, out, unit, or 0: set for touch_hold, and what follows
    double *curvature, *friction;
    double *is_alone; // above 0: no loop takes it; below: none has to, as nothing was in its reach
} ck_Loose;

// What they may touch.
typedef struct ck_Touched {
    const ck_NearSurface *surfaces;
    int count;
    double dt, slack; // s; m, closer than which is touching
} ck_Touched;

// One substep of those that rest or slide on one plane or ball that stays and go on to, and of those that touch
// nothing, and half a kick; then the other half. Says whether there are others, and any that may leave. See
// touch_loop.c.
enum { CK_SOME_ALONE = 1, CK_SOME_LEAVE = 2 };
typedef unsigned ck_TouchSlide(const ck_Touched *touch, const ck_Loose *loose, double *impulse);
typedef void ck_TouchHold(double dt, const ck_Loose *loose);

// Between several surfaces, one pushes into another: so many rounds of all of them at most.
#define CK_PUSH_ROUNDS 16

// Follows one particle at a time where no loop does, for bodies whose constraints are projected. Called from several
// threads at once.
typedef struct ck_Follower {
    void *state;
    // One that may meet a surface on its way from x at a mean velocity v, under a field, m/s², of its own: moves it
    // over its impacts, and gives the mean velocity that it goes on from. False where it meets none: all is as it was.
    //   impulse  in-out, [3] N·s
    bool (*meet)(void *state, int particle, const double *field, double *x, double *v, double *impulse);
    // One that may be inside: out of it, with what friction holds of its way from a place; see row_contact.h.
    void (*press)(void *state, int particle, const double *from, double *depth, double *held, double *x,
                  double *impulse);
} ck_Follower;

// The start of a substep for what of a row cannot touch one of so many surfaces within it. True where others come to be
// near. See near_loop.c.
typedef bool ck_NearRow(const struct ck_ExplicitCloth *cloth, int row, int count);
// The same over a chunk of a list of springs, from one of its two arrays of points, into the other where it advances;
// see list_loop.h.
typedef void ck_ListStart(const struct ck_ExplicitList *list, int chunk, int now);
typedef void ck_ListChunk(const struct ck_ExplicitList *list, int chunk, int from, bool advances);
typedef bool ck_NearChunk(const struct ck_ExplicitList *list, int chunk, const ck_NearSurface *surfaces, int count);
// A wave of interleaved sweeps; see constraint_loop.h.
typedef void ck_ProjectionVisits(const struct ck_ProjectedCloth *cloth, const struct ck_Visits *visits);
// A row's flight to the start of a substep's sweeps, and what surfaces push it by in a sweep, of a contact and of a
// cloth; see row_contact_loop.c.
typedef void ck_RowFly(const struct ck_ProjectedCloth *cloth, int row, bool is_last);
typedef bool ck_RowPress(const struct ck_RowContact *contact, int row); // true where anything was
typedef void ck_ClothPress(const struct ck_ProjectedCloth *cloth, int row);
// Beside a list, and of lines: a bit for each of a row of eight that may meet a surface on its way, from x at a speed
// way/dt under a field gain/dt²; the others do not.
typedef unsigned ck_RowMeets(const struct ck_RowContact *contact, int row);
// A substep of lines; see line_loop.h.
typedef void ck_LineSubstep(const struct ck_LinedCloth *cloth, bool is_last);
// A row's flight there, where there are surfaces, and what those push the cloth by; see line_contact_loop.c.
typedef void ck_LineFly(const struct ck_LinedCloth *cloth, int row, bool is_last);
typedef void ck_LinePress(const struct ck_LinedCloth *cloth);
// A sweep over packs of springs, from the first to before the end, as it comes to them; see sweep_list_loop.h.
typedef void ck_SweepPacks(const struct ck_SweepList *list, int first, int end, bool is_turned);
// Products with a sum each, as many as it can a second; returns how many there were.
typedef long ck_Peak(long rounds, double *result);

typedef struct ck_Loops {
    const char *vectors; // what compilers call the processors that have them
    int lanes;           // numbers of one
    bool fuses, is_single;
    ck_ExplicitStart *explicit_start;
    ck_ExplicitRow *explicit_row;
    ck_NearRow *near_row;
    ck_TouchSlide *touch_slide;
    ck_TouchHold *touch_hold;
    ck_ListStart *list_start;
    ck_ListChunk *list_chunk;
    ck_NearChunk *near_chunk;
    ck_ProjectionVisits *projection_visits;
    ck_RowFly *row_fly;
    ck_RowPress *row_press;
    ck_ClothPress *cloth_press;
    ck_RowMeets *row_meets;
    ck_LineSubstep *line_substep;
    ck_LineFly *line_fly;
    ck_LinePress *line_press;
    ck_SweepPacks *sweep_packs;
    ck_Peak *peak;
} ck_Loops;

// Those that this processor can run, the widest first; from their number on NULL.
const ck_Loops *ck_loops_at(int index);

// The widest of at most so many doubles; 0: of any. Those of two are there always.
const ck_Loops *ck_loops_for(uint32_t lanes);
// Of their kind of vectors, those of single precision, which know rows and lines only: what else there is is NULL.
const ck_Loops *ck_loops_single(const ck_Loops *loops);

#endif
