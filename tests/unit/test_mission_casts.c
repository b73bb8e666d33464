/* Casts of the water that scene files name. */
#include "mission_files_rig.h"

/* By Medwin's equation, at the surface. */
static double speed_of(double temperature_degc, double salinity_ppt) {
    double t = temperature_degc;
    return 1449.2 + 4.6 * t - 0.055 * t * t + 0.00029 * t * t * t +
           (1.34 - 0.010 * t) * (salinity_ppt - 35.0);
}

/* The speeds of a cast of temperatures are those of the salinity that is set or drawn. */
static void casts_take_the_salinity_that_is_set(void **state) {
    workshop *w = *state;
    static const asdic_setting set = {"environment.salinity_ppt", "20"};
    const asdic_draw draw = {.seed = 7, .run = 3};
    write_file(w, "a.yaml", "frequency_khz: 30\n");
    write_file(w, "cast.csv", "depth_m,temperature_degc\n0,10\n9,5\n");
    write_file(w, "scene.yaml",
               "version: 1\n" FLAT SONAR POSE
               "environment: {sound_speed_profile: cast.csv, salinity_ppt: 35}\n"
               "trial: {draws: [{key: environment.salinity_ppt, choice: [5]}]}\n");
    const struct {
        size_t settings;
        const asdic_draw *draw;
        double salinity_ppt;
    } cases[] = {{0, NULL, 35.0}, {1, NULL, 20.0}, {0, &draw, 5.0}, {1, &draw, 20.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_mission *m = load_with(w, &set, cases[i].settings, cases[i].draw);
        assert_non_null(m);
        const asdic_environment *env = asdic_mission_environment(m);
        assert_close(env->salinity_ppt, cases[i].salinity_ppt, 0);
        assert_close(env->sound_speed_profile.sound_speed_mps[0],
                     speed_of(10.0, cases[i].salinity_ppt), 1e-9);
        asdic_mission_destroy(&m);
    }
}

/* A sonar and a cast that are set whole are read from the files that they name. */
static void wholes_that_are_set_name_files(void **state) {
    workshop *w = *state;
    static const asdic_setting settings[] = {
        {"sonar", "{file: b.yaml, ping_rate_hz: 10}"},
        {"environment", "{sound_speed_profile: cast.csv, salinity_ppt: 20}"},
        {"sonar.bandwidth_khz", "5"}};
    write_file(w, "b.yaml", "frequency_khz: 40\nbandwidth_khz: 4\nreceivers: [{name: a}]\n");
    write_file(w, "cast.csv", "depth_m,temperature_degc\n0,10\n9,5\n");
    write_file(w, "scene.yaml", SCENE FLAT POSE);
    asdic_mission *m = load_with(w, settings, 3, NULL);
    assert_non_null(m);
    assert_close(asdic_mission_sonar(m)->frequency_hz, 40e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 5e3, 1e-6);
    assert_close(asdic_mission_environment(m)->sound_speed_profile.sound_speed_mps[0],
                 speed_of(10.0, 20.0), 1e-9);
    asdic_mission_destroy(&m);
}

/* A cast's own salinity counts, whatever stands before its header: a mark of UTF-8, comments, blank lines. */
static void casts_have_their_salinity_behind_what_precedes_it(void **state) {
    workshop *w = *state;
    static const char *const before[] = {"", "\xef\xbb\xbf", "# a\r\n\r\n",
                                         "\xef\xbb\xbf# a\r\n\r\n"};
    write_file(w, "a.yaml", "frequency_khz: 30\n");
    write_file(w, "scene.yaml",
               "version: 1\n" FLAT SONAR POSE
               "environment: {sound_speed_profile: cast.csv, salinity_ppt: 35}\n");
    for (size_t i = 0; i < sizeof before / sizeof *before; i++) {
        char text[128];
        snprintf(text, sizeof text,
                 "%sdepth_m,temperature_degc,salinity_ppt\r\n0,10,20\r\n9,5,20\r\n", before[i]);
        write_file(w, "cast.csv", text);
        asdic_mission *m = load_with(w, NULL, 0, NULL);
        assert_non_null(m);
        assert_close(asdic_mission_environment(m)->sound_speed_profile.sound_speed_mps[0],
                     speed_of(10.0, 20.0), 1e-9);
        asdic_mission_destroy(&m);
    }
}

/* Where nothing says how salty the water is, a cast's speeds are those of the salinity that absorption has. */
static void casts_take_the_salinity_of_the_water(void **state) {
    workshop *w = *state;
    write_file(w, "a.yaml", "frequency_khz: 30\n");
    write_file(w, "cast.csv", "depth_m,temperature_degc\n0,10\n9,5\n");
    write_file(w, "scene.yaml",
               "version: 1\n" FLAT SONAR POSE "environment: {sound_speed_profile: cast.csv}\n");
    asdic_mission *m = load_with(w, NULL, 0, NULL);
    assert_non_null(m);
    const asdic_environment *env = asdic_mission_environment(m);
    assert_close(env->salinity_ppt, asdic_environment_default().salinity_ppt, 0);
    assert_close(env->sound_speed_profile.sound_speed_mps[0], speed_of(10.0, env->salinity_ppt),
                 1e-9);
    asdic_mission_destroy(&m);
}

/* The first of a cast's rows may be at a limit and not beyond it, which its error tells. */
static void casts_reach_their_limits(void **state) {
    workshop *w = *state;
    static const struct {
        const char *rows, *says; /* NULL: good */
    } casts[] = {
        {"depth_m,sound_speed_mps\n0,1300\n11000,1700\n", NULL},
        {"depth_m,temperature_degc,salinity_ppt\n0,-2,0\n9,40,45\n", NULL},
        {"depth_m,sound_speed_mps\n-0.1,1500\n9,1500\n",
         "cast.csv:2:1: error: 'depth_m' = -0.1 is out of range [0, 11000]"},
        {"depth_m,sound_speed_mps\n0,1500\n11000.5,1500\n",
         "cast.csv:3:1: error: 'depth_m' = 11000.5 is out of range [0, 11000]"},
        {"depth_m,sound_speed_mps\n0,1299.5\n9,1500\n",
         "cast.csv:2:3: error: 'sound_speed_mps' = 1299.5 is out of range [1300, 1700]"},
        {"depth_m,sound_speed_mps\n0,1500\n9,1700.5\n",
         "cast.csv:3:3: error: 'sound_speed_mps' = 1700.5 is out of range [1300, 1700]"},
        {"depth_m,sound_speed_mps\n0,1500\n0,1490\n",
         "cast.csv:3:1: error: 'depth_m' = 0 is not deeper than 0 at line 2"},
        {"depth_m,temperature_degc\n0,-2.5\n9,5\n",
         "cast.csv:2:3: error: 'temperature_degc' = -2.5 is out of range [-2, 40]"},
        {"depth_m,temperature_degc\n0,5\n9,40.5\n",
         "cast.csv:3:3: error: 'temperature_degc' = 40.5 is out of range [-2, 40]"},
        {"depth_m,temperature_degc,salinity_ppt\n0,5,-0.5\n9,5,1\n",
         "cast.csv:2:5: error: 'salinity_ppt' = -0.5 is out of range [0, 45]"},
        {"depth_m,temperature_degc,salinity_ppt\n0,5,1\n9,5,45.5\n",
         "cast.csv:3:5: error: 'salinity_ppt' = 45.5 is out of range [0, 45]"},
    };
    write_file(w, "a.yaml", "frequency_khz: 30\n");
    write_file(w, "scene.yaml",
               "version: 1\n" FLAT SONAR POSE "environment: {sound_speed_profile: cast.csv}\n");
    for (size_t i = 0; i < sizeof casts / sizeof *casts; i++) {
        write_file(w, "cast.csv", casts[i].rows);
        asdic_mission *m = load_with(w, NULL, 0, NULL);
        if (casts[i].says) {
            assert_null(m);
            assert_contains(w->said, casts[i].says);
        } else {
            assert_non_null(m);
        }
        asdic_mission_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(casts_take_the_salinity_that_is_set),
        cmocka_unit_test(wholes_that_are_set_name_files),
        cmocka_unit_test(casts_have_their_salinity_behind_what_precedes_it),
        cmocka_unit_test(casts_take_the_salinity_of_the_water),
        cmocka_unit_test(casts_reach_their_limits),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
