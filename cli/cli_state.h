/*
 * The struct behind `cli`, for the files that parse and report; commands use cli.h.
 */
#ifndef ASDIC_CLI_STATE_H
#define ASDIC_CLI_STATE_H

#include "cli.h"

#define CLI_MAX_OPTIONS 48

/* Not even errors: several processes would print the same. */
#define CLI_MUTE (-2)

struct cli {
    asdic_context *ctx;
    const cli_command *command;
    const cli_option *options[CLI_MAX_OPTIONS]; /* the command's own, then the common ones */
    const char *values[CLI_MAX_OPTIONS];        /* NULL: not given; flags: "" */
    size_t option_count;
    char **operands;
    size_t operand_count;
    int verbosity; /* CLI_MUTE, -1 quiet, 0, 1 verbose, 2 more so */
    bool colour;
    bool bad_usage;
};

/* The options COMMAND takes, its own first; for help, man pages and completions. */
size_t cli_options_of(const cli_command *command, const cli_option *out[CLI_MAX_OPTIONS]);

/* Gathers the options COMMAND takes. */
void cli_begin(cli *c, asdic_context *ctx, const cli_command *command);

/* Reads ARGV; its first word is the command's name. False after a mistake, which is reported. */
bool cli_parse(cli *c, int argc, char **argv);

/* Help on stdout: of the program, or of one command. */
void cli_help_program(FILE *out);
void cli_help_on(FILE *out, const cli_command *command);

/* The word of COUNT that is nearest to TEXT; NULL when none is near enough. */
const char *cli_nearest(const char *text, const char *const *words, size_t count);

/* Sends the library's messages to stderr with the verbosity asked for. */
void cli_report_begin(cli *c);

/* Sets how the process takes memory from the system. Call it first of all. */
void cli_heap_begin(void);

/* The first SIGINT or SIGTERM asks CTX to stop, the second ends the program; with STOPS_SOON also
 * the time that it takes. RESUMES: the command has --resume, which the message names where a driver that
 * compiles is not waited for. Call it before threads begin. */
void cli_signals_begin(asdic_context *ctx, bool stops_soon, bool resumes);
void cli_signals_end(void);    /* before the context is destroyed */
int cli_signal_received(void); /* 0: none */

/* Closes stdout. Returns CODE, or CLI_FAILED where writing failed. */
int cli_close_output(const cli *c, int code);

#endif
