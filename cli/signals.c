/* The one place with static state: a signal has no other way to reach the context.
 *
 * A thread waits for signals, and all other threads block them. LLVM, with which PoCL compiles,
 * installs handlers that delete the object it is writing, after which PoCL aborts; a compiler that
 * it started must not stop either. */
#include "cli_state.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <time.h>
#include <unistd.h>

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static asdic_context *watched_context; /* under the lock */
static atomic_int received;
static int wake_fds[2] = {-1, -1};

static void stop_signals(sigset_t *set) {
    sigemptyset(set);
    sigaddset(set, SIGINT);
    sigaddset(set, SIGTERM);
}

/* A compiler of kernels, or a ping of millions of rays, cannot be asked. */
static const struct timespec grace = {.tv_nsec = 700000000};

static void *wait_for_signals(void *stops_soon) {
    sigset_t set;
    int number = 0;
    stop_signals(&set);
    sigwait(&set, &number);
    received = number;
    pthread_mutex_lock(&lock);
    if (watched_context) {
        asdic_context_interrupt(watched_context);
    }
    pthread_mutex_unlock(&lock);
    close(wake_fds[1]); /* who polls the other end learns of it */
    if (stops_soon && sigtimedwait(&set, NULL, &grace) < 0) {
        _exit(128 + number);
    }
    if (!stops_soon) {
        sigwait(&set, &number);
    }
    signal(number, SIG_DFL); /* the second one ends the program at once */
    pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    raise(number);
    return NULL;
}

/* Without a thread or a pipe, signals end the program at once; a run folder survives that. */
void cli_signals_begin(asdic_context *ctx, bool stops_soon) {
    sigset_t set;
    pthread_t thread;
    if (pipe2(wake_fds, O_CLOEXEC) != 0) {
        return;
    }
    watched_context = ctx;
    stop_signals(&set);
    pthread_sigmask(SIG_BLOCK, &set, NULL);
    if (pthread_create(&thread, NULL, wait_for_signals, stops_soon ? &wake_fds : NULL) == 0) {
        pthread_detach(thread);
    } else {
        pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    }
}

void cli_signals_end(void) {
    pthread_mutex_lock(&lock);
    watched_context = NULL;
    pthread_mutex_unlock(&lock);
}

int cli_signal_fd(void) {
    return wake_fds[0];
}

int cli_signal_received(void) {
    return received;
}
