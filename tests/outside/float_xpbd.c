#include "float_xpbd.h"

#include <math.h>
#include <stdlib.h>

// What a build may get wrong, for the test that finds it.
#ifndef STIFFNESS_FACTOR
#define STIFFNESS_FACTOR 1
#endif

typedef struct Link {
    int a, b;
    float rest, compliance;
} Link;

struct FloatXpbd {
    int particles, links, substeps;
    float dt, drag, gravity[3];
    float *x, *before, *v, *weight, *push; // [3*n], weight [n]
    float *mass;
    Link *link;
};

void float_xpbd_free(FloatXpbd *solver) {
    if (!solver) return;
    free(solver->x);
    free(solver->link);
    free(solver);
}

FloatXpbd *float_xpbd_new(const ck_Model *model, int substeps) {
    const int n = model->particle_count;
    FloatXpbd *solver = calloc(1, sizeof *solver);
    if (!solver) return NULL;
    solver->x = calloc(14 * (size_t)n, sizeof(float));
    solver->link = calloc((size_t)model->spring_count + 1, sizeof *solver->link);
    if (!solver->x || !solver->link) {
        float_xpbd_free(solver);
        return NULL;
    }
    solver->particles = n;
    solver->links = model->spring_count;
    solver->substeps = substeps;
    solver->dt = (float)(model->step / substeps);
    solver->drag = (float)model->drag;
    solver->before = solver->x + 3 * n;
    solver->v = solver->before + 3 * n;
    solver->push = solver->v + 3 * n;
    solver->weight = solver->push + 3 * n;
    solver->mass = solver->weight + n;
    for (int i = 0; i < 3 * n; i++) {
        solver->x[i] = (float)model->position[i];
        solver->v[i] = (float)model->velocity[i];
        solver->mass[i / 3] = (float)model->mass[i / 3];
        solver->weight[i / 3] = model->pinned[i / 3] ? 0 : 1 / solver->mass[i / 3];
        solver->push[i] = (float)model->gravity[i % 3] + (float)model->force[i % 3] / solver->mass[i / 3];
    }
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        solver->link[i] = (Link){spring->a, spring->b, (float)spring->rest,
                                 (float)(1 / (spring->stiffness * STIFFNESS_FACTOR)) / (solver->dt * solver->dt)};
    }
    return solver;
}

static void project(FloatXpbd *solver, const Link *link) {
    float *a = solver->x + 3 * link->a, *b = solver->x + 3 * link->b, d[3];
    float weights = solver->weight[link->a] + solver->weight[link->b];
    for (int axis = 0; axis < 3; axis++) d[axis] = b[axis] - a[axis];
    float length = sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (!(length > 0) || !(weights > 0)) return;
    float push = (length - link->rest) / (weights + link->compliance) / length;
    for (int axis = 0; axis < 3; axis++) {
        a[axis] += solver->weight[link->a] * push * d[axis];
        b[axis] -= solver->weight[link->b] * push * d[axis];
    }
}

void float_xpbd_step(FloatXpbd *solver) {
    const float dt = solver->dt, keeps = 1 - solver->drag * dt;
    for (int substep = 0; substep < solver->substeps; substep++) {
        for (int i = 0; i < 3 * solver->particles; i++) {
            solver->before[i] = solver->x[i];
            if (!(solver->weight[i / 3] > 0)) continue;
            solver->v[i] = solver->v[i] * keeps + dt * solver->push[i];
            solver->x[i] += dt * solver->v[i];
        }
        for (int i = 0; i < solver->links; i++) project(solver, &solver->link[i]);
        for (int i = 0; i < 3 * solver->particles; i++) solver->v[i] = (solver->x[i] - solver->before[i]) / dt;
    }
}

void float_xpbd_read(const FloatXpbd *solver, double *position, double *velocity) {
    for (int i = 0; i < 3 * solver->particles; i++) {
        position[i] = (double)solver->x[i];
        velocity[i] = (double)solver->v[i];
    }
}

void float_xpbd_let_go(FloatXpbd *solver, int particle) {
    solver->weight[particle] = 1 / solver->mass[particle];
    for (int axis = 0; axis < 3; axis++) solver->v[3 * particle + axis] = 0;
}
