#include "sweep_order.h"

#include "constraint_kernel.h"
#include "constraint_loop.h"
#include "spring_list.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct Visit {
    long when;
    int spring;
} Visit;

static int compare_visits(const void *a, const void *b) {
    long x = ((const Visit *)a)->when, y = ((const Visit *)b)->when;
    return (x > y) - (x < y);
}

// How a sweep goes over rows.
typedef struct Way {
    ck_Rows rows;
    ck_Projection projection;
    bool goes_down; // else from both edges to the middle
} Way;

// A row's turn; see sweep_schedule.c.
static long turn_of(const Way *way, int row) {
    const int rows = way->rows.rows;
    if (way->goes_down) return 2L * row;
    return row < (rows - 1) / 2 ? 2L * row : 2L * (rows - 1 - row) + 1;
}

// When a sweep comes to a spring: by the turn of the row it is at, colour, vector and lane.
static long when_visited(const Way *way, const ck_Spring *spring) {
    const ck_Rows *rows = &way->rows;
    int row = spring->a / rows->columns, right = spring->b % rows->columns - spring->a % rows->columns;
    int column = spring->a % rows->columns - (right < 0), vector = column % rows->span;
    bool are_bars = way->projection == CK_PROJECT_BARS;
    // the colours' numbers have the order of either sweep
    ck_Colour colour = are_bars ? CK_DOWN : CK_DOWN_LATE;
    if (spring->kind == CK_SHEAR) colour = right > 0 ? CK_DOWN_RIGHT : CK_DOWN_LEFT;
    if (spring->b / rows->columns == row) colour = vector + 1 == rows->span ? CK_ALONG_LAST : vector % 2;
    const long turn = turn_of(way, row + (colour == CK_DOWN_LATE));
    return (turn * CK_COLOUR_COUNT + colour) * rows->stride + ck_rows_at(rows, 0, column).single;
}

// Springs that are coloured together: so many that packs are full, and so few that they stay near.
#define PART 256
#define COLOURS 64
// Springs of a body at least, so that there are some of each.
#define LEAST_COLOURED 128

// Orders springs from one on by colours: each has the first that neither of its particles has yet; of more than there
// are, the last.
//   taken  [n] a bit for each colour that a particle has
static void order_part(const ck_Model *model, int from, int count, uint64_t *taken, int *order) {
    unsigned char colours[PART];
    int starts[COLOURS + 1] = {0};
    for (int i = 0; i < count; i++) taken[model->springs[from + i].a] = taken[model->springs[from + i].b] = 0;
    for (int i = 0; i < count; i++) {
        const ck_Spring *spring = &model->springs[from + i];
        const uint64_t left = ~(taken[spring->a] | taken[spring->b]);
        const int colour = left ? __builtin_ctzll(left) : COLOURS - 1;
        taken[spring->a] |= (uint64_t)1 << colour;
        taken[spring->b] |= (uint64_t)1 << colour;
        colours[i] = (unsigned char)colour;
        starts[colour + 1]++;
    }
    for (int i = 0; i < COLOURS; i++) starts[i + 1] += starts[i];
    for (int i = 0; i < count; i++) order[from + starts[colours[i]]++] = from + i;
}

static ck_Status order_mesh(const ck_Model *model, int *order) {
    uint64_t *taken = malloc(sizeof *taken * (size_t)model->particle_count);
    if (!taken) return CK_NO_MEMORY;
    for (int from = 0; from < model->spring_count; from += PART) {
        const int left = model->spring_count - from;
        order_part(model, from, left < PART ? left : PART, taken, order);
    }
    free(taken);
    return CK_OK;
}

bool ck_sweep_has_colours(const ck_Model *model, ck_Projection projection) {
    ck_RowSprings springs;
    return projection == CK_PROJECT_SPRINGS && model->spring_count >= LEAST_COLOURED &&
           2L * model->spring_count > 3L * model->particle_count && model->spring_count <= CK_MOST_LISTED &&
           model->particle_count <= CK_MOST_LISTED && !ck_projection_fits(model, &springs);
}

// The springs of a kind of lines that begin at each particle, by what leads to the next one.
typedef struct LineStarts {
    int *along, *down, *down_right, *down_left; // [n] springs, or -1
} LineStarts;

static int *starts_of(const LineStarts *starts, const ck_Spring *spring, int columns) {
    const int apart = spring->b - spring->a;
    if (spring->kind == CK_SHEAR) return apart == columns + 1 ? starts->down_right : starts->down_left;
    return apart == columns ? starts->down : starts->along;
}

// Appends the lines of a kind, each from its first particle on; returns how many springs there are by then.
static int append_lines(const ck_Model *model, const int *starts, bool *follows, int *order, int count) {
    const int particles = model->particle_count;
    memset(follows, 0, (size_t)particles * sizeof *follows);
    for (int i = 0; i < particles; i++)
        if (starts[i] >= 0) follows[model->springs[starts[i]].b] = true;
    for (int first = 0; first < particles; first++)
        for (int at = first; !follows[first] && starts[at] >= 0; at = model->springs[order[count++]].b)
            order[count] = starts[at];
    return count;
}

// Of a regular cloth: along rows, down right, down left, down.
static ck_Status order_lines(const ck_Model *model, int *order) {
    const size_t particles = (size_t)model->particle_count;
    int *starts = malloc(sizeof *starts * 4 * particles), count = 0;
    bool *follows = malloc(sizeof *follows * particles);
    if (starts && follows) {
        const LineStarts lines = {starts, starts + particles, starts + 2 * particles, starts + 3 * particles};
        int *const kinds[] = {lines.along, lines.down_right, lines.down_left, lines.down};
        for (size_t i = 0; i < 4 * particles; i++) starts[i] = -1;
        for (int i = 0; i < model->spring_count; i++)
            starts_of(&lines, &model->springs[i], model->columns)[model->springs[i].a] = i;
        for (int kind = 0; kind < 4; kind++) count = append_lines(model, kinds[kind], follows, order, count);
    }
    const bool has_memory = starts && follows;
    free(starts);
    free(follows);
    return has_memory ? CK_OK : CK_NO_MEMORY;
}

ck_Status ck_sweep_order(const ck_Model *model, ck_Projection projection, uint32_t sweeps, int *order) {
    ck_RowSprings springs;
    for (int i = 0; i < model->spring_count; i++) order[i] = i;
    if (!ck_projection_fits(model, &springs))
        return ck_sweep_has_colours(model, projection) ? order_mesh(model, order) : CK_OK;
    if (projection == CK_PROJECT_LINES) return order_lines(model, order);
    const Way way = {ck_rows_of(model), projection, sweeps == 1 || projection == CK_PROJECT_SPRINGS};
    Visit *visits = malloc(sizeof *visits * (size_t)model->spring_count);
    if (!visits) return CK_NO_MEMORY;
    for (int i = 0; i < model->spring_count; i++) visits[i] = (Visit){when_visited(&way, &model->springs[i]), i};
    qsort(visits, (size_t)model->spring_count, sizeof *visits, compare_visits);
    for (int i = 0; i < model->spring_count; i++) order[i] = visits[i].spring;
    free(visits);
    return CK_OK;
}
