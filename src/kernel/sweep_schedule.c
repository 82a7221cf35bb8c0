// The order in which the sweeps over a cloth's rows come to them: ck_projection_step. Compiled for either precision;
// see single.h.
#include "constraint_loop.h"

// Rows between a sweep and the next: neither then touches the other's, which are its row and those beside it; and where
// halves meet, the lower one comes to the row that they share up to two waves after the upper one.
#define LAG 3

// Sweeps that run interleaved: of a narrow cloth enough independent work for a processor that waits for each sweep's
// last result; threads, which are to meet at few rows, and wide cloths take fewer.
#define DEPTH 4
#define DEPTH_WIDE 2
// Bytes that a core's first cache holds at least.
#define FIRST_CACHE (1 << 15)
// Rows of a half at least that are worth a thread: each sweep waits twice for the other half.
#define LEAST_PLACES 16

static int at_least(int depth, int least) {
    return depth > least ? depth : least;
}

static int at_most(int depth, int most) {
    return depth < most ? depth : most;
}

static size_t row_bytes(const ck_ProjectedCloth *cloth) {
    return 6 * sizeof(ck_Real) * (size_t)cloth->rows.stride;
}

static void set(int *ends, int first, int second) {
    ends[0] = first;
    ends[1] = second;
}

// Springs straight down come with the row below.
static void end_down(const ck_ProjectedCloth *cloth, int row, int *ends) {
    const bool is_late = cloth->rule.projection == CK_PROJECT_SPRINGS;
    set(ends, row - is_late, is_late && row + 1 == cloth->rows.rows ? row : -1);
}

// Sweeps down the rows: a substep's first one finds the row below begun.
static void run_down(void *state, long block, int wave) {
    const ck_ProjectedCloth *cloth = state;
    const int rows = cloth->rows.rows;
    // what is not set is not read
    ck_Visits visits;
    visits.count = 0;
    visits.is_turned = false;
    for (int i = 0; i < cloth->depth; i++) {
        const int row = wave - LAG * i;
        const long sweep = block * cloth->depth + i;
        if (row < 0 || row >= rows || sweep >= cloth->sweeps) continue;
        const bool begins = sweep % cloth->rule.iterations == 0;
        if (cloth->head.contact) end_down(cloth, row, visits.ends[visits.count]);
        visits.at[visits.count++] =
            (ck_Visit){sweep, row, {begins && row == 0 ? 0 : -1, begins && row + 1 < rows ? row + 1 : -1}};
    }
    cloth->loops->projection_visits(cloth, &visits);
}

static void step_down(ck_ProjectedCloth *cloth, ck_Waves *waves) {
    const ck_Rows *rows = &cloth->rows;
    if (!ck_rows_are_shared(rows)) waves = NULL;
    const bool is_shared = ck_waves_are_shared(waves);
    const int depth = ck_waves_depth(is_shared ? waves : NULL, cloth->sweeps, rows->rows, LAG, row_bytes(cloth));
    cloth->depth = at_most(at_least(depth, is_shared || ck_rows_are_wide(rows) ? DEPTH_WIDE : DEPTH), CK_MOST_VISITS);
    // a block's first sweep reads the row below it as the last sweep of the block before left it
    const int reach = LAG * (cloth->depth - 1) + 2;
    ck_waves_run(waves, &(ck_WaveWork){run_down, cloth, (cloth->sweeps + cloth->depth - 1) / cloth->depth,
                                       rows->rows + reach - 2, reach, cloth->sweeps});
}

// Sweeps both ways: from the first row and from the last one to the middle, and then the same back, so that what a
// substep does is a product of steps and their transposes. The halves share a row, which the lower one comes to when
// the upper one is done.
typedef enum Half { UPPER, LOWER } Half;

typedef struct BothWays {
    const ck_ProjectedCloth *cloth;
    int in, out;       // sweeps to the middle, and back, of a substep
    int upper, places; // rows of the upper half, and of the lower half
    int lag;           // places between a sweep and the next
    bool follow;       // sweeps share rows, and come one by one
    int behind;        // places by which the upper half is behind the lower one
    int waves[2];      // of those in, and of those out
} BothWays;

// The sweeps that are under way at a step: first to end, of those in or of those out.
typedef struct Stage {
    long sweep; // the number of that way's first one
    int wave, first, end;
    bool is_out;
} Stage;

static Stage stage_at(const BothWays *ways, long step) {
    const int waves = ways->waves[0] + ways->waves[1];
    Stage stage = {.sweep = step / waves * (ways->in + ways->out), .wave = (int)(step % waves)};
    stage.is_out = stage.wave >= ways->waves[0];
    if (stage.is_out) stage.wave -= ways->waves[0], stage.sweep += ways->in;
    const int before = stage.wave - ways->places + ways->lag;
    stage.first = before > 0 ? before / ways->lag : 0;
    stage.end = at_most(stage.wave / ways->lag + 1, stage.is_out ? ways->out : ways->in);
    return stage;
}

// How far from its edge a half's sweep is, in rows; less than 0 or beyond its last one where it is not under way.
static int place_of(const BothWays *ways, const Stage *stage, Half half, int sweep) {
    const int gone = stage->wave - ways->lag * sweep, place = stage->is_out ? ways->places - 1 - gone : gone;
    return half == UPPER ? place - ways->behind : place;
}

static ck_Visit visit_upper(const BothWays *ways, long sweep, int place) {
    const bool begins = sweep % (ways->in + ways->out) == 0;
    return (ck_Visit){sweep, place, {begins && place == 0 ? 0 : -1, begins ? place + 1 : -1}};
}

static void end_upper(int place, bool is_out, int *ends) {
    set(ends, place + is_out, is_out && place == 0 ? 0 : -1);
}

// The upper half, where there is one, has begun the row that both share, and on the way back is the last to leave it.
static ck_Visit visit_lower(const BothWays *ways, long sweep, int place) {
    const int row = ways->cloth->rows.rows - 1 - place;
    const bool begins = sweep % (ways->in + ways->out) == 0 && (row > ways->upper || ways->upper == 0);
    return (ck_Visit){sweep, row, {begins ? row : -1, -1}};
}

static void end_lower(const BothWays *ways, int place, bool is_out, int *ends) {
    const int rows = ways->cloth->rows.rows, row = rows - 1 - place;
    const bool leaves = is_out ? row > ways->upper || ways->upper == 0 : row == ways->upper;
    set(ends, !is_out && row + 1 < rows ? row + 1 : -1, leaves ? row : -1);
}

// Of sweeps that share rows, each comes when the one before is done there. Else the outermost come first, from either
// end: sweeps one after the other would be rows as far apart each, and a processor that sees them fetches the next ones
// so far on, of the other half, out of the cache of who works on it.
static int sweep_at(const BothWays *ways, const Stage *stage, int turn) {
    if (ways->follow) return stage->first + turn;
    return turn % 2 ? stage->end - 1 - turn / 2 : stage->first + turn / 2;
}

static void add_visits(const BothWays *ways, const Stage *stage, Half half, ck_Visits *visits) {
    for (int turn = 0; turn < stage->end - stage->first; turn++) {
        const int i = sweep_at(ways, stage, turn), place = place_of(ways, stage, half, i);
        int *ends = visits->ends[visits->count];
        if (half == UPPER && (place < 0 || place >= ways->upper)) continue;
        visits->at[visits->count++] =
            half == UPPER ? visit_upper(ways, stage->sweep + i, place) : visit_lower(ways, stage->sweep + i, place);
        if (!ways->cloth->head.contact) continue;
        if (half == UPPER)
            end_upper(place, stage->is_out, ends);
        else
            end_lower(ways, place, stage->is_out, ends);
    }
}

static void run_both_ways(void *state, long step, bool runs_upper, bool runs_lower) {
    const BothWays *ways = state;
    const Stage stage = stage_at(ways, step);
    ck_Visits visits;
    visits.count = 0;
    visits.is_turned = stage.is_out;
    if (runs_lower && stage.is_out) add_visits(ways, &stage, LOWER, &visits);
    if (runs_upper) add_visits(ways, &stage, UPPER, &visits);
    if (runs_lower && !stage.is_out) add_visits(ways, &stage, LOWER, &visits);
    ways->cloth->loops->projection_visits(ways->cloth, &visits);
}

// On the way in the upper half is the first at the row that both share, on the way out the lower one. What the other
// has done there before is a sweep ago, or as long ago as its own way from there to here is longer; at the turn, and
// where a substep begins, a half finds what it left itself.
static bool meets_other(void *state, long step, int half, long *needs) {
    const BothWays *ways = state;
    const Stage stage = stage_at(ways, step);
    const int last = half == UPPER ? ways->upper - 1 : ways->places - 1, further = ways->places - ways->upper;
    for (int i = stage.first; i < stage.end; i++) {
        if (place_of(ways, &stage, (Half)half, i) != last) continue;
        const bool is_second = (half == LOWER) != stage.is_out;
        if (is_second)
            *needs = step + 1 - further;
        else if (i > 0)
            *needs = step + 1 - ways->lag + further;
        return true;
    }
    return false;
}

// A cloth beyond the second cache has its sweeps close together, so that it comes to it but once; so has one that two
// threads share, so that each has few rows at hand; else as many are under way as the first cache holds the rows of.
static int lag_of(const ck_ProjectedCloth *cloth, int places, int sweeps, bool is_shared) {
    const size_t bytes = row_bytes(cloth), together = 2 * LAG * bytes;
    const bool is_close = is_shared || ck_waves_depth(NULL, sweeps, cloth->rows.rows, LAG, bytes) > 1;
    const int depth = (int)((FIRST_CACHE + together - 1) / together),
              lag = is_close ? LAG : at_least((places + depth - 1) / depth, LAG);
    return at_least(lag, (2 * places + CK_MOST_VISITS - 1) / CK_MOST_VISITS);
}

// A wide cloth's visits come one by one (run_colours), so that a sweep may take the row that the one before has just
// left and the first cache still holds. With contact rows end after all visits of a wave, which are to share none.
static bool follow_at_once(const ck_ProjectedCloth *cloth, int sweeps, bool is_shared) {
    return !is_shared && !cloth->head.contact && ck_rows_are_wide(&cloth->rows) && 2 * sweeps <= CK_MOST_VISITS;
}

static void step_both_ways(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    const int rows = cloth->rows.rows, sweeps = (int)cloth->rule.iterations;
    BothWays ways = {.cloth = cloth, .out = sweeps / 2, .upper = (rows - 1) / 2};
    ways.in = sweeps - ways.out;
    ways.places = rows - ways.upper;
    if (ways.places < LEAST_PLACES) waves = NULL;
    const bool is_shared = ck_waves_are_shared(waves);
    ways.lag = lag_of(cloth, ways.places, ways.in, is_shared);
    ways.follow = follow_at_once(cloth, ways.in, is_shared);
    if (ways.follow) {
        ways.lag = 1;
        ways.behind = ways.places - ways.upper; // both come to the row that they share in one step
    }
    ways.waves[0] = ways.places + ways.lag * (ways.in - 1);
    ways.waves[1] = ways.places + ways.lag * (ways.out - 1);
    ck_waves_run_halves(waves, &(ck_HalvesWork){run_both_ways, meets_other, &ways,
                                                (long)substeps * (ways.waves[0] + ways.waves[1]), cloth->sweeps});
}

static void follow(ck_ProjectedCloth *cloth) {
    const ck_Real shift[] = {cloth->start[0], cloth->start[CK_STRIPE], cloth->start[2 * CK_STRIPE]};
    if (ck_origin_follows(cloth->origin, shift, cloth->size)) ck_rows_shift(&cloth->rows, cloth->start, shift);
}

void ck_projection_run(ck_ProjectedCloth *cloth, uint32_t substeps, ck_Waves *waves) {
    cloth->sweeps = (long)substeps * cloth->rule.iterations;
#ifdef CK_SINGLE
    ck_sixteens_see(&cloth->head, cloth->origin, cloth->size);
#endif
    if (cloth->rule.iterations == 1 || cloth->rule.projection == CK_PROJECT_SPRINGS)
        step_down(cloth, waves);
    else
        step_both_ways(cloth, substeps, waves);
    if (CK_IS_SINGLE) follow(cloth);
}
