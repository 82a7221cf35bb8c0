#include "rigid.h"

#include "collider.h"
#include "vector.h"

#include <math.h>
#include <string.h>

ck_Turn ck_rigid_start(const ck_RigidBody *rigid) {
    ck_Turn turn = {{1, 0, 0, 0}, {rigid->spin[0], rigid->spin[1], rigid->spin[2]}};
    return turn;
}

// v + 2·w·(u × v) + 2·u × (u × v)
void ck_rigid_rotate(double *out, const double *rotation, const double *vector) {
    const double *u = rotation + 1;
    double once[3], twice[3];
    ck_cross(once, u, vector);
    ck_cross(twice, u, once);
    for (int axis = 0; axis < 3; axis++) out[axis] = vector[axis] + 2 * (rotation[0] * once[axis] + twice[axis]);
}

ck_Collider ck_rigid_place(const ck_RigidBody *rigid, const double *center, const double *rotation) {
    ck_Collider now = rigid->shape;
    memcpy(now.point, center, sizeof now.point);
    for (int k = 0; k < 3; k++) ck_rigid_rotate(now.axes[k], rotation, rigid->shape.axes[k]);
    return now;
}

// Of the matrix axes·startᵀ, by its largest part. Source: Shepperd 1978.
void ck_rigid_rotation(double *rotation, const ck_RigidBody *rigid, double (*axes)[3]) {
    double m[3][3] = {{0}}, part[4];
    for (int i = 0; i < 9; i++)
        for (int k = 0; k < 3; k++) m[i / 3][i % 3] += axes[k][i / 3] * rigid->shape.axes[k][i % 3];
    const double trace = m[0][0] + m[1][1] + m[2][2];
    int most = 0;
    part[0] = trace;
    for (int k = 0; k < 3; k++) part[k + 1] = 2 * m[k][k] - trace;
    for (int k = 1; k < 4; k++)
        if (part[k] > part[most]) most = k;
    const double root = 0.5 * sqrt(fmax(0, 1 + part[most]));
    rotation[most] = root;
    for (int k = 0; k < 3; k++) {
        const int l = (k + 1) % 3, n = (k + 2) % 3;
        const double odd = (m[n][l] - m[l][n]) / (4 * root);
        if (most == 0)
            rotation[k + 1] = odd;
        else if (most == k + 1)
            rotation[0] = odd;
        else
            rotation[k + 1] = (m[most - 1][k] + m[k][most - 1]) / (4 * root);
    }
}

void ck_rigid_momentum(double *momentum, const ck_RigidBody *rigid, const ck_Collider *now, const double *spin) {
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) ck_add_scaled(sum, rigid->inertia[k] * ck_dot(now->axes[k], spin), now->axes[k]);
    memcpy(momentum, sum, sizeof sum);
}

void ck_rigid_spin(double *spin, const ck_RigidBody *rigid, const ck_Collider *now, const double *momentum) {
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) ck_add_scaled(sum, ck_dot(now->axes[k], momentum) / rigid->inertia[k], now->axes[k]);
    memcpy(spin, sum, sizeof sum);
}

// By an angle about a constant axis: the quaternion of spin·dt times the rotation.
static void turn_by(double *out, const double *rotation, const double *spin, double dt) {
    const double rate = ck_length(spin), half = 0.5 * rate * dt, share = rate > 0 ? sin(half) / rate : 0;
    const double w = cos(half), *u = rotation + 1;
    double v[3] = {share * spin[0], share * spin[1], share * spin[2]}, across[3], turned[4];
    ck_cross(across, v, u);
    turned[0] = w * rotation[0] - ck_dot(v, u);
    for (int axis = 0; axis < 3; axis++) turned[axis + 1] = w * u[axis] + rotation[0] * v[axis] + across[axis];
    const double norm = sqrt(turned[0] * turned[0] + ck_dot(turned + 1, turned + 1));
    for (int k = 0; k < 4; k++) out[k] = turned[k] / norm;
}

void ck_rigid_turn(double *rotation, const ck_RigidBody *rigid, const double *momentum, double dt) {
    const double origin[3] = {0, 0, 0};
    double spin[3], middle[4];
    ck_Collider now = ck_rigid_place(rigid, origin, rotation);
    ck_rigid_spin(spin, rigid, &now, momentum);
    turn_by(middle, rotation, spin, 0.5 * dt);
    now = ck_rigid_place(rigid, origin, middle);
    ck_rigid_spin(spin, rigid, &now, momentum);
    turn_by(rotation, rotation, spin, dt);
}

bool ck_rigid_is_unknown(const ck_Collider *one, const ck_Collider *other) {
    return one->shape == CK_BOX && other->shape != CK_PLANE && other->shape != CK_SPHERE;
}

size_t ck_rigid_most_touches(const ck_Model *model) {
    const size_t bodies = (size_t)model->rigid_count, others = (size_t)model->collider_count + bodies;
    return bodies * ((size_t)model->particle_count + 8 * others);
}

// Where a search is at.
typedef struct Search {
    ck_Touch *touches;
    int count;
    double reach;
} Search;

// Of b's surface and a point of a, which is so far inside of a's.
static void add(Search *search, ck_Touch touch, const ck_Collider *surface, const double *point, double inside) {
    touch.gap = ck_collider_gap(surface, point, touch.normal) - inside;
    if (!(touch.gap <= search->reach)) return;
    memcpy(touch.point, point, sizeof touch.point);
    ck_add_scaled(touch.point, -inside, touch.normal);
    search->touches[search->count++] = touch;
}

static bool is_hung(const ck_RigidBody *rigid, int particle) {
    for (int i = 0; i < rigid->hung_count; i++)
        if (rigid->hung[i] == particle) return true;
    return false;
}

static void search_cloth(Search *search, const ck_Model *model, const double *position, const ck_Collider *bodies) {
    for (int j = 0; j < model->rigid_count; j++)
        for (int i = 0; i < ck_model_cloth_count(model); i++) {
            const ck_Touch touch = {.particle = i,
                                    .rigid = -1,
                                    .other = j,
                                    .collider = -1,
                                    .restitution = bodies[j].restitution,
                                    .friction = bodies[j].friction};
            if (!is_hung(&model->rigid[j], i)) add(search, touch, &bodies[j], position + 3 * i, 0);
        }
}

// A body against a surface that is convex: a sphere by its centre, a box by its corners, or by the centre of a sphere.
static void search_pair(Search *search, ck_Touch touch, const ck_Collider *body, const ck_Collider *surface) {
    touch.restitution = fmax(body->restitution, surface->restitution);
    touch.friction = fmax(body->friction, surface->friction);
    if (body->shape == CK_SPHERE) {
        add(search, touch, surface, body->point, body->radius);
    } else if (surface->shape == CK_SPHERE) {
        // seen from the sphere, and turned round
        const int before = search->count;
        add(search, touch, body, surface->point, surface->radius);
        for (int axis = 0; axis < 3 && search->count > before; axis++) search->touches[before].normal[axis] *= -1;
    } else if (surface->shape == CK_PLANE) {
        for (int corner = 0; corner < 8; corner++) {
            double point[3] = {body->point[0], body->point[1], body->point[2]};
            for (int k = 0; k < 3; k++)
                ck_add_scaled(point, corner & 1 << k ? body->half[k] : -body->half[k], body->axes[k]);
            add(search, touch, surface, point, body->radius);
        }
    }
}

int ck_rigid_find_touches(const ck_Model *model, const double *position, const ck_Collider *bodies,
                          const ck_Collider *colliders, double reach, ck_Touch *touches) {
    Search search = {touches, 0, reach};
    search_cloth(&search, model, position, bodies);
    for (int i = 0; i < model->rigid_count; i++) {
        ck_Touch touch = {.particle = model->rigid[i].particle, .rigid = i, .other = -1, .collider = -1};
        for (int j = 0; j < model->collider_count; j++) {
            touch.collider = j;
            search_pair(&search, touch, &bodies[i], &colliders[j]);
        }
        touch.collider = -1;
        for (int j = 0; j < i; j++) {
            touch.other = j;
            search_pair(&search, touch, &bodies[i], &bodies[j]);
        }
    }
    return search.count;
}
