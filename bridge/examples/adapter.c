// A solver of one's own as an engine of clothcheck: damped springs by symplectic Euler, in C.
//     cc -O2 adapter.c -lm -o adapter && clothcheck run SCENE --engine 'mine=./adapter'
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double x[3], v[3], f[3], mass;
    int pinned;
} Particle;
typedef struct {
    int a, b;
    double rest, k, c;
} Spring;
static Particle *particles;
static Spring *springs;
static double frame, gravity[3], force[3], drag;
static int n, m, substeps;
static char word[64];

static int next_word(void) {
    return scanf("%63s", word) == 1;
}
static double number(void) {
    return next_word() ? strtod(word, NULL) : 0;
}
static void vector(double *to) {
    for (int axis = 0; axis < 3; axis++) to[axis] = number();
}

// The scene in SI units, up to the line "end": what is not used is stepped over.
static void begin(void) {
    double rate = 0; // k/m of all springs on the lightest particle, 1/s2
    while (next_word() && strcmp(word, "end")) {
        if (!strcmp(word, "step"))
            frame = number();
        else if (!strcmp(word, "gravity"))
            vector(gravity);
        else if (!strcmp(word, "force"))
            vector(force);
        else if (!strcmp(word, "drag"))
            drag = number();
        else if (!strcmp(word, "substeps"))
            substeps = (int)number();
        else if (!strcmp(word, "particles")) {
            particles = calloc((n = (int)number()), sizeof *particles);
            for (Particle *p = particles; p < particles + n; p++)
                vector(p->x), vector(p->v), p->mass = number(), p->pinned = (int)number();
        } else if (!strcmp(word, "springs")) {
            springs = calloc((m = (int)number()) + 1, sizeof *springs);
            for (Spring *s = springs; s < springs + m; s++, next_word()) {
                s->a = (int)number(), s->b = (int)number(), s->rest = number(), s->k = number(), s->c = number();
                rate = fmax(rate, 8 * s->k / fmin(particles[s->a].mass, particles[s->b].mass));
            }
        }
    }
    if (!substeps) substeps = (int)fmax(1, ceil(frame * sqrt(rate)));
    printf("uses substeps %d\nready\n", substeps);
}

static void step(double dt) {
    for (Particle *p = particles; p < particles + n; p++)
        for (int axis = 0; axis < 3; axis++) p->f[axis] = p->mass * (gravity[axis] - drag * p->v[axis]) + force[axis];
    for (Spring *s = springs; s < springs + m; s++) {
        Particle *a = &particles[s->a], *b = &particles[s->b];
        double d[3] = {b->x[0] - a->x[0], b->x[1] - a->x[1], b->x[2] - a->x[2]}, speed = 0;
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        for (int axis = 0; axis < 3; axis++) speed += d[axis] / length * (b->v[axis] - a->v[axis]);
        double pull = (s->k * (length - s->rest) + s->c * speed) / length;
        for (int axis = 0; axis < 3; axis++) a->f[axis] += pull * d[axis], b->f[axis] -= pull * d[axis];
    }
    for (Particle *p = particles; p < particles + n; p++)
        for (int axis = 0; axis < 3 && !p->pinned; axis++)
            p->v[axis] += dt * p->f[axis] / p->mass, p->x[axis] += dt * p->v[axis];
}

int main(void) {
    for (; next_word() && strcmp(word, "quit"); fflush(stdout)) {
        if (!strcmp(word, "clothcheck") && next_word())
            printf("clothcheck 1\n");
        else if (!strcmp(word, "hello"))
            printf("version 1.0\nmodels springs damping gravity force drag velocity release\npositions raw\n"
                   "setting substeps 1 1e6 whole steps a frame\nend\n");
        else if (!strcmp(word, "begin"))
            begin();
        else if (!strcmp(word, "release"))
            particles[(int)number()].pinned = 0;
        else if (!strcmp(word, "read")) // all places, then all velocities
            for (int i = 0; i < 2 * n; i++)
                fwrite(i < n ? particles[i].x : particles[i - n].v, sizeof(double), 3, stdout);
        else { // step, ping
            for (int i = 0; !strcmp(word, "step") && i < substeps; i++) step(frame / substeps);
            printf("ok\n");
        }
    }
    return 0;
}
