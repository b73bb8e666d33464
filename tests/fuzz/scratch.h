/*
 * A file in memory that holds what the fuzzer made: readers take paths.
 */
#ifndef ASDIC_TESTS_FUZZ_SCRATCH_H
#define ASDIC_TESTS_FUZZ_SCRATCH_H

#include <stddef.h>
#include <stdint.h>

/* A path that ends in NAME; it stays valid, and its folder is this process's own. */
const char *scratch_path(const char *name);

/* The same, after writing the bytes there. */
const char *scratch_write(const char *name, const uint8_t *data, size_t size);

#endif
