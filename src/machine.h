// What a timing depends on beside the code: processor, compiler, versions, date.
#ifndef CK_MACHINE_H
#define CK_MACHINE_H

#include "csv_file.h"

// Adds rows of key and value.
void ck_machine_write(ck_Csv *csv);

#endif
