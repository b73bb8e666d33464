#include "progress.h"

#include <string.h>
#include <unistd.h>

#define WIDTH 24
#define REDRAW_S 0.1

cli_progress cli_progress_begin(const cli *c) {
    return (cli_progress){
        .is_shown = !cli_quiet(c) && isatty(STDERR_FILENO), .resumed = SIZE_MAX, .last_s = -1.0};
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

static void draw(const cli_progress *p, const asdic_run_progress *now) {
    char bar[WIDTH + 1], rate[16], left[32] = "";
    double share = (double)now->pings_done / (double)now->pings_total;
    size_t full = (size_t)(share * WIDTH);
    for (size_t i = 0; i < WIDTH; i++) {
        bar[i] = i < full ? '#' : '.';
    }
    bar[WIDTH] = 0;
    size_t done = now->pings_done - p->resumed;
    cli_progress_short(rate, now->elapsed_s > 0.0 ? (double)now->rays / now->elapsed_s : 0.0);
    if (done > 0) {
        double seconds =
            now->elapsed_s / (double)done * (double)(now->pings_total - now->pings_done) + 0.5;
        unsigned long whole = (unsigned long)seconds;
        snprintf(left, sizeof left, "  %lu:%02lu:%02lu left", whole / 3600, whole / 60 % 60,
                 whole % 60);
    }
    fprintf(stderr, "\r\033[K[%s] %zu/%zu pings  %srays/s%s", bar, now->pings_done,
            now->pings_total, rate, left);
    fflush(stderr);
}

void cli_progress_report(void *user, const asdic_run_progress *now) {
    cli_progress *p = user;
    if (p->resumed == SIZE_MAX) {
        p->resumed = now->pings_done;
    }
    p->last = *now;
    if (p->is_shown && now->elapsed_s - p->last_s >= REDRAW_S) {
        draw(p, now);
        p->last_s = now->elapsed_s;
        p->is_drawn = true;
    }
}

void cli_progress_end(cli_progress *p) {
    if (p->is_drawn) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        p->is_drawn = false;
    }
}
