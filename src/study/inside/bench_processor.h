// What the processor can do, whatever an engine makes of it.
#ifndef CK_BENCH_PROCESSOR_H
#define CK_BENCH_PROCESSOR_H

#include "csv_writer.h"
#include "status.h"

// Adds the rows operations_peak, 1/s, at best: what no loop here can beat; and round_trip, s: from one of two threads
// to the other and back, which are as near to each other as the system places them. Threads that share a third cache
// are some 0.1 µs apart, others 0.6. Errors: CK_NO_MEMORY.
ck_Status ck_bench_add_processor(ck_Csv *csv, double *operations_peak, ck_Error *error);

#endif
