#include "export.h"

#include "vector.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const char *const ck_export_kinds[CK_SPRING_KINDS] = {"structural", "shear", "bend"};

static ck_Status end_of(FILE *out, ck_Error *error) {
    return fflush(out) || ferror(out) ? ck_fail(error, CK_IO, "cannot write the scene: %s", strerror(errno)) : CK_OK;
}

// What is written of JSON, a part a line, so that people can read it.
typedef struct Writer {
    FILE *out;
    bool has_failed; // for lack of memory
} Writer;

// Writes a value, which it takes over, after a text and before another.
static void put(Writer *writer, const char *before, json_t *value, const char *after) {
    char *text = value ? json_dumps(value, JSON_ENCODE_ANY | JSON_REAL_PRECISION(17)) : NULL;
    writer->has_failed |= !text;
    fprintf(writer->out, "%s%s%s", before, text ? text : "", after);
    free(text);
    json_decref(value);
}

static json_t *vector_of(const double *vector) {
    return json_pack("[f, f, f]", vector[0], vector[1], vector[2]);
}

static json_t *node_of(const ck_Model *model, int particle) {
    const double *velocity = model->velocity + 3 * particle;
    json_t *node =
        json_pack("{s:o, s:f}", "at", vector_of(model->position + 3 * particle), "mass", model->mass[particle]);
    bool moves = velocity[0] != 0 || velocity[1] != 0 || velocity[2] != 0;
    if (moves && node && json_object_set_new(node, "velocity", vector_of(velocity))) return NULL;
    return node;
}

static json_t *spring_of(const ck_Spring *spring) {
    if (isinf(spring->stiffness))
        return json_pack("{s:[i, i], s:f, s:b, s:s}", "ends", spring->a, spring->b, "rest", spring->rest, "rigid", 1,
                         "kind", ck_export_kinds[spring->kind]);
    json_t *soft =
        json_pack("{s:[i, i], s:f, s:f, s:f, s:s}", "ends", spring->a, spring->b, "rest", spring->rest, "stiffness",
                  spring->stiffness, "damping", spring->damping, "kind", ck_export_kinds[spring->kind]);
    if (spring->pulls_only && soft && json_object_set_new(soft, "pull_only", json_true())) return NULL;
    return soft;
}

static json_t *triangle_of(const int *corners) {
    return json_pack("[i, i, i]", corners[0], corners[1], corners[2]);
}

static json_t *hinge_of(const ck_Hinge *hinge) {
    json_t *nodes = json_array(), *weights = json_array();
    bool is_whole = nodes && weights;
    for (int i = 0; i < 4 && is_whole; i++)
        if (hinge->particles[i] >= 0)
            is_whole = !json_array_append_new(nodes, json_integer(hinge->particles[i])) &&
                       !json_array_append_new(weights, json_real(hinge->weights[i]));
    if (is_whole)
        return json_pack("{s:o, s:o, s:f, s:f}", "nodes", nodes, "weights", weights, "stiffness", hinge->stiffness,
                         "rest", hinge->rest);
    json_decref(nodes);
    json_decref(weights);
    return NULL;
}

static json_t *path_of(const ck_Path *path) {
    json_t *out, *points = path->kind == CK_PATH_POINTS ? json_array() : NULL;
    bool is_whole = true;
    for (int i = 0; i < path->point_count && points; i++) {
        const double *p = path->points[i];
        is_whole &= !json_array_append_new(points, json_pack("[f, f, f, f]", p[0], p[1], p[2], p[3]));
    }
    if (path->kind == CK_PATH_POINTS)
        out = json_pack("{s:o}", "points", points);
    else if (path->kind == CK_PATH_SINE)
        out = json_pack("{s:o, s:f, s:f}", "amplitude", vector_of(path->vector), "frequency", path->frequency, "from",
                        path->from);
    else
        out = json_pack("{s:o, s:f}", "velocity", vector_of(path->vector), "from", path->from);
    if (out && path->kind != CK_PATH_POINTS && isfinite(path->to))
        is_whole &= !json_object_set_new(out, "to", json_real(path->to));
    if (is_whole) return out;
    json_decref(out);
    return NULL;
}

// A box's side of which half less the rounding is the half of its core again, to the last bit where there is one.
static double side_of(const ck_Collider *collider, int axis) {
    const double half = collider->half[axis], radius = collider->radius, side = 2 * (half + radius);
    const double near[] = {side, nextafter(side, 0), nextafter(side, INFINITY)};
    for (int i = 0; i < 3; i++)
        if (0.5 * near[i] - radius == half) return near[i];
    return side;
}

static json_t *shape_of(const ck_Collider *collider) {
    const double *at = collider->point, *axis = collider->axes[0], *half = collider->half, radius = collider->radius,
                 restitution = collider->restitution, friction = collider->friction;
    double from[3], to[3];
    for (int k = 0; k < 3; k++) from[k] = at[k] - half[0] * axis[k], to[k] = at[k] + half[0] * axis[k];
    if (collider->shape == CK_SPHERE)
        return json_pack("{s:{s:o, s:f, s:f, s:f}}", "sphere", "center", vector_of(at), "radius", radius, "restitution",
                         restitution, "friction", friction);
    if (collider->shape == CK_CAPSULE)
        return json_pack("{s:{s:o, s:o, s:f, s:f, s:f}}", "capsule", "from", vector_of(from), "to", vector_of(to),
                         "radius", radius, "restitution", restitution, "friction", friction);
    if (collider->shape == CK_CYLINDER)
        return json_pack("{s:{s:o, s:o, s:f, s:f, s:f}}", "cylinder", "point", vector_of(at), "axis", vector_of(axis),
                         "radius", radius, "restitution", restitution, "friction", friction);
    if (collider->shape == CK_BOX)
        return json_pack("{s:{s:o, s:[f, f, f], s:o, s:o, s:f, s:f, s:f}}", "box", "center", vector_of(at), "size",
                         side_of(collider, 0), side_of(collider, 1), side_of(collider, 2), "along", vector_of(axis),
                         "up", vector_of(collider->axes[1]), "rounding", radius, "restitution", restitution, "friction",
                         friction);
    return json_pack("{s:{s:o, s:o, s:f, s:f}}", "plane", "point", vector_of(collider->point), "normal",
                     vector_of(collider->normal), "restitution", collider->restitution, "friction", collider->friction);
}

static json_t *collider_of(const ck_Collider *collider) {
    json_t *shape = shape_of(collider);
    if (!shape || !collider->path || !json_object_set_new(shape, "path", path_of(collider->path))) return shape;
    json_decref(shape);
    return NULL;
}

static json_t *rigid_of(const ck_Model *model, const ck_RigidBody *rigid) {
    const double *velocity = model->velocity + 3 * rigid->particle;
    json_t *body = shape_of(&rigid->shape), *hang = rigid->hung_count ? json_array() : NULL;
    bool is_whole = body && !json_object_set_new(body, "mass", json_real(model->mass[rigid->particle]));
    if (is_whole && (velocity[0] != 0 || velocity[1] != 0 || velocity[2] != 0))
        is_whole = !json_object_set_new(body, "velocity", vector_of(velocity));
    if (is_whole && (rigid->spin[0] != 0 || rigid->spin[1] != 0 || rigid->spin[2] != 0))
        is_whole = !json_object_set_new(body, "spin", vector_of(rigid->spin));
    for (int i = 0; i < rigid->hung_count && is_whole; i++)
        is_whole = !json_array_append_new(hang, json_integer(rigid->hung[i]));
    if (is_whole && hang) is_whole = !json_object_set(body, "hang", hang);
    json_decref(hang);
    if (is_whole) return body;
    json_decref(body);
    return NULL;
}

static int cloth_springs(const ck_Model *model) {
    int count = model->spring_count;
    for (int i = 0; i < model->rigid_count; i++) count -= model->rigid[i].hung_count;
    return count;
}

// The springs that bodies hang on, which are alike.
static void put_hanging(Writer *writer, const ck_Model *model) {
    if (cloth_springs(model) == model->spring_count) return;
    const ck_Spring *spring = &model->springs[model->spring_count - 1];
    const double length = ck_distance(model->position + 3 * spring->a, model->position + 3 * spring->b);
    const bool is_rigid = isinf(spring->stiffness);
    json_t *springs = is_rigid ? json_pack("{s:b}", "rigid", 1)
                               : json_pack("{s:f, s:f}", "stiffness", spring->stiffness, "damping", spring->damping);
    bool is_whole = springs != NULL;
    if (length != spring->rest && is_whole)
        is_whole = !json_object_set_new(springs, "prestretch", json_real(length / spring->rest - 1));
    if (spring->pulls_only && is_whole) is_whole = !json_object_set_new(springs, "pull_only", json_true());
    writer->has_failed |= !is_whole;
    put(writer, ",\n\"springs\": ", springs, "");
}

static void put_network(Writer *writer, const ck_Model *model) {
    put(writer, "\"network\": {\"size\": ", json_real(model->size), ", ");
    put(writer, "\"spacing\": ", json_real(model->spacing), ",\n \"nodes\": [");
    for (int i = 0; i < ck_model_cloth_count(model); i++) put(writer, i ? ",\n  " : "\n  ", node_of(model, i), "");
    fprintf(writer->out, "],\n \"springs\": [");
    // those that bodies hang on come last, and are said there
    for (int i = 0; i < cloth_springs(model); i++) put(writer, i ? ",\n  " : "\n  ", spring_of(&model->springs[i]), "");
    // air needs the faces of a cloth, too
    const int(*faces)[3] =
        model->triangle_count ? (const int(*)[3])model->triangles : (const int(*)[3])model->wind.faces;
    const int face_count = model->triangle_count ? model->triangle_count : model->wind.face_count;
    for (int i = 0; i < face_count; i++)
        put(writer, i ? ",\n  " : "],\n \"triangles\": [\n  ", triangle_of(faces[i]), "");
    for (int i = 0; i < model->hinge_count; i++)
        put(writer, i ? ",\n  " : "],\n \"hinges\": [\n  ", hinge_of(&model->hinges[i]), "");
    fprintf(writer->out, "]}");
}

static void put_pins(Writer *writer, const ck_Model *model) {
    json_t *pins = json_array();
    for (int i = 0; i < model->particle_count; i++)
        if (model->pinned[i]) writer->has_failed |= json_array_append_new(pins, json_integer(i)) != 0;
    if (json_array_size(pins))
        put(writer, ",\n\"pins\": ", pins, "");
    else
        json_decref(pins);
}

static void put_releases(Writer *writer, const ck_Model *model) {
    for (int i = 0; i < model->release_count; i++) {
        const ck_Release *release = &model->releases[i];
        json_t *pins = json_array();
        for (int k = 0; k < release->particle_count; k++)
            writer->has_failed |= json_array_append_new(pins, json_integer(release->particles[k])) != 0;
        put(writer, i ? ",\n  " : ",\n\"release\": [\n  ", json_pack("{s:f, s:o}", "at", release->at, "pins", pins),
            i + 1 == model->release_count ? "]" : "");
    }
}

static void put_moves(Writer *writer, const ck_Model *model) {
    bool is_first = true;
    for (int i = 0; i < model->path_count; i++) {
        json_t *pins = json_array();
        for (int k = 0; k < model->driven_count; k++)
            if (model->driven[k].path == &model->paths[i])
                writer->has_failed |= json_array_append_new(pins, json_integer(model->driven[k].particle)) != 0;
        if (json_array_size(pins)) {
            put(writer, is_first ? ",\n\"moves\": [\n  " : ",\n  ",
                json_pack("{s:o, s:o}", "pins", pins, "path", path_of(&model->paths[i])), "");
            is_first = false;
        } else {
            json_decref(pins);
        }
    }
    if (!is_first) fprintf(writer->out, "]");
}

// A closed form is of a rope or a cloth by that name, which a network is not.
static bool truth_goes_along(const ck_Model *model) {
    static const char *const general[] = {"equilibrium", "trajectory", "converged", "rest"};
    for (size_t i = 0; model->truth && i < sizeof general / sizeof *general; i++)
        if (!strcmp(model->truth, general[i])) return true;
    return false;
}

static void put_fields(Writer *writer, const ck_Model *model) {
    if (model->terms & CK_TERM_GRAVITY) put(writer, ",\n\"gravity\": ", vector_of(model->gravity), "");
    if (model->terms & CK_TERM_FORCE) put(writer, ",\n\"force\": ", vector_of(model->force), "");
    if (model->drag > 0) put(writer, ",\n\"drag\": ", json_real(model->drag), "");
    for (int i = 0; i < model->collider_count; i++)
        put(writer, i ? ",\n  " : ",\n\"colliders\": [\n  ", collider_of(&model->colliders[i]),
            i + 1 == model->collider_count ? "]" : "");
    if (model->terms & CK_TERM_WIND)
        put(writer, ",\n\"wind\": ",
            json_pack("{s:o, s:f, s:f, s:f}", "velocity", vector_of(model->wind.velocity), "density",
                      model->wind.density, "drag", model->wind.drag, "lift", model->wind.lift),
            "");
    for (int i = 0; i < model->rigid_count; i++)
        put(writer, i ? ",\n  " : ",\n\"bodies\": [\n  ", rigid_of(model, &model->rigid[i]),
            i + 1 == model->rigid_count ? "]" : "");
    put_hanging(writer, model);
    put_moves(writer, model);
    put_releases(writer, model);
    put(writer, ",\n\"time\": ", json_pack("{s:f, s:f}", "duration", model->duration, "step", model->step), "");
    if (truth_goes_along(model)) put(writer, ",\n\"truth\": ", json_string(model->truth), "");
    json_t *measure = model->measure_count ? json_array() : NULL;
    for (int i = 0; i < model->measure_count; i++)
        writer->has_failed |= json_array_append_new(measure, json_string(model->measure[i])) != 0;
    if (measure) put(writer, ",\n\"measure\": ", measure, "");
}

ck_Status ck_export_json(FILE *out, const ck_Model *model, ck_Error *error) {
    Writer writer = {.out = out};
    put(&writer, "{\"name\": ", json_string(model->name), ",\n");
    put_network(&writer, model);
    put_pins(&writer, model);
    put_fields(&writer, model);
    fprintf(out, "}\n");
    return writer.has_failed ? ck_fail(error, CK_NO_MEMORY, "out of memory") : end_of(out, error);
}

ck_Status ck_export_obj(FILE *out, const ck_Model *model, ck_Error *error) {
    fprintf(out, "# %s: metres; springs are lines, or cells of a cloth and triangles of a mesh are faces\no %s\n",
            model->name, model->name);
    for (int i = 0; i < model->particle_count; i++)
        fprintf(out, "v %.17g %.17g %.17g\n", model->position[3 * i], model->position[3 * i + 1],
                model->position[3 * i + 2]);
    int columns = model->columns, rows = columns ? model->particle_count / columns : 0;
    for (int row = 0; row + 1 < rows; row++)
        for (int column = 0; column + 1 < columns; column++) {
            int first = row * columns + column + 1;
            fprintf(out, "f %d %d %d %d\n", first, first + columns, first + columns + 1, first + 1);
        }
    for (int i = 0; i < model->triangle_count; i++)
        fprintf(out, "f %d %d %d\n", model->triangles[i][0] + 1, model->triangles[i][1] + 1,
                model->triangles[i][2] + 1);
    for (int i = 0; i < model->spring_count && !rows && !model->triangle_count; i++)
        if (model->springs[i].kind == CK_STRUCTURAL)
            fprintf(out, "l %d %d\n", model->springs[i].a + 1, model->springs[i].b + 1);
    return end_of(out, error);
}

static void line(FILE *out, const char *word, const double *numbers, int count) {
    fprintf(out, "%s", word);
    for (int i = 0; i < count; i++) fprintf(out, " %.17g", numbers[i]);
    fprintf(out, "\n");
}

static void write_path(FILE *out, const ck_Path *path) {
    static const char *const kinds[] = {"velocity", "sine", "points"};
    const double *v = path->vector, numbers[] = {path->from, path->to, v[0], v[1], v[2], path->frequency};
    if (path->kind != CK_PATH_POINTS) {
        line(out, kinds[path->kind], numbers, path->kind == CK_PATH_SINE ? 6 : 5);
        return;
    }
    fprintf(out, "points %d\n", path->point_count);
    for (int i = 0; i < path->point_count; i++) line(out, "", path->points[i], 4);
}

static void write_particles(FILE *out, const ck_Model *model) {
    fprintf(out, "particles %d\n", model->particle_count);
    for (int i = 0; i < model->particle_count; i++) {
        const double *x = model->position + 3 * i, *v = model->velocity + 3 * i;
        fprintf(out, "%.17g %.17g %.17g %.17g %.17g %.17g %.17g %d\n", x[0], x[1], x[2], v[0], v[1], v[2],
                model->mass[i], model->pinned[i]);
    }
}

static void write_springs(FILE *out, const ck_Model *model) {
    int slack = 0;
    fprintf(out, "springs %d\n", model->spring_count);
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        slack += spring->pulls_only;
        fprintf(out, "%d %d %.17g %.17g %.17g %s\n", spring->a, spring->b, spring->rest, spring->stiffness,
                spring->damping, ck_export_kinds[spring->kind]);
    }
    if (slack) fprintf(out, "slack %d\n", slack);
    for (int i = 0; i < model->spring_count && slack; i++)
        if (model->springs[i].pulls_only) fprintf(out, "%d\n", i);
}

static void write_hinges(FILE *out, const ck_Model *model) {
    if (model->hinge_count) fprintf(out, "hinges %d\n", model->hinge_count);
    for (int i = 0; i < model->hinge_count; i++) {
        const ck_Hinge *hinge = &model->hinges[i];
        const double numbers[] = {hinge->weights[0], hinge->weights[1], hinge->weights[2],
                                  hinge->weights[3], hinge->stiffness,  hinge->rest};
        fprintf(out, "%d %d %d %d", hinge->particles[0], hinge->particles[1], hinge->particles[2], hinge->particles[3]);
        line(out, "", numbers, 6);
    }
}

static void write_wind(FILE *out, const ck_Wind *wind) {
    const double numbers[] = {wind->velocity[0], wind->velocity[1], wind->velocity[2],
                              wind->density,     wind->drag,        wind->lift};
    if (!wind->face_count) return;
    line(out, "wind", numbers, 6);
    fprintf(out, "faces %d\n", wind->face_count);
    for (int i = 0; i < wind->face_count; i++)
        fprintf(out, "%d %d %d\n", wind->faces[i][0], wind->faces[i][1], wind->faces[i][2]);
}

static void write_moves(FILE *out, const ck_Model *model) {
    if (model->driven_count) fprintf(out, "moves %d\n", model->driven_count);
    for (int i = 0; i < model->driven_count; i++) {
        fprintf(out, "%d %.17g ", model->driven[i].particle, model->driven[i].until);
        write_path(out, model->driven[i].path);
    }
}

// Its place, then its normal or its axes and half its core along them, then its radius, restitution and friction: into
// [20]. Returns how many.
static int collider_numbers(double *numbers, const ck_Collider *collider) {
    int count = 3;
    memcpy(numbers, collider->point, sizeof collider->point);
    if (collider->shape == CK_PLANE) {
        memcpy(numbers + count, collider->normal, sizeof collider->normal);
        count += 3;
    } else if (collider->shape != CK_SPHERE) {
        memcpy(numbers + count, collider->axes, sizeof collider->axes);
        memcpy(numbers + count + 9, collider->half, sizeof collider->half);
        count += 12;
    }
    if (collider->shape != CK_PLANE) numbers[count++] = collider->radius;
    numbers[count++] = collider->restitution;
    numbers[count++] = collider->friction;
    return count;
}

static void write_collider(FILE *out, const ck_Collider *collider) {
    double numbers[20];
    line(out, ck_shape_names[collider->shape], numbers, collider_numbers(numbers, collider));
}

// Each the particle of its centre and what a collider is, and then its spin, its moments of inertia about its axes, and
// how many particles and which it hangs on.
static void write_bodies(FILE *out, const ck_Model *model) {
    if (model->rigid_count) fprintf(out, "bodies %d\n", model->rigid_count);
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_RigidBody *rigid = &model->rigid[i];
        double numbers[20 + 6];
        const int count = collider_numbers(numbers, &rigid->shape);
        memcpy(numbers + count, rigid->spin, sizeof rigid->spin);
        memcpy(numbers + count + 3, rigid->inertia, sizeof rigid->inertia);
        fprintf(out, "%d %s", rigid->particle, ck_shape_names[rigid->shape.shape]);
        for (int k = 0; k < count + 6; k++) fprintf(out, " %.17g", numbers[k]);
        fprintf(out, " %d", rigid->hung_count);
        for (int k = 0; k < rigid->hung_count; k++) fprintf(out, " %d", rigid->hung[k]);
        fprintf(out, "\n");
    }
}

static void write_colliders(FILE *out, const ck_Model *model) {
    int moving = 0;
    fprintf(out, "colliders %d\n", model->collider_count);
    for (int i = 0; i < model->collider_count; i++) {
        write_collider(out, &model->colliders[i]);
        moving += model->colliders[i].path != NULL;
    }
    if (moving) fprintf(out, "moving %d\n", moving);
    for (int i = 0; i < model->collider_count; i++) {
        if (!model->colliders[i].path) continue;
        fprintf(out, "%d ", i);
        write_path(out, model->colliders[i].path);
    }
}

// What a scene lacks of slack springs, hinges, wind and motion has no line: a program that says that it models none of
// them need not know their words.
void ck_export_lines(FILE *out, const ck_Model *model) {
    fprintf(out, "frames %d\n", model->frame_count);
    line(out, "step", &model->step, 1);
    line(out, "size", &model->size, 1);
    line(out, "spacing", &model->spacing, 1);
    line(out, "gravity", model->gravity, 3);
    line(out, "force", model->force, 3);
    line(out, "drag", &model->drag, 1);
    write_particles(out, model);
    write_springs(out, model);
    write_hinges(out, model);
    write_wind(out, &model->wind);
    write_moves(out, model);
    write_colliders(out, model);
    write_bodies(out, model);
}
