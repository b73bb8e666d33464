/* `asdic bench error`: what error a number of rays leaves, and what it costs. */
#include "bench_error.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const bench_column bench_error_columns[] = {{"scene", "scene", 14, 0, 0.0},
                                            {"sampler", "sampler", 14, 0, 0.0},
                                            {"rays", "rays", 8, 0, 0.0},
                                            {"pings", "pings", 5, 0, 0.0},
                                            {"rms_db", "RMS dB", 8, 4, 0.0},
                                            {"far_rms_db", "far dB", 8, 4, 0.0},
                                            {"max_db", "max dB", 8, 3, 0.0},
                                            {"bias_db", "bias dB", 8, 4, 0.0},
                                            {"true_over_stated", "true/stated", 11, 2, 0.0},
                                            {"far_true_over_stated", "far", 6, 2, 0.0},
                                            {"ping_s", "ms/ping", 9, 3, 1e3},
                                            {"learn_share", "learn %", 7, 1, 100.0},
                                            {"beams", NULL, 0, 0, 0.0},
                                            {"bins", NULL, 0, 0, 0.0},
                                            {"reference", NULL, 0, 0, 0.0},
                                            {"reference_rays", NULL, 0, 0, 0.0},
                                            {"reference_spread_db", NULL, 0, 0, 0.0},
                                            {"rays_for_1db", NULL, 0, 0, 0.0},
                                            {"seconds_for_1db", NULL, 0, 0, 0.0},
                                            {"fewer_rays", NULL, 0, 0, 0.0},
                                            {"less_time", NULL, 0, 0, 0.0},
                                            {NULL, NULL, 0, 0, 0.0}};

/* A finished scene: its curves, the baseline last. */
typedef struct result {
    bench_scene scene;
    bench_curve curves[BENCH_SAMPLERS];
} result;

bench_effort bench_effort_of(bool quick) {
    return quick ? (bench_effort){.blocks = 4,
                                  .point_rays = 1u << 20,
                                  .reference_pings = 16,
                                  .reference_rays = 1u << 18}
                 : (bench_effort){.blocks = 16,
                                  .point_rays = 1u << 22,
                                  .reference_pings = 96,
                                  .reference_rays = 1u << 20};
}

static void add_rows(bench *b, const bench_scene *s, const bench_curve *curve,
                     const bench_curve *baseline) {
    for (size_t i = 0; i < curve->count; i++) {
        const bench_point *p = &curve->points[i];
        const bench_cell cells[] = {BENCH_TEXT(s->name),
                                    BENCH_TEXT(bench_sampler_name(curve->sampler)),
                                    BENCH_NUMBER(p->rays),
                                    BENCH_NUMBER(p->pings),
                                    BENCH_NUMBER(p->rms_db),
                                    BENCH_NUMBER(p->far_rms_db),
                                    BENCH_NUMBER(p->most_db),
                                    BENCH_NUMBER(p->bias_db),
                                    BENCH_NUMBER(p->honesty),
                                    BENCH_NUMBER(p->far_honesty),
                                    BENCH_NUMBER(p->ping_s),
                                    BENCH_NUMBER(p->learn_share),
                                    BENCH_NUMBER(s->beams),
                                    BENCH_NUMBER(s->bins),
                                    BENCH_TEXT(s->exact ? "quadrature" : "mean of pings"),
                                    BENCH_NUMBER(s->reference_rays),
                                    BENCH_NUMBER(s->spread_db),
                                    BENCH_NUMBER(curve->rays_1db),
                                    BENCH_NUMBER(curve->seconds_1db),
                                    BENCH_NUMBER(baseline->rays_1db / curve->rays_1db),
                                    BENCH_NUMBER(baseline->seconds_1db / curve->seconds_1db)};
        bench_add(b, cells);
    }
}

static void say(const bench *b, const result *r) {
    const bench_scene *s = &r->scene;
    const bench_curve *baseline = &r->curves[BENCH_SAMPLERS - 1];
    bench_say(b, "%s: %zu beam%s, %zu bins of %g m, counted from %g m; truth: ", s->name, s->beams,
              cli_plural(s->beams), s->bins, s->sonar.bin_length_m,
              (double)s->first_bin * s->sonar.bin_length_m);
    if (s->exact) {
        bench_say(b, "quadrature\n");
    } else {
        bench_say(b, "%.3g rays, good to %.2g dB\n", s->reference_rays, s->spread_db);
    }
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        const bench_curve *curve = &r->curves[k];
        if (isfinite(curve->rays_1db)) {
            bench_say(b, "  %-14s 1 dB with %.4g rays in %.4g ms",
                      bench_sampler_name(curve->sampler), curve->rays_1db,
                      1e3 * curve->seconds_1db);
            if (curve != baseline && isfinite(baseline->rays_1db)) {
                bench_say(b, ": %.4gx fewer rays, %.4gx less time than the uniform sphere",
                          baseline->rays_1db / curve->rays_1db,
                          baseline->seconds_1db / curve->seconds_1db);
            }
            bench_say(b, "\n");
        }
    }
    bench_say(b, "\n");
}

static asdic_status measure(bench *b, size_t index, result *r) {
    static const asdic_sampler samplers[BENCH_SAMPLERS] = {
        ASDIC_SAMPLER_ADAPTIVE, ASDIC_SAMPLER_BEAM, ASDIC_SAMPLER_UNIFORM_SPHERE};
    bench_effort effort = bench_effort_of(b->quick);
    TRY(bench_scene_open(b, index, &effort, &r->scene));
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        r->curves[k].sampler = samplers[k];
        TRY(bench_curve_measure(b, &r->scene, &effort, &r->curves[k]));
    }
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        add_rows(b, &r->scene, &r->curves[k], &r->curves[BENCH_SAMPLERS - 1]);
    }
    say(b, r);
    return ASDIC_OK;
}

/* Makes AXIS hold all COUNT VALUES, by whole decades. */
static void hold(asdic_plot_axis *axis, const double *values, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (values[i] > 0.0 && isfinite(values[i])) {
            axis->low = fmin(axis->low, pow(10.0, floor(log10(values[i]))));
            axis->high = fmax(axis->high, pow(10.0, ceil(log10(values[i]))));
        }
    }
}

/* Two panels: error over rays, error over time. A colour per sampler, a line style per scene. */
static asdic_status draw(const bench *b, const result *results, size_t count) {
    static const uint32_t colors[BENCH_SAMPLERS] = {0x0072b2, 0x009e73, 0xd55e00};
    static const asdic_line_style styles[4] = {ASDIC_LINE_SOLID, ASDIC_LINE_DASHED,
                                               ASDIC_LINE_DOTTED, ASDIC_LINE_DASH_DOT};
    static double x[2][BENCH_MOST_DRAWN * BENCH_SAMPLERS][BENCH_MOST_POINTS];
    static double y[BENCH_MOST_DRAWN * BENCH_SAMPLERS][BENCH_MOST_POINTS];
    asdic_series series[2][BENCH_MOST_DRAWN * BENCH_SAMPLERS + BENCH_MOST_DRAWN + BENCH_SAMPLERS];
    size_t n = 0, entries = 0;
    for (; n < count * BENCH_SAMPLERS; n++) {
        size_t scene = n / BENCH_SAMPLERS, k = n % BENCH_SAMPLERS;
        const bench_curve *curve = &results[scene].curves[k];
        for (size_t p = 0; p < curve->count; p++) {
            x[0][n][p] = curve->points[p].rays;
            x[1][n][p] = 1e3 * curve->points[p].ping_s;
            y[n][p] = curve->points[p].rms_db;
        }
        for (int panel = 0; panel < 2; panel++) {
            series[panel][n] = (asdic_series){.x = x[panel][n],
                                              .y = y[n],
                                              .count = curve->count,
                                              .rgb = colors[k],
                                              .width = 1.5,
                                              .style = styles[scene % 4]};
        }
    }
    /* The legend names colours and styles, not their every product. */
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        series[0][n + entries++] =
            (asdic_series){.label = bench_sampler_name(results[0].curves[k].sampler),
                           .rgb = colors[k],
                           .width = 2.5};
    }
    for (size_t scene = 0; scene < count; scene++) {
        series[0][n + entries++] = (asdic_series){.label = results[scene].scene.name,
                                                  .rgb = 0x606060,
                                                  .width = 1.5,
                                                  .style = styles[scene % 4]};
    }
    asdic_plot_axis error = {
        .label = "r.m.s. error (dB)", .low = 1e-3, .high = 100.0, .logarithmic = true};
    const asdic_plot_axis rays = {
        .label = "rays per ping", .low = 50.0, .high = 1e7, .logarithmic = true};
    asdic_plot_axis time = {
        .label = "time of a ping (ms)", .low = 0.02, .high = 1e3, .logarithmic = true};
    for (size_t i = 0; i < n; i++) {
        hold(&error, y[i], series[1][i].count);
        hold(&time, x[1][i], series[1][i].count);
    }
    const asdic_plot panels[2] = {
        {.x = rays, .y = error, .series = series[0], .series_count = n + entries},
        {.x = time, .y = error, .series = series[1], .series_count = n}};
    asdic_picture_options options = asdic_picture_options_default();
    char facts[ASDIC_SUBTITLE_SIZE] = "", title[ASDIC_SUBTITLE_SIZE + 64];
    bool is_one = true;
    for (size_t scene = count; scene-- > 0;) {
        const asdic_sonar *sonar = &results[scene].scene.sonar;
        snprintf(title, sizeof title, "%s", facts);
        asdic_picture_subtitle(sonar, sonar->bin_length_m, facts);
        is_one = is_one && (scene + 1 == count || strcmp(title, facts) == 0);
    }
    snprintf(title, sizeof title, "Error of a ping against its cost\n%s",
             is_one ? facts : "sonars that differ");
    const char *const texts[] = {"Software", "asdic", "Title", title, NULL};
    options.title = title;
    options.texts = texts;
    return asdic_picture_plot(cli_context(b->c), b->picture, panels, 2, &options);
}

asdic_status bench_error(bench *b) {
    size_t count = bench_scene_count(b);
    result *results = calloc(count, sizeof *results);
    asdic_status status = results ? ASDIC_OK : ASDIC_ERROR_MEMORY;
    for (size_t i = 0; !status && i < count; i++) {
        status = measure(b, i, &results[i]);
    }
    if (!status && b->picture) {
        status = draw(b, results, count);
    }
    for (size_t i = 0; results && i < count; i++) {
        bench_scene_finish(&results[i].scene);
    }
    free(results);
    return status;
}
