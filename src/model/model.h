// A scene compiled into engine-neutral SI arrays. Immutable once built.
#ifndef CK_MODEL_H
#define CK_MODEL_H

#include "status.h"

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

struct ck_Scene;
struct ck_Segment;

// What a scene models; an engine names the terms it supports. Absent terms cost nothing.
typedef enum ck_Term {
    CK_TERM_SPRINGS = 1 << 0,
    CK_TERM_RIGID = 1 << 1,   // springs are bars of fixed length
    CK_TERM_DAMPING = 1 << 2, // along springs
    CK_TERM_GRAVITY = 1 << 3,
    CK_TERM_FORCE = 1 << 4, // the same on each particle
    CK_TERM_DRAG = 1 << 5,
    CK_TERM_VELOCITY = 1 << 6, // at the start
    CK_TERM_PLANE = 1 << 7,
    CK_TERM_SPHERE = 1 << 8,
    CK_TERM_RELEASE = 1 << 9,  // pins let go while it runs
    CK_TERM_BENDING = 1 << 10, // hinges
    CK_TERM_WIND = 1 << 11,
    CK_TERM_PULL_ONLY = 1 << 12, // springs that hang slack where they are shorter than at rest
    CK_TERM_MOVES = 1 << 13,     // pins that are moved
    CK_TERM_MOVING_COLLIDERS = 1 << 14,
    CK_TERM_SOLIDS = 1 << 15,  // capsules, cylinders or boxes
    CK_TERM_BODIES = 1 << 16,  // rigid ones that move freely
    CK_TERM_JITTER = 1 << 17,  // frames that come in uneven steps
    CK_TERM_CHANGES = 1 << 18, // another scene from some frame on, which no engine sees
    CK_TERM_COUNT = 19,
    CK_TERM_COLLIDERS = CK_TERM_PLANE | CK_TERM_SPHERE | CK_TERM_SOLIDS,
} ck_Term;

// The name of the term in bit order, as a scene's author knows it.
extern const char *const ck_term_names[CK_TERM_COUNT];

typedef enum ck_SpringKind { CK_STRUCTURAL, CK_SHEAR, CK_BEND, CK_SPRING_KINDS } ck_SpringKind;
extern const char *const ck_stiffness_names[CK_SPRING_KINDS]; // "structural stiffness" …

typedef struct ck_Spring {
    int a, b;         // particles
    double rest;      // m
    double stiffness; // N/m; INFINITY for a rigid bar
    double damping;   // N·s/m along the spring
    ck_SpringKind kind;
    bool pulls_only; // it does not push, and damps only while it pulls
} ck_Spring;

// What resists being bent: see hinges.h.
typedef struct ck_Hinge {
    int particles[4];  // −1: none
    double weights[4]; // 1/m, of a vector as long as 2·sin(angle/2)
    double stiffness;  // N·m
    double rest;       // rad
} ck_Hinge;

// Air: see wind.h.
typedef struct ck_Wind {
    double velocity[3], density; // m/s, kg/m³: half of the air's where every square has faces both ways
    double drag, lift;           // coefficients, 1
    int (*faces)[3];             // [face_count] particles
    int face_count;              // 0: no air
} ck_Wind;

typedef enum ck_PathKind { CK_PATH_VELOCITY, CK_PATH_SINE, CK_PATH_POINTS } ck_PathKind;

// How something moves from where it starts: see path.h.
typedef struct ck_Path {
    ck_PathKind kind;
    double from, to;     // s: it stays before and after; INFINITY: to the end
    double vector[3];    // m/s, or m of a sine
    double frequency;    // 1/s
    double (*points)[4]; // [point_count] s and m
    int point_count;
    double slack;   // s: what a time may be off, by rounding
    double goal[3]; // m, of a pin's own path: where it is at its end
    bool has_goal;
} ck_Path;

// A pin that is moved.
typedef struct ck_Driven {
    int particle;
    double start[3];     // m
    const ck_Path *path; // of the model's
    double until;        // s: when it is let go; INFINITY: never
} ck_Driven;

typedef enum ck_ColliderShape { CK_PLANE, CK_SPHERE, CK_CAPSULE, CK_CYLINDER, CK_BOX, CK_SHAPE_COUNT } ck_ColliderShape;

extern const char *const ck_shape_names[CK_SHAPE_COUNT];

// A half-space, or what is no farther than a radius from a core: a point, a line or a box.
typedef struct ck_Collider {
    ck_ColliderShape shape;
    double point[3];   // m: a point of the plane, or the middle of the core
    double normal[3];  // unit, plane only
    double radius;     // m: of a box that of its edges, 0 where they are sharp
    double axes[3][3]; // unit, square to one another, that of a capsule or a cylinder first; of a sphere any
    double half[3];    // m, of the core along them: 0 where it is a point or a line, INFINITY along a cylinder
    double restitution, friction;
    const ck_Path *path; // of the model's; NULL: it stays
} ck_Collider;

// A body of a fixed shape that moves freely: see rigid.h.
typedef struct ck_RigidBody {
    int particle;      // its centre: the last ones of a model, in order
    ck_Collider shape; // a sphere or a box, where it starts
    double spin[3];    // rad/s at the start
    double inertia[3]; // kg·m², about its axes
    int *hung;         // particles that springs join to its centre: they do not touch it
    int hung_count;
} ck_RigidBody;

typedef struct ck_Release {
    double at; // s
    int frame; // the first at or after that time: pins are let go between frames
    int *particles;
    int particle_count;
} ck_Release;

typedef enum ck_Body { CK_CLOTH, CK_ROPE, CK_NETWORK, CK_MESH } ck_Body;

// Particles that a mesh's file names together.
typedef struct ck_Group {
    char *name;
    int *particles, particle_count;
} ck_Group;

typedef struct ck_Model {
    char *name;
    char *about; // a sentence; may be NULL
    ck_Body body;
    int particle_count;  // those of the cloth, and then a centre of each rigid body
    int columns;         // of a cloth: particle = row*columns + column; else 0
    double *position;    // [3*n] m at the start
    double *velocity;    // [3*n] m/s at the start, 0 where pinned
    double *mass;        // [n] kg
    bool *pinned;        // [n] at the start
    bool *released;      // [n] at some time
    bool starts_settled; // the scene starts where the body comes to rest: see truth/start.h
    int pin_count;
    ck_Spring *springs;
    int spring_count;
    ck_Hinge *hinges;
    int hinge_count;
    double membrane, poisson; // N/m and 1, of a scene's material; 0: it has none
    double bending;      // N·m of a sheet, N·m² of a rope, as the scene gives it; 0: none, or hinges of their own
    int (*triangles)[3]; // [triangle_count] particles of a mesh's faces, else none
    int triangle_count;
    ck_Wind wind;
    ck_Group *groups; // of a mesh
    int group_count;
    double gravity[3], force[3]; // m/s², N on each particle
    double drag;                 // 1/s
    ck_Collider *colliders;
    int collider_count;
    ck_RigidBody *rigid;
    int rigid_count;
    ck_Release *releases;
    int release_count;
    ck_Path *paths;
    int path_count;
    ck_Driven *driven;
    int driven_count;
    unsigned terms;        // ck_Term bits in use
    double size;           // m: rope's rest length, cloth's longer rest side, else the bounding box's diagonal
    double spacing;        // m: between neighbours; of a network or mesh its shortest spring
    double duration, step; // s
    int frame_count;       // frames after the start
    double jitter;         // of the steps that frames come in; 0: a frame is one
    uint32_t jitter_seed;
    struct ck_Segment *segments; // what the scene is from later frames on: see segment.h
    int segment_count;
    char *truth;       // as the scene names it; NULL: none
    char **measure;    // names of the metrics the scene asks for
    int measure_count; // 0: every metric
} ck_Model;

// Compiles a scene.
// Errors: CK_BAD_INPUT at the scene's file:line:column, CK_NO_MEMORY. Free with ck_model_free in any case.
ck_Status ck_model_build(ck_Model *model, const struct ck_Scene *scene, ck_Error *error);

// As ck_model_build, of a scene whose particles are elsewhere by then: whether they start inside of anything is not
// asked, and its changes are left alone.
ck_Status ck_model_build_part(ck_Model *model, const struct ck_Scene *scene, ck_Error *error);

// Accepts a zeroed model.
void ck_model_free(ck_Model *model);

// The two steps that a frame comes in where there is jitter, s: half of it each, one up to that share more, and the
// other less; by the seed. The first frame is 0.
void ck_model_parts(const ck_Model *model, int frame, double *parts);

// How many particles are the cloth's.
int ck_model_cloth_count(const ck_Model *model);

// A hash of all numbers that a model's motion depends on, whatever files they came from.
uint64_t ck_model_hash(const ck_Model *model);

// Gives a copy of a model springs of its own, [spring_count], of factor times the stiffness.
void ck_model_scale_stiffness(ck_Model *copy, ck_Spring *springs, double factor);

// True for a particle that is pinned from start to end.
bool ck_model_is_held(const ck_Model *model, int particle);

// When a pin is let go, between which frames that is, s; INFINITY: never.
double ck_model_release_time(const ck_Model *model, int particle);

// Errors: CK_BAD_INPUT at a collider's place where a particle is inside of it once it is free: at the start, or when
// its pin is let go. A pin that stays may be there.
ck_Status ck_model_check_outside(const ck_Model *model, const struct ck_Scene *scene, ck_Error *error);

// 1/mass, or 0 where pinned, in 1/kg.
double ck_model_inverse_mass(const ck_Model *model, int particle);

// The sum of all masses that are not pinned, in kg.
double ck_model_free_mass(const ck_Model *model);

// The first spring of a kind between particles that are not pinned, else any of it, or NULL where there is none. All of
// a kind have the same stiffness and damping, but in a network whose springs have values of their own, and of a
// material: there it stands for the others.
const ck_Spring *ck_model_spring_of_kind(const ck_Model *model, ck_SpringKind kind);

// The mass-weighted mean of ck_model_field over particles that are not pinned, in m/s²: the direction of fall.
void ck_model_mean_field(const ck_Model *model, double *acceleration);

// What is left of the acceleration when springs, drag and contact are left out: gravity + force/mass, in m/s².
void ck_model_field(const ck_Model *model, int particle, double *acceleration);

#ifdef __cplusplus
}
#endif

#endif
