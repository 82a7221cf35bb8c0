// A mesh of a file as a body: edges are springs, and faces carry the mass.
#include "body.h"

#include "mesh.h"
#include "vector.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *ck_body_file(const ck_Scene *scene, const char *file) {
    const char *folder = scene->document.file, *end = strrchr(folder, '/');
    char *path;
    if (*file == '/' || !end) return strdup(file);
    return asprintf(&path, "%.*s/%s", (int)(end - folder), folder, file) < 0 ? NULL : path;
}

static ck_Status load(ck_Mesh *mesh, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneMesh *from = scene->file->mesh;
    ck_MeshOptions options = {.weld = from->weld, .scale = from->scale > 0 ? from->scale : 1, .up = 'y'};
    if (from->up && (strlen(from->up) != 1 || !strchr("xyz", *from->up)))
        return ck_scene_fail(scene, "mesh.up", error, "mesh.up is %s; it must be x, y or z", from->up);
    if (from->up) options.up = *from->up;
    if (from->mass > 0 && from->density > 0)
        return ck_scene_fail(scene, "mesh", error, "mesh has both mass and density; keep one");
    double mass;
    ck_Status status = ck_body_mass(&mass, scene, from->mass > 0 ? from->mass : from->density, 1, "mesh", error);
    if (status) return status;
    ck_Error inner = {0};
    char *path = ck_body_file(scene, from->file);
    status = path ? ck_mesh_load(mesh, path, &options, &inner) : CK_NO_MEMORY;
    free(path);
    return status == CK_BAD_INPUT ? ck_scene_fail(scene, "mesh.file", error, "%s", inner.message) : status;
}

static ck_Status set_masses(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneMesh *from = scene->file->mesh;
    const double area = ck_body_share_area(model, 1);
    double mass;
    ck_Status status =
        ck_body_mass(&mass, scene, from->mass > 0 ? from->mass : from->density * area, area, "mesh", error);
    ck_body_share_area(model, mass / area);
    for (int i = 0; i < model->particle_count && !status; i++)
        if (!(model->mass[i] > 0))
            status =
                ck_scene_fail(scene, "mesh.file", error,
                              "vertex %d has no area around it, and so no mass; mend the faces there, or weld more", i);
    return status;
}

// Takes over the groups of a mesh.
static ck_Status keep_groups(ck_Model *model, ck_Mesh *mesh) {
    model->groups = calloc((size_t)mesh->group_count + 1, sizeof *model->groups);
    if (!model->groups) return CK_NO_MEMORY;
    for (int i = 0; i < mesh->group_count; i++) {
        ck_Group *group = &model->groups[model->group_count++];
        group->name = strdup(mesh->groups[i].name);
        group->particles = mesh->groups[i].vertices;
        group->particle_count = mesh->groups[i].vertex_count;
        mesh->groups[i].vertices = NULL;
        if (!group->name) return CK_NO_MEMORY;
    }
    return CK_OK;
}

static ck_Status fill(ck_Model *model, const ck_Scene *scene, ck_Mesh *mesh, const int (*edges)[2], int edge_count,
                      ck_Error *error) {
    ck_Status status = ck_body_allocate(model, scene, "mesh", mesh->vertex_count, edge_count, error);
    if (status) return status;
    memcpy(model->position, mesh->position, sizeof(double[3]) * (size_t)mesh->vertex_count);
    for (int i = 0; i < model->particle_count && scene->file->mesh->origin; i++)
        ck_add_scaled(model->position + 3 * i, 1, scene->file->mesh->origin);
    model->triangles = mesh->triangles;
    model->triangle_count = mesh->triangle_count;
    mesh->triangles = NULL;
    const ck_SceneSprings *springs = ck_body_springs(scene);
    for (int i = 0; i < edge_count && springs; i++) {
        const int a = edges[i][0], b = edges[i][1];
        ck_body_add_spring(model, springs, a, b, ck_distance(model->position + 3 * a, model->position + 3 * b),
                           CK_STRUCTURAL);
    }
    model->body = CK_MESH;
    ck_body_set_lengths(model, 0, 0);
    status = keep_groups(model, mesh);
    return status ? status : set_masses(model, scene, error);
}

ck_Status ck_model_build_mesh(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    ck_Mesh mesh = {0};
    int(*edges)[2] = NULL, edge_count = 0;
    ck_Status status = load(&mesh, scene, error);
    if (!status) status = ck_mesh_edges(&edges, &edge_count, mesh.triangles, mesh.triangle_count);
    if (!status) status = fill(model, scene, &mesh, edges, edge_count, error);
    free(edges);
    ck_mesh_free(&mesh);
    return status;
}
