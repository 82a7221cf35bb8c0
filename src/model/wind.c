#include "wind.h"

#include "vector.h"

#include <math.h>
#include <stdlib.h>

void ck_wind_face_force(const ck_Model *model, int face, const double *position, const double *velocity,
                        double *force) {
    const ck_Wind *wind = &model->wind;
    const int *corners = wind->faces[face];
    double normal[3], felt[3];
    ck_triangle_normal(normal, position + 3 * corners[0], position + 3 * corners[1], position + 3 * corners[2]);
    for (int axis = 0; axis < 3; axis++) {
        const double moves =
            velocity[3 * corners[0] + axis] + velocity[3 * corners[1] + axis] + velocity[3 * corners[2] + axis];
        felt[axis] = wind->velocity[axis] - moves / 3;
        force[axis] = 0;
    }
    // twice the area lies in the normal
    const double speed = ck_length(felt), twice = ck_length(normal), through = ck_dot(normal, felt);
    if (!(speed > 0 && twice > 0)) return;
    const double push = 0.25 * wind->density * fabs(through);
    ck_add_scaled(force, push * wind->drag, felt);
    if (!(wind->lift > 0)) return;
    const double side = through < 0 ? -1 : 1, along = side * through / (twice * speed * speed);
    ck_add_scaled(force, push * wind->lift * speed * side / twice, normal);
    ck_add_scaled(force, -push * wind->lift * speed * along, felt);
}

void ck_wind_add_force(const ck_Model *model, const double *position, const double *velocity, const double *by,
                       double *out) {
    for (int i = 0; i < model->wind.face_count; i++) {
        double force[3];
        ck_wind_face_force(model, i, position, velocity, force);
        for (int k = 0; k < 3; k++) {
            const int particle = model->wind.faces[i][k];
            ck_add_scaled(out + 3 * particle, (by ? by[particle] : 1) / 3, force);
        }
    }
}

bool ck_wind_blows(const ck_Model *model) {
    return model->wind.face_count && ck_length(model->wind.velocity) > 0;
}

double ck_wind_share_area(const ck_Model *model, double *share) {
    double whole = 0;
    for (int i = 0; i < model->wind.face_count; i++) {
        const int *corners = model->wind.faces[i];
        double normal[3];
        ck_triangle_normal(normal, model->position + 3 * corners[0], model->position + 3 * corners[1],
                           model->position + 3 * corners[2]);
        const double area = 0.5 * ck_length(normal);
        whole += area;
        for (int k = 0; k < 3; k++) share[corners[k]] += area / 3;
    }
    return whole;
}

double ck_wind_rate(const ck_Model *model) {
    const ck_Wind *wind = &model->wind;
    if (!wind->face_count) return 0;
    double *share = calloc((size_t)model->particle_count, sizeof *share), field[3], mass = 0, fastest = 0, most = 0;
    if (!share) return INFINITY;
    const double area = ck_wind_share_area(model, share);
    for (int i = 0; i < model->particle_count; i++) {
        mass += model->mass[i];
        fastest = fmax(fastest, ck_length(wind->velocity) + ck_length(model->velocity + 3 * i));
        if (!ck_model_is_held(model, i)) most = fmax(most, share[i] / model->mass[i]);
    }
    free(share);
    ck_model_mean_field(model, field);
    // what falls face on comes to √(2mg/(ρ·C_d·A))
    if (wind->drag > 0) fastest += sqrt(2 * mass * ck_length(field) / (wind->density * wind->drag * area));
    return wind->density * (wind->drag + wind->lift) * most * fastest;
}
