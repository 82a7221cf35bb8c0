// The hinges of bodies: where they are, and what stiffness a sheet's or rope's gives each.
#include "body.h"

#include "hinges.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static ck_Status allocate(ck_Model *model, size_t count) {
    model->hinges = malloc((count + 1) * sizeof *model->hinges);
    return model->hinges ? CK_OK : CK_NO_MEMORY;
}

static ck_Hinge *add(ck_Model *model, int a, int b, int c, int d, double stiffness) {
    ck_Hinge *hinge = &model->hinges[model->hinge_count++];
    *hinge = (ck_Hinge){.particles = {a, b, c, d}, .stiffness = stiffness};
    return hinge;
}

// Three in a row, at distances before and after the middle one: the change of direction.
static void add_row(ck_Model *model, int a, int b, int c, double before, double after, double stiffness) {
    ck_Hinge *hinge = add(model, a, b, c, -1, stiffness);
    hinge->weights[0] = 1 / before;
    hinge->weights[1] = -1 / before - 1 / after;
    hinge->weights[2] = 1 / after;
}

// EI over the mean of the lengths on both sides.
static ck_Status bend_rope(ck_Model *model, double stiffness) {
    ck_Status status = allocate(model, (size_t)model->particle_count);
    for (int i = 1; i + 1 < model->particle_count && !status; i++)
        add_row(model, i - 1, i, i + 1, model->spacing, model->spacing, stiffness / model->spacing);
    return status;
}

// A plate without Poisson's ratio: B·(α² + γ² + 2·β²)/2 an area, α and γ the curvatures along rows and columns, β the
// twist. A row's width is the spacing, half of it at a border, so that every row is a strip of EI = B·width; a square's
// twist is that of its four corners.
static ck_Status bend_cloth(ck_Model *model, double stiffness) {
    const int columns = model->columns, rows = model->particle_count / columns;
    const double spacing = model->spacing;
    ck_Status status = allocate(model, 3 * (size_t)model->particle_count);
    for (int i = 0; i < model->particle_count && !status; i++) {
        const int row = i / columns, column = i % columns;
        const bool is_top = row == 0 || row == rows - 1, is_side = column == 0 || column == columns - 1;
        if (!is_side) add_row(model, i - 1, i, i + 1, spacing, spacing, stiffness * (is_top ? 0.5 : 1));
        if (!is_top) add_row(model, i - columns, i, i + columns, spacing, spacing, stiffness * (is_side ? 0.5 : 1));
        if (row + 1 == rows || column + 1 == columns) continue;
        ck_Hinge *hinge = add(model, i, i + 1, i + columns, i + columns + 1, 2 * stiffness);
        for (int k = 0; k < 4; k++) hinge->weights[k] = (k == 0 || k == 3 ? 1 : -1) / spacing;
    }
    return status;
}

// An edge of a face, and the corner across it.
typedef struct Side {
    int a, b, across, face;
} Side;

static int compare_sides(const void *first, const void *second) {
    const Side *x = first, *y = second;
    const int left[] = {x->a, x->b, x->face}, right[] = {y->a, y->b, y->face};
    for (int i = 0; i < 3; i++)
        if (left[i] != right[i]) return left[i] < right[i] ? -1 : 1;
    return 0;
}

// Cotangent of the angle at a corner between two others.
static double cotangent(const double *corner, const double *one, const double *other) {
    double u[3], v[3], normal[3];
    ck_subtract(u, one, corner);
    ck_subtract(v, other, corner);
    ck_cross(normal, u, v);
    return ck_dot(u, v) / ck_length(normal);
}

static double area_of(const double *a, const double *b, const double *c) {
    double normal[3];
    ck_triangle_normal(normal, a, b, c);
    return 0.5 * ck_length(normal);
}

// Two faces at an edge of length e: weights of cotangents over e, and stiffness B·e²/(A + A'), which is that of a sheet
// of equilateral triangles, (2/√3)·B. Sources: Bergou and others 2006; Schmidt and Fraternali 2012, Universal formulae
// for the limiting elastic energy of membrane networks, for the factor.
static void add_edge(ck_Model *model, const Side *one, const Side *other, double stiffness) {
    const double *a = model->position + 3 * one->a, *b = model->position + 3 * one->b,
                 *c = model->position + 3 * one->across, *d = model->position + 3 * other->across;
    const double length = ck_distance(a, b), area = area_of(a, b, c) + area_of(a, b, d);
    const double at_a[2] = {cotangent(a, b, c), cotangent(a, b, d)}, at_b[2] = {cotangent(b, a, c), cotangent(b, a, d)};
    ck_Hinge *hinge = add(model, one->a, one->b, one->across, other->across, stiffness * length * length / area);
    hinge->weights[0] = (at_b[0] + at_b[1]) / length;
    hinge->weights[1] = (at_a[0] + at_a[1]) / length;
    hinge->weights[2] = -(at_a[0] + at_b[0]) / length;
    hinge->weights[3] = -(at_a[1] + at_b[1]) / length;
}

// Every pair of faces that share an edge: of three at one edge all three pairs.
static ck_Status bend_faces(ck_Model *model, double stiffness) {
    const size_t count = 3 * (size_t)model->triangle_count;
    Side *sides = malloc((count + 1) * sizeof *sides);
    if (!sides) return CK_NO_MEMORY;
    for (size_t i = 0; i < count; i++) {
        const int *corners = model->triangles[i / 3], a = corners[i % 3], b = corners[(i + 1) % 3];
        sides[i] = (Side){a < b ? a : b, a < b ? b : a, corners[(i + 2) % 3], (int)(i / 3)};
    }
    qsort(sides, count, sizeof *sides, compare_sides);
    size_t pairs = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = i + 1; k < count && sides[k].a == sides[i].a && sides[k].b == sides[i].b; k++) pairs++;
    ck_Status status = allocate(model, pairs);
    for (size_t i = 0; i < count && !status; i++)
        for (size_t k = i + 1; k < count && sides[k].a == sides[i].a && sides[k].b == sides[i].b; k++)
            add_edge(model, &sides[i], &sides[k], stiffness);
    free(sides);
    return status;
}

// A network's own.
static ck_Status take_own(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneNetwork *network = scene->file->network;
    ck_Status status = allocate(model, network->hinges_count);
    for (uint32_t i = 0; i < network->hinges_count && !status; i++) {
        const ck_SceneHinge *from = &network->hinges[i];
        char path[40];
        snprintf(path, sizeof path, "network.hinges[%u]", i);
        if (from->particles_count != from->weights_count)
            return ck_scene_fail(scene, path, error, "it has %u nodes and %u weights; give a weight for each",
                                 from->particles_count, from->weights_count);
        ck_Hinge *hinge = add(model, -1, -1, -1, -1, from->stiffness);
        hinge->rest = from->rest;
        for (uint32_t k = 0; k < from->particles_count; k++) {
            if (from->particles[k] >= (uint32_t)model->particle_count)
                return ck_scene_fail(scene, path, error,
                                     "hinge of node %u, which does not exist; the nodes are 0 to %d",
                                     from->particles[k], model->particle_count - 1);
            hinge->particles[k] = (int)from->particles[k];
            hinge->weights[k] = from->weights[k];
        }
    }
    return status;
}

ck_Status ck_model_build_hinges(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneBending *bending = scene->file->bending;
    const ck_SceneNetwork *network = scene->file->network;
    if (network && network->hinges_count && !bending) return take_own(model, scene, error);
    const double of_material = scene->file->material ? scene->file->material->bending : 0;
    const double stiffness = of_material > 0 ? of_material : bending ? bending->stiffness : 0;
    if (!bending && !(stiffness > 0)) return CK_OK;
    if (bending && of_material > 0 && bending->stiffness > 0)
        return ck_scene_fail(scene, "bending.stiffness", error, "the material has a bending stiffness, too; keep one");
    if (network && (network->hinges_count || !network->triangles_count))
        return ck_scene_fail(scene, "bending", error,
                             network->hinges_count ? "the network has hinges of its own; keep one of the two"
                                                   : "a network bends at its faces; give network.triangles");
    const char *rest = bending && bending->rest ? bending->rest : "flat";
    if (strcmp(rest, "flat") && strcmp(rest, "start"))
        return ck_scene_fail(scene, "bending.rest", error, "bending.rest is %s; it must be flat or start", rest);
    if (!(stiffness > 0)) return CK_OK;
    model->bending = stiffness;
    ck_Status status = model->body == CK_ROPE    ? bend_rope(model, stiffness)
                       : model->body == CK_CLOTH ? bend_cloth(model, stiffness)
                                                 : bend_faces(model, stiffness);
    for (int i = 0; i < model->hinge_count && !status; i++)
        if (!strcmp(rest, "start")) model->hinges[i].rest = ck_hinge_angle(&model->hinges[i], model->position);
    return status;
}
