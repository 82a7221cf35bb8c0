// Computed truths kept in files: a damaged or foreign one is none.
#include "fuzz.h"

#include "truth_cache.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const ck_Model *model =
        fuzz_model("name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\nsprings: {stiffness: 50}\n"
                   "pins: [first]\ngravity: [0, -9.81, 0]\ntime: {duration: 0.4, step: 0.1}\n"
                   "truth: trajectory\n");
    ck_Truth truth = {.form = ck_truth_form_find(model->truth)};
    FILE *file = size ? fmemopen((void *)data, size, "rb") : NULL;
    if (!file) return 0;
    if (ck_truth_read(&truth, model, file) && (truth.path_count < 1 || truth.reference.horizon < 0)) abort();
    fclose(file);
    ck_truth_free(&truth);
    return 0;
}
