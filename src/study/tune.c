#include "tune.h"

#include "process.h"
#include "tune_grid.h"

#include <math.h>
#include <nlopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Evaluations of the global search, of the local one that starts from its best, of the one over whole numbers, and of
// all that would be cheaper.
#define GLOBAL 80
#define LOCAL 60
#define REFINING 240
#define EXHAUSTING 800
// Powers of two of substeps and of iterations that a climb goes up to.
#define MOST_POWERS 16
#define MOST_POINTS (GLOBAL + LOCAL + REFINING + EXHAUSTING + MOST_POWERS * MOST_POWERS + 1)
// A setting that fails, or misses the tolerance, counts as this much more work for each power of e.
#define PENALTY 20
#define FAILED 1e3

// How far a variable may go, in powers of two or, for relaxation, as it is.
typedef struct Range {
    int variable;
    double low, high;
} Range;

typedef struct Search {
    const ck_Comparison *comparison;
    const ck_TuneOptions *options;
    ck_Csv *csv;
    ck_Journal journal;
    ck_Settings automatic;
    Range ranges[CK_TUNE_VARIABLES];
    int range_count;
    ck_Run like; // its path, where options->like is set
    ck_TunePoint points[MOST_POINTS];
    double values[MOST_POINTS]; // of the objective
    int point_count, best;
    char keys[MOST_POINTS][256];
    ck_JournalRow kept[MOST_POINTS]; // of the journal
    char kept_keys[MOST_POINTS][256];
    int kept_count;
    double deadline; // of ck_wall
    bool is_late;
    ck_Status status;
    ck_Error *error;
} Search;

enum { ERROR, SAG_ERROR, STRETCH_ERROR, CPU, TIME_STEP };

static bool value_name(int index, char *name, size_t size) {
    static const char *const names[] = {"error", "sag_error", "stretch_error", "cpu_s", "time_step_s"};
    if (index >= (int)(sizeof names / sizeof *names)) return false;
    snprintf(name, size, "%s", names[index]);
    return true;
}

static double work_of(const Search *search, const ck_Settings *settings) {
    return settings->substeps * (1 + fmax(1, settings->iterations)) / search->comparison->model.step;
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

// The errors are measured on the scene as it is, whatever stiffness the engine was given.
static ck_Status try_on(ck_TunePoint *point, const ck_Comparison *comparison, const ck_Run *like,
                        const ck_TuneOptions *options, ck_Error *error) {
    ck_Model model = comparison->model;
    ck_Spring *springs = malloc(sizeof *springs * (size_t)model.spring_count + 1);
    if (!springs) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_model_scale_stiffness(&model, springs, point->stiffness);
    const ck_Trajectory *against = like ? &like->trajectory : NULL;
    ck_Status status = ck_trial_run(&point->trial, &model, &comparison->truth.reference, against, options->engine,
                                    &point->settings, 0, &options->limits, error);
    free(springs);
    return status;
}

// At rest and on the way, apart: a truth at rest knows nothing of the way.
static void split_errors(ck_TunePoint *point, const ck_Truth *truth, bool is_like) {
    bool is_path = is_like || !truth->reference.is_static;
    point->static_error = is_path ? point->trial.sag_error : point->trial.error;
    point->dynamic_error = is_path ? point->trial.error : NAN;
}

static void take_kept(void *context, const char *key, const ck_JournalRow *row) {
    Search *search = context;
    if (search->kept_count == MOST_POINTS) return;
    snprintf(search->kept_keys[search->kept_count], sizeof search->kept_keys[0], "%s", key);
    search->kept[search->kept_count++] = *row;
}

static void write_key(char *key, size_t size, const ck_Engine *engine, const ck_TunePoint *point) {
    size_t used = (size_t)snprintf(key, size, "stiffness %.17g", point->stiffness);
    for (const ck_Setting *row = engine->settings; row && row->name && used < size; row++)
        used += (size_t)snprintf(key + used, size - used, " %s %.17g", row->name,
                                 ck_settings_get(&point->settings, row->slot));
}

// From the journal where it is there, else by running it.
static ck_Status evaluate(Search *search, ck_TunePoint *point, const char *key) {
    for (int i = 0; i < search->kept_count; i++) {
        if (strcmp(search->kept_keys[i], key)) continue;
        const ck_JournalRow *row = &search->kept[i];
        const double *values = row->values;
        point->trial = (ck_Trial){.status = row->status,
                                  .error = values[ERROR],
                                  .sag_error = values[SAG_ERROR],
                                  .stretch_error = values[STRETCH_ERROR],
                                  .cpu = values[CPU],
                                  .time_step = values[TIME_STEP]};
        snprintf(point->trial.reason, sizeof point->trial.reason, "%s", row->reason);
        return CK_OK;
    }
    const ck_Run *like = search->options->like ? &search->like : NULL;
    // no run outlasts the search
    ck_TuneOptions options = *search->options;
    options.limits.seconds = fmin(options.limits.seconds, fmax(1, search->deadline - ck_wall()));
    ck_Status status = try_on(point, search->comparison, like, &options, search->error);
    if (status) return status;
    // cut by the end of the search, not by its own limit: nothing is known of it
    search->is_late |=
        point->trial.status == CK_RUN_TIMED_OUT && options.limits.seconds < search->options->limits.seconds;
    if (search->is_late) return CK_OK;
    const ck_Trial *trial = &point->trial;
    ck_JournalRow row = {.status = (int)trial->status};
    for (int i = 0; i < CK_JOURNAL_VALUES; i++) row.values[i] = NAN;
    const double values[] = {trial->error, trial->sag_error, trial->stretch_error, trial->cpu, trial->time_step};
    memcpy(row.values, values, sizeof values);
    snprintf(row.reason, sizeof row.reason, "%s", trial->reason);
    return ck_journal_add(&search->journal, key, &row, search->error);
}

// The logarithm of the work, or of the error: what is searched for.
static double value_of(const Search *search, const ck_TunePoint *point) {
    double error = point->trial.error, tolerance = search->options->tolerance;
    if (point->trial.status != CK_RUN_OK || !(error >= 0)) return FAILED;
    if (isnan(tolerance)) return log(fmax(error, 1e-16));
    // capped, so that whatever runs is better than what does not; of two that cost the same, the closer one
    return log(point->work) + 1e-6 * fmin(1, error / tolerance) +
           fmin(0.5 * FAILED, PENALTY * fmax(0, log(error / tolerance)));
}

static void add_row(ck_Csv *csv, const ck_Model *model, const ck_TuneOptions *options, const char *role,
                    const ck_TunePoint *point, const char *bounds) {
    const char *const names[] = {"substeps", "iterations", "relaxation", "compliance", "klst"};
    ck_csv_text(csv, model->name);
    ck_csv_text(csv, options->engine->name);
    ck_csv_text(csv, role);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const ck_Setting *row = ck_setting_find(options->engine->settings, names[i]);
        ck_csv_number(csv, row ? ck_settings_get(&point->settings, row->slot) : 0);
    }
    ck_csv_number(csv, point->stiffness);
    ck_csv_text(csv, ck_run_status_names[point->trial.status]);
    ck_csv_text(csv, point->trial.reason);
    ck_csv_number(csv, point->trial.error);
    ck_csv_number(csv, point->static_error);
    ck_csv_number(csv, point->dynamic_error);
    ck_csv_number(csv, options->tolerance);
    bool is_met = point->trial.status == CK_RUN_OK && point->trial.error <= options->tolerance;
    ck_csv_text(csv, isnan(options->tolerance) ? "" : is_met ? "yes" : "no");
    ck_csv_number(csv, point->work);
    ck_csv_number(csv, point->trial.cpu);
    ck_csv_text(csv, bounds);
}

// The number of a point among those tried, -1 where there is none. Settings already tried are not run again.
static int try_point(Search *search, ck_TunePoint *point) {
    char key[256];
    write_key(key, sizeof key, search->options->engine, point);
    for (int i = 0; i < search->point_count; i++)
        if (!strcmp(search->keys[i], key)) return i;
    search->is_late |= ck_wall() > search->deadline;
    if (search->status || search->is_late || search->point_count == MOST_POINTS) return -1;
    search->status = evaluate(search, point, key);
    if (search->status || search->is_late) return -1;
    split_errors(point, &search->comparison->truth, search->options->like != NULL);
    int index = search->point_count++;
    memcpy(search->keys[index], key, sizeof key);
    search->points[index] = *point;
    search->values[index] = value_of(search, point);
    if (search->values[index] < search->values[search->best]) search->best = index;
    add_row(search->csv, &search->comparison->model, search->options, "evaluation", point, "");
    if (search->options->progress)
        search->options->progress(search->point_count, search->points[search->best].trial.error);
    return index;
}

static bool meets(const Search *search, const ck_TunePoint *point) {
    return point->trial.status == CK_RUN_OK && point->trial.error <= search->options->tolerance;
}

// NLopt's.
static double objective(unsigned count, const double *x, double *gradient, void *context) {
    (void)count;
    (void)gradient; // none of the methods asks for it
    Search *search = context;
    ck_TunePoint point = point_at(search, x);
    // dearer than one that meets the tolerance: no run could make it better than this
    if (search->point_count && meets(search, &search->points[search->best]) &&
        point.work > search->points[search->best].work)
        return log(point.work);
    int index = try_point(search, &point);
    return index < 0 ? FAILED : search->values[index];
}

// Relaxations to try at each pair of substeps and iterations: that of the best so far, then over their range.
static const double relaxations[] = {0, 1, 1.2, 1.4, 1.5, 1.6, 1.8};

static bool meets_at(void *context, uint32_t substeps, uint32_t iterations, int variant) {
    Search *search = context;
    ck_TunePoint point = search->points[search->best];
    point.settings.substeps = substeps;
    if (search->automatic.iterations) point.settings.iterations = iterations;
    if (variant) point.settings.relaxation = relaxations[variant];
    point.work = work_of(search, &point.settings);
    int index = try_point(search, &point);
    return index >= 0 && meets(search, &search->points[index]);
}

// Works on whole numbers, which NLopt's methods do not know of.
static void search_grid(Search *search, ck_Tuning *tuning) {
    const ck_TunePoint *best = &search->points[search->best];
    if (!search->point_count || !meets(search, best)) return;
    ck_TuneGrid grid = {.has_iterations = search->automatic.iterations > 0,
                        .variant_count =
                            search->automatic.relaxation > 0 ? sizeof relaxations / sizeof *relaxations : 1,
                        .work = best->settings.substeps * (1 + fmax(1, best->settings.iterations)),
                        .iterations = (uint32_t)fmax(1, best->settings.iterations),
                        .most_tries = REFINING,
                        .meets = meets_at,
                        .context = search};
    ck_tune_grid_refine(&grid);
    grid.most_tries = grid.tries + EXHAUSTING;
    tuning->is_cheapest = ck_tune_grid_exhaust(&grid) && !search->status && !search->is_late;
}

// A pair of substeps and iterations, and its work in sweeps a frame.
typedef struct Pair {
    uint32_t substeps, iterations;
    double work;
} Pair;

static int compare_pairs(const void *a, const void *b) {
    const Pair *one = a, *other = b;
    if (one->work != other->work) return one->work < other->work ? -1 : 1;
    return (one->substeps < other->substeps) - (one->substeps > other->substeps);
}

// Powers of two of both, the cheapest first, until one meets the tolerance: what is dearer is not run.
static void climb(Search *search) {
    Pair pairs[MOST_POWERS * MOST_POWERS];
    int count = 0;
    double most_substeps = exp2(search->ranges[0].high),
           most_iterations = search->automatic.iterations ? exp2(search->ranges[1].high) : 1;
    for (uint32_t substeps = 1, i = 0; substeps <= most_substeps && i < MOST_POWERS; substeps *= 2, i++)
        for (uint32_t iterations = 1, k = 0; iterations <= most_iterations && k < MOST_POWERS; iterations *= 2, k++)
            pairs[count++] = (Pair){substeps, iterations, substeps * (1.0 + iterations)};
    qsort(pairs, (size_t)count, sizeof *pairs, compare_pairs);
    for (int i = 0; i < count && !search->status && !search->is_late; i++) {
        ck_TunePoint point = {.settings = search->automatic, .stiffness = 1};
        point.settings.substeps = pairs[i].substeps;
        if (search->automatic.iterations) point.settings.iterations = pairs[i].iterations;
        point.work = work_of(search, &point.settings);
        int index = try_point(search, &point);
        if (index >= 0 && meets(search, &search->points[index])) break;
    }
}

static void add_range(Search *search, int variable, double low, double high) {
    search->ranges[search->range_count++] = (Range){variable, low, high};
}

// From one to 32 times as many of what is counted; what is given in numbers, around what theory would set.
static void find_ranges(Search *search) {
    const ck_Settings *automatic = &search->automatic;
    const ck_TuneOptions *options = search->options;
    const ck_Model *model = &search->comparison->model;
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
    if (!opt) return ck_fail(search->error, CK_NO_MEMORY, "out of memory");
    nlopt_set_min_objective(opt, objective, search);
    nlopt_set_lower_bounds1(opt, 0);
    nlopt_set_upper_bounds1(opt, 1);
    nlopt_set_initial_step1(opt, 0.1);
    nlopt_set_maxeval(opt, evaluations);
    nlopt_set_xtol_abs1(opt, 1e-3);
    nlopt_optimize(opt, x, &value);
    nlopt_destroy(opt);
    return search->status;
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
            variable == CK_TUNE_STIFFNESS ? "stiffness" : ck_engine_setting(search->options->engine, variable)->name,
            x[i] < 0.5 ? "lower" : "upper");
    }
}

// The same time step on another scene, and its error there.
static ck_Status validate(const Search *search, const ck_Tuning *tuning, const char *path, ck_Error *error) {
    ck_Comparison other = {0};
    ck_Run like = {0};
    const ck_TuneOptions *options = search->options;
    ck_Status status = ck_comparison_load(&other, path, error);
    if (!status) status = ck_truth_create(&other.truth, &other.model, options->cache, error);
    if (!status && options->like)
        status = ck_run_measure(&like, &other.model, options->like, &(ck_Settings){0}, &options->limits, error);
    if (!status && options->like && !ck_run_has_all_frames(&like))
        status = ck_fail(error, CK_REFUSED, "%s: %s has no path to come close to: %s", path, options->like->name,
                         like.reason);
    if (!status) {
        ck_TunePoint point = tuning->best;
        point.settings.substeps = (uint32_t)fmax(1, round(other.model.step / tuning->best.trial.time_step));
        point.work *= point.settings.substeps / other.model.step /
                      (tuning->best.settings.substeps / search->comparison->model.step);
        status = try_on(&point, &other, options->like ? &like : NULL, options, error);
        split_errors(&point, &other.truth, options->like != NULL);
        if (!status) add_row(search->csv, &other.model, options, "validation", &point, "");
        if (!status)
            printf("on %s: error %.3g%s (%s)\n", other.model.name, point.trial.error,
                   isnan(options->tolerance)                 ? ""
                   : point.trial.error <= options->tolerance ? ", within the tolerance"
                                                             : ", not within the tolerance",
                   ck_run_status_names[point.trial.status]);
    }
    ck_run_free(&like);
    ck_comparison_free(&other);
    return status;
}

// What the reference has left of the release at the end of the scene is among the ends of a truth at rest.
static ck_Status check_rest(const Search *search, ck_Error *error) {
    const ck_Comparison *comparison = search->comparison;
    double tolerance = search->options->tolerance,
           left = ck_truth_uncertainty(&comparison->truth, &comparison->model, ck_metric_find("position_rms"));
    if (!comparison->truth.reference.is_static || !(left > tolerance)) return CK_OK;
    return ck_fail(
        error, CK_BAD_INPUT,
        "%s: the scene is still %.2g of its size from rest after %g s, so that no engine comes within %g of it; "
        "take a longer time.duration, more drag, or truth: trajectory",
        comparison->path, left, comparison->model.duration, tolerance);
}

static ck_Status prepare(Search *search, ck_Error *error) {
    const ck_TuneOptions *options = search->options;
    const ck_Model *model = &search->comparison->model;
    const ck_Reference *reference = &search->comparison->truth.reference;
    if (!options->like && (!reference->trajectory.frame_count || reference->is_invariant))
        return ck_fail(error, CK_BAD_INPUT, "%s: its truth has no positions to come close to; give --like ENGINE",
                       search->comparison->path);
    ck_Status status = ck_engine_automatic(options->engine, model, &options->given, &search->automatic, error);
    if (status) return status;
    find_ranges(search);
    if (!options->like) return check_rest(search, error);
    status = ck_run_measure(&search->like, model, options->like, &(ck_Settings){0}, &options->limits, error);
    if (!status && !ck_run_has_all_frames(&search->like))
        status =
            ck_fail(error, CK_REFUSED, "%s has no path to come close to: %s", options->like->name, search->like.reason);
    return status;
}

static ck_Status conclude(Search *search, ck_Tuning *tuning, ck_Error *error) {
    const ck_TuneOptions *options = search->options;
    if (!search->point_count || search->values[search->best] >= FAILED)
        return ck_fail(error, CK_REFUSED, "%s: none of %d settings of %s ran to its end%s", search->comparison->path,
                       search->point_count, options->engine->name,
                       search->is_late ? " in time; --timeout gives it longer" : "");
    tuning->best = search->points[search->best];
    tuning->evaluations = search->point_count;
    tuning->is_late = search->is_late;
    tuning->meets = isnan(options->tolerance) || meets(search, &tuning->best);
    name_bounds(search, tuning);
    add_row(search->csv, &search->comparison->model, options, "best", &tuning->best, tuning->bounds);
    ck_Status status = CK_OK;
    for (int i = 0; i < options->validate_count && !status; i++)
        status = validate(search, tuning, options->validate[i], error);
    return status;
}

ck_Status ck_tune_run(ck_Tuning *tuning, const ck_Comparison *comparison, const ck_TuneOptions *options, ck_Csv *csv,
                      ck_Error *error) {
    *tuning = (ck_Tuning){0};
    Search *search = calloc(1, sizeof *search);
    double x[CK_TUNE_VARIABLES];
    if (!search) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    *search = (Search){.comparison = comparison,
                       .options = options,
                       .csv = csv,
                       .journal = {.file = -1},
                       .deadline = ck_wall() + options->timeout,
                       .error = error};
    ck_Status status = prepare(search, error);
    if (!status)
        status = ck_journal_open(&search->journal, options->directory, "tune.journal", options->question, value_name,
                                 take_kept, search, error);
    bool climbs = !isnan(options->tolerance) && !options->varies_softness && !options->varies_stiffness;
    if (!status && climbs) climb(search);
    if (!status && !climbs) {
        // first what the engine's own rule sets, then everywhere, then around the best
        place(search, &(ck_TunePoint){.settings = search->automatic, .stiffness = 1}, x);
        objective((unsigned)search->range_count, x, NULL, search);
        status = search_with(search, NLOPT_GN_DIRECT_L, GLOBAL, x);
    }
    if (!status && !climbs && search->point_count) place(search, &search->points[search->best], x);
    if (!status && !climbs) status = search_with(search, NLOPT_LN_SBPLX, LOCAL, x);
    if (!status && !isnan(options->tolerance)) search_grid(search, tuning);
    if (!status) status = search->status;
    if (!status) status = conclude(search, tuning, error);
    // what a search that ended early has tried is not run again
    ck_journal_close(&search->journal, !status && !search->is_late);
    ck_run_free(&search->like);
    free(search);
    return status;
}

void ck_tune_print(const ck_Tuning *tuning, const ck_TuneOptions *options, const ck_Model *model) {
    const ck_TunePoint *best = &tuning->best;
    printf("# %s on %s: error %.3g, %.4g sweeps per simulated second, %d settings tried\n", options->engine->name,
           model->name, best->trial.error, best->work, tuning->evaluations);
    if (!tuning->meets) printf("# the tolerance of %g is not met\n", options->tolerance);
    if (tuning->is_late)
        printf("# the search ended after %g s; --timeout gives it longer, and what was tried is not run again\n",
               options->timeout);
    if (tuning->is_cheapest) printf("# every cheaper pair of substeps and iterations was tried, and misses it\n");
    if (*tuning->bounds) printf("# %s\n", tuning->bounds);
    if (best->stiffness != 1) printf("# with stiffness, shear and bend of springs times %.6g\n", best->stiffness);
    printf("settings:\n  %s: {", options->engine->name);
    const char *separator = "";
    for (const ck_Setting *row = options->engine->settings; row && row->name; row++) {
        if (!ck_settings_has(&best->settings, row->slot)) continue;
        printf("%s%s: %.9g", separator, row->name, ck_settings_get(&best->settings, row->slot));
        separator = ", ";
    }
    printf("}\n");
}
