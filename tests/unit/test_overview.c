/*
 * The overview: what its cells hold, and that the picture shows them.
 */
#include "asserts.h"
#include "decoded.h"
#include "test_context.h"

#include "lib/out/overview.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>

static void overview_keeps_the_strongest(void **state) {
    (void)state;
    /* 3000 pings in groups of 3, 2 beams, 4 bins of 10 m; a gain of 20 log r decides. */
    asdic_overview o;
    const float noise_db[8] = {NAN, NAN, NAN, NAN, -100, -100, -100, -100};
    assert_int_equal(asdic_overview_init(ctx, 3000, 2, 4, 10.0, &o), ASDIC_OK);
    assert_int_equal(o.rows, 1000);
    asdic_overview_set_gain(&o, 20.0, 0.0);
    for (int ping = 0; ping < 3000; ping++) {
        float peak_db = ping == 301 ? 0.0f : -60.0f;
        /* Beam 0: -40 dB at 5 m (-26 shown), the peak at 15 m; beam 1: nothing 10 dB above noise. */
        const float levels_db[8] = {-40, peak_db, NAN, -70, -95, -95, NAN, -91};
        asdic_overview_add(&o, levels_db, noise_db, noise_db);
    }
    for (size_t row = 0; row < 1000; row++) {
        bool is_peak = row == 100;
        assert_close(o.range_m[2 * row], is_peak ? 15.0 : 5.0, 0);
        assert_close(o.shown_db[2 * row], is_peak ? 20.0 * log10(15.0) : -40.0 + 20.0 * log10(5.0),
                     1e-9);
        assert_true(isnan(o.shown_db[2 * row + 1]));
    }
    double low_db, high_db;
    asdic_overview_window(&o, &low_db, &high_db);
    assert_close(low_db, -30.0, 0);
    assert_close(high_db, 30.0, 0);
    asdic_overview_finish(&o);
}

/* 601 beams are shown two by two: each cell has the stronger of its own, the last beam one to itself. */
static void overview_groups_many_beams(void **state) {
    (void)state;
    enum { BEAMS = 601, COLUMNS = 301 };
    asdic_overview o;
    float levels_db[2][BEAMS], noise_db[BEAMS];
    for (int b = 0; b < BEAMS; b++) {
        levels_db[0][b] = (float)-b;
        levels_db[1][b] = (float)(b - 1000);
        noise_db[b] = NAN;
    }
    assert_int_equal(asdic_overview_init(ctx, 2, BEAMS, 1, 10.0, &o), ASDIC_OK);
    assert_int_equal(o.columns, COLUMNS);
    asdic_overview_add(&o, levels_db[0], noise_db, noise_db);
    asdic_overview_add(&o, levels_db[1], noise_db, noise_db);
    for (int c = 0; c < COLUMNS; c++) {
        int last = c == COLUMNS - 1 ? 2 * c : 2 * c + 1;
        assert_close(o.shown_db[c], -2.0 * c, 0.0);
        assert_close(o.shown_db[COLUMNS + c], last - 1000.0, 0.0);
        assert_close(o.range_m[c], 5.0, 0.0);
    }
    asdic_overview_finish(&o);
}

/* The gain is that of each bin's middle, and of no bin more than there are. */
static void overview_gain_is_of_its_bins(void **state) {
    (void)state;
    double gain_db[] = {7, 7, 7, 7};
    asdic_overview o = {.bins = 3, .bin_length_m = 10, .gain_db = gain_db};
    asdic_overview_set_gain(&o, 20.0, 0.1);
    assert_close(gain_db[0], 20.0 * log10(5.0) + 0.5, 1e-12);
    assert_close(gain_db[2], 20.0 * log10(25.0) + 2.5, 1e-12);
    assert_close(gain_db[3], 7.0, 0.0);
}

/* Whole tens about what is shown, ten at least, and some where nothing is. */
static void overview_has_room_for_its_levels(void **state) {
    (void)state;
    static const double cases[][4] = {
        {NAN, NAN, 0, 10}, {-37, NAN, -40, -30}, {-40, -40, -40, -30},  {-41, 12, -50, 20},
        {NAN, 20, 20, 30}, {-0.5, 0.5, -10, 10}, {-101, 105, -110, 110}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double shown_db[2] = {cases[i][0], cases[i][1]}, low_db, high_db;
        asdic_overview o = {.rows = 1, .columns = 2, .shown_db = shown_db};
        asdic_overview_window(&o, &low_db, &high_db);
        assert_close(low_db, cases[i][2], 0.0);
        assert_close(high_db, cases[i][3], 0.0);
    }
}

/* Reverberation that its gain makes rise to the last bin is no echo; a weaker one on it is. */
static void overview_leaves_out_the_last_bin(void **state) {
    (void)state;
    asdic_overview o;
    float levels_db[100], noise_db[100];
    assert_int_equal(asdic_overview_init(ctx, 1, 1, 100, 1.0, &o), ASDIC_OK);
    asdic_overview_set_gain(&o, 40.0, 0.0);
    for (size_t i = 0; i < 100; i++) {
        levels_db[i] = -50.0f - 30.0f * log10f((float)i + 0.5f) + (i == 60 ? 1.0f : 0.0f);
        noise_db[i] = NAN;
    }
    asdic_overview_add(&o, levels_db, noise_db, noise_db);
    assert_close(o.range_m[0], 60.5, 0);
    asdic_overview_finish(&o);
}

/* A ripple on what rises with the gain is none, as one that is smaller than its sampling error; an echo below is
 * shown. */
static void overview_leaves_out_ripples(void **state) {
    (void)state;
    static const struct {
        float ripple_db, error_db;
        double range_m;
    } cases[] = {{0.2f, NAN, 20.5}, {0.2f, 0.01f, 20.5}, {2.0f, 3.0f, 20.5}, {2.0f, 0.3f, 60.5}};
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_overview o;
        float levels_db[100], noise_db[100], errors_db[100];
        assert_int_equal(asdic_overview_init(ctx, 1, 1, 100, 1.0, &o), ASDIC_OK);
        asdic_overview_set_gain(&o, 40.0, 0.0);
        for (size_t i = 0; i < 100; i++) {
            float bump_db = i == 20 ? 4.0f : i == 60 ? cases[k].ripple_db : 0.0f;
            levels_db[i] = -50.0f - 30.0f * log10f((float)i + 0.5f) + bump_db;
            noise_db[i] = NAN;
            errors_db[i] = i == 60 ? cases[k].error_db : 0.1f;
        }
        asdic_overview_add(&o, levels_db, noise_db, errors_db);
        assert_close(o.range_m[0], cases[k].range_m, 0);
        asdic_overview_finish(&o);
    }
}

/* One beam of two at the top of the window, the other empty. */
static void the_strongest_is_brightest(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-overview-XXXXXX.png";
    asdic_picture_options options = asdic_picture_options_default();
    size_t width, height;
    close(mkstemps(path, 4));
    options.colormap = ASDIC_COLORMAP_VIRIDIS;
    if (!asdic_picture_annotated()) {
        unlink(path);
        skip();
    }
    asdic_overview o;
    const float levels_db[2] = {-60, NAN}, noise_db[2] = {NAN, NAN};
    const asdic_overview_axes axes = {0};
    assert_int_equal(asdic_overview_init(ctx, 1, 2, 1, 10.0, &o), ASDIC_OK);
    asdic_overview_add(&o, levels_db, noise_db, noise_db);
    assert_int_equal(asdic_draw_overview(ctx, path, &o, &axes, &options), ASDIC_OK);
    size_t bright = count_pixels(path, 0xfde725, &width, &height);
    assert_close((double)bright, 240.0 * 240.0, 400.0); /* the scale has a few of them */
    asdic_overview_finish(&o);
}

/* Pixels of the brightest colour in an overview of PINGS and 7 beams, LIT of which have an echo, in ping 0. */
static size_t lit_pixels(size_t pings, size_t lit, size_t *height) {
    char path[] = "/tmp/asdic-overview-XXXXXX.png";
    asdic_picture_options options = asdic_picture_options_default();
    const asdic_overview_axes axes = {0};
    float levels_db[7], noise_db[7];
    asdic_overview o;
    size_t width;
    close(mkstemps(path, 4));
    options.colormap = ASDIC_COLORMAP_VIRIDIS;
    assert_int_equal(asdic_overview_init(ctx, pings, 7, 1, 10.0, &o), ASDIC_OK);
    for (size_t ping = 0; ping < pings; ping++) {
        for (size_t b = 0; b < 7; b++) {
            levels_db[b] = ping == 0 && b < lit ? -60.0f : NAN;
            noise_db[b] = NAN;
        }
        asdic_overview_add(&o, levels_db, noise_db, noise_db);
    }
    assert_int_equal(asdic_draw_overview(ctx, path, &o, &axes, &options), ASDIC_OK);
    asdic_overview_finish(&o);
    return count_pixels(path, 0xfde725, &width, height);
}

/* A cell is whole pixels: 68 wide where 7 share 480, and as many high as fit into 720, from 1 to 240. */
static void cells_of_an_overview_are_whole_pixels(void **state) {
    (void)state;
    static const struct {
        size_t pings, cell_px, rows_px;
    } expected[] = {{5, 144, 720}, {11, 65, 715}, {2, 240, 480}, {1000, 1, 1000}};
    if (!asdic_picture_annotated()) {
        skip();
    }
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        size_t height, one = lit_pixels(expected[i].pings, 1, &height);
        size_t two = lit_pixels(expected[i].pings, 2, &height);
        assert_int_equal(two - one, 68 * expected[i].cell_px); /* without what the scale has */
        assert_in_range(height, expected[i].rows_px + 60, expected[i].rows_px + 250);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_of_an_overview_are_whole_pixels),
        cmocka_unit_test(overview_keeps_the_strongest),
        cmocka_unit_test(overview_groups_many_beams),
        cmocka_unit_test(overview_gain_is_of_its_bins),
        cmocka_unit_test(overview_has_room_for_its_levels),
        cmocka_unit_test(overview_leaves_out_the_last_bin),
        cmocka_unit_test(overview_leaves_out_ripples),
        cmocka_unit_test(the_strongest_is_brightest),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
