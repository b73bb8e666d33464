/*
 * How far a command is, on stderr and without --quiet: a bar on a terminal; elsewhere, in a file or
 * a pipe, a line now and then.
 */
#ifndef ASDIC_CLI_PROGRESS_H
#define ASDIC_CLI_PROGRESS_H

#include "cli.h"

#define CLI_PROGRESS_LOOPS 8

/* A loop of parts, perhaps within another. */
typedef struct cli_progress_loop {
    const char *what; /* NULL: none */
    size_t done;
    double begun_s;
} cli_progress_loop;

typedef struct cli_progress {
    const cli *c;
    bool is_shown, is_terminal, is_drawn;
    size_t resumed; /* pings present at the start; SIZE_MAX: not known yet */
    double last_s;  /* on the clock, when it was shown last */
    /* The last report, and the first of new pings: what came before it went into compiling. */
    asdic_run_progress last, first;
    cli_progress_loop loops[CLI_PROGRESS_LOOPS];
} cli_progress;

cli_progress cli_progress_begin(const cli *c);

/* For asdic_run_options.progress; USER is the cli_progress. */
void cli_progress_report(void *user, const asdic_run_progress *progress);

/* DONE of TOTAL parts, which WHAT names, are done; USER is the cli_progress. */
void cli_progress_step(void *user, const char *what, size_t done, size_t total);

/* Shows the context's reports, too, until cli_progress_end. PROGRESS stays where it is. */
void cli_progress_watch(cli_progress *progress);

/* Removes the bar. */
void cli_progress_end(cli_progress *progress);

/* Of a run after its first pings; 0 where there were no others. */
double cli_progress_rays_per_s(const cli_progress *progress);

/* 1234567 as "1.23 M", for "1.23 Mrays/s". */
void cli_progress_short(char text[16], double value);

#endif
