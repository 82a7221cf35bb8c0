#include "chain.h"

#include "compliance.h"
#include "constraint_kernel.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A softness is at least this share of 1/m, or rounding could make a pivot 0.
#define ROUNDING 1e-12

// A spring as its chain comes to it, from one end to the other, and its row of the tridiagonal system, as elimination
// leaves it: Δλ is change less the share that the next row has in it times its Δλ.
typedef struct Link {
    int spring, a, b;
    bool goes_on;                     // from the link before
    double rest, compliance, damping; // m, 1/kg, 1: L, α̃, c/(k·dt)
    double taken, yield;              // 1/(1 + γ̃), and the softness of its row, α̃/(1 + γ̃), 1/kg
    double normal[3];
    double change, share;
} Link;

struct ck_Chain {
    int count; // of links
    Link *links;
    double *flown;  // [3*n] m: where the flight ended, and surfaces pushed that
    double *pulled; // [3*n] m: what springs moved the last substep's end by
    double *placed; // [3*n] m: where springs have put what surfaces push
    double *before; // [3*n] m: the way of the substep before; of what is free as its speed now, after impacts, has it
    bool *is_fresh; // [n] has just begun to move
    bool has_moved; // a substep
    double *state;
};

// The one or two springs of each particle; −1: none.
typedef struct Ends {
    int spring[2];
} Ends;

static ck_Status find_ends(Ends *ends, const ck_Model *model, ck_Error *error) {
    for (int i = 0; i < model->particle_count; i++) ends[i] = (Ends){{-1, -1}};
    for (int i = 0; i < model->spring_count; i++)
        for (int k = 0; k < 2; k++) {
            int *spring = ends[k ? model->springs[i].b : model->springs[i].a].spring;
            if (spring[0] >= 0 && spring[1] >= 0)
                return ck_fail(error, CK_REFUSED,
                               "lines are solved of open chains of springs, and of regular cloths that have no bending "
                               "springs and that only springs, a field, drag and colliders that stay move");
            spring[spring[0] >= 0] = i;
        }
    return CK_OK;
}

// Appends the chain that begins at a particle with one spring.
static void follow(ck_Chain *chain, const Ends *ends, const ck_Model *model, int from) {
    int spring = ends[from].spring[0], at = from;
    while (spring >= 0) {
        const ck_Spring *next = &model->springs[spring];
        const int to = next->a == at ? next->b : next->a;
        chain->links[chain->count++] = (Link){.spring = spring, .a = at, .b = to, .goes_on = at != from};
        spring = ends[to].spring[ends[to].spring[0] == spring];
        at = to;
    }
}

// Each chain from its end with the lower number on.
static ck_Status find_links(ck_Chain *chain, Ends *ends, const ck_Model *model, ck_Error *error) {
    ck_Status status = find_ends(ends, model, error);
    for (int i = 0; i < model->particle_count && !status; i++) {
        if (ends[i].spring[0] < 0 || ends[i].spring[1] >= 0) continue;
        follow(chain, ends, model, i);
        // it is not to be found again from its other end
        ends[chain->links[chain->count - 1].b].spring[0] = -1;
    }
    if (!status && chain->count < model->spring_count)
        return ck_fail(error, CK_REFUSED, "a closed chain is no line: it has no end to be solved from");
    return status;
}

ck_Status ck_chain_create(ck_Chain **out, const ck_Model *model, ck_Error *error) {
    const size_t particles = (size_t)model->particle_count;
    *out = NULL;
    ck_Chain *chain = calloc(1, sizeof *chain);
    Ends *ends = malloc(particles * sizeof *ends);
    ck_Status status = CK_NO_MEMORY;
    if (chain) {
        chain->state = calloc(12 * particles, sizeof *chain->state);
        chain->is_fresh = malloc(particles * sizeof *chain->is_fresh);
        chain->links = malloc((size_t)model->spring_count * sizeof *chain->links + 1);
        if (chain->state && chain->is_fresh && chain->links && ends) status = find_links(chain, ends, model, error);
    }
    free(ends);
    if (status) {
        ck_chain_destroy(chain);
        return status == CK_NO_MEMORY ? ck_fail(error, status, "out of memory") : status;
    }
    chain->flown = chain->state;
    chain->pulled = chain->state + 3 * particles;
    chain->placed = chain->state + 6 * particles;
    chain->before = chain->state + 9 * particles;
    for (size_t i = 0; i < particles; i++) chain->is_fresh[i] = true;
    *out = chain;
    return CK_OK;
}

void ck_chain_destroy(ck_Chain *chain) {
    if (!chain) return;
    free(chain->state);
    free(chain->is_fresh);
    free(chain->links);
    free(chain);
}

// N, of what hangs on the links from one on to before another, and of what their pins stretch them by.
static double tension_of(const ck_Chain *chain, const ck_Model *model, int first, int end) {
    double load = 0, rest = 0, yield = 0, stretched = 0;
    int pin = model->pinned[chain->links[first].a] ? chain->links[first].a : -1;
    for (int i = first; i < end; i++) {
        const Link *link = &chain->links[i];
        const ck_Spring *spring = &model->springs[link->spring];
        double field[3];
        ck_model_field(model, link->b, field);
        load += model->mass[link->b] * ck_length(field);
        if (i == first) ck_model_field(model, link->a, field), load += model->mass[link->a] * ck_length(field);
        rest += spring->rest;
        yield += 1 / spring->stiffness;
        if (!model->pinned[link->b]) continue;
        if (pin >= 0)
            stretched =
                fmax(stretched, (ck_distance(model->position + 3 * pin, model->position + 3 * link->b) - rest) / yield);
        pin = link->b;
        rest = yield = 0;
    }
    return fmax(load, stretched);
}

double ck_chain_tension(const ck_Chain *chain, const ck_Model *model) {
    double tension = 0;
    for (int first = 0, end; first < chain->count; first = end) {
        for (end = first + 1; end < chain->count && chain->links[end].goes_on;) end++;
        tension = fmax(tension, tension_of(chain, model, first, end));
    }
    return tension;
}

// Drag eases what a force moves in a substep, as the flight has it of the field.
void ck_chain_soften(ck_Chain *chain, const ck_Native *native) {
    const double dt = native->dt, moved = (1 - CK_LINES_KEPT) * dt * dt / (1 + 0.5 * native->model->drag * dt);
    for (int i = 0; i < chain->count; i++) {
        Link *link = &chain->links[i];
        const ck_Spring *spring = &native->model->springs[link->spring];
        const double softness = ck_compliance_of(spring, &native->used),
                     least = ROUNDING * (native->inverse_mass[link->a] + native->inverse_mass[link->b]);
        link->rest = spring->rest;
        link->compliance = fmax(softness / moved, least);
        link->damping = spring->damping * softness / dt;
        link->taken = 1 / (1 + CK_LINES_RATE * link->damping);
        link->yield = fmax(link->compliance * link->taken, least);
    }
}

// −C − α̃·λ − γ̃·∇C·v·dt, over 1 + γ̃, of a link whose way and length are given. v·dt, of the substep's end, is 1.5 of
// this substep's way less 0.5 of the last one's, and γ̃ counts the part that is yet to be found.
static double residual_of(const ck_Chain *chain, const ck_Native *native, const Link *link, const double *way,
                          double length) {
    double residual = link->rest - length - link->compliance * native->multiplier[link->spring];
    if (link->damping > 0) {
        double began[3], moved[3], before[3];
        ck_subtract(began, native->origin + 3 * link->b, native->origin + 3 * link->a);
        ck_subtract(moved, way, began);
        ck_subtract(before, chain->before + 3 * link->b, chain->before + 3 * link->a);
        residual -= link->damping *
                    (CK_LINES_RATE * ck_dot(moved, link->normal) - (CK_LINES_RATE - 1) * ck_dot(before, link->normal));
    }
    return residual * link->taken;
}

// Eliminates each link after the one before it. One whose ends are both held, or in one place, does nothing.
static void eliminate(const ck_Chain *chain, const ck_Native *native) {
    double right = 0, inverse = 0; // of the row before: its right side, and one over its pivot
    for (int i = 0; i < chain->count; i++) {
        Link *link = &chain->links[i];
        const double weight_a = native->inverse_mass[link->a], weight_b = native->inverse_mass[link->b];
        double way[3];
        ck_subtract(way, native->position + 3 * link->b, native->position + 3 * link->a);
        const double length = ck_length(way), over = length > 0 ? 1 / length : 0;
        for (int axis = 0; axis < 3; axis++) link->normal[axis] = over * way[axis];
        if (weight_a + weight_b == 0 || !(length > 0)) {
            link->change = link->share = right = inverse = 0;
            continue;
        }
        const double residual = residual_of(chain, native, link, way, length),
                     coupling = link->goes_on ? -weight_a * ck_dot(link->normal, link[-1].normal) : 0;
        link->share = coupling * inverse;
        right = residual - link->share * right;
        inverse = 1 / (weight_a + weight_b + link->yield - link->share * coupling);
        link->change = right * inverse;
    }
}

// From the last link back: Δλ, and what it pushes its ends by.
static void move(const ck_Chain *chain, const ck_Native *native) {
    double change = 0, share = 0;
    for (int i = chain->count - 1; i >= 0; i--) {
        const Link *link = &chain->links[i];
        change = link->change - share * change;
        share = link->share;
        native->multiplier[link->spring] += change;
        ck_add_scaled(native->position + 3 * link->b, native->inverse_mass[link->b] * change, link->normal);
        ck_add_scaled(native->position + 3 * link->a, -native->inverse_mass[link->a] * change, link->normal);
    }
}

// What surfaces push is no pull of springs: where the flight ended is pushed as far.
static void project(const ck_Chain *chain, ck_Native *native) {
    const int count = 3 * native->model->particle_count;
    if (!native->contact && !native->rigid) return;
    memcpy(chain->placed, native->position, sizeof(double) * (size_t)count);
    ck_native_project(native);
    for (int i = 0; i < count; i++) chain->flown[i] += native->position[i] - chain->placed[i];
}

// The first substep of what begins to move finds half of its forces, as a leapfrog's first kick is half of one. The
// next one begins with all of that, so that half of it is told to be twice as much.
static void keep_pulls(ck_Chain *chain, const ck_Native *native) {
    for (int i = 0; i < native->model->particle_count; i++) {
        const double times = chain->is_fresh[i] ? 2 : 1;
        for (int axis = 0; axis < 3; axis++)
            chain->pulled[3 * i + axis] = times * (native->position[3 * i + axis] - chain->flown[3 * i + axis]);
        chain->is_fresh[i] = native->inverse_mass[i] == 0;
    }
}

// What is held is known by where it went: its speed is that of the substep's end, and where that jumps, half of the
// jump too much is found in one substep, and then as much too little.
static void look_back(const ck_Chain *chain, const ck_Native *native) {
    for (int i = 0; i < 3 * native->model->particle_count; i++)
        if (native->inverse_mass[i / 3] > 0 || !chain->has_moved)
            chain->before[i] = native->dt * native->other_velocity[i];
}

static void keep_ways(ck_Chain *chain, const ck_Native *native) {
    chain->has_moved = true;
    for (int i = 0; i < 3 * native->model->particle_count; i++)
        if (native->inverse_mass[i / 3] == 0) chain->before[i] = native->position[i] - native->start[i];
}

void ck_chain_solve(ck_Chain *chain, ck_Native *native) {
    const int count = 3 * native->model->particle_count;
    look_back(chain, native);
    memcpy(chain->flown, native->position, sizeof(double) * (size_t)count);
    for (int i = 0; i < count; i++)
        if (!chain->is_fresh[i / 3]) native->position[i] += CK_LINES_KEPT * chain->pulled[i];
    memset(native->multiplier, 0, sizeof(double) * (size_t)native->model->spring_count);
    for (uint32_t i = 0; i < native->iterations; i++) {
        eliminate(chain, native);
        move(chain, native);
        project(chain, native);
    }
    keep_pulls(chain, native);
    keep_ways(chain, native);
}
