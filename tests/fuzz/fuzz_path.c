// Files of points that a pin or a collider moves through.
#include "fuzz.h"

#include "path_file.h"

#include <math.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[40];
    double(*points)[4] = NULL;
    int count = 0;
    const int file = fuzz_file(path, data, size);
    if (!ck_path_file_read(&points, &count, path, NULL))
        for (int i = 0; i < 4 * count; i++)
            if (count < 2 || !isfinite(points[i / 4][i % 4])) abort();
    free(points);
    close(file);
    return 0;
}
