// What a timing depends on beside the code: processor, compiler, versions, how libraries were built, date.
#ifndef CK_MACHINE_H
#define CK_MACHINE_H

#include "csv_writer.h"

// Tells one fact after the other, the date last.
typedef void (*ck_MachineFact)(void *context, const char *key, const char *value);
void ck_machine_tell(ck_MachineFact tell, void *context);

// Adds rows of key and value.
void ck_machine_write(ck_Csv *csv);

// Writes machine.csv into a directory. Errors: CK_IO, CK_NO_MEMORY.
ck_Status ck_machine_save(const char *directory, ck_Error *error);

#endif
