/* Panels of a view: their words, axes and curves. */
#include "view_ink.h"

#include "live/panel.h"
#include "out/colormap.h"

/* Cairo draws nothing more once it is given half a character. */
static void texts_lose_what_is_no_text(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"b\xe9ton", "bton"}, {"\u65e5\xe6\x97", "\u65e5"}, {"\xe9", ""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_close(asdic_canvas_text_width(cases[i][0], 12.0),
                     asdic_canvas_text_width(cases[i][1], 12.0), 0.0);
    }
    asdic_canvas canvas = {0};
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, 100, 20);
    canvas.cr = cairo_create(surface);
    word_count = 0;
    asdic_canvas_text(&canvas, (asdic_lettering){.size_px = 12.0}, "b\xe9ton");
    assert_string_equal(words[0].text, "bton");
    assert_int_equal(cairo_status(canvas.cr), CAIRO_STATUS_SUCCESS);
    cairo_destroy(canvas.cr);
    cairo_surface_destroy(surface);
}

/* A text too long for its room is smaller, and in the end without its middle; its ends stay. */
static void long_texts_lose_their_middle(void **state) {
    (void)state;
    static const struct {
        const char *part;
        int count;
    } middles[] = {{"", 0}, {"xxx", 8}, {"\u00e9", 100}}; /* whole, smaller, cut */
    char text[256];
    asdic_canvas canvas = {0};
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, 100, 20);
    canvas.cr = cairo_create(surface);
    for (int i = 0; i < 3; i++) {
        int used = snprintf(text, sizeof text, "begin");
        for (int k = 0; k < middles[i].count; k++) {
            used += snprintf(text + used, sizeof text - (size_t)used, "%s", middles[i].part);
        }
        snprintf(text + used, sizeof text - (size_t)used, ": end");
        word_count = 0;
        asdic_canvas_text_fit(&canvas, (asdic_lettering){.size_px = 15.0}, text, 220.0);
        assert_true(word_count == 1 && words[0].width < 221.0);
        const char *dots = strstr(words[0].text, "\u2026");
        assert_true((dots != NULL) == (i == 2));
        assert_true(strncmp(words[0].text, "begin", 5) == 0);
        assert_string_equal(words[0].text + strlen(words[0].text) - 5, ": end");
        assert_true(i < 2 || (words[0].width > 205.0 && !strstr(words[0].text, "\xc3\u2026")));
    }
    cairo_destroy(canvas.cr);
    cairo_surface_destroy(surface);
}

/* Of DB, where colours go from 0 to 100 dB. */
static uint32_t colour_of(const asdic_view *v, double db) {
    return asdic_colormap_rgb(v->look.colormap, (unsigned)(db * 2.56));
}

/* Top down the waterfall has the newest ping first; to the right range, of bins in a pixel the strongest. */
static void the_newest_ping_is_on_top(void **state) {
    (void)state;
    asdic_view *v = open_view(THREE, "sampling: {rays: 256}");
    step(v, 1);
    view_history *h = &v->history;
    const size_t bins = v->ping.bins;
    v->look.db_low = 0.0;
    v->look.db_high = 100.0;
    h->rows = 5;
    h->count = 3; /* rows 0, 4 and 3 */
    h->next = 1;
    v->beam = 1;
    for (size_t peak = bins / 4; peak < bins / 4 + 4; peak++) {
        /* Row k of beam b: 20 k + 3 b dB, 5 more far off. */
        for (size_t i = 0; i < 5 * 3 * bins; i++) {
            size_t row = i / bins / 3, beam = i / bins % 3, bin = i % bins;
            h->levels_db[i] = (float)(20 * row + 3 * beam + (bin >= bins / 2 ? 5 : 0));
            h->levels_db[i] = bin == peak ? 95.0f : h->levels_db[i];
        }
        assert_ok(t.ctx, asdic_view_draw(v));
        asdic_view_image frame = asdic_view_get_frame(v);
        const double newest_first_db[] = {3.0, 83.0, 63.0, 43.0};
        const asdic_box box = v->layout.sonar;
        size_t found = 0;
        for (double y = box.y; y < box.y + box.h && found < 4; y += 1.0) {
            const uint32_t *row = frame.rgb + (size_t)y * frame.stride;
            uint32_t near = colour_of(v, newest_first_db[found]);
            uint32_t far = colour_of(v, newest_first_db[found] + 5.0), strong = colour_of(v, 95.0);
            size_t nears = 0, fars = 0, strongs = 0;
            for (double x = box.x; x < box.x + 0.9 * box.w; x += 1.0) {
                uint32_t rgb = row[(size_t)x] & 0xffffffu;
                nears += rgb == near && fars == 0;
                fars += rgb == far;
                strongs += rgb == strong && fars == 0;
            }
            if (nears > 100 && strongs == 1) {
                assert_close((double)nears, (double)fars, 3.0);
                found++;
            }
        }
        assert_int_equal(found, 3);
        size_t unpinged = (size_t)(box.y + 0.8 * box.h) * frame.stride; /* the last two of five */
        assert_int_equal(frame.rgb[unpinged + (size_t)(box.x + 0.5 * box.w)] & 0xffffffu,
                         PANEL_NIGHT_RGB);
    }
    close_view(v);
}

/* TEXT stands behind LABEL; anywhere, where LABEL is NULL. */
static void assert_said(const char *label, const char *text) {
    for (size_t i = label ? 1 : 0; i < word_count; i++) {
        if (strcmp(words[i].text, text) == 0 && (!label || strcmp(words[i - 1].text, label) == 0)) {
            return;
        }
    }
    fail_msg("'%s' is missing behind '%s'", text, label ? label : "");
}

/* Bottoms by the longest names. */
static void long_values_keep_clear_of_their_labels(void **state) {
    (void)state;
    static const struct {
        const char *law, *key;
        double value;
    } bottoms[] = {{"lambert", "lambert_db", -32.5},
                   {"apl-bottom", "grain_size_phi", 7.25},
                   {"rough-facet", "impedance_mrayl", 12.5}};
    for (size_t i = 0; i < 6; i++) {
        asdic_view_options o = asdic_view_options_default();
        o.width /= i % 2 + 1;
        o.height /= i % 2 + 1;
        asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        asdic_material *bottom = &v->chosen.bottom;
        *bottom = asdic_material_of(asdic_law_find(bottoms[i / 2].law));
        assert_ok(t.ctx,
                  asdic_material_set(t.ctx, bottom, bottoms[i / 2].key, bottoms[i / 2].value));
        draw(v);
        for (size_t k = 0; k < word_count; k++) {
            for (size_t n = 0; n < k; n++) {
                if (overlap(&words[k], &words[n])) {
                    fail_msg("'%s' lies on '%s'", words[k].text, words[n].text);
                }
            }
        }
        close_view(v);
    }
}

static void the_status_says_what_is(void **state) {
    (void)state;
    asdic_view *v =
        open_view("[{name: a}], bin_length_m: 0.25, bandwidth_khz: 12.5", "sampling: {rays: 256}");
    step(v, 3);
    v->chosen.wind_speed_kn = 15.0;
    v->chosen.source_level_db = 205.0;
    v->look.db_low = -20.0;
    v->look.db_high = 30.0;
    v->look.tvg_db_per_decade = 40.0;
    draw(v);
    static const char *const said[][2] = {
        {"flown", "by the mission"},
        {"depth", "7.0 m"},
        {"altitude", "13.0 m"},
        {"rudder", "\u2013"},
        {"planes", "\u2013"},
        {"bins", "0.25 m"},
        {"sea", "15 kn wind"},
        {"source", "205 dB"},
        {"bandwidth", "12.5 kHz"},
        {"rays", "256"},
        {"window", "-20..30 dB"},
        {"colours", "inferno"},
        {"recording", "off"},
        {NULL, "ping 2  \u00b7  t = 0.5 s"},
        {NULL, "sonar  \u00b7  beam \u2018a\u2019  \u00b7  shown + 40 log r"},
        {NULL, "A-scope  \u00b7  \u2018a\u2019"}};
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        assert_said(said[i][0], said[i][1]);
    }
    v->helm.flight.vehicle = ASDIC_VEHICLE_REMUS100; /* at rest until somebody steers */
    draw(v);
    assert_said("speed", "2.00 m/s");
    v->is_manual = v->is_paused = true;
    v->helm.rudder = 0.25;
    v->helm.planes = -0.5;
    v->helm.holds_depth = false;
    v->ping.altitude_m = INFINITY;
    draw(v);
    assert_said("flown", "by hand");
    assert_said("altitude", "none");
    assert_said("rudder", "+25 %");
    assert_said("planes", "-50 %");
    assert_said(NULL, "PAUSED  \u00b7  ping 2  \u00b7  t = 0.5 s");
    v->helm.rudder = 0.0;
    v->helm.holds_depth = true;
    v->helm.hold_z_m = 8.5;
    draw(v);
    assert_said("rudder", "amidships");
    assert_said("planes", "hold 8.5 m");
    static const struct {
        double yaw_deg;
        const char *said;
    } headings[] = {{0, "000\u00b0"},      {-10, "350\u00b0"},    {359.4, "359\u00b0"},
                    {359.7, "000\u00b0"},  {-365.0, "355\u00b0"}, {-800.0, "280\u00b0"},
                    {1085.0, "005\u00b0"}, {95.2, "095\u00b0"}};
    for (size_t i = 0; i < sizeof headings / sizeof *headings; i++) {
        v->ping.pose.yaw_rad = headings[i].yaw_deg * DEGREE;
        draw(v);
        assert_said("heading", headings[i].said);
    }
    close_view(v);
}

/* Labels of ranges below a panel are even, begin with 0 and end with the unit, and nearly fill it. */
static void check_ranges(const asdic_view *v, asdic_box box) {
    double first_x = 0.0, each_px = 0.0;
    size_t count = 0;
    bool has_unit = false;
    for (size_t i = 0; i < word_count; i++) {
        char *end;
        double value = strtod(words[i].text, &end);
        if (end == words[i].text || words[i].y < box.y + box.h - 10.0 ||
            words[i].y > box.y + box.h || words[i].x < box.x || words[i].x > box.x + box.w) {
            continue;
        }
        assert_false(has_unit);
        has_unit = strcmp(end, " m") == 0;
        if (count == 0) {
            assert_true(value == 0.0);
            first_x = words[i].x;
        } else {
            double own = (words[i].x - first_x) / value;
            each_px = count == 1 ? own : each_px;
            assert_close(own * value, each_px * value, has_unit ? 8.0 : 3.0);
        }
        count++;
    }
    assert_true(has_unit && count >= 3);
    double wide = each_px * asdic_view_range_m(v);
    assert_true(wide > 0.7 * box.w && wide < box.w);
}

/* A waterfall has two pixels a ping, of which there are four a second. */
static void axes_are_even(void **state) {
    (void)state;
    asdic_view *v = open_view(THREE, "sampling: {rays: 256}");
    step(v, 1);
    draw(v);
    check_ranges(v, v->layout.sonar);
    check_ranges(v, v->layout.ascope);
    double now_y = NAN;
    size_t count = 0;
    for (size_t i = 0; i < word_count; i++) {
        double ago_s;
        now_y = strcmp(words[i].text, "now") == 0 ? words[i].y : now_y;
        if (sscanf(words[i].text, "\u2212%lf s", &ago_s) == 1) {
            assert_close(words[i].y - now_y, ago_s * 4.0 * 2.0, 2.5);
            count++;
        }
    }
    assert_true(count >= 1);
    close_view(v);
}

/* Pixels of the A-scope below its legend that are nearly white, from LOW to HIGH of its width. */
static size_t whites(const asdic_view *v, double low, double high) {
    asdic_view_image frame = asdic_view_get_frame(v);
    asdic_box box = v->layout.ascope;
    size_t count = 0;
    for (double y = box.y + 0.25 * box.h; y < box.y + 0.85 * box.h; y += 1.0) {
        for (double x = box.x + low * box.w; x < box.x + high * box.w; x += 1.0) {
            uint32_t rgb = frame.rgb[(size_t)y * frame.stride + (size_t)x];
            count += (rgb >> 16 & 255) > 110 && (rgb & 255) > 160;
        }
    }
    return count;
}

/* Words grow with the frame, and the room between them: one of twice the width and height has the same, each twice as
 * far from the corner. */
static void larger_frames_have_larger_words_not_more(void **state) {
    (void)state;
    static struct word before[sizeof words / sizeof *words];
    size_t before_count = 0;
    for (unsigned times = 2; times <= 4; times *= 2) {
        asdic_view_options o = small();
        o.width *= times;
        o.height *= times;
        asdic_view *v = try_view(THREE, "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        draw(v);
        for (size_t i = 0; times == 4 && i < word_count; i++) {
            bool is_title = strncmp(words[i].text, "asdic", 5) == 0; /* with a folder's name */
            assert_true(is_title || strcmp(words[i].text, before[i].text) == 0);
            assert_close(words[i].x, 2.0 * before[i].x, 12.0); /* letters are whole pixels wide */
            assert_close(words[i].y, 2.0 * before[i].y, 2.0);
        }
        assert_true(times == 2 || word_count == before_count);
        memcpy(before, words, sizeof words);
        before_count = word_count;
        close_view(v);
    }
}

/* Whatever the frame's size and beams: the title in the middle of its strip, no word beyond the
 * frame. */
static void words_lie_within_the_frame(void **state) {
    (void)state;
    static const char *const receivers[] = {
        THREE, "{fan: {count: 30, sector_deg: 120, length_h_m: 0.1, length_v_m: 0.02}}"};
    const unsigned sizes[][2] = {{640, 360}, {1280, 720}, {700, 900}};
    for (size_t i = 0; i < 6; i++) {
        asdic_view_options o = asdic_view_options_default();
        o.width = sizes[i / 2][0];
        o.height = sizes[i / 2][1];
        asdic_view *v = try_view(receivers[i % 2], "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 2);
        draw(v);
        asdic_box title = v->layout.title;
        size_t titles = 0;
        for (size_t k = 0; k < word_count; k++) {
            const struct word *w = &words[k];
            assert_true(w->x > 0.0 && w->x < o.width && w->y > 0.0 && w->y < o.height);
            if (strstr(w->text, "t = ") || strcmp(w->text, v->title) == 0) {
                assert_close(w->y, title.y + 0.5 * title.h, 0.15 * title.h);
                assert_true(w->x > title.x && w->x < title.x + title.w);
                titles++;
            }
        }
        assert_int_equal(titles, 2);
        close_view(v);
    }
}

/* Of a narrow fan, a wide one and one all round, small and large: no word lies on another, and the bearings stand
 * outside the fan, near it, each where its own bearing is. */
static void words_keep_clear_of_each_other(void **state) {
    (void)state;
    static const int sectors_deg[] = {40, 120, 300};
    for (size_t i = 0; i < 6; i++) {
        char receivers[96];
        snprintf(receivers, sizeof receivers,
                 "{fan: {count: 30, sector_deg: %d, length_h_m: 0.1, length_v_m: 0.02}}",
                 sectors_deg[i / 2]);
        asdic_view_options o = asdic_view_options_default();
        o.width /= i % 2 + 1;
        o.height /= i % 2 + 1;
        asdic_view *v = try_view(receivers, "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 3);
        draw(v);
        const asdic_box sonar = v->layout.sonar;
        const struct arc *apex = arcs;
        while (apex < arcs + arc_count && !(apex->x > sonar.x && apex->x < sonar.x + sonar.w)) {
            apex++;
        }
        assert_true(apex < arcs + arc_count);
        double radius = 0.0; /* of the lines from the apex */
        for (size_t k = 0; k < line_count; k++) {
            const struct line *l = &lines[k];
            if (l->x0 == apex->x && l->y0 == apex->y) {
                radius = fmax(radius, hypot(l->x1 - l->x0, l->y1 - l->y0));
            }
        }
        size_t bearings = 0;
        for (size_t k = 0; k < word_count; k++) {
            const struct word *w = &words[k];
            for (size_t n = 0; n < k; n++) {
                if (overlap(w, &words[n])) {
                    fail_msg("'%s' lies on '%s'", w->text, words[n].text);
                }
            }
            bool is_left = strncmp(w->text, "\u2212", 3) == 0;
            int deg, length = 0;
            if (w->x < sonar.x + sonar.w &&
                sscanf(w->text + (is_left ? 3 : 0), "%d\u00b0%n", &deg, &length) == 1 &&
                length > 0) {
                double angle = (is_left ? -deg : deg) * DEGREE, s = sin(angle), c = cos(angle);
                double along = (w->x - apex->x) * s - (w->y - apex->y) * c;
                double nearest = along - 0.5 * (fabs(s) * w->width + fabs(c) * w->height);
                assert_true(nearest > radius && along < radius + 40.0 * v->layout.scale);
                assert_close((w->x - apex->x) * c + (w->y - apex->y) * s, 0.0,
                             12.0 * v->layout.scale);
                bearings++;
            }
        }
        assert_int_equal(bearings, 2 * (sectors_deg[i / 2] / 60) + 1);
        close_view(v);
    }
}

/* Pixels of the A-scope that are red, from LOW to HIGH of its width. */
static size_t reds(const asdic_view *v, double low, double high) {
    asdic_view_image frame = asdic_view_get_frame(v);
    asdic_box box = v->layout.ascope;
    size_t count = 0;
    for (double y = box.y; y < box.y + box.h; y += 1.0) {
        for (double x = box.x + low * box.w; x < box.x + high * box.w; x += 1.0) {
            uint32_t rgb = frame.rgb[(size_t)y * frame.stride + (size_t)x];
            count += (rgb >> 16 & 255) > 80 && (rgb >> 16 & 255) > 2 * (rgb >> 8 & 255);
        }
    }
    return count;
}

/* A bin between bins without a level is seen, too, and at either end. */
static void a_lone_bin_is_a_dot(void **state) {
    (void)state;
    const asdic_view_options o = asdic_view_options_default();
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    step(v, 1);
    float *levels_db = malloc(v->ping.bins * sizeof *levels_db);
    assert_non_null(levels_db);
    v->ping.level_db = levels_db;
    for (size_t i = 0; i < 4; i++) { /* the last time none is there */
        for (size_t n = 0; n < v->ping.bins; n++) {
            levels_db[n] = i < 3 && n == i * (v->ping.bins - 1) / 2 ? (float)v->look.db_low : NAN;
        }
        draw(v);
        assert_int_equal(whites(v, 0.0, 0.3) > 0, i == 0);
        assert_int_equal(whites(v, 0.4, 0.7) > 0, i == 1);
        assert_int_equal(whites(v, 0.8, 1.0) > 0, i == 2);
    }
    close_view(v);
    free(levels_db);
}

/* Echoes 6 dB above what is expected are marked. */
static void what_stands_out_is_red(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    const float *expected_db = asdic_live_expected_db(&v->expected, ASDIC_TOTAL);
    float *levels_db = malloc(v->ping.bins * sizeof *levels_db);
    assert_true(expected_db && levels_db);
    v->ping.level_db = levels_db;
    for (int above_db = 5; above_db < 8; above_db += 2) {
        for (size_t n = 0; n < v->ping.bins; n++) {
            bool is_near = 2 * n < v->ping.bins;
            levels_db[n] = expected_db[n] + (is_near ? (float)above_db : -20.0f);
        }
        draw(v);
        assert_true((reds(v, 0.05, 0.45) > 100) == (above_db > 6));
        assert_true(reds(v, 0.65, 1.0) == 0);
    }
    close_view(v);
    free(levels_db);
}

/* Panels of any frame lie within it, apart from each other, and leave little of it empty. */
static void panels_fill_the_frame(void **state) {
    (void)state;
    static const unsigned sizes[][2] = {{640, 360},   {800, 600},  {1280, 720}, {1920, 1080},
                                        {1000, 3000}, {7680, 360}, {7680, 4320}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        view_layout l = asdic_view_lay_out(sizes[i][0], sizes[i][1]);
        const asdic_box boxes[] = {l.title, l.sonar, l.ascope, l.chase, l.plan, l.status};
        enum { COUNT = sizeof boxes / sizeof *boxes };
        double width = sizes[i][0], height = sizes[i][1], area = 0.0;
        assert_close(l.scale, fmin(width / 1280.0, height / 720.0), 1e-12);
        for (size_t k = 0; k < COUNT; k++) {
            const asdic_box *a = &boxes[k];
            area += a->w * a->h;
            assert_true(a->x > 0.0 && a->y >= 0.0 && a->w > 60.0 && a->h > 15.0);
            assert_true(a->x + a->w < width && a->y + a->h < height);
            for (size_t n = 0; n < k; n++) {
                const asdic_box *b = &boxes[n];
                assert_true(a->x > b->x + b->w || b->x > a->x + a->w || a->y >= b->y + b->h ||
                            b->y >= a->y + a->h);
            }
        }
        assert_true(area > 0.9 * width * height);
        assert_close(l.sonar.w, l.chase.w, 2.0);
        /* As far from each other as from the edges. */
        const double gaps[] = {width - l.chase.x - l.chase.w,
                               l.chase.x - l.sonar.x - l.sonar.w,
                               l.status.x - l.plan.x - l.plan.w,
                               width - l.status.x - l.status.w,
                               l.ascope.y - l.sonar.y - l.sonar.h,
                               l.plan.y - l.chase.y - l.chase.h,
                               height - l.ascope.y - l.ascope.h,
                               height - l.status.y - l.status.h,
                               l.ascope.x,
                               10.0 * l.scale};
        for (size_t k = 0; k < sizeof gaps / sizeof *gaps; k++) {
            assert_close(gaps[k], l.sonar.x, 2.0);
        }
    }
}

/* Where the label of LEVEL stands beside the A-scope. */
static double label_y(const asdic_view *v, const char *level) {
    asdic_box box = v->layout.ascope;
    for (size_t i = 0; i < word_count; i++) {
        if (strcmp(words[i].text, level) == 0 && words[i].y > box.y && words[i].x > box.x &&
            words[i].x < box.x + 20.0) {
            return words[i].y;
        }
    }
    fail_msg("no level %s", level);
    return NAN;
}

/* The curve's mean height at SHARE of the A-scope's width; NAN: there is none. */
static double curve_y(const asdic_view *v, double share) {
    asdic_view_image frame = asdic_view_get_frame(v);
    asdic_box box = v->layout.ascope;
    double sum = 0.0, count = 0.0;
    for (double y = box.y + 16.0; y < box.y + box.h - 12.0; y += 1.0) {
        uint32_t rgb = frame.rgb[(size_t)y * frame.stride + (size_t)(box.x + share * box.w)];
        double light = (rgb >> 16 & 255) > 60 ? (double)(rgb & 255) : 0.0;
        sum += light * (y + 0.5);
        count += light;
    }
    return sum / count;
}

static void the_scope_shows_the_chosen_beam(void **state) {
    (void)state;
    asdic_view *v = open_view(THREE, "sampling: {rays: 256}");
    step(v, 1);
    size_t bins = v->ping.bins;
    float *levels_db = malloc(3 * bins * sizeof *levels_db);
    assert_non_null(levels_db);
    for (size_t i = 0; i < 3 * bins; i++) { /* between thirds there is nothing */
        size_t third = 3 * (i % bins) / bins;
        levels_db[i] = i / bins != 1 ? 45.0f : third == 0 ? 60.0f : third == 1 ? NAN : 70.0f;
    }
    asdic_live_expected_finish(&v->expected);
    assert_ok(t.ctx, asdic_live_expected_init(t.ctx, bins, true, &v->expected));
    v->ping.level_db = levels_db;
    v->look.db_low = 40.0;
    v->look.db_high = 80.0;
    draw(v); /* without the curves of what is expected, which a thread finds */
    assert_close(curve_y(v, 0.25), label_y(v, "60"), 1.5);
    assert_true(isnan(curve_y(v, 0.55)));
    assert_close(curve_y(v, 0.85), label_y(v, "70"), 1.5);
    close_view(v);
    free(levels_db);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_lie_within_the_frame),
        cmocka_unit_test(words_keep_clear_of_each_other),
        cmocka_unit_test(texts_lose_what_is_no_text),
        cmocka_unit_test(long_texts_lose_their_middle),
        cmocka_unit_test(the_newest_ping_is_on_top),
        cmocka_unit_test(the_scope_shows_the_chosen_beam),
        cmocka_unit_test(long_values_keep_clear_of_their_labels),
        cmocka_unit_test(the_status_says_what_is),
        cmocka_unit_test(axes_are_even),
        cmocka_unit_test(a_lone_bin_is_a_dot),
        cmocka_unit_test(larger_frames_have_larger_words_not_more),
        cmocka_unit_test(what_stands_out_is_red),
        cmocka_unit_test(panels_fill_the_frame),
    };
    t = test_device_open_or_skip();
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
