#include "mesh_import.h"

#include "weld.h"

#include <assimp/cimport.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

// All meshes of a file in one, as its nodes place them: a vertex for each corner that a face names.
typedef struct Flat {
    double *position; // [3*vertex_count]
    int vertex_count, vertex_room;
    int (*triangles)[3];
    int triangle_count, triangle_room;
    struct Part {
        const char *names[3]; // of its node, mesh and material
        int first, count;     // vertices
    } * parts;
    int part_count;
    int *members; // [vertex_count] scratch
} Flat;

// Room for more items, doubled. False without memory or above the most.
static bool grow(void **items, int *room, int count, size_t size, int most) {
    if (count > most) return false;
    if (count <= *room) return true;
    const int wanted = count > most / 2 ? most : 2 * count;
    void *more = realloc(*items, (size_t)wanted * size);
    if (!more) return false;
    *items = more;
    *room = wanted;
    return true;
}

static void transform(double *out, const struct aiMatrix4x4 *by, const struct aiVector3D *from) {
    const double x = from->x, y = from->y, z = from->z;
    out[0] = by->a1 * x + by->a2 * y + by->a3 * z + by->a4;
    out[1] = by->b1 * x + by->b2 * y + by->b3 * z + by->b4;
    out[2] = by->c1 * x + by->c2 * y + by->c3 * z + by->c4;
}

static ck_Status add_mesh(Flat *flat, const struct aiScene *scene, const struct aiNode *node, const struct aiMesh *mesh,
                          const struct aiMatrix4x4 *place, ck_Error *error) {
    const int base = flat->vertex_count;
    struct Part *more = realloc(flat->parts, sizeof *more * (size_t)(flat->part_count + 1));
    if (!more) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    flat->parts = more;
    // a corner of a face each, in the order of faces, which is the one that files share
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        const struct aiFace *face = &mesh->mFaces[i];
        if (face->mNumIndices != 3) continue;
        if (!grow((void **)&flat->triangles, &flat->triangle_room, flat->triangle_count + 1, sizeof(int[3]),
                  CK_MESH_MAX_TRIANGLES) ||
            !grow((void **)&flat->position, &flat->vertex_room, flat->vertex_count + 3, sizeof(double[3]),
                  3 * CK_MESH_MAX_TRIANGLES))
            return ck_fail(error, CK_BAD_INPUT, "has more than %d triangles; a mesh has at most as many",
                           CK_MESH_MAX_TRIANGLES);
        for (int corner = 0; corner < 3; corner++) {
            if (face->mIndices[corner] >= mesh->mNumVertices)
                return ck_fail(error, CK_BAD_INPUT, "a face names vertex %u of %u", face->mIndices[corner],
                               mesh->mNumVertices);
            transform(flat->position + 3 * (size_t)flat->vertex_count, place, &mesh->mVertices[face->mIndices[corner]]);
            flat->triangles[flat->triangle_count][corner] = flat->vertex_count++;
        }
        flat->triangle_count++;
    }
    struct aiString material = {0};
    if (mesh->mMaterialIndex < scene->mNumMaterials)
        aiGetMaterialString(scene->mMaterials[mesh->mMaterialIndex], AI_MATKEY_NAME, &material);
    struct Part *part = &flat->parts[flat->part_count++];
    *part = (struct Part){.names = {node->mName.data, mesh->mName.data, strdup(material.data)},
                          .first = base,
                          .count = flat->vertex_count - base};
    return part->names[2] ? CK_OK : ck_fail(error, CK_NO_MEMORY, "out of memory");
}

// Every mesh where the tree of nodes puts it.
static ck_Status add_node(Flat *flat, const struct aiScene *scene, const struct aiNode *node,
                          const struct aiMatrix4x4 *above, int depth, ck_Error *error) {
    struct aiMatrix4x4 place = *above;
    aiMultiplyMatrix4(&place, &node->mTransformation);
    if (depth > 1000) return ck_fail(error, CK_BAD_INPUT, "its nodes are nested more than 1000 deep");
    ck_Status status = CK_OK;
    for (unsigned i = 0; i < node->mNumMeshes && !status; i++)
        if (node->mMeshes[i] < scene->mNumMeshes)
            status = add_mesh(flat, scene, node, scene->mMeshes[node->mMeshes[i]], &place, error);
    for (unsigned i = 0; i < node->mNumChildren && !status; i++)
        status = add_node(flat, scene, node->mChildren[i], &place, depth + 1, error);
    return status;
}

// Scales, and turns so that the file's upward axis is y.
static void set_upright(Flat *flat, const ck_MeshOptions *options) {
    for (int i = 0; i < flat->vertex_count; i++) {
        double *at = flat->position + 3 * (size_t)i;
        const double x = options->scale * at[0], y = options->scale * at[1], z = options->scale * at[2];
        at[0] = options->up == 'x' ? -y : x;
        at[1] = options->up == 'x' ? x : options->up == 'z' ? z : y;
        at[2] = options->up == 'z' ? -y : z;
    }
}

static ck_Status check(const Flat *flat, ck_Error *error) {
    if (!flat->triangle_count)
        return ck_fail(error, CK_BAD_INPUT, "has no triangles; a cloth needs faces, not points or lines");
    for (int i = 0; i < 3 * flat->vertex_count; i++)
        if (!isfinite(flat->position[i]))
            return ck_fail(error, CK_BAD_INPUT, "has a coordinate that is no finite number, in face %d", i / 9);
    return CK_OK;
}

// Welds, and leaves out triangles of less than three places.
static ck_Status weld(Flat *flat, int *place, double distance, ck_Error *error) {
    const int places = ck_weld(place, flat->position, flat->vertex_count, distance);
    if (places < 0) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (places > CK_MESH_MAX_VERTICES)
        return ck_fail(error, CK_BAD_INPUT, "has %d vertices; a mesh has at most %d", places, CK_MESH_MAX_VERTICES);
    int kept = 0;
    for (int i = 0; i < flat->triangle_count; i++) {
        int corners[3];
        for (int k = 0; k < 3; k++) corners[k] = place[flat->triangles[i][k]];
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
        memcpy(flat->triangles[kept++], corners, sizeof corners);
    }
    flat->triangle_count = kept;
    if (!kept)
        return ck_fail(error, CK_BAD_INPUT,
                       "has no triangle whose corners are more than the weld of %g m apart; is its scale right?",
                       distance);
    return CK_OK;
}

static void put(FILE *out, const void *items, size_t size, size_t count) {
    fwrite(items, size, count, out);
}

// Renumbers the places that triangles name, in the order in which they do, and writes places and triangles.
//   number  [vertex_count] scratch, of places: −1 where no triangle names one
static void put_mesh(FILE *out, const Flat *flat, const int *place, int *number, double *kept) {
    int count = 0;
    for (int i = 0; i < flat->vertex_count; i++) number[i] = -1;
    for (int i = 0; i < flat->triangle_count; i++)
        for (int k = 0; k < 3; k++) {
            int *own = &number[flat->triangles[i][k]];
            if (*own < 0) *own = count++;
            flat->triangles[i][k] = *own;
        }
    // a place is where its first vertex is
    for (int i = flat->vertex_count - 1; i >= 0; i--)
        if (number[place[i]] >= 0)
            memcpy(kept + 3 * (size_t)number[place[i]], flat->position + 3 * (size_t)i, sizeof(double[3]));
    put(out, &count, sizeof count, 1);
    put(out, &flat->triangle_count, sizeof flat->triangle_count, 1);
    put(out, kept, sizeof(double[3]), (size_t)count);
    put(out, flat->triangles, sizeof(int[3]), (size_t)flat->triangle_count);
}

// A group for every name: count, then name and vertices of each, every vertex once.
//   number  [vertex_count] of places;  seen  [vertex_count] scratch
static void put_groups(FILE *out, const Flat *flat, const int *place, const int *number, int *seen) {
    const int count = 3 * flat->part_count;
    put(out, &count, sizeof count, 1);
    for (int i = 0; i < flat->vertex_count; i++) seen[i] = -1;
    for (int i = 0; i < flat->part_count; i++) {
        const struct Part *part = &flat->parts[i];
        int size = 0;
        for (int k = part->first; k < part->first + part->count; k++) {
            const int place_of = place[k];
            if (number[place_of] < 0 || seen[place_of] == i) continue;
            seen[place_of] = i;
            flat->members[size++] = number[place_of];
        }
        for (int k = 0; k < 3; k++) {
            char name[CK_MESH_NAME] = "";
            snprintf(name, sizeof name, "%s", part->names[k]);
            put(out, name, sizeof name, 1);
            put(out, &size, sizeof size, 1);
            put(out, flat->members, sizeof(int), (size_t)size);
        }
    }
}

ck_Status ck_mesh_import(FILE *out, const char *path, const ck_MeshOptions *options, ck_Error *error) {
    const struct aiScene *scene = aiImportFile(path, aiProcess_Triangulate | aiProcess_SortByPType);
    if (!scene) return ck_fail(error, CK_BAD_INPUT, "cannot be read: %.200s", aiGetErrorString());
    Flat flat = {0};
    const struct aiMatrix4x4 none = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    ck_Status status = scene->mRootNode ? add_node(&flat, scene, scene->mRootNode, &none, 0, error)
                                        : ck_fail(error, CK_BAD_INPUT, "has nothing in it");
    if (!status) set_upright(&flat, options);
    if (!status) status = check(&flat, error);
    const size_t count = (size_t)flat.vertex_count + 1;
    int *place = malloc(4 * count * sizeof *place), *number = place + count;
    flat.members = number + count;
    double *kept = malloc(3 * count * sizeof *kept);
    if (!status && (!place || !kept)) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    if (!status) status = weld(&flat, place, options->weld, error);
    if (!status) put_mesh(out, &flat, place, number, kept);
    if (!status) put_groups(out, &flat, place, number, flat.members + count);
    if (!status && (fflush(out) || ferror(out))) status = ck_fail(error, CK_NO_MEMORY, "out of memory");
    free(kept);
    free(place);
    for (int i = 0; i < flat.part_count; i++) free((char *)flat.parts[i].names[2]);
    free(flat.parts);
    free(flat.triangles);
    free(flat.position);
    aiReleaseImport(scene);
    return status;
}
