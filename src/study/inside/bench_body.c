#include "bench_body.h"

#include "engines.h"
#include "scene.h"
#include "statistics.h"
#include "time_scale.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MASS 0.2
#define STIFFNESS 1000
#define DAMPING 0.02
#define BALL 0.3
// The most of critical at the highest frequency, or damping would take a substep that leaves a cloth room to fold.
#define DAMPING_RATIO 0.2
#define FALL 0.6 // s, until a cloth has come down on it

// A network of nodes side by side, as it grows.
typedef struct Net {
    ck_SceneNetwork network;
    double damping;
} Net;

static bool allocate(Net *net, const ck_BenchBody *body) {
    const size_t nodes = (size_t)body->rows * body->columns;
    net->network.nodes = calloc(nodes, sizeof *net->network.nodes);
    net->network.springs = calloc(3 * nodes, sizeof *net->network.springs);
    return net->network.nodes && net->network.springs;
}

static void free_net(Net *net) {
    free(net->network.nodes);
    free(net->network.springs);
}

static void join(Net *net, uint32_t a, uint32_t b) {
    net->network.springs[net->network.springs_count++] =
        (ck_SceneNetworkSpring){.ends = {a, b}, .stiffness = STIFFNESS, .damping = net->damping};
}

static void place_nodes(Net *net, const ck_BenchBody *body, double jitter, ck_Random *random) {
    const uint32_t rows = body->rows, columns = body->columns;
    const double spacing = 1.0 / (rows - 1);
    for (uint32_t i = 0; i < rows * columns; i++) {
        const uint32_t row = i / columns, column = i % columns;
        const bool is_inner = row > 0 && row + 1 < rows && column > 0 && column + 1 < columns;
        ck_SceneNode *node = &net->network.nodes[i];
        node->at[0] = spacing * (column + (is_inner ? jitter * (2 * ck_random_unit(random) - 1) : 0));
        node->at[2] = spacing * (row + (is_inner ? jitter * (2 * ck_random_unit(random) - 1) : 0));
        node->mass = MASS / (rows * columns);
    }
    net->network.nodes_count = rows * columns;
}

static void join_triangles(Net *net, uint32_t side, ck_Random *random) {
    for (uint32_t row = 0; row < side; row++)
        for (uint32_t column = 0; column < side; column++) {
            const uint32_t here = row * side + column;
            if (column + 1 < side) join(net, here, here + 1);
            if (row + 1 < side) join(net, here, here + side);
            if (column + 1 == side || row + 1 == side) continue;
            if (ck_random_unit(random) < 0.5)
                join(net, here, here + side + 1);
            else
                join(net, here + 1, here + side);
        }
}

static void fill_net(Net *net, const ck_BenchBody *body) {
    ck_Random random = ck_random_seed(1);
    const bool is_mesh = body->kind == CK_BENCH_MESH;
    place_nodes(net, body, is_mesh ? 0.25 : 0, &random);
    if (is_mesh) join_triangles(net, body->rows, &random);
    for (uint32_t i = 0; i < body->rows * body->columns && !is_mesh; i++)
        if (i + body->columns < body->rows * body->columns) join(net, i, i + body->columns);
}

static ck_Status build(ck_Model *model, const ck_BenchBody *body, bool is_damped, const Net *net, ck_Error *error) {
    const bool is_net = body->kind == CK_BENCH_MESH || body->kind == CK_BENCH_ROPES,
               is_rope = body->kind == CK_BENCH_ROPE, is_on_ball = body->kind == CK_BENCH_ON_BALL;
    double down[3] = {0, 0, 1}, gravity[3] = {0, -9.81, 0}, along[3] = {1, 0, 0}, origin[3] = {0, 0, 0};
    char last[16], *pins[] = {is_rope ? "first" : "top_left", is_rope ? "first" : "top_right"}, *ends[] = {"0", last};
    snprintf(last, sizeof last, "%u", body->columns - 1);
    const uint32_t longest = body->rows > body->columns ? body->rows : body->columns;
    ck_SceneCloth cloth = {.rows = body->rows, .columns = body->columns, .spacing = 1.0 / (longest - 1), .mass = MASS};
    ck_SceneRope rope = {.particles = body->rows, .spacing = cloth.spacing, .mass = MASS};
    ck_SceneSprings springs = {
        .stiffness = STIFFNESS, .shear = is_rope ? 0 : STIFFNESS / 2.0, .damping = is_damped ? DAMPING : 0};
    ck_SceneSphere ball = {.center = {0.5, -BALL, 0.5}, .radius = BALL, .friction = 0.5};
    ck_SceneCollider collider = {.sphere = &ball};
    cloth.down = down;
    cloth.origin = origin;
    rope.along = along;
    ck_SceneNetwork network = net->network;
    ck_SceneFile file = {.name = (char *)body->name,
                         .cloth = is_net || is_rope ? NULL : &cloth,
                         .rope = is_rope ? &rope : NULL,
                         .network = is_net ? &network : NULL,
                         .springs = is_net ? NULL : &springs,
                         .pins = is_net ? ends : pins,
                         .pins_count = is_on_ball ? 0 : 2,
                         .gravity = gravity,
                         .drag = is_damped ? 2 : 0,
                         .colliders = is_on_ball ? &collider : NULL,
                         .colliders_count = is_on_ball,
                         .time = {1, 1}};
    ck_Scene scene = {.file = &file};
    return ck_model_build(model, &scene, error);
}

static void limit_damping(ck_Model *model, double frequency) {
    const double most = 2 * DAMPING_RATIO * STIFFNESS / frequency;
    for (int i = 0; i < model->spring_count; i++) model->springs[i].damping = fmin(model->springs[i].damping, most);
}

// To where a cloth is when it has come down.
static ck_Status let_fall(ck_Model *model, ck_Error *error) {
    const ck_Engine *engine = ck_engine_find("native-verlet");
    const ck_Settings wanted = {.substeps = CK_BENCH_SUBSTEPS};
    ck_Settings used;
    void *state;
    ck_Status status = ck_engine_create(engine, &state, model, &wanted, &used, NULL, error);
    if (status) return status;
    for (double time = 0; time < FALL && !status; time += model->step)
        if (engine->step(state) != CK_STEP_OK) status = ck_fail(error, CK_REFUSED, "does not come down on its ball");
    engine->read(state, model->position, model->velocity);
    engine->destroy(state);
    return status;
}

ck_Status ck_bench_body_build(ck_Model *model, const ck_BenchBody *body, bool is_damped, ck_Error *error) {
    Net net = {.damping = is_damped ? DAMPING : 0};
    ck_Status status = CK_OK;
    *model = (ck_Model){0};
    if (body->kind == CK_BENCH_MESH || body->kind == CK_BENCH_ROPES) {
        if (allocate(&net, body))
            fill_net(&net, body);
        else
            status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    }
    double frequency = 0;
    if (!status) status = build(model, body, is_damped, &net, error);
    if (!status) status = ck_stability_frequency(model, &frequency);
    if (!status) model->step = CK_BENCH_SUBSTEPS / frequency;
    if (!status) limit_damping(model, frequency);
    if (!status && body->kind == CK_BENCH_ON_BALL) status = let_fall(model, error);
    free_net(&net);
    return status;
}
