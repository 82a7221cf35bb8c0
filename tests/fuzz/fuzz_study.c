// Studies: whatever a file holds is a study whose axes have all their values, or an error that says where.
#include "fuzz.h"

#include "study_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40];
    ck_StudyFile study;
    ck_Error error = {0};
    const int file = fuzz_file(path, data, size);
    ck_Status status = ck_study_file_load(&study, path, &error);
    if (status == CK_BAD_INPUT && strncmp(error.message, path, strlen(path))) abort();
    for (int i = 0; i < study.axis_count && !status; i++)
        for (int k = 0; k < study.axes[i].key_count * study.axes[i].value_count; k++)
            if (!study.axes[i].values[k]) abort();
    ck_study_file_free(&study);
    close(file);
    return 0;
}
