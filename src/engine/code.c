#include "code.h"

#include "engine.h"
#include "scaled_model.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The deepest that parts nest.
#define MOST_PARTS 8

void ck_code_text(ck_Code *code, const char *name, const char *text) {
    ck_CodeValue *value = &code->values[code->value_count++];
    snprintf(value->name, sizeof value->name, "%s", name);
    snprintf(value->text, sizeof value->text, "%s", text);
}

static const char *number_text(char *text, size_t size, double number) {
    if (isinf(number)) return "INFINITY";
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, size, "%.*g", digits, number);
        if (strtod(text, NULL) == number) break;
    }
    return text;
}

void ck_code_number(ck_Code *code, const char *name, double number) {
    char text[40];
    ck_code_text(code, name, number_text(text, sizeof text, number));
}

void ck_code_part(ck_Code *code, const char *name, bool is_in) {
    ck_code_text(code, name, is_in ? "1" : "");
}

void ck_code_free(ck_Code *code) {
    free(code->order);
    *code = (ck_Code){0};
}

static const char *value_of(const ck_Code *code, const char *name, size_t length) {
    for (int i = 0; i < code->value_count; i++)
        if (strlen(code->values[i].name) == length && !strncmp(code->values[i].name, name, length))
            return code->values[i].text;
    return NULL;
}

static void set_vector(ck_Code *code, const char *name, const double *vector) {
    char text[3][40], all[120];
    const char *parts[3];
    for (int axis = 0; axis < 3; axis++) parts[axis] = number_text(text[axis], sizeof text[axis], vector[axis]);
    snprintf(all, sizeof all, "{%s, %s, %s}", parts[0], parts[1], parts[2]);
    ck_code_text(code, name, all);
}

static int count_releases(const ck_Model *model) {
    int count = 0;
    for (int i = 0; i < model->release_count; i++) count += model->releases[i].particle_count;
    return count;
}

static void set_settings(ck_Code *code, const ck_Engine *engine, const ck_Settings *used) {
    char text[120] = "";
    size_t length = 0;
    for (const ck_Setting *row = engine->settings; row && row->name && length < sizeof text; row++)
        if (ck_settings_has(used, row->slot))
            length += (size_t)snprintf(text + length, sizeof text - length, "%s%s %.9g", length ? ", " : "", row->name,
                                       ck_settings_get(used, row->slot));
    ck_code_text(code, "settings", text);
}

// What every engine's program needs of a model in its own units.
static void set_model(ck_Code *code, const ck_Engine *engine, const ck_ScaledModel *scaled, const ck_Settings *used,
                      const char *path) {
    const ck_Model *model = &scaled->model;
    char file[100];
    ck_code_text(code, "scene", model->name);
    ck_code_text(code, "engine", engine->name);
    ck_code_text(code, "path", path);
    snprintf(file, sizeof file, "%.80s.%s", model->name, code->extension);
    ck_code_text(code, "file", file);
    set_settings(code, engine, used);
    ck_code_number(code, "length", scaled->length);
    ck_code_number(code, "mass", scaled->mass);
    ck_code_number(code, "frames", model->frame_count);
    ck_code_number(code, "frame", model->step);
    ck_code_number(code, "substeps", used->substeps);
    ck_code_number(code, "iterations", used->iterations);
    ck_code_number(code, "particles", model->particle_count);
    ck_code_number(code, "springs", model->spring_count);
    ck_code_number(code, "spring_room", model->spring_count ? model->spring_count : 1);
    ck_code_number(code, "colliders", model->collider_count);
    ck_code_number(code, "releases", count_releases(model));
    set_vector(code, "gravity", model->gravity);
    set_vector(code, "force_vector", model->force);
    ck_code_number(code, "drag_rate", model->drag);
    ck_code_part(code, "contact", model->collider_count > 0);
    ck_code_part(code, "damping", model->terms & CK_TERM_DAMPING);
    ck_code_part(code, "drag", model->terms & CK_TERM_DRAG);
    ck_code_part(code, "damped", model->terms & (CK_TERM_DAMPING | CK_TERM_DRAG));
    ck_code_part(code, "force", model->terms & CK_TERM_FORCE);
    ck_code_part(code, "release", model->release_count > 0);
    ck_code_part(code, "rigid", model->terms & CK_TERM_RIGID);
}

static void write_vector(FILE *out, const double *vector, const char *after) {
    char text[3][40];
    const char *parts[3];
    for (int axis = 0; axis < 3; axis++) parts[axis] = number_text(text[axis], sizeof text[axis], vector[axis]);
    fprintf(out, "{%s, %s, %s}%s", parts[0], parts[1], parts[2], after);
}

static void write_numbers(FILE *out, const double *numbers, int count, const char *after) {
    char text[40];
    for (int i = 0; i < count; i++) fprintf(out, "%s%s", i ? ", " : "", number_text(text, sizeof text, numbers[i]));
    fprintf(out, "%s", after);
}

static void write_bodies(FILE *out, const ck_Code *code, const ck_Model *model) {
    fprintf(out, "// at, velocity, mass, pinned\nconst struct Particle particles[PARTICLES] = {\n");
    for (int i = 0; i < model->particle_count; i++) {
        fprintf(out, "    {");
        write_vector(out, model->position + 3 * i, ", ");
        write_vector(out, model->velocity + 3 * i, ", ");
        write_numbers(out, &model->mass[i], 1, model->pinned[i] ? ", 1},\n" : ", 0},\n");
    }
    fprintf(out, "};\n\n// two particles, length at rest, stiffness, damping\n"
                 "const struct Spring springs[] = {\n");
    for (int i = 0; i < model->spring_count; i++) {
        const ck_Spring *spring = &model->springs[code->order ? code->order[i] : i];
        const double numbers[] = {spring->rest, spring->stiffness, spring->damping};
        fprintf(out, "    {%d, %d, ", spring->a, spring->b);
        write_numbers(out, numbers, 3, "},\n");
    }
    fprintf(out, model->spring_count ? "};\n" : "    {0, 0, 0, 0, 0},\n};\n");
}

static void write_tables(FILE *out, const ck_Code *code, const ck_Model *model) {
    write_bodies(out, code, model);
    if (model->collider_count)
        fprintf(out, "\n// ball or not, point, normal, radius, restitution, friction\n"
                     "const struct Collider colliders[COLLIDERS] = {\n");
    for (int i = 0; i < model->collider_count; i++) {
        const ck_Collider *collider = &model->colliders[i];
        const double numbers[] = {collider->radius, collider->restitution, collider->friction};
        fprintf(out, "    {%d, ", collider->shape == CK_SPHERE);
        write_vector(out, collider->point, ", ");
        write_vector(out, collider->normal, ", ");
        write_numbers(out, numbers, 3, "},\n");
    }
    if (model->collider_count) fprintf(out, "};\n");
    if (!model->release_count) return;
    fprintf(out, "\n// before the step of a frame, a particle\nconst struct Release releases[] = {\n");
    for (int i = 0; i < model->release_count; i++)
        for (int k = 0; k < model->releases[i].particle_count; k++)
            fprintf(out, "    {%d, %d},\n", model->releases[i].frame, model->releases[i].particles[k]);
    fprintf(out, "};\n");
}

// A line with its gaps filled.
static void write_line(FILE *out, const ck_Code *code, const char *line, size_t length) {
    while (length) {
        const char *gap = memchr(line, '@', length);
        size_t before = gap ? (size_t)(gap - line) : length;
        fwrite(line, 1, before, out);
        if (!gap) return;
        const char *end = memchr(gap + 1, '@', length - before - 1);
        const char *text = end ? value_of(code, gap + 1, (size_t)(end - gap - 1)) : NULL;
        if (text) {
            fputs(text, out);
            length -= (size_t)(end + 1 - line);
            line = end + 1;
        } else {
            fputc('@', out);
            length -= before + 1;
            line = gap + 1;
        }
    }
}

static bool has_part(const ck_Code *code, const char *name, size_t length) {
    const char *text = value_of(code, name, length);
    return text && *text;
}

static void fill(FILE *out, const ck_Code *code, const ck_Model *model) {
    bool is_in[MOST_PARTS] = {true};
    int depth = 0;
    for (const char *line = code->text; *line;) {
        size_t length = strcspn(line, "\n");
        if (!strncmp(line, "//: if ", 7) && depth + 1 < MOST_PARTS) {
            depth++;
            is_in[depth] = is_in[depth - 1] && has_part(code, line + 7, length - 7);
        } else if (!strncmp(line, "//: else", 8) && depth) {
            is_in[depth] = is_in[depth - 1] && !is_in[depth];
        } else if (!strncmp(line, "//: end", 7) && depth) {
            depth--;
        } else if (!strncmp(line, "//: data", 8)) {
            if (model) write_tables(out, code, model);
        } else if (is_in[depth]) {
            write_line(out, code, line, length);
            fputc('\n', out);
        }
        line += length + (line[length] == '\n');
    }
}

void ck_code_fill(FILE *out, const ck_Code *code) {
    fill(out, code, NULL);
}

bool ck_code_knows(const ck_Engine *engine, const ck_Model *model) {
    const unsigned beyond = CK_TERM_BENDING | CK_TERM_WIND | CK_TERM_PULL_ONLY | CK_TERM_MOVES |
                            CK_TERM_MOVING_COLLIDERS | CK_TERM_SOLIDS | CK_TERM_BODIES | CK_TERM_JITTER |
                            CK_TERM_CHANGES;
    return engine->code && !(model->terms & beyond);
}

ck_Status ck_code_write(FILE *out, const ck_Engine *engine, const ck_Model *model, const ck_Settings *used,
                        const char *path, ck_Error *error) {
    ck_Code code = {0};
    ck_ScaledModel scaled = {0};
    if (!engine->code) return ck_fail(error, CK_BAD_INPUT, "%s has no program to paste", engine->name);
    if (!ck_code_knows(engine, model))
        return ck_fail(error, CK_BAD_INPUT,
                       "%s: the programs to paste know no bending, no wind, no slack springs, no solids but balls, no "
                       "rigid bodies, no uneven steps and nothing that moves; "
                       "leave them out",
                       model->name);
    ck_Status status = ck_scaled_model_create(&scaled, model);
    if (status) return ck_fail(error, status, "out of memory");
    status = engine->code(&code, &scaled, used, error);
    if (!status) {
        set_model(&code, engine, &scaled, used, path);
        fill(out, &code, &scaled.model);
        if (fflush(out) || ferror(out)) status = ck_fail(error, CK_IO, "cannot write the program: %s", strerror(errno));
    }
    ck_code_free(&code);
    ck_scaled_model_free(&scaled);
    return status;
}
