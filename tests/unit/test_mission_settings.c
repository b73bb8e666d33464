/* Settings and draws that stand in place of what a scene file says. */
#include "mission_files_rig.h"

#include "mission/mission.h"

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
    assert_contains(asdic_context_error(w->ctx), "tails of 'normal' by 'within'");
    assert_null(load_with(w, wrong, 1, NULL));
    assert_null(strstr(asdic_context_error(w->ctx), "as drawn"));
    write_file(w, "scene.yaml",
               "version: 1\n" FLAT SONAR POSE); /* a run of which nothing is drawn */
    assert_null(load_with(w, wrong, 1, &draw));
    assert_contains(asdic_context_error(w->ctx), ": 1 error");
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_stand_in_place_of_the_file),
        cmocka_unit_test(draws_stand_in_place_of_the_file),
        cmocka_unit_test(lists_and_maps_are_set),
        cmocka_unit_test(settings_mean_the_entries_of_the_file),
        cmocka_unit_test(parts_stand_in_wholes),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
