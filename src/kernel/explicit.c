#include "explicit.h"

#include "explicit_kind.h"

static ck_Status create(ck_Explicit **body, const ck_ExplicitKind *kind, const ck_ExplicitSetup *setup,
                        ck_Error *error) {
    ck_Status status = kind->create(body, setup, error);
    if (!status) (*body)->kind = kind;
    return status;
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

void ck_explicit_kick(ck_Explicit *body) {
    body->kind->kick(body);
}

bool ck_explicit_drift(ck_Explicit *body, const ck_NearSurface *surfaces, int count, ck_Near *near, ck_Loose *loose) {
    return body->kind->drift(body, surfaces, count, near, loose);
}

void ck_explicit_take(const ck_Explicit *body, const ck_Near *near, const ck_Loose *loose) {
    body->kind->take(body, near, loose);
}

void ck_explicit_put(const ck_Explicit *body, const ck_Near *near, const ck_Loose *loose, bool is_kicked) {
    body->kind->put(body, near, loose, is_kicked);
}

void ck_explicit_read(const ck_Explicit *body, double *position, double *velocity) {
    body->kind->read(body, position, velocity);
}
