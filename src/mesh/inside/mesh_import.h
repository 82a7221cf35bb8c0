// A file read by assimp, flat.
#ifndef CK_MESH_IMPORT_H
#define CK_MESH_IMPORT_H

#include "mesh.h"

#include <stdio.h>

// Reads a file and writes its welded mesh, for ck_mesh_read_back. Errors: CK_BAD_INPUT, CK_NO_MEMORY, CK_IO.
ck_Status ck_mesh_import(FILE *out, const char *path, const ck_MeshOptions *options, ck_Error *error);

#endif
