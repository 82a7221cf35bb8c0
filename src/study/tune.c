#include "tune.h"

#include "process.h"
#include "tune_grid.h"
#include "tune_search.h"

#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Evaluations of the global search, of the local one that starts from its best, of the one over whole numbers, and of
// all that would be cheaper.
#define GLOBAL 80
#define LOCAL 60
#define REFINING 240
#define EXHAUSTING 800
// Powers of two of substeps and of iterations that a climb goes up to.
#define MOST_POWERS 16
_Static_assert(GLOBAL + LOCAL + REFINING + EXHAUSTING + MOST_POWERS * MOST_POWERS < CK_TUNE_MOST_POINTS,
               "room for all");
// A climb ends where so many settings in a row cost more than a frame may, or where the least error so far took so much
// less work.
#define DEAR_IN_A_ROW 3
#define FUTILE 8

// How far a variable may go, in powers of two or, for relaxation, as it is.
typedef struct Range {
    int variable;
    double low, high;
} Range;

typedef struct Search {
    ck_TuneSearch tried;
    ck_Settings automatic;
    Range ranges[CK_TUNE_VARIABLES];
    int range_count;
    int jobs;
} Search;

static double work_of(const Search *search, const ck_Settings *settings) {
    return settings->substeps * (1 + fmax(1, settings->iterations)) / search->tried.comparison->model.step;
}

static bool is_whole(int variable) {
    return variable == CK_SUBSTEPS || variable == CK_ITERATIONS;
}

static ck_TunePoint point_at(const Search *search, const double *x) {
    ck_TunePoint point = {.settings = search->automatic, .stiffness = 1};
    for (int i = 0; i < search->range_count; i++) {
        const Range *range = &search->ranges[i];
        double value = range->low + x[i] * (range->high - range->low);
        if (range->variable != CK_RELAXATION) value = exp2(value);
        if (range->variable == CK_TUNE_STIFFNESS)
            point.stiffness = value;
        else
            ck_settings_set(&point.settings, range->variable,
                            is_whole(range->variable) ? fmax(1, round(value)) : value);
    }
    point.work = work_of(search, &point.settings);
    return point;
}

// The number of a point among those tried, negative where there is none.
static int try_point(Search *search, const ck_TunePoint *point) {
    int index;
    ck_tune_try(&search->tried, point, 1, &index);
    return index;
}

static const ck_TunePoint *best_of(const Search *search) {
    return search->tried.point_count ? &search->tried.points[search->tried.best] : NULL;
}

static bool is_over(const Search *search) {
    return search->tried.status || search->tried.is_late;
}

// NLopt's.
static double objective(unsigned count, const double *x, double *gradient, void *context) {
    (void)count;
    (void)gradient; // none of the methods asks for it
    Search *search = context;
    ck_TunePoint point = point_at(search, x);
    const ck_TunePoint *best = best_of(search);
    // dearer than one that is within the bounds: no run could make it better than this
    if (best && ck_tune_has_bound(&search->tried.options->goal) && ck_tune_meets(&search->tried, best) &&
        point.work > best->work)
        return log(point.work);
    int index = try_point(search, &point);
    return index < 0 ? CK_TUNE_FAILED : search->tried.values[index];
}

// Relaxations to try at each pair of substeps and iterations: that of the best so far, then over their range.
static const double relaxations[] = {0, 1, 1.2, 1.4, 1.5, 1.6, 1.8};

static ck_TunePoint grid_point(const Search *search, uint32_t substeps, uint32_t iterations, int variant) {
    ck_TunePoint point = *best_of(search);
    point.settings.substeps = substeps;
    if (search->automatic.iterations) point.settings.iterations = iterations;
    if (variant) point.settings.relaxation = relaxations[variant];
    point.work = work_of(search, &point.settings);
    return point;
}

static bool meets_at(void *context, uint32_t substeps, uint32_t iterations, int variant) {
    Search *search = context;
    ck_TunePoint point = grid_point(search, substeps, iterations, variant);
    int index = try_point(search, &point);
    return index >= 0 && ck_tune_meets(&search->tried, &search->tried.points[index]);
}

static void try_ahead(void *context, const ck_TunePair *pairs, int count) {
    Search *search = context;
    ck_TunePoint points[CK_TUNE_MOST_BATCH];
    int indices[CK_TUNE_MOST_BATCH];
    for (int i = 0; i < count; i++) points[i] = grid_point(search, pairs[i].substeps, pairs[i].iterations, 0);
    ck_tune_try(&search->tried, points, count, indices);
}

// Works on whole numbers, which NLopt's methods do not know of.
static void search_grid(Search *search, ck_Tuning *tuning) {
    const ck_TunePoint *best = best_of(search);
    if (!best || !ck_tune_meets(&search->tried, best)) return;
    ck_TuneGrid grid = {.has_iterations = search->automatic.iterations > 0,
                        .variant_count =
                            search->automatic.relaxation > 0 ? sizeof relaxations / sizeof *relaxations : 1,
                        .work = best->settings.substeps * (1 + fmax(1, best->settings.iterations)),
                        .iterations = (uint32_t)fmax(1, best->settings.iterations),
                        .most_tries = REFINING,
                        .batch = search->jobs,
                        .meets = meets_at,
                        .try_ahead = try_ahead,
                        .context = search};
    ck_tune_grid_refine(&grid);
    grid.most_tries = grid.tries + EXHAUSTING;
    tuning->is_cheapest = ck_tune_grid_exhaust(&grid) && !is_over(search);
}

static int compare_pairs(const void *a, const void *b) {
    const ck_TunePair *one = a, *other = b;
    double x = one->substeps * (1.0 + one->iterations), y = other->substeps * (1.0 + other->iterations);
    if (x != y) return x < y ? -1 : 1;
    return (one->substeps < other->substeps) - (one->substeps > other->substeps);
}

// Powers of two of both, the cheapest first.
static int list_pairs(const Search *search, ck_TunePair *pairs) {
    int count = 0;
    double most_substeps = exp2(search->ranges[0].high),
           most_iterations = search->automatic.iterations ? exp2(search->ranges[1].high) : 1;
    for (uint32_t substeps = 1, i = 0; substeps <= most_substeps && i < MOST_POWERS; substeps *= 2, i++)
        for (uint32_t iterations = 1, k = 0; iterations <= most_iterations && k < MOST_POWERS; iterations *= 2, k++)
            pairs[count++] = (ck_TunePair){substeps, iterations};
    qsort(pairs, (size_t)count, sizeof *pairs, compare_pairs);
    return count;
}

// Whether a climb goes no further: the cheapest within the bounds is found, or all that follow cost too much, or more
// work has not helped.
static bool ends_climb(const Search *search, int index, int *dear) {
    const ck_TuneGoal *goal = &search->tried.options->goal;
    const ck_TunePoint *point = &search->tried.points[index];
    if (ck_tune_has_bound(goal) && ck_tune_meets(&search->tried, point)) return true;
    if (!ck_tune_has_bound(goal) && point->work > FUTILE * best_of(search)->work) return true;
    bool is_dear = ck_tune_frame_cost(point, &search->tried.comparison->model) > goal->frame;
    *dear = is_dear ? *dear + 1 : 0;
    return *dear == DEAR_IN_A_ROW;
}

// From the cheapest pair on, as many side by side as there are jobs: what is dearer than the goal is not run.
static void climb(Search *search) {
    ck_TunePair pairs[MOST_POWERS * MOST_POWERS];
    int count = list_pairs(search, pairs), dear = 0;
    bool has_ended = false;
    for (int i = 0; i < count && !is_over(search) && !has_ended; i += search->jobs) {
        ck_TunePoint points[CK_TUNE_MOST_BATCH];
        int indices[CK_TUNE_MOST_BATCH], batch = i + search->jobs < count ? search->jobs : count - i;
        for (int k = 0; k < batch; k++) {
            points[k] = (ck_TunePoint){.settings = search->automatic, .stiffness = 1};
            points[k].settings.substeps = pairs[i + k].substeps;
            if (search->automatic.iterations) points[k].settings.iterations = pairs[i + k].iterations;
            points[k].work = work_of(search, &points[k].settings);
        }
        ck_tune_try(&search->tried, points, batch, indices);
        for (int k = 0; k < batch && !has_ended; k++)
            has_ended = indices[k] >= 0 && ends_climb(search, indices[k], &dear);
    }
}

static void add_range(Search *search, int variable, double low, double high) {
    search->ranges[search->range_count++] = (Range){variable, low, high};
}

// From one to 32 times as many of what is counted; what is given in numbers, around what theory would set.
static void find_ranges(Search *search) {
    const ck_Settings *automatic = &search->automatic;
    const ck_TuneOptions *options = search->tried.options;
    const ck_Model *model = &search->tried.comparison->model;
    double stiffness = model->spring_count ? model->springs[0].stiffness : 1;
    add_range(search, CK_SUBSTEPS, 0, log2(automatic->substeps) + 5);
    if (automatic->iterations) add_range(search, CK_ITERATIONS, 0, fmax(7, log2(automatic->iterations) + 2));
    if (automatic->relaxation > 0) add_range(search, CK_RELAXATION, 0.8, 1.9);
    // a share where it ends at 1, as kLST; else a compliance
    const ck_Setting *softness = ck_engine_setting(options->engine, CK_SOFTNESS);
    if (options->varies_softness && softness->most <= 1)
        add_range(search, CK_SOFTNESS, -10, 0);
    else if (options->varies_softness)
        add_range(search, CK_SOFTNESS, -log2(stiffness) - 4, -log2(stiffness) + 4);
    if (options->varies_stiffness) add_range(search, CK_TUNE_STIFFNESS, -3, 3);
}

static ck_Status search_with(Search *search, nlopt_algorithm algorithm, int evaluations, double *x) {
    nlopt_opt opt = nlopt_create(algorithm, (unsigned)search->range_count);
    double value;
    if (!opt) return ck_fail(search->tried.error, CK_NO_MEMORY, "out of memory");
    nlopt_set_min_objective(opt, objective, search);
    nlopt_set_lower_bounds1(opt, 0);
    nlopt_set_upper_bounds1(opt, 1);
    nlopt_set_initial_step1(opt, 0.1);
    nlopt_set_maxeval(opt, evaluations);
    nlopt_set_xtol_abs1(opt, 1e-3);
    nlopt_optimize(opt, x, &value);
    nlopt_destroy(opt);
    return search->tried.status;
}

// Where the settings of a point stand between their bounds, 0 to 1.
static void place(const Search *search, const ck_TunePoint *point, double *x) {
    for (int i = 0; i < search->range_count; i++) {
        const Range *range = &search->ranges[i];
        double value = range->variable == CK_TUNE_STIFFNESS ? point->stiffness
                                                            : ck_settings_get(&point->settings, range->variable);
        // what has no value yet starts in the middle, which is theory's
        if (!(value > 0)) {
            x[i] = 0.5;
            continue;
        }
        if (range->variable != CK_RELAXATION) value = log2(value);
        x[i] = fmin(1, fmax(0, (value - range->low) / (range->high - range->low)));
    }
}

static void name_bounds(const Search *search, ck_Tuning *tuning) {
    double x[CK_TUNE_VARIABLES];
    size_t used = 0;
    place(search, &tuning->best, x);
    for (int i = 0; i < search->range_count; i++) {
        int variable = search->ranges[i].variable;
        bool is_one = x[i] < 0.5 && is_whole(variable);
        if ((x[i] > 0.001 && x[i] < 0.999) || is_one) continue; // none is less than one
        used += (size_t)snprintf(
            tuning->bounds + used, sizeof tuning->bounds - used, "%s%s at its %s bound", used ? "; " : "",
            variable == CK_TUNE_STIFFNESS ? "stiffness"
                                          : ck_engine_setting(search->tried.options->engine, variable)->name,
            x[i] < 0.5 ? "lower" : "upper");
    }
}

// The path that the goal is like, on a scene. Errors: CK_REFUSED where the engine has none, CK_NO_MEMORY, CK_IO.
static ck_Status run_like(ck_Run *like, const ck_Comparison *comparison, const ck_TuneOptions *options,
                          ck_Error *error) {
    const ck_Engine *engine = options->goal.like;
    ck_Status status = ck_run_measure(like, &comparison->model, engine, &(ck_Settings){0}, &options->limits, error);
    if (status || ck_run_has_all_frames(like)) return status;
    return ck_fail(error, CK_REFUSED, "%s: %s has no path to come close to: %s", comparison->path, engine->name,
                   like->reason);
}

// The same time step on another scene, and its error there.
static ck_Status validate(const Search *search, ck_Tuning *tuning, const char *path, ck_Error *error) {
    ck_Comparison other = {0};
    ck_Run like = {0};
    const ck_TuneOptions *options = search->tried.options;
    ck_Status status = ck_comparison_load(&other, path, error);
    if (!status) status = ck_truth_create(&other.truth, &other.model, options->cache, &options->limits, error);
    if (!status && options->goal.like) status = run_like(&like, &other, options, error);
    if (!status) {
        ck_TuneValidation *validation = &tuning->validations[tuning->validation_count++];
        ck_TrialGoal aim = options->goal.aim;
        if (options->goal.like) aim.path = &like.trajectory;
        validation->point = tuning->best;
        ck_TunePoint *point = &validation->point;
        snprintf(validation->scene, sizeof validation->scene, "%s", other.model.name);
        point->settings.substeps = (uint32_t)fmax(1, round(other.model.step / tuning->best.trial.time_step));
        point->work *= point->settings.substeps / other.model.step /
                       (tuning->best.settings.substeps / search->tried.comparison->model.step);
        status = ck_tune_run_on(point, &other, &aim, options, error);
        bool is_path = aim.path || !other.truth.reference.is_static;
        point->static_error = is_path ? point->trial.sag_error : point->trial.error;
        point->dynamic_error = is_path ? point->trial.error : NAN;
        if (!status)
            ck_tune_add_row(search->tried.csv, &other.model, options, "validation", point,
                            ck_tune_meets(&search->tried, point), "");
    }
    ck_run_free(&like);
    ck_comparison_free(&other);
    return status;
}

// What the reference has left of the release at the end of the scene is among the ends of a truth at rest.
static ck_Status check_rest(const Search *search, ck_Error *error) {
    const ck_Comparison *comparison = search->tried.comparison;
    double tolerance = search->tried.options->goal.error,
           left = ck_truth_uncertainty(&comparison->truth, &comparison->model, ck_metric_find("position_rms"));
    if (!comparison->truth.reference.is_static || !(left > tolerance)) return CK_OK;
    return ck_fail(
        error, CK_BAD_INPUT,
        "%s: the scene is still %.2g of its size from rest after %g s, so that no engine comes within %g of it; "
        "take a longer time.duration, more drag, or truth: trajectory",
        comparison->path, left, comparison->model.duration, tolerance);
}

static ck_Status prepare(Search *search, ck_Error *error) {
    ck_TuneSearch *tried = &search->tried;
    const ck_TuneGoal *goal = &tried->options->goal;
    const ck_Reference *truth = &tried->comparison->truth.reference;
    bool is_to_truth = !goal->like && !goal->aim.path && !goal->aim.metric;
    // a stretch alone needs no truth
    bool needs_positions = is_to_truth && (!isnan(goal->error) || isnan(goal->stretch));
    if (needs_positions && (!truth->trajectory.frame_count || truth->is_invariant))
        return ck_fail(error, CK_BAD_INPUT,
                       "%s: its truth has no positions to come close to; give --like ENGINE or FILE, --stretch or "
                       "--target METRIC=VALUE",
                       tried->comparison->path);
    ck_Status status = ck_run_automatic(tried->options->engine, &tried->comparison->model, &tried->options->given,
                                        &tried->options->limits, &search->automatic, error);
    if (status) return status;
    find_ranges(search);
    tried->aim = goal->aim;
    double known =
        ck_truth_uncertainty(&tried->comparison->truth, &tried->comparison->model, ck_metric_find("position_rms"));
    tried->uncertainty = is_to_truth && known > 0 ? known : 0;
    if (!goal->like) return is_to_truth ? check_rest(search, error) : CK_OK;
    status = run_like(&tried->like, tried->comparison, tried->options, error);
    tried->aim.path = &tried->like.trajectory;
    return status;
}

static ck_Status conclude(Search *search, ck_Tuning *tuning, ck_Error *error) {
    ck_TuneSearch *tried = &search->tried;
    const ck_TuneOptions *options = tried->options;
    if (!tried->point_count || tried->values[tried->best] >= CK_TUNE_FAILED)
        return ck_fail(error, CK_REFUSED, "%s: none of %d settings of %s ran to its end%s", tried->comparison->path,
                       tried->point_count, options->engine->name,
                       tried->is_late ? " in time; --timeout gives it longer" : "");
    tuning->points = malloc(sizeof *tuning->points * (size_t)tried->point_count);
    tuning->validations = calloc((size_t)options->validate_count + 1, sizeof *tuning->validations);
    if (!tuning->points || !tuning->validations) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    memcpy(tuning->points, tried->points, sizeof *tuning->points * (size_t)tried->point_count);
    tuning->point_count = tried->point_count;
    tuning->best = *best_of(search);
    tuning->best_index = tried->best;
    tuning->uncertainty = tried->uncertainty;
    tuning->is_late = tried->is_late;
    tuning->meets = ck_tune_meets(tried, &tuning->best);
    name_bounds(search, tuning);
    ck_tune_add_row(tried->csv, &tried->comparison->model, options, "best", &tuning->best, tuning->meets,
                    tuning->bounds);
    ck_Status status = CK_OK;
    for (int i = 0; i < options->validate_count && !status; i++)
        status = validate(search, tuning, options->validate[i], error);
    return status;
}

static ck_Status search_all(Search *search, ck_Tuning *tuning) {
    const ck_TuneOptions *options = search->tried.options;
    const ck_TuneGoal *goal = &options->goal;
    bool has_bound = ck_tune_has_bound(goal), climbs = !options->varies_softness && !options->varies_stiffness;
    double x[CK_TUNE_VARIABLES];
    ck_Status status = CK_OK;
    if (climbs)
        climb(search);
    else {
        // first what the engine's own rule sets, then everywhere
        place(search, &(ck_TunePoint){.settings = search->automatic, .stiffness = 1}, x);
        objective((unsigned)search->range_count, x, NULL, search);
        status = search_with(search, NLOPT_GN_DIRECT_L, GLOBAL, x);
    }
    // then around the best
    if (!status && best_of(search) && (!climbs || !has_bound)) {
        place(search, best_of(search), x);
        status = search_with(search, NLOPT_LN_SBPLX, LOCAL, x);
    }
    if (!status && has_bound) search_grid(search, tuning);
    return status ? status : search->tried.status;
}

ck_Status ck_tune_run(ck_Tuning *tuning, const ck_Comparison *comparison, const ck_TuneOptions *options, ck_Csv *csv,
                      ck_Error *error) {
    *tuning = (ck_Tuning){0};
    Search *search = calloc(1, sizeof *search);
    if (!search) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    long jobs = options->jobs > 0 ? options->jobs : sysconf(_SC_NPROCESSORS_ONLN);
    // side by side they would slow each other down where time is what is asked for
    if (!isnan(options->goal.frame) || jobs < 1) jobs = 1;
    search->jobs = jobs < CK_TUNE_MOST_BATCH ? (int)jobs : CK_TUNE_MOST_BATCH;
    ck_TuneSearch *tried = &search->tried;
    tried->comparison = comparison;
    tried->options = options;
    tried->csv = csv;
    tried->journal.file = -1;
    tried->deadline = ck_wall() + options->timeout;
    tried->error = error;
    ck_Status status = prepare(search, error);
    if (!status) status = ck_tune_search_open(tried, error);
    if (!status) status = search_all(search, tuning);
    if (!status) status = conclude(search, tuning, error);
    // what a search that ended early has tried is not run again
    ck_journal_close(&tried->journal, !status && !tried->is_late);
    ck_run_free(&tried->like);
    free(search);
    return status;
}

void ck_tuning_free(ck_Tuning *tuning) {
    free(tuning->points);
    free(tuning->validations);
    *tuning = (ck_Tuning){0};
}

bool ck_tuning_is_on_front(const ck_Tuning *tuning, int point) {
    const ck_TunePoint *one = &tuning->points[point];
    double error = fmax(one->trial.error, tuning->uncertainty);
    if (one->trial.status != CK_RUN_OK || !(one->trial.error >= 0)) return false;
    for (int i = 0; i < tuning->point_count; i++) {
        const ck_TunePoint *other = &tuning->points[i];
        if (other->trial.status != CK_RUN_OK || i == point) continue;
        bool errs_less = fmax(other->trial.error, tuning->uncertainty) <= 1.02 * error;
        bool is_less = other->work < one->work ||
                       (other->work == one->work && (other->trial.error < one->trial.error ||
                                                     (other->trial.error == one->trial.error && i < point)));
        if (is_less && errs_less) return false;
    }
    return true;
}
