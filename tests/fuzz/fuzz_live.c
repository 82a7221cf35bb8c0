// Messages to a live session, one a line: each is obeyed or refused in words, and the session goes on.
#include "fuzz.h"

#include "engines.h"
#include "orders.h"

static ck_Stage *begin(void) {
    static ck_Stage stage;
    static ck_Live *live;
    const ck_Engine *engine = ck_engine_find("native-verlet");
    const ck_Limits limits = {.seconds = 5, .memory_bytes = (size_t)1 << 30};
    if (live) return &stage;
    static const char scene[] = "name: r\ncloth: {rows: 2, columns: 3, spacing: 0.1, mass: 1}\n"
                                "springs: {stiffness: 50}\npins: [top_left]\ngravity: [0, -9.81, 0]\n"
                                "time: {duration: 0.4, step: 0.1}\n";
    fuzz_write("scene.yaml", (const uint8_t *)scene, sizeof scene - 1);
    if (ck_live_start(&live, "scene.yaml", &engine, &(ck_Settings){0}, 1, &limits, NULL) ||
        ck_stage_begin(&stage, live))
        abort();
    stage.folder = ".";
    return &stage;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    ck_Stage *stage = begin();
    const char *text = (const char *)data;
    while (size) {
        const char *end = memchr(text, '\n', size);
        const size_t length = end ? (size_t)(end - text) : size;
        char answer[1000];
        ck_stage_obey(stage, text, length, answer, sizeof answer);
        if (stage->held >= ck_model_cloth_count(ck_live_model(stage->live))) abort();
        if (stage->steps) ck_stage_step(stage);
        stage->steps = 0;
        size -= length + (end ? 1 : 0);
        text += length + (end ? 1 : 0);
    }
    ck_stage_obey(stage, "{\"do\": \"reset\"}", 15, (char[1000]){0}, 1000);
    return 0;
}
