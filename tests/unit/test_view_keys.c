/* What each key of the view does, by its state before and after. */
#include "asserts.h"

#include "live/view_state.h"

#include <asdic/asdic.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { BEAMS = 3 };

/* Flown north-east at 2 m/s. */
static const char SCENE[] =
    "version: 1\nbottom: {depth_m: 20}\n"
    "mission: {waypoints: {points_m: [[1, 2, 7], [31, 42, 7]], speed_mps: 2}}\n"
    "sonar: {frequency_khz: 100, ping_rate_hz: 4, receivers: [{name: a}, {name: b}, {name: c}]}\n";

static int begin(void **state) {
    asdic_view *v = calloc(1, sizeof *v);
    char path[] = "/tmp/asdic-keys-XXXXXX";
    int fd = mkstemp(path);
    if (!v || fd < 0 || asdic_context_create(&v->ctx) != ASDIC_OK) {
        return -1;
    }
    bool good = write(fd, SCENE, sizeof SCENE - 1) == (ssize_t)sizeof SCENE - 1;
    close(fd);
    good = good && asdic_mission_load(v->ctx, path, &v->mission) == ASDIC_OK;
    unlink(path);
    *state = v;
    return good ? 0 : -1;
}

static int end(void **state) {
    asdic_view *v = *state;
    asdic_mission_destroy(&v->mission);
    asdic_context_destroy(&v->ctx);
    free(v);
    return 0;
}

/* As a view begins. */
static asdic_view *fresh(void **state) {
    asdic_view *v = *state;
    const asdic_flight flight = {.vehicle = ASDIC_VEHICLE_NOMOTO, .speed_mps = 1.0};
    *v = (asdic_view){.ctx = v->ctx, .mission = v->mission};
    asdic_helm_init(&v->helm, &flight);
    v->chosen.wind_speed_kn = 10.0;
    v->chosen.source_level_db = 200.0;
    v->chosen.rays = 1024;
    v->look.db_low = -20.0;
    v->look.db_high = 30.0;
    return v;
}

static void press(asdic_view *v, const char *key, int times) {
    for (int i = 0; i < times; i++) {
        assert_true(asdic_view_press(v, key));
    }
}

static void steering_starts_where_the_vehicle_is(void **state) {
    asdic_view *v = fresh(state);
    press(v, "x", 1);
    assert_true(v->is_manual);
    assert_non_null(strstr(v->message, "by hand"));
    assert_close(v->helm.state.x_m, 1.0, 1e-9);
    assert_close(v->helm.state.y_m, 2.0, 1e-9);
    assert_close(v->helm.state.z_m, 7.0, 1e-9);
    assert_close(v->helm.wanted_mps, 2.0, 0.02); /* as the mission flies */
    v->message[0] = '\0';
    v->helm.state.x_m = 50.0;
    press(v, "x", 1); /* goes on */
    assert_true(v->helm.state.x_m == 50.0);
    assert_string_equal(v->message, "");

    v = fresh(state);
    v->steps = 1;
    v->ping.pose.position_m = (asdic_vec3){5.0, 6.0, 8.0};
    press(v, "x", 1);
    assert_close(v->helm.state.x_m, 5.0, 1e-9);
    assert_close(v->helm.hold_z_m, 8.0, 1e-9);

    v->mission_ping = 17;
    press(v, "a", 1);
    assert_false(v->is_manual);
    assert_non_null(strstr(v->message, "ping 17"));
    v->message[0] = '\0';
    press(v, "a", 1);
    assert_string_equal(v->message, "");
}

static void arrows_are_quarters(void **state) {
    asdic_view *v = fresh(state);
    press(v, "x", 1);
    double speed = v->helm.wanted_mps;
    press(v, "up", 2);
    assert_close(v->helm.wanted_mps, speed + 0.5, 1e-9);
    press(v, "down", 3);
    assert_close(v->helm.wanted_mps, speed - 0.25, 1e-9);
    press(v, "right", 3);
    assert_close(v->helm.rudder, 0.75, 1e-9);
    press(v, "left", 1);
    assert_close(v->helm.rudder, 0.5, 1e-9);
    press(v, "x", 1);
    assert_true(v->helm.rudder == 0.0);
    press(v, "right", 5);
    assert_true(v->helm.rudder == 1.0);

    assert_true(v->helm.holds_depth);
    press(v, "pagedown", 1);
    assert_false(v->helm.holds_depth);
    assert_close(v->helm.planes, 0.25, 1e-9);
    press(v, "pageup", 2);
    assert_close(v->helm.planes, -0.25, 1e-9);
    v->helm.state.z_m = 9.0;
    press(v, "h", 1);
    assert_true(v->helm.holds_depth && v->helm.hold_z_m == 9.0 && v->helm.planes == 0.0);
    press(v, "h", 1);
    assert_false(v->helm.holds_depth);
}

static void pauses_and_steps(void **state) {
    asdic_view *v = fresh(state);
    press(v, "space", 1);
    assert_true(v->is_paused);
    press(v, ".", 1);
    assert_true(v->is_paused && v->steps_allowed == 1);
    press(v, "space", 1);
    assert_true(!v->is_paused && v->steps_allowed == 0);
    press(v, ".", 1);
    assert_true(v->is_paused && v->steps_allowed == 1);
    assert_false(v->is_quit);
    press(v, "q", 1);
    assert_true(v->is_quit);
}

static void a_recording_needs_a_folder(void **state) {
    asdic_view *v = fresh(state);
    press(v, "r", 1);
    assert_false(v->wants_recording);
    assert_non_null(strstr(v->message, "--output"));
    v->message[0] = '\0';
    v->options.folder = "here";
    press(v, "r", 1);
    assert_true(v->wants_recording);
    press(v, "r", 1);
    assert_false(v->wants_recording);
    assert_string_equal(v->message, "");
}

static void beams_and_colours_go_round(void **state) {
    asdic_view *v = fresh(state);
    const size_t ahead[] = {1, 2, 0, 1}, back[] = {0, 2, 1};
    for (size_t i = 0; i < 4; i++) {
        press(v, "b", 1);
        assert_int_equal(v->beam, ahead[i]);
    }
    for (size_t i = 0; i < 3; i++) {
        press(v, "g", 1);
        assert_int_equal(v->beam, back[i]);
    }
    for (int i = 1; i <= ASDIC_COLORMAP_COUNT; i++) {
        press(v, "c", 1);
        assert_int_equal(v->look.colormap, i % ASDIC_COLORMAP_COUNT);
    }
    const double gains[] = {20.0, 30.0, 40.0, 0.0, 20.0};
    for (size_t i = 0; i < 5; i++) {
        press(v, "t", 1);
        assert_true(v->look.tvg_db_per_decade == gains[i]);
    }
    press(v, "v", 1); /* no fan */
    assert_false(v->shows_fan);
    assert_non_null(strstr(v->message, "no fan"));
    v->has_fan = true;
    press(v, "v", 1);
    assert_true(v->shows_fan);
    press(v, "v", 1);
    assert_false(v->shows_fan);
}

static void check_window(const asdic_view *v, double low, double high) {
    assert_true(v->look.db_low == low);
    assert_true(v->look.db_high == high);
}

static void the_window_moves_by_5_db(void **state) {
    asdic_view *v = fresh(state);
    press(v, "]", 2);
    check_window(v, -10.0, 40.0);
    press(v, "[", 3);
    check_window(v, -25.0, 25.0);
    press(v, "=", 1);
    check_window(v, -30.0, 25.0);
    press(v, "-", 9);
    check_window(v, 15.0, 25.0);
    press(v, "-", 1); /* at least 10 dB */
    check_window(v, 15.0, 25.0);
    press(v, "]", 1);
    check_window(v, 20.0, 30.0);
}

static void the_sea_follows(void **state) {
    asdic_view *v = fresh(state);
    press(v, "p", 1);
    assert_true(v->chosen.wind_speed_kn == 15.0 && v->is_changed);
    press(v, "o", 2);
    assert_true(v->chosen.wind_speed_kn == 5.0);
    press(v, "o", 3);
    assert_true(v->chosen.wind_speed_kn == 0.0);
    v->is_changed = false;
    press(v, "o", 1); /* as calm as can be */
    assert_false(v->is_changed);
    press(v, "p", 20);
    assert_true(v->chosen.wind_speed_kn == 60.0);
    v->is_changed = false;
    press(v, "2", 1); /* of a scene without one */
    assert_false(v->is_changed || v->chosen.bottom.law);
    assert_non_null(strstr(v->message, "no bottom"));
    v->chosen.bottom = asdic_material_bottom(1.5);
    for (int type = 1; type <= 4; type++) {
        const char key[] = {(char)('0' + type), '\0'};
        const asdic_material bottom = asdic_material_bottom(type);
        press(v, key, 1);
        assert_memory_equal(&v->chosen.bottom, &bottom, sizeof bottom);
    }
}

static void source_and_rays_have_limits(void **state) {
    asdic_view *v = fresh(state);
    press(v, "l", 1);
    assert_true(v->chosen.source_level_db == 205.0 && v->is_changed);
    press(v, "k", 2);
    assert_true(v->chosen.source_level_db == 195.0);
    press(v, "l", 20);
    assert_true(v->chosen.source_level_db == 260.0);
    press(v, "k", 100);
    assert_true(v->chosen.source_level_db == -100.0);
    press(v, "m", 1);
    assert_int_equal(v->chosen.rays, 2048);
    assert_int_equal(v->governor.wanted, 2048);
    press(v, "n", 2);
    assert_int_equal(v->chosen.rays, 512);
    press(v, "n", 9);
    assert_int_equal(v->chosen.rays, 64);
    press(v, "m", 30);
    assert_int_equal(v->chosen.rays, 1 << 22);
    assert_int_equal(v->governor.wanted, 1 << 22);
}

static void keys_are_listed(void **state) {
    asdic_view *v = fresh(state);
    size_t count = 0;
    const char *does = NULL, *name;
    for (; (name = asdic_view_key_name(count, &does)) != NULL; count++) {
        assert_true(asdic_view_press(v, name));
        assert_true(does && strlen(does) > 3);
        assert_string_equal(name, asdic_view_key_name(count, NULL));
    }
    assert_int_equal(count, 32);
    assert_false(asdic_view_press(v, "z"));
    assert_false(asdic_view_press(v, NULL));
    assert_false(asdic_view_press(NULL, "x"));
}

static void check_title(asdic_view *v, const char *wanted) {
    asdic_view_write_title(v);
    if (!strstr(v->title, wanted)) {
        fail_msg("'%s' lacks '%s'", v->title, wanted);
    }
}

/* Rays by thousands, those that are wanted where the machine cannot follow, and how time goes. */
static void titles_say_rays_and_time(void **state) {
    static const struct {
        uint32_t rays;
        const char *said;
    } cases[] = {{999, "  999 rays"},           {1000, "  1,000 rays"},
                 {20480, "  20,480 rays"},      {999999, "  999,999 rays"},
                 {1000000, "  1,000,000 rays"}, {12003004, "  12,003,004 rays"}};
    asdic_view *v = fresh(state);
    v->governor.stretch = 1.0;
    for (size_t n = 0; n < sizeof cases / sizeof *cases; n++) {
        v->governor.rays = v->governor.wanted = cases[n].rays;
        check_title(v, cases[n].said);
    }
    check_title(v, "  4 pings/s  ");
    check_title(v, "as fast as it goes");
    check_title(v, "asdic-keys-"); /* the scene's name */
    v->governor.rays = 2048;
    check_title(v, "  2,048 of 12,003,004 rays");
    v->options.real_time = true;
    check_title(v, "real time");
    v->governor.stretch = 1.04;
    check_title(v, "time stretched 1.04\u00d7");
    v->governor.stretch = 2.5;
    check_title(v, "time stretched 2.50\u00d7");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(steering_starts_where_the_vehicle_is),
        cmocka_unit_test(arrows_are_quarters),
        cmocka_unit_test(pauses_and_steps),
        cmocka_unit_test(a_recording_needs_a_folder),
        cmocka_unit_test(beams_and_colours_go_round),
        cmocka_unit_test(the_window_moves_by_5_db),
        cmocka_unit_test(the_sea_follows),
        cmocka_unit_test(source_and_rays_have_limits),
        cmocka_unit_test(keys_are_listed),
        cmocka_unit_test(titles_say_rays_and_time),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
