/*
 * The device a test program works on: ASDIC_DEVICE, else "auto". A machine without one skips the
 * program with exit code 77, by hand, because cmocka exits 0 when all tests of a group skip.
 */
#ifndef ASDIC_TEST_DEVICE_H
#define ASDIC_TEST_DEVICE_H

#include <stdio.h>
#include <stdlib.h>

#include <asdic/device.h>

typedef struct test_device {
    asdic_context *ctx;
    asdic_device **devices;
    size_t count;
    asdic_device *device; /* the first */
} test_device;

/* Call first in main(). */
static inline test_device test_device_open_or_skip(void) {
    test_device t = {0};
    if (asdic_context_create(&t.ctx) != ASDIC_OK) {
        exit(1);
    }
    asdic_status status = asdic_devices_open(t.ctx, getenv("ASDIC_DEVICE"), &t.devices, &t.count);
    if (status != ASDIC_OK) {
        printf("skipped: %s\n", asdic_context_error(t.ctx));
        asdic_context_destroy(&t.ctx);
        exit(status == ASDIC_ERROR_DEVICE ? 77 : 1);
    }
    t.device = t.devices[0];
    return t;
}

static inline void test_device_close(test_device *t) {
    asdic_devices_close(&t->devices, t->count);
    asdic_context_destroy(&t->ctx);
}

/* Call last in main(), with what FAILED. */
static inline int test_device_end(test_device *t, int failed) {
    test_device_close(t);
    return failed;
}

#endif
