/*
 * What a trial draws: distributions against their closed forms, what a number depends on, and draws
 * that cannot be.
 */
#include "scene_text.h"

#include "base/sort.h"
#include "mission/scene_file/scene_draw.h"
#include "mission/scene_file/scene_keys.h"
#include "mission/scene_file/yaml_tree.h"

#include <asdic/asdic.h>

#include <math.h>
#include <unistd.h>

#define RUNS 20000

static const char OBJECTS[] = "objects:\n"
                              "  - {name: a, sphere: {radius_m: 1}, position_m: [30, 0, 6]}\n"
                              "  - {name: b, sphere: {radius_m: 1}, position_m: [40, 0, 6]}\n"
                              "  - {name: c, sphere: {radius_m: 1}, position_m: [50, 0, 6]}\n";

/* What run RUN of a scene with DRAWS gets, "key value" a line; the scene as drawn goes to SCENE. To
 * be freed. */
static char *drawn_by(const char *draws, uint64_t seed, uint64_t run, char **scene) {
    asdic_arena arena = {0};
    asdic_problems problems = {.name = "t"};
    asdic_text text = {0}, out = {0}, tree = {0};
    asdic_yaml_node *root = NULL;
    file_trial trial = {0};
    asdic_drawn drawn = {0};
    asdic_draw draw = {seed, run};
    asdic_text_format(&text, "%s%strial:\n  draws:\n%s", MINIMAL, OBJECTS, draws);
    assert_true(asdic_yaml_read(text.data, text.length, &arena, &problems, &root));
    asdic_schema_read(&asdic_trial_table, &asdic_trial_table, asdic_yaml_child(root, "trial"),
                      &arena, &problems, &trial);
    asdic_scene_draw_check(&trial, &arena, &problems);
    asdic_scene_draw(root, &trial, &draw, ASDIC_TURN_REST, &arena, &problems, &drawn);
    asdic_scene_draw_finish(root, &drawn, &arena, &problems);
    assert_int_equal(problems.total, 0);
    asdic_text_add(&out, "");
    for (size_t i = 0; i < drawn.count; i++) {
        asdic_text_format(&out, "%s %s\n", drawn.items[i].key, drawn.items[i].value);
    }
    asdic_yaml_print(root, &tree);
    char *printed = asdic_text_take(&tree);
    *strstr(printed, "trial:") = '\0';
    if (scene) {
        *scene = printed;
    } else {
        free(printed);
    }
    asdic_text_finish(&text);
    asdic_arena_finish(&arena);
    return asdic_text_take(&out);
}

/* What is printed says what was set: names of files may hold what means something in YAML. */
static void settings_are_printed_as_they_are(void **state) {
    (void)state;
    static const char *const values[] = {
        "w #1", "w: 2", "w:",  "- w",  "-",  "-w",  "[w",  "#w", "'w'", "\"w\"", "a:b#c", " w",
        "w\t",  "w\nv", "{w}", "a, b", "?w", "? w", ": w", "@w", "w",   "-1.5",  "C:\\w"};
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        asdic_arena arena = {0};
        asdic_problems problems = {.name = "t"};
        asdic_text text = {0};
        asdic_yaml_node *root = NULL, *again = NULL;
        const asdic_setting setting = {"list[0].track", values[i]};
        static const char scene[] = "list:\n  - {track: a}\n";
        assert_true(asdic_yaml_read(scene, strlen(scene), &arena, &problems, &root));
        asdic_scene_file_set(root, &setting, &arena, &problems);
        asdic_yaml_print(root, &text);
        assert_true(asdic_yaml_read(text.data, text.length, &arena, &problems, &again));
        assert_int_equal(problems.total, 0);
        const asdic_yaml_node *entry = asdic_yaml_child(again, "list")->first;
        assert_string_equal(asdic_yaml_child(entry, "track")->text, values[i]);
        asdic_problems_finish(&problems);
        asdic_text_finish(&text);
        asdic_arena_finish(&arena);
    }
}

static double number_by(const char *draws, uint64_t run) {
    char *text = drawn_by(draws, 7, run, NULL);
    double value = strtod(strrchr(text, ' '), NULL);
    free(text);
    return value;
}

/* Kolmogorov and Smirnov: the largest distance between the sample's distribution and CDF, times the
 * root of the size, exceeds 1.95 in one of a thousand samples. */
static void check_distribution(const char *draws, double (*cdf)(double)) {
    static double values[RUNS];
    double worst = 0.0;
    for (uint64_t i = 0; i < RUNS; i++) {
        values[i] = number_by(draws, i);
    }
    asdic_sort_doubles(values, RUNS);
    for (size_t i = 0; i < RUNS; i++) {
        worst = fmax(worst, fabs(cdf(values[i]) - ((double)i + 0.5) / RUNS));
    }
    assert_true(worst * sqrt(RUNS) < 1.95);
}

static double uniform_cdf(double x) {
    return (x + 3.0) / 8.0;
}

static double normal_cdf(double x) {
    return 0.5 * erfc((4.0 - x) / 2.0 / sqrt(2.0));
}

/* Between 3 and 4 standard deviations above the mean. */
static double tail_cdf(double x) {
    double low = erfc(3.0 / sqrt(2.0)), high = erfc(4.0 / sqrt(2.0));
    return (low - erfc((x - 4.0) / 2.0 / sqrt(2.0))) / (low - high);
}

static void test_distributions(void **state) {
    (void)state;
    check_distribution("    - {key: a, uniform: [-3, 5]}\n", uniform_cdf);
    check_distribution("    - {key: a, normal: [4, 2]}\n", normal_cdf);
    check_distribution("    - {key: a, normal: [4, 2], within: [10, 12]}\n", tail_cdf);
}

static void test_choices_are_as_likely(void **state) {
    (void)state;
    size_t counts[4] = {0};
    for (uint64_t i = 0; i < RUNS; i++) {
        char *text =
            drawn_by("    - {key: bottom.type, choice: [mud, sand, gravel, rock]}\n", 1, i, NULL);
        counts[strstr(text, "mud")      ? 0
               : strstr(text, "sand")   ? 1
               : strstr(text, "gravel") ? 2
                                        : 3]++;
        free(text);
    }
    double chi_square = 0.0;
    for (size_t i = 0; i < 4; i++) {
        double over = (double)counts[i] - RUNS / 4.0;
        chi_square += over * over / (RUNS / 4.0);
    }
    assert_true(chi_square < 16.27); /* exceeded once in a thousand, three degrees of freedom */
}

/* A draw is the same whatever else is drawn, and in every order of runs. */
static void test_depends_on_seed_run_and_key(void **state) {
    (void)state;
    char *alone = drawn_by("    - {key: x.a, uniform: [0, 1]}\n", 1, 5, NULL);
    char *more = drawn_by("    - {key: x.b, uniform: [0, 1]}\n    - {key: x.a, uniform: [0, 1]}\n",
                          1, 5, NULL);
    char *seed = drawn_by("    - {key: x.a, uniform: [0, 1]}\n", 2, 5, NULL);
    char *run = drawn_by("    - {key: x.a, uniform: [0, 1]}\n", 1, 6, NULL);
    assert_non_null(strstr(more, alone));
    assert_string_not_equal(alone, seed);
    assert_string_not_equal(alone, run);
    assert_true(strtod(more + 4, NULL) != strtod(alone + 4, NULL)); /* x.b and x.a */
    free(alone);
    free(more);
    free(seed);
    free(run);
}

/* The second entry of a list and the key that has its number behind the list's name. */
static void entries_and_keys_draw_apart(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 8; i++) {
        char *scene = NULL;
        free(drawn_by("    - key: objects[0]\n"
                      "      choice:\n"
                      "        - {name: d, point: -20, position_m: [9, {uniform: [0, 1]}, 6],"
                      " position_m1: {uniform: [0, 1]}}\n",
                      1, i, &scene));
        const char *entry = strstr(scene, "position_m: [9, "),
                   *key = strstr(scene, "position_m1: ");
        assert_true(entry && key);
        assert_true(strtod(entry + 16, NULL) != strtod(key + 13, NULL));
        free(scene);
    }
}

/* Draws inside choices are drawn; entries that are none go, and draws inside them with them. */
static void test_nested_and_none(void **state) {
    (void)state;
    bool is_seen[2] = {false, false};
    for (uint64_t i = 0; i < 32; i++) {
        char *scene = NULL;
        char *text =
            drawn_by("    - key: objects[0]\n"
                     "      choice:\n"
                     "        - none\n"
                     "        - {name: pile, cylinder: {radius_m: {uniform: [2, 3]}, length_m: 4},"
                     " position_m: [{normal: [60, 1], within: [59, 61]}, 0, 6]}\n"
                     "    - {key: 'objects[0].position_m[1]', uniform: [-9, -8]}\n"
                     "    - {key: 'objects[1].position_m[1]', uniform: [5, 6]}\n",
                     1, i, &scene);
        bool is_none = strstr(text, "objects[0] none\n");
        is_seen[is_none] = true;
        assert_null(strstr(scene, "name: a"));
        assert_non_null(strstr(scene, "name: b"));
        assert_int_equal(strstr(scene, "name: pile") != NULL, !is_none);
        assert_int_equal(strstr(text, "objects[0].position_m[1] \n") == NULL, !is_none);
        if (!is_none) {
            double radius_m = strtod(strstr(scene, "radius_m:") + 9, NULL);
            assert_true(radius_m > 2.0 && radius_m < 3.0);
        }
        free(text);
        free(scene);
    }
    assert_true(is_seen[0] && is_seen[1]);
}

/* Draws that cannot be make one error each, at their line, also those inside choices. */
static void test_impossible(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {"{key: mission.pose.yaw_deg, uniform: [2, 1]}",
         "'uniform' = [2, 1] is empty; give the lower bound first"},
        {"{key: mission.pose.yaw_deg, normal: [0, 0]}", "a standard deviation of 0 is not above 0"},
        {"{key: mission.pose.yaw_deg, normal: [0, 1], within: [9, 10]}",
         "'within' = [9, 10] leaves 1.1e-19 of the"},
        {"{key: mission.pose.yaw_deg, normal: [0, 1], within: [2, 1]}",
         "'within' = [2, 1] is empty; give the lower"},
        {"{key: mission.pose.yaw_deg, uniform: [0, 1], within: [0, 1]}",
         "'within' cuts a 'normal' draw"},
        {"{key: mission.pose.yaw_deg, choice: []}", "'choice' must be a list of values"},
        {"{key: mission.pose.yaw_deg, choice: [1, {uniform: [2, 1]}]}",
         "'uniform' = [2, 1] is empty"},
        {"{key: mission.pose.yaw_deg, uniform: [0, 1], normal: [0, 1]}", "exclude each other"},
        {"{key: mission.pose.yaw_deg}", "none of 'uniform', 'normal', 'choice' is given"},
        {"{uniform: [0, 1]}", "missing key 'key'"},
        {"{key: [1], uniform: [0, 1]}", "'key' must be the path of a key"},
        {"{key: sampling.seed, choice: [7, 8]}",
         "'sampling.seed' cannot be drawn: leave it out, rays and speckle are others in each "},
        {"{key: enviroment.ph, uniform: [7, 8]}",
         "11:13: error: unknown key 'enviroment'; did you mean 'environment'?"},
        {"{key: environment.pH2, uniform: [7, 8]}", "unknown key 'pH2'; did you mean 'ph'?"},
        {"{key: 3, uniform: [7, 8]}", "unknown key '3'; the keys here are version"},
        {"{key: bottom.ph, uniform: [7, 8]}", "unknown key 'ph' here; it belongs in environment"},
        {"{key: environment.ph.x, uniform: [7, 8]}", "'ph' has no keys, and so no 'x'"},
        {"{key: 'environment.ph[0]', uniform: [7, 8]}", "'ph' has no entry '[0]'"},
        {"{key: 'mission.pose.position_m[3]', uniform: [7, 8]}", "'position_m' has no entry '[3]'"},
        {"{key: 'objects[5].position_m[0]', uniform: [7, 8]}", "there is no 'objects[5]' here"},
        {"{key: 'sonar.receivers[1].yaw_deg', uniform: [7, 8]}", "there is no '[1]' here"},
        {"{key: environment.ph, uniform: [7.5, 9]}",
         "'ph' = 9 is out of range [7, 8.5]  [trial.draws[0]]"},
        {"{key: environment.ph, uniform: [9, 10]}", "'ph' = 9 is out of range [7, 8.5]"},
        {"{key: environment.ph, normal: [8, 2], within: [7, 9]}", "'ph' = 9 is out of range"},
        {"{key: environment.ph, normal: [9, 1]}", "'ph' = 9 is out of range [7, 8.5]"},
        {"{key: bottom.type, choice: [mud, sandd]}",
         "'type' = sandd is not one of mud, sand, gravel, rock or a number in [1, 4]; did you"},
        {"{key: bottom.type, choice: [mud, {uniform: [1, 5]}]}", "'type' = 5 is out of range"},
        {"{key: sampling.rays, uniform: [100, 200]}",
         "'rays' is a whole number, of which a 'choice' can be given"},
        {"{key: sampling, choice: [{rays: {uniform: [100, 200]}}]}",
         "'rays' = 138.1966011250105 is not one of auto or a whole number in "},
        {"{key: sampling, choice: [{rays: {normal: [200, 10]}}]}", "a whole number in "},
        {"{key: sampling, choice: [{rays: {choice: [100, {uniform: [100, 200]}]}}]}",
         "a whole number in "},
        {"{key: mission.pose, choice: [{position_m: [0, 0, {uniform: [3, 1e8]}]}]}",
         "'position_m' = 100000000 is out of range"},
        {"{key: mission.pose, choice: [{position_m: [0, 0, 5], jaw_deg: 3}]}",
         "unknown key 'jaw_deg'; did you mean 'yaw_deg'?"},
        {"{key: 'mission.pose.position_m[2]', uniform: [3, 1e8]}",
         "'position_m' = 100000000 is out of range"},
        {"{key: 'environment.sound_speed_profile[1][1]', uniform: [1400, 1800]}",
         "'sound_speed_profile' = 1800 is out of range [1300, 1700] m/s"},
        {"{key: bottom.type, choice: [mud, none]}", "'type' = none is not one of mud, sand"},
        {"{key: trial.draws, uniform: [0, 1]}", "a trial cannot draw its own 'trial.draws'"},
        {"{key: mission.pose.yaw_deg, unifrom: [0, 1], choice: [1]}", "did you mean 'uniform'?"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        asdic_arena arena = {0};
        asdic_scene_file file;
        asdic_text text = {0};
        asdic_text_format(&text, "%strial:\n  draws:\n    - %s\n", MINIMAL, wrong[i][0]);
        char *errors = read_errors(text.data, text.length, &arena, &file);
        if (strncmp(errors, "scene.yaml:11:", 14) != 0 || !strstr(errors, wrong[i][1]) ||
            strchr(errors, '\n')[1]) {
            fail_msg("%s: %s", wrong[i][0], errors);
        }
        free(errors);
        asdic_text_finish(&text);
        asdic_arena_finish(&arena);
    }
}

/* Keys that the scene does not have yet, entries that other draws bring or take out, values that a part drawn beside
 * them completes, tails whose middle may be, words and numbers. */
static void test_possible(void **state) {
    (void)state;
    static const char *const good[] = {
        "{key: environment.wind_speed_kn, uniform: [0, 60]}",
        "{key: environment.wind_speed_kn, normal: [30, 15]}",
        "{key: environment.particle_density, choice: [low, -80]}",
        "{key: sampling.rays, choice: [100, auto]}",
        "{key: sampling, choice: [{rays: {choice: [100, 200]}}, {rays: {uniform: [300, 300]}}]}",
        "{key: mission, choice: [{pose: {position_m: [0, 0, 5]}}, {waypoints: [[0, 0, 5], [9, 0, "
        "5]]}]}",
        "{key: mission.pose.position_m, choice: [[0, 0, 5], [{uniform: [0, 1]}, 1, 5]]}",
        "{key: objects, choice: [[], [{name: a, point: -20, position_m: [9, 0, 5]}]]}\n"
        "    - {key: 'objects[0].position_m[0]', uniform: [9, 20]}",
        "{key: 'sonar.receivers[0]', choice: [{name: a}, none]}\n"
        "    - {key: 'sonar.receivers[0].yaw_deg', uniform: [0, 9]}",
        "{key: surface, choice: [{law: course}]}\n    - {key: bottom, choice: [none, {depth_m: "
        "9}]}",
        "{key: sonar.file, choice: [a.yaml]}\n    - {key: 'sonar.receivers[7].yaw_deg', choice: "
        "[1]}",
        "{key: environment.sound_speed_profile, choice: [a.csv]}",
    };
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        asdic_arena arena = {0};
        asdic_scene_file file;
        asdic_text text = {0};
        asdic_text_format(&text, "%strial:\n  draws:\n    - %s\n", MINIMAL, good[i]);
        char *errors = read_errors(text.data, text.length, &arena, &file);
        if (errors[0]) {
            fail_msg("%s: %s", good[i], errors);
        }
        free(errors);
        asdic_text_finish(&text);
        asdic_arena_finish(&arena);
    }
}

/* A mission of a run says what was drawn and keeps the scene as drawn; another reads the same from
 * that text. A value that no scene may have is an error that names the run. */
static void test_mission_of_a_run(void **state) {
    (void)state;
    asdic_context *ctx = NULL;
    asdic_mission *mission = NULL, *again = NULL, *bad = NULL;
    asdic_draw draw = {.seed = 3, .run = 9};
    char path[] = "/tmp/asdic-draw-XXXXXX", other[64];
    FILE *file = fdopen(mkstemp(path), "w");
    assert_non_null(file);
    fprintf(file,
            "%s%strial:\n  draws:\n    - {key: environment.wind_speed_kn, uniform: [20, 30]}\n"
            "    - {key: 'objects[1]', choice: [none]}\n",
            MINIMAL, OBJECTS);
    fclose(file);
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(asdic_mission_load_run(ctx, path, NULL, 0, &draw, &mission), ASDIC_OK);
    asdic_setting wind = asdic_mission_drawn(mission, 0);
    assert_string_equal(wind.key, "environment.wind_speed_kn");
    double wind_kn = strtod(wind.value, NULL);
    assert_true(asdic_mission_environment(mission)->wind_speed_kn == wind_kn);
    assert_true(wind_kn > 20.0 && wind_kn < 30.0);
    assert_int_equal(asdic_mission_object_count(mission), 2);
    assert_string_equal(asdic_mission_drawn(mission, 1).value, "none");
    assert_null(asdic_mission_drawn(mission, 2).key);
    assert_null(strstr(asdic_mission_text(mission), "trial"));
    snprintf(other, sizeof other, "%s.again", path);
    file = fopen(other, "w");
    fputs(asdic_mission_text(mission), file);
    fclose(file);
    assert_int_equal(asdic_mission_load(ctx, other, &again), ASDIC_OK);
    assert_string_equal(asdic_mission_hash(again), asdic_mission_hash(mission));
    assert_true(asdic_mission_environment(again)->wind_speed_kn == wind_kn);
    const asdic_setting setting = {"trial.draws[0].uniform[1]", "300"};
    draw.run = 4;
    assert_int_equal(asdic_mission_load_run(ctx, path, &setting, 1, &draw, &bad),
                     ASDIC_ERROR_INPUT);
    assert_non_null(strstr(asdic_context_error(ctx), "as drawn for run 4 with seed 3"));
    asdic_mission_destroy(&mission);
    asdic_mission_destroy(&again);
    asdic_context_destroy(&ctx);
    unlink(path);
    unlink(other);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(settings_are_printed_as_they_are),
        cmocka_unit_test(test_distributions),
        cmocka_unit_test(test_choices_are_as_likely),
        cmocka_unit_test(test_depends_on_seed_run_and_key),
        cmocka_unit_test(entries_and_keys_draw_apart),
        cmocka_unit_test(test_nested_and_none),
        cmocka_unit_test(test_impossible),
        cmocka_unit_test(test_possible),
        cmocka_unit_test(test_mission_of_a_run),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
