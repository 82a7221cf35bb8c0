#include "runner.h"

#include "process.h"
#include "session.h"
#include "statistics.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// What a child tells its parent, in shared memory.
typedef struct Report {
    ck_Status status;
    ck_Error error;
    ck_StepResult step;
    ck_Settings used;
    ck_Ledger ledger;
    int frame_count; // complete frames, the start among them
    double cpu, worst_step;
    bool is_cut;      // by the caller's patience
    char remark[240]; // the engine's own, or empty
} Report;

typedef struct Job {
    const ck_Run *run;
    Report *report;
    int frames; // to step
    const ck_Limits *limits;
} Job;

// False where the engine does not take the scene.
static bool begin(const Job *job, ck_Session *session) {
    Report *report = job->report;
    report->ledger.count = 0;
    report->status = ck_session_begin(session, job->run->engine, job->run->model, &job->run->wanted, &report->used,
                                      &report->ledger, &report->error);
    if (!report->status) ck_ledger_add_material(&report->ledger, job->run->model);
    return !report->status;
}

// What the whole run would cost, s of CPU time.
static double foresee(const Report *report, int frames) {
    return report->frame_count > 1 ? report->cpu / (report->frame_count - 1) * frames : INFINITY;
}

// A fifth of the patience tells what the whole will cost. What misses it by little may go on to its end.
static bool is_too_slow(const Job *job) {
    const Report *report = job->report;
    double patience = job->limits->patience;
    if (!(patience > 0) || report->frame_count > job->frames || report->cpu < patience / 5) return false;
    return foresee(report, job->frames) > 1.2 * patience;
}

static double cpu_of(const ck_Engine *engine, const void *state) {
    return engine->outside && engine->outside->cpu ? engine->outside->cpu(state) : ck_process_cpu();
}

// Others tell by themselves.
static bool is_finite(const ck_Run *run, int frame) {
    const ck_Trajectory *path = &run->trajectory;
    bool is_finite = true;
    for (int i = 0; i < 3 * path->particle_count && run->engine->outside && is_finite; i++)
        is_finite =
            isfinite(ck_trajectory_position(path, frame)[i]) && isfinite(ck_trajectory_velocity(path, frame)[i]);
    return is_finite;
}

static void measure(void *context) {
    const Job *job = context;
    const ck_Engine *engine = job->run->engine;
    Report *report = job->report;
    ck_Session session;
    if (!begin(job, &session)) return;
    ck_session_read(&session, &job->run->trajectory, 0);
    report->frame_count = 1;
    while (report->frame_count <= job->frames) {
        double start = cpu_of(engine, session.state);
        report->step = ck_session_advance(&session, report->frame_count - 1);
        report->cpu += cpu_of(engine, session.state) - start;
        if (report->step && *session.refusal.message) {
            report->status = CK_REFUSED;
            snprintf(report->error.message, sizeof report->error.message, "%.400s, in the change at %g s",
                     session.refusal.message, (report->frame_count - 1) * job->run->model->step);
        }
        if (report->step) break;
        ck_session_read(&session, &job->run->trajectory, report->frame_count);
        if (!is_finite(job->run, report->frame_count)) report->step = CK_STEP_DIVERGED;
        if (report->step) break;
        report->frame_count++;
        if (is_too_slow(job)) report->is_cut = true;
        if (report->is_cut) break;
    }
    const char *remark = engine->remark ? engine->remark(session.state) : NULL;
    snprintf(report->remark, sizeof report->remark, "%s", remark ? remark : "");
    ck_session_end(&session);
}

static void time_frames(void *context) {
    const Job *job = context;
    const ck_Engine *engine = job->run->engine;
    Report *report = job->report;
    // warm up on a world of its own: code and allocator, not this world's state
    ck_Session session;
    if (!begin(job, &session)) return;
    for (int i = 0; i < job->frames && i < 3; i++) ck_session_advance(&session, i);
    ck_session_end(&session);
    if (!begin(job, &session)) return;
    for (int i = 0; i < job->frames; i++) {
        double start = cpu_of(engine, session.state);
        report->step = ck_session_advance(&session, i);
        double cpu = cpu_of(engine, session.state) - start;
        report->cpu += cpu;
        report->worst_step = fmax(report->worst_step, cpu);
        if (report->step) break;
    }
    ck_session_end(&session);
}

static const ck_RunStatus status_of_child[] = {
    [CK_CHILD_DONE] = CK_RUN_OK,
    [CK_CHILD_ABORTED] = CK_RUN_ABORTED,
    [CK_CHILD_TIMED_OUT] = CK_RUN_TIMED_OUT,
    [CK_CHILD_NO_MEMORY] = CK_RUN_OUT_OF_MEMORY,
};

// A single frame may outlast the patience: so many times of it, in wall time, end it.
#define WAIT_OF_PATIENCE 4

// What ran is the only timing that such a run has.
static void tell_too_slow(ck_Run *run, const Report *report, const ck_Limits *limits) {
    int frames = report->frame_count - 1;
    double whole = foresee(report, run->model->frame_count), time = fmax(0, frames) * run->model->step;
    run->status = CK_RUN_TOO_SLOW;
    if (frames < 1) {
        snprintf(run->reason, sizeof run->reason, "not one frame in %g s; --patience 0 lets it run", limits->seconds);
        return;
    }
    run->timing = (ck_Timing){.frames = frames, .cpu = {report->cpu}, .repeat_count = 1, .worst_step = NAN};
    snprintf(run->reason, sizeof run->reason,
             "%.3g s of CPU a simulated second, some %.2g s in all; cut at t = %.4g s; --patience %.0f lets it run",
             report->cpu / time, whole, time, ceil(1.5 * whole));
}

// Turns how the child ended and what it reported into the run's status and reason.
static void conclude(ck_Run *run, const Report *report, const ck_ChildResult *child, const ck_Limits *limits,
                     double allowed) {
    run->used = report->used;
    run->ledger = report->ledger;
    run->trajectory.frame_count = report->frame_count;
    run->measured_cpu = report->cpu;
    run->peak_rss_bytes = child->peak_rss_bytes;
    memcpy(run->remark, report->remark, sizeof run->remark);
    run->status = status_of_child[child->end];
    double time = fmax(0, report->frame_count - 1) * run->model->step;
    if (report->is_cut || (child->end == CK_CHILD_TIMED_OUT && limits->seconds < allowed)) {
        tell_too_slow(run, report, limits);
    } else if (child->end != CK_CHILD_DONE) {
        snprintf(run->reason, sizeof run->reason, "%s, at t = %g s", child->reason, time);
    } else if (report->status) {
        run->status = report->status == CK_NO_MEMORY ? CK_RUN_OUT_OF_MEMORY : CK_RUN_REFUSED;
        snprintf(run->reason, sizeof run->reason, "%s", report->error.message);
    } else if (report->step == CK_STEP_NO_MEMORY) {
        run->status = CK_RUN_OUT_OF_MEMORY;
        snprintf(run->reason, sizeof run->reason, "the engine ran out of memory after t = %g s", time);
    } else if (report->step == CK_STEP_DIVERGED) {
        run->status = CK_RUN_DIVERGED;
        snprintf(run->reason, sizeof run->reason, "%s after t = %g s%s%s",
                 *report->remark ? "stopped" : "left the finite numbers", time, *report->remark ? "; " : "",
                 report->remark);
    } else {
        snprintf(run->reason, sizeof run->reason, "ran to t = %g s", time);
    }
}

// True, with status and reason set, where the scene has a term that the engine lacks.
static bool is_unsupported(ck_Run *run) {
    unsigned missing = run->model->terms & ~run->engine->terms & ~(unsigned)CK_TERM_CHANGES;
    if (!missing) return false;
    run->status = CK_RUN_UNSUPPORTED;
    size_t used = (size_t)snprintf(run->reason, sizeof run->reason, "%s does not model", run->engine->name);
    const char *separator = " ";
    for (int bit = 0; bit < CK_TERM_COUNT; bit++) {
        if (!(missing & (1u << bit))) continue;
        used += (size_t)snprintf(run->reason + used, sizeof run->reason - used, "%s%s", separator, ck_term_names[bit]);
        separator = ", ";
    }
    return true;
}

ck_Status ck_run_measure(ck_Run *run, const ck_Model *model, const ck_Engine *engine, const ck_Settings *wanted,
                         const ck_Limits *limits, ck_Error *error) {
    *run = (ck_Run){.model = model, .engine = engine, .wanted = *wanted};
    if (is_unsupported(run)) return CK_OK;
    ck_Error why = {0};
    if (ck_trajectory_create(&run->trajectory, model, &why)) {
        run->status = CK_RUN_OUT_OF_MEMORY;
        snprintf(run->reason, sizeof run->reason, "%s", why.message);
        return CK_OK;
    }
    Report *report = ck_shared_allocate(sizeof *report);
    if (!report) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_ChildResult child;
    ck_Limits own = *limits;
    own.spawns = engine->outside && engine->outside->spawns;
    if (limits->patience > 0) own.seconds = fmin(limits->seconds, WAIT_OF_PATIENCE * limits->patience);
    ck_Status status = ck_child_run(&child, measure, &(Job){run, report, model->frame_count, &own}, &own, error);
    if (!status) conclude(run, report, &child, &own, limits->seconds);
    ck_shared_free(report, sizeof *report);
    return status;
}

static void find_automatic(void *context) {
    const Job *job = context;
    ck_Session session;
    if (begin(job, &session)) ck_session_end(&session);
}

ck_Status ck_run_automatic(const ck_Engine *engine, const ck_Model *model, const ck_Settings *wanted,
                           const ck_Limits *limits, ck_Settings *used, ck_Error *error) {
    ck_Run run = {.model = model, .engine = engine, .wanted = *wanted};
    ck_ChildResult child;
    ck_Limits own = *limits;
    if (is_unsupported(&run)) return ck_fail(error, CK_REFUSED, "%s", run.reason);
    Report *report = ck_shared_allocate(sizeof *report);
    if (!report) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    own.spawns = engine->outside && engine->outside->spawns;
    ck_Status status = ck_child_run(&child, find_automatic, &(Job){&run, report, 0, &own}, &own, error);
    if (!status && child.end != CK_CHILD_DONE)
        status = ck_fail(error, CK_REFUSED, "%s on %s: %s", engine->name, model->name, child.reason);
    else if (!status && report->status)
        status = ck_fail(error, report->status, "%s", report->error.message);
    if (!status) *used = report->used;
    ck_shared_free(report, sizeof *report);
    return status;
}

// What a recording cost is told with it, once and for all.
static void take_recorded_cost(ck_Run *run) {
    double cost = run->engine->outside->frame_cost;
    int frames = run->model->frame_count;
    run->timing = (ck_Timing){.frames = frames, .worst_step = NAN, .has_failed = true};
    if (isnan(cost)) return;
    run->timing.cpu[0] = cost * frames;
    run->timing.repeat_count = 1;
}

ck_Status ck_run_time(ck_Run *run, double budget, const ck_Limits *limits, ck_Error *error) {
    ck_Timing *timing = &run->timing;
    if (run->trajectory.frame_count <= run->model->frame_count || timing->repeat_count == CK_MAX_REPEATS ||
        timing->has_failed)
        return CK_OK;
    if (run->engine->outside && run->engine->outside->is_recorded) {
        take_recorded_cost(run);
        return CK_OK;
    }
    if (!timing->frames) {
        double fits = run->measured_cpu > 0 ? budget / run->measured_cpu : 1;
        timing->frames = (int)fmax(1, floor(fmin(1, fits) * run->model->frame_count));
    }
    Report *report = ck_shared_allocate(sizeof *report);
    if (!report) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    ck_ChildResult child;
    double start = ck_wall();
    ck_Limits own = *limits;
    own.spawns = run->engine->outside && run->engine->outside->spawns;
    ck_Status status = ck_child_run(&child, time_frames, &(Job){run, report, timing->frames, &own}, &own, error);
    if (!status && child.end == CK_CHILD_DONE && !report->status && !report->step) {
        timing->cpu[timing->repeat_count++] = report->cpu;
        timing->worst_step = fmax(timing->worst_step, report->worst_step);
    } else if (!status) {
        timing->has_failed = true;
    }
    timing->spent += ck_wall() - start;
    ck_shared_free(report, sizeof *report);
    return status;
}

bool ck_run_has_all_frames(const ck_Run *run) {
    return run->model && run->trajectory.frame_count == run->model->frame_count + 1;
}

void ck_run_free(ck_Run *run) {
    ck_trajectory_free(&run->trajectory);
    *run = (ck_Run){0};
}

static double quantile(const ck_Timing *timing, double share) {
    double sorted[CK_MAX_REPEATS];
    memcpy(sorted, timing->cpu, sizeof *sorted * (size_t)timing->repeat_count);
    return ck_quantile(sorted, timing->repeat_count, share);
}

double ck_timing_median(const ck_Timing *timing) {
    return quantile(timing, 0.5);
}

void ck_timing_interval(const ck_Timing *timing, double *low, double *high) {
    double sorted[CK_MAX_REPEATS];
    memcpy(sorted, timing->cpu, sizeof *sorted * (size_t)timing->repeat_count);
    ck_median_interval(sorted, timing->repeat_count, low, high);
}

// Timing ends when its interval is this narrow, of the median, or when enough is spent; but where repeats are short not
// before so many. Source: Criterion and hyperfine do alike.
#define NARROW 0.02
#define FEWEST 5

bool ck_timing_is_known(const ck_Timing *timing, double enough) {
    double low, high;
    if (timing->has_failed) return true;
    if (!timing->repeat_count) return false;
    if (timing->repeat_count < FEWEST && timing->spent * FEWEST / timing->repeat_count <= enough) return false;
    ck_timing_interval(timing, &low, &high);
    return timing->spent >= enough || timing->repeat_count == CK_MAX_REPEATS ||
           (timing->repeat_count > FEWEST && high - low <= NARROW * ck_timing_median(timing));
}

double ck_timing_iqr(const ck_Timing *timing) {
    return timing->repeat_count > 1 ? quantile(timing, 0.75) - quantile(timing, 0.25) : NAN;
}
