/*
 * A video of a run through ffmpeg, which reads the frames as PNG files from a pipe.
 */
#include "render_video.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* Players are at a loss with fewer or more frames a second than these. */
#define LEAST_RATE_HZ 1.0
#define MOST_RATE_HZ 60.0

typedef struct film {
    cli *c;
    const char *path;
    char *part;  /* where ffmpeg writes: of the same ending, by which it knows the format */
    char *to;    /* the same as ffmpeg takes it, whatever is in it: "file:fan.part.mp4" */
    char *frame; /* the picture that is drawn anew for each ping */
    double rate_hz;
    pid_t child;
    FILE *pipe; /* NULL: ffmpeg was not started */
} film;

/* Frames a second that show a run in its own time. */
static asdic_status find_rate(cli *c, const char *folder, double *rate_hz) {
    asdic_run *run = NULL;
    asdic_record record;
    asdic_status status = asdic_run_open(cli_context(c), folder, &run);
    double first_s = 0.0, last_s = 0.0;
    size_t pings = status == ASDIC_OK ? asdic_run_get_info(run).pings : 0;
    if (pings > 1 && (status = asdic_run_read(run, 0, &record)) == ASDIC_OK) {
        first_s = record.time_s;
        status = asdic_run_read(run, pings - 1, &record);
        last_s = record.time_s;
    }
    *rate_hz = last_s > first_s ? (double)(pings - 1) / (last_s - first_s) : LEAST_RATE_HZ;
    *rate_hz = fmin(fmax(*rate_hz, LEAST_RATE_HZ), MOST_RATE_HZ);
    asdic_run_close(&run);
    return status;
}

/* Starts ffmpeg, its standard input being FILM's pipe. */
static bool start(film *f) {
    char rate[32];
    int ends[2];
    snprintf(rate, sizeof rate, "%.0f/1000", 1000.0 * f->rate_hz);
    /* H.264 as every player reads it wants an even number of pixels a side. */
    const char *const words[] = {
        "ffmpeg",   "-loglevel", "error", "-y", "-f", "image2pipe", "-framerate",
        rate,       "-c:v",      "png",   "-i", "-",  "-vf",        "pad=ceil(iw/2)*2:ceil(ih/2)*2",
        "-pix_fmt", "yuv420p",   f->to,   NULL};
    posix_spawn_file_actions_t actions;
    if (pipe(ends) != 0) {
        cli_error(f->c, "no pipe for ffmpeg: %s", strerror(errno));
        return false;
    }
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    posix_spawn_file_actions_addclose(&actions, ends[1]);
    int error =
        posix_spawnp(&f->child, words[0], &actions, NULL, (char *const *)(uintptr_t)words, environ);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[0]);
    if (error != 0) {
        close(ends[1]);
        cli_error(f->c,
                  "a video needs ffmpeg, which cannot be started: %s; install it (package "
                  "ffmpeg), or draw pictures with --ping",
                  strerror(error));
        return false;
    }
    cli_signals_helper(&(cli_helper){f->child, {f->frame, f->part}});
    f->pipe = fdopen(ends[1], "wb");
    return f->pipe != NULL;
}

/* The first frame starts ffmpeg: a run that has none is no matter of its. */
static bool add_frame(void *user, const char *path) {
    film *f = user;
    char block[65536];
    size_t length;
    if (!f->pipe && !start(f)) {
        return false;
    }
    FILE *frame = fopen(path, "rb");
    bool is_written = frame != NULL;
    while (is_written && (length = fread(block, 1, sizeof block, frame)) > 0) {
        is_written = fwrite(block, 1, length, f->pipe) == length;
    }
    if (frame) {
        fclose(frame);
    }
    return is_written;
}

/* Ends ffmpeg. Only a video of all frames, drawn with STATUS, takes its name. */
static bool finish(film *f, asdic_status status) {
    int state = 0;
    bool all = status == ASDIC_OK;
    if (!f->pipe) {
        return false;
    }
    if (status == ASDIC_ERROR_INTERRUPTED) {
        kill(f->child, SIGKILL); /* asked, it would encode what it holds first */
    }
    bool is_whole = fclose(f->pipe) == 0;
    while (waitpid(f->child, &state, 0) < 0 && errno == EINTR) {
    }
    cli_signals_helper(NULL);
    is_whole = is_whole && WIFEXITED(state) && WEXITSTATUS(state) == 0;
    if (is_whole && all && rename(f->part, f->path) == 0) {
        return true;
    }
    unlink(f->part);
    if (all) {
        cli_error(f->c, "ffmpeg did not write '%s'", f->path);
    }
    return false;
}

/* "fan.part.mp4" of "fan.mp4", and "fan.part.mp4.png" for the frames. */
static bool name_parts(film *f) {
    size_t stem = cli_stem(f->path);
    if (asprintf(&f->part, "%.*s.part%s", (int)stem, f->path, f->path + stem) < 0) {
        f->part = NULL;
    }
    if (!f->part || asprintf(&f->frame, "%s.png", f->part) < 0) {
        f->frame = NULL;
    }
    if (!f->frame || asprintf(&f->to, "file:%s", f->part) < 0) {
        f->to = NULL;
    }
    return f->to != NULL;
}

int render_video(cli *c, const char *folder, const asdic_render_options *options,
                 const char *path) {
    film f = {.c = c, .path = path};
    asdic_render_options each = *options;
    asdic_status status = name_parts(&f) ? find_rate(c, folder, &f.rate_hz) : ASDIC_ERROR_MEMORY;
    bool is_whole = false;
    if (status == ASDIC_OK) {
        signal(SIGPIPE, SIG_IGN); /* an ffmpeg that ends early is an error to report */
        each.path = f.frame;
        status = asdic_run_render_frames(cli_context(c), folder, &each, add_frame, &f);
        is_whole = finish(&f, status);
        unlink(f.frame);
    }
    free(f.part);
    free(f.to);
    free(f.frame);
    return status != ASDIC_OK ? cli_end(c, status) : is_whole ? CLI_OK : CLI_FAILED;
}
