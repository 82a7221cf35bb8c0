// Meshes of every kind of file are the same mesh, bodies of them have their mass and pins, and hostile files are
// errors.
#include "fixture.h"

#include "mesh.h"
#include "scene.h"
#include "statistics.h"
#include "vector.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/clothcheck-test-XXXXXX";

static const char *path_to(const char *name) {
    static char path[200];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static const char *write_bytes(const char *name, const void *bytes, size_t size) {
    FILE *file = fopen(path_to(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
    return path_to(name);
}

static const char *write_text(const char *name, const char *text) {
    return write_bytes(name, text, strlen(text));
}

static const ck_MeshOptions plain = {.scale = 1, .up = 'y'};

// A square of two triangles, twice: 0.5 m wide at x = 0, and again at x = 2 in a group of its own.
static const char obj[] = "v 0 0 0\nv 0.5 0 0\nv 0.5 0.5 0\nv 0 0.5 0\nv 2 0 0\nv 2.5 0 0\nv 2.5 0.5 0\nv 2 0.5 0\n"
                          "g left\nf 1 2 3\nf 1 3 4\ng right\nf 5 6 7 8\n";
static const char ply[] = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\n"
                          "property float z\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
                          "0 0 0\n0.5 0 0\n0.5 0.5 0\n0 0.5 0\n2 0 0\n2.5 0 0\n2.5 0.5 0\n2 0.5 0\n"
                          "3 0 1 2\n3 0 2 3\n4 4 5 6 7\n";
static const char gltf[] =
    "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0, 1]}],"
    "\"nodes\": [{\"mesh\": 0, \"name\": \"left\"}, {\"mesh\": 0, \"name\": \"right\", \"translation\": [2, 0, 0]}],"
    "\"meshes\": [{\"primitives\": [{\"attributes\": {\"POSITION\": 0}, \"indices\": 1}]}],"
    "\"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\","
    "\"min\": [0, 0, 0], \"max\": [0.5, 0.5, 0]},"
    "{\"bufferView\": 1, \"componentType\": 5123, \"count\": 6, \"type\": \"SCALAR\"}],"
    "\"bufferViews\": [{\"buffer\": 0, \"byteOffset\": 0, \"byteLength\": 48},"
    "{\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 12}],"
    "\"buffers\": [{\"byteLength\": 60, \"uri\": \"data:application/octet-stream;base64,"
    "AAAAAAAAAAAAAAAAAAAAPwAAAAAAAAAAAAAAPwAAAD8AAAAAAAAAAAAAAD8AAAAAAAABAAIAAAACAAMA\"}]}";

// A file of triangles that share nothing, as text or as bytes.
static const char *write_stl(const char *name, bool is_binary) {
    static const float corners[4][3][3] = {{{0, 0, 0}, {0.5f, 0, 0}, {0.5f, 0.5f, 0}},
                                           {{0, 0, 0}, {0.5f, 0.5f, 0}, {0, 0.5f, 0}},
                                           {{2, 0, 0}, {2.5f, 0, 0}, {2.5f, 0.5f, 0}},
                                           {{2, 0, 0}, {2.5f, 0.5f, 0}, {2, 0.5f, 0}}};
    FILE *file = fopen(path_to(name), "wb");
    assert_non_null(file);
    const float normal[3] = {0, 0, 1};
    if (is_binary) {
        const char header[80] = "made by hand";
        const uint32_t count = 4;
        fwrite(header, 1, sizeof header, file);
        fwrite(&count, sizeof count, 1, file);
    } else {
        fprintf(file, "solid square\n");
    }
    for (int i = 0; i < 4; i++) {
        const uint16_t none = 0;
        if (is_binary) {
            fwrite(normal, sizeof normal, 1, file);
            fwrite(corners[i], sizeof corners[i], 1, file);
            fwrite(&none, sizeof none, 1, file);
            continue;
        }
        fprintf(file, "facet normal 0 0 1\nouter loop\n");
        for (int k = 0; k < 3; k++)
            fprintf(file, "vertex %g %g %g\n", corners[i][k][0], corners[i][k][1], corners[i][k][2]);
        fprintf(file, "endloop\nendfacet\n");
    }
    if (!is_binary) fprintf(file, "endsolid square\n");
    fclose(file);
    return path_to(name);
}

static double area_of(const ck_Mesh *mesh) {
    double sum = 0;
    for (int i = 0; i < mesh->triangle_count; i++) {
        double one[3], other[3], normal[3];
        const int *corners = mesh->triangles[i];
        ck_subtract(one, mesh->position + 3 * corners[1], mesh->position + 3 * corners[0]);
        ck_subtract(other, mesh->position + 3 * corners[2], mesh->position + 3 * corners[0]);
        ck_cross(normal, one, other);
        sum += 0.5 * ck_length(normal);
    }
    return sum;
}

static void load(ck_Mesh *mesh, const char *path, const ck_MeshOptions *options) {
    ck_Error error = {0};
    if (ck_mesh_load(mesh, path, options, &error)) fail_msg("%s", error.message);
}

static void test_kinds(void **state) {
    (void)state;
    const char *names[] = {"a.obj", "a.ply", "a.gltf", "text.stl", "bytes.STL"};
    write_text("a.obj", obj);
    write_text("a.ply", ply);
    write_text("a.gltf", gltf);
    write_stl("text.stl", false);
    write_stl("bytes.STL", true);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        ck_Mesh mesh;
        int(*edges)[2], edge_count;
        load(&mesh, path_to(names[i]), &plain);
        if (mesh.vertex_count != 8 || mesh.triangle_count != 4)
            fail_msg("%s: %d vertices, %d triangles", names[i], mesh.vertex_count, mesh.triangle_count);
        assert_true(fabs(area_of(&mesh) - 0.5) < 1e-12);
        assert_int_equal(ck_mesh_edges(&edges, &edge_count, mesh.triangles, mesh.triangle_count), CK_OK);
        assert_int_equal(edge_count, 10);
        free(edges);
        ck_mesh_free(&mesh);
    }
}

static const ck_MeshGroup *group_of(const ck_Mesh *mesh, const char *name) {
    for (int i = 0; i < mesh->group_count; i++)
        if (!strcmp(mesh->groups[i].name, name)) return &mesh->groups[i];
    fail_msg("no group %s", name);
    return NULL;
}

static void test_groups(void **state) {
    (void)state;
    const char *names[] = {"a.obj", "a.gltf"};
    for (int i = 0; i < 2; i++) {
        ck_Mesh mesh;
        write_text(names[i], i ? gltf : obj);
        load(&mesh, path_to(names[i]), &plain);
        const ck_MeshGroup *group = group_of(&mesh, "right");
        assert_true(group->vertex_count >= 4);
        for (int k = 0; k < group->vertex_count; k++) assert_true(mesh.position[3 * group->vertices[k]] >= 2);
        ck_mesh_free(&mesh);
    }
}

// Two sheets that a gap of 1 mm parts become one where it is welded; an axis that points up becomes y.
static void test_options(void **state) {
    (void)state;
    static const char gap[] = "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1.001 0 0\nv 0 0 1.001\nv 1 0 1\nf 1 2 3\nf 4 6 5\n";
    const struct {
        ck_MeshOptions options;
        int vertices;
        double highest; // m
    } cases[] = {{{.scale = 1, .up = 'y'}, 6, 0},
                 {{.scale = 1, .up = 'y', .weld = 1e-300}, 6, 0},
                 {{.scale = 1, .up = 'y', .weld = 0.0015}, 4, 0},
                 {{.scale = 0.001, .up = 'z', .weld = 1.5e-6}, 4, 0.001001},
                 {{.scale = 2, .up = 'x', .weld = 0.003}, 4, 2.002}};
    write_text("gap.obj", gap);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_Mesh mesh;
        double highest = -1;
        load(&mesh, path_to("gap.obj"), &cases[i].options);
        assert_int_equal(mesh.vertex_count, cases[i].vertices);
        assert_int_equal(mesh.triangle_count, 2);
        for (int k = 0; k < mesh.vertex_count; k++) highest = fmax(highest, mesh.position[3 * k + 1]);
        // floats hold coordinates to 6e-8, and which of two welded places stays is that of the first
        assert_true(fabs(highest - cases[i].highest) < 2e-3 * cases[i].options.scale);
        ck_mesh_free(&mesh);
    }
}

static void build(ck_Model *model, const char *rest) {
    char text[1000];
    ck_Scene scene;
    ck_Error error = {0};
    snprintf(text, sizeof text, "name: m\n%s\ntime: {duration: 1, step: 0.1}\n", rest);
    ck_Status status = ck_scene_load(&scene, write_text("scene.yaml", text), &error);
    if (!status) status = ck_model_build(model, &scene, &error);
    if (status) fail_msg("%s", error.message);
    ck_scene_free(&scene);
}

static void test_body(void **state) {
    (void)state;
    static const struct {
        const char *pins;
        int count;
    } pins[] = {{"y > 0.4", 4}, {"x<0.1", 2}, {"box 1.9 -1 -1 3 1 1", 4}, {"right", 4}, {"left", 4}, {"7", 1}};
    write_text("a.obj", obj);
    for (size_t i = 0; i < sizeof pins / sizeof *pins; i++) {
        char rest[300];
        double mass = 0;
        ck_Model model;
        snprintf(rest, sizeof rest, "mesh: {file: a.obj, %s}\nsprings: {stiffness: 10}\npins: ['%s']",
                 i % 2 ? "mass: 0.3" : "density: 0.6", pins[i].pins);
        build(&model, rest);
        for (int k = 0; k < model.particle_count; k++) mass += model.mass[k];
        assert_true(fabs(mass - 0.3) < 1e-12);
        assert_int_equal(model.pin_count, pins[i].count);
        assert_int_equal(model.spring_count, 10);
        ck_model_free(&model);
    }
}

// Three faces at an edge, as a pocket has, are a body like any other.
static void test_branches(void **state) {
    (void)state;
    ck_Model model;
    write_text("branch.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n");
    build(&model, "mesh: {file: branch.obj, mass: 1}\nsprings: {stiffness: 10}");
    assert_int_equal(model.spring_count, 7);
    assert_int_equal(model.triangle_count, 3);
    ck_model_free(&model);
}

static void refuse(const char *path, const char *wanted) {
    ck_Mesh mesh;
    ck_Error error = {0};
    ck_Status status = ck_mesh_load(&mesh, path, &plain, &error);
    if (status != CK_BAD_INPUT || !strstr(error.message, wanted) || !strstr(error.message, path))
        fail_msg("%s: status %d, '%s', without '%s'", path, status, error.message, wanted);
    ck_mesh_free(&mesh);
}

static void test_hostile(void **state) {
    (void)state;
    static const struct {
        const char *name, *text, *message;
    } files[] = {
        {"empty.obj", "", "cannot be read"},
        {"empty.ply", "", "cannot be read"},
        {"empty.stl", "", "cannot be read"},
        {"empty.gltf", "", "cannot be read"},
        {"empty.glb", "", "cannot be read"},
        {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", ""},
        {"lines.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nl 2 3\n", ""},
        {"beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 900000000\n", ""},
        {"before.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -900\n", ""},
        {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 0 0\n", ""},
        {"nan.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ""},
        {"inf.obj", "v 1e999 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", ""},
        {"point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "is its scale right?"},
        {"words.obj", "v a b c\nf x y z\n", ""},
        {"binary.obj",
         "\x7f"
         "ELF\x02\x01\x01",
         ""},
        {"header.ply", "ply\n", ""},
        {"claims.ply",
         "ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float x\nproperty float y\n"
         "property float z\nelement face 2000000000\nproperty list uchar int vertex_indices\nend_header\nabc",
         ""},
        {"beyond.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 77\n",
         ""},
        {"text.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", ""},
        {"garbage.stl", "neither solid nor anything else", ""},
        {"text.gltf", "{\"asset\": {\"version\": \"2.0\"}", "cannot be read"},
        {"none.gltf", "{\"asset\": {\"version\": \"2.0\"}}", ""},
        {"old.gltf", "{\"asset\": {\"version\": \"-3\"}, \"meshes\": 7}", ""},
        {"circle.gltf",
         "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], \"nodes\": [{\"children\": "
         "[0]}]}",
         ""},
        {"away.gltf",
         "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"byteLength\": 4000000000, \"uri\": \"/dev/zero\"}]}",
         ""},
        {"short.glb", "glTF\x02\x00\x00\x00\xff\xff\xff\x7f", ""},
        {"cloth.abc", "v 0 0 0\n", "is of no known kind"},
        {"cloth", "v 0 0 0\n", "is of no known kind"},
    };
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        refuse(write_text(files[i].name, files[i].text), files[i].message);
    refuse(path_to("missing.obj"), "No such file");
    assert_int_equal(mkdir(path_to("folder.obj"), 0700), 0);
    refuse(path_to("folder.obj"), "is not a file");
    // 1 GB of nothing, and a hundred million faces that are not there
    int file = open(path_to("large.stl"), O_CREAT | O_WRONLY, 0600);
    assert_int_equal(ftruncate(file, 1 << 30), 0);
    close(file);
    refuse(path_to("large.stl"), "is 1024 MiB long; a mesh has at most 256");
    char claims[134] = "claims";
    const uint32_t faces = 100000000;
    memcpy(claims + 80, &faces, sizeof faces);
    refuse(write_bytes("claims.stl", claims, sizeof claims), "");
}

// Files with a few bytes changed are an error, or a mesh that is whole.
static void test_damage(void **state) {
    (void)state;
    static const struct {
        const char *name, *text;
        size_t size;
    } whole[] = {{"d.obj", obj, sizeof obj}, {"d.ply", ply, sizeof ply}, {"d.gltf", gltf, sizeof gltf}};
    ck_Random random = ck_random_seed(5);
    for (int i = 0; i < 36; i++) {
        char bytes[2000];
        const size_t size = whole[i % 3].size - 1;
        memcpy(bytes, whole[i % 3].text, size);
        for (int k = 0; k < 3; k++) {
            const size_t at = (size_t)(ck_random_unit(&random) * (double)size);
            bytes[at] = (char)(32 + 95 * ck_random_unit(&random));
        }
        ck_Mesh mesh;
        ck_Error error = {0};
        ck_Status status = ck_mesh_load(&mesh, write_bytes(whole[i % 3].name, bytes, size), &plain, &error);
        assert_true(status == CK_OK || (status == CK_BAD_INPUT && *error.message));
        for (int k = 0; k < 3 * mesh.triangle_count && !status; k++)
            assert_in_range(mesh.triangles[k / 3][k % 3], 0, mesh.vertex_count - 1);
        for (int k = 0; k < 3 * mesh.vertex_count && !status; k++) assert_true(isfinite(mesh.position[k]));
        ck_mesh_free(&mesh);
    }
}

static int make_folder(void **state) {
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state) {
    (void)state;
    char command[100];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),  cmocka_unit_test(test_groups),   cmocka_unit_test(test_options),
        cmocka_unit_test(test_body),   cmocka_unit_test(test_branches), cmocka_unit_test(test_hostile),
        cmocka_unit_test(test_damage),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
