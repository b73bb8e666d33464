/*
 * The context: where the library keeps its last error and its log callback. There is no other state
 * outside the objects a program creates; two contexts are independent.
 *
 * Threads: one context and the objects created from it may be used by one thread at a time, except
 * where a function says otherwise. The error sentence itself is guarded, so that worker threads
 * inside the library may report through the caller's context.
 *
 * Errors: what returns a status may answer ASDIC_ERROR_ARGUMENT, for what lies outside the domain
 * stated with it, and ASDIC_ERROR_MEMORY; which others, stands with the function. What works on a
 * device may also answer ASDIC_ERROR_DEVICE and ASDIC_ERROR_DEVICE_LOST, what writes files
 * ASDIC_ERROR_IO, and what takes long ASDIC_ERROR_INTERRUPTED (asdic_context_interrupt). Where OUT
 * takes an object, it is the caller's to destroy, and *OUT is NULL on failure.
 *
 * NULL where an object is needed: what returns a status answers ASDIC_ERROR_ARGUMENT; what asks a
 * mission, scene, mesh, run, scan, tracker or view something gets nothing (zeros, NULL). Arithmetic
 * on what the caller fills in, as asdic_beam_axis, needs all that it is given. A NULL context only
 * loses the sentence.
 */
#ifndef ASDIC_CONTEXT_H
#define ASDIC_CONTEXT_H

#include <asdic/common.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_context asdic_context;

typedef enum asdic_log_level {
    ASDIC_LOG_ERROR = 0, /* one of several in an input, and the call fails; or of a lost device */
    ASDIC_LOG_WARNING = 1,
    ASDIC_LOG_NOTE = 2, /* what a user who waits wants to know */
    ASDIC_LOG_INFO = 3,
    ASDIC_LOG_DEBUG = 4,
} asdic_log_level;

/* MESSAGE is one or more complete lines without a trailing newline, valid during the call only.
 * May be called from a worker thread, never from two at once. It may interrupt the context; another
 * call of the library with this context would wait for ever. */
typedef void (*asdic_log_fn)(void *user, asdic_log_level level, const char *message);

/* *OUT is NULL on failure (ASDIC_ERROR_MEMORY, or ASDIC_ERROR_ARGUMENT when OUT is NULL). */
ASDIC_API asdic_status asdic_context_create(asdic_context **out);

/* NULL and pointers to NULL are allowed, here and in every destroy; *CTX becomes NULL. Objects
 * created from the context must be destroyed before it. */
ASDIC_API void asdic_context_destroy(asdic_context **ctx);

/* Messages at LEVEL and more severe go to FN; NULL silences. Without a call nothing is reported. */
ASDIC_API void asdic_context_set_log(asdic_context *ctx, asdic_log_level level, asdic_log_fn fn,
                                     void *user);

/* One sentence about the last failed call with this context, or with what was created from it other
 * than a ping: what failed, with which value, against which limit, what to do. Valid until the next
 * failing call on this context; "" when nothing has failed. */
ASDIC_API const char *asdic_context_error(const asdic_context *ctx);

/* A call that takes long has done DONE of TOTAL parts, which WHAT names ("beams"). One that is part
 * of another reports among the other's reports. As with logs: maybe from a worker thread, never
 * from two at once, and nothing but an interruption of the context may come from it. */
typedef void (*asdic_progress_fn)(void *user, const char *what, size_t done, size_t total);

/* Reports of calls that take long, other than missions, go to FN; NULL silences. */
ASDIC_API void asdic_context_set_progress(asdic_context *ctx, asdic_progress_fn fn, void *user);

/* Asks a running call (a mission, a bench) to stop at the next ping, an expectation at the next
 * bin, a drawing at the next picture, and for good: calls that follow stop as well. Safe in a
 * signal handler. */
ASDIC_API void asdic_context_interrupt(asdic_context *ctx);
ASDIC_API bool asdic_context_interrupted(const asdic_context *ctx);

/* Whether a driver may be compiling, which takes up to minutes and nothing can interrupt. A program
 * that was asked to end need not wait for it: it may exit at once, and a run folder stays good. */
ASDIC_API bool asdic_context_compiles(const asdic_context *ctx);

#ifdef __cplusplus
}
#endif

#endif
