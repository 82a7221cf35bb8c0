#include "model.h"

#include "body.h"
#include "collider.h"
#include "path.h"
#include "scene.h"
#include "segment.h"
#include "statistics.h"
#include "vector.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const ck_term_names[CK_TERM_COUNT] = {
    "springs",
    "rigid bars",
    "spring damping",
    "gravity",
    "force",
    "drag",
    "start velocity",
    "plane",
    "sphere",
    "release",
    "bending",
    "wind",
    "springs that only pull",
    "moving pins",
    "moving colliders",
    "capsules, cylinders or boxes",
    "rigid bodies",
    "uneven steps",
    "changes",
};

const char *const ck_shape_names[CK_SHAPE_COUNT] = {"plane", "sphere", "capsule", "cylinder", "box"};

const char *const ck_stiffness_names[CK_SPRING_KINDS] = {"structural stiffness", "shear stiffness",
                                                         "second-neighbour stiffness"};

static ck_Status copy_text(char **out, const char *text) {
    *out = text ? strdup(text) : NULL;
    return text && !*out ? CK_NO_MEMORY : CK_OK;
}

static ck_Status copy_labels(ck_Model *model, const ck_SceneFile *file) {
    ck_Status status = copy_text(&model->name, file->name);
    if (!status) status = copy_text(&model->about, file->about);
    // none is what a scene says that is another one's but for its truth
    if (!status) status = copy_text(&model->truth, file->truth && strcmp(file->truth, "none") ? file->truth : NULL);
    model->measure = calloc(file->measure_count + 1, sizeof *model->measure);
    if (!model->measure) return CK_NO_MEMORY;
    for (uint32_t i = 0; i < file->measure_count && !status; i++) {
        status = copy_text(&model->measure[i], file->measure[i]);
        model->measure_count++;
    }
    return status;
}

// Whether the step is a whole number of frames a second, in as many digits as people write.
static bool is_near_fps(const ck_SceneTime *time) {
    double fps = 1 / time->step;
    return fabs(fps - round(fps)) < 1e-4 * fps && fmod(time->duration * round(fps), 1) == 0;
}

static bool moves_collider(const ck_SceneFile *file) {
    bool moves = false;
    for (uint32_t i = 0; i < file->colliders_count; i++) moves |= file->colliders[i].path != NULL;
    return moves;
}

static ck_Status set_time(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneTime *time = &scene->file->time;
    double ratio = time->duration / time->step, frames = floor(ratio + 0.5);
    if (frames < 1 || frames > 1e6 || fabs(ratio - frames) > 1e-6 * frames)
        return ck_scene_fail(scene, "time", error,
                             "duration / step is %.9g frames; it must be a whole number from 1 to 1000000%s", ratio,
                             is_near_fps(time) ? "; fps in place of step says 1/60 s and its like exactly" : "");
    model->duration = time->duration;
    model->step = time->step;
    model->frame_count = (int)frames;
    model->jitter = time->jitter;
    model->jitter_seed = time->seed;
    if (!(time->jitter < 1))
        return ck_scene_fail(scene, "time.jitter", error, "it is %g; below 1, or a step would take no time",
                             time->jitter);
    if (time->jitter > 0 && (scene->file->moves_count || moves_collider(scene->file)))
        return ck_scene_fail(scene, "time.jitter", error,
                             "uneven steps of what moves along a path are not modelled; leave one of the two out");
    return CK_OK;
}

static ck_Status set_pins(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneFile *file = scene->file;
    int *chosen = malloc(sizeof *chosen * (size_t)model->particle_count);
    ck_Status status = chosen ? CK_OK : CK_NO_MEMORY;
    for (uint32_t i = 0; i < file->pins_count && !status; i++) {
        char path[32];
        snprintf(path, sizeof path, "pins[%u]", i);
        int count = 0;
        status = ck_model_resolve_pin(chosen, &count, model, scene, file->pins[i], path, error);
        for (int j = 0; j < count; j++) model->pinned[chosen[j]] = true;
    }
    free(chosen);
    for (int i = 0; i < model->particle_count; i++) model->pin_count += model->pinned[i];
    if (!status && model->truth && !strcmp(model->truth, "equilibrium") && !model->pin_count)
        return ck_scene_fail(
            scene, "truth", error,
            "truth equilibrium needs pins: without them the body falls for ever; add pins or another truth");
    return status;
}

static ck_Status set_start(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const char *start = scene->file->start;
    if (!start) return CK_OK;
    if (strcmp(start, "equilibrium"))
        return ck_scene_fail(scene, "start", error,
                             "start is %s; it must be equilibrium, or be left out: then the body starts as given",
                             start);
    if (!model->pin_count)
        return ck_scene_fail(
            scene, "start", error,
            "start equilibrium needs pins: without them the body falls for ever; release lets them go");
    model->starts_settled = true;
    return CK_OK;
}

// Adds what a pin's name stands for.
static ck_Status release_pins(ck_Model *model, ck_Release *release, const int *chosen, int count, const char *pin,
                              const ck_Scene *scene, const char *path, ck_Error *error) {
    int *grown = realloc(release->particles, sizeof *grown * (size_t)(release->particle_count + count + 1));
    if (!grown) return CK_NO_MEMORY;
    release->particles = grown;
    for (int j = 0; j < count; j++) {
        if (!model->pinned[chosen[j]])
            return ck_scene_fail(scene, path, error, "%s is not pinned, so that it cannot be released; add it to pins",
                                 pin);
        if (model->released[chosen[j]])
            return ck_scene_fail(scene, path, error, "%s is already let go; name it once", pin);
        model->released[chosen[j]] = true;
        grown[release->particle_count++] = chosen[j];
    }
    return CK_OK;
}

static ck_Status set_release(ck_Model *model, const ck_Scene *scene, uint32_t index, ck_Error *error) {
    const ck_SceneRelease *from = &scene->file->release[index];
    ck_Release *release = &model->releases[model->release_count++];
    if (from->at >= model->duration) {
        char path[32];
        snprintf(path, sizeof path, "release[%u].at", index);
        return ck_scene_fail(scene, path, error, "the scene ends at %g s; let pins go before", model->duration);
    }
    release->at = from->at;
    release->frame = (int)fmin(ceil(from->at / model->step * (1 - 1e-12)), model->frame_count);
    int *chosen = malloc(sizeof *chosen * (size_t)model->particle_count);
    ck_Status status = chosen ? CK_OK : CK_NO_MEMORY;
    for (uint32_t i = 0; i < from->pins_count && !status; i++) {
        char path[48];
        snprintf(path, sizeof path, "release[%u].pins[%u]", index, i);
        int count = 0;
        status = ck_model_resolve_pin(chosen, &count, model, scene, from->pins[i], path, error);
        if (!status) status = release_pins(model, release, chosen, count, from->pins[i], scene, path, error);
    }
    free(chosen);
    return status;
}

static ck_Status set_releases(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    model->releases = calloc(scene->file->release_count + 1, sizeof *model->releases);
    if (!model->releases) return CK_NO_MEMORY;
    ck_Status status = CK_OK;
    for (uint32_t i = 0; i < scene->file->release_count && !status; i++) status = set_release(model, scene, i, error);
    return status;
}

// What is said of springs is modelled, or it is an error: nothing is left out in silence. A body too small to have
// springs of a kind is none.
static ck_Status check_springs(const ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneSprings *springs = scene->file->springs;
    if (!springs) return CK_OK;
    bool is_none = !(springs->stiffness > 0) && !(springs->shear > 0) && !(springs->bend > 0) && !springs->rigid;
    const ck_SceneNetwork *network = scene->file->network;
    bool lacks_bars = network && network->springs_count && !network->bars_count;
    // bodies hang on them
    for (uint32_t i = 0; i < scene->file->bodies_count; i++) lacks_bars &= !scene->file->bodies[i].hang_count;
    const struct {
        const char *path;
        double value;
        bool is_idle;
        const char *why;
    } rules[] = {
        {"springs.stiffness", springs->stiffness, springs->rigid, "bars that are rigid have none; keep one of the two"},
        {"springs.damping", springs->damping, springs->rigid, "rigid bars do not stretch, so that it damps nothing"},
        {"springs.shear", springs->shear, model->body != CK_CLOTH,
         "only a cloth of squares has diagonals; add bars to a network, or leave it out"},
        {"springs.bend", springs->bend, model->body == CK_NETWORK || model->body == CK_MESH,
         "only a cloth and a rope have second neighbours; leave it out"},
        {"springs.pull_only", springs->pull_only, springs->rigid, "rigid bars push, too; leave one of the two out"},
        {"springs.pull_only", springs->pull_only, is_none, "there is no spring; give a stiffness, or leave it out"},
        {"springs.damping", springs->damping, is_none, "there is no spring; give a stiffness, or leave it out"},
        {"springs.prestretch", springs->prestretch, is_none, "there is no spring; give a stiffness, or leave it out"},
        {"springs.stiffness", springs->stiffness, lacks_bars,
         "there are no network.bars; network.springs have their own"},
        {"springs.rigid", springs->rigid, lacks_bars, "there are no network.bars; network.springs have their own"},
    };
    for (size_t i = 0; i < sizeof rules / sizeof *rules; i++)
        if (rules[i].value > 0 && rules[i].is_idle)
            return ck_scene_fail(scene, rules[i].path, error, "%s has nothing to act on: %s", rules[i].path,
                                 rules[i].why);
    return CK_OK;
}

// Where a particle is when it is first free, and when that is.
static double first_free(const ck_Model *model, int particle, double *position) {
    memcpy(position, model->position + 3 * particle, 3 * sizeof(double));
    if (!model->pinned[particle]) return 0;
    for (int i = 0; i < model->driven_count; i++)
        if (model->driven[i].particle == particle) ck_driven_at(&model->driven[i], model->driven[i].until, position);
    return ck_model_release_time(model, particle);
}

ck_Status ck_model_check_outside(const ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    for (int i = 0; i < model->particle_count; i++) {
        double position[3], normal[3], speed[3], gain[3];
        if (!model->collider_count || ck_model_is_held(model, i)) continue;
        const double time = first_free(model, i, position);
        for (int j = 0; j < model->collider_count; j++) {
            const ck_Collider there = ck_collider_at(&model->colliders[j], time, -1, speed, gain);
            const double gap = ck_collider_gap(&there, position, normal);
            char path[32];
            snprintf(path, sizeof path, "colliders[%d]", j);
            if (!(gap < -1e-9 * model->spacing)) continue;
            if (time > 0)
                return ck_scene_fail(scene, path, error,
                                     "particle %d is %g m inside this collider when it is let go, at %g s; move one of "
                                     "them, or let it go elsewhere",
                                     i, -gap, time);
            return ck_scene_fail(scene, path, error, "particle %d starts %g m inside this collider%s; move %s", i, -gap,
                                 model->starts_settled ? ", of which a start at equilibrium knows nothing" : "",
                                 model->starts_settled ? "the collider, or let the body fall on it"
                                                       : "the body or the collider");
        }
    }
    return CK_OK;
}

// A node's own start speed, over the scene's.
static ck_Status set_node_velocity(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_SceneNetwork *network = scene->file->network;
    for (int i = 0; network && i < model->particle_count; i++) {
        const double *velocity = network->nodes[i].velocity;
        char path[48];
        if (!velocity) continue;
        snprintf(path, sizeof path, "network.nodes[%d].velocity", i);
        if (model->pinned[i] && ck_length(velocity) > 0)
            return ck_scene_fail(scene, path, error, "node %d is pinned; leave its velocity out, or the pin", i);
        memcpy(model->velocity + 3 * i, velocity, 3 * sizeof(double));
    }
    return CK_OK;
}

static void set_fields(ck_Model *model, const ck_SceneFile *file) {
    if (file->gravity) memcpy(model->gravity, file->gravity, sizeof model->gravity);
    if (file->force) memcpy(model->force, file->force, sizeof model->force);
    model->drag = file->drag;
    for (int i = 0; i < model->particle_count; i++)
        if (file->velocity && !model->pinned[i]) memcpy(model->velocity + 3 * i, file->velocity, 3 * sizeof(double));
}

// Numbers that are each fine may still make a body that is not.
static ck_Status check_finite(const ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    bool fine = isfinite(model->size * model->size) && isfinite(model->size * ck_length(model->gravity));
    for (int i = 0; i < model->particle_count; i++) {
        fine &= isfinite(ck_dot(model->position + 3 * i, model->position + 3 * i)) && isfinite(1 / model->mass[i]);
        fine &= isfinite(ck_dot(model->velocity + 3 * i, model->velocity + 3 * i)) &&
                isfinite(ck_length(model->force) / model->mass[i]);
    }
    if (fine) return CK_OK;
    return ck_scene_fail(
        scene, "", error,
        "its numbers are too large or too small to be computed with; use metres, kilograms and seconds");
}

static unsigned terms_in_use(const ck_Model *model) {
    unsigned terms = 0;
    if (model->spring_count) terms |= CK_TERM_SPRINGS;
    for (int i = 0; i < model->spring_count; i++) {
        if (isinf(model->springs[i].stiffness)) terms |= CK_TERM_RIGID;
        if (model->springs[i].damping > 0) terms |= CK_TERM_DAMPING;
        if (model->springs[i].pulls_only) terms |= CK_TERM_PULL_ONLY;
    }
    if (ck_length(model->gravity) > 0) terms |= CK_TERM_GRAVITY;
    if (ck_length(model->force) > 0) terms |= CK_TERM_FORCE;
    if (model->drag > 0) terms |= CK_TERM_DRAG;
    for (int i = 0; i < model->particle_count; i++)
        if (ck_length(model->velocity + 3 * i) > 0) terms |= CK_TERM_VELOCITY;
    for (int i = 0; i < model->collider_count; i++) terms |= ck_collider_terms(&model->colliders[i]);
    if (model->release_count) terms |= CK_TERM_RELEASE;
    if (model->driven_count) terms |= CK_TERM_MOVES;
    if (model->hinge_count) terms |= CK_TERM_BENDING;
    if (model->wind.face_count) terms |= CK_TERM_WIND;
    if (model->rigid_count) terms |= CK_TERM_BODIES;
    if (model->jitter > 0) terms |= CK_TERM_JITTER;
    return terms;
}

//   is_part  of a scene that changes: where its particles are is not yet known
static ck_Status build(ck_Model *model, const ck_Scene *scene, bool is_part, ck_Error *error) {
    *model = (ck_Model){0};
    if (error) error->message[0] = 0;
    ck_Status status = copy_labels(model, scene->file);
    if (!status) status = set_time(model, scene, error);
    if (!status) status = ck_model_build_body(model, scene, error);
    if (!status) status = check_springs(model, scene, error);
    if (!status) status = ck_model_set_material(model, scene, error);
    if (!status) status = ck_model_build_hinges(model, scene, error);
    if (!status) status = ck_model_set_wind(model, scene, error);
    if (!status) status = set_pins(model, scene, error);
    if (!status) status = set_start(model, scene, error);
    if (!status) status = set_releases(model, scene, error);
    if (!status) status = ck_model_set_colliders(model, scene, error);
    if (!status) status = ck_model_set_paths(model, scene, error);
    if (status == CK_NO_MEMORY) return ck_fail(error, status, "%s: out of memory", scene->document.path);
    if (status) return status;
    ck_model_add_noise(model, scene);
    // of a start at equilibrium it is asked once that is known
    if (!model->starts_settled && !is_part) status = ck_model_check_outside(model, scene, error);
    if (status) return status;
    set_fields(model, scene->file);
    status = set_node_velocity(model, scene, error);
    if (!status) status = ck_model_add_rigid(model, scene, is_part, error);
    if (status == CK_NO_MEMORY) return ck_fail(error, status, "%s: out of memory", scene->document.path);
    if (status) return status;
    model->terms = terms_in_use(model);
    return check_finite(model, scene, error);
}

ck_Status ck_model_build(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    const ck_Status status = build(model, scene, false, error);
    return status ? status : ck_model_build_segments(model, scene, error);
}

ck_Status ck_model_build_part(ck_Model *model, const ck_Scene *scene, ck_Error *error) {
    return build(model, scene, true, error);
}

void ck_model_free(ck_Model *model) {
    for (int i = 0; i < model->release_count; i++) free(model->releases[i].particles);
    for (int i = 0; i < model->measure_count; i++) free(model->measure[i]);
    for (int i = 0; i < model->group_count; i++) {
        free(model->groups[i].name);
        free(model->groups[i].particles);
    }
    for (int i = 0; i < model->path_count; i++) free(model->paths[i].points);
    for (int i = 0; i < model->rigid_count; i++) free(model->rigid[i].hung);
    for (int i = 0; i < model->segment_count; i++) ck_segment_free(&model->segments[i]);
    free(model->segments);
    free(model->rigid);
    free(model->paths);
    free(model->driven);
    free(model->groups);
    free(model->hinges);
    free(model->wind.faces);
    free(model->triangles);
    free(model->releases);
    free(model->measure);
    free(model->colliders);
    free(model->springs);
    free(model->position);
    free(model->velocity);
    free(model->mass);
    free(model->pinned);
    free(model->released);
    free(model->truth);
    free(model->about);
    free(model->name);
    *model = (ck_Model){0};
}

void ck_model_scale_stiffness(ck_Model *copy, ck_Spring *springs, double factor) {
    for (int i = 0; i < copy->spring_count; i++) {
        springs[i] = copy->springs[i];
        springs[i].stiffness *= factor;
    }
    copy->springs = springs;
}

double ck_model_release_time(const ck_Model *model, int particle) {
    for (int i = 0; i < model->release_count; i++)
        for (int j = 0; j < model->releases[i].particle_count; j++)
            if (model->releases[i].particles[j] == particle) return model->releases[i].frame * model->step;
    return INFINITY;
}

void ck_model_parts(const ck_Model *model, int frame, double *parts) {
    ck_Random random = ck_random_seed(((uint64_t)model->jitter_seed << 32) + (uint64_t)frame);
    const double more = model->jitter * (2 * ck_random_unit(&random) - 1);
    parts[0] = 0.5 * model->step * (1 + more);
    parts[1] = model->step - parts[0];
}

int ck_model_cloth_count(const ck_Model *model) {
    return model->particle_count - model->rigid_count;
}

bool ck_model_is_held(const ck_Model *model, int particle) {
    return model->pinned[particle] && !model->released[particle];
}

double ck_model_inverse_mass(const ck_Model *model, int particle) {
    return model->pinned[particle] ? 0 : 1 / model->mass[particle];
}

double ck_model_free_mass(const ck_Model *model) {
    double sum = 0;
    for (int i = 0; i < model->particle_count; i++)
        if (!model->pinned[i]) sum += model->mass[i];
    return sum;
}

const ck_Spring *ck_model_spring_of_kind(const ck_Model *model, ck_SpringKind kind) {
    const ck_Spring *found = NULL;
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[i];
        if (spring->kind != kind) continue;
        if (!model->pinned[spring->a] && !model->pinned[spring->b]) return spring;
        if (!found) found = spring;
    }
    return found;
}

void ck_model_field(const ck_Model *model, int particle, double *acceleration) {
    double push[3];
    if (!(model->terms & CK_TERM_FORCE)) {
        memcpy(acceleration, model->gravity, 3 * sizeof(double));
        return;
    }
    for (int axis = 0; axis < 3; axis++) push[axis] = model->force[axis] / model->mass[particle];
    for (int axis = 0; axis < 3; axis++) acceleration[axis] = model->gravity[axis] + push[axis];
    // a force that carries the weight leaves nothing, not the rounding of it
    if (ck_length(acceleration) <= 1e-14 * ck_length(push)) memset(acceleration, 0, 3 * sizeof(double));
}

void ck_model_mean_field(const ck_Model *model, double *acceleration) {
    double mass = ck_model_free_mass(model), field[3];
    memset(acceleration, 0, 3 * sizeof(double));
    for (int i = 0; i < model->particle_count; i++) {
        ck_model_field(model, i, field);
        if (!model->pinned[i]) ck_add_scaled(acceleration, model->mass[i] / mass, field);
    }
}
