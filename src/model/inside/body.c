#include "body.h"

#include "statistics.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

ck_Status ck_model_unit(double *out, const double *from, const ck_Scene *scene, const char *path, ck_Error *error) {
    double length = ck_length(from);
    // one that is a unit vector already, to rounding, stays as it is: so that what is written out reads back the same
    if (fabs(length - 1) < 4e-16) {
        memcpy(out, from, 3 * sizeof(double));
        return CK_OK;
    }
    if (!(length > 0) || !isfinite(length))
        return ck_scene_fail(scene, path, error, "%s has no direction; give a vector of any length above 0", path);
    for (int axis = 0; axis < 3; axis++) out[axis] = from[axis] / length;
    return CK_OK;
}

ck_Status ck_body_allocate(ck_Model *model, const ck_Scene *scene, const char *body, double particles, double springs,
                           ck_Error *error) {
    if (particles < 1 || particles > CK_SCENE_MAX_PARTICLES)
        return ck_scene_fail(scene, body, error, "%s asks for %.0f particles; it must be 1 to %d", body, particles,
                             CK_SCENE_MAX_PARTICLES);
    size_t count = (size_t)particles;
    model->particle_count = (int)particles;
    model->position = calloc(3 * count, sizeof(double));
    model->velocity = calloc(3 * count, sizeof(double));
    model->mass = calloc(count, sizeof(double));
    model->pinned = calloc(count, sizeof(bool));
    model->released = calloc(count, sizeof(bool));
    model->springs = calloc((size_t)springs + 1, sizeof(ck_Spring));
    bool whole =
        model->position && model->velocity && model->mass && model->pinned && model->released && model->springs;
    return whole ? CK_OK : CK_NO_MEMORY;
}

void ck_body_add_spring(ck_Model *model, const ck_SceneSprings *springs, int a, int b, double length,
                        ck_SpringKind kind) {
    const double stiffness[CK_SPRING_KINDS] = {springs->stiffness, springs->shear, springs->bend};
    bool bar = springs->rigid && (kind == CK_STRUCTURAL || stiffness[kind] > 0);
    if (!bar && !(stiffness[kind] > 0)) return;
    model->springs[model->spring_count++] = (ck_Spring){.a = a,
                                                        .b = b,
                                                        .rest = length / (1 + springs->prestretch),
                                                        .stiffness = bar ? INFINITY : stiffness[kind],
                                                        .damping = springs->damping,
                                                        .kind = kind,
                                                        .pulls_only = springs->pull_only};
}

static const double origin_default[3] = {0, 0, 0}, across_default[3] = {1, 0, 0}, down_default[3] = {0, -1, 0};

static const double *or_default(const double *given, const double *fallback) {
    return given ? given : fallback;
}

static ck_Status build_rope(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneRope *rope = scene->file->rope;
    double along[3];
    ck_Status status = ck_model_unit(along, or_default(rope->along, down_default), scene, "rope.along", error);
    if (!status) status = ck_body_allocate(model, scene, "rope", rope->particles, 2.0 * rope->particles, error);
    if (status) return status;
    for (int i = 0; i < model->particle_count; i++) {
        memcpy(model->position + 3 * i, or_default(rope->origin, origin_default), 3 * sizeof(double));
        ck_add_scaled(model->position + 3 * i, rope->spacing * i, along);
        model->mass[i] = rope->mass / rope->particles;
    }
    model->mass[model->particle_count - 1] += rope->end_mass;
    model->body = CK_ROPE;
    const double segments = rope->particles > 1 ? rope->particles - 1.0 : 1;
    model->spacing = rope->length > 0 ? rope->length / segments : rope->spacing;
    model->size = model->spacing * segments;
    const ck_SceneSprings *springs = ck_body_springs(scene);
    for (int i = 1; i < model->particle_count && springs; i++)
        ck_body_add_spring(model, springs, i - 1, i, model->spacing, CK_STRUCTURAL);
    for (int i = 2; i < model->particle_count && springs; i++)
        ck_body_add_spring(model, springs, i - 2, i, 2 * model->spacing, CK_BEND);
    return CK_OK;
}

static ck_Status check_ends(const ck_Model *model, const ck_Scene *scene, const uint32_t *bar, const char *path,
                            ck_Error *error) {
    for (int end = 0; end < 2; end++)
        if (bar[end] >= (uint32_t)model->particle_count)
            return ck_scene_fail(scene, path, error, "bar to node %u, which does not exist; the nodes are 0 to %d",
                                 bar[end], model->particle_count - 1);
    if (bar[0] == bar[1])
        return ck_scene_fail(scene, path, error, "bar from node %u to itself; a bar joins two nodes", bar[0]);
    double length = ck_distance(model->position + 3 * bar[0], model->position + 3 * bar[1]);
    if (!(length > 0))
        return ck_scene_fail(scene, path, error,
                             "bar between nodes %u and %u, which are at the same place; move one of them", bar[0],
                             bar[1]);
    return CK_OK;
}

static ck_Status build_bars(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneNetwork *network = scene->file->network;
    const ck_SceneSprings *springs = scene->file->springs;
    if (network->bars_count && !(springs && (springs->rigid || springs->stiffness > 0)))
        return ck_scene_fail(scene, "network.bars", error,
                             "bars need springs: give springs.stiffness, or springs.rigid: true");
    for (uint32_t i = 0; i < network->bars_count; i++) {
        char path[40];
        snprintf(path, sizeof path, "network.bars[%u]", i);
        ck_Status status = check_ends(model, scene, network->bars[i], path, error);
        if (status) return status;
        int a = (int)network->bars[i][0], b = (int)network->bars[i][1];
        double length = ck_distance(model->position + 3 * a, model->position + 3 * b);
        ck_body_add_spring(model, springs, a, b, length, CK_STRUCTURAL);
    }
    return CK_OK;
}

static const char *const kind_names[CK_SPRING_KINDS] = {"structural", "shear", "bend"};

static ck_Status add_own_spring(ck_Model *model, const ck_Scene *scene, uint32_t index, ck_Error *error) {
    const ck_SceneNetworkSpring *from = &scene->file->network->springs[index];
    char path[60];
    int kind = 0;
    snprintf(path, sizeof path, "network.springs[%u]", index);
    ck_Status status = check_ends(model, scene, from->ends, path, error);
    if (status) return status;
    while (from->kind && kind < CK_SPRING_KINDS && strcmp(from->kind, kind_names[kind])) kind++;
    if (kind == CK_SPRING_KINDS)
        return ck_scene_fail(scene, path, error, "its kind is %s; it must be structural, shear or bend", from->kind);
    if (from->rigid == (from->stiffness > 0) || (from->rigid && (from->damping > 0 || from->pull_only)))
        return ck_scene_fail(scene, path, error,
                             "it needs either a stiffness above 0, or rigid: true and no damping, which would do "
                             "nothing, and no pull_only");
    // engines have bars or springs, not both
    if (model->spring_count && isinf(model->springs[0].stiffness) != from->rigid)
        return ck_scene_fail(scene, path, error, "it is %s where those before are not; make all alike",
                             from->rigid ? "rigid" : "a spring");
    const int a = (int)from->ends[0], b = (int)from->ends[1];
    double length = ck_distance(model->position + 3 * a, model->position + 3 * b);
    model->springs[model->spring_count++] = (ck_Spring){.a = a,
                                                        .b = b,
                                                        .rest = from->rest > 0 ? from->rest : length,
                                                        .stiffness = from->rigid ? INFINITY : from->stiffness,
                                                        .damping = from->damping,
                                                        .kind = (ck_SpringKind)kind,
                                                        .pulls_only = from->pull_only};
    return CK_OK;
}

void ck_body_set_lengths(ck_Model *model, double size, double spacing) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < 3 * model->particle_count; i++) {
        low[i % 3] = fmin(low[i % 3], model->position[i]);
        high[i % 3] = fmax(high[i % 3], model->position[i]);
    }
    model->size = size > 0 ? size : ck_distance(low, high);
    if (!(model->size > 0)) model->size = 1; // a single node has no extent of its own
    model->spacing = model->spring_count ? INFINITY : model->size;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        model->spacing =
            fmin(model->spacing, ck_distance(model->position + 3 * spring->a, model->position + 3 * spring->b));
    }
    if (spacing > 0) model->spacing = spacing;
}

static ck_Status build_triangles(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneNetwork *network = scene->file->network;
    if (!network->triangles_count) return CK_OK;
    model->triangles = malloc(network->triangles_count * sizeof *model->triangles);
    if (!model->triangles) return CK_NO_MEMORY;
    for (uint32_t i = 0; i < network->triangles_count; i++) {
        const uint32_t *corners = network->triangles[i];
        char path[48];
        snprintf(path, sizeof path, "network.triangles[%u]", i);
        for (int k = 0; k < 3; k++) {
            if (corners[k] >= (uint32_t)model->particle_count)
                return ck_scene_fail(scene, path, error,
                                     "triangle of node %u, which does not exist; the nodes are 0 to %d", corners[k],
                                     model->particle_count - 1);
            if (corners[k] == corners[(k + 1) % 3])
                return ck_scene_fail(scene, path, error, "triangle that has node %u twice; it joins three", corners[k]);
            model->triangles[i][k] = (int)corners[k];
        }
        model->triangle_count++;
    }
    return CK_OK;
}

static ck_Status build_network(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneNetwork *network = scene->file->network;
    double springs = (double)network->bars_count + network->springs_count;
    ck_Status status = ck_body_allocate(model, scene, "network", network->nodes_count, springs, error);
    if (status) return status;
    for (int i = 0; i < model->particle_count; i++) {
        memcpy(model->position + 3 * i, network->nodes[i].at, 3 * sizeof(double));
        model->mass[i] = network->nodes[i].mass;
    }
    model->body = CK_NETWORK;
    status = build_bars(model, scene, error);
    for (uint32_t i = 0; i < network->springs_count && !status; i++) status = add_own_spring(model, scene, i, error);
    if (!status) ck_body_set_lengths(model, network->size, network->spacing);
    if (!status) status = build_triangles(model, scene, error);
    return status;
}

// Some direction at right angles to a line, [3].
static void across_line(double *out, const double *line) {
    int least = fabs(line[0]) <= fabs(line[1]) ? 0 : 1;
    if (fabs(line[2]) < fabs(line[least])) least = 2;
    double axis[3] = {least == 0, least == 1, least == 2};
    ck_cross(out, line, axis);
}

// Out of the plane of three nodes that are far apart: that of all, where they have one. Towards growing z, or y, or x.
static void out_of_network(double *normal, const ck_Model *model) {
    double line[3] = {0, 0, 0}, to[3], cross[3], farthest = 0;
    for (int i = 1; i < model->particle_count; i++) {
        ck_subtract(to, model->position + 3 * i, model->position);
        if (ck_length(to) > ck_length(line)) memcpy(line, to, sizeof line);
    }
    if (!(ck_length(line) > 0)) line[0] = 1;
    across_line(normal, line);
    for (int i = 1; i < model->particle_count; i++) {
        ck_subtract(to, model->position + 3 * i, model->position);
        ck_cross(cross, line, to);
        if (ck_length(cross) <= fmax(farthest, 1e-9 * ck_dot(line, line))) continue;
        farthest = ck_length(cross);
        memcpy(normal, cross, sizeof cross);
    }
    int axis = fabs(normal[2]) > 1e-9 * ck_length(normal) ? 2 : fabs(normal[1]) > 1e-9 * ck_length(normal) ? 1 : 0;
    for (int i = 0; i < 3 && normal[axis] < 0; i++) to[i] = -normal[i];
    if (normal[axis] < 0) memcpy(normal, to, sizeof to);
}

// The unit vector along which noise moves particles: out of the plane of the body, or across its line.
static void out_of_plane(double *normal, const ck_Model *model, const ck_SceneFile *file) {
    const double *across = across_default, *down = down_default;
    if (file->cloth) {
        ck_cross(normal, or_default(file->cloth->across, across), or_default(file->cloth->down, down));
    } else if (file->rope) {
        across_line(normal, or_default(file->rope->along, down));
    } else {
        out_of_network(normal, model);
    }
    double length = ck_length(normal);
    for (int axis = 0; axis < 3; axis++) normal[axis] /= length;
}

void ck_model_add_noise(ck_Model *model, const ck_Scene *scene) {
    const ck_SceneFile *file = scene->file;
    if (!file->noise) return;
    double normal[3];
    out_of_plane(normal, model, file);
    ck_Random random = ck_random_seed(file->noise->seed);
    for (int i = 0; i < model->particle_count; i++) {
        double offset = file->noise->amplitude * (2 * ck_random_unit(&random) - 1);
        if (!model->pinned[i]) ck_add_scaled(model->position + 3 * i, offset, normal);
    }
}

ck_Status ck_model_build_body(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    if (scene->file->cloth) return ck_model_build_cloth(model, scene, error);
    if (scene->file->rope) return build_rope(model, scene, error);
    if (scene->file->mesh) return ck_model_build_mesh(model, scene, error);
    return build_network(model, scene, error);
}
