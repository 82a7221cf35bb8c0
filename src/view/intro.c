#include "intro.h"

#include "orders.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

size_t ck_intro_shown_count(const ck_Model *model) {
    return (size_t)(model->particle_count + 2 * model->rigid_count);
}

static json_t *numbers(const double *from, int count) {
    json_t *array = json_array();
    for (int i = 0; i < count && array; i++) json_array_append_new(array, json_real(isfinite(from[i]) ? from[i] : 0));
    return array;
}

// A collider as a replay has it: its place, and a plane's normal or a solid's radius, axes and half its core.
static json_t *collider_of(const ck_Model *model, const ck_Collider *collider) {
    double all[16];
    memcpy(all, collider->point, sizeof collider->point);
    if (collider->shape == CK_PLANE) {
        memcpy(all + 3, collider->normal, sizeof collider->normal);
        return json_pack("{s:s, s:o}", "shape", "plane", "numbers", numbers(all, 6));
    }
    all[3] = collider->radius;
    memcpy(all + 4, collider->axes, sizeof collider->axes);
    for (int k = 0; k < 3; k++) all[13 + k] = fmin(collider->half[k], model->size);
    return json_pack("{s:s, s:o}", "shape", ck_shape_names[collider->shape], "numbers", numbers(all, 16));
}

static void add_body(json_t *intro, const ck_Model *model) {
    json_t *springs = json_array(), *rests = json_array(), *triangles = json_array(), *colliders = json_array(),
           *bodies = json_array();
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        if (spring->kind != CK_STRUCTURAL) continue;
        json_array_append_new(springs, json_integer(spring->a));
        json_array_append_new(springs, json_integer(spring->b));
        json_array_append_new(rests, json_real(spring->rest));
    }
    for (int i = 0; i < 3 * model->triangle_count; i++)
        json_array_append_new(triangles, json_integer(model->triangles[i / 3][i % 3]));
    for (int i = 0; i < model->collider_count; i++)
        json_array_append_new(colliders, collider_of(model, &model->colliders[i]));
    for (int i = 0; i < model->rigid_count; i++) {
        const ck_Collider *shape = &model->rigid[i].shape;
        const double of[4] = {shape->radius, shape->half[0], shape->half[1], shape->half[2]};
        json_array_append_new(bodies, numbers(of, 4));
    }
    json_object_set_new(intro, "springs", springs);
    json_object_set_new(intro, "rests", rests);
    json_object_set_new(intro, "triangles", triangles);
    json_object_set_new(intro, "colliders", colliders);
    json_object_set_new(intro, "bodies", bodies);
}

// What the scene is set to, for the page's fields.
static void add_values(json_t *intro, const ck_Live *live) {
    const ck_Model *model = ck_live_model(live);
    const ck_Spring *spring = model->spring_count ? &model->springs[0] : NULL;
    const bool is_rigid = spring && isinf(spring->stiffness);
    json_object_set_new(intro, "gravity", numbers(model->gravity, 3));
    json_object_set_new(intro, "force", numbers(model->force, 3));
    json_object_set_new(intro, "drag", json_real(model->drag));
    json_object_set_new(intro, "stiffness", spring && !is_rigid ? json_real(spring->stiffness) : json_null());
    json_object_set_new(intro, "damping", spring && !is_rigid ? json_real(spring->damping) : json_null());
    json_t *pins = json_array();
    for (int i = 0; i < model->particle_count; i++)
        if (model->pinned[i]) json_array_append_new(pins, json_integer(i));
    json_object_set_new(intro, "pins", pins);
}

static json_t *engine_of(const ck_Engine *engine) {
    json_t *settings = json_array();
    for (const ck_Setting *row = engine->settings; row && row->name; row++)
        json_array_append_new(settings,
                              json_pack("{s:s, s:s, s:b, s:f, s:f, s:s}", "name", row->name, "help", row->help, "whole",
                                        row->is_whole, "least", row->least, "most", row->most, "rule", row->rule));
    return json_pack("{s:s, s:s, s:s, s:b, s:o}", "name", engine->name, "about", engine->about, "family",
                     engine->family, "stock", engine->is_stock, "settings", settings);
}

char *ck_intro_make(const ck_Live *live) {
    const ck_Model *model = ck_live_model(live);
    const char *about = ck_live_scene(live)->file->about;
    json_t *intro =
        json_pack("{s:s, s:s, s:s, s:f, s:f, s:f, s:i, s:i, s:i}", "kind", "intro", "scene", model->name, "about",
                  about ? about : "", "step", model->step, "size", model->size, "spacing", model->spacing, "columns",
                  model->columns, "particles", (int)ck_intro_shown_count(model), "cloth", ck_model_cloth_count(model));
    json_t *engines = json_array();
    if (!intro || !engines) return NULL;
    for (int i = 0; i < ck_live_count(live); i++)
        json_array_append_new(engines, engine_of(ck_live_engine(live, i)->engine));
    json_object_set_new(intro, "engines", engines);
    json_object_set_new(intro, "fastest", json_real(CK_STAGE_FASTEST * model->size));
    json_object_set_new(intro, "weight", json_real(9.81 * ck_model_free_mass(model) / fmax(1, model->particle_count)));
    add_body(intro, model);
    add_values(intro, live);
    char *text = json_dumps(intro, JSON_COMPACT);
    json_decref(intro);
    return text;
}
