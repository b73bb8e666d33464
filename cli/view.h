/*
 * Shared by the window and the stream: options, and keys from a script.
 */
#ifndef ASDIC_CLI_VIEW_H
#define ASDIC_CLI_VIEW_H

#include "cli.h"

/* A key and the mission time at which it is pressed. */
typedef struct view_key {
    double time_s;
    const char *name;
} view_key;

typedef struct view_job {
    cli *c;
    asdic_view *view;
    double rate_hz;
    bool is_offline; /* without a display, and so without a user */
    size_t pings;    /* SIZE_MAX: until it is over */
    view_key *keys;
    size_t key_count, next_key;
    char *key_text;
} view_job;

/* "2:up,2.5:r": into JOB's keys. False after a message. */
bool view_read_keys(view_job *job, const char *text);

/* Presses the keys that are due, then steps. False at the end, or after a failure (*STATUS). */
bool view_next(view_job *job, asdic_status *status);

/* Each shows the view until it is over and returns an exit code. */
int view_stream(view_job *job, const char *path);
int view_snapshots(view_job *job, size_t count, size_t pings, const char *folder, bool force);
int view_window(view_job *job); /* of the module "window" */

#endif
