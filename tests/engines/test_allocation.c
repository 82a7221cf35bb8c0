// No native engine asks for memory while it steps. Linked with malloc and its kin wrapped, which counts them.
#include "fixture.h"

static long count;

void *__real_malloc(size_t size);
void *__real_calloc(size_t many, size_t size);
void *__real_realloc(void *old, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);

void *__wrap_malloc(size_t size) {
    count++;
    return __real_malloc(size);
}

void *__wrap_calloc(size_t many, size_t size) {
    count++;
    return __real_calloc(many, size);
}

void *__wrap_realloc(void *old, size_t size) {
    count++;
    return __real_realloc(old, size);
}

void *__wrap_aligned_alloc(size_t alignment, size_t size) {
    count++;
    return __real_aligned_alloc(alignment, size);
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

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_steps)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
