/* Steps of a view: which pings it makes, and what it keeps of them. */
#include "view_rig.h"

#include "base/context.h"
#include "kernels/beam.h"
#include "live/recording.h"
#include "mission/mission.h"

#include <sys/stat.h>

/* Windows of the size that the manual states. */
static void views_are_as_large_as_said(void **state) {
    (void)state;
    const asdic_view_options o = asdic_view_options_default();
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    asdic_view_image frame = asdic_view_get_frame(v);
    assert_true(frame.width == 1280 && frame.height == 720);
    assert_true(o.colormap == ASDIC_COLORMAP_INFERNO && isnan(o.db_low) && isnan(o.db_high));
    close_view(v);
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
        assert_int_equal(clock.is_flown, k + 1 == count);
        assert_close(time_s, clock.time_s, 1e-9);
        assert_memory_equal(&v->ping.pose.position_m, &pose.position_m, sizeof pose.position_m);
        assert_close(asdic_view_mission_speed_mps(v), 2.0, 0.05); /* to the last one, too */
    }
    assert_true(asdic_view_is_over(v));
    assert_int_equal(v->trail_count, count);
    for (size_t k = 0; k < count; k++) {
        asdic_vec3 at = asdic_mission_pose(v->mission, k, NULL).position_m;
        assert_memory_equal(&v->trail_m[k], &at, sizeof at);
    }
    asdic_vec3 last = v->ping.pose.position_m;
    assert_true(asdic_view_press(v, "x"));
    assert_false(asdic_view_is_over(v) || asdic_view_get_clock(v).is_flown); /* somebody steers */
    step(v, 1);
    assert_close(v->time_s, 0.25 * (double)count, 1e-9);
    assert_close(v->ping.pose.position_m.y - last.y, 0.5, 0.02); /* 2 m/s for 0.25 s */
    close_view(v);
}

/* By hand a vehicle goes on as fast through the water as the mission flew, over ground with the current that carried
 * it: once. */
static void a_current_counts_once(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    v->mission->flight.current_mps[1] = v->helm.flight.current_mps[1] = 0.5; /* of the 2 m/s */
    step(v, 3);
    assert_close(asdic_view_mission_speed_mps(v), 1.5, 0.05);
    asdic_vec3 last = v->ping.pose.position_m;
    assert_true(asdic_view_press(v, "x"));
    step(v, 4);
    assert_close(v->ping.pose.position_m.y - last.y, 2.0, 0.05); /* in a second */
    assert_close(asdic_helm_speed_mps(&v->helm), 1.5, 0.05);
    close_view(v);
}

/* A mission that goes on after three pings by hand is flown to its last ping all the same. */
static void the_end_is_flown_after_steering(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    size_t count = asdic_mission_ping_count(v->mission);
    step(v, 1);
    assert_true(asdic_view_press(v, "x"));
    step(v, 3);
    assert_true(asdic_view_press(v, "a"));
    for (size_t k = 1; k < count; k++) {
        assert_false(asdic_view_is_over(v));
        step(v, 1);
    }
    assert_true(asdic_view_is_over(v));
    asdic_vec3 last = asdic_mission_pose(v->mission, count - 1, NULL).position_m;
    assert_memory_equal(&v->ping.pose.position_m, &last, sizeof last);
    close_view(v);
}

/* Who steers before the first ping begins at 0 s, too. */
static void steering_begins_at_once(void **state) {
    (void)state;
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    assert_true(asdic_view_press(v, "x"));
    step(v, 1);
    assert_close(asdic_view_get_clock(v).time_s, 0.0, 1e-12);
    step(v, 1);
    assert_close(asdic_view_get_clock(v).time_s, 0.25, 1e-12);
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
    assert_contains(v->message, "recorded 1 ping to");
    assert_int_equal(asdic_view_stop(NULL), ASDIC_ERROR_ARGUMENT);
    close_view(v);
    assert_int_equal(system(command), 0);
}

/* Who interrupts the program, as by Ctrl-C, has the recording all the same, and the program still sees it. */
static void recordings_are_written_whole_when_interrupted(void **state) {
    (void)state;
    asdic_view_options o = small();
    char folder[] = "/tmp/asdic-view-XXXXXX", command[64], run[64];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command, "rm -r %s", folder);
    snprintf(run, sizeof run, "%s/000", folder);
    o.folder = folder;
    asdic_context *others = t.ctx, *own = NULL; /* that stays interrupted */
    assert_int_equal(asdic_context_create(&own), ASDIC_OK);
    t.ctx = own;
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    t.ctx = others;
    assert_true(asdic_view_press(v, "r"));
    step(v, 2);
    asdic_context_interrupt(own);
    assert_ok(own, asdic_view_stop(v));
    assert_contains(v->message, "recorded 2 pings to");
    assert_true(asdic_context_interrupted(own));
    close_view(v);
    asdic_run *opened = NULL;
    assert_ok(others, asdic_run_open(others, run, &opened));
    assert_int_equal(asdic_run_get_info(opened).pings, 2);
    asdic_run_close(&opened);
    asdic_context_destroy(&own);
    assert_int_equal(system(command), 0);
}

/* Whatever sentence was left before. */
static void an_interrupted_view_says_after_how_many_pings(void **state) {
    (void)state;
    asdic_view_options o = small();
    asdic_context *others = t.ctx, *own = NULL; /* that stays interrupted */
    assert_int_equal(asdic_context_create(&own), ASDIC_OK);
    t.ctx = own;
    asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
    t.ctx = others;
    step(v, 2);
    asdic_context_interrupt(own);
    asdic_fail(own, ASDIC_ERROR_INTERRUPTED, "interrupted after 0 of 1 beams");
    assert_int_equal(asdic_view_step(v), ASDIC_ERROR_INTERRUPTED);
    assert_string_equal(asdic_context_error(own), "interrupted after 2 pings");
    close_view(v);
    asdic_context_destroy(&own);
}

/* The first number that is free, three digits; a recording of no pings leaves nothing. */
static void recordings_have_numbers(void **state) {
    (void)state;
    char folder[] = "/tmp/asdic-view-XXXXXX", path[64], command[64];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof command, "rm -r %s", folder);
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    asdic_recording *r = NULL;
    for (int k = 0; k < 4; k++) {
        snprintf(path, sizeof path, "%s/%03d", folder, k);
        assert_true(k == 2 || mkdir(path, 0777) == 0);
    }
    assert_ok(t.ctx, asdic_recording_begin(t.ctx, v->mission, t.device, folder, &r));
    assert_int_equal(asdic_recording_number(r), 2);
    assert_int_equal(asdic_recording_pings(r), 0);
    snprintf(path, sizeof path, "%s/002/scene.yaml", folder);
    assert_int_equal(access(path, F_OK), 0);
    assert_ok(t.ctx, asdic_recording_end(&r));
    assert_null(r);
    snprintf(path, sizeof path, "%s/002", folder);
    assert_int_not_equal(access(path, F_OK), 0);
    for (int k = 2; k < 1000; k++) {
        snprintf(path, sizeof path, "%s/%03d", folder, k);
        assert_true(k == 3 || k == 999 || mkdir(path, 0777) == 0);
    }
    assert_ok(t.ctx, asdic_recording_begin(t.ctx, v->mission, t.device, folder, &r));
    assert_int_equal(asdic_recording_number(r), 999);
    asdic_recording *other = r;
    assert_status(t.ctx, asdic_recording_begin(t.ctx, v->mission, t.device, folder, &other),
                  ASDIC_ERROR_EXISTS);
    assert_null(other);
    assert_contains(asdic_context_error(t.ctx), "holds 1000 recordings; give another folder");
    snprintf(path, sizeof path, "%s/999/scene.yaml", folder);
    assert_status(t.ctx, asdic_recording_begin(t.ctx, v->mission, t.device, path, &other),
                  ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(t.ctx), "cannot create folder");
    assert_ok(t.ctx, asdic_recording_end(&r));
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
    for (int end = 0; end < 2; end++) { /* beyond all that is heard */
        o.db_low = end ? NAN : 390.0;
        o.db_high = end ? -390.0 : NAN;
        asdic_view *v = try_view("[{name: a}]", "sampling: {rays: 256}", &o, ASDIC_OK);
        step(v, 1);
        assert_true(end ? v->look.db_high == -390.0 : v->look.db_low == 390.0);
        assert_true(v->look.db_high - v->look.db_low == 10.0);
        close_view(v);
    }
}

/* A fan has three bearings or more in their order, also of an array that is tilted, and is shown as one
 * from twelve beams on; the first beam shown looks ahead. Heads that scan make fans of more than two directions. */
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
        {"[{name: a, yaw_deg: -9}, {name: b, pitch_deg: 40}, {name: c, yaw_deg: 9}]", "", true,
         false, 0},
        {"[{name: a, yaw_deg: -9}, {name: b, pitch_deg: 85}, {name: c, yaw_deg: 9}]", "", false,
         false, 0},
        {"[{name: a, yaw_deg: 9}, {name: b, yaw_deg: -1}, {name: c, yaw_deg: -9}]", "", true, false,
         1},
        {"{fan: {count: 12, sector_deg: 120, pitch_deg: 10, length_h_m: 0.1, length_v_m: 0.02}}",
         "", true, true, 5},
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
    for (int k = 5; k < 8; k++) { /* the head goes on when choices change */
        assert_true(asdic_view_press(v, k % 2 ? "l" : "p"));
        step(v, 1);
        assert_int_equal(v->ping.ping, k);
        assert_close(v->ping.time_s, 0.25 * k, 1e-9);
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
    static const double windows[][2] = {{0, 0}, {1, -1}, {-INFINITY, 0}, {0, INFINITY}};
    o = small();
    for (size_t i = 0; i < sizeof windows / sizeof *windows; i++) {
        o.db_low = windows[i][0];
        o.db_high = windows[i][1];
        try_view("[{name: a}]", "", &o, ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(t.ctx), "level window");
    }
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

/* COUNT times the character C. */
static const char *repeated(const char *c, size_t count) {
    static char text[256];
    text[0] = '\0';
    for (size_t i = 0; i < count; i++) {
        strcat(text, c);
    }
    return text;
}

/* Names and messages are as long as there is room, in whole characters: cairo draws nothing after half a one. */
static void long_words_end_with_a_character(void **state) {
    (void)state;
    static const struct {
        const char *character;
        size_t count, named, said;
    } cases[] = {{"a", 150, 63, 150},
                 {"a", 170, 63, 159},
                 {"\u00e4", 100, 31, 79},
                 {"\u20ac", 60, 21, 53},
                 {"\U0001d11e", 60, 15, 39}};
    asdic_view *v = open_view("[{name: a}]", "sampling: {rays: 256}");
    char *path = v->mission->path;
    step(v, 1);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char named[256];
        const char *c = cases[i].character;
        snprintf(named, sizeof named, "asdic  \u00b7  %s  \u00b7  4 pings/s",
                 repeated(c, cases[i].named));
        v->mission->path = strdup(repeated(c, cases[i].count));
        asdic_view_say(v, "%s", repeated(c, cases[i].count));
        assert_string_equal(v->message, repeated(c, cases[i].said));
        assert_ok(t.ctx, asdic_view_draw(v));
        assert_contains(asdic_view_title(v), named);
        free(v->mission->path);
    }
    v->mission->path = path;
    close_view(v);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_are_as_large_as_said),
        cmocka_unit_test(the_mission_is_flown_to_its_end),
        cmocka_unit_test(a_current_counts_once),
        cmocka_unit_test(the_end_is_flown_after_steering),
        cmocka_unit_test(steering_begins_at_once),
        cmocka_unit_test(pauses_hold_pings),
        cmocka_unit_test(the_history_is_a_ring),
        cmocka_unit_test(bins_of_few_rays_are_joined),
        cmocka_unit_test(recordings_are_written_at_the_end),
        cmocka_unit_test(recordings_are_written_whole_when_interrupted),
        cmocka_unit_test(an_interrupted_view_says_after_how_many_pings),
        cmocka_unit_test(recordings_have_numbers),
        cmocka_unit_test(slow_machines_get_fewer_rays),
        cmocka_unit_test(rays_are_enough_for_every_bin),
        cmocka_unit_test(the_window_is_of_the_first_ping),
        cmocka_unit_test(fans_are_known),
        cmocka_unit_test(scans_keep_the_chosen_beam),
        cmocka_unit_test(beams_are_as_wide_as_their_pattern),
        cmocka_unit_test(wrong_options_are_refused),
        cmocka_unit_test(camera_and_map_follow),
        cmocka_unit_test(long_words_end_with_a_character),
    };
    t = test_device_open_or_skip();
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
