// Contact loops over rows against the particles one by one, from random states.
#include "fixture_loops.h"

#include "collider.h"
#include "contact.h"
#include "near_surfaces.h"
#include "row_contact.h"
#include "statistics.h"
#include "vector.h"

#define PARTICLES 200
#define DT 2e-3

// Particles of 1 to 2 kg in a box, most of them near something, with what loops and formulas start from.
typedef struct Crowd {
    Fixture fixture;
    ck_Contact *contact;
    ck_RowContact *rows;
    double x[3 * PARTICLES], from[3 * PARTICLES], held[3 * PARTICLES], depth[PARTICLES], mass[PARTICLES];
    double way[3 * PARTICLES], gain[3 * PARTICLES];
} Crowd;

static double within(ck_Random *random, double most) {
    return most * (2 * ck_random_unit(random) - 1);
}

// On the surface of a collider, or a little off it; some, and where there is none, anywhere.
static void place(Crowd *crowd, ck_Random *random, int i) {
    const ck_Model *model = &crowd->fixture.model;
    double *x = crowd->x + 3 * i, normal[3];
    for (int axis = 0; axis < 3; axis++) x[axis] = within(random, 0.5);
    if (ck_random_unit(random) < 0.3) return;
    const ck_Collider *collider = &model->colliders[i % model->collider_count];
    const double gap = ck_collider_gap(collider, x, normal);
    static const double offs[] = {0, 1e-16, -1e-16, 1e-4, -1e-4};
    ck_add_scaled(x, offs[i % 5] - gap, normal);
}

// What loops leave alone.
static void press_alone(void *state, int particle, const double *from, double *depth, double *held, double *x,
                        double *impulse) {
    const Crowd *crowd = state;
    ck_Contact contact = *crowd->contact;
    ck_Pressed pressed = {*depth, {held[0], held[1], held[2]}};
    memset(contact.impulse, 0, sizeof contact.impulse);
    ck_contact_project(&contact, crowd->mass[particle], from, &pressed, x);
    *depth = pressed.depth;
    memcpy(held, pressed.held, sizeof pressed.held);
    ck_add_scaled(impulse, 1, contact.impulse);
}

static void scatter(double *tiles, const double *vectors) {
    ck_row_contact_take(tiles, vectors, PARTICLES);
}

static void gather_crowd(Crowd *crowd, const char *colliders, uint64_t seed) {
    char text[900];
    ck_Random random = ck_random_seed(seed);
    snprintf(text, sizeof text,
             "name: crowd\ncloth: {rows: 2, columns: 100, spacing: 0.05, mass: 1, origin: [0, 9, 0]}\n"
             "springs: {stiffness: 1}\ngravity: [0, -9.81, 0]\ncolliders:\n%stime: {duration: 1, step: 0.002}\n",
             colliders);
    fixture_load(&crowd->fixture, text);
    assert_int_equal(crowd->fixture.model.particle_count, PARTICLES);
    assert_int_equal(ck_contact_create(&crowd->contact, &crowd->fixture.model, DT, NULL), CK_OK);
    for (int i = 0; i < PARTICLES; i++) {
        place(crowd, &random, i);
        crowd->mass[i] = i % 7 ? 1 + ck_random_unit(&random) : 0;
        crowd->depth[i] = i % 3 ? 0 : 1e-4 * ck_random_unit(&random);
        const double fast = i % 4 ? 3 * DT : 1e-3 * DT * DT;
        for (int axis = 0; axis < 3; axis++) {
            crowd->from[3 * i + axis] = crowd->x[3 * i + axis] + within(&random, 2e-3);
            crowd->held[3 * i + axis] = i % 3 ? 0 : within(&random, 2e-5);
            crowd->way[3 * i + axis] = i % 11 ? within(&random, fast) : 0;
            crowd->gain[3 * i + axis] = DT * DT * (within(&random, 2) - 9.81 * (axis == 1));
        }
    }
    ck_NearSurface surfaces[8];
    assert_true(crowd->fixture.model.collider_count <= 8);
    ck_near_surfaces(surfaces, crowd->contact);
    const ck_Touched touched = {surfaces, crowd->fixture.model.collider_count, DT, crowd->contact->slack};
    const ck_Follower follower = {.state = crowd, .press = press_alone};
    assert_int_equal(ck_row_contact_create(&crowd->rows, ck_loops_at(0), &touched, &follower, PARTICLES, NULL), CK_OK);
    memcpy(crowd->rows->mass, crowd->mass, sizeof crowd->mass);
    ck_near_surfaces_at_end(ck_row_contact_surfaces(crowd->rows, true), crowd->contact);
    scatter(crowd->rows->x, crowd->x);
    scatter(crowd->rows->from, crowd->from);
    scatter(crowd->rows->held, crowd->held);
    scatter(crowd->rows->way, crowd->way);
    scatter(crowd->rows->gain, crowd->gain);
    memcpy(crowd->rows->depth, crowd->depth, sizeof crowd->depth);
}

static void scatter_crowd(Crowd *crowd) {
    ck_row_contact_destroy(crowd->rows);
    free(crowd->contact);
    fixture_free(&crowd->fixture);
}

static const char *const colliders[] = {
    "  - {plane: {point: [0, 0.1, 0], normal: [0.2, 1, 0], friction: 0.5}}\n",
    "  - {sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.8}}\n",
    "  - {sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.2}}\n"
    "  - {plane: {point: [0, -0.2, 0], normal: [0, 1, 0]}}\n"
    "  - {sphere: {center: [0.4, 0, 0], radius: 0.2, friction: 1}}\n",
    "  - {sphere: {center: [0, 0, 0], radius: 0.3, friction: 0.4}, path: {velocity: [0.5, 0.2, 0]}}\n"
    "  - {plane: {point: [0, -0.2, 0], normal: [0, 1, 0], friction: 0.5}, path: {amplitude: [0, 0.1, 0.1], frequency: "
    "3}}\n",
    "  - {capsule: {from: [-0.2, 0, 0.1], to: [0.3, 0.1, 0], radius: 0.1, friction: 0.6}}\n",
    "  - {cylinder: {point: [0, 0.1, 0], axis: [0, 0, 1], radius: 0.2, friction: 0.3}, path: {velocity: [0, 1, 0]}}\n"
    "  - {box: {center: [0.2, -0.1, 0], size: [0.3, 0.4, 0.3], rounding: 0.03, friction: 0.4}}\n",
    "  - {box: {center: [0, 0, 0], size: [0.3, 0.4, 0.3], friction: 0.4}}\n"
    "  - {plane: {point: [0, -0.15, 0], normal: [0, 1, 0.1], friction: 0.5}}\n",
};
#define CROWDS (sizeof colliders / sizeof *colliders)

// Places, holds and impulses as by the formulas: rounding of a metre, and of ways that are taken from it, over rounds.
static void test_press(void **state) {
    (void)state;
    for (size_t k = 0; k < CROWDS; k++)
        for (int kind = 0; ck_loops_at(kind); kind++) {
            Crowd crowd;
            double given[3] = {0};
            int pressed = 0;
            gather_crowd(&crowd, colliders[k], 7 + k);
            for (int row = 0; row < crowd.rows->rows.rows; row++) {
                ck_loops_at(kind)->row_press(crowd.rows, row);
                double now[3 * PARTICLES];
                ck_row_contact_give(crowd.rows, row, now, PARTICLES);
                for (int i = row * CK_STRIPE; i < (row + 1) * CK_STRIPE && i < PARTICLES; i++) {
                    ck_Pressed alone = {crowd.depth[i], {0}};
                    memcpy(alone.held, crowd.held + 3 * i, sizeof alone.held);
                    double *x = crowd.x + 3 * i, was[3] = {x[0], x[1], x[2]};
                    if (crowd.mass[i] > 0)
                        ck_contact_project(crowd.contact, crowd.mass[i], crowd.from + 3 * i, &alone, x);
                    assert_near(colliders[k], ck_distance(x, now + 3 * i), 0, 1e-14);
                    assert_near("depth", crowd.rows->depth[i], alone.depth, 1e-14);
                    pressed += ck_distance(x, was) > 0;
                }
            }
            assert_true(pressed > 10);
            ck_row_contact_impulse(crowd.rows, given);
            assert_near("impulse", ck_distance(given, crowd.contact->impulse), 0, 1e-14 * PARTICLES * 2 / DT);
            scatter_crowd(&crowd);
        }
}

// The loop may err on one side only: who meets a surface is always among those whose follower is asked. Most of the
// others are not.
static void test_meets(void **state) {
    (void)state;
    for (size_t k = 0; k < CROWDS; k++)
        for (int kind = 0; ck_loops_at(kind); kind++) {
            Crowd crowd;
            int asked = 0, met = 0;
            gather_crowd(&crowd, colliders[k], 70 + k);
            for (int i = 0; i < PARTICLES; i++) {
                const bool is_asked = ck_loops_at(kind)->row_meets(crowd.rows, i / CK_STRIPE) >> i % CK_STRIPE & 1;
                double field[3], v[3];
                for (int axis = 0; axis < 3; axis++) {
                    field[axis] = crowd.gain[3 * i + axis] / (DT * DT);
                    v[axis] = crowd.way[3 * i + axis] / DT + 0.5 * DT * field[axis];
                }
                const bool meets =
                    crowd.mass[i] > 0 && ck_contact_meet(crowd.contact, crowd.mass[i], field, crowd.x + 3 * i, v);
                asked += is_asked;
                met += meets;
                if (meets && !is_asked) fail_msg("particle %d meets one of %s", i, colliders[k]);
            }
            // bounds without roots are up to √3 too long
            assert_true(met > 10 && asked < 2 * met + 20);
            scatter_crowd(&crowd);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_press), cmocka_unit_test(test_meets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
