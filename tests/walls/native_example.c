// Damped springs by symplectic Euler: the smallest engine there can be, and the example of src/README.md. The test of
// the walls adds it to a copy of the program: this file, one line in src/native/CMakeLists.txt, one row a setting.
#include "own_ledger.h"
#include "springs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// The number of its own setting.
enum { OWN_SLOWNESS };

typedef struct Example {
    const ck_Model *model;
    uint32_t substeps;
    double dt;
    double *position, *velocity, *acceleration; // [3*n]
} Example;

static void destroy(void *state) {
    Example *example = state;
    free(example->position);
    free(example);
}

static ck_Status create(void **state, const ck_Model *model, const ck_Settings *wanted, ck_Settings *used,
                        ck_Ledger *ledger, ck_Error *error) {
    size_t count = 3 * (size_t)model->particle_count;
    Example *example = calloc(1, sizeof *example);
    double *memory = calloc(3 * count, sizeof *memory);
    if (!example || !memory) {
        free(example);
        free(memory);
        return ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    *used = *wanted;
    if (!used->substeps) used->substeps = 100;
    *example =
        (Example){model, used->substeps, model->step / used->substeps, memory, memory + count, memory + 2 * count};
    example->dt /= ck_settings_own(wanted, OWN_SLOWNESS, 1);
    memcpy(example->position, model->position, count * sizeof *memory);
    memcpy(example->velocity, model->velocity, count * sizeof *memory);
    ck_own_ledger_springs(ledger, model, "k", "k", CK_EXACT);
    *state = example;
    return CK_OK;
}

static ck_StepResult step(void *state) {
    Example *example = state;
    double sum = 0;
    for (uint32_t substep = 0; substep < example->substeps; substep++) {
        ck_springs_accelerate(example->model, example->position, example->velocity, example->acceleration);
        for (int i = 0; i < 3 * example->model->particle_count; i++) {
            example->velocity[i] += example->dt * example->acceleration[i];
            example->position[i] += example->dt * example->velocity[i];
            sum += example->position[i];
        }
    }
    return isfinite(sum) ? CK_STEP_OK : CK_STEP_DIVERGED;
}

static void read_state(const void *state, double *position, double *velocity) {
    const Example *example = state;
    size_t bytes = 3 * sizeof(double) * (size_t)example->model->particle_count;
    memcpy(position, example->position, bytes);
    memcpy(velocity, example->velocity, bytes);
}

static const ck_Setting settings[] = {
    {.name = "substeps",
     .slot = CK_SUBSTEPS,
     .is_whole = true,
     .least = 1,
     .most = 1e6,
     .unit = "1",
     .rule = "100",
     .help = "steps a frame"},
    // a row is all that a setting takes
    {0},
};

const ck_Engine ck_native_example = {
    .name = "native-example",
    .about = "damped springs by symplectic Euler",
    .family = "native",
    .version = ck_own_version,
    .terms = CK_TERM_SPRINGS | CK_TERM_DAMPING | CK_TERM_GRAVITY | CK_TERM_FORCE | CK_TERM_DRAG | CK_TERM_VELOCITY,
    .settings = settings,
    .create = create,
    .step = step,
    .read = read_state,
    .destroy = destroy,
};
