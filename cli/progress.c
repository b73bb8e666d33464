#include "progress.h"

#include <string.h>
#include <unistd.h>

#define WIDTH 24
#define REDRAW_S 0.1
#define LINE_S 10.0

cli_progress cli_progress_begin(const cli *c) {
    return (cli_progress){.c = c,
                          .is_shown = !cli_quiet(c),
                          .is_terminal = isatty(STDERR_FILENO),
                          .resumed = SIZE_MAX};
}

void cli_progress_short(char text[16], double value) {
    static const char units[] = " kMGT";
    size_t unit = 0;
    while (value >= 1000.0 && unit + 2 < sizeof units) {
        value /= 1000.0;
        unit++;
    }
    const char *format = value < 10.0 ? "%.2f %c" : value < 100.0 ? "%.1f %c" : "%.0f %c";
    snprintf(text, 16, unit ? format : "%.0f ", value, units[unit]);
}

/* "0:01:23 left", or "" at the beginning. */
static void time_left(char text[32], const cli_progress *p, const asdic_run_progress *now) {
    size_t done = now->pings_done - p->resumed;
    text[0] = 0;
    if (done > 0) {
        double seconds =
            now->elapsed_s / (double)done * (double)(now->pings_total - now->pings_done) + 0.5;
        unsigned long whole = (unsigned long)seconds;
        snprintf(text, 32, "  %lu:%02lu:%02lu left", whole / 3600, whole / 60 % 60, whole % 60);
    }
}

static void draw(const cli_progress *p, const asdic_run_progress *now) {
    char bar[WIDTH + 1], rate[16], speed[32] = "", left[32];
    double share = (double)now->pings_done / (double)now->pings_total;
    size_t full = (size_t)(share * WIDTH);
    for (size_t i = 0; i < WIDTH; i++) {
        bar[i] = i < full ? '#' : '.';
    }
    bar[WIDTH] = 0;
    if (now->rays > 0) {
        cli_progress_short(rate, now->elapsed_s > 0.0 ? (double)now->rays / now->elapsed_s : 0.0);
        snprintf(speed, sizeof speed, "  %srays/s", rate);
    }
    time_left(left, p, now);
    if (p->is_terminal) {
        fprintf(stderr, "\r\033[K[%s] %zu/%zu pings%s%s", bar, now->pings_done, now->pings_total,
                speed, left);
        fflush(stderr);
    } else {
        cli_note(p->c, "%zu of %zu pings%s%s", now->pings_done, now->pings_total, speed, left);
    }
}

void cli_progress_report(void *user, const asdic_run_progress *now) {
    cli_progress *p = user;
    bool is_new = now->elapsed_s < p->last.elapsed_s; /* another part of the work begins */
    if (p->resumed == SIZE_MAX || is_new) {
        p->resumed = is_new ? 0 : now->pings_done;
        p->last_s = p->is_terminal ? -1.0 : 0.0;
    }
    p->last = *now;
    if (p->is_shown && now->elapsed_s - p->last_s >= (p->is_terminal ? REDRAW_S : LINE_S)) {
        draw(p, now);
        p->last_s = now->elapsed_s;
        p->is_drawn = p->is_terminal;
    }
}

void cli_progress_end(cli_progress *p) {
    if (p->is_drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        p->is_drawn = false;
    }
}
