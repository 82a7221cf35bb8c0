// A scene file as it was written: SI units, nothing resolved yet. What is left out is NULL or 0 and is not modelled.
#ifndef CK_SCENE_H
#define CK_SCENE_H

#include "document.h"
#include "status.h"

#include <stdbool.h>
#include <stdint.h>

// The most particles, and the most springs, that a scene may ask for.
#define CK_SCENE_MAX_PARTICLES 4000000

// The most that a changed scene's name is longer, the zero at its end included.
#define CK_SCENE_SUFFIX 120

typedef struct ck_SceneCloth {
    uint32_t rows, columns;
    double spacing, mass; // m between neighbours; kg of the whole cloth, 0: the material's
    char *pattern;        // square, cross or triangle; NULL: square
    double *origin;       // [3] m, row 0 column 0; NULL: (0, 0, 0)
    double *across;       // [3] direction of growing column; NULL: (1, 0, 0)
    double *down;         // [3] direction of growing row; NULL: (0, −1, 0)
} ck_SceneCloth;

typedef struct ck_SceneRope {
    uint32_t particles;
    double spacing, mass, end_mass; // m; kg of the whole rope; kg added to its last particle
    double length;                  // m, of the whole at rest; 0: as it starts
    double *origin, *along;         // [3]; NULL: (0, 0, 0) and (0, −1, 0)
} ck_SceneRope;

typedef struct ck_SceneMesh {
    char *file;           // beside the scene's
    double mass, density; // kg of the whole, or kg/m²: one of the two
    double weld, scale;   // m; m of one of the file's units, 0: 1
    char *up;             // x, y or z; NULL: y
    double *origin;       // [3] m, added to all; NULL: none
} ck_SceneMesh;

typedef struct ck_SceneNode {
    double at[3];     // m
    double mass;      // kg
    double *velocity; // [3] m/s; NULL: the scene's
} ck_SceneNode;

// A spring with values of its own.
typedef struct ck_SceneNetworkSpring {
    uint32_t ends[2];
    double stiffness, damping, rest; // N/m, N·s/m, m; rest 0: the distance at the start
    bool rigid;                      // a bar of fixed length
    bool pull_only;                  // it does not push
    char *kind;                      // structural, shear, bend; NULL: structural
} ck_SceneNetworkSpring;

// A hinge with values of its own.
typedef struct ck_SceneHinge {
    uint32_t *particles; // 3 or 4
    uint32_t particles_count;
    double *weights; // 1/m
    uint32_t weights_count;
    double stiffness, rest; // N·m, rad
} ck_SceneHinge;

typedef struct ck_SceneNetwork {
    ck_SceneNode *nodes;
    uint32_t nodes_count;
    uint32_t (*bars)[2];
    uint32_t bars_count;
    ck_SceneNetworkSpring *springs;
    uint32_t springs_count;
    uint32_t (*triangles)[3]; // faces, which are drawn
    uint32_t triangles_count;
    ck_SceneHinge *hinges;
    uint32_t hinges_count;
    double size, spacing; // m; 0: those of its nodes and springs
} ck_SceneNetwork;

typedef struct ck_SceneSprings {
    double stiffness, damping, shear, bend; // N/m, N·s/m, N/m, N/m
    double prestretch;                      // strain at the start: rest length = length/(1 + prestretch)
    bool rigid;                             // springs become bars of fixed length
    bool pull_only;                         // they do not push
} ck_SceneSprings;

// A fabric, in place of springs: the same at any resolution.
typedef struct ck_SceneMaterial {
    double membrane;    // N/m, Young's modulus times thickness
    double *poisson;    // 1; NULL: a third, at which all patterns are isotropic
    double bending;     // N·m
    double density;     // kg/m²; 0: the body's mass
    double retardation; // s: a spring's damping over its stiffness
} ck_SceneMaterial;

typedef struct ck_SceneWind {
    double *velocity;           // [3] m/s; NULL: still air
    double density, drag, lift; // kg/m³, 0: 1.225, air at sea level; coefficients, 1
} ck_SceneWind;

typedef struct ck_SceneBending {
    double stiffness; // N·m of a cloth or mesh, N·m² of a rope; 0: the material's
    char *rest;       // flat or start; NULL: flat
} ck_SceneBending;

typedef struct ck_SceneNoise {
    double amplitude; // m
    uint32_t seed;
} ck_SceneNoise;

typedef struct ck_ScenePlane {
    double point[3], normal[3];
    double restitution, friction;
} ck_ScenePlane;

typedef struct ck_SceneSphere {
    double center[3], radius;
    double restitution, friction;
} ck_SceneSphere;

typedef struct ck_SceneCapsule {
    double from[3], to[3], radius; // around the line between the two
    double restitution, friction;
} ck_SceneCapsule;

typedef struct ck_SceneCylinder {
    double point[3], axis[3], radius; // without ends
    double restitution, friction;
} ck_SceneCylinder;

typedef struct ck_SceneBox {
    double center[3], size[3];
    double *along, *up; // [3] directions of its first and second side; NULL: x and y
    double rounding;    // m, of its edges
    double restitution, friction;
} ck_SceneBox;

// How something moves from where it starts: in one of five ways.
typedef struct ck_ScenePath {
    double from, to;     // s, but of points and files: it stays before and after; to 0: to the end
    double *velocity;    // [3] m/s
    double *towards;     // [3] m, where it is at to, from wherever it is at from, at an even speed
    double *amplitude;   // [3] m, of a sine
    double frequency;    // 1/s, of that
    double (*points)[4]; // s, and m: joined by a smooth curve; only how it moves from the first counts
    uint32_t points_count;
    char *file; // CSV of such points, beside the scene's
} ck_ScenePath;

typedef struct ck_SceneCollider {
    ck_ScenePlane *plane;
    ck_SceneSphere *sphere;
    ck_SceneCapsule *capsule;
    ck_SceneCylinder *cylinder;
    ck_SceneBox *box;
    ck_ScenePath *path; // NULL: it stays
} ck_SceneCollider;

// A rigid body that moves freely: a sphere or a box.
typedef struct ck_SceneRigidBody {
    ck_SceneSphere *sphere;
    ck_SceneBox *box;
    double mass;             // kg
    double *velocity, *spin; // [3] m/s, rad/s; NULL: none
    char **hang;             // nodes that springs join to its centre
    uint32_t hang_count;
} ck_SceneRigidBody;

typedef struct ck_SceneMove {
    char **pins;
    uint32_t pins_count;
    ck_ScenePath path;
} ck_SceneMove;

typedef struct ck_SceneRelease {
    double at; // s
    char **pins;
    uint32_t pins_count;
} ck_SceneRelease;

// What the scene is from a time on.
typedef struct ck_SceneChange {
    double at; // s
    char *set; // @KEY=VALUE@KEY=VALUE, as after a scene's file
} ck_SceneChange;

// A value that was measured of the whole body, and its standard uncertainty.
typedef struct ck_SceneMeasure {
    double value, uncertainty;
} ck_SceneMeasure;

typedef struct ck_SceneMeasured {
    ck_SceneMeasure *sag;         // m
    ck_SceneMeasure *stretch_max; // 1
    ck_SceneMeasure *period;      // s
} ck_SceneMeasured;

typedef struct ck_SceneTime {
    double duration, step; // s
    double fps;            // frames a second, in place of step; 0: step is given
    double jitter;         // a frame comes in two steps of (1 ± jitter)/2 of it at most; 0: in one
    uint32_t seed;         // of that
} ck_SceneTime;

// The part of a scene that the file's schema fills.
typedef struct ck_SceneFile {
    char *name, *about;
    double resolution; // segments a row over what the body says, the material and size its; 0: 1
    ck_SceneCloth *cloth;
    ck_SceneRope *rope;
    ck_SceneNetwork *network;
    ck_SceneMesh *mesh;
    ck_SceneSprings *springs;
    ck_SceneBending *bending;
    ck_SceneMaterial *material;
    ck_SceneWind *wind;
    char **pins;
    uint32_t pins_count;
    ck_SceneNoise *noise;
    char *start;                        // equilibrium: where it comes to rest; NULL: as it is given
    double *gravity, *force, *velocity; // [3] m/s², N on each particle, m/s; NULL: none
    double drag;                        // 1/s
    ck_SceneCollider *colliders;
    uint32_t colliders_count;
    ck_SceneRigidBody *bodies;
    uint32_t bodies_count;
    ck_SceneMove *moves;
    uint32_t moves_count;
    ck_SceneRelease *release;
    uint32_t release_count;
    ck_SceneChange *changes;
    uint32_t changes_count;
    ck_SceneTime time;
    char *truth;
    char **measure;
    uint32_t measure_count;
    ck_SceneMeasured *measured; // NULL: nothing
} ck_SceneFile;

// A setting of an engine, as it is written: which engines there are, and what they have, is not known here.
typedef struct ck_SceneSetting {
    const char *engine, *key; // of the document
    double value;
    const yaml_node_t *engine_at, *key_at, *value_at;
} ck_SceneSetting;

typedef struct ck_Scene {
    ck_SceneFile *file;
    ck_Document document;
    ck_SceneSetting *settings; // [setting_count]
    int setting_count;
} ck_Scene;

// Loads and checks a scene file, with the changes that its path has (change.h), which its name then tells: keys, types
// and the range of every single value. What several values must agree on (pins and the body, bars and nodes) is checked
// by ck_model_build. Errors: CK_BAD_INPUT with file:line:column, what is wrong and what would be right; CK_NO_MEMORY;
// CK_IO.
ck_Status ck_scene_load(ck_Scene *scene, const char *path, ck_Error *error);

// Accepts a zeroed scene.
void ck_scene_free(ck_Scene *scene);

// Fails at the place of a dotted path in the scene file, such as "network.bars[3]".
ck_Status ck_scene_fail(const ck_Scene *scene, const char *path, ck_Error *error, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
