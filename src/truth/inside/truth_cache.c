#include "truth_cache.h"

#include "equilibrium.h"
#include "files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

// Changes whenever a truth of the same model would come out different, or the layout does.
#define FORMAT "clothcheck truth 5\n\0\0\0\0"

typedef struct Header {
    char format[24];
    uint64_t model, data; // hashes
    int32_t path_count, particle_count, horizon, frame_counts[CK_TRUTH_MAX_PATHS], unused;
} Header;

uint64_t ck_truth_cache_hash(const ck_Model *model) {
    return ck_hash(ck_model_hash(model), model->truth, strlen(model->truth));
}

static size_t path_bytes(const ck_Model *model, int frames) {
    return 6 * sizeof(double) * (size_t)model->particle_count * (size_t)frames;
}

static bool is_header_sound(const Header *header, const ck_Truth *truth, const ck_Model *model) {
    bool sound = !memcmp(header->format, FORMAT, sizeof header->format) &&
                 header->model == ck_truth_cache_hash(model) && header->particle_count == model->particle_count &&
                 header->path_count >= 1 && header->path_count <= CK_TRUTH_MAX_PATHS;
    int most = truth->form->is_static ? 1 : model->frame_count + 1;
    for (int i = 0; sound && i < CK_TRUTH_MAX_PATHS; i++)
        sound = i < header->path_count ? header->frame_counts[i] >= 1 && header->frame_counts[i] <= most
                                       : !header->frame_counts[i];
    return sound && !header->unused && header->horizon >= 0 &&
           header->horizon < (truth->form->is_static ? 1 : header->frame_counts[0]);
}

// Reads the paths and holds them against the header's hash.
static bool read_paths(ck_Truth *loaded, const Header *header, const ck_Model *model, FILE *file) {
    uint64_t value = CK_HASH_START;
    for (int i = 0; i < header->path_count; i++) {
        ck_Trajectory *path = &loaded->paths[i];
        ck_Model frames = *model;
        frames.frame_count = header->frame_counts[i] - 1;
        if (ck_trajectory_create(path, &frames, NULL)) return false;
        loaded->path_count = i + 1;
        if (fread(path->data, 1, path->bytes, file) != path->bytes) return false;
        path->frame_count = header->frame_counts[i];
        value = ck_hash(value, path->data, path->bytes);
    }
    return value == header->data && fgetc(file) == EOF;
}

static void name_of(char *name, size_t size, const ck_Model *model) {
    snprintf(name, size, "%016llx.truth", (unsigned long long)ck_truth_cache_hash(model));
}

bool ck_truth_read(ck_Truth *truth, const ck_Model *model, FILE *file) {
    Header header;
    ck_Truth loaded = {.form = truth->form};
    bool sound = fread(&header, sizeof header, 1, file) == 1 && is_header_sound(&header, truth, model) &&
                 read_paths(&loaded, &header, model, file);
    if (!sound) {
        ck_truth_free(&loaded);
        return false;
    }
    memcpy(truth->paths, loaded.paths, sizeof loaded.paths);
    truth->path_count = loaded.path_count;
    truth->reference.horizon = header.horizon;
    return true;
}

// What a file says of an equilibrium is held against its own forces.
static bool balances(const ck_Truth *truth, const ck_Model *model) {
    if (!truth->form->is_static) return true;
    const double residual = ck_equilibrium_residual(model, truth->paths[0].data);
    return residual >= 0 && residual <= ck_equilibrium_tolerance(model);
}

bool ck_truth_cache_load(ck_Truth *truth, const ck_Model *model, const char *directory) {
    char name[40];
    name_of(name, sizeof name, model);
    char *path = ck_path_join(directory, name);
    FILE *file = path ? fopen(path, "rb") : NULL;
    free(path);
    if (!file) return false;
    ck_Truth loaded = {.form = truth->form};
    bool is_there = ck_truth_read(&loaded, model, file) && balances(&loaded, model);
    fclose(file);
    if (is_there) {
        memcpy(truth->paths, loaded.paths, sizeof loaded.paths);
        truth->path_count = loaded.path_count;
        truth->reference.horizon = loaded.reference.horizon;
    } else {
        ck_truth_free(&loaded);
    }
    return is_there;
}

void ck_truth_write(const ck_Truth *truth, const ck_Model *model, FILE *file) {
    Header header = {.format = FORMAT,
                     .model = ck_truth_cache_hash(model),
                     .data = CK_HASH_START,
                     .path_count = truth->path_count,
                     .particle_count = model->particle_count,
                     .horizon = truth->reference.horizon};
    for (int i = 0; i < truth->path_count; i++) {
        header.frame_counts[i] = truth->paths[i].frame_count;
        header.data = ck_hash(header.data, truth->paths[i].data, path_bytes(model, truth->paths[i].frame_count));
    }
    fwrite(&header, sizeof header, 1, file);
    for (int i = 0; i < truth->path_count; i++)
        fwrite(truth->paths[i].data, 1, path_bytes(model, truth->paths[i].frame_count), file);
}

ck_Status ck_truth_cache_save(const ck_Truth *truth, const ck_Model *model, const char *directory) {
    char name[40];
    ck_WholeFile whole;
    name_of(name, sizeof name, model);
    ck_Status status = ck_whole_file_open(&whole, directory, name, NULL);
    if (!status) {
        ck_truth_write(truth, model, whole.file);
        status = ck_whole_file_close(&whole, NULL);
    }
    ck_whole_file_discard(&whole);
    return status;
}
