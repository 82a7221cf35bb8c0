// Scene files: every bad one gets one clear error with its place, and the shipped ones load.
#include "fixture_comparison.h"

#include "files.h"
#include "scene_schema.h"
#include "segment.h"
#include "vector.h"

#include "scene.h"

#include <glob.h>
#include <unistd.h>

#define TIME "time: {duration: 1, step: 0.1}\n"
#define ROPE "name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 10}\n"
#define NETWORK(bars)                                                                                                  \
    "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}]\n  "   \
    "bars: " bars "\nsprings: {stiffness: 10}\n" TIME

#define OWN(springs)                                                                                                   \
    "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [2, 0, 0], mass: 1}]\n"     \
    "  springs: [" springs "]\n" TIME

static const struct {
    const char *about, *text;
    const char *place, *message; // what the error must contain
} bad_scenes[] = {
    {"unknown key", ROPE TIME "stifness: 3\n", ":5:1:", "unknown key stifness; known here: name, about, cloth"},
    {"unknown inner key", "name: r\nrope: {particles: 3, spaceing: 0.1, mass: 1}\n" TIME,
     ":2:22:", "unknown key spaceing in rope; did you mean spacing?; known here: particles"},
    {"missing body", "name: r\n" TIME, ":1:1:", "needs one body"},
    {"two bodies", ROPE "cloth: {rows: 2, columns: 2, spacing: 1, mass: 1}\n" TIME, ":4:1:", "both rope and cloth"},
    {"bars that only pull",
     "name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {rigid: true, pull_only: true}\n" TIME,
     ":3:35:", "rigid bars push, too"},
    {"bending of a bare network", NETWORK("[[0, 1]]") "bending: {stiffness: 1}\n",
     ":7:10:", "a network bends at its faces"},
    {"bending to somewhere", ROPE TIME "bending: {stiffness: 1, rest: curled}\n",
     ":5:31:", "bending.rest is curled; it must be flat or start"},
    {"hinge of too few weights",
     "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}]\n  hinges: [{nodes: [0, 0, 0, 0], weights: [1, 1, 1], "
     "stiffness: 1}]\n" TIME,
     ":4:12:", "it has 4 nodes and 3 weights; give a weight for each"},
    {"hinge of nobody",
     "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}]\n  hinges: [{nodes: [0, 0, 7], weights: [1, 1, 1], "
     "stiffness: 1}]\n" TIME,
     ":4:12:", "hinge of node 7, which does not exist"},
    {"cantilever that is none", ROPE TIME "truth: cantilever\n", ":5:8:", "its first two particles pinned alone"},
    {"mesh that is not there", "name: m\nmesh: {file: none.obj, mass: 1}\n" TIME, ":2:14:", "none.obj: No such file"},
    {"mesh of both masses", "name: m\nmesh: {file: none.obj, mass: 1, density: 1}\n" TIME,
     ":2:7:", "mesh has both mass and density; keep one"},
    {"mesh without mass", "name: m\nmesh: {file: none.obj}\n" TIME, ":2:7:", "mesh has no mass; give it one"},
    {"mesh upside", "name: m\nmesh: {file: none.obj, mass: 1, up: down}\n" TIME,
     ":2:37:", "mesh.up is down; it must be x, y or z"},
    {"triangle of nobody",
     "name: n\nnetwork:\n  nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}]\n  triangles: [[0, 1, "
     "2]]\n" TIME,
     ":4:15:", "triangle of node 2, which does not exist"},
    {"pin nowhere", ROPE "pins: ['y > 5']\n" TIME, ":4:8:", "pin y > 5 is not on the rope"},
    {"kind of a spring", OWN("{ends: [0, 1], stiffness: 3, kind: weft}"),
     ":4:13:", "its kind is weft; it must be structural, shear or bend"},
    {"spring without strength", OWN("{ends: [0, 1]}"), ":4:13:", "it needs either a stiffness above 0, or rigid: true"},
    {"rigid and damped", OWN("{ends: [0, 1], rigid: true, damping: 1}"),
     ":4:13:", "no damping, which would do nothing"},
    {"rigid and soft", OWN("{ends: [0, 1], rigid: true, stiffness: 1}"), ":4:13:", "it needs either a stiffness"},
    {"rigid beside soft", OWN("{ends: [0, 1], stiffness: 3}, {ends: [1, 2], rigid: true}"),
     ":4:43:", "it is rigid where those before are not"},
    {"spring to nowhere", OWN("{ends: [0, 3], stiffness: 3}"), ":4:13:", "bar to node 3, which does not exist"},
    {"no length at rest", OWN("{ends: [0, 1], stiffness: 3, rest: 0}"),
     ":4:48:", "network.springs[].rest is 0; it must be a number above 0"},
    {"springs for no bars", OWN("{ends: [0, 1], stiffness: 3}") "springs: {stiffness: 3}\n",
     ":6:22:", "there are no network.bars"},
    {"pin with a speed",
     "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1, velocity: [1, 0, 0]}, {at: [1, 0, 0], mass: 1}]}\npins: "
     "[first]\n" TIME,
     ":2:54:", "node 0 is pinned; leave its velocity out"},
    {"missing time", ROPE, ":1:1:", "lacks the key time"},
    {"missing inner key", "name: r\nrope: {particles: 3, mass: 1}\n" TIME, ":2:7:", "rope lacks the key spacing"},
    {"key twice", ROPE TIME "name: again\n", ":5:1:", "given twice"},
    {"text for number", "name: r\nrope: {particles: 3, spacing: wide, mass: 1}\n" TIME,
     ":2:31:", "rope.spacing is wide; it must be a number"},
    {"list for number", "name: r\nrope: {particles: 3, spacing: [1], mass: 1}\n" TIME,
     ":2:31:", "is a list; it must be a number"},
    {"fraction for count", "name: r\nrope: {particles: 2.5, spacing: 1, mass: 1}\n" TIME,
     ":2:19:", "must be a whole number"},
    {"negative count", "name: r\nrope: {particles: -3, spacing: 1, mass: 1}\n" TIME,
     ":2:19:", "must be a whole number"},
    {"number for mapping", "name: r\nrope: 3\n" TIME, ":2:7:", "must be a mapping with keys among particles"},
    {"nothing for mapping", "name: r\nrope:\n" TIME, ":2:6:", "rope is empty"},
    {"text for boolean", "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {rigid: perhaps}\n" TIME,
     ":3:18:", "true or false"},
    {"short vector", ROPE TIME "gravity: [0, -9.81]\n", ":5:10:", "has 2 entries; it must have 3"},
    {"nan", "name: r\nrope: {particles: 3, spacing: .nan, mass: 1}\n" TIME, ":2:31:", "must be a number"},
    {"nan in C's spelling", "name: r\nrope: {particles: 3, spacing: nan, mass: 1}\n" TIME, ":2:31:", "must be"},
    {"inf", ROPE TIME "drag: inf\n", ":5:7:", "must be"},
    {"overflow", ROPE TIME "drag: 1e999\n", ":5:7:", "must be a finite number"},
    {"zero mass", "name: r\nrope: {particles: 3, spacing: 1, mass: 0}\n" TIME, ":2:40:", "must be a number above 0"},
    {"negative mass", "name: r\nrope: {particles: 3, spacing: 1, mass: -1}\n" TIME,
     ":2:40:", "must be a number above 0"},
    {"zero spacing", "name: r\nrope: {particles: 3, spacing: 0, mass: 1}\n" TIME, ":2:31:", "must be a number above 0"},
    {"zero step", ROPE "time: {duration: 1, step: 0}\n", ":4:27:", "must be a number above 0"},
    {"negative duration", ROPE "time: {duration: -1, step: 0.1}\n", ":4:18:", "must be a number above 0"},
    {"step beyond duration", ROPE "time: {duration: 1, step: 3}\n", ":4:7:", "is 0.333333333 frames"},
    {"restitution above 1", ROPE TIME "colliders: [{plane: {point: [0, 0, 0], normal: [0, 1, 0], restitution: 2}}]\n",
     ":5:72:", "from 0 to 1"},
    {"collider of no shape", ROPE TIME "colliders: [{}]\n",
     ":5:13:", "none of plane, sphere, capsule, cylinder and box"},
    {"hidden name", "name: .r\nrope: {particles: 3, spacing: 1, mass: 1}\n" TIME, ":1:7:", "begins with a dot"},
    {"capsule without length", ROPE TIME "colliders: [{capsule: {from: [0, 9, 0], to: [0, 9, 0], radius: 1}}]\n",
     ":5:", "a sphere has its place as center"},
    {"axis without direction", ROPE TIME "colliders: [{cylinder: {point: [0, 9, 0], axis: [0, 0, 0], radius: 1}}]\n",
     ":5:", "no direction"},
    {"box too round", ROPE TIME "colliders: [{box: {center: [0, 9, 0], size: [1, 1, 0.3], rounding: 0.2}}]\n",
     ":5:", "no room for edges rounded by 0.2 m"},
    {"box of one direction",
     ROPE TIME "colliders: [{box: {center: [0, 9, 0], size: [1, 1, 1], along: [0, 1, 0], up: [0, 2, 0]}}]\n",
     ":5:", "along and up are one direction"},
    {"flat box", ROPE TIME "colliders: [{box: {center: [0, 9, 0], size: [1, 0, 1]}}]\n", ":5:", "above 0"},
    {"normal without direction", ROPE TIME "colliders: [{plane: {point: [0, 0, 0], normal: [0, 0, 0]}}]\n",
     ":5:48:", "no direction"},
    {"a start inside a plane", ROPE TIME "colliders: [{plane: {point: [0, -0.1, 0], normal: [0, 1, 0]}}]\n",
     ":5:13:", "starts 0.1 m inside this collider"},
    {"a start inside a ball", ROPE TIME "colliders: [{sphere: {center: [0, -0.15, 0], radius: 0.1}}]\n",
     ":5:13:", "particle 1 starts 0.05 m inside"},
    {"a truth that knows no collider",
     ROPE TIME "truth: vertical_chain\ncolliders: [{plane: {point: [0, -3, 0], normal: [0, 1, 0]}}]\n",
     ":5:8:", "knows no plane"},
    {"a bounce without a plane", ROPE TIME "truth: bounce\n", ":5:8:", "above one plane"},
    {"a quirk that is no number", ROPE TIME "settings: {seed-tecido: {mended: all}}\n", ":5:34:", "must be"},
    {"pin outside a rope", ROPE TIME "pins: [first, 3]\n",
     ":5:15:", "pin 3 is not on the rope; give first, last, a number up to 2, a place as 'y > 0.5'"},
    {"pin outside a cloth", "name: c\ncloth: {rows: 2, columns: 2, spacing: 1, mass: 1}\npins: [2:0]\n" TIME,
     ":3:8:", "up to 1:1"},
    {"pin of no name", ROPE TIME "pins: [top_left]\n", ":5:8:", "pin top_left is not on the rope"},
    {"released pin that is none", ROPE TIME "pins: [0]\nrelease: [{at: 0.5, pins: [1]}]\n", ":6:28:", "is not pinned"},
    {"released twice", ROPE TIME "pins: [0]\nrelease: [{at: 0, pins: [0]}, {at: 0.5, pins: [0]}]\n",
     ":6:48:", "is already let go"},
    {"released after the end", ROPE TIME "pins: [0]\nrelease: [{at: 50, pins: [0]}]\n", ":6:16:", "ends at 1 s"},
    {"let go inside a plane",
     ROPE TIME "pins: [2]\nrelease: [{at: 0.5, pins: [2]}]\ncolliders: [{plane: {point: [0, -0.15, 0], normal: [0, 1, "
               "0]}}]\n",
     ":7:13:", "particle 2 is 0.05 m inside this collider when it is let go, at 0.5 s"},
    {"bar to itself", NETWORK("[[0, 0]]"), ":4:10:", "bar from node 0 to itself"},
    {"bar to a missing node", NETWORK("[[0, 1], [0, 7]]"),
     ":4:18:", "node 7, which does not exist; the nodes are 0 to 2"},
    {"bar of no length", NETWORK("[[0, 1], [1, 2]]"), ":4:18:", "at the same place"},
    {"bar with three ends", NETWORK("[[0, 1, 2]]"), ":4:10:", "has 3 entries; it must have 2"},
    {"bars without springs",
     "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}], bars: [[0, 1]]}\n" TIME,
     ":2:", "bars need springs"},
    {"equilibrium without pins", ROPE TIME "truth: equilibrium\n", ":5:8:", "needs pins"},
    {"unknown truth", ROPE TIME "truth: magic\n", ":5:8:", "no truth magic; known are"},
    {"truth for another body", ROPE TIME "truth: catenary\n", ":5:8:", "pinned at both ends"},
    {"unknown metric", ROPE TIME "measure: [sag, beauty]\n", ":5:16:", "no metric beauty; known are sag"},
    {"unknown engine", ROPE TIME "settings: {havok: {substeps: 3}}\n",
     ":5:12:", "unknown key havok in settings; known here: native-verlet"},
    {"cloth that is skew",
     "name: c\ncloth: {rows: 2, columns: 2, spacing: 1, mass: 1, across: [1, 0, 0], down: [1, 1, 0]}\n" TIME,
     ":2:8:", "right angles"},
    {"a billion particles", "name: r\nrope: {particles: 1000000000, spacing: 1, mass: 1}\n" TIME,
     ":2:7:", "asks for 1000000000 particles; it must be 1 to"},
    {"too many rows", "name: c\ncloth: {rows: 100000, columns: 100000, spacing: 1, mass: 1}\n" TIME,
     ":2:8:", "asks for 10000000000 particles"},
    {"a step that does not divide", ROPE "time: {duration: 1, step: 0.3}\n",
     ":4:7:", "is 3.33333333 frames; it must be a whole"},
    {"numbers beyond computing", "name: r\nrope: {particles: 3, spacing: 1.0e+200, mass: 1}\n" TIME,
     ":1:1:", "too large"},
    {"more iterations than an int", ROPE TIME "settings: {bullet-implicit: {iterations: 4294967295}}\n",
     ":5:42:", "must be a whole number from 1 to 1000000"},
    {"a number for an engine with a dot", ROPE TIME "settings: {\"a.b\": 5}\n",
     ":5:19:", "it must be a mapping of settings"},
    {"a mapping for a number", ROPE TIME "settings: {ode-quick: {substeps: {k: 1}}}\n", ":5:34:", "must be a number"},
    {"negative relaxation", ROPE TIME "settings: {ode-quick: {relaxation: -1}}\n", ":5:36:", "from 0.01 to 2"},
    {"name with a slash", "name: ../r\nrope: {particles: 3, spacing: 1, mass: 1}\n" TIME, ":1:7:", "made of letters"},
    {"zero byte", "name: \"a\\0b\"\nrope: {particles: 3, spacing: 1, mass: 1}\n" TIME, ":1:7:", "zero byte"},
    {"two documents", ROPE TIME "---\nname: s\n", ":5:1:", "second document"},
    {"deep nesting", "name: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[", ":1:22:", "nested too deep"},
    {"oscillator with prestretch",
     "name: r\nrope: {particles: 2, spacing: 1, mass: 1, along: [1, 0, 0]}\nsprings: {stiffness: 100, prestretch: "
     "0.1}\n"
     "pins: [first]\nvelocity: [1, 0, 0]\ntruth: oscillator\n" TIME,
     ":6:8:", "truth oscillator needs"},
    {"oscillator through its pin",
     "name: r\nrope: {particles: 2, spacing: 1, mass: 1, along: [1, 0, 0]}\nsprings: {stiffness: 100}\npins: [first]\n"
     "velocity: [30, 0, 0]\ntruth: oscillator\n" TIME,
     ":6:8:", "so gently that no spring turns over"},
    {"free fall pulled apart",
     "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 2}], bars: [[0, 1]]}\n"
     "springs: {stiffness: 9}\nforce: [1, 0, 0]\ntruth: free_fall\n" TIME,
     ":5:8:", "truth free_fall needs"},
    {"a network that bends",
     "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}], bars: "
     "[[0, 1]]}\nsprings: {stiffness: 9, bend: 1}\n" TIME,
     ":3:31:", "springs.bend has nothing to act on"},
    {"a network that shears",
     "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}], bars: "
     "[[0, 1]]}\nsprings: {stiffness: 9, shear: 1}\n" TIME,
     ":3:32:", "springs.shear has nothing to act on"},
    {"a rope that shears",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {stiffness: 9, shear: 1}\n" TIME,
     ":3:32:", "springs.shear has nothing to act on"},
    {"rigid bars with a stiffness",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {rigid: true, stiffness: 9}\n" TIME,
     ":3:35:", "bars that are rigid have none"},
    {"rigid bars with damping",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {rigid: true, damping: 9}\n" TIME,
     ":3:33:", "rigid bars do not stretch"},
    {"damping without springs",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {stiffness: 0, damping: 9}\n" TIME,
     ":3:34:", "springs.damping has nothing to act on"},
    {"a setting that the engine lacks", ROPE TIME "settings: {bullet-pbd: {relaxation: 1.2}}\n", ":5:25:",
     "unknown key relaxation in settings.bullet-pbd; known here: substeps, piterations, kLST, kDP, reordered"},
    {"a setting of an engine without any", ROPE TIME "settings: {still: {substeps: 2}}\n",
     ":5:20:", "known here: none"},
    {"rigid bars in equilibrium",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {rigid: true}\npins: [first]\ntruth: "
     "equilibrium\n" TIME,
     ":5:8:", "rigid bars have no energy to be least; for them there are vertical_chain"},
    {"rigid bars that snap on a trajectory",
     "name: r\nrope: {particles: 3, spacing: 1, mass: 1}\nsprings: {rigid: true, prestretch: 0.1}\npins: [first]\n"
     "truth: trajectory\n" TIME,
     ":5:8:", "bars that start at their lengths"},
    {"two clocks", ROPE "time: {duration: 1, step: 0.1, fps: 10}\n", ":4:32:", "both step and fps"},
    {"no clock", ROPE "time: {duration: 1}\n", ":4:7:", "time has none of step and fps"},
    {"60 Hz in few digits", ROPE "time: {duration: 6, step: 0.0166667}\n",
     ":4:7:", "fps in place of step says 1/60 s and its like exactly"},
    {"resolution beyond counting",
     "name: c\ncloth: {rows: 5, columns: 5, spacing: 1, mass: 1}\nresolution: 1073741824\n" TIME,
     ":2:8:", "cloth asks for"},
    {"empty file", "", ":1:1:", "is empty"},
    {"not YAML", "name: [\n", ":", "is not YAML"},
    {"a list", "- name\n", ":1:1:", "must be a mapping"},
    {"an alias", "name: &a r\nabout: *a\nrope: {particles: 3, spacing: 1, mass: 1}\n" TIME,
     ":2:8:", "an alias is not supported"},
};

static void test_bad_scenes(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof bad_scenes / sizeof *bad_scenes; i++) {
        ck_Error error = {0};
        ck_Comparison comparison;
        char *path = fixture_file(bad_scenes[i].text);
        ck_Status status = ck_comparison_load(&comparison, path, &error);
        ck_comparison_free(&comparison);
        unlink(path);
        if (status != CK_BAD_INPUT) fail_msg("%s: status %d, %s", bad_scenes[i].about, status, error.message);
        if (strncmp(error.message, path, strlen(path)) || !strstr(error.message + strlen(path), bad_scenes[i].place) ||
            !strstr(error.message, bad_scenes[i].message))
            fail_msg("%s: wanted %s %s, got %s", bad_scenes[i].about, bad_scenes[i].place, bad_scenes[i].message,
                     error.message);
        if (strchr(error.message, '\n')) fail_msg("%s: more than one line: %s", bad_scenes[i].about, error.message);
        free(path);
    }
}

static void test_bad_files(void **state) {
    (void)state;
    ck_Error error = {0};
    ck_Comparison comparison;
    assert_int_equal(ck_comparison_load(&comparison, "/tmp", &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "/tmp: is not a file"));
    ck_comparison_free(&comparison);
    assert_int_equal(ck_comparison_load(&comparison, "/nonexistent.yaml", &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "No such file"));
    ck_comparison_free(&comparison);

    // 100 MB, without writing them
    char *path = fixture_file("name: r\n");
    assert_int_equal(truncate(path, 100 << 20), 0);
    assert_int_equal(ck_comparison_load(&comparison, path, &error), CK_BAD_INPUT);
    assert_non_null(strstr(error.message, "is 104857600 bytes long; a scene file has at most 16777216"));
    ck_comparison_free(&comparison);
    unlink(path);
    free(path);
}

static void test_every_key(void **state) {
    (void)state;
    ck_Comparison comparison;
    fixture_load_comparison(
        &comparison,
        "name: all\nabout: every key there is\n"
        "cloth: {rows: 3, columns: 4, spacing: 0.5, mass: 12, origin: [1, 2, 3], across: [0, 0, 2], down: [0, -1, 0]}\n"
        "springs: {stiffness: 10, damping: 0.1, shear: 5, bend: 1, rigid: false, pull_only: true}\n"
        "bending: {stiffness: 0.2, rest: flat}\nwind: {velocity: [1, 0, 0], density: 1.2, drag: 1, lift: 0.5}\n"
        "pins: [top_edge, 2:3, 5]\nnoise: {amplitude: 0.01, seed: 7}\ngravity: [0, -10, 0]\ndrag: 2\nforce: [1, 0, "
        "0]\nvelocity: [0, 0, 1]\n"
        "colliders: [{plane: {point: [0, -1, 0], normal: [0, 2, 0], restitution: 0.6, friction: 0.3}},\n"
        "            {sphere: {center: [0, -1, 0], radius: 0.3, restitution: 0.2, friction: 0.5}, path: {velocity: [0, "
        "1, 0], to: 3}},\n"
        "            {capsule: {from: [0, -2, 0], to: [1, -2, 0], radius: 0.3, restitution: 0.2, friction: 0.5}},\n"
        "            {cylinder: {point: [0, -3, 0], axis: [0, 0, 3], radius: 0.3, restitution: 0.2, friction: 0.5}},\n"
        "            {box: {center: [0, -4, 0], size: [1, 0.5, 2], along: [0, 0, 1], up: [0, 1, 1], rounding: 0.1, "
        "restitution: 0.2, friction: 0.5}}]\n"
        "bodies: [{sphere: {center: [9, 9, 9], radius: 0.5, restitution: 0.2, friction: 0.5}, mass: 2, velocity: [1, "
        "0, 0],\n  spin: [0, 1, 0], hang: [bottom_left]}]\n"
        "moves: [{pins: [5], path: {amplitude: [0, 0, 1], frequency: 0.1}}]\n"
        "release: [{at: 1, pins: [top_left, 2:3]}]\nchanges: [{at: 2, set: '@drag=3'}]\n"
        "time: {duration: 4, step: 0.5}\nmeasure: [sag]\n"
        "settings: {ode-quick: {substeps: 16, iterations: 20, relaxation: 1.2}}\n");
    const ck_Model *model = &comparison.model;
    assert_int_equal(model->particle_count, 12 + 1);
    assert_int_equal(model->pin_count, 6); // four, one, one
    // 9 + 8 structural, 2 × 6 shear, 6 + 4 bend
    assert_int_equal(model->spring_count, 17 + 12 + 10 + 1);
    assert_int_equal(model->springs[39].a, 8);
    assert_int_equal(model->springs[39].b, 12);
    assert_near("inertia", model->rigid[0].inertia[1], 0.4 * 2 * 0.25, 1e-15);
    // 3 × 2 along rows, 1 × 4 along columns, 6 squares
    assert_int_equal(model->hinge_count, 6 + 4 + 6);
    assert_near("twist", model->hinges[0].stiffness, 0.4, 0);
    assert_near("border", model->hinges[1].stiffness, 0.1, 0);
    assert_int_equal(model->frame_count, 8);
    assert_near("size", model->size, 1.5, 0);
    assert_near("mass", model->mass[3], 1, 0);
    assert_near("last z", model->position[3 * 11 + 2], 3 + 1.5, 1e-15); // a pin: no noise
    assert_near("last y", model->position[3 * 11 + 1], 2 - 1, 1e-15);
    assert_true(fabs(model->position[3 * 6] - 1) > 0 && fabs(model->position[3 * 6] - 1) <= 0.01);
    assert_near("shear rest", model->springs[17].rest, 0.5 * sqrt(2), 1e-15);
    assert_near("normal", model->colliders[0].normal[1], 1, 0);
    assert_int_equal(model->releases[0].particle_count, 2);
    assert_int_equal(model->releases[0].particles[1], 11);
    assert_int_equal(ck_engine_scene_settings(ck_engine_find("ode-quick"), &comparison.scene).iterations, 20);
    assert_int_equal(ck_engine_scene_settings(ck_engine_find("ode-direct"), &comparison.scene).iterations, 0);
    assert_int_equal(model->segments[0].frame, 4);
    assert_near("drag later", model->segments[0].model.drag, 3, 0);
    // rigid bars are no springs, and uneven steps know no paths
    unsigned all = (1u << CK_TERM_COUNT) - 1;
    assert_int_equal(model->terms, all & ~(unsigned)(CK_TERM_RIGID | CK_TERM_JITTER));
    ck_comparison_free(&comparison);
}

static void test_shipped_scenes(void **state) {
    (void)state;
    glob_t found;
    assert_int_equal(glob(SCENE_DIRECTORY "/*.yaml", 0, NULL, &found), 0);
    assert_true(found.gl_pathc >= 7);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        ck_Error error = {0};
        ck_Comparison comparison;
        if (ck_comparison_load(&comparison, found.gl_pathv[i], &error)) fail_msg("%s", error.message);
        // a scene is found by its file
        char name[200];
        snprintf(name, sizeof name, "/%s.yaml", comparison.model.name);
        assert_non_null(strstr(found.gl_pathv[i], name));
        assert_non_null(comparison.scene.file->about);
        ck_comparison_free(&comparison);
    }
    globfree(&found);
}

static char *read_text(const char *path) {
    char *text = NULL;
    size_t size;
    ck_Error error = {0};
    if (ck_file_read(&text, &size, path, &error)) fail_msg("%s", error.message);
    return text;
}

static int load_blocks(const char *text) {
    int count = 0;
    for (const char *at = strstr(text, "```yaml\n"); at; at = strstr(at + 1, "```yaml\n"), count++) {
        char *scene = strndup(at + 8, (size_t)(strstr(at + 8, "```") - at - 8));
        ck_Comparison comparison;
        fixture_load_comparison(&comparison, scene);
        // a scene that is shown with a truth at rest comes to it
        if (comparison.model.truth && !strcmp(comparison.model.truth, "equilibrium"))
            assert_true(ck_settling_time(&comparison.model) <= comparison.model.duration);
        ck_comparison_free(&comparison);
        free(scene);
    }
    return count;
}

// Each scene that a README shows is one.
static void test_readme_scenes(void **state) {
    (void)state;
    static const char *const readmes[] = {SCENE_DIRECTORY "/../README.md", SCENE_DIRECTORY "/README.md"};
    for (size_t i = 0; i < sizeof readmes / sizeof *readmes; i++) {
        char *text = read_text(readmes[i]);
        assert_true(load_blocks(text) > 0);
        free(text);
    }
}

static void find_keys(const cyaml_schema_value_t *value, const char *readme) {
    if (value->type == CYAML_SEQUENCE || value->type == CYAML_SEQUENCE_FIXED) find_keys(value->sequence.entry, readme);
    if (value->type != CYAML_MAPPING) return;
    for (const cyaml_schema_field_t *field = value->mapping.fields; field->key; field++) {
        if (!strstr(readme, field->key)) fail_msg("scenes/README.md does not tell of %s", field->key);
        find_keys(&field->value, readme);
    }
}

// The README tells of every key of the schema.
static void test_readme_keys(void **state) {
    (void)state;
    char *text = read_text(SCENE_DIRECTORY "/README.md");
    find_keys(&ck_scene_schema, text);
    free(text);
}

// Noise moves free nodes out of the plane of a network, wherever that lies, and across the line of one that has none.
static void test_network_noise(void **state) {
    (void)state;
    static const struct {
        const char *nodes;
        double normal[3];
    } networks[] = {
        {"[{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [0, 1, 0], mass: 1}]", {0, 0, 1}},
        {"[{at: [0, 0, 0], mass: 1}, {at: [1, 0, 0], mass: 1}, {at: [0, 0, 1], mass: 1}]", {0, 1, 0}},
        {"[{at: [5, 0, 0], mass: 1}, {at: [5, 0, 2], mass: 1}, {at: [5, 3, 1], mass: 1}]", {1, 0, 0}},
        {"[{at: [0, 0, 0], mass: 1}, {at: [0, 1, 1], mass: 1}, {at: [1, 1, 1], mass: 1}]", {0, -M_SQRT1_2, M_SQRT1_2}},
    };
    for (size_t i = 0; i < sizeof networks / sizeof *networks; i++) {
        char text[600];
        ck_Comparison quiet, noisy;
        for (int has_noise = 0; has_noise < 2; has_noise++) {
            snprintf(text, sizeof text,
                     "name: n\nnetwork: {nodes: %s, bars: [[0, 1], [1, 2]]}\nsprings: {stiffness: 9}\n%s" TIME,
                     networks[i].nodes, has_noise ? "noise: {amplitude: 0.1, seed: 4}\n" : "");
            fixture_load_comparison(has_noise ? &noisy : &quiet, text);
        }
        for (int node = 0; node < 3; node++) {
            double moved[3];
            ck_subtract(moved, noisy.model.position + 3 * node, quiet.model.position + 3 * node);
            assert_near("along the normal", fabs(ck_dot(moved, networks[i].normal)), ck_length(moved), 1e-12);
            assert_true(ck_length(moved) > 1e-6);
        }
        ck_comparison_free(&quiet);
        ck_comparison_free(&noisy);
    }
    ck_Comparison line;
    fixture_load_comparison(
        &line, "name: n\nnetwork: {nodes: [{at: [0, 0, 0], mass: 1}, {at: [0, 0, 2], mass: 1}], bars: [[0, 1]]}\n"
               "springs: {stiffness: 9}\nnoise: {amplitude: 0.1, seed: 4}\n" TIME);
    assert_near("along the line", line.model.position[2], 0, 0);
    assert_true(ck_length(line.model.position) > 1e-6);
    ck_comparison_free(&line);
}

static void test_frames_a_second(void **state) {
    (void)state;
    ck_Comparison comparison;
    fixture_load_comparison(&comparison, ROPE "time: {duration: 6, fps: 60}\n");
    assert_int_equal(comparison.model.frame_count, 360);
    assert_near("step", comparison.model.step, 1.0 / 60, 0);
    ck_comparison_free(&comparison);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bad_scenes),      cmocka_unit_test(test_bad_files),
        cmocka_unit_test(test_every_key),       cmocka_unit_test(test_network_noise),
        cmocka_unit_test(test_frames_a_second), cmocka_unit_test(test_shipped_scenes),
        cmocka_unit_test(test_readme_scenes),   cmocka_unit_test(test_readme_keys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
