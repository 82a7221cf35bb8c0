// Where a case runs, for its row.
#ifndef CK_PROVENANCE_H
#define CK_PROVENANCE_H

const char *ck_host(void);      // its name, plain
const char *ck_processor(void); // as the system calls it

#endif
