/*
 * One context for all tests of a program: cmocka_run_group_tests(tests, context_begin, context_end).
 */
#ifndef ASDIC_TEST_CONTEXT_H
#define ASDIC_TEST_CONTEXT_H

#include <asdic/context.h>

static asdic_context *ctx;

static int context_begin(void **state) {
    (void)state;
    return asdic_context_create(&ctx) != ASDIC_OK;
}

static int context_end(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return 0;
}

#endif
