/*
 * Zeros where there may be some already.
 */
#ifndef ASDIC_BASE_CLEAR_H
#define ASDIC_BASE_CLEAR_H

#include <stddef.h>

/* Sets BYTES from AT on to 0. What is 0 is left alone: reading is cheaper than writing, and pages that nobody writes
 * to take neither memory nor time. */
void asdic_clear(void *at, size_t bytes);

#endif
