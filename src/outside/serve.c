#include "serve.h"

#include "collider.h"
#include "outside_words.h"
#include "rigid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct Server {
    const ck_Engine *engine;
    ck_Model model; // owned
    ck_Settings wanted;
    void *world;   // NULL: not begun
    double *state; // [6*n]
    ck_Turn *turn; // [rigid bodies]
    char word[64];
} Server;

// What is asked is not as it must be: the other end is told by the exit status, and a person by these words.
static _Noreturn void fail(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

static bool next_word(Server *server) {
    return scanf("%63s", server->word) == 1;
}

static double number(Server *server) {
    char *end;
    if (!next_word(server)) fail("the scene ends within a number");
    double value = strtod(server->word, &end);
    if (*end) fail("the scene holds a word where a number must be");
    return value;
}

static int count(Server *server) {
    double value = number(server);
    if (!(value >= 0 && value <= 4e6) || floor(value) != value) fail("the scene holds no count where one must be");
    return (int)value;
}

static void vector(Server *server, double *to) {
    for (int axis = 0; axis < 3; axis++) to[axis] = number(server);
}

static void *allocate(size_t items, size_t size) {
    void *memory = calloc(items + 1, size);
    if (!memory) fail("out of memory");
    return memory;
}

static void read_particles(Server *server) {
    ck_Model *model = &server->model;
    model->particle_count = count(server);
    const size_t n = (size_t)model->particle_count;
    model->position = allocate(3 * n, sizeof(double));
    model->velocity = allocate(3 * n, sizeof(double));
    model->mass = allocate(n, sizeof(double));
    model->pinned = allocate(n, sizeof(bool));
    model->released = allocate(n, sizeof(bool));
    server->state = allocate(6 * n, sizeof(double));
    for (size_t i = 0; i < n; i++) {
        vector(server, model->position + 3 * i);
        vector(server, model->velocity + 3 * i);
        model->mass[i] = number(server);
        model->pinned[i] = number(server) > 0;
        model->pin_count += model->pinned[i];
    }
}

static void read_springs(Server *server) {
    static const char *const kinds[CK_SPRING_KINDS] = {"structural", "shear", "bend"};
    ck_Model *model = &server->model;
    model->spring_count = count(server);
    model->springs = allocate((size_t)model->spring_count, sizeof *model->springs);
    for (int i = 0; i < model->spring_count; i++) {
        ck_Spring *spring = &model->springs[i];
        spring->a = count(server);
        spring->b = count(server);
        if (spring->a >= model->particle_count || spring->b >= model->particle_count)
            fail("a spring joins a particle that is not there");
        spring->rest = number(server);
        spring->stiffness = number(server);
        spring->damping = number(server);
        if (!next_word(server)) fail("the scene ends within a spring");
        for (int kind = 0; kind < CK_SPRING_KINDS; kind++)
            if (!strcmp(server->word, kinds[kind])) spring->kind = (ck_SpringKind)kind;
    }
}

static void read_collider(Server *server, ck_Collider *collider) {
    if (!next_word(server)) fail("the scene ends within a collider");
    while (collider->shape < CK_SHAPE_COUNT && strcmp(server->word, ck_shape_names[collider->shape])) collider->shape++;
    if (collider->shape == CK_SHAPE_COUNT) fail("a collider of no known shape");
    vector(server, collider->point);
    if (collider->shape == CK_PLANE) vector(server, collider->normal);
    for (int k = 0; k < 3 && collider->shape > CK_SPHERE; k++) vector(server, collider->axes[k]);
    if (collider->shape > CK_SPHERE) vector(server, collider->half);
    if (collider->shape != CK_PLANE) collider->radius = number(server);
    collider->restitution = number(server);
    collider->friction = number(server);
}

static void read_colliders(Server *server) {
    ck_Model *model = &server->model;
    model->collider_count = count(server);
    model->colliders = allocate((size_t)model->collider_count, sizeof *model->colliders);
    for (int i = 0; i < model->collider_count; i++) read_collider(server, &model->colliders[i]);
}

// Rigid bodies, whose centres are the last particles, in order.
static void read_bodies(Server *server) {
    ck_Model *model = &server->model;
    model->rigid_count = count(server);
    model->rigid = allocate((size_t)model->rigid_count, sizeof *model->rigid);
    server->turn = allocate((size_t)model->rigid_count, sizeof *server->turn);
    for (int i = 0; i < model->rigid_count; i++) {
        ck_RigidBody *rigid = &model->rigid[i];
        rigid->particle = count(server);
        if (rigid->particle != model->particle_count - model->rigid_count + i) fail("a body of no particle of its own");
        read_collider(server, &rigid->shape);
        for (int k = 0; k < 3 && rigid->shape.shape == CK_SPHERE; k++) rigid->shape.axes[k][k] = 1;
        vector(server, rigid->spin);
        vector(server, rigid->inertia);
        rigid->hung_count = count(server);
        rigid->hung = allocate((size_t)rigid->hung_count, sizeof *rigid->hung);
        for (int k = 0; k < rigid->hung_count; k++) rigid->hung[k] = count(server);
    }
}

// Springs that only pull, by their numbers.
static void read_slack(Server *server) {
    for (int left = count(server); left > 0; left--) {
        const int spring = (int)number(server);
        if (spring < 0 || spring >= server->model.spring_count) fail("no such spring hangs slack");
        server->model.springs[spring].pulls_only = true;
    }
}

static void read_hinges(Server *server) {
    ck_Model *model = &server->model;
    model->hinge_count = count(server);
    model->hinges = allocate((size_t)model->hinge_count, sizeof *model->hinges);
    for (int i = 0; i < model->hinge_count; i++) {
        ck_Hinge *hinge = &model->hinges[i];
        for (int k = 0; k < 4; k++) {
            hinge->particles[k] = (int)number(server);
            if (hinge->particles[k] < -1 || hinge->particles[k] >= model->particle_count)
                fail("a hinge of no particle");
        }
        for (int k = 0; k < 4; k++) hinge->weights[k] = number(server);
        hinge->stiffness = number(server);
        hinge->rest = number(server);
    }
}

static void read_wind(Server *server) {
    ck_Wind *wind = &server->model.wind;
    vector(server, wind->velocity);
    wind->density = number(server);
    wind->drag = number(server);
    wind->lift = number(server);
}

static void read_faces(Server *server) {
    ck_Model *model = &server->model;
    model->wind.face_count = count(server);
    model->wind.faces = allocate((size_t)model->wind.face_count, sizeof *model->wind.faces);
    for (int i = 0; i < 3 * model->wind.face_count; i++) {
        const int particle = (int)number(server);
        if (particle < 0 || particle >= model->particle_count) fail("a face of no particle");
        model->wind.faces[i / 3][i % 3] = particle;
    }
}

// The most pins and colliders together that move.
#define MOST_PATHS 100000

static void read_path(Server *server, ck_Path *path) {
    if (!next_word(server)) fail("the scene ends within a path");
    path->kind = !strcmp(server->word, "points") ? CK_PATH_POINTS
                 : !strcmp(server->word, "sine") ? CK_PATH_SINE
                                                 : CK_PATH_VELOCITY;
    path->slack = 1e-9 * server->model.step;
    if (path->kind != CK_PATH_POINTS) {
        path->from = number(server);
        path->to = number(server);
        vector(server, path->vector);
        if (path->kind == CK_PATH_SINE) path->frequency = number(server);
        return;
    }
    path->point_count = count(server);
    path->points = allocate((size_t)path->point_count, sizeof *path->points);
    for (int i = 0; i < 4 * path->point_count; i++) path->points[i / 4][i % 4] = number(server);
    if (path->point_count < 2) fail("a path has at least two points");
    path->from = path->points[0][0];
    path->to = path->points[path->point_count - 1][0];
}

// Room for paths, to which pins and colliders point.
static ck_Path *more_paths(Server *server, int more) {
    ck_Model *model = &server->model;
    if (!model->paths) model->paths = allocate(MOST_PATHS, sizeof *model->paths);
    if (more > MOST_PATHS - model->path_count) fail("too much moves");
    model->path_count += more;
    return model->paths + model->path_count - more;
}

// Colliders that move, each its number and a path.
static void read_moving(Server *server) {
    ck_Model *model = &server->model;
    const int moving = count(server);
    ck_Path *path = more_paths(server, moving);
    for (int i = 0; i < moving; i++, path++) {
        const int collider = count(server);
        if (collider >= model->collider_count) fail("no such collider moves");
        model->colliders[collider].path = path;
        read_path(server, path);
    }
}

// Pins that move: each with a path of its own.
static void read_moves(Server *server) {
    ck_Model *model = &server->model;
    model->driven_count = count(server);
    model->driven = allocate((size_t)model->driven_count, sizeof *model->driven);
    ck_Path *path = more_paths(server, model->driven_count);
    for (int i = 0; i < model->driven_count; i++, path++) {
        ck_Driven *driven = &model->driven[i];
        *driven = (ck_Driven){.particle = count(server), .path = path, .until = number(server)};
        if (driven->particle >= model->particle_count) fail("no such particle moves");
        memcpy(driven->start, model->position + 3 * driven->particle, sizeof driven->start);
        read_path(server, path);
    }
}

static void read_setting(Server *server) {
    if (!next_word(server)) fail("the scene ends within a setting");
    const ck_Setting *setting = ck_setting_find(server->engine->settings, server->word);
    double value = number(server);
    if (!setting) fail("there is no such setting");
    ck_settings_set(&server->wanted, setting->slot, value);
}

// What the scene has, of its numbers.
static unsigned terms_of(const ck_Model *model) {
    const double none[3] = {0};
    unsigned terms = model->spring_count ? CK_TERM_SPRINGS : 0;
    for (int i = 0; i < model->spring_count; i++) {
        if (isinf(model->springs[i].stiffness)) terms |= CK_TERM_RIGID;
        if (model->springs[i].damping > 0) terms |= CK_TERM_DAMPING;
        if (model->springs[i].pulls_only) terms |= CK_TERM_PULL_ONLY;
    }
    if (model->driven_count) terms |= CK_TERM_MOVES;
    if (model->hinge_count) terms |= CK_TERM_BENDING;
    if (model->wind.face_count) terms |= CK_TERM_WIND;
    if (model->rigid_count) terms |= CK_TERM_BODIES;
    if (memcmp(model->gravity, none, sizeof none)) terms |= CK_TERM_GRAVITY;
    if (memcmp(model->force, none, sizeof none)) terms |= CK_TERM_FORCE;
    if (model->drag > 0) terms |= CK_TERM_DRAG;
    for (int i = 0; i < 3 * model->particle_count; i++)
        if (model->velocity[i] != 0) terms |= CK_TERM_VELOCITY;
    for (int i = 0; i < model->collider_count; i++) terms |= ck_collider_terms(&model->colliders[i]);
    return terms;
}

static void read_scene(Server *server) {
    ck_Model *model = &server->model;
    model->name = "scene";
    model->body = CK_NETWORK;
    while (next_word(server) && strcmp(server->word, "end")) {
        const char *word = server->word;
        if (!strcmp(word, "frames"))
            model->frame_count = count(server);
        else if (!strcmp(word, "step"))
            model->step = number(server);
        else if (!strcmp(word, "size"))
            model->size = number(server);
        else if (!strcmp(word, "spacing"))
            model->spacing = number(server);
        else if (!strcmp(word, "gravity"))
            vector(server, model->gravity);
        else if (!strcmp(word, "force"))
            vector(server, model->force);
        else if (!strcmp(word, "drag"))
            model->drag = number(server);
        else if (!strcmp(word, "particles"))
            read_particles(server);
        else if (!strcmp(word, "springs"))
            read_springs(server);
        else if (!strcmp(word, "slack"))
            read_slack(server);
        else if (!strcmp(word, "wind"))
            read_wind(server);
        else if (!strcmp(word, "faces"))
            read_faces(server);
        else if (!strcmp(word, "hinges"))
            read_hinges(server);
        else if (!strcmp(word, "moves"))
            read_moves(server);
        else if (!strcmp(word, "moving"))
            read_moving(server);
        else if (!strcmp(word, "colliders"))
            read_colliders(server);
        else if (!strcmp(word, "bodies"))
            read_bodies(server);
        else if (!strcmp(word, "setting"))
            read_setting(server);
    }
    model->duration = model->frame_count * model->step;
    model->terms = terms_of(model);
}

static void tell_row(const ck_LedgerRow *row) {
    printf("ledger %s %.17g %s %.17g; %s; %s; %.280s\n", ck_match_names[row->match], row->wanted, row->unit,
           row->native_value, row->quantity, row->native_parameter, row->formula);
}

// Studies vary the number of iterations by that name.
static const char *name_of(const ck_Setting *row) {
    return row->slot == CK_ITERATIONS ? "iterations" : row->name;
}

static void begin(Server *server) {
    ck_Error error = {0};
    ck_Settings used = {0};
    ck_Ledger ledger = {.count = 0};
    read_scene(server);
    const ck_Engine *engine = server->engine;
    ck_Status status = engine->create(&server->world, &server->model, &server->wanted, &used, &ledger, &error);
    if (status) {
        printf("refuse %s\n", error.message);
        return;
    }
    for (const ck_Setting *row = engine->settings; row && row->name; row++)
        if (ck_settings_has(&used, row->slot))
            printf("uses %s %.17g\n", name_of(row), ck_settings_get(&used, row->slot));
    for (int i = 0; i < ledger.count; i++) tell_row(&ledger.rows[i]);
    printf("ready\n");
}

static void say_hello(const ck_Engine *engine) {
    printf("version %s %s\nabout %.150s\nmodels", engine->family, engine->version(), engine->about);
    for (int term = 0; term < CK_TERM_COUNT; term++)
        if (engine->terms & (1u << term)) printf(" %s", ck_term_words[term]);
    printf("\npositions raw\nprecision %s\n", engine->is_single ? "single" : "double");
    for (const ck_Setting *row = engine->settings; row && row->name; row++)
        printf("setting %s %.17g %.17g %s %.90s\n", name_of(row), row->least, row->most,
               row->is_whole ? "whole" : "real", row->help);
    printf("end\n");
}

static void tell_state(const Server *server) {
    const size_t numbers = 3 * (size_t)server->model.particle_count;
    server->engine->read(server->world, server->state, server->state + numbers);
    fwrite(server->state, sizeof *server->state, 2 * numbers, stdout);
    if (server->engine->turn && server->turn) {
        server->engine->turn(server->world, server->turn);
        fwrite(server->turn, sizeof *server->turn, (size_t)server->model.rigid_count, stdout);
    }
}

// A word that needs a world.
static void serve_world(Server *server) {
    if (!server->world) fail("it must begin first");
    if (!strcmp(server->word, "step"))
        printf(server->engine->step(server->world) == CK_STEP_OK ? "ok\n" : "diverged\n");
    else if (!strcmp(server->word, "pace") && server->engine->pace)
        server->engine->pace(server->world, number(server));
    else if (!strcmp(server->word, "read"))
        tell_state(server);
    else if (!strcmp(server->word, "release")) {
        int particle = count(server);
        if (particle >= server->model.particle_count || !server->engine->release) fail("it cannot be let go");
        server->engine->release(server->world, particle);
    } else
        fail("there is no such word");
}

int ck_serve(const ck_Engine *engine) {
    Server server = {.engine = engine};
    for (; next_word(&server) && strcmp(server.word, "quit"); fflush(stdout)) {
        if (!strcmp(server.word, "clothcheck")) {
            number(&server);
            printf("clothcheck 1\n");
        } else if (!strcmp(server.word, "hello")) {
            say_hello(engine);
        } else if (!strcmp(server.word, "ping")) {
            printf("ok\n");
        } else if (!strcmp(server.word, "begin")) {
            begin(&server);
        } else {
            serve_world(&server);
        }
    }
    return 0;
}
