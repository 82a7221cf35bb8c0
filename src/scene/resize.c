#include "resize.h"

#include <math.h>
#include <string.h>

// Segments of that many particles, share times as many; 0 where they are no whole number.
static uint32_t scale_count(uint32_t count, double share) {
    const double segments = (count - 1.0) * share;
    const bool is_whole = fabs(segments - round(segments)) < 1e-9 * segments && segments >= 1;
    // more than a scene may have is refused by who counts particles
    return is_whole ? (uint32_t)fmin(round(segments), CK_SCENE_MAX_PARTICLES) + 1 : 0;
}

static bool has_number(char *const *pins, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        if (pins[i][strspn(pins[i], "0123456789:")] == 0) return true;
    return false;
}

const char *ck_scene_resize_refusal(const ck_SceneFile *file, double share) {
    if (!file->cloth && !file->rope) return "it is neither a cloth nor a rope";
    // pins by number would be others then
    bool is_numbered = has_number(file->pins, file->pins_count);
    for (uint32_t i = 0; i < file->moves_count; i++)
        is_numbered |= has_number(file->moves[i].pins, file->moves[i].pins_count);
    for (uint32_t i = 0; i < file->bodies_count; i++)
        is_numbered |= has_number(file->bodies[i].hang, file->bodies[i].hang_count);
    if (is_numbered)
        return "its pins are numbered, and would be others: name a corner, an edge or a place, as 'y > 0.5'";
    if (file->release_count) return "it lets pins go";
    bool is_whole = file->rope ? scale_count(file->rope->particles, share)
                               : scale_count(file->cloth->rows, share) && scale_count(file->cloth->columns, share);
    return is_whole ? NULL : "no grid of whole cells has its size";
}

void ck_scene_resize(ck_SceneResized *resized, const ck_SceneFile *from, double share) {
    double particles, left;
    resized->file = *from;
    if (from->springs) resized->springs = *from->springs;
    if (from->cloth) {
        ck_SceneCloth *cloth = &resized->cloth;
        *cloth = *from->cloth;
        particles = (double)cloth->rows * cloth->columns;
        cloth->rows = scale_count(cloth->rows, share);
        cloth->columns = scale_count(cloth->columns, share);
        cloth->spacing /= share;
        left = (double)cloth->rows * cloth->columns;
        resized->file.cloth = cloth;
    } else {
        ck_SceneRope *rope = &resized->rope;
        *rope = *from->rope;
        particles = rope->particles;
        rope->particles = scale_count(rope->particles, share);
        rope->spacing /= share;
        left = rope->particles;
        resized->springs.stiffness *= share;
        resized->springs.bend *= share;
        resized->springs.damping *= share;
        resized->file.rope = rope;
    }
    if (from->springs) resized->file.springs = &resized->springs;
    for (int axis = 0; axis < 3 && from->force; axis++) resized->force[axis] = from->force[axis] * particles / left;
    if (from->force) resized->file.force = resized->force;
}
