// The kernels of position constraints, in rows, against the plain loops that they stand for.
#include "fixture_lines.h"
#include "fixture_loops.h"

#include "constraint_kernel.h"
#include "springs.h"
#include "sweep_list_loop.h"
#include "sweep_order.h"
#include "vector.h"

// One spring by its formula, as constraint_kernel.h gives it. Tells of a long bar, and asks all whether they turned.
static void plain_project(const ck_Model *model, const ck_ProjectionRule *rule, const ck_Spring *spring,
                          const double *start, double *x, double *multiplier, bool asks_all, bool *is_far) {
    double *a = x + 3 * spring->a, *b = x + 3 * spring->b, now[3], old[3], dt = rule->dt;
    double weight_a = ck_model_inverse_mass(model, spring->a), weight_b = ck_model_inverse_mass(model, spring->b);
    if (weight_a + weight_b == 0) return;
    ck_subtract(now, b, a);
    ck_subtract(old, start + 3 * spring->b, start + 3 * spring->a);
    double length = ck_length(now), along = ck_dot(now, old), change;
    if (rule->projection == CK_PROJECT_BARS) {
        double square = spring->rest * spring->rest;
        bool is_long = length * length > CK_LONG_BAR * square;
        const double *way = is_long || (asks_all && along < CK_TURNED_BAR * square) ? now : old;
        change = -0.5 * rule->relaxation * (length * length - square) / (weight_a + weight_b);
        change /= is_long ? length * length : square;
        if (is_long) *is_far = true;
        ck_add_scaled(a, -weight_a * change, way);
        ck_add_scaled(b, weight_b * change, way);
        return;
    }
    double compliance = 1 / (spring->stiffness * dt * dt), gamma = spring->damping / (spring->stiffness * dt);
    double moved = (length * length - along) / length; // ∇C·(x − x_start)
    if (spring->pulls_only && length < spring->rest && !(*multiplier < 0)) return;
    change = -rule->relaxation * (length - spring->rest + compliance * *multiplier + gamma * moved) /
             ((1 + gamma) * (weight_a + weight_b) + compliance);
    if (spring->pulls_only) change = fmin(change, -*multiplier);
    *multiplier += change;
    ck_add_scaled(a, -weight_a * change / length, now);
    ck_add_scaled(b, weight_b * change / length, now);
}

// pulls  [3*n] m: what the constraints of lines moved particles by in the substep before; this one begins with half of
// it
static void plain_substep(const ck_Model *model, const ck_ProjectionRule *rule, const int *order, double *x, double *v,
                          double *before, double *pulls) {
    int count = 3 * model->particle_count;
    double *start = malloc(sizeof *start * (size_t)count);
    double *multipliers = calloc((size_t)model->spring_count, sizeof *multipliers);
    memcpy(start, x, sizeof *start * (size_t)count);
    memcpy(before, v, sizeof *v * (size_t)count);
    for (int i = 0; i < count; i++)
        if (!model->pinned[i / 3]) x[i] += rule->dt * (rule->carry * v[i] + rule->push[i % 3]);
    for (int i = 0; i < count; i++) {
        const double flown = x[i];
        x[i] += rule->projection == CK_PROJECT_LINES ? 0.5 * pulls[i] : 0;
        pulls[i] = -flown;
    }
    const size_t rows = (size_t)(model->particle_count / model->columns);
    bool *is_far = calloc(2 * rows, sizeof *is_far), *was_far = is_far + rows;
    for (uint32_t sweep = 0; sweep < rule->iterations; sweep++) {
        bool has_lines = rule->projection == CK_PROJECT_LINES;
        if (has_lines) fixture_sweep_lines(model, rule->dt, 0.5 * (1 + rule->carry), order, start, x, multipliers);
        for (int k = 0; k < model->spring_count && !has_lines; k++) {
            const int i =
                order[ck_sweep_is_turned(rule->projection, sweep, rule->iterations) ? model->spring_count - 1 - k : k];
            const ck_Spring *spring = &model->springs[i];
            const int row = spring->a / model->columns;
            plain_project(model, rule, spring, start, x, &multipliers[i], was_far[row], &is_far[row]);
        }
        memcpy(was_far, is_far, rows * sizeof *is_far);
    }
    free(is_far);
    for (int i = 0; i < count; i++) {
        v[i] = rule->keep * (x[i] - start[i]) / rule->dt;
        pulls[i] += x[i];
    }
    free(start);
    free(multipliers);
}

// Roots and sums rounded otherwise, 1e-16 a substep; sweeps only even them out, substeps let them grow by less than
// 1e4.
static void compare_projection(const char *size, const char *springs, const char *noise, ck_Projection projection,
                               uint32_t iterations, uint32_t substeps) {
    char text[500];
    int columns;
    assert_int_equal(sscanf(size, "rows: %*d, columns: %d", &columns), 1);
    snprintf(
        text, sizeof text,
        "name: kernel\ncloth: {%s, spacing: 0.1, mass: 1, down: [0, 0, 1]}\nsprings: {%s}\npins: [top_left, 0:%d]\n"
        "noise: {amplitude: %s, seed: 5}\nvelocity: [0.3, -0.5, 0.2]\ngravity: [0, -9.81, 1]\n"
        "time: {duration: 1, step: 0.01}\n",
        size, springs, columns > 2 ? 2 : 1, noise);
    Fixture fixture;
    fixture_load(&fixture, text);
    const ck_Model *model = &fixture.model;
    size_t count = 3 * (size_t)model->particle_count;
    double *state = calloc(3 * count, sizeof *state), *weight = malloc(count * sizeof *weight), dt = 2e-3;
    double *x = state, *v = state + count, *before = state + 2 * count;
    int *order = malloc(sizeof *order * (size_t)model->spring_count);
    ck_ProjectionRule rule = {
        projection,          dt,   iterations, 0.99,
        {0, -9.81 * dt, dt}, 0.98, 0,          iterations > 1 && projection != CK_PROJECT_LINES ? 1.3 : 1};
    ck_RowSprings row_springs;
    memcpy(x, model->position, count * sizeof *x);
    memcpy(v, model->velocity, count * sizeof *v);
    for (int i = 0; i < model->particle_count; i++) weight[i] = ck_model_inverse_mass(model, i);
    assert_true(ck_projection_fits(model, &row_springs));
    assert_int_equal(ck_sweep_order(model, projection, iterations, order), CK_OK);
    double *results[MOST_LOOPS];
    for (int kind = 0; ck_loops_at(kind); kind++) {
        ck_ProjectedCloth *cloth;
        double *result = results[kind] = calloc(3 * count, sizeof *x);
        const ck_ProjectionSetup setup = {.loops = ck_loops_at(kind),
                                          .model = model,
                                          .springs = &row_springs,
                                          .rule = &rule,
                                          .position = x,
                                          .velocity = v,
                                          .before = before,
                                          .inverse_mass = weight};
        assert_int_equal(ck_projection_create(&cloth, &setup, NULL), CK_OK);
        // in two calls, as two frames are
        ck_projection_step(cloth, substeps / 4, NULL);
        ck_projection_step(cloth, substeps - substeps / 4, NULL);
        ck_projection_read(cloth, result, result + count, result + 2 * count);
        for (size_t i = count; i < 3 * count; i++) result[i] *= dt;
        ck_projection_destroy(cloth);
    }
    double *pulls = calloc(count, sizeof *pulls);
    for (uint32_t i = 0; i < substeps; i++) {
        plain_substep(model, &rule, order, x, v, before, pulls);
        for (size_t k = 0; k < count && i == 0; k++) pulls[k] *= 2; // all of the first one's, see line_kernel.c
    }
    free(pulls);
    for (size_t i = count; i < 3 * count; i++) state[i] *= dt;
    fixture_compare_loops(text, results, state, 3 * count);
    double moved = 0;
    for (size_t i = 0; i < count; i++) moved = fmax(moved, fabs(x[i] - model->position[i]));
    assert_true(moved > 1e-2);
    free(order);
    free(state);
    free(weight);
    fixture_free(&fixture);
}

// One sweep and several, one substep's in a block of interleaved sweeps or its sweeps in several blocks.
static void test_projection(void **state) {
    (void)state;
    static const char *const sizes[] = {"rows: 2, columns: 3", "rows: 5, columns: 8", "rows: 6, columns: 16",
                                        "rows: 9, columns: 19", "rows: 12, columns: 33"};
    static const char *const springs[] = {"stiffness: 100", "stiffness: 100, shear: 50",
                                          "stiffness: 100, shear: 50, damping: 0.05"};
    for (size_t size = 0; size < sizeof sizes / sizeof *sizes; size++)
        for (size_t i = 0; i < sizeof springs / sizeof *springs; i++)
            for (uint32_t iterations = 1; iterations < 7; iterations += iterations < 3 ? 1 : 3) {
                compare_projection(sizes[size], springs[i], "0.01", CK_PROJECT_BARS, iterations, 50);
                compare_projection(sizes[size], springs[i], "0.01", CK_PROJECT_SPRINGS, iterations, 50);
            }
    compare_projection(sizes[2], "rigid: true", "0.01", CK_PROJECT_SPRINGS, 3, 50);
    // so wide that sweeps share rows
    for (uint32_t iterations = 1; iterations < 8; iterations++) {
        compare_projection("rows: 6, columns: 85", springs[1], "0.01", CK_PROJECT_BARS, iterations, 20);
        compare_projection("rows: 7, columns: 96", springs[0], "0.01", CK_PROJECT_BARS, iterations, 20);
        compare_projection("rows: 7, columns: 85", springs[2], "0.01", CK_PROJECT_SPRINGS, iterations, 20);
    }
}

// Lines against a full solve of each, over sheets as wide as vectors and not, and wider than long.
static void test_lines(void **state) {
    (void)state;
    static const char *const sizes[] = {"rows: 2, columns: 2",  "rows: 2, columns: 3",  "rows: 12, columns: 2",
                                        "rows: 6, columns: 16", "rows: 33, columns: 8", "rows: 9, columns: 19",
                                        "rows: 5, columns: 40"};
    static const char *const springs[] = {"stiffness: 100", "stiffness: 1e6, shear: 50",
                                          "stiffness: 100, shear: 50, damping: 0.05"};
    for (size_t size = 0; size < sizeof sizes / sizeof *sizes; size++)
        for (size_t i = 0; i < sizeof springs / sizeof *springs; i++)
            for (uint32_t iterations = 1; iterations < 4; iterations += 2)
                compare_projection(sizes[size], springs[i], "0.01", CK_PROJECT_LINES, iterations, 50);
}

// Bars of up to three times their length, turned and not, with held ends and free ones. Such corrections let rounding
// grow by more than ten a sweep, so that there are few of them.
static void test_far_bars(void **state) {
    (void)state;
    compare_projection("rows: 5, columns: 8", "stiffness: 100, shear: 50", "0.08", CK_PROJECT_BARS, 3, 2);
    compare_projection("rows: 9, columns: 19", "stiffness: 100", "0.06", CK_PROJECT_BARS, 4, 2);
    compare_projection("rows: 12, columns: 33", "stiffness: 100, shear: 50", "0.08", CK_PROJECT_BARS, 2, 2);
    compare_projection("rows: 9, columns: 85", "stiffness: 100, shear: 50", "0.08", CK_PROJECT_BARS, 3, 2);
}

// Two bars that are torn down to twice their length, or aside, where they turn by 45° to 75° and there is none of their
// length along where they were: they have it again after forty sweeps, which on a bar converge as Newton's steps do.
static void test_torn_bars(void **state) {
    (void)state;
    static const char *const pulls[] = {"[0, -16, 0]", "[16, 0, 0]", "[19, 0, 0]", "[27.7, 0, 0]", "[60, 0, 0]"};
    for (size_t pull = 0; pull < sizeof pulls / sizeof *pulls; pull++) {
        char text[300];
        snprintf(text, sizeof text,
                 "name: torn\ncloth: {rows: 2, columns: 2, spacing: 1, mass: 1}\nsprings: {rigid: true}\npins: "
                 "[top_edge]\ngravity: %s\ntime: {duration: 0.25, step: 0.25}\n",
                 pulls[pull]);
        Fixture fixture;
        fixture_load(&fixture, text);
        for (int kind = 0; ck_loops_at(kind); kind++) {
            ck_Trajectory trajectory;
            const ck_Settings settings = {
                .substeps = 1, .iterations = 40, .own = {ck_loops_at(kind)->lanes}, .own_set = 1};
            fixture_run(&trajectory, &fixture.model, ck_engine_find("native-bars"), &settings, NULL);
            const double *x = ck_trajectory_position(&trajectory, 1);
            assert_near(pulls[pull], ck_distance(x, x + 6), 1, 1e-9);
            ck_trajectory_free(&trajectory);
        }
        fixture_free(&fixture);
    }
}

// Steps that a few sweeps cannot follow stretch sheets, but keep them finite: a long bar is projected along itself, by
// less than its length. In rows, in a list, as bars that bend are, and with contact.
static void test_coarse_bars(void **state) {
    (void)state;
    fixture_skip_sanitized();
    static const char *const bodies[] = {
        "springs: {stiffness: 1000, shear: 500}", "springs: {stiffness: 1000, shear: 500, bend: 10}",
        "springs: {stiffness: 1000}\ncolliders: [{plane: {point: [0, -0.3, 0], normal: [0, 1, 0]}}]"};
    for (size_t i = 0; i < 9; i++) {
        static const double steps[] = {0.0025, 0.016, 1};
        for (uint32_t iterations = 2; iterations <= 40; iterations *= 20) {
            char text[500];
            snprintf(
                text, sizeof text,
                "name: coarse\ncloth: {rows: 24, columns: 24, spacing: 0.04, mass: 0.2, down: [0, 0, 1]}\n%s\npins: "
                "[top_left, top_right]\ngravity: [0, -9.81, 0]\ntime: {duration: %g, step: %g}\n",
                bodies[i / 3], 200 * steps[i % 3], steps[i % 3]);
            Fixture fixture;
            ck_Trajectory trajectory;
            fixture_load(&fixture, text);
            fixture_run(&trajectory, &fixture.model, ck_engine_find("native-bars"),
                        &(ck_Settings){.substeps = 1, .iterations = iterations}, NULL);
            ck_trajectory_free(&trajectory);
            fixture_free(&fixture);
        }
    }
}

// Packs of a list against the springs one by one, in the order of sweeps and half of them back: 1e-11 of rounding as
// above. From where noise has put particles, a little way from there.
static void compare_list(const char *body, ck_Projection projection, uint32_t iterations, bool has_packs) {
    char text[500];
    snprintf(text, sizeof text, "name: list\n%s\nnoise: {amplitude: 0.02, seed: 7}\ntime: {duration: 1, step: 0.01}\n",
             body);
    Fixture fixture;
    fixture_load(&fixture, text);
    const ck_Model *model = &fixture.model;
    const size_t count = 3 * (size_t)model->particle_count, springs = (size_t)model->spring_count;
    const ck_ProjectionRule rule = {projection, 5e-3, iterations, 1, {0}, 1, 0, 1.2};
    double *x = malloc(2 * count * sizeof *x), *moved = x + count, *weight = malloc(count * sizeof *weight),
           *values = calloc(3 * springs, sizeof *values), *multiplier = values + 2 * springs, *results[MOST_LOOPS];
    for (size_t i = 0; i < count; i++) x[i] = moved[i] = model->position[i] + 3e-3 * sin(1.7 * (double)i);
    for (int i = 0; i < model->particle_count; i++) weight[i] = ck_model_inverse_mass(model, i);
    for (size_t i = 0; i < springs; i++) {
        values[i] = 1 / (model->springs[i].stiffness * rule.dt * rule.dt);
        values[springs + i] = model->springs[i].damping / (model->springs[i].stiffness * rule.dt);
    }
    const ck_SweepRule sweeps = {projection, iterations, rule.relaxation, weight, values, values + springs};
    for (int kind = 0; ck_loops_at(kind); kind++) {
        ck_SweepList *list;
        results[kind] = malloc(count * sizeof *x);
        assert_int_equal(ck_sweep_list_create(&list, ck_loops_at(kind), model, &sweeps, NULL), CK_OK);
        assert_int_equal(list != NULL, has_packs);
        if (!list) continue;
        // twice, as two substeps are: the second forgets the first
        for (int substep = 0; substep < 2; substep++) {
            ck_sweep_list_begin(list, moved, model->position);
            for (uint32_t i = 0; i < iterations; i++)
                ck_sweep_list_sweep(list, 1, ck_sweep_is_turned(projection, i, iterations), NULL);
        }
        ck_sweep_list_read(list, results[kind]);
        ck_sweep_list_destroy(list);
    }
    bool is_far;
    int *order = malloc(springs * sizeof *order);
    assert_int_equal(ck_sweep_order(model, projection, iterations, order), CK_OK);
    for (uint32_t sweep = 0; sweep < iterations; sweep++)
        for (int k = 0; k < model->spring_count; k++) {
            const int i = order[ck_sweep_is_turned(projection, sweep, iterations) ? model->spring_count - 1 - k : k];
            plain_project(model, &rule, &model->springs[i], model->position, x, &multiplier[i], true, &is_far);
        }
    // who sweeps one by one goes through the model's list, and predictions go by the order
    for (int k = 0; k < model->spring_count && !has_packs; k++) assert_int_equal(order[k], k);
    if (has_packs)
        fixture_compare_loops(text, results, x, count);
    else
        for (int kind = 0; ck_loops_at(kind); kind++) free(results[kind]);
    free(order);
    free(x);
    free(weight);
    free(values);
    fixture_free(&fixture);
}

// Cloths with springs of any kind, some of them slack, damped or not; a rope has no packs, nor has a small mesh.
static void test_list(void **state) {
    (void)state;
    static const char *const bodies[] = {
        "cloth: {rows: 9, columns: 14, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100, shear: 50, bend: 5}\n"
        "pins: [top_left, 3:5]",
        "cloth: {rows: 8, columns: 11, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100, shear: 50, bend: 5, damping: "
        "0.05}\npins: [top_edge]",
        "cloth: {rows: 8, columns: 11, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100, bend: 5, damping: 0.05, "
        "pull_only: true}\npins: [0:1]"};
    for (size_t i = 0; i < sizeof bodies / sizeof *bodies; i++)
        for (uint32_t iterations = 1; iterations < 4; iterations++) {
            compare_list(bodies[i], CK_PROJECT_SPRINGS, iterations, true);
            compare_list(bodies[i], CK_PROJECT_BARS, iterations, true);
        }
    compare_list("cloth: {rows: 3, columns: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100, shear: 50, bend: 5}\n"
                 "pins: [0:1]",
                 CK_PROJECT_SPRINGS, 2, false);
    compare_list("rope: {particles: 20, spacing: 0.1, mass: 1}\nsprings: {stiffness: 100}\npins: [first]",
                 CK_PROJECT_SPRINGS, 2, false);
}

// A net of triangles, in the order of its nodes. Free with free.
static char *write_net(int side) {
    char *text;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    fprintf(file, "name: net\nnetwork:\n  nodes:\n");
    for (int i = 0; i < side * side; i++)
        fprintf(file, "    - {at: [%g, 0, %g], mass: 1e-3}\n", 0.02 * (i % side), 0.02 * (i / side));
    fprintf(file, "  bars: [[0, 1]");
    for (int i = 0; i < side * side; i++) {
        const bool has_right = i % side + 1 < side, has_below = i / side + 1 < side;
        if (has_right && i > 0) fprintf(file, ", [%d, %d]", i, i + 1);
        if (has_below) fprintf(file, ", [%d, %d]", i, i + side);
        if (has_right && has_below) fprintf(file, ", [%d, %d]", i, i + side + 1);
    }
    fprintf(file, "]\nsprings: {stiffness: 200, damping: 0.01}\npins: [0, %d]\ngravity: [0, -9.81, 0]\n", side - 1);
    fprintf(file, "time: {duration: 1, step: 0.01}\n");
    fclose(file);
    return text;
}

// The places after sweeps of so many threads, [3*n] m; how many parts the net has for them.
static int sweep_net(const ck_Model *model, ck_Projection projection, int threads, bool are_turned, double *x) {
    const size_t count = 3 * (size_t)model->particle_count, springs = (size_t)model->spring_count;
    double *weight = calloc((size_t)model->particle_count, sizeof *weight), *soft = calloc(2 * springs, sizeof *soft);
    for (size_t i = 0; i < count; i++) x[i] = model->position[i] + 1e-3 * sin(1.7 * (double)i);
    for (int i = 0; i < model->particle_count; i++) weight[i] = ck_model_inverse_mass(model, i);
    for (size_t i = 0; i < springs; i++) soft[i] = 100, soft[springs + i] = 0.1;
    const ck_SweepRule rule = {projection, 5, 1, weight, soft, soft + springs};
    ck_SweepList *list;
    ck_Waves *waves;
    assert_int_equal(ck_sweep_list_create(&list, ck_loops_at(0), model, &rule, NULL), CK_OK);
    assert_non_null(list);
    assert_int_equal(ck_waves_create(&waves, threads, NULL), CK_OK);
    for (int substep = 0; substep < 20; substep++) {
        ck_sweep_list_begin(list, x, model->position);
        ck_sweep_list_sweep(list, 5, are_turned, waves);
        ck_sweep_list_read(list, x);
    }
    const int parts = list->rows / (3 * list->reach);
    ck_waves_destroy(waves);
    ck_sweep_list_destroy(list);
    free(weight);
    free(soft);
    return parts;
}

// Threads share several sweeps over a net, either way round, and leave the same bits.
static void test_shared_list(void **state) {
    (void)state;
    static const ck_Projection projections[] = {CK_PROJECT_SPRINGS, CK_PROJECT_BARS};
    char *text = write_net(60);
    Fixture fixture;
    fixture_load(&fixture, text);
    const size_t bytes = 3 * sizeof(double) * (size_t)fixture.model.particle_count;
    double *one = malloc(bytes), *many = malloc(bytes);
    for (int i = 0; i < 2; i++)
        for (int is_turned = 0; is_turned < 2; is_turned++) {
            sweep_net(&fixture.model, projections[i], 1, is_turned, one);
            for (int threads = 2; threads < 4; threads++) {
                const int parts = sweep_net(&fixture.model, projections[i], threads, is_turned, many);
                if (parts < 2) fail_msg("only %d part: nothing is shared", parts);
                assert_memory_equal(one, many, bytes);
            }
        }
    free(one);
    free(many);
    free(text);
    fixture_free(&fixture);
}

// The rms speed at the end, m/s.
static double end_speed(const char *text, const ck_Settings *settings) {
    Fixture fixture;
    ck_Trajectory trajectory;
    fixture_load(&fixture, text);
    fixture_run(&trajectory, &fixture.model, ck_engine_find("native-bars"), settings, NULL);
    const double *v = ck_trajectory_velocity(&trajectory, trajectory.frame_count - 1);
    double sum = 0;
    for (int i = 0; i < 3 * fixture.model.particle_count; i++) sum += v[i] * v[i];
    sum = sqrt(sum / fixture.model.particle_count);
    ck_trajectory_free(&trajectory);
    fixture_free(&fixture);
    return sum;
}

// Sheets with more bars than freedoms, blown aside, and on a ball whose friction holds them, come to rest: to 0.1 % of
// the speed √(g·size) of a fall, which is where metric.h calls a body still. Sweeps in one direction shake both at 0.2
// to 1 % of it, and friction that is held to what one sweep pushes lets the second slide.
static void test_rest(void **state) {
    (void)state;
    fixture_skip_long();
    static const char blown[] = "cloth: {rows: 25, columns: 25, spacing: 0.05, mass: 0.3125, across: [1, 0, 0], down: "
                                "[0, -1, 0]}\nsprings: {rigid: true, shear: 1}\npins: [0:0, 3:0, 6:0, 9:0, 12:0, 15:0, "
                                "18:0, 21:0, 24:0]\nforce: [0.01, 0, 0.002]\n",
                      draped[] = "cloth: {rows: 16, columns: 16, spacing: 0.05, mass: 0.3, origin: [-0.375, 0.35, "
                                 "-0.375], down: [0, 0, 1]}\nsprings: {rigid: true, shear: 1}\ncolliders: [{sphere: "
                                 "{center: [0, 0, 0], radius: 0.3, friction: 0.8}}]\n";
    for (int is_draped = 0; is_draped < 2; is_draped++)
        for (int seed = 1; seed < 3; seed++) {
            char text[600];
            snprintf(text, sizeof text,
                     "name: sheet\n%snoise: {amplitude: 1e-3, seed: %d}\ngravity: [0, -9.81, 0]\ndrag: 6\n"
                     "time: {duration: 5, step: 0.02}\n",
                     is_draped ? draped : blown, seed);
            assert_near(text, end_speed(text, &(ck_Settings){.substeps = is_draped ? 70 : 168, .iterations = 4}), 0,
                        1e-3 * sqrt(9.81 * 0.75));
        }
}

// m: where a run of so many substeps ends, farthest from another.
static double apart(const Fixture *fixture, uint32_t substeps, uint32_t other) {
    ck_Trajectory runs[2];
    for (int i = 0; i < 2; i++) {
        const ck_Settings settings = {.substeps = i ? other : substeps, .iterations = 1};
        fixture_run(&runs[i], &fixture->model, ck_engine_find("native-lines"), &settings, NULL);
    }
    double most = 0;
    for (int i = 0; i < 3 * fixture->model.particle_count; i++)
        most = fmax(most, fabs(ck_trajectory_position(&runs[0], runs[0].frame_count - 1)[i] -
                               ck_trajectory_position(&runs[1], runs[1].frame_count - 1)[i]));
    for (int i = 0; i < 2; i++) ck_trajectory_free(&runs[i]);
    return most;
}

// Lines are of second order without dampers, whether a cloth starts under tension, a pin is let go on the way or drag
// slows it: with half the step there is a quarter of the error, where one that is of first order at the start, or whose
// springs drag does not ease, would leave half.
static void test_order_of_lines(void **state) {
    (void)state;
    static const char *const changes[] = {"springs: {stiffness: 200, shear: 100, prestretch: 0.05}\n",
                                          "springs: {stiffness: 200, shear: 100}\nnoise: {amplitude: 1e-3, seed: 1}\n"
                                          "release: [{at: 0.05, pins: [top_right]}]\n",
                                          "springs: {stiffness: 200, shear: 100}\ndrag: 20\n"};
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        char text[500];
        snprintf(text, sizeof text,
                 "name: order\ncloth: {rows: 6, columns: 6, spacing: 0.05, mass: 0.1, down: [0, -1, 0]}\n"
                 "pins: [top_left, top_right]\ngravity: [0, -9.81, 0]\n%stime: {duration: 0.1, step: 0.01}\n",
                 changes[i]);
        Fixture fixture;
        fixture_load(&fixture, text);
        const double ratio = apart(&fixture, 32, 1024) / apart(&fixture, 64, 1024);
        assert_near(changes[i], log2(ratio), 2, 0.3);
        fixture_free(&fixture);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_projection),  cmocka_unit_test(test_lines),       cmocka_unit_test(test_far_bars),
        cmocka_unit_test(test_torn_bars),   cmocka_unit_test(test_coarse_bars), cmocka_unit_test(test_list),
        cmocka_unit_test(test_shared_list), cmocka_unit_test(test_rest),        cmocka_unit_test(test_order_of_lines)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
