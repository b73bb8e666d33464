/* A scene file as JSON: what plain words, numbers and quoted texts become. */
#include "mission_rig.h"

static char *json_of(workshop *w, const char *yaml) {
    char path[128], *json = NULL;
    write_file(w, "some.yaml", yaml);
    snprintf(path, sizeof path, "%s/some.yaml", w->folder);
    assert_ok(w->ctx, asdic_mission_file_json(w->ctx, path, &json));
    return json;
}

static void scalars_are_what_they_say(void **state) {
    workshop *w = *state;
    static const char *const cases[][2] = {{"5", "5"},
                                           {"-5", "-5"},
                                           {"0", "0"},
                                           {"-0", "-0"},
                                           {"10", "10"},
                                           {"007", "\"007\""},
                                           {"-01", "\"-01\""},
                                           {"1.50", "1.5"},
                                           {"1e3", "1000"},
                                           {".5", "0.5"},
                                           {"+3", "3"},
                                           {"3x", "\"3x\""},
                                           {"'5'", "\"5\""},
                                           {"\"true\"", "\"true\""},
                                           {"true", "true"},
                                           {"Yes", "true"},
                                           {"on", "true"},
                                           {"FALSE", "false"},
                                           {"no", "false"},
                                           {"off", "false"},
                                           {"y", "true"},
                                           {"N", "false"},
                                           {"~", "null"},
                                           {"null", "null"},
                                           {"", "null"},
                                           {"''", "\"\""},
                                           {"sand", "\"sand\""},
                                           {"a b", "\"a b\""},
                                           {"truer", "\"truer\""},
                                           {"12345678901234567890123", "12345678901234567890123"},
                                           {"'a\"\\b'", "\"a\\\"\\\\b\""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char yaml[64], expected[80];
        snprintf(yaml, sizeof yaml, "k: %s\n", cases[i][0]);
        snprintf(expected, sizeof expected, "{\"k\": %s}", cases[i][1]);
        char *json = json_of(w, yaml);
        if (strcmp(json, expected) != 0) {
            print_error("'%s' is %s, expected %s\n", cases[i][0], json, expected);
            fail();
        }
        free(json);
    }
}

static void nodes_nest(void **state) {
    workshop *w = *state;
    char *json =
        json_of(w, "a: [1, [2, 3], {b: c}]\n# not this\nd: {}\ne: []\n\"f g\":\n  - h\n  - i: 1\n"
                   "    j: yes\n");
    assert_string_equal(json, "{\"a\": [1, [2, 3], {\"b\": \"c\"}], \"d\": {}, \"e\": [], "
                              "\"f g\": [\"h\", {\"i\": 1, \"j\": true}]}");
    free(json);
    json = json_of(w, "k: gr\xc3\xbc\xc3\x9f\n");
    assert_string_equal(json, "{\"k\": \"gr\xc3\xbc\xc3\x9f\"}");
    free(json);
}

static void names_are_text(void **state) {
    workshop *w = *state;
    char *json = json_of(
        w, "objects: [{name: no, mesh: 12}, {name: 1.50, track: 1e3}, {name: on, point: 1.50}]\n"
           "bottom: {grid: {file: 007.0}}\nmesh: {scale: 2.0}\nname:\n");
    assert_string_equal(json, "{\"objects\": [{\"name\": \"no\", \"mesh\": \"12\"}, "
                              "{\"name\": \"1.50\", \"track\": \"1e3\"}, "
                              "{\"name\": \"on\", \"point\": 1.5}], "
                              "\"bottom\": {\"grid\": {\"file\": \"007.0\"}}, "
                              "\"mesh\": {\"scale\": 2}, \"name\": null}");
    free(json);
}

static void what_is_no_file_is_told(void **state) {
    workshop *w = *state;
    char path[128], *json = (char *)w;
    snprintf(path, sizeof path, "%s/some.yaml", w->folder);
    write_file(w, "some.yaml", "a: [1\n");
    assert_status(w->ctx, asdic_mission_file_json(w->ctx, path, &json), ASDIC_ERROR_INPUT);
    assert_null(json);
    assert_contains(asdic_context_error(w->ctx), "some.yaml");
    json = (char *)w;
    snprintf(path, sizeof path, "%s/none.yaml", w->folder);
    assert_true(asdic_mission_file_json(w->ctx, path, &json) != ASDIC_OK);
    assert_null(json);
    assert_status(w->ctx, asdic_mission_file_json(w->ctx, NULL, &json), ASDIC_ERROR_ARGUMENT);
    assert_status(w->ctx, asdic_mission_file_json(w->ctx, path, NULL), ASDIC_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(scalars_are_what_they_say, begin, end),
        cmocka_unit_test_setup_teardown(nodes_nest, begin, end),
        cmocka_unit_test_setup_teardown(names_are_text, begin, end),
        cmocka_unit_test_setup_teardown(what_is_no_file_is_told, begin, end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
