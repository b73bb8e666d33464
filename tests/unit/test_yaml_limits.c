/*
 * What is refused before a scene file is looked into: bad text, bad YAML, YAML that only a
 * serialiser writes, and files that are too deep or too long.
 */
#include "scene_text.h"

#include "mission/scene_file/scene_file.h"

static void syntax_errors_have_a_place(void **state) {
    (void)state;
    expect_errors("sonar: {a: 1\nbottom: 2\n",
                  "2:7: error: not valid YAML: did not find expected ',' or '}', while parsing a "
                  "flow mapping that began at 1:8\n");
    expect_errors("a: b: c\n",
                  "1:5: error: not valid YAML: mapping values are not allowed in this context\n");
    expect_errors("a: 'b\n",
                  "2:1: error: not valid YAML: found unexpected end of stream, while scanning a "
                  "quoted scalar that began at 1:4\n");
    expect_errors("a:\n\tb: 1\n",
                  "2:1: error: not valid YAML: a tab cannot begin a key or a value; indent with "
                  "spaces\n");
    expect_errors("a: %b\n",
                  "1:4: error: not valid YAML: found character that cannot start any token, while "
                  "scanning for the next token that began at 1:4\n");
    expect_errors("", "1:1: error: the file is empty\n");
    expect_errors("# nothing\n", "1:1: error: the file is empty\n");
}

static void undecodable_text_has_a_place(void **state) {
    (void)state;
    expect_errors("version: 1\nbottom: \xff\n",
                  "2:9: error: not a text file in UTF-8: invalid leading UTF-8 octet (0xFF); save "
                  "the scene as UTF-8\n");
    expect_errors("a: \xc3\xa4\xc3\xa4\xe4\nb: 1\n",
                  "1:7: error: not a text file in UTF-8: invalid trailing UTF-8 octet (0x0A); save "
                  "the scene as UTF-8\n");
    expect_errors("a: \x01\n",
                  "1:4: error: not a text file in UTF-8: control characters are not allowed "
                  "(0x01); save the scene as UTF-8\n");
}

static void yaml_of_serialisers_is_refused(void **state) {
    (void)state;
    expect_edit("frequency_khz: 100", "frequency_khz: &f 100",
                "4:18: error: anchors (&f) are not accepted; leave it out  "
                "[sonar.frequency_khz]\n");
    expect_edit("frequency_khz: 100", "frequency_khz: !!float 100",
                "4:18: error: tags (tag:yaml.org,2002:float) are not accepted; leave it out  "
                "[sonar.frequency_khz]\n");
    expect_edit("frequency_khz: 100", "frequency_khz: *f",
                "4:18: error: aliases (*f) are not accepted; write the value out  "
                "[sonar.frequency_khz]\n");
    expect_edit("version: 1", "&v version: 1",
                "1:1: error: anchors (&v) are not accepted; leave it out  [scene]\n");
    expect_edit("{depth_m: 12}", "{&d depth_m: 12}",
                "2:10: error: anchors (&d) are not accepted; leave it out  [bottom]\n");
    expect_edit("{depth_m: 12}", "&b {depth_m: 12}",
                "2:9: error: anchors (&b) are not accepted; leave it out  [bottom]\n");
    expect_edit("version: 1", "? [version]\n: 1\nversion: 1",
                "1:3: error: a key is a list or a map, not a word  [scene]\n");
    expect_edit("{depth_m: 12}", "{depth_m: 12, <<: {type: sand}}",
                "2:23: error: merges (<<) are not accepted; write the keys out  [bottom]\n");
}

static void duplicate_keys_are_refused(void **state) {
    (void)state;
    expect_edit("mission:", "bottom: none\nmission:",
                "7:1: error: duplicate key 'bottom'; it is given at line 2 already  [scene]\n");
    expect_edit("{depth_m: 12}", "{\"depth_m\": 12, depth_m: 13}",
                "2:25: error: duplicate key 'depth_m'; it is given at line 2 already  [bottom]\n");
}

static void one_file_is_one_document(void **state) {
    (void)state;
    char *text = edited(MINIMAL, "version", "%YAML 1.1\n---\nversion");
    expect_errors(text, "");
    free(text);
    asdic_text two = {0};
    asdic_text_add(&two, MINIMAL);
    asdic_text_add(&two, "---\nversion: 1\n");
    expect_errors(two.data, "9:1: error: a second document begins; one file holds one scene\n");
    asdic_text_finish(&two);
}

static void nesting_is_limited(void **state) {
    (void)state;
    for (int depth = 30; depth <= 100000; depth = depth == 30   ? 33
                                                  : depth == 33 ? 100000
                                                                : 1 << 30) {
        asdic_arena arena = {0};
        asdic_scene_file file;
        char *text = malloc((size_t)depth + 8);
        assert_non_null(text);
        memcpy(text, "a: ", 3);
        memset(text + 3, '[', (size_t)depth);
        char *errors = read_errors(text, (size_t)depth + 3, &arena, &file);
        bool deep = strstr(errors, "scene.yaml:1:35: error: nested deeper than 32 levels") != NULL;
        assert_int_equal(deep, depth > 30);
        free(errors);
        free(text);
        asdic_arena_finish(&arena);
    }
}

static void keys_and_values_are_limited(void **state) {
    (void)state;
    asdic_text text = {0};
    for (int i = 0; i < 300; i++) {
        asdic_text_format(&text, "k%d: 1\n", i);
    }
    expect_errors(text.data, "257:1: error: more than 256 keys in one map  [scene]\n");
    asdic_text_finish(&text);
    asdic_text_add(&text, "version: [");
    for (int i = 0; i < 600000; i++) {
        asdic_text_add(&text, "1,\n");
    }
    expect_errors(text.data, "499998:1: error: more than 500000 values; put geometry into mesh "
                             "files\n");
    asdic_text_finish(&text);
}

/* UNITS of UTF-16 for TEXT (ASCII), with a byte-order mark. */
static size_t to_utf16(const char *text, int big_endian, char *out) {
    size_t n = 0;
    out[n + !big_endian] = (char)0xfe;
    out[n + big_endian] = (char)0xff;
    for (n = 2; *text; text++, n += 2) {
        out[n + big_endian] = *text;
        out[n + !big_endian] = '\0';
    }
    return n;
}

static void encodings_are_understood(void **state) {
    (void)state;
    char wide[2 * sizeof MINIMAL + 2];
    size_t length = 0;
    for (int big_endian = 0; big_endian < 2; big_endian++) {
        /* The mark's two bytes are FF FE in little-endian order. */
        size_t size = to_utf16(MINIMAL, big_endian, wide);
        wide[0] = (char)(big_endian ? 0xfe : 0xff);
        wide[1] = (char)(big_endian ? 0xff : 0xfe);
        char *text = asdic_text_to_utf8(wide, size, &length);
        assert_string_equal(text, MINIMAL);
        assert_int_equal(length, strlen(MINIMAL));
        free(text);
    }
    char *marked = asdic_text_to_utf8("\xef\xbb\xbfversion: 1", 13, &length);
    assert_string_equal(marked, "version: 1");
    free(marked);
    /* U+00E4, U+20AC, U+1D11E as a pair of surrogates, and a lone surrogate. */
    char *letters =
        asdic_text_to_utf8("\xff\xfe\xe4\x00\xac\x20\x34\xd8\x1e\xdd\x34\xd8", 12, &length);
    assert_string_equal(letters, "\xc3\xa4\xe2\x82\xac\xf0\x9d\x84\x9e\xed\xa0\xb4");
    free(letters);
    /* Characters that take half as much again: the heap is looked through for bytes behind the result. */
    enum { CHARACTERS = 1000 };
    char utf16[2 * CHARACTERS + 2] = "\xff\xfe";
    for (size_t i = 1; i <= CHARACTERS; i++) {
        memcpy(utf16 + 2 * i, "\x00\x4e", 2);
    }
    char *chinese = asdic_text_to_utf8(utf16, sizeof utf16, &length);
    assert_int_equal(length, 3 * CHARACTERS);
    for (size_t i = 0; i < CHARACTERS; i++) {
        assert_memory_equal(chinese + 3 * i, "\xe4\xb8\x80", 3);
    }
    free(chinese);
    char *empty = asdic_text_to_utf8("", 0, &length);
    assert_int_equal(length, 0);
    free(empty);
}

static void line_ends_of_all_systems(void **state) {
    (void)state;
    const char *ends[] = {"\r\n", "\r"};
    for (size_t e = 0; e < 2; e++) {
        asdic_text text = {0};
        for (const char *c = MINIMAL; *c; c++) {
            if (*c == '\n') {
                asdic_text_add(&text, ends[e]);
            } else {
                asdic_text_add_bytes(&text, c, 1);
            }
        }
        expect_errors(text.data, "");
        char *wrong = edited(text.data, "100", "9e9");
        expect_errors(wrong, "4:18: error: 'frequency_khz' = 9e9 is out of range [0.1, 3000] kHz  "
                             "[sonar.frequency_khz]\n");
        free(wrong);
        asdic_text_finish(&text);
    }
}

static void hostile_values_are_shown_tamely(void **state) {
    (void)state;
    expect_edit("100", "\"\\e[31m%s%n\\0\"",
                "4:18: error: 'frequency_khz' = \"?[31m%s%n?\" is text, not a number in [0.1, "
                "3000] kHz  [sonar.frequency_khz]\n");
    expect_edit(
        "frequency_khz: 100", "frequency_khz: 100\n  \"%s%s%n\\0x\": 1",
        "5:3: error: a key holds a zero character  [sonar]\n"
        "5:3: error: unknown key '%s%s%n'; the keys here are file, frequency_khz, "
        "bandwidth_khz, ping_rate_hz, max_range_m, source_level_db, bin_length_m, blanking_m, "
        "transmitter, receivers, array, scan, noise, speckle, speckle_shape, rear_floor_db  "
        "[sonar]\n");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(syntax_errors_have_a_place),
        cmocka_unit_test(undecodable_text_has_a_place),
        cmocka_unit_test(yaml_of_serialisers_is_refused),
        cmocka_unit_test(duplicate_keys_are_refused),
        cmocka_unit_test(one_file_is_one_document),
        cmocka_unit_test(nesting_is_limited),
        cmocka_unit_test(keys_and_values_are_limited),
        cmocka_unit_test(encodings_are_understood),
        cmocka_unit_test(line_ends_of_all_systems),
        cmocka_unit_test(hostile_values_are_shown_tamely),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
