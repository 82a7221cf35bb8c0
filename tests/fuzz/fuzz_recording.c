// Positions that another program recorded, as CSV or as NumPy writes them.
#include "fuzz.h"

#include "recording.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    const ck_Model *model =
        fuzz_model("name: r\nrope: {particles: 3, spacing: 0.1, mass: 1}\ntime: {duration: 0.4, step: "
                   "0.1}\n");
    char path[40];
    ck_Recording recording;
    const int file = fuzz_file(path, data, size);
    if (!ck_recording_read(&recording, path, model, 0, NULL))
        for (int i = 0; i < recording.point_count; i++)
            if (recording.points[i].particle < 0 || recording.points[i].particle >= model->particle_count ||
                !(recording.points[i].time >= 0))
                abort();
    ck_recording_free(&recording);
    close(file);
    return 0;
}
