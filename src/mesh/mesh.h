// A triangle mesh of a file: OBJ, PLY, STL or glTF.
#ifndef CK_MESH_H
#define CK_MESH_H

#include "status.h"

// The largest file that is read, the most vertices and triangles of a mesh, and the letters of a group's name.
#define CK_MESH_MAX_BYTES (256u << 20)
#define CK_MESH_MAX_VERTICES 4000000
#define CK_MESH_MAX_TRIANGLES 8000000
#define CK_MESH_NAME 64

// Vertices that a file names together: an object, a group or a material.
typedef struct ck_MeshGroup {
    char name[CK_MESH_NAME];
    int *vertices, vertex_count;
} ck_MeshGroup;

typedef struct ck_Mesh {
    double *position; // [3*vertex_count] m
    int vertex_count;
    int (*triangles)[3]; // [triangle_count]
    int triangle_count;
    ck_MeshGroup *groups;
    int group_count;
} ck_Mesh;

typedef struct ck_MeshOptions {
    double weld;  // m, after scaling: vertices that close become one; 0: those at the same place
    double scale; // m of one of the file's units
    char up;      // the file's axis that points up, 'x', 'y' or 'z'; it becomes y
} ck_MeshOptions;

// Reads a file in a child process with limits of time and memory, so that a hostile file costs an error. Vertices are
// in the order in which faces first name them; coordinates are as exact as floats, which is how files are read; what
// no face names, and faces of less than three places, is left out.
// Errors: CK_BAD_INPUT with what is wrong and what would be right, CK_IO, CK_NO_MEMORY. Free with ck_mesh_free in any
// case.
ck_Status ck_mesh_load(ck_Mesh *mesh, const char *path, const ck_MeshOptions *options, ck_Error *error);

// Accepts a zeroed mesh.
void ck_mesh_free(ck_Mesh *mesh);

// Every edge of the triangles once, its lower vertex first, in the order of vertices.
// Errors: CK_NO_MEMORY. Free *edges in any case.
ck_Status ck_mesh_edges(int (**edges)[2], int *edge_count, const int (*triangles)[3], int triangle_count);

#endif
