#include "csv_writer.h"
#include "export.h"
#include "path.h"

#include <math.h>

static const ck_Layout particles = {"particles.csv",
                                    "where each particle starts, m and m/s, its mass, kg, and whether it is pinned, "
                                    "until when, s",
                                    {{"particle", CK_COLUMN_NUMBER},
                                     {"x", CK_COLUMN_NUMBER},
                                     {"y", CK_COLUMN_NUMBER},
                                     {"z", CK_COLUMN_NUMBER},
                                     {"vx", CK_COLUMN_NUMBER},
                                     {"vy", CK_COLUMN_NUMBER},
                                     {"vz", CK_COLUMN_NUMBER},
                                     {"mass", CK_COLUMN_NUMBER},
                                     {"pinned", CK_COLUMN_NUMBER},
                                     {"released_s", CK_COLUMN_NUMBER}}};

static const ck_Layout springs = {"springs.csv",
                                  "two particles, length at rest, m, stiffness, N/m, inf for a bar, damping, N*s/m",
                                  {{"a", CK_COLUMN_NUMBER},
                                   {"b", CK_COLUMN_NUMBER},
                                   {"rest", CK_COLUMN_NUMBER},
                                   {"stiffness", CK_COLUMN_NUMBER},
                                   {"damping", CK_COLUMN_NUMBER},
                                   {"kind", CK_COLUMN_NAME}}};

static const ck_Layout colliders = {
    "colliders.csv",
    "planes, balls, and what is no farther than a radius from a core: capsules, endless cylinders and boxes; axes and "
    "half of the core along them, m",
    {{"shape", CK_COLUMN_NAME},      {"x", CK_COLUMN_NUMBER},        {"y", CK_COLUMN_NUMBER},
     {"z", CK_COLUMN_NUMBER},        {"normal_x", CK_COLUMN_NUMBER}, {"normal_y", CK_COLUMN_NUMBER},
     {"normal_z", CK_COLUMN_NUMBER}, {"radius", CK_COLUMN_NUMBER},   {"restitution", CK_COLUMN_NUMBER},
     {"friction", CK_COLUMN_NUMBER}, {"axis1_x", CK_COLUMN_NUMBER},  {"axis1_y", CK_COLUMN_NUMBER},
     {"axis1_z", CK_COLUMN_NUMBER},  {"axis2_x", CK_COLUMN_NUMBER},  {"axis2_y", CK_COLUMN_NUMBER},
     {"axis2_z", CK_COLUMN_NUMBER},  {"axis3_x", CK_COLUMN_NUMBER},  {"axis3_y", CK_COLUMN_NUMBER},
     {"axis3_z", CK_COLUMN_NUMBER},  {"half_1", CK_COLUMN_NUMBER},   {"half_2", CK_COLUMN_NUMBER},
     {"half_3", CK_COLUMN_NUMBER}}};

static const ck_Layout moves = {"moves.csv",
                                "where each pin that moves is at every frame, s and m",
                                {{"particle", CK_COLUMN_NUMBER},
                                 {"time_s", CK_COLUMN_NUMBER},
                                 {"x", CK_COLUMN_NUMBER},
                                 {"y", CK_COLUMN_NUMBER},
                                 {"z", CK_COLUMN_NUMBER}}};

static const ck_Layout collider_moves = {"collider_moves.csv",
                                         "how far each collider that moves has come at every frame, s and m",
                                         {{"collider", CK_COLUMN_NUMBER},
                                          {"time_s", CK_COLUMN_NUMBER},
                                          {"x", CK_COLUMN_NUMBER},
                                          {"y", CK_COLUMN_NUMBER},
                                          {"z", CK_COLUMN_NUMBER}}};

static const ck_Layout scene = {"scene.csv",
                                "what acts on all of it",
                                {{"key", CK_COLUMN_NAME}, {"unit", CK_COLUMN_NAME}, {"value", CK_COLUMN_NUMBER}}};

static void add_numbers(ck_Csv *csv, const double *numbers, int count) {
    for (int i = 0; i < count; i++) ck_csv_number(csv, numbers[i]);
}

static double released_at(const ck_Model *model, int particle) {
    for (int i = 0; i < model->release_count; i++)
        for (int k = 0; k < model->releases[i].particle_count; k++)
            if (model->releases[i].particles[k] == particle) return model->releases[i].at;
    return NAN;
}

static void add_particles(ck_Csv *csv, const ck_Model *model) {
    for (int i = 0; i < model->particle_count; i++) {
        ck_csv_number(csv, i);
        add_numbers(csv, model->position + 3 * i, 3);
        add_numbers(csv, model->velocity + 3 * i, 3);
        const double rest[] = {model->mass[i], model->pinned[i], released_at(model, i)};
        add_numbers(csv, rest, 3);
    }
}

static void add_springs(ck_Csv *csv, const ck_Model *model) {
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        const double numbers[] = {spring->a, spring->b, spring->rest, spring->stiffness, spring->damping};
        add_numbers(csv, numbers, 5);
        ck_csv_text(csv, ck_export_kinds[spring->kind]);
    }
}

static void add_moves(ck_Csv *csv, const ck_Model *model) {
    for (int i = 0; i < model->driven_count; i++)
        for (int frame = 0; frame <= model->frame_count; frame++) {
            const ck_Driven *driven = &model->driven[i];
            const double time = frame * model->step;
            double at[3];
            if (!ck_driven_holds(model, driven, time)) break;
            ck_driven_at(driven, time, at);
            ck_csv_number(csv, driven->particle);
            ck_csv_number(csv, time);
            add_numbers(csv, at, 3);
        }
}

static void add_collider_moves(ck_Csv *csv, const ck_Model *model) {
    for (int i = 0; i < model->collider_count; i++)
        for (int frame = 0; frame <= model->frame_count && model->colliders[i].path; frame++) {
            double moved[3], v[3], a[3];
            ck_path_at(model->colliders[i].path, frame * model->step, -1, moved, v, a);
            ck_csv_number(csv, i);
            ck_csv_number(csv, frame * model->step);
            add_numbers(csv, moved, 3);
        }
}

static void add_colliders(ck_Csv *csv, const ck_Model *model) {
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider *collider = &model->colliders[i];
        const bool is_plane = collider->shape == CK_PLANE;
        ck_csv_text(csv, ck_shape_names[collider->shape]);
        add_numbers(csv, collider->point, 3);
        for (int axis = 0; axis < 3; axis++) ck_csv_number(csv, is_plane ? collider->normal[axis] : NAN);
        const double rest[] = {is_plane ? NAN : collider->radius, collider->restitution, collider->friction};
        add_numbers(csv, rest, 3);
        for (int k = 0; k < 9; k++)
            ck_csv_number(csv, collider->shape > CK_SPHERE ? collider->axes[k / 3][k % 3] : NAN);
        for (int k = 0; k < 3; k++) ck_csv_number(csv, collider->shape > CK_SPHERE ? collider->half[k] : NAN);
    }
}

static void add_scene(ck_Csv *csv, const ck_Model *model) {
    const struct {
        const char *key, *unit;
        double value;
    } rows[] = {
        {"gravity_x", "m/s2", model->gravity[0]},
        {"gravity_y", "m/s2", model->gravity[1]},
        {"gravity_z", "m/s2", model->gravity[2]},
        {"force_x", "N", model->force[0]},
        {"force_y", "N", model->force[1]},
        {"force_z", "N", model->force[2]},
        {"drag", "1/s", model->drag},
        {"duration", "s", model->duration},
        {"step", "s", model->step},
        {"frames", "1", model->frame_count},
        {"size", "m", model->size},
        {"spacing", "m", model->spacing},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        ck_csv_text(csv, rows[i].key);
        ck_csv_text(csv, rows[i].unit);
        ck_csv_number(csv, rows[i].value);
    }
}

ck_Status ck_export_csv(const char *directory, const ck_Model *model, ck_Error *error) {
    const struct {
        const ck_Layout *layout;
        void (*add)(ck_Csv *csv, const ck_Model *model);
    } tables[] = {{&particles, add_particles},
                  {&springs, add_springs},
                  {&colliders, add_colliders},
                  {&scene, add_scene},
                  {model->driven_count ? &moves : NULL, add_moves},
                  {model->terms & CK_TERM_MOVING_COLLIDERS ? &collider_moves : NULL, add_collider_moves}};
    ck_Status status = CK_OK;
    for (size_t i = 0; i < sizeof tables / sizeof *tables && !status; i++) {
        ck_Csv csv = {0};
        if (!tables[i].layout) continue;
        status = ck_csv_open(&csv, directory, tables[i].layout, error);
        if (!status) tables[i].add(&csv, model);
        if (!status) status = ck_csv_close(&csv, error);
        ck_csv_discard(&csv);
    }
    return status;
}
