#include "constraint_kind.h"
#include "row_contact.h"

#include <stdlib.h>

ck_Status ck_sixteens_create(ck_ProjectionHead *head, const ck_RowContact *beside, const ck_Follower *follower,
                             long places, ck_Error *error) {
    head->seen = calloc((size_t)beside->touched.count, sizeof *head->seen);
    if (!head->seen) return ck_fail(error, CK_NO_MEMORY, "out of memory");
    return ck_row_contact_create(&head->contact, beside->loops, &beside->touched, follower, (int)places, error);
}

void ck_sixteens_see(ck_ProjectionHead *head, const double origin[3], double size) {
    if (!head->contact) return;
    const ck_Touched *touched = &head->contact->touched;
    for (int i = 0; i < touched->count; i++) head->seen[i] = ck_lane_surface(&touched->surfaces[i], origin, size);
}
