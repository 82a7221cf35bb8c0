// Meshes of any kind: what is read is triangles of vertices that are there, or an error; a crash of the importer is its
// own child's.
#include "fuzz.h"

#include "mesh.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    // the kind is told by the name
    static const char *const kinds[] = {"obj", "ply", "stl", "gltf"};
    const ck_MeshOptions options = {.weld = size & 1 ? 1e-3 : 0, .scale = 1, .up = "xyz"[size % 3]};
    char name[40];
    ck_Mesh mesh = {0};
    int(*edges)[2] = NULL, count = 0;
    if (!size) return 0;
    snprintf(name, sizeof name, "input.%s", kinds[data[0] % 4]);
    fuzz_write(name, data + 1, size - 1);
    if (!ck_mesh_load(&mesh, name, &options, NULL)) {
        for (int i = 0; i < 3 * mesh.triangle_count; i++)
            if (mesh.triangles[i / 3][i % 3] < 0 || mesh.triangles[i / 3][i % 3] >= mesh.vertex_count) abort();
        for (int i = 0; i < 3 * mesh.vertex_count; i++)
            if (!isfinite(mesh.position[i])) abort();
        ck_mesh_edges(&edges, &count, (const int(*)[3])mesh.triangles, mesh.triangle_count);
    }
    free(edges);
    ck_mesh_free(&mesh);
    return 0;
}
