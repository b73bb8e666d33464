/* Speed against error as a table, JSON, CSV and a picture. */
#include "bench_error.h"
#include "json.h"

#include <math.h>

static double factor(double baseline, double value) {
    return baseline / value;
}

static void print_number(double value, const char *format, const char *missing) {
    if (isfinite(value)) {
        printf(format, value);
    } else {
        printf("%s", missing);
    }
}

static void print_1db(const bench_curve *curve, const bench_curve *baseline) {
    double rays = factor(baseline->rays_1db, curve->rays_1db);
    double seconds = factor(baseline->seconds_1db, curve->seconds_1db);
    printf("  %-14s 1 dB with ", bench_sampler_name(curve->sampler));
    print_number(curve->rays_1db, "%.4g rays", "- rays");
    print_number(1e3 * curve->seconds_1db, " in %.4g ms", "");
    if (curve != baseline) {
        print_number(rays, ": %.4gx fewer rays", "");
        print_number(seconds, ", %.4gx less time than the uniform sphere", "");
    }
    printf("\n");
}

/* Of many bins, as part of the time of few. */
static double bins_cost(const bench_result *r) {
    return r->bins_cost.many_s / r->bins_cost.few_s - 1.0;
}

void bench_error_print(const bench_result *r, bool first) {
    const bench_scene *s = &r->scene;
    printf("%s%s: %zu beam%s, %zu bins of %g m, from %g m; ", first ? "" : "\n", s->name, s->beams,
           s->beams == 1 ? "" : "s", s->bins, s->sonar.bin_length_m,
           (double)s->first_bin * s->sonar.bin_length_m);
    if (s->exact) {
        printf("truth: quadrature\n");
    } else {
        printf("truth: %.3g rays in one lattice a ping, good to %.2g dB\n", s->reference_rays,
               s->spread_db);
    }
    printf("  %-14s %8s %5s %8s %8s %8s %8s  %11s %6s %9s %7s\n", "sampler", "rays", "pings",
           "RMS dB", "far dB", "max dB", "bias dB", "true/stated", "far", "ms/ping", "learn %");
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        for (size_t i = 0; i < r->curves[k].count; i++) {
            const bench_point *p = &r->curves[k].points[i];
            printf("  %-14s %8u %5zu %8.4f %8.4f %8.3f %8.4f  %11.2f %6.2f %9.3f %7.1f\n",
                   bench_sampler_name(r->curves[k].sampler), p->rays, p->pings, p->rms_db,
                   p->far_rms_db, p->most_db, p->bias_db, p->honesty, p->far_honesty,
                   1e3 * p->ping_s, 100.0 * p->learn_share);
        }
    }
    for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
        print_1db(&r->curves[k], &r->curves[BENCH_SAMPLERS - 1]);
    }
    printf("  stderr_db costs %.1f %% of the time without it\n", 100.0 * r->stated_cost);
    printf("  %d bins cost %.1f %% more time than %d: %.3f and %.3f ms/ping\n", BENCH_MANY_BINS,
           100.0 * bins_cost(r), BENCH_FEW_BINS, 1e3 * r->bins_cost.many_s,
           1e3 * r->bins_cost.few_s);
}

static void json_curve(json *j, const bench_curve *curve, const bench_curve *baseline) {
    json_open(j, NULL, '{');
    json_text(j, "sampler", bench_sampler_name(curve->sampler));
    json_number(j, "rays_for_1db", curve->rays_1db);
    json_number(j, "seconds_for_1db", curve->seconds_1db);
    json_number(j, "fewer_rays", factor(baseline->rays_1db, curve->rays_1db));
    json_number(j, "less_time", factor(baseline->seconds_1db, curve->seconds_1db));
    json_open(j, "points", '[');
    for (size_t i = 0; i < curve->count; i++) {
        const bench_point *p = &curve->points[i];
        json_open(j, NULL, '{');
        json_integer(j, "rays", p->rays);
        json_integer(j, "pings", p->pings);
        json_number(j, "rms_db", p->rms_db);
        json_number(j, "far_rms_db", p->far_rms_db);
        json_number(j, "max_db", p->most_db);
        json_number(j, "bias_db", p->bias_db);
        json_number(j, "true_over_stated", p->honesty);
        json_number(j, "far_true_over_stated", p->far_honesty);
        json_number(j, "ping_s", p->ping_s);
        json_number(j, "learn_share", p->learn_share);
        json_close(j);
    }
    json_close(j);
    json_close(j);
}

void bench_error_json(const bench_result *results, size_t count, const asdic_device_info *device) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "version", asdic_version());
    json_text(&j, "device", device->name);
    json_integer(&j, "learn_block", ASDIC_LEARN_BLOCK);
    json_open(&j, "scenes", '[');
    for (size_t i = 0; i < count; i++) {
        const bench_scene *s = &results[i].scene;
        json_open(&j, NULL, '{');
        json_text(&j, "scene", s->name);
        json_integer(&j, "beams", s->beams);
        json_integer(&j, "bins", s->bins);
        json_text(&j, "reference", s->exact ? "quadrature" : "mean of pings");
        json_number(&j, "reference_rays", s->reference_rays);
        json_number(&j, "reference_spread_db", s->spread_db);
        json_number(&j, "stated_error_cost", results[i].stated_cost);
        json_number(&j, "ping_s_of_150_bins", results[i].bins_cost.few_s);
        json_number(&j, "ping_s_of_2048_bins", results[i].bins_cost.many_s);
        json_open(&j, "curves", '[');
        for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
            json_curve(&j, &results[i].curves[k], &results[i].curves[BENCH_SAMPLERS - 1]);
        }
        json_close(&j);
        json_close(&j);
    }
    json_close(&j);
    json_close(&j);
}

int bench_error_csv(const cli *c, const char *path, const bench_result *results, size_t count) {
    FILE *file = bench_begin_file(c, path);
    if (!file) {
        return CLI_FAILED;
    }
    fprintf(file, "scene,sampler,rays,pings,rms_db,far_rms_db,max_db,bias_db,true_over_stated,"
                  "far_true_over_stated,ping_s,learn_share,reference_spread_db,stated_error_cost,"
                  "bins_cost\n");
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < BENCH_SAMPLERS; k++) {
            for (size_t n = 0; n < results[i].curves[k].count; n++) {
                const bench_point *p = &results[i].curves[k].points[n];
                fprintf(file,
                        "%s,%s,%u,%zu,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.6g,%.4g,%.4g\n",
                        results[i].scene.name, bench_sampler_name(results[i].curves[k].sampler),
                        p->rays, p->pings, p->rms_db, p->far_rms_db, p->most_db, p->bias_db,
                        p->honesty, p->far_honesty, p->ping_s, p->learn_share,
                        results[i].scene.spread_db, results[i].stated_cost, bins_cost(&results[i]));
            }
        }
    }
    return bench_end_file(c, file, path);
}

/* Two panels: error over rays, error over time. A colour per sampler, a line style per scene. */
asdic_status bench_error_picture(const cli *c, const char *path, const bench_result *results,
                                 size_t count) {
    enum { MOST_SCENES = 8 };
    static const uint32_t colors[BENCH_SAMPLERS] = {0x0072b2, 0x009e73, 0xd55e00};
    static const asdic_line_style styles[4] = {ASDIC_LINE_SOLID, ASDIC_LINE_DASHED,
                                               ASDIC_LINE_DOTTED, ASDIC_LINE_DASH_DOT};
    static double x[2][MOST_SCENES * BENCH_SAMPLERS][BENCH_MOST_POINTS];
    static double y[MOST_SCENES * BENCH_SAMPLERS][BENCH_MOST_POINTS];
    static char labels[MOST_SCENES * BENCH_SAMPLERS][96];
    asdic_series series[2][MOST_SCENES * BENCH_SAMPLERS];
    size_t n = 0;
    for (size_t i = 0; i < count && i < MOST_SCENES; i++) {
        for (size_t k = 0; k < BENCH_SAMPLERS; k++, n++) {
            const bench_curve *curve = &results[i].curves[k];
            for (size_t p = 0; p < curve->count; p++) {
                x[0][n][p] = curve->points[p].rays;
                x[1][n][p] = 1e3 * curve->points[p].ping_s;
                y[n][p] = curve->points[p].rms_db;
            }
            snprintf(labels[n], sizeof labels[n], "%s, %s", results[i].scene.name,
                     bench_sampler_name(curve->sampler));
            for (int panel = 0; panel < 2; panel++) {
                series[panel][n] = (asdic_series){.label = labels[n],
                                                  .x = x[panel][n],
                                                  .y = y[n],
                                                  .count = curve->count,
                                                  .rgb = colors[k],
                                                  .width = 1.5,
                                                  .style = styles[i % 4]};
            }
        }
    }
    const asdic_plot_axis error = {"RMS error, dB", 1e-3, 100.0, true};
    const asdic_plot panels[2] = {{.x = {"rays per ping", 50.0, 1e7, true},
                                   .y = error,
                                   .series = series[0],
                                   .series_count = n},
                                  {.x = {"milliseconds per ping", 0.02, 1e3, true},
                                   .y = error,
                                   .series = series[1],
                                   .series_count = n}};
    asdic_picture_options options = asdic_picture_options_default();
    options.title = "Error of a ping against its cost";
    return asdic_picture_plot(cli_context(c), path, panels, 2, &options);
}
