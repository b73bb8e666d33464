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
#include <string.h>
#include <time.h>
#include <unistd.h>

#define PATIENCE_MS 700
#define STEP_MS 50
#define MOST_GROUPS 256

static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;
static asdic_context *watched_context; /* under the lock */
static atomic_int received;
static int wake_fds[2] = {-1, -1};
static const char *while_compiling;
static cli_helper helper;         /* under the lock */
static pid_t groups[MOST_GROUPS]; /* the same; 0: none */

static void stop_signals(sigset_t *set) {
    sigemptyset(set);
    sigaddset(set, SIGINT);
    sigaddset(set, SIGTERM);
}

/* Under the lock, before the program ends where it stands. */
static void end_helper(void) {
    if (helper.child > 0) {
        kill(helper.child, SIGKILL);
    }
    for (int i = 0; i < 2 && helper.files[i]; i++) {
        unlink(helper.files[i]);
    }
    for (int i = 0; i < MOST_GROUPS; i++) {
        if (groups[i] > 0) {
            kill(-groups[i], SIGKILL);
        }
    }
}

/* After signal NUMBER: waits for the next one of SET, and returns it. A driver that compiles does not
 * learn of a signal and may take minutes; nor does a ping of millions of rays. Where one is at it after
 * a while the program ends: a run folder stays good, and so it does for what STOPS_SOON. */
static int wait_for_second(const sigset_t *set, int number, bool stops_soon) {
    static const struct timespec step = {.tv_nsec = STEP_MS * 1000000};
    for (int waited_ms = 0;; waited_ms += STEP_MS) {
        int second = sigtimedwait(set, NULL, &step);
        if (second > 0) {
            return second;
        }
        pthread_mutex_lock(&lock);
        bool compiles = asdic_context_compiles(watched_context);
        if (waited_ms >= PATIENCE_MS && (stops_soon || compiles)) {
            if (compiles) {
                (void)!write(STDERR_FILENO, while_compiling, strlen(while_compiling));
            }
            end_helper();
            _exit(128 + number);
        }
        pthread_mutex_unlock(&lock);
    }
}

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
    number = wait_for_second(&set, number, stops_soon != NULL);
    pthread_mutex_lock(&lock);
    end_helper();
    signal(number, SIG_DFL); /* the second one ends the program at once */
    pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    raise(number);
    return NULL;
}

/* Without a thread or a pipe, signals end the program at once; a run folder survives that. */
void cli_signals_begin(asdic_context *ctx, bool stops_soon, bool resumes) {
    sigset_t set;
    pthread_t thread;
    while_compiling =
        resumes
            ? "error: interrupted while a driver compiled; --resume goes on with what was begun\n"
            : "error: interrupted while a driver compiled\n";
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

void cli_signals_as_found(void) {
    sigset_t set;
    stop_signals(&set);
    pthread_sigmask(SIG_UNBLOCK, &set, NULL);
    signal(SIGPIPE, SIG_DFL);
}

void cli_signals_helper(const cli_helper *now) {
    pthread_mutex_lock(&lock);
    helper = now ? *now : (cli_helper){0};
    pthread_mutex_unlock(&lock);
}

void cli_signals_group(pid_t group, bool runs) {
    pthread_mutex_lock(&lock);
    for (int i = 0; i < MOST_GROUPS; i++) {
        if (groups[i] == (runs ? 0 : group)) {
            groups[i] = runs ? group : 0;
            break;
        }
    }
    pthread_mutex_unlock(&lock);
}

int cli_signal_fd(void) {
    return wake_fds[0];
}

int cli_signal_received(void) {
    return received;
}
