#include "explicit.h"

#include "explicit_kind.h"

static ck_Status create(ck_Explicit **body, const ck_ExplicitKind *kind, const ck_ExplicitSetup *setup,
                        ck_Error *error) {
    ck_Status status = kind->create(body, setup, error);
    if (status) return status;
    (*body)->kind = kind;
    (*body)->is_placed = true;
    return CK_OK;
}

ck_Status ck_explicit_create(ck_Explicit **body, const ck_ExplicitSetup *setup, ck_Error *error) {
    ck_RowSprings springs;
    const bool is_regular = ck_rows_fit(setup->model, &springs);
    const ck_ExplicitKind *rows = setup->loops->is_single ? &ck_explicit_rows_single : &ck_explicit_rows;
    return create(body, is_regular ? rows : &ck_explicit_list, setup, error);
}

ck_Status ck_explicit_create_list(ck_Explicit **body, const ck_ExplicitSetup *setup, ck_Error *error) {
    return create(body, &ck_explicit_list, setup, error);
}

void ck_explicit_place(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    body->is_placed = true;
    body->kind->place(body, setup);
}

void ck_explicit_pace(ck_Explicit *body, const ck_ExplicitSetup *setup) {
    body->kind->pace(body, setup);
}

const double *ck_explicit_acceleration(const ck_Explicit *body, size_t *count) {
    return body->kind->acceleration(body, count);
}

void ck_explicit_destroy(ck_Explicit *body) {
    if (body) body->kind->destroy(body);
}

void ck_explicit_step(ck_Explicit *body, uint32_t substeps, ck_Waves *waves) {
    body->kind->step(body, substeps, waves);
}

// Strays beyond which what is loose is taken anew, in the order of its places.
static bool is_strewn(const ck_Loose *loose) {
    return loose->strays > 32 + loose->count / 8;
}

void ck_explicit_drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose) {
    const bool is_anew = body->is_placed || is_strewn(loose);
    if (is_anew) loose->count = 0;
    const int before = loose->count;
    body->kind->drift(body, surfaces, count, loose, is_anew);
    loose->strays = is_anew ? 0 : loose->strays + loose->count - before;
    body->is_placed = false;
}

void ck_explicit_kick(ck_Explicit *body, ck_Loose *loose) {
    body->kind->kick(body);
    body->kind->take(body, loose, loose->count);
}

void ck_explicit_turn(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Loose *loose) {
    const int before = loose->count;
    body->kind->turn(body, surfaces, count, loose);
    body->kind->take(body, loose, before);
    loose->strays += loose->count - before;
}

void ck_explicit_put(const ck_Explicit *body, const ck_Loose *loose, bool is_kicked) {
    body->kind->put(body, loose, is_kicked);
}

static void copy(const ck_Loose *loose, double *vectors, int to, int from) {
    for (int axis = 0; axis < 3; axis++) vectors[axis * loose->stride + to] = vectors[axis * loose->stride + from];
}

// The last one takes the place of one that leaves.
void ck_explicit_leave(ck_Explicit *body, ck_Loose *loose) {
    for (int i = loose->count - 1; i >= 0; i--) {
        if (!(loose->is_alone[i] < 0)) continue;
        const int last = --loose->count;
        body->kind->leave(body, loose, i);
        double *vectors[] = {loose->x, loose->v, loose->a, loose->predicted, loose->normal};
        double *numbers[] = {loose->mass, loose->curvature, loose->friction, loose->is_alone};
        for (size_t k = 0; k < sizeof vectors / sizeof *vectors; k++) copy(loose, vectors[k], i, last);
        for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) numbers[k][i] = numbers[k][last];
        loose->place[i] = loose->place[last];
        loose->strays += i < last;
    }
}

void ck_explicit_read(const ck_Explicit *body, double *position, double *velocity) {
    body->kind->read(body, position, velocity);
}
