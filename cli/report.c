/* Messages on stderr, exit codes. */
#include "cli_state.h"

#include <errno.h>
#include <poll.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define RED_BOLD "\033[1;31m"
#define YELLOW_BOLD "\033[1;33m"
#define PLAIN "\033[0m"

/* https://no-color.org: set and not empty means no colour. */
static bool terminal_shows_colour(void) {
    const char *no_color = getenv("NO_COLOR");
    const char *term = getenv("TERM");
    return isatty(STDERR_FILENO) && !(no_color && no_color[0]) &&
           !(term && strcmp(term, "dumb") == 0);
}

/* "scene.yaml:5:3: error: text" already names its severity; other messages get it in front. */
static void print_message(const cli *c, const char *word, const char *colour, const char *text) {
    char mark[32];
    const char *on = c->colour ? colour : "", *off = c->colour ? PLAIN : "";
    snprintf(mark, sizeof mark, ": %s: ", word);
    const char *at = strstr(text, mark);
    if (at) {
        fprintf(stderr, "%.*s%s%s:%s %s\n", (int)(at + 2 - text), text, on, word, off,
                at + strlen(mark));
    } else {
        fprintf(stderr, "%s%s:%s %s\n", on, word, off, text);
    }
}

static void on_log(void *user, asdic_log_level level, const char *message) {
    const cli *c = user;
    if (c->verbosity == CLI_MUTE) {
        return;
    }
    switch (level) {
    case ASDIC_LOG_ERROR:
        print_message(c, "error", RED_BOLD, message);
        break;
    case ASDIC_LOG_WARNING:
        print_message(c, strstr(message, ": remark: ") ? "remark" : "warning", YELLOW_BOLD,
                      message);
        break;
    case ASDIC_LOG_NOTE:
    case ASDIC_LOG_INFO:
    case ASDIC_LOG_DEBUG:
        fprintf(stderr, "%s\n", message);
        break;
    }
}

void cli_report_begin(cli *c) {
    /* Notes are for somebody who waits, as the progress bar is. */
    asdic_log_level usual = isatty(STDERR_FILENO) ? ASDIC_LOG_NOTE : ASDIC_LOG_WARNING;
    const asdic_log_level levels[] = {ASDIC_LOG_ERROR, usual, ASDIC_LOG_INFO, ASDIC_LOG_DEBUG};
    c->colour = terminal_shows_colour();
    asdic_context_set_log(c->ctx, levels[c->verbosity == CLI_MUTE ? 0 : c->verbosity + 1], on_log,
                          c);
}

static void print_formatted(const cli *c, asdic_log_level level, const char *format, va_list args) {
    char text[2048];
    vsnprintf(text, sizeof text, format, args);
    on_log((void *)(uintptr_t)c, level, text);
}

void cli_error(const cli *c, const char *format, ...) {
    va_list args;
    va_start(args, format);
    print_formatted(c, ASDIC_LOG_ERROR, format, args);
    va_end(args);
}

void cli_warning(const cli *c, const char *format, ...) {
    if (c->verbosity >= 0) {
        va_list args;
        va_start(args, format);
        print_formatted(c, ASDIC_LOG_WARNING, format, args);
        va_end(args);
    }
}

void cli_warning_always(const cli *c, const char *format, ...) {
    va_list args;
    va_start(args, format);
    print_formatted(c, ASDIC_LOG_WARNING, format, args);
    va_end(args);
}

void cli_note(const cli *c, const char *format, ...) {
    if (c->verbosity >= 0) {
        va_list args;
        va_start(args, format);
        print_formatted(c, ASDIC_LOG_INFO, format, args);
        va_end(args);
    }
}

bool cli_quiet(const cli *c) {
    return c->verbosity < 0;
}

int cli_usage(cli *c, const char *format, ...) {
    va_list args;
    va_start(args, format);
    print_formatted(c, ASDIC_LOG_ERROR, format, args);
    va_end(args);
    if (c->verbosity != CLI_MUTE) {
        fprintf(stderr, "'asdic %s --help' shows how it is used\n", c->command->name);
    }
    c->bad_usage = true;
    return CLI_USAGE;
}

static int exit_code(asdic_status status) {
    switch (status) {
    case ASDIC_OK:
        return CLI_OK;
    case ASDIC_ERROR_ARGUMENT: /* what a command passes on comes from the command line */
        return CLI_USAGE;
    case ASDIC_ERROR_INPUT:
        return CLI_INPUT;
    case ASDIC_ERROR_DEVICE:
        return CLI_DEVICE;
    case ASDIC_ERROR_INTERRUPTED:
        return cli_signal_received() ? 128 + cli_signal_received() : CLI_FAILED;
    case ASDIC_ERROR_DEVICE_LOST:
    case ASDIC_ERROR_MEMORY:
    case ASDIC_ERROR_IO:
    case ASDIC_ERROR_EXISTS:
    case ASDIC_ERROR_UNSUPPORTED:
        break;
    }
    return CLI_FAILED;
}

/* Exits as SIGPIPE would have, where the parent ignores that signal. */
#define READER_LEFT (128 + 13)

/* Whether data went to stdout ("-o -") and its reader is gone. */
static bool reader_left(const cli *c) {
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    bool to_stdout = false;
    for (size_t i = 0; i < c->option_count; i++) {
        to_stdout |= strcmp(c->options[i]->name, "output") == 0 && c->values[i] &&
                     cli_is_stdout(c->values[i]);
    }
    return to_stdout && poll(&out, 1, 0) == 1 && (out.revents & POLLERR);
}

int cli_end(const cli *c, asdic_status status) {
    const char *text = asdic_context_error(c->ctx);
    if (status == ASDIC_ERROR_IO && reader_left(c)) {
        return READER_LEFT;
    }
    if (status == ASDIC_ERROR_INTERRUPTED) {
        const char *word = asdic_status_text(status); /* TEXT may be an earlier error, dealt with */
        cli_note(c, "%s", strncmp(text, word, strlen(word)) == 0 ? text : word);
    } else if (status != ASDIC_OK) {
        cli_error(c, "%s", text[0] ? text : asdic_status_text(status));
    }
    return exit_code(status);
}

/* Why an earlier write to stdout failed. stdio does not keep the reason, so one more byte is
 * written where that does no harm. 0: not known. */
static int earlier_error(void) {
    struct stat st;
    bool is_harmless = fstat(STDOUT_FILENO, &st) == 0 && !S_ISREG(st.st_mode);
    return is_harmless && write(STDOUT_FILENO, "", 1) < 0 ? errno : 0;
}

int cli_close_output(const cli *c, int code) {
    bool failed = ferror(stdout) != 0;
    int error = failed ? earlier_error() : 0;
    errno = 0;
    if (fclose(stdout) != 0 || failed) {
        error = error ? error : errno;
        if (error == EPIPE) {
            return READER_LEFT;
        }
        cli_error(c, "cannot write to standard output: %s",
                  error ? strerror(error) : "an earlier write failed");
        return code == CLI_OK ? CLI_FAILED : code;
    }
    return code;
}
