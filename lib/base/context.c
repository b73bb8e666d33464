#include "context.h"

#include "number.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

struct asdic_context {
    pthread_mutex_t lock; /* guards everything below but the interrupt flag */
    char error[1024];
    asdic_log_level level;
    asdic_log_fn log;
    void *user;
    asdic_progress_fn progress;
    void *progress_user;
    atomic_uint compiling;         /* drivers that may be */
    atomic_bool interrupted, held; /* set by signal handlers, read by every thread */
};

asdic_status asdic_context_create(asdic_context **out) {
    if (!out) {
        return ASDIC_ERROR_ARGUMENT;
    }
    *out = calloc(1, sizeof **out);
    if (!*out) {
        return ASDIC_ERROR_MEMORY;
    }
    if (pthread_mutex_init(&(*out)->lock, NULL) != 0) {
        free(*out);
        *out = NULL;
        return ASDIC_ERROR_MEMORY;
    }
    return ASDIC_OK;
}

void asdic_context_destroy(asdic_context **ctx) {
    if (!ctx || !*ctx) {
        return;
    }
    pthread_mutex_destroy(&(*ctx)->lock);
    free(*ctx);
    *ctx = NULL;
}

void asdic_context_set_log(asdic_context *ctx, asdic_log_level level, asdic_log_fn fn, void *user) {
    if (!ctx) {
        return;
    }
    pthread_mutex_lock(&ctx->lock);
    ctx->level = level;
    ctx->log = fn;
    ctx->user = user;
    pthread_mutex_unlock(&ctx->lock);
}

void asdic_context_set_progress(asdic_context *ctx, asdic_progress_fn fn, void *user) {
    if (!ctx) {
        return;
    }
    pthread_mutex_lock(&ctx->lock);
    ctx->progress = fn;
    ctx->progress_user = user;
    pthread_mutex_unlock(&ctx->lock);
}

asdic_status asdic_step(asdic_context *ctx, const char *what, size_t done, size_t total) {
    if (asdic_context_interrupted(ctx)) {
        return asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED, "interrupted after %zu of %zu %s", done,
                          total, what);
    }
    if (ctx) {
        pthread_mutex_lock(&ctx->lock);
        if (ctx->progress) {
            ctx->progress(ctx->progress_user, what, done, total);
        }
        pthread_mutex_unlock(&ctx->lock);
    }
    return ASDIC_OK;
}

void asdic_context_hold_interrupt(asdic_context *ctx, bool held) {
    if (ctx) {
        atomic_store(&ctx->held, held);
    }
}

const char *asdic_context_error(const asdic_context *ctx) {
    return ctx ? ctx->error : "no context";
}

void asdic_context_copy_error(asdic_context *ctx, char *out, size_t size) {
    pthread_mutex_lock(&ctx->lock);
    snprintf(out, size, "%s", ctx->error);
    pthread_mutex_unlock(&ctx->lock);
}

void asdic_context_interrupt(asdic_context *ctx) {
    if (ctx) {
        atomic_store(&ctx->interrupted, true);
    }
}

bool asdic_context_interrupted(const asdic_context *ctx) {
    return ctx && atomic_load(&ctx->interrupted) && !atomic_load(&ctx->held);
}

void asdic_context_compile_begin(asdic_context *ctx) {
    if (ctx) {
        atomic_fetch_add(&ctx->compiling, 1);
    }
}

void asdic_context_compile_end(asdic_context *ctx) {
    if (ctx) {
        atomic_fetch_sub(&ctx->compiling, 1);
    }
}

bool asdic_context_compiles(const asdic_context *ctx) {
    return ctx && atomic_load(&ctx->compiling) > 0;
}

asdic_status asdic_fail(asdic_context *ctx, asdic_status status, const char *format, ...) {
    if (ctx) {
        char text[sizeof ctx->error];
        va_list args;
        va_start(args, format);
        asdic_c_print(text, sizeof text, format, args);
        va_end(args);
        pthread_mutex_lock(&ctx->lock);
        snprintf(ctx->error, sizeof ctx->error, "%s", text);
        pthread_mutex_unlock(&ctx->lock);
    }
    return status;
}

asdic_status asdic_fail_null(asdic_context *ctx, const char *function) {
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: an argument that is needed is NULL",
                      function);
}

asdic_status asdic_fail_memory(asdic_context *ctx, const char *what) {
    return asdic_fail(ctx, ASDIC_ERROR_MEMORY, "out of memory while allocating %s", what);
}

void asdic_log(asdic_context *ctx, asdic_log_level level, const char *format, ...) {
    if (!ctx) {
        return;
    }
    pthread_mutex_lock(&ctx->lock);
    if (ctx->log && level <= ctx->level) {
        char text[2048];
        va_list args;
        va_start(args, format);
        asdic_c_print(text, sizeof text, format, args);
        va_end(args);
        ctx->log(ctx->user, level, text);
    }
    pthread_mutex_unlock(&ctx->lock);
}
