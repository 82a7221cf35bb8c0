#include "orders.h"

#include "engines.h"
#include "names.h"
#include "text.h"
#include "vector.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void take_pins(ck_Stage *stage) {
    const ck_Model *model = ck_live_model(stage->live);
    memcpy(stage->pinned, model->pinned, sizeof *stage->pinned * (size_t)model->particle_count);
}

ck_Status ck_stage_begin(ck_Stage *stage, ck_Live *live) {
    *stage = (ck_Stage){.live = live, .held = -1};
    stage->pinned = calloc((size_t)ck_live_model(live)->particle_count, sizeof *stage->pinned);
    if (!stage->pinned) return CK_NO_MEMORY;
    take_pins(stage);
    return CK_OK;
}

void ck_stage_end(ck_Stage *stage) {
    free(stage->pinned);
}

static void say(char *answer, size_t size, const char *kind, const char *text) {
    json_t *object = json_pack("{s:s, s:s}", "kind", kind, "text", text);
    char *dumped = object ? json_dumps(object, JSON_COMPACT) : NULL;
    snprintf(answer, size, "%s", dumped ? dumped : "{\"kind\":\"error\",\"text\":\"out of memory\"}");
    free(dumped);
    json_decref(object);
}

// What a viewer may set. Pins and moves have words of their own.
static bool may_set(const char *key) {
    static const char *const whole[] = {"gravity", "force", "drag", "bending.stiffness"};
    static const char *const below[] = {"springs.", "settings.", "wind.", "material."};
    for (size_t i = 0; i < sizeof whole / sizeof *whole; i++)
        if (!strcmp(key, whole[i])) return true;
    for (size_t i = 0; i < sizeof below / sizeof *below; i++)
        if (!strncmp(key, below[i], strlen(below[i]))) return true;
    return false;
}

static ck_Status set_value(ck_Stage *stage, json_t *order, ck_Error *error) {
    const char *key = json_string_value(json_object_get(order, "key")),
               *value = json_string_value(json_object_get(order, "value"));
    char words[600];
    if (!key || !value || !*value || strlen(key) > 100 || strlen(value) > 400)
        return ck_fail(error, CK_BAD_INPUT, "set takes a key and a value as text");
    if (!may_set(key) || strpbrk(key, "@= \n")) return ck_fail(error, CK_BAD_INPUT, "%s cannot be set here", key);
    if (value[strspn(value, "0123456789.eE+-[], truefalse")])
        return ck_fail(error, CK_BAD_INPUT, "%s takes numbers, lists of them, true or false", key);
    snprintf(words, sizeof words, "@%s=%s", key, value);
    return ck_live_change(stage->live, words, error);
}

// All pins as a change has them, and the one that is dragged on its way. NULL without memory.
//   goal  [3] m, at the frame's end; NULL: nothing moves
static char *pin_words(const ck_Stage *stage, const double *goal) {
    const ck_Model *model = ck_live_model(stage->live);
    ck_Text text;
    if (!ck_text_begin(&text)) return NULL;
    FILE *out = text.file;
    fprintf(out, "@pins=[");
    bool is_first = true;
    for (int i = 0; i < ck_model_cloth_count(model); i++) {
        if (!stage->pinned[i] && !(goal && i == stage->held)) continue;
        fprintf(out, "%s'%d'", is_first ? "" : ", ", i);
        is_first = false;
    }
    const double now = ck_live_frame(stage->live) * model->step;
    fprintf(out, "]@moves=[");
    if (goal)
        fprintf(out, "{pins: ['%d'], path: {towards: [%.17g, %.17g, %.17g], from: %.17g, to: %.17g}}", stage->held,
                goal[0], goal[1], goal[2], now, now + model->step);
    fprintf(out, "]");
    return ck_text_end(&text) ? text.bytes : NULL;
}

static ck_Status change_pins(ck_Stage *stage, const double *goal, ck_Error *error) {
    char *words = pin_words(stage, goal);
    ck_Status status =
        words ? ck_live_change(stage->live, words, error) : ck_fail(error, CK_NO_MEMORY, "out of memory");
    free(words);
    return status;
}

// A particle of the cloth; −1: the order names none.
static int particle_of(const ck_Stage *stage, json_t *order) {
    const json_t *number = json_object_get(order, "particle");
    const json_int_t particle = json_is_integer(number) ? json_integer_value(number) : -1;
    return particle >= 0 && particle < ck_model_cloth_count(ck_live_model(stage->live)) ? (int)particle : -1;
}

static ck_Status pin(ck_Stage *stage, json_t *order, bool locks, ck_Error *error) {
    const int particle = particle_of(stage, order);
    if (particle < 0) return ck_fail(error, CK_BAD_INPUT, "there is no such particle");
    const bool before = stage->pinned[particle];
    stage->pinned[particle] = locks;
    ck_Status status = change_pins(stage, NULL, error);
    if (status) stage->pinned[particle] = before;
    return status;
}

static ck_Status lock(ck_Stage *stage, json_t *order, ck_Error *error) {
    return pin(stage, order, true, error);
}

static ck_Status let_go(ck_Stage *stage, json_t *order, ck_Error *error) {
    return pin(stage, order, false, error);
}

static ck_Status drag(ck_Stage *stage, json_t *order, ck_Error *error) {
    const int particle = particle_of(stage, order);
    json_t *to = json_object_get(order, "to");
    double goal[3];
    for (size_t axis = 0; axis < 3; axis++) {
        goal[axis] = json_number_value(json_array_get(to, axis));
        if (!json_is_number(json_array_get(to, axis)) || !(fabs(goal[axis]) < 1e6))
            return ck_fail(error, CK_BAD_INPUT, "drag takes a place");
    }
    if (particle < 0) return ck_fail(error, CK_BAD_INPUT, "there is no such particle");
    if (stage->held != particle) stage->was_pinned = stage->pinned[particle];
    stage->held = particle;
    memcpy(stage->goal, goal, sizeof goal);
    return CK_OK;
}

static ck_Status drop(ck_Stage *stage, json_t *order, ck_Error *error) {
    (void)order;
    if (stage->held < 0) return CK_OK;
    stage->pinned[stage->held] = stage->was_pinned;
    stage->held = -1;
    stage->moves = false;
    return change_pins(stage, NULL, error);
}

static ck_Status play(ck_Stage *stage, json_t *order, ck_Error *error) {
    (void)order, (void)error;
    stage->plays = true;
    return CK_OK;
}

static ck_Status wait(ck_Stage *stage, json_t *order, ck_Error *error) {
    (void)order, (void)error;
    stage->plays = false;
    return CK_OK;
}

static ck_Status step(ck_Stage *stage, json_t *order, ck_Error *error) {
    (void)order, (void)error;
    stage->plays = false;
    stage->steps = 1;
    return CK_OK;
}

static ck_Status reset(ck_Stage *stage, json_t *order, ck_Error *error) {
    (void)order, (void)error;
    stage->held = -1;
    stage->moves = false;
    ck_live_reset(stage->live);
    take_pins(stage);
    return CK_OK;
}

static ck_Status pace(ck_Stage *stage, json_t *order, ck_Error *error) {
    const double times = json_number_value(json_object_get(order, "times"));
    if (!(times >= 0) || times > 100) return ck_fail(error, CK_BAD_INPUT, "pace takes times from 0 to 100");
    stage->real_time = times;
    return CK_OK;
}

// Frames are where things can be changed and what is saved is counted in, so that others are a session of their own.
static ck_Status rate(ck_Stage *stage, json_t *order, ck_Error *error) {
    const double rate = json_number_value(json_object_get(order, "rate"));
    if (!(rate >= 1) || rate > 1000) return ck_fail(error, CK_BAD_INPUT, "rate takes 1 to 1000 frames a second");
    ck_Status status = ck_live_set_rate(&stage->live, rate, error);
    if (status) return status;
    stage->held = -1;
    stage->moves = false;
    take_pins(stage);
    return CK_OK;
}

static ck_Status save(ck_Stage *stage, json_t *order, ck_Error *error) {
    char name[200];
    const char *asked = json_string_value(json_object_get(order, "name"));
    if (!asked || !*asked || strlen(asked) > 100 || asked[strspn(asked, CK_PLAIN_LETTERS)] || *asked == '.')
        return ck_fail(error, CK_BAD_INPUT,
                       "a name is made of letters, digits, _, - and ., and begins with none of dots");
    snprintf(name, sizeof name, "%s.yaml", asked);
    return ck_live_save(stage->live, stage->folder, name, error);
}

static const struct {
    const char *word;
    ck_Status (*obey)(ck_Stage *stage, json_t *order, ck_Error *error);
    const char *said; // to all
} orders[] = {
    {"play", play, NULL},   {"pause", wait, NULL}, {"step", step, NULL},     {"reset", reset, "back to the start"},
    {"pace", pace, NULL},   {"rate", rate, NULL},  {"set", set_value, NULL}, {"lock", lock, NULL},
    {"free", let_go, NULL}, {"drag", drag, NULL},  {"drop", drop, NULL},     {"save", save, NULL},
};

// The command that does the same again, with the same engines under the same names.
static void say_saved(char *answer, size_t size, const ck_Stage *stage, const char *name) {
    ck_Text text;
    if (!ck_text_begin(&text)) {
        say(answer, size, "error", "out of memory");
        return;
    }
    fprintf(text.file, "clothcheck compare %s/%s.yaml", stage->folder, name);
    for (int i = 0; i < ck_live_count(stage->live); i++) {
        const ck_Engine *engine = ck_live_engine(stage->live, i)->engine, *original = ck_engine_original(engine);
        fprintf(text.file, " -e %s", engine->name);
        if (original) fprintf(text.file, "=%s", original->name);
    }
    const bool has = ck_text_end(&text);
    say(answer, size, has ? "saved" : "error", has ? text.bytes : "out of memory");
    if (has) free(text.bytes);
}

bool ck_stage_obey(ck_Stage *stage, const char *message, size_t length, char *answer, size_t size) {
    json_error_t where;
    json_t *order = json_loadb(message, length, JSON_REJECT_DUPLICATES, &where);
    const char *word = json_string_value(json_object_get(order, "do"));
    ck_Error error = {0};
    ck_Status status = CK_BAD_INPUT;
    size_t i = 0;
    *answer = 0;
    while (word && i < sizeof orders / sizeof *orders && strcmp(orders[i].word, word)) i++;
    if (!word || i == sizeof orders / sizeof *orders)
        ck_fail(&error, CK_BAD_INPUT, "there is no such order");
    else
        status = orders[i].obey(stage, order, &error);
    if (status)
        say(answer, size, "error", error.message);
    else if (!strcmp(word, "save"))
        say_saved(answer, size, stage, json_string_value(json_object_get(order, "name")));
    else if (orders[i].said)
        say(answer, size, "said", orders[i].said);
    json_decref(order);
    return !status && orders[i].said;
}

void ck_stage_step(ck_Stage *stage) {
    const ck_Model *model = ck_live_model(stage->live);
    if (stage->held >= 0 && ck_live_count(stage->live)) {
        // where the first engine that runs has it
        int first = 0;
        while (first + 1 < ck_live_count(stage->live) && !ck_live_engine(stage->live, first)->runs) first++;
        const double *at = ck_trajectory_position(&ck_live_engine(stage->live, first)->shown, 0) + 3 * stage->held;
        double way[3], goal[3];
        ck_subtract(way, stage->goal, at);
        const double far = ck_length(way), most = CK_STAGE_FASTEST * model->size * model->step;
        memcpy(goal, at, sizeof goal);
        ck_add_scaled(goal, far > most ? most / far : 1, way);
        const bool moves = far > 1e-6 * model->size;
        // one that is held still needs no new path
        if (moves || stage->moves || !stage->pinned[stage->held]) {
            stage->pinned[stage->held] = true;
            change_pins(stage, goal, NULL);
        }
        stage->moves = moves;
    }
    ck_live_step(stage->live);
}
