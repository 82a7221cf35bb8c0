// Compiled once for each kind of vectors; see loops.h.
#include "spring_loop.h"
#include "lanes.h"

enum { DAMPED = CK_ROW_DAMPED, DRAGGED = CK_ROW_DRAGGED, SHEARED = CK_ROW_SHEARED, BENT = CK_ROW_BENT };

// The springs of one vector of a row to the vector on its right and to the row below; DOWN_LEFT leads from the vector
// on the right to the one below this.
enum { RIGHT, DOWN, DOWN_RIGHT, DOWN_LEFT, SPRINGS };
_Static_assert(SPRINGS <= CK_MOST_TOGETHER, "a vector's springs go through the root together");

typedef struct Ends {
    long a, b; // tiles
    ck_SpringKind kind;
} Ends;

// d leads from a spring's end a to its end b; its force on a is scale·d, with k·(1 − L/l) + c·(v·d)/l² for the scale,
// N/m. Springs go through each operation together: a processor would not look far enough ahead to fill the wait for
// one's result with another's work. Coincident particles push nowhere: their scale is a number.
CK_INLINE void pull(const struct ck_ExplicitCloth *cloth, ck_Lanes3 *d, ck_Lanes *scale, const Ends *ends,
                    const int count, const int terms) {
    const ck_Real damping = (ck_Real)cloth->springs.damping;
    ck_Lanes squared[SPRINGS], inverse[SPRINGS];
    for (int i = 0; i < count; i++) {
        d[i] = ck_lanes3_subtract(ck_lanes3_load(cloth->x + ends[i].b), ck_lanes3_load(cloth->x + ends[i].a));
        squared[i] = ck_lanes3_dot(d[i], d[i]);
    }
    ck_lanes_inverse_root(inverse, squared, count);
    for (int i = 0; i < count; i++) {
        const ck_Real stiffness = (ck_Real)cloth->springs.stiffness[ends[i].kind];
        ck_Lanes slack = ck_lanes_all(cloth->slack[ends[i].kind]);
        if (terms & DAMPED) {
            ck_Lanes3 v = ck_lanes3_subtract(ck_lanes3_load(cloth->predicted + ends[i].b),
                                             ck_lanes3_load(cloth->predicted + ends[i].a));
            slack = ck_lanes_minus(slack, damping * ck_lanes3_dot(v, d[i]), inverse[i]);
        }
        scale[i] = ck_lanes_minus(ck_lanes_all(stiffness), slack, inverse[i]);
    }
}

static const ck_Lanes3 none;

// Springs over two columns and over two rows: their sums go through memory. The row two below starts its sum here.
CK_INLINE void bend_vector(const struct ck_ExplicitCloth *cloth, int row, int vector, int lane, const int terms) {
    const ck_Rows *rows = &cloth->rows;
    const bool is_low = row + 2 >= rows->rows;
    const long here = ck_rows_place(rows, row, vector).tile + lane;
    const long right = ck_rows_right(rows, row, vector, 2).tile + lane;
    const long below = is_low ? here : here + 6 * rows->stride;
    ck_Lanes3 d[2];
    ck_Lanes scale[2];
    pull(cloth, d, scale, (const Ends[]){{here, right, CK_BEND}, {here, below, CK_BEND}}, 2, terms);
    scale[0] *= ck_lanes_load(cloth->far_paired + vector * CK_STRIPE + lane);
    ck_Lanes3 force = ck_lanes3_add_scaled(ck_lanes3_load(cloth->a + here), scale[0], d[0]);
    ck_lanes3_store(cloth->a + here, ck_lanes3_add_scaled(force, scale[1], d[1]));
    force = ck_lanes3_load(cloth->a + right);
    ck_lanes3_store(cloth->a + right, ck_lanes3_subtract_scaled(force, scale[0], d[0]));
    if (!is_low) ck_lanes3_store(cloth->a + below, ck_lanes3_subtract_scaled(none, scale[1], d[1]));
}

// Forces on the vectors that a vector's springs reach.
typedef struct Pulls {
    ck_Lanes3 here, right, below, below_right;
} Pulls;

// Adds what a vector's springs pull. A last row's springs down lead from nodes to themselves or are not paired: they
// pull nothing.
CK_INLINE void pull_vector(const struct ck_ExplicitCloth *cloth, Pulls *pulls, int row, int vector, int lane,
                           const int terms) {
    const ck_Rows *rows = &cloth->rows;
    const bool is_low = row + 1 >= rows->rows;
    const long here = ck_rows_place(rows, row, vector).tile + lane;
    const long right = ck_rows_right(rows, row, vector, 1).tile + lane, down = is_low ? 0 : 3 * rows->stride;
    const Ends ends[] = {{here, right, CK_STRUCTURAL},
                         {here, here + down, CK_STRUCTURAL},
                         {here, right + down, CK_SHEAR},
                         {right, here + down, CK_SHEAR}};
    const ck_Lanes paired = ck_lanes_load(cloth->paired + vector * CK_STRIPE + lane);
    ck_Lanes3 d[SPRINGS];
    ck_Lanes scale[SPRINGS];
    pull(cloth, d, scale, ends, terms & SHEARED ? SPRINGS : 2, terms);
    scale[RIGHT] *= paired;
    pulls->here = ck_lanes3_add_scaled(pulls->here, scale[RIGHT], d[RIGHT]);
    pulls->here = ck_lanes3_add_scaled(pulls->here, scale[DOWN], d[DOWN]);
    pulls->right = ck_lanes3_subtract_scaled(pulls->right, scale[RIGHT], d[RIGHT]);
    pulls->below = ck_lanes3_subtract_scaled(pulls->below, scale[DOWN], d[DOWN]);
    if (!(terms & SHEARED)) return;
    for (int i = DOWN_RIGHT; i < SPRINGS; i++) scale[i] *= is_low ? (ck_Lanes){0} : paired;
    pulls->here = ck_lanes3_add_scaled(pulls->here, scale[DOWN_RIGHT], d[DOWN_RIGHT]);
    pulls->right = ck_lanes3_add_scaled(pulls->right, scale[DOWN_LEFT], d[DOWN_LEFT]);
    pulls->below = ck_lanes3_subtract_scaled(pulls->below, scale[DOWN_LEFT], d[DOWN_LEFT]);
    pulls->below_right = ck_lanes3_subtract_scaled(pulls->below_right, scale[DOWN_RIGHT], d[DOWN_RIGHT]);
}

// a ← w·(force − drag·m·v*), the weight in the force. With another substep to come v ← v + a·dt, x ← x + v·dt, v* = v +
// a·dt/2: its start, too; else v ← v + a·dt/2.
CK_INLINE void finish(const struct ck_ExplicitCloth *cloth, ck_Place at, ck_Lanes3 force, bool advances,
                      const int terms) {
    const ck_Real dt = cloth->dt;
    const ck_Lanes gain = ck_lanes_load(cloth->gain + at.single);
    ck_Lanes3 v = ck_lanes3_load(cloth->v + at.tile);
    if (terms & DRAGGED)
        force = ck_lanes3_subtract_scaled(force, ck_lanes_all(cloth->resistance),
                                          ck_lanes3_load(cloth->predicted + at.tile));
    if (!advances) {
        ck_lanes3_store(cloth->v + at.tile, ck_lanes3_add_scaled(v, 0.5 * gain, force));
        ck_lanes3_store(cloth->a + at.tile, ck_lanes3_scale(gain * (1 / dt), force));
        return;
    }
    v = ck_lanes3_add_scaled(v, gain, force);
    ck_lanes3_store(cloth->v + at.tile, v);
    ck_Lanes3 x = ck_lanes3_load(cloth->x + at.tile);
    ck_lanes3_store(cloth->x + at.tile, ck_lanes3_add_scaled(x, ck_lanes_all(dt), v));
    if (terms & (DAMPED | DRAGGED))
        ck_lanes3_store(cloth->predicted + at.tile, ck_lanes3_add_scaled(v, 0.5 * gain, force));
}

// A vector whose row's springs are done is not read again and ends its substep at once.
CK_INLINE void end_vector(const struct ck_ExplicitCloth *cloth, const Pulls *pulls, int row, int vector, int lane,
                          bool advances, const int terms) {
    ck_Place at = ck_rows_place(&cloth->rows, row, vector);
    at = (ck_Place){at.single + lane, at.tile + lane};
    if (row + 1 < cloth->rows.rows) {
        ck_Real *below = cloth->a + at.tile + 3 * cloth->rows.stride;
        const bool has_begun = (terms & BENT) && row > 0;
        ck_lanes3_store(below, has_begun ? ck_lanes3_add(ck_lanes3_load(below), pulls->below) : pulls->below);
    }
    finish(cloth, at, ck_lanes3_add(ck_lanes3_load(cloth->a + at.tile), pulls->here), advances, terms);
}

// The last vector's springs come first: what they pull to the right is on the first vector, one lane on. To the right
// each pulls with the weight of what is there, too, which so comes in once.
CK_INLINE void pass(const struct ck_ExplicitCloth *cloth, int row, bool advances, const int terms) {
    const int last = cloth->rows.span - 1;
    const ck_Lanes3 weight = ck_lanes3_all(cloth->weight);
    Pulls lasts[CK_STRIPE / CK_LANES];
    // from the last lanes on, so that a vector that is its own right has the sums of its springs in one order
    for (int i = 0; i <= last && (terms & BENT); i++)
        for (int lane = CK_STRIPE - CK_LANES; lane >= 0; lane -= CK_LANES) bend_vector(cloth, row, i, lane, terms);
    for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
        lasts[lane / CK_LANES] = (Pulls){none, weight, none, none};
        pull_vector(cloth, &lasts[lane / CK_LANES], row, last, lane, terms);
    }
    const Pulls *before = NULL;
    for (int lane = 0; lane < CK_STRIPE; lane += CK_LANES) {
        Pulls *end = &lasts[lane / CK_LANES];
        Pulls pulls = {.right = ck_lanes3_next(before ? before->right : weight, end->right),
                       .below_right = ck_lanes3_next(before ? before->below_right : none, end->below_right)};
        for (int i = 0; i < last; i++) {
            pulls = (Pulls){pulls.right, weight, pulls.below_right, none};
            pull_vector(cloth, &pulls, row, i, lane, terms);
            end_vector(cloth, &pulls, row, i, lane, advances, terms);
        }
        end->here = ck_lanes3_add(end->here, pulls.right);
        end->below = ck_lanes3_add(end->below, pulls.below_right);
        end_vector(cloth, end, row, last, lane, advances, terms);
        before = end;
    }
}

// x ← x + v·dt + a·dt²/2;  v* = v + a·dt, where a pass reads it;  v ← v + a·dt/2
ck_ExplicitStart CK_LOOP(ck_explicit_start);
void CK_LOOP(ck_explicit_start)(const struct ck_ExplicitCloth *cloth, int row) {
    const ck_Lanes dt = ck_lanes_all(cloth->dt), half = ck_lanes_all((ck_Real)0.5 * cloth->dt);
    const long end = ck_rows_place(&cloth->rows, row + 1, 0).tile;
    const bool predicts = cloth->terms & (DAMPED | DRAGGED);
    for (long i = ck_rows_place(&cloth->rows, row, 0).tile; i < end; i += CK_LANES) {
        const ck_Lanes a = ck_lanes_load(cloth->a + i), v = ck_lanes_plus(ck_lanes_load(cloth->v + i), half, a);
        ck_lanes_store(cloth->x + i, ck_lanes_plus(ck_lanes_load(cloth->x + i), dt, v));
        if (predicts) ck_lanes_store(cloth->predicted + i, ck_lanes_plus(v, half, a));
        ck_lanes_store(cloth->v + i, v);
    }
}

// The copy is known to share no memory with the arrays: what stands in it need not be read again after each store.
ck_ExplicitRow CK_LOOP(ck_explicit_row);
void CK_LOOP(ck_explicit_row)(const struct ck_ExplicitCloth *shared, int row, bool advances) {
    const struct ck_ExplicitCloth local = *shared, *cloth = &local;
    switch (local.terms) {
    case 0: pass(cloth, row, advances, 0); break;
    case DAMPED: pass(cloth, row, advances, DAMPED); break;
    case DRAGGED: pass(cloth, row, advances, DRAGGED); break;
    case DAMPED | DRAGGED: pass(cloth, row, advances, DAMPED | DRAGGED); break;
    case SHEARED: pass(cloth, row, advances, SHEARED); break;
    case SHEARED | DAMPED: pass(cloth, row, advances, SHEARED | DAMPED); break;
    case SHEARED | DRAGGED: pass(cloth, row, advances, SHEARED | DRAGGED); break;
    case SHEARED | DAMPED | DRAGGED: pass(cloth, row, advances, SHEARED | DAMPED | DRAGGED); break;
    case BENT | DAMPED | DRAGGED: pass(cloth, row, advances, BENT | DAMPED | DRAGGED); break;
    default: pass(cloth, row, advances, BENT | SHEARED | DAMPED | DRAGGED); break;
    }
}
