// No native engine asks for memory while it steps, and none falls over where there is none when a pin is let go. Linked
// with malloc and its kin wrapped, which counts and refuses.
#include "fixture.h"

static long count;
static bool has_none;

void *__real_malloc(size_t size);
void *__real_calloc(size_t many, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size) {
    count++;
    return has_none ? NULL : __real_malloc(size);
}

void *__wrap_calloc(size_t many, size_t size) {
    count++;
    return has_none ? NULL : __real_calloc(many, size);
}

void *__wrap_realloc(void *old, size_t size) {
    count++;
    return has_none ? NULL : __real_realloc(old, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    count++;
    return has_none ? NULL : __real_aligned_alloc(alignment, size);
}

static void count_in_steps(const ck_Model *model) {
    for (int i = 0; i < ck_engine_count(); i++) {
        const ck_Engine *engine = ck_engine_at(i);
        ck_Settings used, wanted = {.substeps = 8};
        void *state;
        if (strcmp(engine->family, "native") || engine->method == CK_METHOD_STILL || (model->terms & ~engine->terms))
            continue;
        long before = count;
        if (ck_engine_create(engine, &state, model, &wanted, &used, NULL, NULL)) continue;
        assert_true(count > before); // the counter sees the library
        before = count;
        for (int frame = 0; frame < 3; frame++) assert_int_equal(engine->step(state), CK_STEP_OK);
        if (count != before)
            fail_msg("%s on %s: %ld allocations in 3 frames", engine->name, model->name, count - before);
        engine->destroy(state);
    }
}

static void test_steps(void **state) {
    (void)state;
    static const char *const scenes[] = {"cloth_two_corners", "rope_hanging", "rope_heavy_end", "cloth_on_sphere",
                                         "cloth_flag"};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        Fixture fixture;
        char path[200];
        snprintf(path, sizeof path, SCENE_DIRECTORY "/%s.yaml", scenes[i]);
        assert_int_equal(fixture_open(&fixture, path, NULL), CK_OK);
        count_in_steps(&fixture.model);
        fixture_free(&fixture);
    }
}

// What lays a cloth out anew then has no room for it: the engine goes on without, or says that it cannot.
static void test_release_without_memory(void **state) {
    (void)state;
    Fixture fixture;
    fixture_load(&fixture, "name: cloth\ncloth: {rows: 9, columns: 9, spacing: 0.1, mass: 1, down: [0, 0, 1]}\n"
                           "springs: {stiffness: 300}\npins: [top_left, top_right]\ngravity: [0, -9.81, 0]\n"
                           "colliders: [{plane: {point: [0, -0.1, 0], normal: [0, 1, 0], friction: 0.5}}]\n"
                           "time: {duration: 1, step: 0.02}\n");
    const ck_Model *model = &fixture.model;
    double *position = malloc(6 * sizeof(double) * (size_t)model->particle_count);
    for (int i = 0; i < ck_engine_count(); i++)
        for (int single = 0; single < 2; single++) {
            const ck_Engine *engine = ck_engine_at(i);
            ck_Settings used, wanted = {.substeps = 40};
            void *created;
            if (strcmp(engine->family, "native") || !engine->release) continue;
            if (single && !ck_setting_find(engine->settings, "single")) continue;
            if (single) ck_settings_set(&wanted, ck_setting_find(engine->settings, "single")->slot, 1);
            if (ck_engine_create(engine, &created, model, &wanted, &used, NULL, NULL)) continue;
            for (int frame = 0; frame < 5; frame++) assert_int_equal(engine->step(created), CK_STEP_OK);
            has_none = true;
            engine->release(created, model->columns - 1);
            has_none = false;
            for (int frame = 0; frame < 5; frame++)
                if (engine->step(created) == CK_STEP_OK) {
                    engine->read(created, position, position + 3L * model->particle_count);
                    assert_true(position[3L * (model->columns - 1) + 1] <= 0);
                }
            engine->destroy(created);
        }
    free(position);
    fixture_free(&fixture);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steps), cmocka_unit_test(test_release_without_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
