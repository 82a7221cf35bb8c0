// Records of a study's cases: what is found in a file that anybody wrote is whole, and can be read.
#include "fuzz.h"

#include "files.h"
#include "store.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[5000];
    ck_Store store;
    ck_StoreFile file = {-1, -1};
    snprintf(path, sizeof path, "%s/a.cases", fuzz_folder());
    FILE *out = fopen(path, "wb");
    if (!out || fwrite(data, 1, size, out) != size || fclose(out)) abort();
    if (ck_store_open(&store, fuzz_folder(), NULL)) abort();
    for (size_t i = 0; i < store.capacity; i++) {
        const ck_StoreEntry *entry = &store.entries[i];
        if (!entry->bytes) continue;
        if (ck_store_find(&store, entry->key) != entry) abort();
        char *text = ck_store_text(&store, entry, &file, NULL);
        if (!text) abort();
        free(text);
    }
    if (file.file >= 0) close(file.file);
    ck_store_free(&store);
    return 0;
}
