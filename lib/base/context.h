/*
 * The context behind asdic_context: last error, log, interrupt flag.
 */
#ifndef ASDIC_BASE_CONTEXT_H
#define ASDIC_BASE_CONTEXT_H

#include <asdic/context.h>

/* Records one sentence and returns STATUS, so that a failing function can end with
 * `return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", path, strerror(errno));` */
asdic_status asdic_fail(asdic_context *ctx, asdic_status status, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A pointer that FUNCTION cannot do without is NULL: ASDIC_ERROR_ARGUMENT. */
asdic_status asdic_fail_null(asdic_context *ctx, const char *function);

/* Whether the caller gave a place for what a function makes, asked before anything that may fail: there is NULL in it
 * until the function succeeds. */
#define ASDIC_PLACE(out) ((out) ? (*(out) = NULL, true) : false)

/* Out of memory while allocating WHAT ("1000 bins"). */
asdic_status asdic_fail_memory(asdic_context *ctx, const char *what);

/* Begins part DONE of TOTAL of a call that takes long: reports progress, and answers
 * ASDIC_ERROR_INTERRUPTED where the call is to stop. WHAT is a text that stays, as "beams". */
asdic_status asdic_step(asdic_context *ctx, const char *what, size_t done, size_t total);

/* While HELD, an interruption waits: what was begun is finished. */
void asdic_context_hold_interrupt(asdic_context *ctx, bool held);

/* The last error into OUT of SIZE bytes, whole, while other threads may fail as well. */
void asdic_context_copy_error(asdic_context *ctx, char *out, size_t size);

/* Of a driver, which may be one of several; every beginning has its end. */
void asdic_context_compile_begin(asdic_context *ctx);
void asdic_context_compile_end(asdic_context *ctx);

void asdic_log(asdic_context *ctx, asdic_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
