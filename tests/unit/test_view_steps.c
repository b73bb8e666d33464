/* Steps of a view: which pings it makes, what it keeps of them, and what its panels show. */
#include "asserts.h"
#include "test_device.h"

#include "kernels/beam.h"
#include "live/view_state.h"
#include "out/colormap.h"

#include <asdic/asdic.h>

#include <cairo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define THREE "[{name: a, yaw_deg: -10}, {name: b}, {name: c, yaw_deg: 10}]"

static test_device t;

/* What was written since word_count was 0, and the middle of its ink. This takes the place of cairo's own. */
static struct word {
    char text[160];
    double x, y;
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
    snprintf(w->text, sizeof w->text, "%s", text);
}

/* As commands open it, of a mission that flies east at 2 m/s and pings four times a second. */
static asdic_view *try_view(const char *receivers, const char *more,
                            const asdic_view_options *options, asdic_status wanted) {
    char path[] = "/tmp/asdic-view-XXXXXX";
    asdic_mission *mission = NULL;
    asdic_view *view = NULL;
    int fd = mkstemp(path);
    assert_true(fd >= 0);
    assert_true(dprintf(fd,
                        "version: 1\nbottom: {depth_m: 20}\n"
                        "mission: {waypoints: {points_m: [[0, 0, 7], [0, 6, 7]], speed_mps: 2}}\n"
                        "sonar: {frequency_khz: 100, ping_rate_hz: 4, receivers: %s}\n%s\n",
                        receivers, more) > 0);
    close(fd);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, path, &mission));
    unlink(path);
    assert_status(t.ctx, asdic_view_create(t.ctx, mission, t.device, options, &view), wanted);
    assert_true((view != NULL) == (wanted == ASDIC_OK));
    if (!view) {
        asdic_mission_destroy(&mission);
    }
    return view;
}

static asdic_view_options small(void) {
    asdic_view_options o = asdic_view_options_default();
    o.width = 640;
    o.height = 360;
    return o;
}

static asdic_view *open_view(const char *receivers, const char *more) {
    const asdic_view_options o = small();
    return try_view(receivers, more, &o, ASDIC_OK);
}

static void close_view(asdic_view *view) {
    asdic_mission *mission = view->mission;
    asdic_view_destroy(&view);
    asdic_mission_destroy(&mission);
}

static void step(asdic_view *view, int times) {
    for (int i = 0; i < times; i++) {
        assert_ok(t.ctx, asdic_view_step(view));
    }
}

static void the_mission_is_flown_to_its_end(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    size_t count = asdic_mission_ping_count(v->mission);
    assert_true(count > 8 && count < 20);
    for (size_t k = 0; k < count; k++) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(v->mission, k, &time_s);
        assert_false(asdic_view_is_over(v));
        step(v, 1);
        asdic_view_clock clock = asdic_view_get_clock(v);
        assert_int_equal(clock.pings, k + 1);
        assert_close(clock.time_s, 0.25 * (double)k, 1e-9);
        assert_close(time_s, clock.time_s, 1e-9);
        assert_memory_equal(&v->ping.pose.position_m, &pose.position_m, sizeof pose.position_m);
        assert_close(asdic_view_mission_speed_mps(v), 2.0, 0.05); /* to the last one, too */
        assert_close(v->helm.flight.speed_mps, 2.0, 0.05);
    }
    assert_true(asdic_view_is_over(v));
    assert_int_equal(v->trail_count, count);
    for (size_t k = 0; k < count; k++) {
        asdic_vec3 at = asdic_mission_pose(v->mission, k, NULL).position_m;
        assert_memory_equal(&v->trail_m[k], &at, sizeof at);
    }
    asdic_vec3 last = v->ping.pose.position_m;
    assert_true(asdic_view_press(v, "x"));
    assert_false(asdic_view_is_over(v)); /* somebody steers */
    step(v, 1);
    assert_close(v->time_s, 0.25 * (double)count, 1e-9);
    assert_close(v->ping.pose.position_m.y - last.y, 0.5, 0.02); /* 2 m/s for 0.25 s */
    close_view(v);
}

/* While paused a view composes; the first ping is made all the same, for there is something to show. */
static void pauses_hold_pings(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    assert_true(asdic_view_press(v, "space"));
    assert_true(asdic_view_is_paused(v));
    step(v, 3);
    assert_int_equal(v->steps, 1);
    assert_true(v->begun_s == 0.0);
    assert_true(asdic_view_press(v, "."));
    step(v, 3);
    assert_int_equal(v->steps, 2);
    assert_true(asdic_view_press(v, "space"));
    step(v, 3);
    assert_int_equal(v->steps, 5);
    assert_true(v->begun_s > 0.0);
    close_view(v);
}

/* The last pings are kept in the place of the oldest; 400, or as many as 64 MiB hold. */
static void the_history_is_a_ring(void **state) {
    (void)state;
    asdic_view *v = open_view(THREE, "sampling: {rays: 4096}");
    step(v, 1);
    view_history *h = &v->history;
    size_t cells = v->ping.beams * v->ping.bins;
    assert_int_equal(v->ping.beams, 3);
    assert_int_equal(h->rows, 400);
    h->rows = 3;
    for (size_t k = 1; k < 8; k++) {
        const float *kept = h->levels_db + (k - 1) % 3 * cells;
        assert_memory_equal(kept, v->ping.level_db, cells * sizeof *kept);
        assert_int_equal(h->count, k < 3 ? k : 3);
        assert_int_equal(h->next, k % 3);
        step(v, 1);
    }
    close_view(v);

    v = open_view(THREE ", bin_length_m: 0.01", "sampling: {rays: 256}");
    step(v, 1);
    assert_int_equal(v->history.rows, (64 << 20) / (v->ping.beams * v->ping.bins * 4));
    close_view(v);
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
            uint32_t near =
                asdic_colormap_rgb(v->look.colormap, (unsigned)(newest_first_db[found] * 2.56));
            uint32_t far = asdic_colormap_rgb(v->look.colormap,
                                              (unsigned)((newest_first_db[found] + 5.0) * 2.56));
            uint32_t strong = asdic_colormap_rgb(v->look.colormap, (unsigned)(95.0 * 2.56));
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

/* So few rays that four bins are shown as one, which has their mean; the last of what is left. */
static void bins_of_few_rays_are_joined(void **state) {
    (void)state;
    asdic_view *v = open_view(THREE ", bin_length_m: 0.25", "sampling: {rays: 64}");
    step(v, 1);
    const asdic_loop_ping *p = &v->ping;
    size_t heard = 0;
    assert_int_equal(v->joined, 4);
    assert_true(p->bins % 4 != 0);
    for (size_t first = 0; first < p->beams * p->bins; first++) {
        size_t n = first % p->bins, count = p->bins - n < 4 ? p->bins - n : 4;
        double mean = 0.0;
        for (size_t k = 0; n % 4 == 0 && k < count; k++) {
            mean += p->parts->intensity_lin[ASDIC_TOTAL][first + k] / (double)count;
        }
        for (size_t k = 0; mean > 0.0 && k < count; k++, heard++) {
            assert_close((double)p->level_db[first + k], 10.0 * log10(mean), 1e-4);
        }
    }
    assert_true(heard > p->bins);
    close_view(v);

    v = open_view(THREE, "sampling: {rays: 4096}");
    step(v, 1);
    assert_int_equal(v->joined, 1);
    assert_null(v->shown_db);
    close_view(v);
}

/* A change of the sea ends a recording and begins the next; all are written when recording stops. */
static void recordings_are_written_at_the_end(void **state) {
    (void)state;
    asdic_view_options o = small();
    char folder[] = "/tmp/asdic-view-XXXXXX", part[64], command[64];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command, "rm -r %s", folder);
    o.folder = folder;
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    assert_true(asdic_view_press(v, "r"));
    step(v, 2);
    for (int k = 0; k < 2; k++) { /* 2, 1 and 1 pings */
        assert_true(asdic_view_press(v, "l"));
        step(v, 1);
        assert_int_equal(v->ended_count, k + 1);
        assert_non_null(v->recording);
    }
    for (int k = 0; k < 4; k++) {
        snprintf(part, sizeof part, "%s/%03d/track.csv", folder, k);
        assert_int_not_equal(access(part, F_OK), 0);
    }
    v->message[0] = '\0';
    assert_true(asdic_view_press(v, "r"));
    step(v, 1);
    assert_true(v->begun_s == 0.0); /* writing does not count as time */
    assert_null(v->recording);
    assert_int_equal(v->ended_count, 0);
    assert_contains(v->message, "recorded 4 pings to /tmp/asdic-view-");
    for (int k = 0; k < 4; k++) {
        snprintf(part, sizeof part, "%s/%03d/track.csv", folder, k);
        assert_true((access(part, F_OK) == 0) == (k < 3));
    }
    v->message[0] = '\0';
    assert_ok(t.ctx, asdic_view_stop(v)); /* nothing is left */
    assert_string_equal(v->message, "");
    assert_true(asdic_view_press(v, "r"));
    step(v, 1);
    assert_ok(t.ctx, asdic_view_stop(v));
    assert_contains(v->message, "recorded 1 pings to");
    assert_ok(t.ctx, asdic_view_stop(NULL));
    close_view(v);
    assert_int_equal(system(command), 0);
}

/* A machine that is far too slow for the clock gets the least rays, from the next ping on. */
static void slow_machines_get_fewer_rays(void **state) {
    (void)state;
    asdic_view_options o = small();
    o.real_time = true;
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 4096}", &o, ASDIC_OK);
    v->governor.period_s = 1e-6;
    step(v, 5);
    assert_false(v->is_changed);
    step(v, 1);
    assert_true(v->is_changed);
    assert_int_equal(asdic_view_get_clock(v).rays, 2000);
    assert_int_equal(asdic_mission_get_choices(v->mission).rays, 4096);
    step(v, 1);
    assert_false(v->is_changed);
    assert_int_equal(asdic_mission_get_choices(v->mission).rays, 2000);
    close_view(v);
    o.least_rays = 3000;
    v = try_view("[{name: a}]", "sampling: {rays: 4096}", &o, ASDIC_OK);
    assert_int_equal(v->governor.least, 3000);
    close_view(v);
}

/* Where the scene leaves it open: as many as usual, or as every bin needs to be shown. */
static void rays_are_enough_for_every_bin(void **state) {
    (void)state;
    uint32_t usual = asdic_sampling_default().rays;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: auto}");
    assert_int_equal(v->chosen.rays, usual);
    close_view(v);
    v = open_view("[{name: a}], bin_length_m: 0.01", "sampling: {rays: auto}");
    double speed_mps =
        asdic_environment_sound_speed_mps(asdic_mission_environment(v->mission), 7.0);
    size_t bins = asdic_sonar_bin_count(asdic_mission_sonar(v->mission), speed_mps);
    assert_true(v->chosen.rays > usual); /* the least is that of 25 beams */
    assert_int_equal(asdic_governor_joined(v->chosen.rays, 25, bins), 1);
    assert_int_equal(asdic_governor_joined(v->chosen.rays, 25, bins + bins / 100), 2);
    close_view(v);
}

/* From the first ping, in tens of decibels, where options do not say. */
static void the_window_is_of_the_first_ping(void **state) {
    (void)state;
    asdic_view_options o = small();
    for (int given = 0; given < 4; given++) {
        o.db_low = given & 1 ? -33.0 : NAN;
        o.db_high = given & 2 ? 144.0 : NAN;
        asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        double low = v->look.db_low, high = v->look.db_high;
        assert_true(low < high);
        assert_true(given & 1 ? low == -33.0 : remainder(low, 10.0) == 0.0);
        assert_true(given & 2 ? high == 144.0 : remainder(high, 10.0) == 0.0);
        v->look.db_low = -60.0;
        step(v, 1);
        assert_true(v->look.db_low == -60.0 && v->look.db_high == high);
        close_view(v);
    }
}

/* COUNT beams 2 degrees apart, the middle ahead, behind RECEIVERS. */
static void add_beams(char receivers[1024], int count) {
    for (int b = 0; b < count; b++) {
        snprintf(receivers + strlen(receivers), 48, "{name: b%d, yaw_deg: %d}%s", b,
                 2 * b + 1 - count, b + 1 < count ? ", " : "]");
    }
}

/* A fan has ascending bearings in one plane, and is shown as one from twelve beams on; the first beam shown looks
 * ahead. Heads that scan make fans of more than two directions. */
static void fans_are_known(void **state) {
    (void)state;
    static const struct {
        const char *receivers, *scan;
        bool has_fan, shows_fan;
        size_t beam;
    } cases[] = {
        {"[{name: a}]", "", false, false, 0},
        {THREE, "", true, false, 1},
        {"[{name: a, yaw_deg: -10}, {name: b, yaw_deg: -10}, {name: c}]", "", false, false, 2},
        {"[{name: a, yaw_deg: 10}, {name: b, yaw_deg: 2}]", "", false, false, 1},
        {"[{name: a, yaw_deg: 3}, {name: b, yaw_deg: 5, pitch_deg: 2}]", "", false, false, 0},
        {"[{name: a, pitch_deg: -5}, {name: b, yaw_deg: 4}]", "", false, false, 1},
        {"{fan: 11}", "", true, false, 5},
        {"{fan: 12}", "", true, true, 5}, /* of the two in the middle the first */
        {"[{name: a}]", ", scan: {sector_deg: 30, step_deg: 30}", false, false, 0},
        {"[{name: a}]", ", scan: {sector_deg: 60, step_deg: 30}", true, true, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char receivers[1024] = "[";
        int beams = 0;
        if (sscanf(cases[i].receivers, "{fan: %d}", &beams) == 1) {
            add_beams(receivers, beams);
        } else {
            snprintf(receivers, sizeof receivers, "%s%s", cases[i].receivers, cases[i].scan);
        }
        asdic_view *v = open_view(receivers, "sampling: {rays: 256}");
        assert_int_equal(v->has_fan, cases[i].has_fan);
        assert_int_equal(v->shows_fan, cases[i].shows_fan);
        assert_int_equal(v->beam, cases[i].beam);
        for (size_t b = 0; b < asdic_mission_sonar(v->mission)->receiver_count; b++) {
            assert_true(v->bearing_rad[b] == asdic_mission_sonar(v->mission)->receivers[b].yaw_rad);
        }
        close_view(v);
    }
}

/* Three directions from port to starboard; each keeps what the chosen beam heard in it. */
static void scans_keep_the_chosen_beam(void **state) {
    (void)state;
    asdic_view *v =
        open_view("[{name: a, pitch_deg: 9}, {name: b}], scan: {sector_deg: 60, step_deg: 30}",
                  "sampling: {rays: 4096}");
    assert_int_equal(v->beam, 1);
    for (int k = 0; k < 5; k++) {
        step(v, 1);
        asdic_sweep sweep = asdic_mission_sweep(v->mission);
        size_t at = asdic_sweep_direction(&sweep, v->ping.ping), bins = v->ping.bins;
        assert_int_equal(v->polar.columns, 3);
        assert_memory_equal(v->polar.levels_db + at * bins, v->ping.level_db + bins,
                            bins * sizeof(float));
        double head = asdic_sweep_bearing_rad(&sweep, at);
        assert_close(head, 30.0 * DEGREE * ((double)at - 1.0), 1e-9);
        assert_close(asdic_view_sonar_pose(v).yaw_rad, v->ping.pose.yaw_rad + head, 1e-6);
    }
    close_view(v);
}

/* Where the pattern of an aperture falls to a half; a small one hears half all round. */
static void beams_are_as_wide_as_their_pattern(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    v->ping.pose.position_m.z = 7.0;
    double wavelength_m =
        asdic_environment_sound_speed_mps(asdic_mission_environment(v->mission), 7.0) / 100e3;
    for (double length_m = 0.01; length_m < 1.0; length_m *= 2.0) {
        double at = asdic_view_half_width_rad(v, length_m);
        assert_close(beam_pattern_lin(cos(at), sin(at), 0.0, length_m / wavelength_m, 1.0, 0.0),
                     0.5, 1e-3);
    }
    assert_close(asdic_view_half_width_rad(v, 0.001), 90.0 * DEGREE, 1e-9);
    close_view(v);
}

static void wrong_options_are_refused(void **state) {
    (void)state;
    static const struct {
        unsigned width, height;
        asdic_status status;
    } cases[] = {{640, 360, ASDIC_OK},
                 {639, 360, ASDIC_ERROR_ARGUMENT},
                 {640, 359, ASDIC_ERROR_ARGUMENT},
                 {7680, 360, ASDIC_OK},
                 {7681, 360, ASDIC_ERROR_ARGUMENT},
                 {640, 7680, ASDIC_OK},
                 {640, 7681, ASDIC_ERROR_ARGUMENT}};
    asdic_view_options o = small();
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        o.width = cases[i].width;
        o.height = cases[i].height;
        asdic_view *v = try_view("[{name: a}]", "", &o, cases[i].status);
        if (v) {
            close_view(v);
        } else {
            assert_contains(asdic_context_error(t.ctx), "at least 640 x 360, at most 7680 a side");
        }
    }
    o = small();
    o.colormap = ASDIC_COLORMAP_COUNT;
    try_view("[{name: a}]", "", &o, ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(t.ctx), "no colour map");
    assert_int_equal(asdic_view_step(NULL), ASDIC_ERROR_ARGUMENT);
}

/* The camera turns after the vehicle, the short way round, and has it in the middle of its picture; the map holds
 * what is heard, most of it ahead, and stays where it is until the vehicle leaves its middle. */
static void camera_and_map_follow(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    step(v, 2);
    double yaw = v->ping.pose.yaw_rad, range_m = asdic_view_range_m(v), x, y, far_m;
    assert_close(yaw, 90.0 * DEGREE, 0.01);
    assert_close(v->camera_yaw_rad, yaw, 0.01);
    assert_true(asdic_camera_project(v->camera, v->ping.pose.position_m, &x, &y, &far_m));
    assert_close(x, 0.5 * v->layout.chase.w, 2.0);
    assert_close(y, 0.5 * v->layout.chase.h, 0.3 * v->layout.chase.h);
    assert_true(far_m > 3.0 && far_m < 45.0);
    v->camera_yaw_rad = yaw + 350.0 * DEGREE;
    assert_ok(t.ctx, asdic_view_draw(v));
    double turned = v->camera_yaw_rad - (yaw + 350.0 * DEGREE);
    assert_true(turned > 1.0 * DEGREE && turned < 5.0 * DEGREE);

    const asdic_relief *map = &v->relief;
    double side_m = map->cell_m * (double)map->rows;
    assert_int_equal(map->rows, map->columns);
    asdic_vec3 *at = &v->ping.pose.position_m;
    assert_true(map->south_m < at->x - range_m && map->south_m + side_m > at->x + range_m);
    assert_true(map->west_m < at->y - 0.5 * range_m && map->west_m + side_m > at->y + range_m);
    assert_close(map->depth_m[map->columns * 7 + 5], 20.0, 1e-6);
    double south_m = map->south_m, west_m = map->west_m;
    at->x += 0.5 * range_m;
    assert_ok(t.ctx, asdic_view_draw(v));
    assert_true(map->south_m == south_m && map->west_m == west_m);
    at->x += 0.5 * range_m;
    assert_ok(t.ctx, asdic_view_draw(v));
    assert_close(map->south_m - south_m, range_m, 1e-3 * range_m);
    close_view(v);
}

/* The last shot, seen on its way to the camera. */
static asdic_shot shot;

asdic_status __real_asdic_camera_shoot(asdic_camera *camera, const asdic_simulator *sim,
                                       const asdic_shot *of);
asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, const asdic_simulator *sim,
                                       const asdic_shot *of);

asdic_status __wrap_asdic_camera_shoot(asdic_camera *camera, const asdic_simulator *sim,
                                       const asdic_shot *of) {
    shot = *of;
    return __real_asdic_camera_shoot(camera, sim, of);
}

static void draw(asdic_view *view) {
    word_count = 0;
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
    } headings[] = {{0, "000\u00b0"},     {-10, "350\u00b0"},    {359.4, "359\u00b0"},
                    {359.7, "000\u00b0"}, {-365.0, "355\u00b0"}, {95.2, "095\u00b0"}};
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

/* Nine beams and more are one wedge. The chosen beam is amber, which has more red than blue, and stronger. */
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_mission_is_flown_to_its_end),
        cmocka_unit_test(pauses_hold_pings),
        cmocka_unit_test(the_history_is_a_ring),
        cmocka_unit_test(the_newest_ping_is_on_top),
        cmocka_unit_test(bins_of_few_rays_are_joined),
        cmocka_unit_test(recordings_are_written_at_the_end),
        cmocka_unit_test(slow_machines_get_fewer_rays),
        cmocka_unit_test(rays_are_enough_for_every_bin),
        cmocka_unit_test(the_window_is_of_the_first_ping),
        cmocka_unit_test(fans_are_known),
        cmocka_unit_test(scans_keep_the_chosen_beam),
        cmocka_unit_test(beams_are_as_wide_as_their_pattern),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(camera_and_map_follow),
        cmocka_unit_test(beams_are_cones),
        cmocka_unit_test(the_camera_stays_in_the_water),
        cmocka_unit_test(the_scope_shows_the_chosen_beam),
        cmocka_unit_test(the_status_says_what_is),
        cmocka_unit_test(axes_are_even),
        cmocka_unit_test(what_stands_out_is_red),
        cmocka_unit_test(panels_fill_the_frame),
    };
    t = test_device_open_or_skip();
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
