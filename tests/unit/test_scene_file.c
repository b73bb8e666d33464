/*
 * Whole scene files: the documented example, its twin in JSON, other locales, and thousands of
 * damaged copies.
 */
#include "scene_text.h"

#include "base/file_read.h"
#include "base/number.h"
#include "de_locale.h"
#include "damage.h"
#include "mission/mission_settings.h"

static char *read_file(const char *name, size_t *size) {
    char path[512];
    char *data = NULL;
    snprintf(path, sizeof path, "%s/unit/scenes/%s", TEST_DIR, name);
    assert_int_equal(asdic_file_read(NULL, path, 1 << 20, &data, size), ASDIC_OK);
    return data;
}

/* What STRUCT_OF of TABLE holds, a line per key, so that two readings can be compared. */
static void dump(const asdic_table *table, const void *struct_of, asdic_text *text) {
    const char *base = struct_of;
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        const void *at = base + key->offset;
        asdic_text_format(text, "%s:", key->name);
        if (key->type == ASDIC_KEY_LIST) {
            const asdic_list *list = at;
            for (size_t k = 0; k < list->count; k++) {
                dump(key->table, (const char *)list->items + k * key->table->size, text);
            }
        } else if (key->type == ASDIC_KEY_POINTS) {
            const asdic_list *points = at;
            for (size_t k = 0; k < 3 * points->count; k++) {
                asdic_text_format(text, " %.17g", ((const double *)points->items)[k]);
            }
        } else if (key->type == ASDIC_KEY_MAP) {
            dump(key->table, at, text);
        } else if (key->type == ASDIC_KEY_NUMBER || key->type == ASDIC_KEY_NUMBERS) {
            for (size_t k = 0; k < (key->count ? key->count : 1); k++) {
                asdic_text_format(text, " %.17g", ((const double *)at)[k]);
            }
        } else if (key->type == ASDIC_KEY_INTEGER) {
            asdic_text_format(text, " %lld", (long long)*(const int64_t *)at);
        } else if (key->type == ASDIC_KEY_NAME || key->type == ASDIC_KEY_PATH) {
            const char *string = *(const char *const *)at;
            asdic_text_format(text, " %s", string ? string : "-");
        } else if (key->type == ASDIC_KEY_BOOL) {
            asdic_text_add(text, *(const bool *)at ? " true" : " false");
        } else {
            asdic_text_format(text, " %d", *(const int *)at);
        }
        asdic_text_add(text, "\n");
    }
}

/* The dump of the file NAME, which must be without errors. */
static char *dump_file(const char *name) {
    size_t size = 0;
    char *text = read_file(name, &size);
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(text, size, &arena, &file);
    assert_string_equal(errors, "");
    asdic_text out = {0};
    dump(asdic_scene_table(), &file, &out);
    free(errors);
    asdic_arena_finish(&arena);
    free(text);
    return asdic_text_take(&out);
}

static void materials_have_names(void **state) {
    (void)state;
    char *text = edited(MINIMAL, "mission:",
                        "objects:\n"
                        "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: {preset: "
                        "concrete, slope_rms: 0}}\n"
                        "  - {point: -42.3, position_m: [1, 2, 3]}\n"
                        "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: brass}\n"
                        "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: gravel}\n"
                        "  - {sphere: {radius_m: 1}, position_m: [1, 2, 3], material: cobble}\n"
                        "mission:");
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(text, strlen(text), &arena, &file);
    assert_string_equal(errors, "");
    const file_object *objects = file.objects.items;
    asdic_material_file rows;
    asdic_material material = asdic_scene_file_material(&objects[0], &rows);
    char words[64];
    asdic_material_describe(&material, words, sizeof words);
    assert_string_equal(words, "concrete");
    assert_close(asdic_material_get(&material, "slope_rms"), 0.0, 0);
    static const char *const alone[] = {"brass", "gravel", "cobble"}; /* each another key's */
    for (size_t k = 0; k < 3; k++) {
        material = asdic_scene_file_material(&objects[2 + k], &rows);
        asdic_material_describe(&material, words, sizeof words);
        assert_string_equal(words, alone[k]);
    }
    assert_non_null(objects[1].point.node);
    assert_close(objects[1].point.target_strength_db, -42.3, 0);
    asdic_context *ctx = NULL;
    double impedance_mrayl = 0.0;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(asdic_material_find_impedance(ctx, "steel", &impedance_mrayl), ASDIC_OK);
    assert_close(impedance_mrayl, 47.0, 0);
    assert_int_equal(asdic_material_find_impedance(ctx, "unobtainium", &impedance_mrayl),
                     ASDIC_ERROR_ARGUMENT);
    assert_non_null(strstr(asdic_context_error(ctx), "concrete"));
    asdic_context_destroy(&ctx);
    free(errors);
    asdic_arena_finish(&arena);
    free(text);
}

static void example_means_what_it_says(void **state) {
    (void)state;
    size_t size = 0;
    char *text = read_file("example.yaml", &size);
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(text, size, &arena, &file);
    assert_string_equal(errors, "");
    asdic_environment env = asdic_scene_file_environment(&file);
    assert_close(env.sound_speed_mps, 1490.102, 0);
    assert_close(env.max_depth_m, 12, 0);
    assert_close(env.particle_strength_db, -90, 0);
    assert_close(file.bottom.depth_m, 12, 0);
    asdic_material_file rows;
    asdic_material sand = asdic_scene_file_bottom(&file, &rows);
    assert_close(asdic_material_get(&sand, "type"), 2, 0);
    assert_int_equal(file.objects.count, 1);
    const file_object *rise = file.objects.items;
    assert_string_equal(rise->name, "rise");
    assert_close(rise->box.size_m[1], 200, 0);
    assert_close(rise->position_m[0], 55, 0);
    asdic_material material = asdic_scene_file_material(rise, &rows);
    assert_ptr_equal(material.law, asdic_law_find("rough-facet"));
    assert_close(asdic_material_get(&material, "impedance_mrayl"), 45, 0);
    assert_close_relative(asdic_material_get(&material, "roughness_rms_mm"), 1, 1e-15);
    assert_close(asdic_material_get(&material, "slope_rms"), 0.1, 0);
    assert_true(isnan(asdic_material_get(&material, "coherent_area_m2")));
    asdic_sonar sonar = asdic_scene_file_sonar(&file);
    assert_close(sonar.frequency_hz, 1e5, 0);
    assert_close(sonar.bandwidth_hz, 1e4, 0);
    assert_int_equal(sonar.receiver_count, 1);
    assert_int_equal(sonar.array.elements, 0);
    asdic_beam beam;
    asdic_scene_file_receivers(&file, &beam);
    assert_string_equal(beam.name, "forward");
    assert_close(asdic_scene_file_pose(&file).position_m.z, 7, 0);
    assert_int_equal(file.mission.pings, 1);
    assert_int_equal(file.sampling.multipath, ASDIC_MULTIPATH_FIRST);
    assert_close(file.detector.pfa, 1e-3, 0);
    assert_false(file.output.formats[ASDIC_FORMAT_netcdf]);
    free(errors);
    asdic_arena_finish(&arena);
    free(text);
}

/* Every format of the list is a key of `output`, off unless it is asked for, and its own bit. */
static void formats_are_keys_of_output(void **state) {
    (void)state;
    size_t count = 0;
    for (; asdic_format_name(count); count++) {
        char scene[512];
        asdic_settings settings;
        asdic_context *ctx = NULL;
        assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
        snprintf(scene, sizeof scene,
                 "version: 1\nbottom: {none: true}\nmission: {pose: {position_m: [0, 0, 5]}}\n"
                 "sonar: {frequency_khz: 100, receivers: [{name: a}]}\noutput: {%s: true}\n",
                 asdic_format_name(count));
        assert_int_equal(asdic_settings_read(ctx, "scene", scene, &settings), ASDIC_OK);
        assert_int_equal(settings.output.formats, 1u << count);
        assert_int_equal(settings.output.csv, ASDIC_CSV_LONG);
        asdic_settings_finish(&settings);
        asdic_context_destroy(&ctx);
    }
    assert_int_equal(count, ASDIC_FORMAT_COUNT);
    assert_true(count >= 2);
    assert_string_equal(asdic_formats[ASDIC_FORMAT_npy]->file, "levels.npy");
}

static void a_scene_has_its_file_s_name(void **state) {
    (void)state;
    static const char *const names[][2] = {{"a/b.c/reef.yaml", "reef"},
                                           {"reef", "reef"},
                                           {"./a.b.yaml", "a.b"},
                                           {"-", "scene"},
                                           {"a/.hidden", ".hidden"},
                                           {"caf\xe9/b\xe9ton.yaml", "b_ton"},
                                           {"\xe6\x97\xa5\xe6\x97.yaml", "\xe6\x97\xa5__"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char *name = asdic_scene_name(names[i][0]);
        assert_string_equal(name, names[i][1]);
        free(name);
    }
    assert_null(asdic_scene_name(NULL));
}

static void json_is_read_as_yaml_is(void **state) {
    (void)state;
    char *yaml = dump_file("example.yaml"), *json = dump_file("example.json");
    assert_string_equal(yaml, json);
    free(yaml);
    free(json);
    /* Without blanks, as programs write it. */
    expect_errors("{\"version\":1,\"bottom\":{\"depth_m\":1.2e1},\"sonar\":{\"frequency_khz\":100,"
                  "\"receivers\":[{\"name\":\"a\",\"yaw_deg\":-5}]},\"mission\":{\"pose\":"
                  "{\"position_m\":[0,0,7]},\"track\":\"dir\\/a.csv\"}}",
                  "1:152: error: 'pose' and 'track' exclude each other; give only one of 'pose', "
                  "'track', 'waypoints'  [mission]\n");
}

static void fan_spreads_from_port_to_starboard(void **state) {
    (void)state;
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *text = edited(MINIMAL, "    - name: forward\n",
                        "    fan: {count: 4, sector_deg: 120, yaw_deg: 10, pitch_deg: 5, "
                        "shape: cone, length_h_m: 0.2}\n");
    char *errors = read_errors(text, strlen(text), &arena, &file);
    assert_string_equal(errors, "");
    assert_int_equal(asdic_scene_file_sonar(&file).receiver_count, 4);
    asdic_beam beams[4];
    asdic_scene_file_receivers(&file, beams);
    const double yaw_deg[] = {-35, -5, 25, 55};
    const char *names[] = {"000", "001", "002", "003"};
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(beams[i].name, names[i]);
        assert_close(beams[i].yaw_rad, yaw_deg[i] * 3.14159265358979323846 / 180, 1e-15);
        assert_close(beams[i].pitch_rad, 5 * 3.14159265358979323846 / 180, 1e-15);
        assert_close(beams[i].length_h_m, 0.2, 0);
        assert_close(beams[i].length_v_m, 0.05, 0);
    }
    free(errors);
    free(text);
    asdic_arena_finish(&arena);
}

/* A pitched array: its beams lie in one plane, so that those at the sides look down less. */
static void check_plane(double yaw_deg) {
    enum { COUNT = 5 };
    asdic_arena arena = {0};
    asdic_scene_file file;
    char fan[128];
    snprintf(fan, sizeof fan, "    fan: {count: 5, sector_deg: 150, yaw_deg: %g, pitch_deg: 10}\n",
             yaw_deg);
    char *text = edited(MINIMAL, "    - name: forward\n", fan);
    char *errors = read_errors(text, strlen(text), &arena, &file);
    assert_string_equal(errors, "");
    asdic_beam beams[COUNT];
    asdic_scene_file_receivers(&file, beams);
    const asdic_pose level = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    const double degree = 3.14159265358979323846 / 180, yaw = yaw_deg * degree, pitch = 10 * degree;
    for (size_t i = 0; i < COUNT; i++) {
        double bearing = (-60.0 + 30.0 * (double)i) * degree;
        asdic_vec3 axis = asdic_beam_axis(&beams[i], &level);
        /* Ahead of the array cos(bearing), turned down by its pitch; aside sin(bearing). */
        double ahead = cos(bearing) * cos(pitch), aside = sin(bearing);
        assert_close(axis.x, ahead * cos(yaw) - aside * sin(yaw), 1e-12);
        assert_close(axis.y, ahead * sin(yaw) + aside * cos(yaw), 1e-12);
        assert_close(axis.z, cos(bearing) * sin(pitch), 1e-12);
        /* Bearings rise through 180 degrees, so that pictures know a fan. */
        assert_true(i == 0 || beams[i].yaw_rad > beams[i - 1].yaw_rad);
    }
    assert_close(asin(asdic_beam_axis(&beams[0], &level).z) / degree, 4.98, 0.01);
    free(errors);
    free(text);
    asdic_arena_finish(&arena);
}

static void fan_of_an_array_lies_in_its_plane(void **state) {
    (void)state;
    check_plane(20.0);
    check_plane(180.0);
    check_plane(-130.0);
}

/* Intensities know an array's beams as even apertures that take in as much from all around: of equal weights its
 * whole length, of Hann's, whose squares add up to 1.5 over their number, two thirds of it, as seen from aside. */
static void beams_of_an_array_are_even_apertures(void **state) {
    (void)state;
    for (int elements = 16; elements <= 45; elements += 29) {
        for (int hann = 0; hann < 2; hann++) {
            asdic_arena arena = {0};
            asdic_scene_file file;
            char array[128];
            snprintf(array, sizeof array,
                     "  array: {elements: %d, spacing_wl: 0.4, shading: %s, beams: {count: 3, "
                     "sector_deg: 90}}\n",
                     elements, hann ? "hann" : "none");
            char *text = edited(MINIMAL, "  receivers:\n    - name: forward\n", array);
            char *errors = read_errors(text, strlen(text), &arena, &file);
            assert_string_equal(errors, "");
            asdic_beam beams[3];
            asdic_scene_file_receivers(&file, beams);
            double spacing_m = asdic_scene_file_sonar(&file).array.spacing_m;
            assert_close(spacing_m, 0.4 * 0.01495, 1e-4);
            for (size_t i = 0; i < 3; i++) {
                double aside = i == 1 ? 1.0 : sqrt(0.75); /* the cosine of 30 degrees */
                double whole_m = elements * spacing_m / (hann ? 1.5 : 1.0);
                assert_close(beams[i].length_h_m, whole_m * aside, 1e-12);
            }
            free(errors);
            free(text);
            asdic_arena_finish(&arena);
        }
    }
}

static void decimal_comma_locale_changes_nothing(void **state) {
    (void)state;
    char *before = dump_file("example.yaml");
    if (!set_german_locale()) {
        free(before);
        skip();
    }
    char comma[16];
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_string_equal(comma, "0,5");
    /* As asdic_mission_load does, so that messages have points too. */
    locale_t caller = asdic_c_locale_enter();
    char *after = dump_file("example.yaml");
    expect_edit("100\n", "0.05\n",
                "4:18: error: 'frequency_khz' = 0.05 is out of range [0.1, 3000] kHz  "
                "[sonar.frequency_khz]\n");
    asdic_c_locale_leave(caller);
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    assert_string_equal(comma, "0,5");
    setlocale(LC_ALL, "C");
    assert_string_equal(before, after);
    free(before);
    free(after);
}

static void damaged_files_are_answered(void **state) {
    (void)state;
    const char *names[] = {"example.yaml", "example.json"};
    size_t good = 0, bad = 0;
    for (size_t f = 0; f < 2; f++) {
        size_t size = 0;
        uint32_t random = 2463534242u;
        char *text = read_file(names[f], &size);
        char *copy = malloc(2 * size + 512);
        assert_non_null(copy);
        for (int i = 0; i < 2500; i++) {
            asdic_arena arena = {0};
            asdic_scene_file file;
            size_t damaged = damage(text, size, &random, copy);
            char *errors = read_errors(copy, damaged, &arena, &file);
            good += *errors == '\0';
            bad += *errors != '\0';
            free(errors);
            asdic_arena_finish(&arena);
        }
        free(copy);
        free(text);
    }
    assert_true(good > 100); /* damage in comments and numbers */
    assert_true(bad > 2500);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(materials_have_names),
        cmocka_unit_test(example_means_what_it_says),
        cmocka_unit_test(formats_are_keys_of_output),
        cmocka_unit_test(a_scene_has_its_file_s_name),
        cmocka_unit_test(json_is_read_as_yaml_is),
        cmocka_unit_test(fan_spreads_from_port_to_starboard),
        cmocka_unit_test(fan_of_an_array_lies_in_its_plane),
        cmocka_unit_test(beams_of_an_array_are_even_apertures),
        cmocka_unit_test(decimal_comma_locale_changes_nothing),
        cmocka_unit_test(damaged_files_are_answered),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
