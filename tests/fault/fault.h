/*
 * Makes the n-th allocation, or the n-th OpenCL call, of the library fail. The linker's --wrap puts
 * these in the place of the real ones, for asdic's own code only: what libraries below it allocate
 * is theirs.
 */
#ifndef ASDIC_TESTS_FAULT_H
#define ASDIC_TESTS_FAULT_H

#include <stdbool.h>

typedef enum fault_kind { FAULT_ALLOCATION, FAULT_OPENCL, FAULT_THREAD } fault_kind;

/* From now on the NTH call of this kind fails, counted from 1, once. */
void fault_arm(fault_kind kind, long nth);

/* Ends it; whether the call came at all. */
bool fault_disarm(void);

/* Whether commands went to a queue since the host last waited for one. */
bool fault_pending(void);

/* How many contexts, queues, buffers, programs and kernels of OpenCL there are. */
long fault_alive(void);

#endif
