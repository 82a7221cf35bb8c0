// What vectors of particles on a surface do in a substep, against one particle at a time.
#include "fixture_loops.h"

#include "collider.h"
#include "contact.h"
#include "near_surfaces.h"
#include "slide.h"
#include "statistics.h"
#include "vector.h"

#define MANY 64

typedef struct Trial {
    ck_Model model;
    ck_Collider collider;
    ck_Contact *contact;
    ck_NearSurface surface;
    ck_Loose loose;
    long place[MANY];
    double x[3 * MANY], v[3 * MANY], a[3 * MANY], predicted[3 * MANY], normal[3 * MANY];
    double mass[MANY], curvature[MANY], friction[MANY], is_alone[MANY];
} Trial;

static double any(ck_Random *random, double low, double high) {
    return low + (high - low) * ck_random_unit(random);
}

static void any_direction(ck_Random *random, double *way) {
    do
        for (int axis = 0; axis < 3; axis++) way[axis] = any(random, -1, 1);
    while (ck_length(way) < 0.1 || ck_length(way) > 1);
    const double length = ck_length(way);
    for (int axis = 0; axis < 3; axis++) way[axis] /= length;
}

// On a surface, or just out of it; pressed on or pulled off; still, slow enough to stop or turn within a substep, or
// faster; seldom into it or away.
static void place(Trial *trial, int i, ck_Random *random) {
    double normal[3], along[3], x[3], v[3] = {0, 0, 0}, a[3];
    const double dt = trial->contact->dt, pull = 9.81;
    any_direction(random, normal);
    any_direction(random, along);
    any_direction(random, a);
    if (trial->collider.shape == CK_PLANE) memcpy(normal, trial->collider.normal, sizeof normal);
    memcpy(x, trial->collider.point, sizeof x);
    ck_add_scaled(x, trial->collider.radius, normal);
    for (int axis = 0; axis < 3; axis++) a[axis] *= any(random, 0, pull);
    ck_add_scaled(a, -any(random, -0.1, 1) * pull, normal);
    ck_tangential(along, along, normal);
    const double speeds[] = {0, any(random, 0, 2) * pull * dt, any(random, 0, 2)};
    ck_add_scaled(v, speeds[ck_random_next(random) % 3], along);
    const double pushes[] = {0, 0, 0, any(random, -1, 4) * pull * dt};
    ck_add_scaled(v, pushes[ck_random_next(random) % 4], normal);
    for (int axis = 0; axis < 3; axis++) {
        const long at = axis * trial->loose.stride + i;
        trial->x[at] = x[axis];
        trial->v[at] = v[axis];
        trial->a[at] = a[axis];
    }
    trial->mass[i] = 1;
}

static void begin(Trial *trial, uint64_t seed) {
    ck_Random random = ck_random_seed(seed);
    ck_Error error;
    *trial = (Trial){.loose = {.count = MANY, .stride = MANY}};
    ck_Collider *collider = &trial->collider;
    collider->shape = seed % 3 ? CK_SPHERE : CK_PLANE;
    collider->radius = seed % 3 ? any(&random, 0.05, 1) : 0;
    collider->friction = seed % 4 ? any(&random, 0, 1.5) : 0;
    any_direction(&random, collider->normal);
    any_direction(&random, collider->point);
    trial->model = (ck_Model){.colliders = collider, .collider_count = 1, .spacing = 0.02};
    assert_int_equal(ck_contact_create(&trial->contact, &trial->model, any(&random, 1e-4, 1e-3), &error), CK_OK);
    trial->contact->elapsed = trial->contact->dt;
    ck_near_surfaces(&trial->surface, trial->contact);
    ck_Loose *loose = &trial->loose;
    loose->place = trial->place;
    loose->x = trial->x;
    loose->v = trial->v;
    loose->a = trial->a;
    loose->predicted = trial->predicted;
    loose->normal = trial->normal;
    loose->mass = trial->mass;
    loose->curvature = trial->curvature;
    loose->friction = trial->friction;
    loose->is_alone = trial->is_alone;
    for (int i = 0; i < MANY; i++) place(trial, i, &random);
}

// A particle at the start of a substep.
typedef struct Start {
    double x[3], v[3], a[3];
} Start;

static Start start_of(const Trial *trial, int i) {
    Start start;
    for (int axis = 0; axis < 3; axis++) {
        const long at = axis * trial->loose.stride + i;
        start.x[axis] = trial->x[at];
        start.v[axis] = trial->v[at];
        start.a[axis] = trial->a[at];
    }
    return start;
}

// What it does, by its state.
typedef enum Deed { LIES, SLIDES, STOPS, TURNS, LEAVES, STRIKES, DEEDS } Deed;

static const char *const deed_names[] = {"lies", "slides", "stops", "turns", "leaves", "strikes"};

static Deed deed_of(const Trial *trial, const Start *start) {
    const double dt = trial->contact->dt, friction = trial->collider.friction;
    double normal[3], along[3], push[3], left[3];
    ck_collider_gap(&trial->collider, start->x, normal);
    const double out = ck_dot(start->v, normal),
                 press = ck_slide_press(&trial->collider, normal, start->x, start->v, start->a);
    if (out > 1e-12 * ck_length(start->v) || !(press > 0)) return LEAVES;
    if (-out > 1e-12 * ck_length(start->v)) return STRIKES;
    ck_tangential(along, start->v, normal);
    ck_tangential(push, start->a, normal);
    memcpy(left, start->a, sizeof left);
    ck_slide_hold(&trial->collider, normal, dt, start->x, start->v, left);
    if (ck_length(along) == 0) return ck_length(push) < friction * press ? LIES : SLIDES;
    ck_Ending ending;
    const double stop = ck_slide_stop_time(friction * press, dt, start->v, push, left, &ending);
    return friction > 0 && stop < dt ? ending == CK_STOPS ? STOPS : TURNS : SLIDES;
}

// One at a time ends as vectors have it: a root and a normal there are good to 4e-14, a place to its rounding; and a
// speed is a root of what work leaves, so that its square is told.
static void compare(const Trial *before, const Trial *after, int i) {
    const Start start = start_of(before, i);
    const double dt = before->contact->dt, most = ck_length(start.v) + dt * ck_length(start.a);
    double x[3], v[3], left[3], kept[3], off[3], slower[3];
    memcpy(x, start.x, sizeof x);
    memcpy(v, start.v, sizeof v);
    ck_contact_advance(before->contact, 1, x, v, start.a);
    ck_contact_filter(before->contact, x, v, start.a, left);
    memcpy(kept, v, sizeof kept);
    ck_add_scaled(kept, -0.5 * dt, left);
    for (int axis = 0; axis < 3; axis++) {
        const long at = axis * before->loose.stride + i;
        assert_near("place", after->x[at], x[axis], 1e-12 * dt * most + 1e-15);
        off[axis] = after->predicted[at] - v[axis];
        slower[axis] = after->v[at] - kept[axis];
    }
    const double enough = 1e-12 * most;
    if (ck_length(off) > enough) assert_near("speed", ck_length(off) * ck_length(v), 0, enough * most);
    if (ck_length(slower) > enough) assert_near("half a kick", ck_length(slower) * ck_length(v), 0, enough * most);
}

static void test_slides(void **state) {
    (void)state;
    long done[DEEDS] = {0}, all[DEEDS] = {0};
    for (uint64_t seed = 1; seed <= 600; seed++)
        for (int kind = 0; ck_loops_at(kind); kind++) {
            Trial before, after;
            begin(&before, seed);
            begin(&after, seed);
            const ck_Touched touch = {&after.surface, 1, after.contact->dt, after.contact->slack};
            ck_loops_at(kind)->touch_slide(&touch, &after.loose, after.contact->impulse);
            for (int i = 0; i < MANY; i++) {
                const Start start = start_of(&before, i);
                const Deed deed = deed_of(&before, &start);
                all[deed]++;
                if (after.is_alone[i] > 0) continue;
                done[deed]++;
                compare(&before, &after, i);
            }
            free(before.contact);
            free(after.contact);
        }
    for (int deed = 0; deed < DEEDS; deed++)
        print_message("%-7s %6ld, %6ld of them in vectors\n", deed_names[deed], all[deed], done[deed]);
    for (int deed = LIES; deed <= STOPS; deed++) assert_int_equal(done[deed], all[deed]);
    // a way may turn twice in a substep, and what hardly leaves may come back
    for (int deed = TURNS; deed < DEEDS; deed++) assert_true(3 * done[deed] > all[deed]);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_slides)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
