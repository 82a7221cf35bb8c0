// The bodies of a scene: their particles, springs and the names of their pins.
#ifndef CK_BODY_H
#define CK_BODY_H

#include "model.h"
#include "scene.h"

// Fills the particles and springs of a model whose time and labels are set.
// Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_model_build_body(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// The same of a rectangle of cloth; and of a mesh, from its file.
ck_Status ck_model_build_cloth(ck_Model *model, const ck_Scene *scene, ck_Error *error);
ck_Status ck_model_build_mesh(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// Fills the hinges of a body whose particles and faces are there, where the scene bends. Errors: CK_BAD_INPUT,
// CK_NO_MEMORY.
ck_Status ck_model_build_hinges(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// The springs that a body is built with: the scene's or, where it has a material, of 1 N/m, which ck_model_set_material
// changes. NULL: none.
const ck_SceneSprings *ck_body_springs(const ck_Scene *scene);

// The mass of a body that is given its own, or the material's density times an area. Errors: CK_BAD_INPUT at path
// unless exactly one is given.
ck_Status ck_body_mass(double *mass, const ck_Scene *scene, double own, double area, const char *path, ck_Error *error);

// Gives springs and, on a grid, masses what the scene's material makes of them. Errors: CK_BAD_INPUT where the body
// cannot have it.
ck_Status ck_model_set_material(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// Shares the area of each face among its corners: into mass, times density, kg/m². Returns the sum, m².
double ck_body_share_area(ck_Model *model, double density);

// The air of a scene, and the faces that it acts on. Errors: CK_BAD_INPUT where there are none, CK_NO_MEMORY.
ck_Status ck_model_set_wind(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// Errors: CK_BAD_INPUT at the place of a shape that is none, CK_NO_MEMORY.
ck_Status ck_model_set_colliders(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// Adds the rigid bodies of a scene behind the cloth, and the springs that they hang on. Errors: CK_BAD_INPUT where one
// would touch what is not modelled, or starts inside of something; CK_NO_MEMORY.
ck_Status ck_model_add_rigid(ck_Model *model, const ck_Scene *scene, bool is_part, ck_Error *error);

// A sphere's or a box's shape of the keys at a place of the scene. Errors: CK_BAD_INPUT.
ck_Status ck_model_set_sphere(ck_Collider *collider, const ck_SceneSphere *from);
ck_Status ck_model_set_box(ck_Collider *collider, const ck_SceneBox *from, const ck_Scene *scene, const char *at,
                           ck_Error *error);

// The paths of the pins and colliders that move. Errors: CK_BAD_INPUT, CK_NO_MEMORY.
ck_Status ck_model_set_paths(ck_Model *model, const ck_Scene *scene, ck_Error *error);

// The path of a file that a scene names, beside the scene's. NULL without memory. The caller frees it.
char *ck_body_file(const ck_Scene *scene, const char *file);

// Room for so many particles and springs. Errors: CK_BAD_INPUT where there are too many, CK_NO_MEMORY.
ck_Status ck_body_allocate(ck_Model *model, const ck_Scene *scene, const char *body, double particles, double springs,
                           ck_Error *error);

// Adds a spring unless its stiffness is 0, which models none.
void ck_body_add_spring(ck_Model *model, const ck_SceneSprings *springs, int a, int b, double length,
                        ck_SpringKind kind);

// The size and spacing, m, of a body that is no grid: as given, or where 0 what its particles and springs are.
void ck_body_set_lengths(ck_Model *model, double size, double spacing);

// Moves the particles that are not pinned out of the body's plane as the scene asks. Rest lengths stay those of the
// flat body.
void ck_model_add_noise(ck_Model *model, const ck_Scene *scene);

// The particles that a pin's name stands for, each once: a corner, an edge, first, last, row:column, a number, a place
// or a group.
//   chosen  [particle_count] out;  count  out
// Errors: CK_BAD_INPUT at path.
ck_Status ck_model_resolve_pin(int *chosen, int *count, const ck_Model *model, const ck_Scene *scene, const char *pin,
                               const char *path, ck_Error *error);

// Scales from to length 1. Errors: CK_BAD_INPUT at path where it has no direction.
ck_Status ck_model_unit(double *out, const double *from, const ck_Scene *scene, const char *path, ck_Error *error);

#endif
