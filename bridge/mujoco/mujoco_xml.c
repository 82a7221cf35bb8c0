#include "mujoco_xml.h"

#include "collider.h"
#include "path.h"
#include "rigid.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

double ck_mujoco_radius(const ck_Model *model) {
    // a rigid body rolls and turns over at where its shape ends
    const double share = model->rigid_count ? 0.01 : 0.1;
    double radius = share * model->spacing;
    for (int i = 0; i < model->collider_count; i++)
        radius = fmin(radius, share * ck_collider_breadth(&model->colliders[i]));
    for (int i = 0; i < model->rigid_count; i++)
        radius = fmin(radius, share * ck_collider_breadth(&model->rigid[i].shape));
    return radius;
}

// Half the length of a cylinder without end, in sizes of the body.
#define ENDLESS 100.0

// Steps that a contact without restitution takes to come to rest.
#define REST_STEPS 2.0

// The damping ratio ζ of a spring and damper that let a particle go with e times the speed that it came with, and
// cannot pull: e = exp(−2·ζ·acos ζ/√(1 − ζ²)), beyond 1 with acosh. Source: derived from x'' + 2·ζ·x' + x = 0, up to
// where the force is 0.
static double damping_ratio(double restitution) {
    double low = 0, high = 100;
    for (int i = 0; i < 60; i++) {
        double ratio = 0.5 * (low + high), root = sqrt(fabs(1 - ratio * ratio));
        double angle = root < 1e-9 ? 1 : (ratio < 1 ? acos(ratio) : acosh(ratio)) / root;
        if (exp(-2 * ratio * angle) > restitution)
            low = ratio;
        else
            high = ratio;
    }
    return low;
}

// A contact is a spring and a damper, by how MuJoCo takes solref: with restitution as −k and −b of the relative
// acceleration −b·v − k·r; without, as a time constant, critically damped. solimp near 1, or a part of the motion would
// be left as it is.
static void write_contact(FILE *out, const ck_Collider *collider, double step) {
    if (collider->restitution > 0) {
        double frequency = M_PI / (CK_MUJOCO_BOUNCE_STEPS * step);
        fprintf(out, " solref=\"%.17g %.17g\"", -frequency * frequency,
                -2 * damping_ratio(collider->restitution) * frequency);
    } else {
        fprintf(out, " solref=\"%.17g 1\"", REST_STEPS * step);
    }
    fprintf(out, " solimp=\"0.9999 0.9999 0.001\" condim=\"%d\" friction=\"%.17g 0 0\"", collider->friction > 0 ? 3 : 1,
            collider->friction);
}

// A solid that moves is a body, which is put where it belongs before every step, and too heavy to be pushed.
static void write_moving(FILE *out, const ck_Model *model, int index) {
    double mass = CK_MUJOCO_HEAVY * model->particle_count;
    fprintf(out, "<body name=\"c%d\"><inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g %.17g\"/>", index,
            mass, mass, mass, mass);
    for (int axis = 0; axis < 3; axis++)
        fprintf(out, "<joint type=\"slide\" axis=\"%d %d %d\"/>", axis == 0, axis == 1, axis == 2);
}

// What meets what: contype of one and conaffinity of the other.
typedef enum Meets { MEETS_PARTICLES, MEETS_BODIES, MEETS_BOTH } Meets;
static const char *const meets[] = {"contype=\"0\" conaffinity=\"1\"", "contype=\"2\" conaffinity=\"0\"",
                                    "contype=\"0\" conaffinity=\"3\""};

// One of MuJoCo's own shapes at a place, m, with its sizes, m, and the axes of the collider.
static void write_geom(FILE *out, const ck_Collider *collider, const ck_MujocoOptions *options, const char *type,
                       const double *at, const double *sizes, const double *zaxis) {
    const double(*axes)[3] = collider->axes;
    fprintf(out, "<geom mass=\"0\" %s type=\"%s\" pos=\"%.17g %.17g %.17g\" size=\"%.17g %.17g %.17g\"",
            meets[options->meets], type, at[0], at[1], at[2], sizes[0], sizes[1], sizes[2]);
    if (zaxis)
        fprintf(out, " zaxis=\"%.17g %.17g %.17g\"", zaxis[0], zaxis[1], zaxis[2]);
    else if (collider->shape == CK_BOX)
        fprintf(out, " xyaxes=\"%.17g %.17g %.17g %.17g %.17g %.17g\"", axes[0][0], axes[0][1], axes[0][2], axes[1][0],
                axes[1][1], axes[1][2]);
    write_contact(out, collider, options->step);
    fprintf(out, "/>");
}

// A box with rounded edges: three, each out to two faces, and a capsule along each edge.
static void write_box(FILE *out, const ck_Collider *collider, const ck_MujocoOptions *options, double radius) {
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, m = (k + 2) % 3;
        double sizes[3] = {collider->half[0], collider->half[1], collider->half[2]};
        sizes[k] += radius;
        write_geom(out, collider, options, "box", collider->point, sizes, NULL);
        for (int corner = 0; corner < 4; corner++) {
            const double edge[3] = {radius, collider->half[k], 0};
            double at[3];
            memcpy(at, collider->point, sizeof at);
            ck_add_scaled(at, (corner & 1 ? 1 : -1) * collider->half[l], collider->axes[l]);
            ck_add_scaled(at, (corner & 2 ? 1 : -1) * collider->half[m], collider->axes[m]);
            write_geom(out, collider, options, "capsule", at, edge, collider->axes[k]);
        }
    }
}

// A sphere or a box of MuJoCo's about a place, m, larger by so much, m.
static void write_solid(FILE *out, const ck_Collider *solid, const double *at, const ck_MujocoOptions *options,
                        double more) {
    const double radius = solid->radius + more, ball[3] = {radius, 0, 0},
                 box[3] = {solid->half[0] + radius, solid->half[1] + radius, solid->half[2] + radius};
    ck_Collider there = *solid;
    memcpy(there.point, at, sizeof there.point);
    if (solid->shape == CK_SPHERE)
        write_geom(out, &there, options, "sphere", at, ball, NULL);
    else if (radius > 0 && solid->radius > 0)
        write_box(out, &there, options, radius);
    else
        write_geom(out, &there, options, "box", at, box, NULL);
}

// A rigid body: it slides and turns. Particles, which are spheres to MuJoCo, meet a smaller shape of it, and colliders,
// which are smaller themselves, a larger one; so do other bodies, of whose two shapes each meets the other's other.
static void write_rigid(FILE *out, const ck_Model *model, int index, const ck_MujocoOptions *options) {
    const ck_RigidBody *rigid = &model->rigid[index];
    const double *at = model->position + 3 * rigid->particle, mass = model->mass[rigid->particle], none[3] = {0};
    const double(*axes)[3] = rigid->shape.axes;
    ck_MujocoOptions small = *options, large = *options;
    small.meets = MEETS_BOTH;
    large.meets = MEETS_BODIES;
    fprintf(out,
            "<body name=\"b%d\" pos=\"%.17g %.17g %.17g\"><inertial pos=\"0 0 0\" mass=\"%.17g\" "
            "diaginertia=\"%.17g %.17g %.17g\" xyaxes=\"%.17g %.17g %.17g %.17g %.17g %.17g\"/>",
            rigid->particle, at[0], at[1], at[2], mass, rigid->inertia[0], rigid->inertia[1], rigid->inertia[2],
            axes[0][0], axes[0][1], axes[0][2], axes[1][0], axes[1][1], axes[1][2]);
    for (int axis = 0; axis < 3; axis++)
        fprintf(out, "<joint type=\"slide\" axis=\"%d %d %d\" damping=\"%.17g\"/>", axis == 0, axis == 1, axis == 2,
                model->drag * mass);
    fprintf(out, "<joint type=\"ball\"/><site name=\"s%d\"/>", rigid->particle);
    write_solid(out, &rigid->shape, none, &small, -options->radius);
    write_solid(out, &rigid->shape, none, &large, options->radius);
    fprintf(out, "</body>\n");
}

// What hangs a body does not touch it.
static void write_excludes(FILE *out, const ck_Model *model) {
    fprintf(out, "<contact>\n");
    for (int i = 0; i < model->rigid_count; i++)
        for (int k = 0; k < model->rigid[i].hung_count; k++)
            if (!model->pinned[model->rigid[i].hung[k]])
                fprintf(out, "<exclude body1=\"b%d\" body2=\"b%d\"/>\n", model->rigid[i].particle,
                        model->rigid[i].hung[k]);
    fprintf(out, "</contact>\n");
}

// A plane sinks and a solid shrinks by the radius of what stands for a particle, which rounds sharp edges. A cylinder
// without end is a capsule far longer than the body.
static void write_collider(FILE *out, const ck_Model *model, int index, const ck_MujocoOptions *options) {
    const ck_Collider *collider = &model->colliders[index];
    const double radius = collider->radius - options->radius, length = fmin(collider->half[0], ENDLESS * model->size);
    const double plane[3] = {0, 0, 1}, ball[3] = {radius, 0, 0}, capsule[3] = {radius, length, 0},
                 box[3] = {collider->half[0] + radius, collider->half[1] + radius, collider->half[2] + radius};
    double sunk[3] = {collider->point[0], collider->point[1], collider->point[2]};
    // what has no end is written where the body is
    for (int i = 0; i < model->particle_count && collider->shape == CK_CYLINDER; i++) {
        double from[3];
        ck_subtract(from, model->position + 3 * i, collider->point);
        ck_add_scaled(sunk, ck_dot(from, collider->axes[0]) / model->particle_count, collider->axes[0]);
    }
    if (collider->path) write_moving(out, model, index);
    if (collider->shape == CK_PLANE) {
        ck_add_scaled(sunk, -options->radius, collider->normal);
        write_geom(out, collider, options, "plane", sunk, plane, collider->normal);
    } else if (collider->shape == CK_SPHERE) {
        write_geom(out, collider, options, "sphere", collider->point, ball, NULL);
    } else if (collider->shape != CK_BOX) {
        write_geom(out, collider, options, "capsule", sunk, capsule, collider->axes[0]);
    } else if (radius > 0) {
        write_box(out, collider, options, radius);
    } else {
        write_geom(out, collider, options, "box", collider->point, box, NULL);
    }
    fprintf(out, collider->path ? "</body>\n" : "\n");
}

// What of a particle meets solids, m from where it belongs to.
static void write_touching(FILE *out, const ck_MujocoOptions *options, const double *at) {
    fprintf(out,
            "<geom type=\"sphere\" pos=\"%.17g %.17g %.17g\" size=\"%.17g\" contype=\"1\" conaffinity=\"0\" "
            "condim=\"1\" friction=\"0 0 0\" priority=\"-1\" mass=\"0\"/>",
            at[0], at[1], at[2], options->radius);
}

static void write_particle(FILE *out, const ck_Model *model, int particle, const ck_MujocoOptions *options) {
    const double *at = model->position + 3 * particle;
    // one that is moved is put where it belongs after every step
    if (model->pinned[particle] && !ck_driven_find(model, particle, 0)) {
        fprintf(out, "<site name=\"s%d\" pos=\"%.17g %.17g %.17g\"/>\n", particle, at[0], at[1], at[2]);
        if (model->rigid_count) write_touching(out, options, at);
        return;
    }
    // it does not turn, so that any inertia does
    double mass = model->mass[particle], inertia = 0.1 * mass * model->spacing * model->spacing;
    fprintf(
        out,
        "<body name=\"b%d\" pos=\"%.17g %.17g %.17g\"><inertial pos=\"0 0 0\" mass=\"%.17g\" diaginertia=\"%.17g %.17g "
        "%.17g\"/>",
        particle, at[0], at[1], at[2], mass, inertia, inertia, inertia);
    for (int axis = 0; axis < 3; axis++)
        fprintf(out, "<joint type=\"slide\" axis=\"%d %d %d\" damping=\"%.17g\"/>", axis == 0, axis == 1, axis == 2,
                model->drag * mass);
    fprintf(out, "<site name=\"s%d\"/>", particle);
    const double none[3] = {0};
    if (model->collider_count || model->rigid_count) write_touching(out, options, none);
    fprintf(out, "</body>\n");
}

static void write_springs(FILE *out, const ck_Model *model) {
    fprintf(out, "<tendon>\n");
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        if (model->pinned[spring->a] && model->pinned[spring->b]) continue;
        fprintf(out,
                "<spatial stiffness=\"%.17g\" damping=\"%.17g\" springlength=\"%.17g\"><site site=\"s%d\"/><site "
                "site=\"s%d\"/></spatial>\n",
                spring->stiffness, spring->damping, spring->rest, spring->a, spring->b);
    }
    fprintf(out, "</tendon>\n");
}

// How many contacts there may be: a particle at a corner of a rounded box touches three of its pieces, or more where
// they are thin.
static int most_contacts(const ck_Model *model) {
    int most = 0;
    for (int i = 0; i < model->collider_count; i++) most += model->colliders[i].shape == CK_BOX ? 6 : 1;
    return most * model->particle_count + 2 * (int)ck_rigid_most_touches(model);
}

int ck_mujoco_stack(const ck_Model *model, const char *integrator) {
    const double joints = 3.0 * model->particle_count, rows = 3.0 * most_contacts(model);
    double numbers = 1e6 + 4e3 * model->particle_count;
    if (!strcmp(integrator, "implicit")) numbers += 10 * joints * model->spring_count;
    if (rows > 0) numbers += (joints + rows) * (joints + rows);
    return (int)fmin(2e8, numbers);
}

char *ck_mujoco_xml(const ck_Model *model, const ck_MujocoOptions *options, size_t *length) {
    char *text = NULL;
    FILE *out = open_memstream(&text, length);
    if (!out) return NULL;
    const double *g = model->gravity;
    fprintf(out,
            "<mujoco><compiler boundmass=\"0\" boundinertia=\"0\" autolimits=\"true\"/>\n<option timestep=\"%.17g\" "
            "gravity=\"%.17g %.17g %.17g\" integrator=\"%s\" jacobian=\"sparse\" cone=\"elliptic\" tolerance=\"0\" "
            "iterations=\"100\"/>\n<size njmax=\"%d\" nconmax=\"%d\" nstack=\"%d\"/>\n<worldbody>\n",
            options->step, g[0], g[1], g[2], options->integrator, 10 + 3 * most_contacts(model),
            10 + most_contacts(model), ck_mujoco_stack(model, options->integrator));
    ck_MujocoOptions solid = *options;
    solid.meets = model->rigid_count ? MEETS_BOTH : MEETS_PARTICLES;
    for (int i = 0; i < model->collider_count; i++) write_collider(out, model, i, &solid);
    for (int i = 0; i < ck_model_cloth_count(model); i++) write_particle(out, model, i, options);
    for (int i = 0; i < model->rigid_count; i++) write_rigid(out, model, i, options);
    fprintf(out, "</worldbody>\n");
    write_springs(out, model);
    if (model->rigid_count) write_excludes(out, model);
    fprintf(out, "</mujoco>\n");
    // a stream in memory fails for lack of it alone
    if (fclose(out)) {
        free(text);
        return NULL;
    }
    return text;
}
