/* The one place with static state: a signal handler has no other way to reach the context. */
#include "cli_state.h"

#include <signal.h>

static asdic_context *handled_context;
static volatile sig_atomic_t received;

static void on_signal(int number) {
    received = number;
    asdic_context_interrupt(handled_context);
    signal(SIGINT, SIG_DFL); /* the next one ends the program at once */
    signal(SIGTERM, SIG_DFL);
}

void cli_signals_begin(asdic_context *ctx) {
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESTART};
    handled_context = ctx;
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    signal(SIGXFSZ,
           SIG_IGN); /* a limit on file sizes is then an error of writing, as a full disk */
}

int cli_signal_received(void) {
    return received;
}
