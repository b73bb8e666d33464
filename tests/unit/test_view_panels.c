/* Panels of a view: their words, axes and curves; what its camera is told to show. */
#include "view_rig.h"

#include "out/colormap.h"

#include <cairo.h>

/* What was written since word_count was 0, the middle of its ink and its size. This takes the place of cairo's own. */
static struct word {
    char text[160];
    double x, y, width, height;
} words[400];
static size_t word_count;

void cairo_show_text(cairo_t *cr, const char *text) {
    cairo_text_extents_t e;
    if (word_count == sizeof words / sizeof *words) {
        return;
    }
    struct word *w = &words[word_count++];
    cairo_get_current_point(cr, &w->x, &w->y);
    cairo_text_extents(cr, text, &e);
    w->x += e.x_bearing + 0.5 * e.width;
    w->y += e.y_bearing + 0.5 * e.height;
    cairo_user_to_device(cr, &w->x, &w->y);
    w->width = e.width;
    w->height = e.height;
    cairo_user_to_device_distance(cr, &w->width, &w->height);
    snprintf(w->text, sizeof w->text, "%s", text);
}

/* Straight lines, and arcs, since line_count and arc_count were 0. */
static struct line { double x0, y0, x1, y1; } lines[400];
static struct arc { double x, y, radius, rad[2]; } arcs[400];
static size_t line_count, arc_count;

void __real_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __real_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high);
void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high);

void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1) {
    if (line_count < sizeof lines / sizeof *lines) {
        lines[line_count++] = (struct line){x0, y0, x1, y1};
    }
    __real_asdic_canvas_line(c, x0, y0, x1, y1);
}

void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high) {
    if (arc_count < sizeof arcs / sizeof *arcs) {
        arcs[arc_count++] = (struct arc){x, y, radius, {low, high}};
    }
    __real_cairo_arc(cr, x, y, radius, low, high);
}

/* Of DB, where colours go from 0 to 100 dB. */
static uint32_t colour_of(const asdic_view *v, double db) {
    return asdic_colormap_rgb(v->look.colormap, (unsigned)(db * 2.56));
}

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
    asdic_canvas_text(&canvas, (asdic_text){.size_px = 12.0}, "b\xe9ton");
    assert_string_equal(words[0].text, "bton");
    assert_int_equal(cairo_status(canvas.cr), CAIRO_STATUS_SUCCESS);
    cairo_destroy(canvas.cr);
    cairo_surface_destroy(surface);
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
    }
    close_view(v);
}

/* The last shot, seen on its way to the camera. */
static asdic_shot shot;

asdic_status __real_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of);
asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of);

asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim,
                                       const asdic_shot *of) {
    shot = *of;
    return __real_asdic_camera_shoot(camera, sim, of);
}

static void draw(asdic_view *view) {
    word_count = line_count = arc_count = 0;
    assert_ok(t.ctx, asdic_view_draw(view));
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

static bool overlap(const struct word *a, const struct word *b) {
    return fabs(a->x - b->x) < 0.5 * (a->width + b->width) &&
           fabs(a->y - b->y) < 0.5 * (a->height + b->height);
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

/* The seconds that a waterfall's axis tells, in their order, of a frame of TIMES 640 by 360 pixels. */
static size_t told_ago_s(unsigned times, double ago_s[20]) {
    asdic_view_options o = small();
    size_t count = 0;
    o.width *= times;
    o.height *= times;
    asdic_view *v = try_view(THREE, "sampling: {rays: 256}", &o, ASDIC_OK);
    step(v, 1);
    draw(v);
    for (size_t i = 0; i < word_count && count < 20; i++) {
        count += sscanf(words[i].text, "\u2212%lf s", &ago_s[count]) == 1;
    }
    close_view(v);
    return count;
}

/* Words grow with the frame, and the room between them: one of twice the width and height has the same labels. */
static void larger_frames_have_larger_words_not_more(void **state) {
    (void)state;
    double small_s[20], large_s[20];
    size_t count = told_ago_s(2, small_s);
    assert_true(count >= 2);
    assert_int_equal(told_ago_s(4, large_s), count);
    assert_memory_equal(small_s, large_s, count * sizeof *small_s);
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

/* A bin between bins without a level is seen, too. */
static void a_lone_bin_is_a_dot(void **state) {
    (void)state;
    const asdic_view_options o = asdic_view_options_default();
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    step(v, 1);
    float *levels_db = malloc(v->ping.bins * sizeof *levels_db);
    assert_non_null(levels_db);
    v->ping.level_db = levels_db;
    for (int is_there = 0; is_there < 2; is_there++) {
        for (size_t n = 0; n < v->ping.bins; n++) {
            levels_db[n] = NAN;
        }
        levels_db[v->ping.bins / 2] = is_there ? (float)v->look.db_low : NAN;
        draw(v);
        assert_int_equal(whites(v, 0.4, 0.7) > 0, is_there);
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
    static const unsigned sizes[][2] = {{640, 360},   {800, 600},   {1280, 720},
                                        {1920, 1080}, {1000, 3000}, {7680, 360}};
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
        assert_close(l.sonar.x, width - l.chase.x - l.chase.w, 2.0); /* as wide at both sides */
        assert_close(l.sonar.w, l.chase.w, 2.0);
        assert_close(l.ascope.y + l.ascope.h, l.status.y + l.status.h, 2.0);
    }
}

/* A cone's axis and edges lie as said: by heading and depression, with half-widths to the sides and up and down. */
static void check_cone(const dev_cone_view *cone, double heading_rad, double down_rad,
                       double half_h_rad, double half_v_rad) {
    for (int k = 0; k < 5; k++) {
        double side = k < 3 ? half_h_rad * (k - 1) : 0.0,
               below = k < 3 ? 0.0 : half_v_rad * (2 * k - 7);
        /* Turned to the side within the plane of the face, then down, then to the heading. */
        double x = cos(side) * cos(below), y = sin(side), z = sin(below), seen[3];
        double ahead = x * cos(down_rad) - z * sin(down_rad);
        const double u[3] = {ahead * cos(heading_rad) - y * sin(heading_rad),
                             ahead * sin(heading_rad) + y * cos(heading_rad),
                             x * sin(down_rad) + z * cos(down_rad)};
        for (int row = 0; row < 3; row++) {
            const float *r = cone->rows + 3 * row;
            seen[row] = (double)r[0] * u[0] + (double)r[1] * u[1] + (double)r[2] * u[2];
        }
        assert_close(seen[1] / seen[0], k < 3 ? k - 1.0 : 0.0, 1e-4);
        assert_close(seen[2] / seen[0], k < 3 ? 0.0 : 2.0 * k - 7.0, 1e-4);
        assert_close(seen[0], cos(side) * cos(below), 1e-4);
    }
}

/* An arc of the last frame goes from LOW to HIGH, bearings from north on. */
static void check_arc(size_t at, double low_rad, double high_rad) {
    assert_true(at < arc_count);
    assert_close(arcs[at].rad[0], low_rad - 90.0 * DEGREE, 1e-9);
    assert_close(arcs[at].rad[1], high_rad - 90.0 * DEGREE, 1e-9);
}

/* Nine beams and more are one wedge, on the map one sector. The chosen beam is amber, which has more red than blue, and
 * stronger. */
static void beams_are_cones(void **state) {
    (void)state;
    asdic_view *v =
        open_view("[{name: a, yaw_deg: -40}, {name: b, pitch_deg: 30, length_v_m: 0.05}, "
                  "{name: c, yaw_deg: 25, length_h_m: 0.2}]",
                  "sampling: {rays: 256}");
    v->beam = 2;
    step(v, 1);
    const asdic_beam *beams = asdic_mission_sonar(v->mission)->receivers;
    double heading = v->ping.pose.yaw_rad;
    assert_int_equal(shot.cones, 3);
    for (size_t b = 0; b < 3; b++) {
        const dev_cone_view *cone = &shot.cone[b];
        check_cone(cone, heading + beams[b].yaw_rad, beams[b].pitch_rad,
                   asdic_view_half_width_rad(v, beams[b].length_h_m),
                   asdic_view_half_width_rad(v, beams[b].length_v_m));
        assert_int_equal(cone->rgb[0] > cone->rgb[2], b == 2);
        assert_close((double)cone->strength, b == 2 ? 1.0 : 0.55, 1e-6);
    }
    draw(v);
    assert_int_equal(arc_count, 3); /* on the map the chosen one comes last */
    for (size_t b = 0; b < 3; b++) {
        double middle = heading + beams[b].yaw_rad;
        double half = asdic_view_half_width_rad(v, beams[b].length_h_m);
        check_arc(b, middle - half, middle + half);
    }
    close_view(v);
    for (int count = 8; count < 11; count++) {
        char receivers[1024] = "[";
        add_beams(receivers, count);
        v = open_view(receivers, "sampling: {rays: 256}");
        v->beam = 1;
        step(v, 1);
        beams = asdic_mission_sonar(v->mission)->receivers;
        assert_int_equal(shot.cones, count < 9 ? count : 2);
        if (count >= 9) {
            double half = asdic_view_half_width_rad(v, beams[0].length_h_m);
            check_cone(&shot.cone[0], v->ping.pose.yaw_rad + beams[1].yaw_rad, 0.0, half,
                       asdic_view_half_width_rad(v, beams[1].length_v_m));
            check_cone(&shot.cone[1], v->ping.pose.yaw_rad, 0.0, beams[count - 1].yaw_rad + half,
                       asdic_view_half_width_rad(v, beams[0].length_v_m));
            assert_true(shot.cone[0].rgb[0] > shot.cone[0].rgb[2]);
            assert_true(shot.cone[1].rgb[0] < shot.cone[1].rgb[2]);
            double yaw = v->ping.pose.yaw_rad, last = beams[count - 1].yaw_rad;
            draw(v);
            assert_int_equal(arc_count, 2);
            check_arc(0, yaw - last - half, yaw + last + half);
            check_arc(1, yaw + beams[1].yaw_rad - half, yaw + beams[1].yaw_rad + half);
        }
        close_view(v);
    }
}

/* On the map and by its name, where it is at the moment. */
static void what_moves_is_shown(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-track-XXXXXX", more[160];
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(
        dprintf(
            fd,
            "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,2,12,7,0,0,0\n4,-2,12,7,0,0,0\n") >
        0);
    close(fd);
    snprintf(more, sizeof more,
             "objects: [{name: fish, sphere: {radius_m: 0.5}, track: %s}]\nsampling: {rays: 256}",
             path);
    asdic_view *v = open_view("[{name: a}]", more);
    unlink(path);
    double label_x = NAN;
    for (int ping = 0; ping < 3; ping++) {
        step(v, 1);
        draw(v);
        double px_per_m =
            fmax(v->layout.plan.w, v->layout.plan.h) / ((double)v->relief.rows * v->relief.cell_m);
        assert_int_equal(arc_count, 2);
        assert_close(arcs[1].x - arcs[0].x, (12.0 - 0.5 * ping) * px_per_m, 1e-6);
        assert_close(arcs[1].y - arcs[0].y, -(2.0 - 0.25 * ping) * px_per_m, 1e-6);
        double last_x = label_x;
        for (size_t i = 0; i < word_count; i++) {
            label_x = strcmp(words[i].text, "fish") == 0 ? words[i].x : label_x;
        }
        assert_true(ping == 0 ? label_x > v->layout.chase.x : label_x > last_x);
    }
    close_view(v);
}

/* Which has no triangles, and is in no relief. */
static void points_are_on_the_map(void **state) {
    (void)state;
    asdic_view *v = open_view(
        "[{name: a}]",
        "sampling: {rays: 256}\n"
        "objects:\n  - {name: p, point: {target_strength_db: -30}, position_m: [2, 12, 7]}\n"
        "  - {name: s, sphere: {radius_m: 0.5}, position_m: [2, 8, 7]}\n");
    step(v, 1);
    draw(v);
    double px_per_m =
        fmax(v->layout.plan.w, v->layout.plan.h) / ((double)v->relief.rows * v->relief.cell_m);
    assert_int_equal(arc_count, 2);
    assert_close(arcs[1].x - arcs[0].x, 12.0 * px_per_m, 1e-6);
    assert_close(arcs[1].y - arcs[0].y, -2.0 * px_per_m, 1e-6);
    close_view(v);
}

/* A cone ends at 166 degrees: a wider fan is seen as several, side by side. */
static void wide_fans_are_seen_whole(void **state) {
    (void)state;
    static const struct {
        int sector_deg;
        unsigned cones;
    } cases[] = {{120, 1}, {200, 2}, {360, 3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char fan[96];
        snprintf(fan, sizeof fan, "{fan: {count: 24, sector_deg: %d, length_h_m: 0.2}}",
                 cases[i].sector_deg);
        asdic_view *v = open_view(fan, "sampling: {rays: 256}");
        step(v, 1);
        const asdic_sonar *sonar = asdic_mission_sonar(v->mission);
        double half_v = asdic_view_half_width_rad(v, sonar->receivers[0].length_v_m);
        double half = asdic_view_half_width_rad(v, 0.2), yaw = v->ping.pose.yaw_rad;
        double low = sonar->receivers[0].yaw_rad - half, whole = -2.0 * low;
        assert_int_equal(shot.cones, 1 + cases[i].cones);
        whole = fmin(whole, 360.0 * DEGREE);
        for (unsigned k = 0; k < cases[i].cones; k++) {
            double each = whole / cases[i].cones;
            check_cone(&shot.cone[1 + k], yaw + low + (k + 0.5) * each, 0.0, 0.5 * each, half_v);
        }
        close_view(v);
    }
}

/* From behind and above, in the water, clear of the bottom. */
static void the_camera_stays_in_the_water(void **state) {
    (void)state;
    static const double depths_m[] = {0.1, 1.0, 7.0, 15.0, 19.9};
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    for (size_t i = 0; i < sizeof depths_m / sizeof *depths_m; i++) {
        asdic_vec3 *at = &v->ping.pose.position_m;
        at->z = depths_m[i];
        draw(v);
        double behind_m = at->y - shot.eye_m.y; /* it swims east */
        assert_true(behind_m > 3.0 && fabs(shot.eye_m.x - at->x) < 0.02 * behind_m);
        assert_true(shot.eye_m.z >= 0.4 && shot.eye_m.z < 20.0 - 0.1 * behind_m);
        assert_true(shot.eye_m.z < at->z || at->z < 0.4);
        assert_true(shot.eye_m.z > 0.41 || at->z < 0.4 * behind_m);
        /* Down to a place ahead of the vehicle, which is seen below the middle, if at all. */
        double down = atan2(at->z - shot.eye_m.z, behind_m);
        assert_true(-shot.pitch_rad < down + 0.1 && shot.pitch_rad < 0.0);
    }
    close_view(v);
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

static bool is_written(const char *word) {
    for (size_t i = 0; i < word_count; i++) {
        if (strcmp(words[i].text, word) == 0) {
            return true;
        }
    }
    return false;
}

/* White pixels of the map: the vehicle's fill alone. */
static size_t white_pixels(const asdic_view *v) {
    cairo_surface_t *surface = v->canvas.surface;
    const asdic_box box = v->layout.plan;
    size_t count = 0;
    cairo_surface_flush(surface);
    const unsigned char *data = cairo_image_surface_get_data(surface);
    for (size_t y = (size_t)box.y; y < (size_t)(box.y + box.h); y++) {
        const unsigned char *row = data + y * (size_t)cairo_image_surface_get_stride(surface);
        for (size_t x = (size_t)box.x; x < (size_t)(box.x + box.w); x++) {
            count += row[4 * x] == 255 && row[4 * x + 1] == 255 && row[4 * x + 2] == 255;
        }
    }
    return count;
}

/* An arrow of 0.74 times its size squared, 8 pixels in a window of 1280 and 16 in one of 2560, less half a line round
 * it. */
static void the_vehicle_is_as_large_as_the_window(void **state) {
    (void)state;
    size_t white[2];
    for (int i = 0; i < 2; i++) {
        asdic_view_options o = small();
        o.width *= 2 * (i + 1);
        o.height *= 2 * (i + 1);
        asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        draw(v);
        white[i] = white_pixels(v);
        close_view(v);
    }
    assert_true(white[0] >= 8 && white[0] < 48);
    assert_true(white[1] >= 95 && white[1] < 190);
}

/* As far apart as the scale bar is long: lines of equal east, which go down the map, and of equal north. */
static void the_map_is_to_scale(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    draw(v);
    const asdic_box box = v->layout.plan;
    double side_m = v->relief.cell_m * (double)v->relief.rows, length_m = NAN, bar_px = NAN;
    size_t norths = 0;
    for (size_t i = 0; i < word_count; i++) { /* below the arrow, which ends 26 px down */
        bool is_north = strcmp(words[i].text, "N") == 0;
        norths += is_north;
        assert_true(!is_north || (words[i].x > box.x + 0.5 * box.w && words[i].x < box.x + box.w &&
                                  words[i].y > box.y + 26.0 * v->layout.scale &&
                                  words[i].y < box.y + 60.0 * v->layout.scale));
    }
    assert_int_equal(norths, 1);
    for (size_t i = 0; i < word_count && isnan(length_m); i++) {
        char *end;
        double value = strtod(words[i].text, &end);
        if (words[i].x > box.x && words[i].x < box.x + box.w && words[i].y > box.y &&
            strcmp(end, " m") == 0) {
            length_m = value;
        }
    }
    assert_true(length_m > 0.1 * side_m && length_m < 0.5 * side_m);
    double step_px = length_m * fmax(box.w, box.h) / side_m, last_x = NAN, last_y = NAN;
    size_t down = 0, across = 0;
    for (size_t i = 0; i < line_count; i++) {
        const struct line *l = &lines[i];
        if (l->x0 == l->x1 && l->y0 == box.y && l->y1 == box.y + box.h && l->x0 >= box.x) {
            assert_true(down++ == 0 || fabs(fabs(l->x0 - last_x) - step_px) < 1.01);
            last_x = l->x0;
        } else if (l->y0 == l->y1 && l->x0 == box.x && l->x1 == box.x + box.w) {
            assert_true(across++ == 0 || fabs(fabs(l->y0 - last_y) - step_px) < 1.01);
            assert_true(l->y0 > box.y - 1.0 && l->y0 < box.y + box.h + 1.0);
            last_y = l->y0;
        } else if (l->y0 == l->y1 && l->x0 > box.x && l->x1 < box.x + box.w && l->y0 > box.y) {
            bar_px = l->x1 - l->x0;
        }
    }
    assert_close(bar_px, step_px, 1e-6);
    assert_close((double)down, box.w / step_px, 1.0);
    assert_close((double)across, box.h / step_px, 1.0);
    assert_true(down >= 3 && across >= 3);
    close_view(v);
}

/* A flat floor has the middle of the map's colours, 0.04, 0.13, 0.20 to 0.33, 0.53, 0.56 of white, and its depth below. */
static void the_map_knows_a_flat_floor(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 1);
    draw(v);
    assert_true(is_written("floor at 20.0 m") || is_written("20.0 m"));
    const asdic_box box = v->layout.plan;
    asdic_view_image frame = asdic_view_get_frame(v);
    size_t alike = 0, seen = 0;
    for (size_t y = (size_t)box.y; y < (size_t)(box.y + box.h); y++) {
        for (size_t x = (size_t)box.x; x < (size_t)(box.x + box.w); x++, seen++) {
            uint32_t rgb = frame.rgb[y * frame.stride + x];
            alike += abs((int)(rgb >> 16 & 255) - 47) < 3 && abs((int)(rgb >> 8 & 255) - 84) < 3 &&
                     abs((int)(rgb & 255) - 97) < 3;
        }
    }
    assert_true(alike > seen / 4);
    close_view(v);
}

/* Seen from behind, the oldest of the way lies in open water, nearest to the eye. */
static void a_trail_lies_behind_the_vehicle(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 12);
    draw(v);
    double x[2], y[2], far_m[2];
    bool is_drawn = false;
    for (size_t k = 0; k < 2; k++) {
        assert_true(asdic_camera_project(v->camera, v->trail_m[k], &x[k], &y[k], &far_m[k]));
        x[k] += v->layout.chase.x;
        y[k] += v->layout.chase.y;
    }
    assert_true(far_m[0] < far_m[1]);
    for (size_t i = 0; i < line_count; i++) {
        const struct line *l = &lines[i];
        is_drawn = is_drawn ||
                   hypot(l->x0 - x[0], l->y0 - y[0]) + hypot(l->x1 - x[1], l->y1 - y[1]) < 1e-6;
    }
    assert_true(is_drawn);
    close_view(v);
}

/* Of objects in one place the first is named alone, wherever others are. */
static void names_keep_clear_of_names(void **state) {
    (void)state;
    asdic_view *v = open_view(
        "[{name: a}]", "sampling: {rays: 256}\nobjects:\n"
                       "  - {name: port, box: {size_m: [1, 1, 1]}, position_m: [4, 15, 12]}\n"
                       "  - {name: starboard, box: {size_m: [1, 1, 1]}, position_m: [-4, 15, 12]}\n"
                       "  - {name: again, box: {size_m: [0.9, 0.9, 1]}, position_m: [4, 15, 12]}");
    step(v, 1);
    draw(v);
    assert_true(is_written("port") && is_written("starboard") && !is_written("again"));
    /* Each stands above the middle of its object's top, 6 pixels in a window of 1280 and half as many in one of 640. */
    static const struct {
        const char *name;
        asdic_vec3 top_m;
    } tops[] = {{"port", {4, 15, 11.5}}, {"starboard", {-4, 15, 11.5}}};
    for (size_t i = 0; i < 2; i++) {
        double x, y, far_m;
        assert_true(asdic_camera_project(v->camera, tops[i].top_m, &x, &y, &far_m));
        const struct word *w = words;
        while (strcmp(w->text, tops[i].name) != 0) {
            w++;
        }
        assert_close(w->x, v->layout.chase.x + x, 1.5);
        assert_close(w->y, v->layout.chase.y + y - 3.0 - 3.0, 3.0); /* half the letters' height */
    }
    close_view(v);
}

/* What the camera sees fills its panel, but for what is drawn over it. */
static void the_camera_fills_its_panel(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 4);
    draw(v);
    const asdic_box box = v->layout.chase;
    const size_t width = (size_t)box.w, height = (size_t)box.h;
    const uint32_t *seen = asdic_camera_rgb(v->camera);
    asdic_view_image frame = asdic_view_get_frame(v);
    size_t others = 0, coloured = 0;
    for (size_t y = 0; y < height; y++) {
        const uint32_t *row = frame.rgb + ((size_t)box.y + y) * frame.stride + (size_t)box.x;
        for (size_t x = 0; x < width; x++) {
            others += ((row[x] ^ seen[y * width + x]) & 0xffffffu) != 0;
            coloured += seen[y * width + x] != seen[0];
        }
    }
    assert_true(others < width * height / 50 && coloured > width * height / 2);
    close_view(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(words_lie_within_the_frame),
        cmocka_unit_test(words_keep_clear_of_each_other),
        cmocka_unit_test(texts_lose_what_is_no_text),
        cmocka_unit_test(the_newest_ping_is_on_top),
        cmocka_unit_test(beams_are_cones),
        cmocka_unit_test(what_moves_is_shown),
        cmocka_unit_test(points_are_on_the_map),
        cmocka_unit_test(wide_fans_are_seen_whole),
        cmocka_unit_test(the_camera_stays_in_the_water),
        cmocka_unit_test(the_scope_shows_the_chosen_beam),
        cmocka_unit_test(long_values_keep_clear_of_their_labels),
        cmocka_unit_test(the_status_says_what_is),
        cmocka_unit_test(axes_are_even),
        cmocka_unit_test(a_lone_bin_is_a_dot),
        cmocka_unit_test(larger_frames_have_larger_words_not_more),
        cmocka_unit_test(what_stands_out_is_red),
        cmocka_unit_test(panels_fill_the_frame),
        cmocka_unit_test(the_vehicle_is_as_large_as_the_window),
        cmocka_unit_test(the_map_is_to_scale),
        cmocka_unit_test(the_map_knows_a_flat_floor),
        cmocka_unit_test(a_trail_lies_behind_the_vehicle),
        cmocka_unit_test(names_keep_clear_of_names),
        cmocka_unit_test(the_camera_fills_its_panel),
    };
    t = test_device_open_or_skip();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
