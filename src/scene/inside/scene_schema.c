#include "scene_schema.h"

#include "scene.h"

#define OPTIONAL CYAML_FLAG_OPTIONAL
#define REQUIRED CYAML_FLAG_DEFAULT

const ck_RangeRule ck_scene_ranges[] = {
    {"resolution", CK_RANGE_POSITIVE},
    {"cloth.rows", CK_RANGE_POSITIVE},
    {"cloth.columns", CK_RANGE_POSITIVE},
    {"cloth.spacing", CK_RANGE_POSITIVE},
    {"cloth.mass", CK_RANGE_POSITIVE},
    {"rope.particles", CK_RANGE_POSITIVE},
    {"rope.spacing", CK_RANGE_POSITIVE},
    {"rope.mass", CK_RANGE_POSITIVE},
    {"rope.end_mass", CK_RANGE_NOT_NEGATIVE},
    {"rope.length", CK_RANGE_POSITIVE},
    {"network.nodes[].mass", CK_RANGE_POSITIVE},
    {"network.springs[].stiffness", CK_RANGE_NOT_NEGATIVE},
    {"network.springs[].damping", CK_RANGE_NOT_NEGATIVE},
    {"network.springs[].rest", CK_RANGE_POSITIVE},
    {"network.size", CK_RANGE_POSITIVE},
    {"network.spacing", CK_RANGE_POSITIVE},
    {"mesh.mass", CK_RANGE_POSITIVE},
    {"mesh.density", CK_RANGE_POSITIVE},
    {"mesh.weld", CK_RANGE_NOT_NEGATIVE},
    {"mesh.scale", CK_RANGE_POSITIVE},
    {"springs.stiffness", CK_RANGE_NOT_NEGATIVE},
    {"springs.damping", CK_RANGE_NOT_NEGATIVE},
    {"springs.shear", CK_RANGE_NOT_NEGATIVE},
    {"springs.bend", CK_RANGE_NOT_NEGATIVE},
    {"springs.prestretch", CK_RANGE_NOT_NEGATIVE},
    {"bending.stiffness", CK_RANGE_NOT_NEGATIVE},
    {"network.hinges[].stiffness", CK_RANGE_POSITIVE},
    {"network.hinges[].rest", CK_RANGE_NOT_NEGATIVE},
    {"material.membrane", CK_RANGE_POSITIVE},
    {"material.poisson", CK_RANGE_UNIT},
    {"material.bending", CK_RANGE_NOT_NEGATIVE},
    {"material.density", CK_RANGE_POSITIVE},
    {"material.retardation", CK_RANGE_NOT_NEGATIVE},
    {"wind.density", CK_RANGE_POSITIVE},
    {"wind.drag", CK_RANGE_NOT_NEGATIVE},
    {"wind.lift", CK_RANGE_NOT_NEGATIVE},
    {"noise.amplitude", CK_RANGE_NOT_NEGATIVE},
    {"drag", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].plane.restitution", CK_RANGE_UNIT},
    {"colliders[].plane.friction", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].sphere.radius", CK_RANGE_POSITIVE},
    {"colliders[].sphere.restitution", CK_RANGE_UNIT},
    {"colliders[].sphere.friction", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].capsule.radius", CK_RANGE_POSITIVE},
    {"colliders[].capsule.restitution", CK_RANGE_UNIT},
    {"colliders[].capsule.friction", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].cylinder.radius", CK_RANGE_POSITIVE},
    {"colliders[].cylinder.restitution", CK_RANGE_UNIT},
    {"colliders[].cylinder.friction", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].box.size", CK_RANGE_POSITIVE},
    {"colliders[].box.rounding", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].box.restitution", CK_RANGE_UNIT},
    {"colliders[].box.friction", CK_RANGE_NOT_NEGATIVE},
    {"bodies[].mass", CK_RANGE_POSITIVE},
    {"bodies[].sphere.radius", CK_RANGE_POSITIVE},
    {"bodies[].sphere.restitution", CK_RANGE_UNIT},
    {"bodies[].sphere.friction", CK_RANGE_NOT_NEGATIVE},
    {"bodies[].box.size", CK_RANGE_POSITIVE},
    {"bodies[].box.rounding", CK_RANGE_NOT_NEGATIVE},
    {"bodies[].box.restitution", CK_RANGE_UNIT},
    {"bodies[].box.friction", CK_RANGE_NOT_NEGATIVE},
    {"moves[].path.from", CK_RANGE_NOT_NEGATIVE},
    {"moves[].path.to", CK_RANGE_POSITIVE},
    {"moves[].path.frequency", CK_RANGE_POSITIVE},
    {"colliders[].path.from", CK_RANGE_NOT_NEGATIVE},
    {"colliders[].path.to", CK_RANGE_POSITIVE},
    {"colliders[].path.frequency", CK_RANGE_POSITIVE},
    {"release[].at", CK_RANGE_NOT_NEGATIVE},
    {"changes[].at", CK_RANGE_NOT_NEGATIVE},
    {"time.duration", CK_RANGE_POSITIVE},
    {"time.step", CK_RANGE_POSITIVE},
    {"time.fps", CK_RANGE_POSITIVE},
    {"time.jitter", CK_RANGE_NOT_NEGATIVE},
    {"measured.sag.uncertainty", CK_RANGE_POSITIVE},
    {"measured.stretch_max.uncertainty", CK_RANGE_POSITIVE},
    {"measured.period.uncertainty", CK_RANGE_POSITIVE},
    {NULL, CK_RANGE_FINITE},
};

static const cyaml_schema_value_t number = {CYAML_VALUE_FLOAT(CYAML_FLAG_DEFAULT, double)};
static const cyaml_schema_value_t index_entry = {CYAML_VALUE_UINT(CYAML_FLAG_DEFAULT, uint32_t)};
static const cyaml_schema_value_t index_pair = {
    CYAML_VALUE_SEQUENCE_FIXED(CYAML_FLAG_DEFAULT, uint32_t, &index_entry, 2)};
static const cyaml_schema_value_t index_triple = {
    CYAML_VALUE_SEQUENCE_FIXED(CYAML_FLAG_DEFAULT, uint32_t, &index_entry, 3)};
static const cyaml_schema_value_t text = {CYAML_VALUE_STRING(CYAML_FLAG_POINTER, char *, 0, CYAML_UNLIMITED)};

static const cyaml_schema_field_t cloth_fields[] = {
    CYAML_FIELD_UINT("rows", REQUIRED, ck_SceneCloth, rows),
    CYAML_FIELD_UINT("columns", REQUIRED, ck_SceneCloth, columns),
    CYAML_FIELD_FLOAT("spacing", REQUIRED, ck_SceneCloth, spacing),
    CYAML_FIELD_FLOAT("mass", OPTIONAL, ck_SceneCloth, mass),
    CYAML_FIELD_STRING_PTR("pattern", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneCloth, pattern, 1, 20),
    CYAML_FIELD_SEQUENCE_FIXED("origin", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneCloth, origin, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("across", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneCloth, across, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("down", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneCloth, down, &number, 3),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t rope_fields[] = {
    CYAML_FIELD_UINT("particles", REQUIRED, ck_SceneRope, particles),
    CYAML_FIELD_FLOAT("spacing", REQUIRED, ck_SceneRope, spacing),
    CYAML_FIELD_FLOAT("mass", REQUIRED, ck_SceneRope, mass),
    CYAML_FIELD_FLOAT("end_mass", OPTIONAL, ck_SceneRope, end_mass),
    CYAML_FIELD_FLOAT("length", OPTIONAL, ck_SceneRope, length),
    CYAML_FIELD_SEQUENCE_FIXED("origin", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneRope, origin, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("along", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneRope, along, &number, 3),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t mesh_fields[] = {
    CYAML_FIELD_STRING_PTR("file", REQUIRED | CYAML_FLAG_POINTER, ck_SceneMesh, file, 1, 1000),
    CYAML_FIELD_FLOAT("mass", OPTIONAL, ck_SceneMesh, mass),
    CYAML_FIELD_FLOAT("density", OPTIONAL, ck_SceneMesh, density),
    CYAML_FIELD_FLOAT("weld", OPTIONAL, ck_SceneMesh, weld),
    CYAML_FIELD_FLOAT("scale", OPTIONAL, ck_SceneMesh, scale),
    CYAML_FIELD_STRING_PTR("up", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneMesh, up, 1, 20),
    CYAML_FIELD_SEQUENCE_FIXED("origin", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneMesh, origin, &number, 3),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t node_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("at", REQUIRED, ck_SceneNode, at, &number, 3),
    CYAML_FIELD_FLOAT("mass", REQUIRED, ck_SceneNode, mass),
    CYAML_FIELD_SEQUENCE_FIXED("velocity", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNode, velocity, &number, 3),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t node = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneNode, node_fields)};

static const cyaml_schema_field_t network_spring_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("ends", REQUIRED, ck_SceneNetworkSpring, ends, &index_entry, 2),
    CYAML_FIELD_FLOAT("stiffness", OPTIONAL, ck_SceneNetworkSpring, stiffness),
    CYAML_FIELD_FLOAT("damping", OPTIONAL, ck_SceneNetworkSpring, damping),
    CYAML_FIELD_FLOAT("rest", OPTIONAL, ck_SceneNetworkSpring, rest),
    CYAML_FIELD_BOOL("rigid", OPTIONAL, ck_SceneNetworkSpring, rigid),
    CYAML_FIELD_BOOL("pull_only", OPTIONAL, ck_SceneNetworkSpring, pull_only),
    CYAML_FIELD_STRING_PTR("kind", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNetworkSpring, kind, 1, 20),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t network_spring = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneNetworkSpring, network_spring_fields)};

static const cyaml_schema_field_t hinge_fields[] = {
    CYAML_FIELD_SEQUENCE("nodes", REQUIRED | CYAML_FLAG_POINTER, ck_SceneHinge, particles, &index_entry, 3, 4),
    CYAML_FIELD_SEQUENCE("weights", REQUIRED | CYAML_FLAG_POINTER, ck_SceneHinge, weights, &number, 3, 4),
    CYAML_FIELD_FLOAT("stiffness", REQUIRED, ck_SceneHinge, stiffness),
    CYAML_FIELD_FLOAT("rest", OPTIONAL, ck_SceneHinge, rest),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t hinge = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneHinge, hinge_fields)};

static const cyaml_schema_field_t network_fields[] = {
    CYAML_FIELD_SEQUENCE("nodes", REQUIRED | CYAML_FLAG_POINTER, ck_SceneNetwork, nodes, &node, 1,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_SEQUENCE("bars", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNetwork, bars, &index_pair, 0,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_SEQUENCE("springs", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNetwork, springs, &network_spring, 0,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_SEQUENCE("triangles", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNetwork, triangles, &index_triple, 0,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_SEQUENCE("hinges", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneNetwork, hinges, &hinge, 0,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_FLOAT("size", OPTIONAL, ck_SceneNetwork, size),
    CYAML_FIELD_FLOAT("spacing", OPTIONAL, ck_SceneNetwork, spacing),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t springs_fields[] = {
    CYAML_FIELD_FLOAT("stiffness", OPTIONAL, ck_SceneSprings, stiffness),
    CYAML_FIELD_FLOAT("damping", OPTIONAL, ck_SceneSprings, damping),
    CYAML_FIELD_FLOAT("shear", OPTIONAL, ck_SceneSprings, shear),
    CYAML_FIELD_FLOAT("bend", OPTIONAL, ck_SceneSprings, bend),
    CYAML_FIELD_FLOAT("prestretch", OPTIONAL, ck_SceneSprings, prestretch),
    CYAML_FIELD_BOOL("rigid", OPTIONAL, ck_SceneSprings, rigid),
    CYAML_FIELD_BOOL("pull_only", OPTIONAL, ck_SceneSprings, pull_only),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t bending_fields[] = {
    CYAML_FIELD_FLOAT("stiffness", OPTIONAL, ck_SceneBending, stiffness),
    CYAML_FIELD_STRING_PTR("rest", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneBending, rest, 1, 20),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t material_fields[] = {
    CYAML_FIELD_FLOAT("membrane", REQUIRED, ck_SceneMaterial, membrane),
    CYAML_FIELD_FLOAT_PTR("poisson", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneMaterial, poisson),
    CYAML_FIELD_FLOAT("bending", OPTIONAL, ck_SceneMaterial, bending),
    CYAML_FIELD_FLOAT("density", OPTIONAL, ck_SceneMaterial, density),
    CYAML_FIELD_FLOAT("retardation", OPTIONAL, ck_SceneMaterial, retardation),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t wind_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("velocity", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneWind, velocity, &number, 3),
    CYAML_FIELD_FLOAT("density", OPTIONAL, ck_SceneWind, density),
    CYAML_FIELD_FLOAT("drag", REQUIRED, ck_SceneWind, drag),
    CYAML_FIELD_FLOAT("lift", OPTIONAL, ck_SceneWind, lift),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t noise_fields[] = {
    CYAML_FIELD_FLOAT("amplitude", REQUIRED, ck_SceneNoise, amplitude),
    CYAML_FIELD_UINT("seed", REQUIRED, ck_SceneNoise, seed),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t plane_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("point", REQUIRED, ck_ScenePlane, point, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("normal", REQUIRED, ck_ScenePlane, normal, &number, 3),
    CYAML_FIELD_FLOAT("restitution", OPTIONAL, ck_ScenePlane, restitution),
    CYAML_FIELD_FLOAT("friction", OPTIONAL, ck_ScenePlane, friction),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t sphere_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("center", REQUIRED, ck_SceneSphere, center, &number, 3),
    CYAML_FIELD_FLOAT("radius", REQUIRED, ck_SceneSphere, radius),
    CYAML_FIELD_FLOAT("restitution", OPTIONAL, ck_SceneSphere, restitution),
    CYAML_FIELD_FLOAT("friction", OPTIONAL, ck_SceneSphere, friction),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t capsule_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("from", REQUIRED, ck_SceneCapsule, from, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("to", REQUIRED, ck_SceneCapsule, to, &number, 3),
    CYAML_FIELD_FLOAT("radius", REQUIRED, ck_SceneCapsule, radius),
    CYAML_FIELD_FLOAT("restitution", OPTIONAL, ck_SceneCapsule, restitution),
    CYAML_FIELD_FLOAT("friction", OPTIONAL, ck_SceneCapsule, friction),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t cylinder_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("point", REQUIRED, ck_SceneCylinder, point, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("axis", REQUIRED, ck_SceneCylinder, axis, &number, 3),
    CYAML_FIELD_FLOAT("radius", REQUIRED, ck_SceneCylinder, radius),
    CYAML_FIELD_FLOAT("restitution", OPTIONAL, ck_SceneCylinder, restitution),
    CYAML_FIELD_FLOAT("friction", OPTIONAL, ck_SceneCylinder, friction),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t box_fields[] = {
    CYAML_FIELD_SEQUENCE_FIXED("center", REQUIRED, ck_SceneBox, center, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("size", REQUIRED, ck_SceneBox, size, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("along", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneBox, along, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("up", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneBox, up, &number, 3),
    CYAML_FIELD_FLOAT("rounding", OPTIONAL, ck_SceneBox, rounding),
    CYAML_FIELD_FLOAT("restitution", OPTIONAL, ck_SceneBox, restitution),
    CYAML_FIELD_FLOAT("friction", OPTIONAL, ck_SceneBox, friction),
    CYAML_FIELD_END,
};

static const cyaml_schema_value_t path_point = {CYAML_VALUE_SEQUENCE_FIXED(CYAML_FLAG_DEFAULT, double, &number, 4)};
static const cyaml_schema_field_t path_fields[] = {
    CYAML_FIELD_FLOAT("from", OPTIONAL, ck_ScenePath, from),
    CYAML_FIELD_FLOAT("to", OPTIONAL, ck_ScenePath, to),
    CYAML_FIELD_SEQUENCE_FIXED("velocity", OPTIONAL | CYAML_FLAG_POINTER, ck_ScenePath, velocity, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("towards", OPTIONAL | CYAML_FLAG_POINTER, ck_ScenePath, towards, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("amplitude", OPTIONAL | CYAML_FLAG_POINTER, ck_ScenePath, amplitude, &number, 3),
    CYAML_FIELD_FLOAT("frequency", OPTIONAL, ck_ScenePath, frequency),
    CYAML_FIELD_SEQUENCE("points", OPTIONAL | CYAML_FLAG_POINTER, ck_ScenePath, points, &path_point, 2,
                         CK_SCENE_MAX_PARTICLES),
    CYAML_FIELD_STRING_PTR("file", OPTIONAL | CYAML_FLAG_POINTER, ck_ScenePath, file, 1, 1000),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t collider_fields[] = {
    CYAML_FIELD_MAPPING_PTR("plane", OPTIONAL, ck_SceneCollider, plane, plane_fields),
    CYAML_FIELD_MAPPING_PTR("sphere", OPTIONAL, ck_SceneCollider, sphere, sphere_fields),
    CYAML_FIELD_MAPPING_PTR("capsule", OPTIONAL, ck_SceneCollider, capsule, capsule_fields),
    CYAML_FIELD_MAPPING_PTR("cylinder", OPTIONAL, ck_SceneCollider, cylinder, cylinder_fields),
    CYAML_FIELD_MAPPING_PTR("box", OPTIONAL, ck_SceneCollider, box, box_fields),
    CYAML_FIELD_MAPPING_PTR("path", OPTIONAL, ck_SceneCollider, path, path_fields),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t collider = {
    CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneCollider, collider_fields)};

static const cyaml_schema_field_t body_fields[] = {
    CYAML_FIELD_MAPPING_PTR("sphere", OPTIONAL, ck_SceneRigidBody, sphere, sphere_fields),
    CYAML_FIELD_MAPPING_PTR("box", OPTIONAL, ck_SceneRigidBody, box, box_fields),
    CYAML_FIELD_FLOAT("mass", REQUIRED, ck_SceneRigidBody, mass),
    CYAML_FIELD_SEQUENCE_FIXED("velocity", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneRigidBody, velocity, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("spin", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneRigidBody, spin, &number, 3),
    CYAML_FIELD_SEQUENCE("hang", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneRigidBody, hang, &text, 1, CYAML_UNLIMITED),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t body = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneRigidBody, body_fields)};

static const cyaml_schema_field_t release_fields[] = {
    CYAML_FIELD_FLOAT("at", REQUIRED, ck_SceneRelease, at),
    CYAML_FIELD_SEQUENCE("pins", REQUIRED | CYAML_FLAG_POINTER, ck_SceneRelease, pins, &text, 1, CYAML_UNLIMITED),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t release = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneRelease, release_fields)};

static const cyaml_schema_field_t change_fields[] = {
    CYAML_FIELD_FLOAT("at", REQUIRED, ck_SceneChange, at),
    CYAML_FIELD_STRING_PTR("set", REQUIRED | CYAML_FLAG_POINTER, ck_SceneChange, set, 1, CYAML_UNLIMITED),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t change = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneChange, change_fields)};

static const cyaml_schema_field_t move_fields[] = {
    CYAML_FIELD_SEQUENCE("pins", REQUIRED | CYAML_FLAG_POINTER, ck_SceneMove, pins, &text, 1, CYAML_UNLIMITED),
    CYAML_FIELD_MAPPING("path", REQUIRED, ck_SceneMove, path, path_fields),
    CYAML_FIELD_END,
};
static const cyaml_schema_value_t move = {CYAML_VALUE_MAPPING(CYAML_FLAG_DEFAULT, ck_SceneMove, move_fields)};

static const cyaml_schema_field_t time_fields[] = {
    CYAML_FIELD_FLOAT("duration", REQUIRED, ck_SceneTime, duration),
    CYAML_FIELD_FLOAT("step", OPTIONAL, ck_SceneTime, step),
    CYAML_FIELD_FLOAT("fps", OPTIONAL, ck_SceneTime, fps),
    CYAML_FIELD_FLOAT("jitter", OPTIONAL, ck_SceneTime, jitter),
    CYAML_FIELD_UINT("seed", OPTIONAL, ck_SceneTime, seed),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t measure_fields[] = {
    CYAML_FIELD_FLOAT("value", REQUIRED, ck_SceneMeasure, value),
    CYAML_FIELD_FLOAT("uncertainty", REQUIRED, ck_SceneMeasure, uncertainty),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t measured_fields[] = {
    CYAML_FIELD_MAPPING_PTR("sag", OPTIONAL, ck_SceneMeasured, sag, measure_fields),
    CYAML_FIELD_MAPPING_PTR("stretch_max", OPTIONAL, ck_SceneMeasured, stretch_max, measure_fields),
    CYAML_FIELD_MAPPING_PTR("period", OPTIONAL, ck_SceneMeasured, period, measure_fields),
    CYAML_FIELD_END,
};

static const cyaml_schema_field_t scene_fields[] = {
    CYAML_FIELD_STRING_PTR("name", REQUIRED | CYAML_FLAG_POINTER, ck_SceneFile, name, 1, 100),
    CYAML_FIELD_STRING_PTR("about", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, about, 0, CYAML_UNLIMITED),
    CYAML_FIELD_MAPPING_PTR("cloth", OPTIONAL, ck_SceneFile, cloth, cloth_fields),
    CYAML_FIELD_MAPPING_PTR("rope", OPTIONAL, ck_SceneFile, rope, rope_fields),
    CYAML_FIELD_MAPPING_PTR("network", OPTIONAL, ck_SceneFile, network, network_fields),
    CYAML_FIELD_MAPPING_PTR("mesh", OPTIONAL, ck_SceneFile, mesh, mesh_fields),
    CYAML_FIELD_FLOAT("resolution", OPTIONAL, ck_SceneFile, resolution),
    CYAML_FIELD_MAPPING_PTR("springs", OPTIONAL, ck_SceneFile, springs, springs_fields),
    CYAML_FIELD_MAPPING_PTR("material", OPTIONAL, ck_SceneFile, material, material_fields),
    CYAML_FIELD_MAPPING_PTR("wind", OPTIONAL, ck_SceneFile, wind, wind_fields),
    CYAML_FIELD_MAPPING_PTR("bending", OPTIONAL, ck_SceneFile, bending, bending_fields),
    CYAML_FIELD_SEQUENCE("pins", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, pins, &text, 0, CYAML_UNLIMITED),
    CYAML_FIELD_STRING_PTR("start", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, start, 1, 20),
    CYAML_FIELD_MAPPING_PTR("noise", OPTIONAL, ck_SceneFile, noise, noise_fields),
    CYAML_FIELD_SEQUENCE_FIXED("gravity", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, gravity, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("force", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, force, &number, 3),
    CYAML_FIELD_SEQUENCE_FIXED("velocity", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, velocity, &number, 3),
    CYAML_FIELD_FLOAT("drag", OPTIONAL, ck_SceneFile, drag),
    CYAML_FIELD_SEQUENCE("colliders", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, colliders, &collider, 0, 1000),
    CYAML_FIELD_SEQUENCE("bodies", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, bodies, &body, 0, 100),
    CYAML_FIELD_SEQUENCE("moves", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, moves, &move, 0, 1000),
    CYAML_FIELD_SEQUENCE("release", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, release, &release, 0, 1000),
    CYAML_FIELD_SEQUENCE("changes", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, changes, &change, 0, 100000),
    CYAML_FIELD_MAPPING("time", REQUIRED, ck_SceneFile, time, time_fields),
    CYAML_FIELD_STRING_PTR("truth", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, truth, 1, 100),
    CYAML_FIELD_SEQUENCE("measure", OPTIONAL | CYAML_FLAG_POINTER, ck_SceneFile, measure, &text, 0, 100),
    CYAML_FIELD_MAPPING_PTR("measured", OPTIONAL, ck_SceneFile, measured, measured_fields),
    CYAML_FIELD_IGNORE("settings", OPTIONAL),
    CYAML_FIELD_END,
};
const cyaml_schema_value_t ck_scene_schema = {CYAML_VALUE_MAPPING(CYAML_FLAG_POINTER, ck_SceneFile, scene_fields)};
