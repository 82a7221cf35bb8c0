// Compiled once for each kind of vectors; see loops.h.
#include "line_loop.h"
#include "lanes.h"

#include <string.h>

enum { DAMPED = CK_LINE_DAMPED, REPEATED = CK_LINE_REPEATED, SLANTED = 4 };

// As many lines as there are lanes, side by side: where the first one is in the first row, what is added to be in the
// next, and the rows in which any of them is on the cloth.
typedef struct Lines {
    ck_Real *x, *start, *multiplier, *scratch;
    const ck_Real *weight, *there;
    long step, plane, weight_step; // of x and start; of weight and multiplier
    int slant;                     // of there
    int first, last;
    ck_LineSprings springs;
} Lines;

// A particle of each line, and of the springs that end there.
typedef struct Node {
    ck_Lanes3 x, start;
    ck_Lanes weight, there;
} Node;

CK_INLINE Node node_at(const Lines *lines, int row, const int terms) {
    Node node = {.x = ck_lanes3_load_apart(lines->x + row * lines->step, lines->plane),
                 .weight = ck_lanes_load(lines->weight + row * lines->weight_step)};
    if ((terms & DAMPED) || CK_IS_SINGLE)
        node.start = ck_lanes3_load_apart(lines->start + row * lines->step, lines->plane);
    if (terms & SLANTED) node.there = ck_lanes_load(lines->there + (long)row * lines->slant);
    return node;
}

// A row of the tridiagonal system, as elimination leaves it: Δλ is longer·inverse less the share that the next row has
// in it times its Δλ.
typedef struct Pivot {
    ck_Lanes3 normal;
    ck_Lanes longer, inverse, share, there;
} Pivot;

// −C − α̃·λ − γ̃·∇C·(x − x_start), over 1 + γ̃. In single precision x is told from x_start, to the digits that it begins
// with, half of a place's last one: at 1280 substeps a frame what dampers take that for is 5e-7 of a spring's length.
CK_INLINE ck_Lanes residual_of(const Lines *lines, const Node *a, const Node *b, ck_Lanes3 way, ck_Lanes3 normal,
                               ck_Lanes length, long multiplier, const int terms) {
    const ck_LineSprings *springs = &lines->springs;
    ck_Lanes residual = springs->rest - length;
    if (terms & REPEATED)
        residual =
            ck_lanes_minus(residual, ck_lanes_all(springs->compliance), ck_lanes_load(lines->multiplier + multiplier));
    if (terms & DAMPED) {
        const ck_Lanes3 moved = CK_IS_SINGLE ? ck_lanes3_subtract(b->x, a->x)
                                             : ck_lanes3_subtract(way, ck_lanes3_subtract(b->start, a->start));
        residual = ck_lanes_minus(residual, ck_lanes_all(springs->gamma), ck_lanes3_dot(moved, normal));
    }
    return springs->share * residual;
}

// Eliminates the spring from a to b, after the one that ends in a.
CK_INLINE Pivot eliminate(const Lines *lines, const Node *a, const Node *b, const Pivot *before, long multiplier,
                          const int terms) {
    Pivot pivot;
    ck_Lanes3 way = ck_lanes3_subtract(b->x, a->x);
    if (CK_IS_SINGLE) way = ck_lanes3_add(ck_lanes3_subtract(b->start, a->start), way);
    ck_Lanes squared = ck_lanes3_dot(way, way), inverse;
    ck_lanes_inverse_root(&inverse, &squared, 1);
    pivot.normal = ck_lanes3_scale(inverse, way);
    pivot.longer = residual_of(lines, a, b, way, pivot.normal, squared * inverse, multiplier, terms);
    ck_Lanes coupling = -a->weight * ck_lanes3_dot(pivot.normal, before->normal);
    if (terms & SLANTED) {
        pivot.there = a->there * b->there;
        pivot.longer *= pivot.there;
        coupling *= pivot.there * before->there;
    }
    pivot.share = coupling * before->inverse;
    const ck_Lanes diagonal = ck_lanes_minus(a->weight + b->weight + lines->springs.softness, pivot.share, coupling);
    pivot.inverse = ck_lanes_all(1) / diagonal;
    pivot.longer = ck_lanes_minus(pivot.longer, pivot.share, before->longer);
    return pivot;
}

CK_INLINE void keep(ck_Real *scratch, const Pivot *pivot) {
    ck_lanes3_store_apart(scratch, CK_STRIPE, pivot->normal);
    ck_lanes_store(scratch + 3 * CK_STRIPE, pivot->longer * pivot->inverse);
    ck_lanes_store(scratch + 4 * CK_STRIPE, pivot->share);
}

CK_INLINE void eliminate_lines(const Lines *lines, const int terms) {
    const ck_Lanes none = {0};
    Pivot before = {{none, none, none}, none, none, none, none};
    Node a = node_at(lines, lines->first, terms);
    for (int row = lines->first; row < lines->last; row++) {
        const Node b = node_at(lines, row + 1, terms);
        before = eliminate(lines, &a, &b, &before, row * lines->weight_step, terms);
        keep(lines->scratch + (long)CK_LINE_SCRATCH * row, &before);
        a = b;
    }
}

// x ← x + w·push
CK_INLINE void push(const Lines *lines, int row, ck_Lanes3 push) {
    ck_Real *x = lines->x + row * lines->step;
    const ck_Lanes weight = ck_lanes_load(lines->weight + row * lines->weight_step);
    ck_lanes3_store_apart(x, lines->plane, ck_lanes3_add_scaled(ck_lanes3_load_apart(x, lines->plane), weight, push));
}

// From the last spring back: Δλ, and what it and the one after it push the particle between them by.
CK_INLINE void move_lines(const Lines *lines, const int terms) {
    const ck_Lanes none = {0};
    ck_Lanes change = none, share = none;
    ck_Lanes3 after = {none, none, none};
    for (int row = lines->last - 1; row >= lines->first; row--) {
        const ck_Real *kept = lines->scratch + (long)CK_LINE_SCRATCH * row;
        change = ck_lanes_minus(ck_lanes_load(kept + 3 * CK_STRIPE), share, change);
        share = ck_lanes_load(kept + 4 * CK_STRIPE);
        const ck_Lanes3 pull = ck_lanes3_scale(change, ck_lanes3_load_apart(kept, CK_STRIPE));
        push(lines, row + 1, ck_lanes3_subtract(pull, after));
        after = pull;
        if (terms & REPEATED) {
            ck_Real *multiplier = lines->multiplier + row * lines->weight_step;
            ck_lanes_store(multiplier, ck_lanes_load(multiplier) + change);
        }
    }
    push(lines, lines->first, ck_lanes3_subtract((ck_Lanes3){none, none, none}, after));
}

CK_INLINE int most(int a, int b) {
    return a > b ? a : b;
}

CK_INLINE int least(int a, int b) {
    return a < b ? a : b;
}

CK_INLINE void solve(const Lines *lines, const int terms) {
    eliminate_lines(lines, terms);
    move_lines(lines, terms);
}

// All lines of a kind that goes down the rows. A line that is beside the cloth for some rows has no springs there.
CK_INLINE void solve_down(const struct ck_LinedCloth *cloth, ck_LineKind kind, const int slant, const int terms) {
    const int rows = cloth->rows, columns = cloth->columns;
    const int from = slant > 0 ? 1 - rows : 0, to = slant < 0 ? columns + rows - 1 : columns;
    for (int column = from; column < to; column += CK_LANES) {
        Lines lines = {.x = cloth->x + column,
                       .start = cloth->start + column,
                       .weight = cloth->weight + column,
                       .there = cloth->there + column,
                       .multiplier = cloth->multiplier[kind] + column,
                       .scratch = cloth->scratch,
                       .step = cloth->stride + slant,
                       .weight_step = cloth->stride + slant,
                       .plane = cloth->plane,
                       .slant = slant,
                       .last = rows - 1,
                       .springs = cloth->springs[kind]};
        if (slant > 0) {
            lines.first = most(0, 1 - CK_LANES - column);
            lines.last = least(rows - 1, columns - 1 - column);
        } else if (slant < 0) {
            lines.first = most(0, column - columns + 1);
            lines.last = least(rows - 1, column + CK_LANES - 1);
        }
        solve(&lines, terms | (slant ? SLANTED : 0));
    }
}

// Turns a square of as many vectors as there are lanes: blocks of one, two, four … lanes change places across it. Loops
// count by one or two, which compilers unroll: else the square would stand in memory, a tenth of a substep's time.
#if CK_LANES == 16
CK_INLINE void turn_square(ck_Lanes *square) {
    for (int i = 0; i < 16; i += 2) {
        const ck_Lanes a = square[i], b = square[i + 1];
        square[i] = __builtin_shufflevector(a, b, 0, 16, 2, 18, 4, 20, 6, 22, 8, 24, 10, 26, 12, 28, 14, 30);
        square[i + 1] = __builtin_shufflevector(a, b, 1, 17, 3, 19, 5, 21, 7, 23, 9, 25, 11, 27, 13, 29, 15, 31);
    }
    for (int k = 0; k < 8; k++) {
        const int i = k / 2 * 4 + k % 2;
        const ck_Lanes a = square[i], b = square[i + 2];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 16, 17, 4, 5, 20, 21, 8, 9, 24, 25, 12, 13, 28, 29);
        square[i + 2] = __builtin_shufflevector(a, b, 2, 3, 18, 19, 6, 7, 22, 23, 10, 11, 26, 27, 14, 15, 30, 31);
    }
    for (int k = 0; k < 8; k++) {
        const int i = k / 4 * 8 + k % 4;
        const ck_Lanes a = square[i], b = square[i + 4];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 16, 17, 18, 19, 8, 9, 10, 11, 24, 25, 26, 27);
        square[i + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 20, 21, 22, 23, 12, 13, 14, 15, 28, 29, 30, 31);
    }
    for (int i = 0; i < 8; i++) {
        const ck_Lanes a = square[i], b = square[i + 8];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23);
        square[i + 8] = __builtin_shufflevector(a, b, 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31);
    }
}
#elif CK_LANES == 8
CK_INLINE void turn_square(ck_Lanes *square) {
    for (int i = 0; i < 8; i += 2) {
        const ck_Lanes a = square[i], b = square[i + 1];
        square[i] = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
        square[i + 1] = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
    }
    for (int k = 0; k < 4; k++) {
        const int i = k / 2 * 4 + k % 2;
        const ck_Lanes a = square[i], b = square[i + 2];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
        square[i + 2] = __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
    }
    for (int i = 0; i < 4; i++) {
        const ck_Lanes a = square[i], b = square[i + 4];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
        square[i + 4] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
    }
}
#elif CK_LANES == 4
CK_INLINE void turn_square(ck_Lanes *square) {
    for (int i = 0; i < 4; i += 2) {
        const ck_Lanes a = square[i], b = square[i + 1];
        square[i] = __builtin_shufflevector(a, b, 0, 4, 2, 6);
        square[i + 1] = __builtin_shufflevector(a, b, 1, 5, 3, 7);
    }
    for (int i = 0; i < 2; i++) {
        const ck_Lanes a = square[i], b = square[i + 2];
        square[i] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
        square[i + 2] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
    }
}
#else
CK_INLINE void turn_square(ck_Lanes *square) {
    const ck_Lanes a = square[0], b = square[1];
    square[0] = __builtin_shufflevector(a, b, 0, 2);
    square[1] = __builtin_shufflevector(a, b, 1, 3);
}
#endif

// From as many rows as there are lanes to a tile a column, and back. Beside the cloth there is room for whole squares.
CK_INLINE void turn_rows(const struct ck_LinedCloth *cloth, ck_Real *tiles, const ck_Real *rows) {
    for (int axis = 0; axis < 3; axis++)
        for (int column = 0; column < cloth->columns; column += CK_LANES) {
            ck_Lanes square[CK_LANES];
            for (int i = 0; i < CK_LANES; i++)
                square[i] = ck_lanes_load(rows + axis * cloth->plane + i * cloth->stride + column);
            turn_square(square);
            for (int i = 0; i < CK_LANES; i++) ck_lanes_store(tiles + (3 * (column + i) + axis) * CK_LANES, square[i]);
        }
}

CK_INLINE void turn_back(const struct ck_LinedCloth *cloth, ck_Real *rows, const ck_Real *tiles) {
    for (int axis = 0; axis < 3; axis++)
        for (int column = 0; column < cloth->columns; column += CK_LANES) {
            ck_Lanes square[CK_LANES];
            for (int i = 0; i < CK_LANES; i++) square[i] = ck_lanes_load(tiles + (3 * (column + i) + axis) * CK_LANES);
            turn_square(square);
            for (int i = 0; i < CK_LANES; i++)
                ck_lanes_store(rows + axis * cloth->plane + i * cloth->stride + column, square[i]);
        }
}

// The lines along as many rows as there are lanes.
CK_INLINE void solve_along(const struct ck_LinedCloth *cloth, int row, const int terms) {
    const long first = row * cloth->stride;
    const Lines lines = {.x = cloth->tiles,
                         .start = cloth->start_tiles,
                         .weight = cloth->turned_weight + row,
                         .multiplier = cloth->multiplier[CK_LINES_ALONG] + row,
                         .scratch = cloth->scratch,
                         .step = 3 * CK_LANES,
                         .plane = CK_LANES,
                         .weight_step = cloth->turned_stride,
                         .last = cloth->columns - 1,
                         .springs = cloth->springs[CK_LINES_ALONG]};
    turn_rows(cloth, cloth->tiles, cloth->x + first);
    if ((terms & DAMPED) || CK_IS_SINGLE) turn_rows(cloth, cloth->start_tiles, cloth->start + first);
    solve(&lines, terms);
    turn_back(cloth, cloth->x + first, cloth->tiles);
}

// x̂ ← x + carried·(x − x_start) + push;  x ← x̂ + KEPT·(x − the last x̂);  x_start ← x as it was; of a row. In single
// precision x_start takes up what its digits reach of x, which is told from there; see constraint_loop.c.
CK_INLINE void predict(const struct ck_LinedCloth *cloth, int row, bool is_last) {
    const ck_Lanes carried = ck_lanes_all(cloth->carried), kept = ck_lanes_all(CK_LINES_KEPT), none = {0};
    for (int axis = 0; axis < 3; axis++) {
        const ck_Lanes gain = ck_lanes_all(cloth->push[axis]);
        const long first = row * cloth->stride, from = axis * cloth->plane + first;
        ck_Real *x = cloth->x + from, *start = cloth->start + from, *before = cloth->before + from,
                *flown = cloth->flown + from, *begun = CK_IS_SINGLE ? cloth->begun + from : start;
        for (long i = 0; i < cloth->columns; i += CK_LANES) {
            const ck_Lanes now = ck_lanes_load(x + i), pulled = now - ck_lanes_load(flown + i),
                           moved = now - ck_lanes_load(begun + i);
            const ck_LaneMask is_free = ck_lanes_less(none, ck_lanes_load(cloth->weight + first + i));
            ck_Lanes begins = now, starts = now;
            if (CK_IS_SINGLE) {
                const ck_Lanes last = ck_lanes_load(start + i);
                starts = last + now;
                begins = now - (starts - last);
                ck_lanes_store(begun + i, begins);
            }
            const ck_Lanes flies = begins + ck_lanes_plus(gain, carried, moved);
            ck_lanes_store(flown + i, ck_lanes_choose(is_free, flies, begins));
            ck_lanes_store(x + i, ck_lanes_choose(is_free, ck_lanes_plus(flies, kept, pulled), begins));
            ck_lanes_store(start + i, starts);
            if (is_last) ck_lanes_store(before + i, moved);
        }
    }
}

CK_INLINE void begin_row(const struct ck_LinedCloth *cloth, const struct ck_LinedCloth *shared, int row, bool is_last) {
    if (!cloth->head.contact)
        predict(cloth, row, is_last);
    else if (row < cloth->rows)
        cloth->loops->line_fly(shared, row, is_last);
}

// Along rows as soon as they have flown. Other files get what is shared: the copy's address does not leave this one.
CK_INLINE void sweep(const struct ck_LinedCloth *cloth, const struct ck_LinedCloth *shared, bool begins, bool is_last,
                     const int terms) {
    for (int row = 0; row < cloth->rows; row += CK_LANES) {
        for (int i = row; i < row + CK_LANES && begins; i++) begin_row(cloth, shared, i, is_last);
        solve_along(cloth, row, terms);
    }
    if (cloth->springs[CK_LINES_DOWN_RIGHT].rest > 0) {
        solve_down(cloth, CK_LINES_DOWN_RIGHT, 1, terms);
        solve_down(cloth, CK_LINES_DOWN_LEFT, -1, terms);
    }
    solve_down(cloth, CK_LINES_DOWN, 0, terms);
    if (cloth->head.contact) cloth->loops->line_press(shared);
}

static void forget_multipliers(const struct ck_LinedCloth *cloth) {
    for (int kind = 0; kind < CK_LINE_KINDS; kind++)
        memset(cloth->multiplier[kind] - CK_MARGIN, 0, sizeof(ck_Real) * (size_t)(cloth->multipliers + CK_MARGIN));
}

// A substep: the flight, and its sweeps.
ck_LineSubstep CK_LOOP(ck_line_substep);
void CK_LOOP(ck_line_substep)(const struct ck_LinedCloth *shared, bool is_last) {
    const struct ck_LinedCloth local = *shared, *cloth = &local; // known to share no memory with the arrays
    if (cloth->terms & REPEATED) forget_multipliers(cloth);
    for (uint32_t i = 0; i < cloth->rule.iterations; i++) switch (cloth->terms) {
        case 0: sweep(cloth, shared, i == 0, is_last, 0); break;
        case DAMPED: sweep(cloth, shared, i == 0, is_last, DAMPED); break;
        case REPEATED: sweep(cloth, shared, i == 0, is_last, REPEATED); break;
        default: sweep(cloth, shared, i == 0, is_last, DAMPED | REPEATED); break;
        }
}
