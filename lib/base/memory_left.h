/*
 * How much memory the process can still have.
 */
#ifndef ASDIC_BASE_MEMORY_LEFT_H
#define ASDIC_BASE_MEMORY_LEFT_H

#include <asdic/context.h>

#include <stdint.h>

/* Bytes that can be allocated without swapping, as the system estimates and limits of the process and of its
 * control groups allow; UINT64_MAX where it does not tell. */
uint64_t asdic_memory_left(void);

/* Of the control groups alone, to which containers and batch systems give limits: those that TABLE, /proc/self/cgroup,
 * lists, and all above them, as they lie below ROOT, /sys/fs/cgroup (the kernel's documentation, cgroup-v1/memory.rst
 * and cgroup-v2.rst). */
uint64_t asdic_memory_groups_left(const char *table, const char *root);

/* Succeeds when NEEDED bytes are LEFT, else fails with ASDIC_ERROR_MEMORY and "WHAT NEEDED bytes of
 * memory, LEFT are available; REMEDY". Asked before allocation, because Linux kills a process that
 * uses more than there is. WHAT includes the verb: "2 pings need". */
asdic_status asdic_memory_check(asdic_context *ctx, uint64_t needed, uint64_t left,
                                const char *what, const char *remedy);

#endif
