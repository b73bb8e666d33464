/*
 * A-scopes: the panels, curves and axes that are drawn, seen where they are handed on.
 */
#include "asserts.h"
#include "test_context.h"

#include <asdic/output.h>

#include <math.h>
#include <string.h>

#define MOST_BEAMS 8
#define MOST_POINTS 64

/* What the last call was to draw. */
static size_t panel_count;
static asdic_plot panels[MOST_BEAMS + 1];
static asdic_series series[MOST_BEAMS + 1][8];
static double xs[MOST_BEAMS + 1][8][MOST_POINTS], ys[MOST_BEAMS + 1][8][MOST_POINTS];

asdic_status __wrap_asdic_picture_plot(asdic_context *c, const char *path, const asdic_plot *p,
                                       size_t count, const asdic_picture_options *options);

asdic_status __wrap_asdic_picture_plot(asdic_context *c, const char *path, const asdic_plot *p,
                                       size_t count, const asdic_picture_options *options) {
    (void)c;
    (void)path;
    (void)options;
    assert_in_range(count, 1, MOST_BEAMS + 1);
    panel_count = count;
    for (size_t i = 0; i < count; i++) {
        panels[i] = p[i];
        assert_in_range(p[i].series_count, 0, 8);
        for (size_t k = 0; k < p[i].series_count; k++) {
            const asdic_series *s = &p[i].series[k];
            series[i][k] = *s;
            assert_in_range(s->count, 0, MOST_POINTS);
            memcpy(xs[i][k], s->x, s->count * sizeof *s->x);
            memcpy(ys[i][k], s->y, s->count * sizeof *s->y);
        }
    }
    return ASDIC_OK;
}

static void draw(const asdic_ascope *beams, size_t count) {
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = -140.0;
    options.db_high = -20.0;
    assert_ok(ctx, asdic_picture_ascope(ctx, "p.png", beams, count, &options));
}

/* In the order of drawing; the colours are those of Okabe and Ito. */
static const struct {
    const char *label;
    uint32_t rgb;
} looks[] = {{"noise", 0xe69f00},          {"volume", 0x009e73},    {"surface", 0x56b4e9},
             {"bottom", 0x0072b2},         {"multipath", 0xcc79a7}, {"object", 0xd55e00},
             {"expected total", 0xb4b4b4}, {"simulated", 0}};

static void curves_are_the_levels(void **state) {
    (void)state;
    enum { BINS = 5 };
    float db[8][BINS];
    for (size_t k = 0; k < 8; k++) {
        for (size_t i = 0; i < BINS; i++) {
            db[k][i] = i == 2 ? NAN : -30.0f - 10.0f * (float)k - (float)i;
        }
    }
    const float lone_db[2] = {-50.0f, -51.5f}, dark_db[1] = {NAN};
    const asdic_ascope beams[3] = {
        {.title = "all",
         .bins = BINS,
         .bin_length_m = 0.5,
         .noise_db = db[0],
         .volume_db = db[1],
         .surface_db = db[2],
         .bottom_db = db[3],
         .multipath_db = db[4],
         .object_db = db[5],
         .total_db = db[6],
         .simulated_db = db[7]},
        {.title = "lone",
         .bins = 1,
         .bin_length_m = 40.0,
         .total_db = &lone_db[0],
         .simulated_db = &lone_db[1]},
        {.title = "dark", .bins = 1, .bin_length_m = 40.0, .total_db = dark_db}};
    draw(beams, 3);
    assert_int_equal(panel_count, 4);
    static const char *const titles[] = {"all", "lone", "dark", "simulated \u2212 expected"};
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(panels[i].title, titles[i]);
        assert_string_equal(panels[i].x.label, "range (m)");
        assert_true(panels[i].x.low == 0.0 && panels[i].x.high == (i == 0 || i == 3 ? 2.5 : 40.0));
        assert_string_equal(panels[i].y.label, i < 3 ? "level (dB re 1 \u00b5Pa)" : "dB");
        assert_true(i == 3 || (panels[i].y.low == -140.0 && panels[i].y.high == -20.0));
        assert_int_equal(panels[i].series_count, i < 3 ? 8 : 2);
    }
    for (size_t k = 0; k < 8; k++) {
        for (size_t i = 0; i < 3; i++) { /* all are in the legend */
            assert_string_equal(series[i][k].label, looks[k].label);
            assert_int_equal(series[i][k].rgb, looks[k].rgb);
        }
        assert_int_equal(series[0][k].count, BINS);
        assert_int_equal(series[1][k].count, k < 6 ? 0 : 2); /* of a bin both ends */
        assert_int_equal(series[2][k].count, k == 6 ? 2 : 0);
        for (size_t i = 0; i < BINS; i++) {
            assert_close(xs[0][k][i], 0.25 + 0.5 * (double)i, 1e-12);
            if (i != 2) {
                assert_close(ys[0][k][i], (double)db[k][i], 0.0);
            } else if (k == 4 || k == 5) {
                assert_true(ys[0][k][i] < -1000.0); /* a short echo rises from the floor */
            } else {
                assert_true(isnan(ys[0][k][i]));
            }
        }
    }
    for (size_t i = 0; i < 2; i++) {
        assert_true(xs[1][6][i] == 40.0 * (double)i && ys[1][6][i] == -50.0 &&
                    ys[1][7][i] == -51.5);
        assert_true(xs[3][1][i] == 40.0 * (double)i && ys[3][1][i] == -1.5);
    }
    /* Simulated less expected, a colour for each beam. */
    assert_true(panels[3].y.low == -10.0 && panels[3].y.high == 10.0);
    assert_string_equal(series[3][0].label, "all");
    assert_string_equal(series[3][1].label, "lone");
    assert_true(series[3][0].rgb != series[3][1].rgb);
    assert_true(series[3][0].count == BINS && series[3][1].count == 2);
    for (size_t i = 0; i < BINS; i++) {
        assert_close(xs[3][0][i], 0.25 + 0.5 * (double)i, 1e-12);
        assert_true(i == 2 ? isnan(ys[3][0][i]) : ys[3][0][i] == -10.0);
    }
    /* A curve without a level in any beam is none. */
    draw(&beams[2], 1);
    assert_int_equal(panel_count, 1);
    assert_int_equal(panels[0].series_count, 0);
}

/* 95 of 100 differences fit; what is louder than 20 dB gets 40. */
static void residuals_fit_their_panel(void **state) {
    (void)state;
    enum { BINS = 41 };
    static const double heights[][2] = {{0.4, 0.5},   {0.6, 1.0},   {1.5, 2.0},
                                        {4.0, 5.0},   {9.0, 10.0},  {10.0, 10.0},
                                        {19.0, 20.0}, {21.0, 40.0}, {70.0, 40.0}};
    for (size_t i = 0; i < sizeof heights / sizeof *heights; i++) {
        for (size_t loud = 2; loud < 4; loud++) { /* of 41, the third of which counts */
            float total_db[BINS], simulated_db[BINS];
            for (size_t n = 0; n < BINS; n++) {
                double off_db = n < loud ? heights[i][0] : 0.1;
                total_db[n] = -80.0f;
                simulated_db[n] = total_db[n] + (float)(n % 2 ? off_db : -off_db);
            }
            const asdic_ascope beam = {.bins = BINS,
                                       .bin_length_m = 1.0,
                                       .total_db = total_db,
                                       .simulated_db = simulated_db};
            draw(&beam, 1);
            assert_int_equal(panel_count, 2);
            assert_close(panels[1].y.high, loud == 2 ? 0.5 : heights[i][1], 0.0);
            assert_close(panels[1].y.low, -panels[1].y.high, 0.0);
        }
    }
}

/* Eight beams, the first with the quietest differences; nine are refused. */
static void beams_are_as_many_as_there_are_colours(void **state) {
    (void)state;
    float total_db[2] = {-80.0f, -81.0f}, simulated_db[9][2];
    asdic_ascope beams[9];
    for (size_t i = 0; i < 9; i++) {
        simulated_db[i][0] = simulated_db[i][1] = -80.5f + 2.0f * (float)i;
        beams[i] = (asdic_ascope){.title = "b",
                                  .bins = 2,
                                  .bin_length_m = 1.0,
                                  .total_db = total_db,
                                  .simulated_db = simulated_db[i]};
    }
    draw(beams, 8);
    assert_int_equal(panel_count, 9);
    assert_int_equal(panels[8].series_count, 8);
    assert_close(panels[8].y.high, 20.0, 0.0);
    for (size_t i = 0; i < 8; i++) {
        for (size_t k = 0; k < i; k++) {
            assert_true(series[8][i].rgb != series[8][k].rgb);
        }
    }
    asdic_picture_options options = asdic_picture_options_default();
    assert_status(ctx, asdic_picture_ascope(ctx, "p.png", beams, 9, &options),
                  ASDIC_ERROR_ARGUMENT);
    assert_string_equal(asdic_context_error(ctx), "an A-scope shows 1..8 beams, not 9");
    assert_status(ctx, asdic_picture_ascope(ctx, "p.png", beams, 0, &options),
                  ASDIC_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_are_the_levels),
        cmocka_unit_test(residuals_fit_their_panel),
        cmocka_unit_test(beams_are_as_many_as_there_are_colours),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
