/*
 * Scene files that a mission is loaded from with settings, draws and included files, and those that it writes.
 */
#include "mission_rig.h"

#include "base/memory_left.h"
#include "base/sha256.h"
#include "mission/mission.h"
#include "mission/run/run_chart_data.h"
#include "mission/scene_inputs.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/stat.h>

static uint64_t left = UINT64_MAX;

uint64_t __wrap_asdic_memory_left(void); /* linked in place of the library's */

uint64_t __wrap_asdic_memory_left(void) {
    return left;
}

#define POSE "mission: {pose: {position_m: [0, 0, 3]}}\n"
#define FLAT "bottom: {depth_m: 12}\n"
#define SONAR "sonar: {file: a.yaml, ping_rate_hz: 10, receivers: [{name: a}]}\n"

static const char *path_of(const workshop *w, const char *name) {
    static char paths[2][128];
    static int turn;
    turn = 1 - turn;
    snprintf(paths[turn], sizeof paths[turn], "%s/%s", w->folder, name);
    return paths[turn];
}

/* What is in the file NAME. */
static const char *content_of(const workshop *w, const char *name) {
    static char text[8192];
    FILE *file = fopen(path_of(w, name), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    return text;
}

/* Loads the file scene.yaml, with what is said of it; NULL where it is wrong. */
static asdic_mission *load_with(workshop *w, const asdic_setting *settings, size_t count,
                                const asdic_draw *draw) {
    asdic_mission *m = NULL;
    w->said[0] = '\0';
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, keep_lines, w);
    if (draw) {
        asdic_mission_load_run(w->ctx, path_of(w, "scene.yaml"), settings, count, draw, &m);
    } else {
        asdic_mission_load_with(w->ctx, path_of(w, "scene.yaml"), settings, count, &m);
    }
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, NULL, NULL);
    return m;
}

/* Whether the scene file at PATH is loaded again as that of HASH. */
static bool loads_same(workshop *w, const char *path, const char *hash) {
    asdic_mission *m = NULL;
    assert_ok(w->ctx, asdic_mission_load_same(w->ctx, path, hash, &m));
    bool is_same = m && strcmp(asdic_mission_hash(m), hash) == 0;
    assert_true(is_same || !m);
    asdic_mission_destroy(&m);
    return is_same;
}

/* Settings come after what files bring, the last one for a key counts, and the text stays the file's. */
static void settings_stand_in_place_of_the_file(void **state) {
    workshop *w = *state;
    static const char text[] = "version: 1\n" FLAT SONAR POSE;
    static const asdic_setting settings[] = {{"sonar.frequency_khz", "50"},
                                             {"sonar.file", "b.yaml"},
                                             {"sonar.frequency_khz", "60"},
                                             {"environment.wind_speed_kn", "7"}};
    write_file(w, "a.yaml", "frequency_khz: 30\nbandwidth_khz: 3\nping_rate_hz: 5\n");
    write_file(w, "b.yaml", "frequency_khz: 40\nbandwidth_khz: 4\n");
    write_file(w, "scene.yaml", text);
    asdic_mission *m = load_with(w, NULL, 0, NULL);
    assert_close(asdic_mission_sonar(m)->frequency_hz, 30e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 3e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->ping_rate_hz, 10, 0);
    assert_false(m->is_varied);
    assert_null(strstr(asdic_mission_text(m), "a.yaml"));
    assert_contains(asdic_mission_text(m), "bandwidth_khz: 3");
    char hash[65];
    strcpy(hash, asdic_mission_hash(m));
    asdic_mission_destroy(&m);
    m = load_with(w, settings, 4, NULL);
    assert_close(asdic_mission_sonar(m)->frequency_hz, 60e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 4e3, 1e-6);
    assert_close(asdic_mission_environment(m)->wind_speed_kn, 7, 0);
    assert_true(m->is_varied);
    assert_null(strstr(asdic_mission_text(m), "60"));
    asdic_mission_destroy(&m);
    /* The hash is that of the file with what it includes. */
    assert_true(loads_same(w, path_of(w, "scene.yaml"), hash));
    assert_false(loads_same(w, "-", hash));
    assert_false(loads_same(w, path_of(w, "none.yaml"), hash));
    write_file(w, "a.yaml", "frequency_khz: 31\nbandwidth_khz: 3\nping_rate_hz: 5\n");
    assert_false(loads_same(w, path_of(w, "scene.yaml"), hash));
    write_file(w, "scene.yaml", "version: 1\nsonar: nonsense\n"); /* its text is enough */
    assert_ok(w->ctx, asdic_mission_load_text(w->ctx,
                                              &(asdic_scene_text){.text = SCENE FLAT POSE,
                                                                  .length = strlen(SCENE FLAT POSE),
                                                                  .name = "s"},
                                              &m));
    write_file(w, "scene.yaml", SCENE FLAT POSE);
    assert_true(loads_same(w, path_of(w, "scene.yaml"), asdic_mission_hash(m)));
    asdic_mission_destroy(&m);
}

/* Draws stand in place of the file's values, files before the values in them, and settings in place of draws. */
static void draws_stand_in_place_of_the_file(void **state) {
    workshop *w = *state;
    static const asdic_setting settings[] = {
        {"environment.wind_speed_kn", "7"}, {"sonar.file", "c.yaml"}, {"trial.time_s", "5"}};
    const asdic_draw draw = {.seed = 7, .run = 3};
    char text[1024];
    write_file(w, "b.yaml", "frequency_khz: 40\nbandwidth_khz: 4\n");
    write_file(w, "c.yaml", "frequency_khz: 70\nbandwidth_khz: 7\n");
    snprintf(text, sizeof text,
             "version: 1\n" FLAT SONAR POSE "trial:\n  draws:\n"
             "    - {key: sonar.bandwidth_khz, uniform: [8, 9]}\n"
             "    - {key: sonar.file, choice: [b.yaml]}\n"
             "    - {key: environment.wind_speed_kn, uniform: [20, 30]}\n");
    write_file(w, "scene.yaml", text);
    asdic_mission *m = load_with(w, NULL, 0, &draw);
    assert_non_null(m);
    assert_close(asdic_mission_sonar(m)->frequency_hz, 40e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 8.5e3, 0.5e3);
    double wind_kn = asdic_mission_environment(m)->wind_speed_kn;
    assert_close(wind_kn, 25, 5);
    assert_false(m->is_varied);
    assert_null(strstr(asdic_mission_text(m), "trial"));
    assert_null(strstr(asdic_mission_text(m), "b.yaml"));
    assert_contains(asdic_mission_text(m), "frequency_khz: 40");
    assert_contains(asdic_mission_text(m), "wind_speed_kn: 2");
    for (size_t i = 0; i < 3; i++) {
        asdic_setting drawn = asdic_mission_drawn(m, i);
        assert_non_null(drawn.key);
        if (strcmp(drawn.key, "environment.wind_speed_kn") == 0) {
            assert_close(atof(drawn.value), wind_kn, 1e-12);
        }
    }
    assert_null(asdic_mission_drawn(m, 3).key);
    asdic_mission_destroy(&m);
    m = load_with(w, settings, 3, &draw);
    assert_close(asdic_mission_environment(m)->wind_speed_kn, 7, 0);
    assert_close(asdic_mission_sonar(m)->frequency_hz, 70e3, 1e-6);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 8.5e3, 0.5e3);
    assert_close(m->trial.time_s, 5, 0);
    assert_contains(asdic_mission_text(m), "wind_speed_kn: 7");
    for (size_t i = 0; i < 3; i++) {
        asdic_setting drawn = asdic_mission_drawn(m, i);
        if (strncmp(drawn.key, "sonar.b", 7) != 0) {
            assert_string_equal(drawn.value, drawn.key[0] == 's' ? "c.yaml" : "7");
        }
    }
    asdic_mission_destroy(&m);
    /* Without a draw the section is there, and nothing is drawn. */
    m = load_with(w, settings, 1, NULL);
    assert_null(asdic_mission_drawn(m, 0).key);
    assert_close(asdic_mission_sonar(m)->bandwidth_hz, 3e3, 1e-6);
    assert_close(asdic_mission_environment(m)->wind_speed_kn, 7, 0);
    asdic_mission_destroy(&m);
    static const asdic_setting wrong[] = {{"sonar.frequency_khz", "-1"}};
    assert_null(load_with(w, wrong, 1, &draw));
    assert_contains(asdic_context_error(w->ctx), ", as drawn for run 3 with seed 7");
    assert_null(load_with(w, wrong, 1, NULL));
    assert_null(strstr(asdic_context_error(w->ctx), "as drawn"));
}

/* Lists and maps are set as the file would say them; what is wrong with them is told as theirs, not the file's. */
static void lists_and_maps_are_set(void **state) {
    workshop *w = *state;
    static const asdic_setting good[] = {{"mission.pose.position_m", "[1, 2, 3]"},
                                         {"bottom", "{depth_m: 9, type: mud}"}};
    static const asdic_setting wrong[][2] = {
        {{"mission.pose.position_m", "[1, 2"}, {"mission.pose.position_m=[1, 2:1:1: ", NULL}},
        {{"mission.pose.position_m", "[1, 2, -3]"}, {"position_m=[1, 2, -3]:1:8: ", NULL}},
        {{"bottom", "{depht_m: 9}"}, {"bottom={depht_m: 9}:1:2: ", NULL}},
        {{"sonar.frequenci_khz", "9"}, {"sonar.frequenci_khz=9:1:1: ", NULL}}};
    write_file(w, "scene.yaml", SCENE FLAT POSE);
    asdic_mission *m = load_with(w, good, 2, NULL);
    assert_non_null(m);
    asdic_vec3 at_m = asdic_mission_pose(m, 0, NULL).position_m;
    assert_true(at_m.x == 1 && at_m.y == 2 && at_m.z == 3);
    assert_close(asdic_mission_flat_scene(m, 0).depth_m + asdic_mission_flat_scene(m, 0).altitude_m,
                 9, 1e-9);
    asdic_mission_destroy(&m);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_null(load_with(w, &wrong[i][0], 1, NULL));
        assert_contains(w->said, wrong[i][1].key);
    }
}

/* An index means the file's entry in every run, also where one before it is drawn as none; what is set in an entry that is
 * gone goes with it. */
static void settings_mean_the_entries_of_the_file(void **state) {
    workshop *w = *state;
    static const asdic_setting settings[] = {{"objects[1].position_m[0]", "7"},
                                             {"objects[0].position_m[0]", "8"}};
    const asdic_draw draw = {.seed = 7, .run = 3};
    write_file(w, "scene.yaml",
               SCENE FLAT POSE "objects:\n"
                               "  - {name: a, point: 0, position_m: [20, 0, 3]}\n"
                               "  - {name: b, point: 0, position_m: [30, 0, 3]}\n"
                               "  - {name: c, point: 0, position_m: [40, 0, 3]}\n"
                               "trial:\n  draws:\n    - {key: 'objects[0]', choice: [none]}\n"
                               "    - {key: 'objects[0].position_m[0]', uniform: [1, 2]}\n");
    asdic_mission *m = load_with(w, settings, 2, &draw);
    assert_non_null(m);
    assert_int_equal(asdic_mission_object_count(m), 2);
    assert_string_equal(asdic_mission_get_object(m, 0)->name, "b");
    assert_close(asdic_mission_get_object(m, 0)->pose.position_m.x, 7, 0);
    assert_close(asdic_mission_get_object(m, 1)->pose.position_m.x, 40, 0);
    assert_string_equal(asdic_mission_drawn(m, 1).value, "");
    asdic_mission_destroy(&m);
}

/* What is drawn in what is set whole is drawn in that; what is set in what is drawn whole stands in that. */
static void parts_stand_in_wholes(void **state) {
    workshop *w = *state;
    static const asdic_setting settings[] = {
        {"environment", "{temperature_degc: 5}"},
        {"objects[1]", "{name: c, point: -9, position_m: [40, 1, 3]}"},
        {"objects[0].position_m[0]", "8"},
        {"sampling", "{rays: 500}"},
        {"sampling.seed", "7"}};
    const asdic_draw draw = {.seed = 7, .run = 3};
    write_file(w, "scene.yaml",
               SCENE FLAT POSE
               "objects: [{name: a, point: 0, position_m: [9, 0, 3]}, {name: b, point: 0}]\n"
               "trial:\n  draws:\n"
               "    - {key: environment.wind_speed_kn, uniform: [20, 30]}\n"
               "    - {key: 'objects[0]', choice: [{name: d, point: 1, position_m: [20, 2, 3]}]}\n"
               "    - {key: 'objects[1]', choice: [none]}\n"
               "    - {key: 'objects[1].position_m[0]', uniform: [1, 2]}\n");
    asdic_mission *m = load_with(w, settings, 5, &draw);
    assert_non_null(m);
    assert_close(asdic_mission_environment(m)->temperature_degc, 5, 0);
    assert_close(asdic_mission_environment(m)->wind_speed_kn, 25, 5);
    assert_close(atof(asdic_mission_drawn(m, 0).value), asdic_mission_environment(m)->wind_speed_kn,
                 1e-12);
    assert_int_equal(asdic_mission_object_count(m), 2);
    const asdic_mission_object *first = asdic_mission_get_object(m, 0);
    const asdic_mission_object *second = asdic_mission_get_object(m, 1);
    assert_string_equal(first->name, "d");
    assert_true(first->pose.position_m.x == 8 && first->pose.position_m.y == 2);
    assert_string_equal(second->name, "c");
    assert_close(second->pose.position_m.x, 1.5, 0.5);
    assert_close(second->pose.position_m.y, 1, 0);
    assert_string_equal(asdic_mission_drawn(m, 2).value, settings[1].value);
    assert_int_equal(asdic_mission_sampling(m)->rays, 500);
    assert_int_equal(asdic_mission_sampling(m)->seed, 7);
    asdic_mission_destroy(&m);
}

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

/* All that is wrong in files that a scene names is told of with what is wrong in the scene, each file by itself. */
static void every_wrong_row_of_every_file_is_told_of(void **state) {
    workshop *w = *state;
    write_file(w, "cast.csv", "depth_m,sound_speed_mps\n0,1500\n9,x\n5,1700.5\n4,1490\n4,1490\n");
    write_file(w, "track.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,-1,0,0,\n");
    write_file(w, "curve.csv", "grazing_deg,strength_db\n5,-40\n91,-30\n4,-30\n");
    write_file(w, "scene.yaml",
               "version: 1\nbottom: {depth_m: -1}\n" SONAR
               "objects:\n  - {box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9], "
               "material: {curve: curve.csv}}\n"
               "mission: {track: track.csv}\nenvironment: {sound_speed_profile: cast.csv}\n");
    static const char *const said[] = {
        "cast.csv:3:3: error: 'sound_speed_mps' = x is not a number",
        "cast.csv:4:3: error: 'sound_speed_mps' = 1700.5 is out of range [1300, 1700]",
        "cast.csv:6:1: error: 'depth_m' = 4 is not deeper than 4 at line 5",
        "track.csv:2:7: error: 'z_m' = -1 is out of range [0, 11000]; z is positive down",
        "track.csv:2:14: error: 'yaw_deg' is empty",
        "curve.csv:3:1: error: 'grazing_deg' = 91 is out of range [0, 90]",
        "curve.csv:4:1: error: 'grazing_deg' = 4 is not more than 5 at line 2",
        "scene.yaml:2:19: error: 'depth_m' = -1 is out of range",
    };
    assert_null(load_with(w, NULL, 0, NULL));
    for (size_t i = 0; i < sizeof said / sizeof *said; i++) {
        assert_contains(w->said, said[i]);
    }
    assert_contains(asdic_context_error(w->ctx), "8 errors");
    write_file(w, "scene.yaml",
               "version: 1\nbottom: {depth_m: 12, curve: curve.csv}\n" SONAR
               "mission: {track: track.csv}\nenvironment: {sound_speed_profile: cast.csv}\n");
    assert_null(load_with(w, NULL, 0, NULL));
    for (size_t i = 0; i < sizeof said / sizeof *said - 1; i++) {
        assert_contains(w->said, said[i]);
    }
    assert_contains(asdic_context_error(w->ctx), "7 errors");
}

/* A run of a trial may start below the bottom; runs of a data set need names, and in layers their places count. */
static void loads_of_other_kinds(void **state) {
    workshop *w = *state;
    const asdic_draw draw = {.seed = 7, .run = 3};
    const char *path = path_of(w, "scene.yaml");
    asdic_mission *m = NULL, *first = NULL;
    write_file(w, "scene.yaml", SCENE FLAT "mission: {waypoints: [[0, 0, 3], [0, 60, 14]]}\n");
    assert_null(load_with(w, NULL, 0, &draw));
    assert_ok(w->ctx, asdic_mission_load_trial(w->ctx, path, NULL, 0, &draw, NULL, &m));
    asdic_mission_destroy(&m);
    assert_int_equal(asdic_mission_load_run(w->ctx, path, NULL, 0, NULL, &m), ASDIC_ERROR_ARGUMENT);
    write_file(w, "scene.yaml",
               SCENE FLAT "objects:\n  - {box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9]}\n" POSE);
    assert_ok(w->ctx, asdic_mission_load(w->ctx, path, &m));
    assert_int_equal(asdic_mission_object_count(m), 1);
    assert_false(m->is_varied);
    asdic_mission_destroy(&m);
    assert_ok(w->ctx, asdic_mission_load_empty(w->ctx, path, &m));
    assert_int_equal(asdic_mission_object_count(m), 0);
    assert_true(m->is_varied);
    asdic_mission_destroy(&m);
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, keep_lines, w);
    w->said[0] = '\0';
    assert_int_equal(asdic_mission_load_like(w->ctx, path, &draw, NULL, 0, false, &m),
                     ASDIC_ERROR_INPUT);
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, NULL, NULL);
    assert_string_equal(w->said,
                        "scene.yaml:6:5: error: an object of a data set needs a 'name': it "
                        "is its class  [objects[0]]\n");
    for (int layers = 0; layers < 2; layers++) {
        for (int i = 0; i < 2; i++) {
            char text[600];
            snprintf(text, sizeof text,
                     "version: 1\n%s" FLAT "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n"
                     "objects:\n"
                     "  - {name: a, box: {size_m: [1, 1, 1]}, position_m: [%d, 0, 9]}\n" POSE,
                     layers ? "environment: {sound_speed_profile: [[0, 1500], [9, 1510]]}\n" : "",
                     9 + i);
            write_file(w, "scene.yaml", text);
            const asdic_mission *bases[] = {first};
            assert_ok(w->ctx, asdic_mission_load_like(w->ctx, path, &draw, bases, 1, false,
                                                      i ? &m : &first));
        }
        assert_ptr_equal(m->base, layers ? NULL : first);
        assert_int_equal(m->stands_anywhere, !layers);
        asdic_mission_destroy(&m);
        asdic_mission_destroy(&first);
    }
}

/* A scene in memory that lacks something is refused; 4 MiB are read, and a byte more is not. */
static void scenes_in_memory_are_whole(void **state) {
    workshop *w = *state;
    const size_t most = (size_t)4 << 20;
    char *large = malloc(most + 2);
    asdic_mission *m = NULL;
    asdic_mesh *mesh = NULL;
    assert_non_null(large);
    memset(large, '#', most + 1);
    memcpy(large, SCENE FLAT POSE, strlen(SCENE FLAT POSE));
    large[most + 1] = '\0';
    assert_ok(w->ctx, asdic_mesh_box(w->ctx, (asdic_vec3){1, 1, 1}, &mesh));
    const asdic_named_mesh good = {"box", mesh}, unnamed = {NULL, mesh}, empty = {"box", NULL};
    const asdic_scene_text cases[] = {
        {large, most, "s", &good, 1},  {large, most, "s", NULL, 0},
        {NULL, most, "s", &good, 1},   {large, most, NULL, &good, 1},
        {large, most, "s", NULL, 1},   {large, most, "s", &unnamed, 1},
        {large, most, "s", &empty, 1}, {large, most + 1, "s", NULL, 0}};
    for (size_t i = 0; i < 8; i++) {
        m = (asdic_mission *)large;
        asdic_status status = asdic_mission_load_text(w->ctx, &cases[i], &m);
        assert_int_equal(status, i < 2   ? ASDIC_OK
                                 : i < 7 ? ASDIC_ERROR_ARGUMENT
                                         : ASDIC_ERROR_INPUT);
        assert_int_equal(m != NULL, i < 2);
        asdic_mission_destroy(&m);
    }
    assert_string_equal(asdic_context_error(w->ctx),
                        "s: a scene of 4194305 bytes; at most 4194304 are read");
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, keep_lines, w);
    w->said[0] = '\0';
    asdic_mission_load_text(w->ctx, &(asdic_scene_text){"version: 2", 10, "-", NULL, 0}, &m);
    asdic_context_set_log(w->ctx, ASDIC_LOG_ERROR, NULL, NULL);
    assert_int_equal(strncmp(w->said, "-:1:1: ", 7), 0);
    assert_int_equal(asdic_mission_load(w->ctx, w->folder, &m), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(w->ctx), ": Is a directory; give a scene file");
    asdic_mesh_destroy(&mesh);
    free(large);
}

/* Two beams of 150 bins are some 90,000 bytes. */
static void scenes_beyond_the_memory_are_refused(void **state) {
    workshop *w = *state;
    static const char text[] = "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                               "sonar: {frequency_khz: 100, receivers: [{name: a}, {name: b}]}\n";
    left = 95000;
    asdic_mission *m = load_text(w, text);
    assert_non_null(m);
    asdic_mission_destroy(&m);
    left = 85000;
    m = load_text(w, text);
    left = UINT64_MAX;
    assert_null(m);
    assert_contains(asdic_context_error(w->ctx), "2 beams of 150 bins need 9");
    assert_contains(asdic_context_error(w->ctx), " bytes of memory, 85000 are available; use fewer "
                                                 "beams or a longer 'bin_length_m'");
    /* Smooth pulses of coherent pings reach three times as far, and elements beside the middle. */
    left = 100000;
    m = load_text(w, "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                     "sonar: {frequency_khz: 100, bandwidth_khz: 0.1,\n"
                     "  array: {elements: 16, beams: {count: 2, sector_deg: 9}}}\n"
                     "sampling: {coherent: true}\n");
    left = UINT64_MAX;
    assert_null(m);
    assert_contains(asdic_context_error(w->ctx), "2 beams of 150 bins need 1");
}

/* --- written ------------------------------------------------------------------------------------ */

static const char WRITTEN[] = "version: 1\n"
                              "bottom: {grid: ground.asc, type: mud, position_m: [0, 0, 1]}\n"
                              "objects:\n"
                              "  - {name: a, box: {size_m: [1, 1, 1]}, track: way.csv}\n"
                              "  - {name: b, box: {size_m: [1, 1, 1]}, position_m: [9, 0, 5],\n"
                              "     material: {curve: a.csv}}\n"
                              "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n"
                              "mission: {waypoints: [[5, 5, 3], [5, 30, 3]]}\n"
                              "sampling: {rays: %s}\n";

/* The scene of WRITTEN, changed by CHOICES, written to again/scene.yaml with its track, and read from there. */
static asdic_mission *write_again(workshop *w, const asdic_choices *choices, const char *rays) {
    char text[1024], path[128];
    asdic_mission *m = NULL, *again = NULL;
    snprintf(text, sizeof text, WRITTEN, rays);
    write_file(w, "scene.yaml", text);
    assert_ok(w->ctx, asdic_mission_load(w->ctx, path_of(w, "scene.yaml"), &m));
    if (choices) {
        assert_ok(w->ctx, asdic_mission_choose(w->ctx, m, choices));
    }
    snprintf(path, sizeof path, "%s/again/scene.yaml", w->folder);
    assert_ok(w->ctx, asdic_mission_write_scene(w->ctx, m, path, "track.csv"));
    assert_ok(w->ctx, asdic_mission_write_track(w->ctx, m, path_of(w, "again/track.csv")));
    assert_ok(w->ctx, asdic_mission_load(w->ctx, path, &again));
    assert_int_equal(asdic_mission_ping_count(again), asdic_mission_ping_count(m));
    assert_int_equal(again->object_count, 3);
    assert_int_equal(again->objects[2].material.row_count, 2);
    for (size_t i = 0; i < asdic_mission_ping_count(m); i += 10) {
        asdic_vec3 a = asdic_mission_pose(m, i, NULL).position_m;
        asdic_vec3 b = asdic_mission_pose(again, i, NULL).position_m;
        assert_close(a.x, b.x, 1e-9);
        assert_close(a.y, b.y, 1e-9);
        assert_close(asdic_mission_object_pose(again, 1, i).position_m.x,
                     asdic_mission_object_pose(m, 1, i).position_m.x, 1e-9);
    }
    asdic_mission_destroy(&m);
    return again;
}

static void written_scenes_are_as_chosen(void **state) {
    workshop *w = *state;
    char path[128];
    assert_int_equal(mkdir(path_of(w, "again"), 0700), 0);
    write_file(w, "ground.asc",
               "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 40\n9 9 9\n9 9 9\n9 9 9\n");
    write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n10,-30\n");
    write_track(w, "way.csv", "0,0,0,5,0,0,0\n10,10,20,5,0,0,0\n");
    asdic_mission *m =
        load_text(w, SCENE FLAT "objects:\n"
                                "  - {name: a, box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9],\n"
                                "     material: {lambert_db: -21}}\n"
                                "  - {name: b, box: {size_m: [1, 1, 1]}, position_m: [9, 0, 9],\n"
                                "     material: {sediment: rock}}\n" POSE);
    assert_non_null(m);
    asdic_material rock = m->objects[1].material;
    asdic_choices choices = {.wind_speed_kn = 13,
                             .bottom = m->objects[0].material,
                             .source_level_db = 201,
                             .rays = 777,
                             .seed = 99};
    asdic_mission_destroy(&m);
    m = write_again(w, &choices, "5000");
    asdic_choices read = asdic_mission_get_choices(m);
    assert_close(read.wind_speed_kn, 13, 0);
    assert_close(read.source_level_db, 201, 0);
    assert_int_equal(read.rays, 777);
    assert_int_equal(read.seed, 99);
    assert_ptr_equal(read.bottom.law, choices.bottom.law);
    assert_close(asdic_material_get(&read.bottom, "lambert_db"), -21, 0);
    assert_close(m->objects[0].min_m.z, 10, 0); /* the ground's place is kept */
    assert_true(m->settings.keeps_all_terms);
    asdic_mission_destroy(&m);
    const char *text = content_of(w, "again/scene.yaml");
    assert_null(strstr(text, "waypoints"));
    assert_null(strstr(text, "type: "));
    snprintf(path, sizeof path, "%s/ground.asc", w->folder);
    assert_contains(text, path);
    /* A word that stands for a number; what is not given is left out; rays that asdic chose stay so. */
    choices.bottom = rock;
    m = write_again(w, &choices, "5000");
    text = content_of(w, "again/scene.yaml");
    assert_contains(text, "sediment: rock\n");
    assert_null(strstr(text, "nan"));
    assert_null(strstr(text, "type: "));
    assert_ptr_equal(m->bottom.law, rock.law);
    assert_close(asdic_material_get(&m->bottom, "sediment"), asdic_material_get(&rock, "sediment"),
                 0);
    asdic_mission_destroy(&m);
    m = write_again(w, NULL, "auto");
    assert_true(asdic_settings_rays_are_auto(&m->settings));
    assert_contains(content_of(w, "again/scene.yaml"), "rays: auto");
    assert_close(asdic_material_get(&m->bottom, "type"), 1, 0);
    asdic_mission_destroy(&m);
}

/* A bottom whose law has a file stays as it is; where there is none, none is made. Names that are absolute stay. */
static void written_scenes_keep_what_is_not_chosen(void **state) {
    workshop *w = *state;
    static const char *const bottoms[] = {"{depth_m: 12, curve: a.csv}", "none"};
    char before[500], text[1024], folder[500];
    write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n10,-30\n");
    assert_non_null(getcwd(before, sizeof before));
    assert_int_equal(chdir(w->folder), 0);
    assert_non_null(getcwd(folder, sizeof folder));
    for (size_t i = 0; i < 2; i++) {
        asdic_mission *m = NULL;
        snprintf(text, sizeof text,
                 "version: 1\nbottom: %s\nobjects:\n  - {name: a, point: -20, track: %s/way.csv}\n"
                 "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n" POSE,
                 bottoms[i], folder);
        write_file(w, "scene.yaml", text);
        asdic_status status = asdic_mission_load(w->ctx, "scene.yaml", &m);
        assert_int_equal(status, ASDIC_OK);
        assert_ok(w->ctx, asdic_mission_write_scene(w->ctx, m, "again/scene.yaml", "t.csv"));
        asdic_mission_destroy(&m);
        snprintf(text, sizeof text, "track: %s/way.csv", folder);
        assert_non_null(strstr(content_of(w, "again/scene.yaml"), text));
        /* In quotes, whatever the name: a number's, or one with a colon. */
        assert_non_null(strstr(content_of(w, "again/scene.yaml"), "track: \"t.csv\"\n"));
        assert_null(strstr(content_of(w, "again/scene.yaml"), "//"));
        snprintf(text, sizeof text, "%s/a.csv", folder);
        assert_int_equal(strstr(content_of(w, "again/scene.yaml"), text) != NULL, i == 0);
        assert_int_equal(strstr(content_of(w, "again/scene.yaml"), "none") != NULL, i == 1);
        assert_null(strstr(content_of(w, "again/scene.yaml"), "_db: -2"));
    }
    assert_int_equal(chdir(before), 0);
    asdic_mission *m = NULL;
    assert_int_equal(mkdir(path_of(w, "gone"), 0700), 0);
    write_file(w, "gone/scene.yaml", SCENE FLAT POSE);
    assert_ok(w->ctx, asdic_mission_load(w->ctx, path_of(w, "gone/scene.yaml"), &m));
    assert_int_equal(unlink(path_of(w, "gone/scene.yaml")), 0);
    assert_int_equal(rmdir(path_of(w, "gone")), 0);
    assert_int_equal(asdic_mission_write_scene(w->ctx, m, path_of(w, "x.yaml"), "t.csv"),
                     ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(w->ctx), "gone/scene.yaml' is gone: No such file");
    asdic_mission_destroy(&m);
    m = load_text(w, SCENE FLAT POSE);
    assert_int_equal(asdic_mission_write_scene(w->ctx, NULL, "x", "t.csv"), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mission_write_scene(w->ctx, m, NULL, "t.csv"), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mission_write_track(w->ctx, NULL, "x"), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mission_write_track(w->ctx, m, NULL), ASDIC_ERROR_ARGUMENT);
    asdic_mission_destroy(&m);
}

/* Pings 3 to 6 of a way of 1 m/s along which a ping is 0.1 s. */
static void tracks_are_of_the_pings_asked_for(void **state) {
    workshop *w = *state;
    write_track(w, "way.csv", "100,0,0,5,0,0,90\n110,10,0,5,0,0,90\n");
    asdic_mission *m = load_text(w, SCENE FLAT "mission: {track: way.csv}\n");
    assert_non_null(m);
    assert_ok(w->ctx, asdic_mission_write_pings(w->ctx, m, 3, 4, path_of(w, "part.csv")));
    asdic_mission_destroy(&m);
    const char *text = content_of(w, "part.csv"), *line = strchr(text, '\n');
    for (int i = 3; i < 7; i++) {
        double time_s, x_m, y_m, z_m;
        assert_int_equal(sscanf(line, " %lf,%lf,%lf,%lf", &time_s, &x_m, &y_m, &z_m), 4);
        assert_close(time_s, 100 + 0.1 * i, 1e-9);
        assert_close(x_m, 0.1 * i, 1e-9);
        line = strchr(line + 1, '\n');
    }
    assert_string_equal(line, "\n");
}

/* Leaves BYTE on the stack, where the next functions put their variables. */
static void __attribute__((noinline)) leave(unsigned char byte) {
    volatile unsigned char left_there[16384];
    for (size_t i = 0; i < sizeof left_there; i++) {
        left_there[i] = byte;
    }
}

/* The rows of a curve count, and nothing behind them, whatever memory held before. */
static void inputs_have_one_hash(void **state) {
    workshop *w = *state;
    char first[65] = "", other[65];
    write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n60,-20\n");
    for (int k = 0; k < 4; k++) {
        if (k == 3) {
            write_file(w, "a.csv", "grazing_deg,strength_db\n5,-40\n60,-21\n");
        }
        mallopt(M_PERTURB, 17 + 50 * k); /* what new memory holds */
        asdic_mission *m = load_text(w, SCENE "bottom: {depth_m: 12, curve: a.csv}\n" POSE);
        assert_non_null(m);
        leave((unsigned char)(17 + 50 * k));
        assert_ok(w->ctx, asdic_mission_inputs_hash(w->ctx, m, k == 0 ? first : other));
        asdic_mission_destroy(&m);
        assert_true(k == 0 || (strcmp(first, other) == 0) == (k < 3));
    }
    mallopt(M_PERTURB, 0);
}

/* Adds what sha256sum says of TEXT. */
static void add_sum(char *sums, const char *text) {
    asdic_sha256_hex(text, strlen(text), sums + strlen(sums));
}

/* Whichever a scene names, in its order, beside the scene wherever it lies; no folder, and none that is not there. */
static void files_that_a_scene_names_are_hashed(void **state) {
    workshop *w = *state;
    static const char *const more[] = {"sub/c.csv", "", "a.csv"};
    char text[512], sums[600] = "", hex[65], expected[65];
    int here = open(".", O_RDONLY);
    assert_int_equal(mkdir(path_of(w, "sub"), 0777), 0);
    write_file(w, "a.csv", "1");
    write_file(w, "b.csv", "22");
    write_file(w, "sub/c.csv", "333");
    write_file(w, "sub/a.csv", "4444");
    snprintf(text, sizeof text,
             "a: b.csv\nb: [a.csv, {c: sub/c.csv}]\nd: %s/a.csv\ne: sub\nf: none.csv\ng:\nh: 5\n",
             w->folder);
    write_file(w, "named.yaml", text);
    write_file(w, "sub/named.yaml", "a: [a.csv, ../b.csv]\n");
    write_file(w, "alone.yaml", "a: 5\n");
    add_sum(sums, "22");
    add_sum(sums, "1");
    add_sum(sums, "333");
    add_sum(sums, "1");
    for (int k = 0; k < 2; k++) { /* by its path, and from where it is */
        const char *scene = k == 0 ? path_of(w, "named.yaml") : "named.yaml";
        asdic_text out = {0};
        assert_int_equal(k == 1 ? chdir(w->folder) : 0, 0);
        assert_ok(w->ctx, asdic_scene_files_hash(w->ctx, scene, NULL, 0, &out));
        assert_string_equal(out.data, sums);
        asdic_text_finish(&out);
    }
    assert_int_equal(fchdir(here), 0);
    assert_int_equal(close(here), 0);
    asdic_text out = {0};
    add_sum(sums, "333");
    add_sum(sums, "1");
    assert_ok(w->ctx, asdic_scene_files_hash(w->ctx, path_of(w, "named.yaml"), more, 3, &out));
    assert_string_equal(out.data, sums);
    asdic_text_finish(&out);
    sums[0] = '\0';
    add_sum(sums, "a: [a.csv, ../b.csv]\n");
    add_sum(sums, "4444");
    add_sum(sums, "22");
    asdic_sha256_hex(sums, strlen(sums), expected);
    assert_ok(w->ctx, asdic_scene_inputs_hash(w->ctx, path_of(w, "sub/named.yaml"), hex));
    assert_string_equal(hex, expected);
    asdic_sha256_hex("a: 5\n", 5, expected);
    assert_ok(w->ctx, asdic_scene_inputs_hash(w->ctx, path_of(w, "alone.yaml"), hex));
    assert_string_equal(hex, expected);
}

/* A mission keeps its bottom, and none of its objects is beyond the last. */
static void choices_and_objects_have_limits(void **state) {
    workshop *w = *state;
    asdic_mission *m =
        load_text(w, SCENE FLAT POSE "objects: [{name: p, point: 0, position_m: [9, 1, 5]}]\n");
    assert_non_null(m);
    asdic_choices choices = asdic_mission_get_choices(m);
    const asdic_material sand = choices.bottom;
    choices.wind_speed_kn = 7.0;
    choices.bottom = (asdic_material){.law = NULL};
    assert_int_equal(asdic_mission_choose(w->ctx, m, &choices), ASDIC_ERROR_ARGUMENT);
    choices = asdic_mission_get_choices(m);
    assert_true(asdic_material_equal(&choices.bottom, &sand) && choices.wind_speed_kn != 7.0);
    assert_true(asdic_mission_object_pose(m, 0, 0).position_m.x == 9.0);
    assert_true(asdic_mission_object_pose(m, 1, 0).position_m.x == 0.0);
    assert_true(asdic_mission_object_pose(m, SIZE_MAX, 0).position_m.x == 0.0);
    asdic_mission_destroy(&m);
    m = load_text(w, SCENE "bottom: none\n" POSE);
    assert_non_null(m);
    choices = asdic_mission_get_choices(m);
    assert_null(choices.bottom.law); /* it has none */
    assert_int_equal(asdic_mission_choose(w->ctx, m, &choices), ASDIC_OK);
    asdic_mission_destroy(&m);
    assert_int_equal(asdic_mission_load_with(w->ctx, path_of(w, "scene.yaml"), NULL, 1, &m),
                     ASDIC_ERROR_ARGUMENT);
}

/* A point's outline is a point, and there is none behind it. */
static void outlines_are_as_many_as_objects(void **state) {
    workshop *w = *state;
    mallopt(M_PERTURB, 90);
    asdic_mission *m =
        load_text(w, SCENE FLAT POSE "objects: [{name: p, point: 0, position_m: [9, 1, 5]}]\n");
    assert_non_null(m);
    assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
    assert_string_equal(content_of(w, "objects.csv"), "object,outline,x_m,y_m\np,0,9.000,1.000\n");
    asdic_mission_destroy(&m);
    mallopt(M_PERTURB, 0);
}

/* A floor that slopes both ways: its depth, to a millimetre, in the middle of each cell that lies on it and within reach
 * of a ping, from the north-western one on. Cells are a tenth of a metre, 440 from south to north. */
static void terrain_is_that_in_reach(void **state) {
    workshop *w = *state;
    char text[2048];
    size_t used = (size_t)snprintf(text, sizeof text,
                                   "ncols 2\nnrows 41\nxllcenter -1\nyllcenter -40\n"
                                   "cellsize 2\n");
    for (int row = 0; row < 41; row++) {
        double deep_m = 12.5 - 0.0371 * (40.0 - 2.0 * row);
        used += (size_t)snprintf(text + used, sizeof text - used, "%.4f %.4f\n", deep_m - 0.013,
                                 deep_m + 0.013);
    }
    write_file(w, "slope.asc", text);
    write_track(w, "north.csv", "0,0,0,5,0,0,0\n2,4,0,5,0,0,0\n");
    asdic_mission *m = load_text(
        w, "version: 1\nbottom: {grid: {file: slope.asc, values: depths}, type: mud}\n"
           "sonar: {frequency_khz: 100, ping_rate_hz: 1, bin_length_m: 0.5, max_range_m: 20, "
           "receivers: [{name: a}]}\nmission: {track: north.csv}\n");
    assert_non_null(m);
    unlink(path_of(w, "objects.csv")); /* of another test */
    assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
    assert_int_not_equal(access(path_of(w, "objects.csv"), F_OK), 0);
    assert_int_not_equal(access(path_of(w, "routes.csv"), F_OK), 0);
    FILE *file = fopen(path_of(w, "terrain.asc"), "r");
    assert_non_null(file);
    static const char *const header[] = {"ncols         20\n",  "nrows         440\n",
                                         "xllcorner     -1\n",  "yllcorner     -20\n",
                                         "cellsize      0.1\n", "NODATA_value  -9999\n"};
    for (size_t i = 0; i < sizeof header / sizeof *header; i++) {
        assert_non_null(fgets(text, sizeof text, file));
        assert_string_equal(text, header[i]);
    }
    for (int row = 0; row < 440; row++) {
        for (int column = 0; column < 20; column++) {
            char digits[32], end;
            assert_int_equal(fscanf(file, "%31[0-9.]%c", digits, &end), 2);
            assert_int_equal(end, column == 19 ? '\n' : ' ');
            assert_string_equal(digits + strlen(digits) - 4, strchr(digits, '.'));
            double north_m = 24.0 - 0.1 * (row + 0.5), east_m = -1.0 + 0.1 * (column + 0.5);
            assert_close(strtod(digits, NULL), 12.5 - 0.0371 * north_m + 0.013 * east_m, 5.1e-4);
        }
    }
    assert_int_equal(fgetc(file), EOF);
    assert_int_equal(fclose(file), 0);
    asdic_mission_destroy(&m);
}

/* Of a route every so many-th ping, 512 at most, and the last. */
static void routes_are_thinned_out(void **state) {
    workshop *w = *state;
    static const struct {
        double time_s;
        size_t pings, every, rows;
    } ways[] = {
        {2.5, 251, 1, 251}, {5.11, 512, 1, 512}, {5.12, 513, 2, 257}, {20.01, 2002, 4, 502}};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        char rows[256], text[512];
        snprintf(rows, sizeof rows, "0,0,0,5,0,0,0\n%.17g,4,0,5,0,0,0\n", ways[i].time_s);
        write_track(w, "own.csv", rows);
        snprintf(rows, sizeof rows, "0,10,-5,5,0,0,-20\n%.17g,40,5,5,0,0,70\n", ways[i].time_s);
        write_track(w, "boat.csv", rows);
        snprintf(text, sizeof text,
                 "version: 1\n" FLAT "objects:\n"
                 "  - {name: still, point: -20, position_m: [9, 1, 5]}\n"
                 "  - {name: boat, box: {size_m: [1, 1, 1]}, track: boat.csv}\n"
                 "sonar: {frequency_khz: 100, ping_rate_hz: 100, max_range_m: 5, "
                 "receivers: [{name: a}]}\nmission: {track: own.csv}\n");
        asdic_mission *m = load_text(w, text);
        assert_non_null(m);
        assert_int_equal(asdic_mission_ping_count(m), ways[i].pings);
        assert_ok(w->ctx, asdic_chart_data_write(w->ctx, m, w->folder));
        FILE *file = fopen(path_of(w, "routes.csv"), "r");
        assert_non_null(file);
        assert_non_null(fgets(text, sizeof text, file));
        assert_string_equal(text, "object,time_s,x_m,y_m,yaw_deg\n");
        size_t count = 0, last = ways[i].pings - 1;
        for (; fgets(text, sizeof text, file); count++) {
            double time_s, x_m, y_m, yaw_deg;
            size_t ping = count * ways[i].every < last ? count * ways[i].every : last;
            double share = (double)ping / (100.0 * ways[i].time_s);
            assert_int_equal(sscanf(text, "boat,%lf,%lf,%lf,%lf\n", &time_s, &x_m, &y_m, &yaw_deg),
                             4);
            assert_close(time_s, 0.01 * (double)ping, 1e-9);
            assert_close(x_m, 10.0 + 30.0 * share, 5.1e-4);
            assert_close(y_m, -5.0 + 10.0 * share, 5.1e-4);
            assert_close(yaw_deg, -20.0 + 90.0 * share, 5.1e-4);
        }
        assert_int_equal(count, ways[i].rows);
        assert_int_equal(fclose(file), 0);
        asdic_mission_destroy(&m);
    }
}

/* Copies of a mesh are counted before the first is made: those of its own file, and those that follow. */
static void copies_beyond_the_memory_are_refused(void **state) {
    workshop *w = *state;
    enum { BIG = 21, COPIES = 12 };
    char mesh[1024] = "v 0 0 0\n", text[2048];
    size_t used = strlen(mesh);
    for (int i = 0; i <= BIG; i++) {
        used += (size_t)snprintf(mesh + used, sizeof mesh - used, "v 1 %d %d\n", i, i * i);
    }
    for (int i = 0; i < BIG; i++) {
        used += (size_t)snprintf(mesh + used, sizeof mesh - used, "f 1 %d %d\n", i + 2, i + 3);
    }
    write_file(w, "big.obj", mesh);
    write_file(w, "small.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (int big_first = 0; big_first < 2; big_first++) {
        int length = snprintf(text, sizeof text,
                              "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                              "sonar: {frequency_khz: 100, receivers: [{name: a}]}\nobjects:\n");
        for (int i = 0; i < COPIES + 1; i++) {
            bool big = big_first ? i == 0 : i < COPIES; /* once and eleven small ones; or twelve */
            length += snprintf(text + length, sizeof text - (size_t)length,
                               "  - {mesh: {file: %s.obj}, position_m: [%d, 0, 5], type: rock}\n",
                               big ? "big" : "small", 20 + 5 * i);
        }
        write_file(w, "scene.yaml", text);
        left = big_first ? (BIG + COPIES) * 304 + 46000 : 50000;
        asdic_mission *m = load_with(w, NULL, 0, NULL);
        left = UINT64_MAX;
        assert_int_equal(m != NULL, big_first);
        if (!m) {
            assert_contains(asdic_context_error(w->ctx), "a scene of 252 triangles or more needs");
        }
        asdic_mission_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_stand_in_place_of_the_file),
        cmocka_unit_test(draws_stand_in_place_of_the_file),
        cmocka_unit_test(lists_and_maps_are_set),
        cmocka_unit_test(settings_mean_the_entries_of_the_file),
        cmocka_unit_test(parts_stand_in_wholes),
        cmocka_unit_test(wholes_that_are_set_name_files),
        cmocka_unit_test(casts_take_the_salinity_that_is_set),
        cmocka_unit_test(casts_have_their_salinity_behind_what_precedes_it),
        cmocka_unit_test(casts_take_the_salinity_of_the_water),
        cmocka_unit_test(casts_reach_their_limits),
        cmocka_unit_test(every_wrong_row_of_every_file_is_told_of),
        cmocka_unit_test(loads_of_other_kinds),
        cmocka_unit_test(scenes_in_memory_are_whole),
        cmocka_unit_test(inputs_have_one_hash),
        cmocka_unit_test(files_that_a_scene_names_are_hashed),
        cmocka_unit_test(choices_and_objects_have_limits),
        cmocka_unit_test(outlines_are_as_many_as_objects),
        cmocka_unit_test(terrain_is_that_in_reach),
        cmocka_unit_test(routes_are_thinned_out),
        cmocka_unit_test(scenes_beyond_the_memory_are_refused),
        cmocka_unit_test(copies_beyond_the_memory_are_refused),
        cmocka_unit_test(written_scenes_are_as_chosen),
        cmocka_unit_test(written_scenes_keep_what_is_not_chosen),
        cmocka_unit_test(tracks_are_of_the_pings_asked_for),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
