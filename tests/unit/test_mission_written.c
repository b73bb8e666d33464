/* Scenes and tracks that a mission writes. */
#include "mission_files_rig.h"

#include "mission/mission.h"

#include <sys/stat.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(written_scenes_are_as_chosen),
        cmocka_unit_test(written_scenes_keep_what_is_not_chosen),
        cmocka_unit_test(tracks_are_of_the_pings_asked_for),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
