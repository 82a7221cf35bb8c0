// Engines that are commands: whatever one says, its hello is taken or refused, and a run of it has a status and a
// reason. It says the input: up to the line "end" as its hello, and what follows in a run.
#include "fuzz.h"

#include "outside.h"
#include "runner.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const ck_Model *model = fuzz_model("name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\n"
                                       "springs: {stiffness: 50}\npins: [first]\ngravity: [0, -9.81, 0]\n"
                                       "time: {duration: 0.4, step: 0.1}\n");
    const ck_Limits limits = {.seconds = 2, .memory_bytes = (size_t)1 << 30};
    const uint8_t *end = memmem(data, size, "\nend\n", 5), *rest = end ? end + 5 : data;
    ck_Engine *engine = NULL;
    ck_Run run = {0};
    ck_Error error = {0};
    fuzz_write("said", data, end ? (size_t)(rest - data) : size);
    const ck_Status status = ck_outside_command(&engine, "input", "cat said", false, &error);
    if (status && !*error.message) abort();
    fuzz_write("said", rest, size - (size_t)(rest - data));
    if (!status && ck_run_measure(&run, model, engine, &(ck_Settings){0}, &limits, &error)) abort();
    if (!status && !*run.reason) abort();
    ck_run_free(&run);
    if (!status) ck_outside_free(engine);
    return 0;
}
