#include "needs.h"

#include "resize.h"
#include "start.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// A scene file with one term changed: the parts that changes point to.
typedef struct Reduced {
    ck_SceneFile file;
    ck_SceneCloth cloth;
    ck_SceneRope rope;
    ck_SceneSprings springs;
    ck_SceneNetwork network;
    ck_SceneNetworkSpring *own; // of network
    ck_SceneCollider colliders[CK_NEEDS_MOST];
    ck_ScenePlane planes[CK_NEEDS_MOST];
    ck_SceneSphere spheres[CK_NEEDS_MOST];
    ck_SceneResized resized;
} Reduced;

// Copies what a change may touch, so that the scene stays as it is. False without memory.
static bool copy_file(Reduced *reduced, const ck_SceneFile *file) {
    reduced->file = *file;
    if (file->network) {
        const size_t count = file->network->springs_count;
        reduced->network = *file->network;
        reduced->own = malloc((count + 1) * sizeof *reduced->own);
        if (!reduced->own) return false;
        if (count) memcpy(reduced->own, file->network->springs, count * sizeof *reduced->own);
        reduced->network.springs = reduced->own;
        reduced->file.network = &reduced->network;
    }
    if (file->cloth) reduced->cloth = *file->cloth, reduced->file.cloth = &reduced->cloth;
    if (file->rope) reduced->rope = *file->rope, reduced->file.rope = &reduced->rope;
    if (file->springs) reduced->springs = *file->springs, reduced->file.springs = &reduced->springs;
    if (file->colliders_count) reduced->file.colliders = reduced->colliders;
    for (uint32_t i = 0; i < file->colliders_count; i++) {
        reduced->colliders[i] = file->colliders[i];
        if (file->colliders[i].plane)
            reduced->planes[i] = *file->colliders[i].plane, reduced->colliders[i].plane = &reduced->planes[i];
        if (file->colliders[i].sphere)
            reduced->spheres[i] = *file->colliders[i].sphere, reduced->colliders[i].sphere = &reduced->spheres[i];
    }
    return true;
}

static bool is_of_kind(const ck_SceneNetworkSpring *spring, const char *kind) {
    return spring->kind && !strcmp(spring->kind, kind);
}

// Whether a network has springs of a kind, of their own values.
static bool has_own(const ck_SceneFile *file, const char *kind) {
    bool has = false;
    for (uint32_t i = 0; file->network && i < file->network->springs_count; i++)
        has |= is_of_kind(&file->network->springs[i], kind);
    return has;
}
static void drop_own(Reduced *reduced, const char *kind) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < reduced->network.springs_count; i++)
        if (!is_of_kind(&reduced->own[i], kind)) reduced->own[left++] = reduced->own[i];
    reduced->network.springs_count = left;
}

static bool has_shear(const ck_SceneFile *file) {
    return (file->springs && file->springs->shear > 0) || has_own(file, "shear");
}
static void drop_shear(Reduced *reduced, int collider) {
    (void)collider;
    reduced->springs.shear = 0;
    drop_own(reduced, "shear");
}

static bool has_bend(const ck_SceneFile *file) {
    return (file->springs && file->springs->bend > 0) || has_own(file, "bend");
}
static void drop_bend(Reduced *reduced, int collider) {
    (void)collider;
    reduced->springs.bend = 0;
    drop_own(reduced, "bend");
}

static bool has_bending(const ck_SceneFile *file) {
    return (file->bending && file->bending->stiffness > 0) || (file->network && file->network->hinges_count);
}
static void drop_bending(Reduced *reduced, int collider) {
    (void)collider;
    reduced->file.bending = NULL;
    reduced->network.hinges_count = 0;
}

static bool has_wind(const ck_SceneFile *file) {
    return file->wind != NULL;
}
static void drop_wind(Reduced *reduced, int collider) {
    (void)collider;
    reduced->file.wind = NULL;
}

static bool has_damping(const ck_SceneFile *file) {
    bool has = file->springs && file->springs->damping > 0;
    for (uint32_t i = 0; file->network && i < file->network->springs_count; i++)
        has |= file->network->springs[i].damping > 0;
    return has;
}
static void drop_damping(Reduced *reduced, int collider) {
    (void)collider;
    reduced->springs.damping = 0;
    for (uint32_t i = 0; i < reduced->network.springs_count; i++) reduced->own[i].damping = 0;
}

static bool has_drag(const ck_SceneFile *file) {
    return file->drag > 0;
}
static void drop_drag(Reduced *reduced, int collider) {
    (void)collider;
    reduced->file.drag = 0;
}

static bool has_noise(const ck_SceneFile *file) {
    return file->noise != NULL;
}
static void drop_noise(Reduced *reduced, int collider) {
    (void)collider;
    reduced->file.noise = NULL;
}

static bool has_friction(const ck_SceneFile *file) {
    bool has = false;
    for (uint32_t i = 0; i < file->colliders_count; i++)
        has |=
            (file->colliders[i].plane ? file->colliders[i].plane->friction : file->colliders[i].sphere->friction) > 0;
    return has;
}
static void drop_friction(Reduced *reduced, int collider) {
    (void)collider;
    for (int i = 0; i < CK_NEEDS_MOST; i++) reduced->planes[i].friction = reduced->spheres[i].friction = 0;
}

static bool has_restitution(const ck_SceneFile *file) {
    bool has = false;
    for (uint32_t i = 0; i < file->colliders_count; i++)
        has |= (file->colliders[i].plane ? file->colliders[i].plane->restitution
                                         : file->colliders[i].sphere->restitution) > 0;
    return has;
}
static void drop_restitution(Reduced *reduced, int collider) {
    (void)collider;
    for (int i = 0; i < CK_NEEDS_MOST; i++) reduced->planes[i].restitution = reduced->spheres[i].restitution = 0;
}

static bool has_collider(const ck_SceneFile *file) {
    return file->colliders_count > 0;
}
static void drop_collider(Reduced *reduced, int collider) {
    uint32_t last = --reduced->file.colliders_count;
    reduced->colliders[collider] = reduced->colliders[last];
    if (!last) reduced->file.colliders = NULL;
}

static uint32_t greatest_divisor(uint32_t a, uint32_t b) {
    return b ? greatest_divisor(b, a % b) : a;
}

// By what share of its springs in a row a body can do with about half of them and keep its size: a cloth's rows and
// columns must both come out whole. 0: by none.
static double halved_share(const ck_SceneFile *file) {
    if (file->rope)
        return file->rope->particles > 3 ? floor(file->rope->particles / 2.0) / (file->rope->particles - 1) : 0;
    if (!file->cloth || file->cloth->rows < 2 || file->cloth->columns < 2) return 0;
    uint32_t divisor = greatest_divisor(file->cloth->rows - 1, file->cloth->columns - 1);
    return divisor > 1 ? (divisor + 1) / 2 / (double)divisor : 0;
}

static bool is_halvable(const ck_SceneFile *file) {
    return file->rope || file->cloth;
}

static const char *not_halved(const ck_SceneFile *file) {
    const double share = halved_share(file);
    return share > 0 ? ck_scene_resize_refusal(file, share) : "no coarser grid of square cells has its size";
}

static void halve(Reduced *reduced, int collider) {
    (void)collider;
    const ck_SceneFile from = reduced->file;
    ck_scene_resize(&reduced->resized, &from, halved_share(&from));
    reduced->file = reduced->resized.file;
}

static const struct {
    const char *name;
    bool (*is_there)(const ck_SceneFile *file);
    void (*leave_out)(Reduced *reduced, int collider);
    bool of_each_collider, moves_particles;          // the particles are others: paths cannot be compared
    const char *(*cannot)(const ck_SceneFile *file); // why it cannot be left out; may be NULL
} terms[] = {
    {"shear", has_shear, drop_shear, false, false, NULL},
    {"bend", has_bend, drop_bend, false, false, NULL},
    {"bending", has_bending, drop_bending, false, false, NULL},
    {"wind", has_wind, drop_wind, false, false, NULL},
    {"spring damping", has_damping, drop_damping, false, false, NULL},
    {"drag", has_drag, drop_drag, false, false, NULL},
    {"friction", has_friction, drop_friction, false, false, NULL},
    {"restitution", has_restitution, drop_restitution, false, false, NULL},
    {"collider", has_collider, drop_collider, true, false, NULL},
    {"noise", has_noise, drop_noise, false, false, NULL},
    {"every second particle", is_halvable, halve, false, true, not_halved},
};
#define TERMS ((int)(sizeof terms / sizeof *terms))

static void list_cases(ck_Needs *needs) {
    const ck_SceneFile *file = needs->comparison->scene.file;
    for (int term = 0; term < TERMS; term++) {
        int count = terms[term].of_each_collider ? (int)file->colliders_count : 1;
        for (int i = 0; terms[term].is_there(file) && i < count && needs->case_count < CK_NEEDS_MOST; i++) {
            ck_NeedsCase *one = &needs->cases[needs->case_count++];
            *one = (ck_NeedsCase){.term = term, .collider = i};
            if (terms[term].of_each_collider)
                snprintf(one->name, sizeof one->name, "collider %d (%s)", i + 1,
                         file->colliders[i].plane ? "plane" : "sphere");
            else
                snprintf(one->name, sizeof one->name, "%s", terms[term].name);
        }
    }
}

ck_Status ck_needs_create(ck_Needs *needs, const ck_Comparison *comparison, const ck_Engine *engine, double tolerance,
                          const ck_Settings *given, const ck_Limits *limits, ck_Error *error) {
    *needs = (ck_Needs){.comparison = comparison, .engine = engine, .tolerance = tolerance, .limits = *limits};
    if (engine->method == CK_METHOD_STILL)
        return ck_fail(error, CK_BAD_INPUT, "%s moves nothing, so that it needs nothing; give another --engine",
                       engine->name);
    if (comparison->scene.file->colliders_count > CK_NEEDS_MOST - TERMS)
        return ck_fail(error, CK_REFUSED, "%s: has more than %d colliders to leave out", comparison->path,
                       CK_NEEDS_MOST - TERMS);
    needs->given = *given;
    const ck_Settings wanted = *given;
    // no truth: with and without are set against each other
    const ck_Reference none = {.is_static = comparison->truth.reference.is_static};
    ck_Status status =
        ck_measurement_take(&needs->whole, &comparison->model, &none, engine, &wanted, limits, &needs->base, error);
    if (!status && !ck_run_has_all_frames(&needs->base))
        status = ck_fail(error, CK_REFUSED, "%s: %s does not get through the whole scene: %s", comparison->path,
                         engine->name, needs->whole.reason);
    if (!status) list_cases(needs);
    return status;
}

void ck_needs_free(ck_Needs *needs) {
    ck_run_free(&needs->base);
    *needs = (ck_Needs){0};
}

static void describe(const void *context, int index, char *key, size_t size) {
    snprintf(key, size, "%s", ((const ck_Needs *)context)->cases[index].name);
}

enum { CPU, DISTANCE, METRICS };
bool ck_needs_value(int index, char *name, size_t size) {
    if (index >= METRICS + ck_metric_count()) return false;
    snprintf(name, size, "%s",
             index == CPU        ? "cpu_s"
             : index == DISTANCE ? "position_rms to the scene as it is"
                                 : ck_metric_at(index - METRICS)->name);
    return true;
}
_Static_assert(METRICS + CK_METRIC_CAPACITY <= CK_JOURNAL_VALUES, "raise CK_JOURNAL_VALUES");

static ck_Status run(const void *context, int index, ck_JournalRow *row, ck_Error *error) {
    const ck_Needs *needs = context;
    const ck_NeedsCase *one = &needs->cases[index];
    const char *why = terms[one->term].cannot ? terms[one->term].cannot(needs->comparison->scene.file) : NULL;
    if (why) {
        row->status = CK_RUN_REFUSED;
        snprintf(row->reason, sizeof row->reason, "not tried: %s", why);
        return CK_OK;
    }
    Reduced *reduced = calloc(1, sizeof *reduced);
    if (!reduced) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!copy_file(reduced, needs->comparison->scene.file)) {
        free(reduced);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    terms[one->term].leave_out(reduced, one->collider);
    const ck_Scene scene = {.file = &reduced->file, .document = needs->comparison->scene.document};
    ck_Model model = {0};
    ck_Measurement without;
    ck_Run run = {0};
    ck_Status status = ck_start_build(&model, &scene, error);
    const ck_Settings wanted = needs->given;
    const ck_Reference none = {.is_static = needs->comparison->truth.reference.is_static};
    if (!status)
        status = ck_measurement_take(&without, &model, &none, needs->engine, &wanted, &needs->limits, &run, error);
    if (!status) {
        row->status = (int)without.status;
        snprintf(row->reason, sizeof row->reason, "%s", without.reason);
        row->values[CPU] = without.cpu;
        memcpy(row->values + METRICS, without.values, sizeof without.values);
        if (!terms[one->term].moves_particles && run.trajectory.frame_count == needs->base.trajectory.frame_count)
            row->values[DISTANCE] = ck_metric_deviation(ck_metric_find("position_rms"), &model, &run.trajectory,
                                                        &needs->base.trajectory, &none);
    }
    ck_run_free(&run);
    ck_model_free(&model);
    free(reduced->own);
    free(reduced);
    return status;
}

ck_Study ck_needs_study(const ck_Needs *needs) {
    return (ck_Study){"needs", ck_needs_value, needs->case_count, (void *)needs, describe, run};
}

// By how much a metric changes: as it is where it is dimensionless, else relative. One that starts or ends to apply has
// changed by more than any tolerance; where right is none (jitter, drift), only its values say anything.
static double change_of(const ck_Metric *metric, double with, double without) {
    bool is_of_motion = metric->truth == CK_TRUTH_OF_STATE;
    if (isnan(with) && isnan(without)) return NAN;
    if (isnan(with) || isnan(without)) return is_of_motion ? INFINITY : NAN;
    double scale = strcmp(metric->unit, "1") ? fmax(fabs(with), fabs(without)) : 1;
    return scale > 0 ? fabs(without - with) / scale : 0;
}

static void add_row(const ck_Needs *needs, const ck_JournalRow *row, int index, ck_Csv *csv, const char *metric,
                    const char *unit, double with, double without, double change) {
    bool matters = change > needs->tolerance;
    ck_csv_text(csv, needs->comparison->model.name);
    ck_csv_text(csv, needs->engine->name);
    ck_csv_text(csv, needs->cases[index].name);
    ck_csv_text(csv, metric);
    ck_csv_text(csv, unit);
    ck_csv_number(csv, with);
    ck_csv_number(csv, without);
    ck_csv_number(csv, change);
    ck_csv_number(csv, needs->tolerance);
    ck_csv_text(csv, !*metric ? "" : matters ? "yes" : "no");
    ck_csv_number(csv, needs->whole.cpu);
    ck_csv_number(csv, row->values[CPU]);
    ck_csv_text(csv, ck_run_status_names[row->status]);
    ck_csv_text(csv, row->reason);
}

void ck_needs_write(const ck_Needs *needs, const ck_JournalRow *rows, ck_Csv *csv) {
    for (int i = 0; i < needs->case_count; i++) {
        bool has_row = false;
        for (int k = 0; k < ck_metric_count() && rows[i].is_done && rows[i].status != CK_RUN_REFUSED; k++) {
            const ck_Metric *metric = ck_metric_at(k);
            double with = needs->whole.values[k], without = rows[i].values[METRICS + k];
            bool is_distance = !strcmp(metric->name, "position_rms");
            double change = is_distance ? rows[i].values[DISTANCE] : change_of(metric, with, without);
            if (!ck_metric_is_wanted(metric, &needs->comparison->model) || isnan(change)) continue;
            add_row(needs, &rows[i], i, csv, metric->name, metric->unit, is_distance ? NAN : with,
                    is_distance ? NAN : without, change);
            has_row = true;
        }
        // refused or failed: the reason says why
        if (rows[i].is_done && !has_row) add_row(needs, &rows[i], i, csv, "", "", NAN, NAN, NAN);
    }
}
