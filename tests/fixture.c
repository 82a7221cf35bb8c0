#include "fixture.h"

#include <unistd.h>

char *fixture_file(const char *text) {
    char *path = strdup("/tmp/clothcheck-XXXXXX");
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, text, strlen(text)), strlen(text));
    close(file);
    return path;
}

void fixture_load(ck_Comparison *comparison, const char *text) {
    ck_Error error = {0};
    char *path = fixture_file(text);
    if (ck_comparison_load(comparison, path, &error)) fail_msg("%s", error.message);
    unlink(path);
    free(path);
    comparison->path = "text";
}

void fixture_run(ck_Trajectory *trajectory, const ck_Model *model, const ck_Engine *engine, const ck_Settings *settings,
                 ck_Settings *used) {
    ck_Error error = {0};
    ck_Settings automatic = {0}, ignored;
    void *state;
    if (engine->create(&state, model, settings ? settings : &automatic, used ? used : &ignored, NULL, &error))
        fail_msg("%s on %s: %s", engine->name, model->name, error.message);
    assert_int_equal(ck_trajectory_create(trajectory, model, &error), CK_OK);
    for (int frame = 0; frame <= model->frame_count; frame++) {
        if (frame && ck_engine_advance(engine, state, model, frame - 1) != CK_STEP_OK)
            fail_msg("%s on %s did not reach frame %d", engine->name, model->name, frame);
        ck_engine_read(engine, state, trajectory, frame);
        trajectory->frame_count = frame + 1;
    }
    engine->destroy(state);
}

bool fixture_supports(const ck_Engine *engine, const ck_Model *model) {
    return !(model->terms & ~engine->terms);
}

void assert_near(const char *what, double value, double wanted, double tolerance) {
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%s is %.17g, wanted %.17g within %.3g, off by %.3g", what, value, wanted, tolerance,
                 fabs(value - wanted));
}

bool fixture_is_solver(const ck_Engine *engine) {
    return engine->method != CK_METHOD_NONE && engine->method != CK_METHOD_SEED;
}

bool fixture_takes(const ck_Engine *engine, const ck_Model *model) {
    ck_Settings automatic = {0}, used;
    void *state;
    if (!fixture_supports(engine, model) || engine->create(&state, model, &automatic, &used, NULL, NULL)) return false;
    engine->destroy(state);
    return true;
}
