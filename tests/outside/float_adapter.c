// The solver as a command, which reads the scene's lines into a model of its own.
#include "float_xpbd.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ck_Model model;
static int substeps = FLOAT_XPBD_SUBSTEPS;

static void numbers(double *to, int count) {
    for (int i = 0; i < count; i++)
        if (scanf("%lf", to + i) != 1) exit(1);
}

static void read_particles(void) {
    const size_t n = (size_t)model.particle_count;
    model.position = calloc(3 * n, sizeof(double));
    model.velocity = calloc(3 * n, sizeof(double));
    model.mass = calloc(n, sizeof(double));
    model.pinned = calloc(n, sizeof(bool));
    for (size_t i = 0; i < n; i++) {
        int pinned;
        numbers(model.position + 3 * i, 3);
        numbers(model.velocity + 3 * i, 3);
        numbers(model.mass + i, 1);
        if (scanf("%d", &pinned) != 1) exit(1);
        model.pinned[i] = pinned;
    }
}

static void read_springs(void) {
    char kind[32];
    model.springs = calloc((size_t)model.spring_count + 1, sizeof *model.springs);
    for (ck_Spring *s = model.springs; s < model.springs + model.spring_count; s++)
        if (scanf("%d %d %lf %lf %lf %31s", &s->a, &s->b, &s->rest, &s->stiffness, &s->damping, kind) != 6) exit(1);
}

static FloatXpbd *begin(void) {
    char word[64];
    while (scanf("%63s", word) == 1 && strcmp(word, "end")) {
        if (!strcmp(word, "step")) numbers(&model.step, 1);
        if (!strcmp(word, "gravity")) numbers(model.gravity, 3);
        if (!strcmp(word, "force")) numbers(model.force, 3);
        if (!strcmp(word, "drag")) numbers(&model.drag, 1);
        if (!strcmp(word, "setting") && scanf(" substeps %d", &substeps) != 1) exit(1);
        if (!strcmp(word, "particles") && scanf("%d", &model.particle_count) == 1) read_particles();
        if (!strcmp(word, "springs") && scanf("%d", &model.spring_count) == 1) read_springs();
    }
    printf("uses substeps %d\nready\n", substeps);
    return float_xpbd_new(&model, substeps);
}

static void tell(const FloatXpbd *solver) {
    const size_t count = 3 * (size_t)model.particle_count;
    double *state = calloc(2 * count, sizeof *state);
    float_xpbd_read(solver, state, state + count);
    fwrite(state, sizeof *state, 2 * count, stdout);
    free(state);
}

int main(void) {
    FloatXpbd *solver = NULL;
    char word[64];
    for (int particle; scanf("%63s", word) == 1 && strcmp(word, "quit"); fflush(stdout)) {
        if (!strcmp(word, "clothcheck") && scanf("%63s", word) == 1) printf("clothcheck 1\n");
        if (!strcmp(word, "hello"))
            printf("version 2.1 float\nmodels springs gravity force drag velocity release\npositions raw\nprecision "
                   "single\n"
                   "setting substeps 1 1e6 whole steps a frame\nend\n");
        if (!strcmp(word, "ping")) printf("ok\n");
        if (!strcmp(word, "begin")) solver = begin();
        if (!strcmp(word, "release") && scanf("%d", &particle) == 1) float_xpbd_let_go(solver, particle);
        if (!strcmp(word, "step")) {
            float_xpbd_step(solver);
            printf("ok\n");
        }
        if (!strcmp(word, "read")) tell(solver);
    }
    float_xpbd_free(solver);
    return 0;
}
