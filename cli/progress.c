#include "progress.h"

#include <pthread.h>
#include <string.h>
#include <unistd.h>

#define WIDTH 24
#define REDRAW_S 0.1
#define LINE_S 10.0

/* What a bar or a line says. */
typedef struct shown {
    const char *what;
    size_t done, total;
    size_t before; /* of DONE, what was there at the start */
    double elapsed_s;
    uint64_t rays;
} shown;

cli_progress cli_progress_begin(const cli *c) {
    bool is_terminal = isatty(STDERR_FILENO);
    return (cli_progress){.c = c,
                          .is_shown = !cli_quiet(c),
                          .is_terminal = is_terminal,
                          .last_s = is_terminal ? 0.0 : cli_clock_s(),
                          .resumed = SIZE_MAX};
}

void cli_progress_short(char text[16], double value) {
    static const char units[] = " kMGT";
    size_t unit = 0;
    while (value >= 999.5 && unit + 2 < sizeof units) {
        value /= 1000.0;
        unit++;
    }
    const char *format = value < 9.995 ? "%.2f %c" : value < 99.95 ? "%.1f %c" : "%.0f %c";
    snprintf(text, 16, unit ? format : "%.0f ", value, units[unit]);
}

/* "0:01:23 left", or "" at the beginning. */
static void time_left(char text[32], const shown *s) {
    size_t done = s->done - s->before;
    text[0] = 0;
    if (done > 0) {
        double seconds = s->elapsed_s / (double)done * (double)(s->total - s->done) + 0.5;
        unsigned long whole = (unsigned long)seconds;
        snprintf(text, 32, "  %lu:%02lu:%02lu left", whole / 3600, whole / 60 % 60, whole % 60);
    }
}

static void draw(const cli_progress *p, const shown *s) {
    char bar[WIDTH + 1], rate[16], speed[32] = "", left[32];
    size_t full = (size_t)((double)s->done / (double)s->total * WIDTH);
    for (size_t i = 0; i < WIDTH; i++) {
        bar[i] = i < full ? '#' : '.';
    }
    bar[WIDTH] = 0;
    if (s->rays > 0) {
        cli_progress_short(rate, s->elapsed_s > 0.0 ? (double)s->rays / s->elapsed_s : 0.0);
        snprintf(speed, sizeof speed, "  %srays/s", rate);
    }
    time_left(left, s);
    if (p->is_terminal) {
        fprintf(stderr, "\r\033[K[%s] %zu/%zu %s%s%s", bar, s->done, s->total, s->what, speed,
                left);
        fflush(stderr);
    } else {
        cli_note(p->c, "%zu of %zu %s%s%s", s->done, s->total, s->what, speed, left);
    }
}

/* Reports of a run and of the context may come from different threads. */
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

/* Now and then. */
static void show(cli_progress *p, const shown *s) {
    double time_s = cli_clock_s();
    pthread_mutex_lock(&lock);
    if (p->is_shown && time_s - p->last_s >= (p->is_terminal ? REDRAW_S : LINE_S)) {
        draw(p, s);
        p->last_s = time_s;
        p->is_drawn = p->is_terminal;
    }
    pthread_mutex_unlock(&lock);
}

void cli_progress_report(void *user, const asdic_run_progress *now) {
    cli_progress *p = user;
    bool is_new = now->elapsed_s < p->last.elapsed_s; /* another part of the work begins */
    if (p->resumed == SIZE_MAX || is_new) {
        p->resumed = is_new ? 0 : now->pings_done;
        p->first = (asdic_run_progress){0};
    }
    if (p->first.pings_done <= p->resumed) {
        p->first = *now;
    }
    p->last = *now;
    show(p, &(shown){.what = "pings",
                     .done = now->pings_done,
                     .total = now->pings_total,
                     .before = p->first.pings_done,
                     .elapsed_s = now->elapsed_s - p->first.elapsed_s,
                     .rays = now->rays - p->first.rays});
}

double cli_progress_rays_per_s(const cli_progress *p) {
    double elapsed_s = p->last.elapsed_s - p->first.elapsed_s;
    return elapsed_s > 0.0 ? (double)(p->last.rays - p->first.rays) / elapsed_s : 0.0;
}

/* The loop that counts WHAT; begun now where it is another or begins again. NULL where there are
 * too many. */
static cli_progress_loop *find_loop(cli_progress *p, const char *what, size_t done) {
    for (size_t i = 0; i < CLI_PROGRESS_LOOPS; i++) {
        cli_progress_loop *loop = &p->loops[i];
        if (!loop->what || strcmp(loop->what, what) == 0) {
            if (!loop->what || done < loop->done) {
                *loop = (cli_progress_loop){what, done, cli_clock_s()};
            }
            loop->done = done;
            return loop;
        }
    }
    return NULL;
}

void cli_progress_step(void *user, const char *what, size_t done, size_t total) {
    cli_progress *p = user;
    const cli_progress_loop *loop = find_loop(p, what, done);
    if (loop) {
        show(p, &(shown){.what = what,
                         .done = done,
                         .total = total,
                         .elapsed_s = cli_clock_s() - loop->begun_s});
    }
}

void cli_progress_watch(cli_progress *p) {
    asdic_context_set_progress(cli_context(p->c), cli_progress_step, p);
}

void cli_progress_end(cli_progress *p) {
    asdic_context_set_progress(cli_context(p->c), NULL, NULL);
    if (p->is_drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        p->is_drawn = false;
    }
}
