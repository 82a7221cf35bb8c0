#include "path.h"

#include "vector.h"
#include "wind.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

// m/s at a point: of the line between its neighbours.
static double slope_at(const ck_Path *path, int i, int axis) {
    if (i == 0 || i == path->point_count - 1) return 0;
    const double *before = path->points[i - 1], *after = path->points[i + 1];
    return (after[1 + axis] - before[1 + axis]) / (after[0] - before[0]);
}

// The last point at or before a time that lies between points.
static int point_before(const ck_Path *path, double time, int side) {
    int low = 0, high = path->point_count - 1;
    while (high - low > 1) {
        const int middle = (low + high) / 2;
        if (side < 0 ? path->points[middle][0] < time : path->points[middle][0] <= time)
            low = middle;
        else
            high = middle;
    }
    return low;
}

// Hermite's cubic over the share s of the way from one point to the next.
static void along_points(const ck_Path *path, double time, int side, double *moved, double *velocity,
                         double *acceleration) {
    const int i = point_before(path, time + side * path->slack, side);
    const double *p = path->points[i], *q = path->points[i + 1], span = q[0] - p[0], s = (time - p[0]) / span;
    for (int axis = 0; axis < 3; axis++) {
        const double m = span * slope_at(path, i, axis), n = span * slope_at(path, i + 1, axis);
        const double way = q[1 + axis] - p[1 + axis], b = 3 * way - 2 * m - n, c = m + n - 2 * way;
        moved[axis] = p[1 + axis] - path->points[0][1 + axis] + s * (m + s * (b + s * c));
        velocity[axis] = (m + s * (2 * b + 3 * s * c)) / span;
        acceleration[axis] = (2 * b + 6 * s * c) / (span * span);
    }
}

void ck_path_at(const ck_Path *path, double time, int side, double *moved, double *velocity, double *acceleration) {
    const double slack = side * path->slack;
    const bool moves = time + slack > path->from && time + slack < path->to;
    const double at = fmax(path->from, fmin(path->to, time)), since = at - path->from;
    memset(velocity, 0, 3 * sizeof(double));
    memset(acceleration, 0, 3 * sizeof(double));
    if (path->kind == CK_PATH_POINTS) {
        along_points(path, at, side, moved, velocity, acceleration);
    } else {
        const double rate = path->kind == CK_PATH_SINE ? 2 * pi * path->frequency : 0, angle = rate * since;
        const double share = rate > 0 ? sin(angle) : since, change = rate > 0 ? rate * cos(angle) : 1;
        for (int axis = 0; axis < 3; axis++) {
            moved[axis] = share * path->vector[axis];
            velocity[axis] = change * path->vector[axis];
            acceleration[axis] = rate > 0 ? -rate * rate * share * path->vector[axis] : 0;
        }
    }
    if (moves) return;
    memset(velocity, 0, 3 * sizeof(double));
    memset(acceleration, 0, 3 * sizeof(double));
}

void ck_path_aim(ck_Path *path, const double *place) {
    const double from = fmax(0, path->from), length = path->to - from;
    for (int axis = 0; axis < 3; axis++)
        path->vector[axis] = length > path->slack ? (path->goal[axis] - place[axis]) / length : 0;
    path->from = from;
}

double ck_path_next_jump(const ck_Path *path, double time) {
    const double after = time + path->slack;
    if (after < path->from) return path->from;
    if (path->kind == CK_PATH_POINTS && after < path->to) return path->points[point_before(path, after, 1) + 1][0];
    return after < path->to ? path->to : INFINITY;
}

// The largest acceleration of points, m/s², and half of how far they reach, m.
static double bend_of(const ck_Path *path, double *reach) {
    double largest = 0;
    *reach = 0;
    for (int i = 0; i < path->point_count; i++) {
        double from[3], moved[3], velocity[3], acceleration[3];
        ck_subtract(from, path->points[i] + 1, path->points[0] + 1);
        *reach = fmax(*reach, 0.5 * ck_length(from));
        for (int side = -1; side <= 1; side += 2) {
            along_points(path, path->points[i][0], side, moved, velocity, acceleration);
            largest = fmax(largest, ck_length(acceleration));
        }
    }
    return largest;
}

double ck_path_longest_step(const ck_Model *model) {
    double longest = INFINITY;
    for (int i = 0; i < model->path_count; i++) {
        const ck_Path *path = &model->paths[i];
        double reach;
        if (path->kind == CK_PATH_SINE) longest = fmin(longest, 1 / (20 * path->frequency));
        if (path->kind != CK_PATH_POINTS) continue;
        const double bend = bend_of(path, &reach);
        if (bend > 0) longest = fmin(longest, 2 * pi / 20 * sqrt(reach / bend));
    }
    return longest;
}

bool ck_driven_jump(const ck_Model *model, double time) {
    bool jumps = false;
    for (int i = 0; i < model->path_count; i++) {
        const ck_Path *path = &model->paths[i];
        jumps |= fabs(time - ck_path_next_jump(path, time - 3 * path->slack)) <= path->slack;
    }
    return jumps;
}

bool ck_driven_holds(const ck_Model *model, const ck_Driven *driven, double time) {
    return model->pinned[driven->particle] && time <= driven->until + driven->path->slack;
}

void ck_driven_at(const ck_Driven *driven, double time, double *position) {
    double moved[3], v[3], a[3];
    ck_path_at(driven->path, time, -1, moved, v, a);
    memcpy(position, driven->start, 3 * sizeof(double));
    ck_add_scaled(position, 1, moved);
}

const ck_Driven *ck_driven_find(const ck_Model *model, int particle, double time) {
    for (int i = 0; i < model->driven_count; i++)
        if (model->driven[i].particle == particle && ck_driven_holds(model, &model->driven[i], time))
            return &model->driven[i];
    return NULL;
}

void ck_driven_place(const ck_Model *model, double time, int side, double *position, double *velocity) {
    for (int i = 0; i < model->driven_count; i++) {
        const ck_Driven *driven = &model->driven[i];
        double moved[3], v[3], a[3], *x = position + 3 * driven->particle;
        if (!ck_driven_holds(model, driven, time)) continue;
        ck_path_at(driven->path, time, side, moved, v, a);
        memcpy(x, driven->start, 3 * sizeof(double));
        ck_add_scaled(x, 1, moved);
        if (velocity) memcpy(velocity + 3 * driven->particle, v, sizeof v);
    }
}

void ck_driven_accelerate(const ck_Model *model, double time, int side, double *acceleration) {
    for (int i = 0; i < model->driven_count; i++) {
        const ck_Driven *driven = &model->driven[i];
        double moved[3], v[3];
        if (ck_driven_holds(model, driven, time))
            ck_path_at(driven->path, time, side, moved, v, acceleration + 3 * driven->particle);
    }
}

bool ck_model_is_worked_on(const ck_Model *model) {
    return model->path_count > 0 || model->segment_count > 0 || ck_wind_blows(model);
}

bool ck_model_ends_moving(const ck_Model *model) {
    for (int i = 0; i < model->path_count; i++)
        if (model->paths[i].to > model->duration) return true;
    return false;
}
