/* Scene files, those that they name, and the hashes of all. */
#include "mission_files_rig.h"

#include "base/sha256.h"
#include "mission/mission.h"
#include "mission/scene_inputs.h"

#include <fcntl.h>
#include <malloc.h>
#include <sys/stat.h>

/* All that is wrong in files that a scene names is told of with what is wrong in the scene, each file by itself. */
static void every_wrong_row_of_every_file_is_told_of(void **state) {
    workshop *w = *state;
    write_file(w, "a.yaml", "frequency_khz: 30\n");
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

/* Rays and seeds alone are others in a run than in its text. */
static void what_a_text_does_not_say_is_not_run(void **state) {
    workshop *w = *state;
    asdic_mission *m = load_text(w, SCENE FLAT POSE);
    assert_non_null(m);
    const asdic_choices said = asdic_mission_get_choices(m);
    for (int i = 0; i < 6; i++) {
        asdic_choices choices = said;
        choices.wind_speed_kn += i == 1 ? 1.0 : 0.0;
        choices.source_level_db += i == 2 ? 1.0 : 0.0;
        choices.bottom = i == 3 ? asdic_material_bottom(2.0) : said.bottom;
        choices.rays += i == 4;
        choices.seed += i == 5;
        assert_ok(w->ctx, asdic_mission_choose(w->ctx, m, &choices));
        assert_int_equal(asdic_mission_run(w->ctx, m, NULL, 0, NULL),
                         i >= 1 && i <= 3 ? ASDIC_ERROR_UNSUPPORTED : ASDIC_ERROR_ARGUMENT);
    }
    asdic_mission_destroy(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_wrong_row_of_every_file_is_told_of),
        cmocka_unit_test(loads_of_other_kinds),
        cmocka_unit_test(scenes_in_memory_are_whole),
        cmocka_unit_test(inputs_have_one_hash),
        cmocka_unit_test(files_that_a_scene_names_are_hashed),
        cmocka_unit_test(choices_and_objects_have_limits),
        cmocka_unit_test(what_a_text_does_not_say_is_not_run),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
