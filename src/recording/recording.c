#include "recording.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Times of one frame differ by what printing them in six digits takes; in steps of the scene.
#define SAME_TIME 1e-4

// Whole states at the times that were recorded.
typedef struct States {
    int count;
    double *time;                // [count] s
    double *position, *velocity; // [count][3*n]
    int finite;                  // of them, up to the first coordinate that is no number
} States;

static int compare_points(const void *a, const void *b) {
    const ck_RecordedPoint *one = a, *other = b;
    if (one->time != other->time) return one->time < other->time ? -1 : 1;
    return (one->particle > other->particle) - (one->particle < other->particle);
}

static void free_states(States *states) {
    free(states->time);
    free(states->position);
    free(states->velocity);
}

static ck_Status allocate_states(States *states, const ck_Model *model, int most, ck_Error *error) {
    size_t bytes = 3 * (size_t)model->particle_count * sizeof(double);
    states->time = calloc((size_t)most, sizeof *states->time);
    states->position = calloc((size_t)most, bytes);
    states->velocity = calloc((size_t)most, bytes);
    return states->time && states->position && states->velocity ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// Starts a state of which nothing is known but particles that never move.
static double *begin_state(States *states, const ck_Model *model, double time) {
    size_t at = 3 * (size_t)model->particle_count * (size_t)states->count;
    states->time[states->count++] = time;
    for (int i = 0; i < model->particle_count; i++)
        for (int axis = 0; axis < 3; axis++)
            states->position[at + 3 * i + axis] = ck_model_is_held(model, i) ? model->position[3 * i + axis] : NAN;
    return states->position + at;
}

static ck_Status check_frame(const ck_Recording *recording, const ck_Model *model, const bool *seen, double time,
                             ck_Error *error) {
    int missing = 0, first = -1;
    for (int i = 0; i < model->particle_count; i++) {
        if (seen[i] || ck_model_is_held(model, i)) continue;
        if (!missing++) first = i;
    }
    if (!missing) return CK_OK;
    return ck_fail(error, CK_BAD_INPUT, "%s: at time_s %g %d of %d particles are missing, particle %d among them",
                   recording->path, time, missing, model->particle_count, first);
}

// Sorted points become states; a frame is what was recorded at one time.
static ck_Status gather(States *states, const ck_Recording *recording, const ck_RecordedPoint *points,
                        const ck_Model *model, bool *seen, ck_Error *error) {
    double *at = NULL, *speed = NULL, begun = NAN;
    ck_Status status = CK_OK;
    if (points[0].time > SAME_TIME * model->step) {
        memcpy(begin_state(states, model, 0), model->position, 3 * (size_t)model->particle_count * sizeof *at);
        memcpy(states->velocity, model->velocity, 3 * (size_t)model->particle_count * sizeof *at);
    }
    for (int i = 0; i < recording->point_count && !status; i++) {
        const ck_RecordedPoint *point = &points[i];
        if (!(point->time - begun <= SAME_TIME * model->step)) {
            if (at) status = check_frame(recording, model, seen, begun, error);
            memset(seen, 0, (size_t)model->particle_count * sizeof *seen);
            begun = point->time;
            at = begin_state(states, model, begun);
            speed = states->velocity + (at - states->position);
        }
        if (seen[point->particle] && !status)
            status = ck_fail(error, CK_BAD_INPUT, "%s:%d: particle %d stands twice at time_s %g", recording->path,
                             point->line, point->particle, point->time);
        seen[point->particle] = true;
        memcpy(at + 3 * point->particle, point->at, sizeof point->at);
        memcpy(speed + 3 * point->particle, point->velocity, sizeof point->velocity);
    }
    return status ? status : check_frame(recording, model, seen, begun, error);
}

static void find_finite(States *states, const ck_Model *model) {
    size_t width = 3 * (size_t)model->particle_count;
    for (states->finite = 0; states->finite < states->count; states->finite++)
        for (size_t i = 0; i < width; i++)
            if (!isfinite(states->position[width * (size_t)states->finite + i]) ||
                !isfinite(states->velocity[width * (size_t)states->finite + i]))
                return;
}

// The slope at a state of the parabola through it and its neighbours; at the scene's start the scene's own speed.
static void derive_velocity(States *states, const ck_Model *model) {
    size_t width = 3 * (size_t)model->particle_count;
    for (int k = 0; k < states->count; k++) {
        int last = states->count - 1, middle = k == last && last > 1 ? last - 1 : k;
        double *out = states->velocity + width * (size_t)k;
        if (k == 0 || last < 1) {
            memcpy(out, model->velocity, width * sizeof *out);
            continue;
        }
        const double *x = states->position + width * (size_t)middle;
        double t = states->time[k];
        double before = states->time[middle - 1], now = states->time[middle];
        double after = middle < last ? states->time[middle + 1] : NAN;
        for (size_t i = 0; i < width; i++) {
            double slope = (x[i] - x[i - width]) / (now - before);
            if (middle == last) {
                out[i] = slope;
                continue;
            }
            double bend = ((x[i + width] - x[i]) / (after - now) - slope) / (after - before);
            out[i] = slope + bend * (2 * t - before - now);
        }
    }
}

static void write_frame(const ck_Trajectory *path, int frame, const States *states, const ck_Model *model, int *at) {
    double time = frame * model->step, *position = ck_trajectory_position(path, frame),
           *velocity = ck_trajectory_velocity(path, frame);
    size_t width = 3 * (size_t)model->particle_count;
    while (*at + 1 < states->finite && states->time[*at + 1] <= time + SAME_TIME * model->step) ++*at;
    const double *x = states->position + width * (size_t)*at, *v = states->velocity + width * (size_t)*at;
    if (fabs(states->time[*at] - time) <= SAME_TIME * model->step || *at + 1 >= states->finite) {
        memcpy(position, x, width * sizeof *x);
        memcpy(velocity, v, width * sizeof *v);
        return;
    }
    double h = states->time[*at + 1] - states->time[*at], t = (time - states->time[*at]) / h;
    for (size_t i = 0; i < width; i++)
        position[i] = ck_between(x[i], v[i], x[i + width], v[i + width], h, t, &velocity[i]);
}

// Which of the scene's frames the recording reaches, and whether that is all of them where nothing diverged.
static ck_Status resample(ck_Trajectory *path, const States *states, const ck_Recording *recording,
                          const ck_Model *model, int *interpolated, ck_Error *error) {
    double end = states->finite ? states->time[states->finite - 1] : -1;
    bool is_finite = states->finite == states->count;
    if (is_finite && end < model->duration - 0.5 * model->step)
        return ck_fail(error, CK_BAD_INPUT, "%s: ends at time_s %g; the scene goes to %g s (time.duration)",
                       recording->path, end, model->duration);
    int at = 0;
    *interpolated = 0;
    for (int frame = 0; frame <= model->frame_count; frame++) {
        if (!is_finite && frame * model->step > end + SAME_TIME * model->step) break;
        write_frame(path, frame, states, model, &at);
        *interpolated += fabs(states->time[at] - frame * model->step) > SAME_TIME * model->step;
        path->frame_count = frame + 1;
    }
    return CK_OK;
}

static void tell(char *note, size_t size, const ck_Recording *recording, const States *states, int interpolated,
                 bool lacks_start) {
    size_t used = 0;
    *note = 0;
    if (lacks_start) used += (size_t)snprintf(note, size, "its start is the scene's");
    if (!recording->has_velocity && used < size)
        used += (size_t)snprintf(note + used, size - used, "%svelocities derived from positions", used ? "; " : "");
    if (interpolated && used < size)
        snprintf(note + used, size - used, "%s%d frames interpolated between %d recorded ones", used ? "; " : "",
                 interpolated, states->count);
}

ck_Status ck_recording_path(ck_Trajectory *path, const ck_Recording *recording, const ck_Model *model, char *note,
                            size_t size, ck_Error *error) {
    States states = {0};
    int interpolated = 0;
    ck_RecordedPoint *sorted = malloc(sizeof *sorted * (size_t)recording->point_count);
    bool *seen = calloc((size_t)model->particle_count, sizeof *seen);
    *path = (ck_Trajectory){0};
    ck_Status status = sorted && seen ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) {
        memcpy(sorted, recording->points, sizeof *sorted * (size_t)recording->point_count);
        qsort(sorted, (size_t)recording->point_count, sizeof *sorted, compare_points);
        int times = 2;
        for (int i = 1; i < recording->point_count; i++) times += sorted[i].time > sorted[i - 1].time;
        status = allocate_states(&states, model, times, error);
    }
    if (!status) status = gather(&states, recording, sorted, model, seen, error);
    if (!status) status = ck_trajectory_create(path, model, error);
    if (!status) {
        if (!recording->has_velocity) derive_velocity(&states, model);
        find_finite(&states, model);
        status = resample(path, &states, recording, model, &interpolated, error);
    }
    if (!status) tell(note, size, recording, &states, interpolated, sorted[0].time > SAME_TIME * model->step);
    free_states(&states);
    free(sorted);
    free(seen);
    return status;
}
