/*
 * Every row of the table of keys, taken from the table itself: what lies at its bounds is accepted,
 * what lies beyond is refused, its default is what the library's defaults say, and the schema says
 * the same.
 */
#include "scene_text.h"

#include "base/number.h"

#include <float.h>

static void write_table(asdic_text *text, const asdic_table *table, const asdic_key *chosen,
                        const char *value);

/* Some value that KEY accepts. */
static void write_value(asdic_text *text, const asdic_key *key) {
    switch (key->type) {
    case ASDIC_KEY_NUMBER:
    case ASDIC_KEY_INTEGER:
        asdic_text_format(text, "%.15g", key->min);
        break;
    case ASDIC_KEY_NUMBERS:
        for (size_t i = 0; i < key->count; i++) {
            asdic_text_format(text, "%s%.15g", i ? ", " : "[", key->max);
        }
        asdic_text_add(text, "]");
        break;
    case ASDIC_KEY_POINTS:
        asdic_text_add(text, "[[1, 2, 3], [4, 5, 6]]");
        break;
    case ASDIC_KEY_CURVE:
        asdic_text_add(text, "[[1, 1400], [2, 1401]]");
        break;
    case ASDIC_KEY_NODE:
        asdic_text_add(text, "[a]");
        break;
    case ASDIC_KEY_BOOL:
        asdic_text_add(text, "false");
        break;
    case ASDIC_KEY_WORD:
        asdic_text_add(text, key->words[0].name);
        break;
    case ASDIC_KEY_WORDS:
        asdic_text_format(text, "[%s]", key->words[0].name);
        break;
    case ASDIC_KEY_NAME:
    case ASDIC_KEY_PATH:
        asdic_text_add(text, "a");
        break;
    case ASDIC_KEY_MAP:
        write_table(text, key->table, NULL, NULL);
        break;
    case ASDIC_KEY_LIST:
        asdic_text_add(text, "[");
        write_table(text, key->table, NULL, NULL);
        asdic_text_add(text, "]");
        break;
    }
}

/* A map of TABLE with what it needs, and with CHOSEN = VALUE. */
static void write_table(asdic_text *text, const asdic_table *table, const asdic_key *chosen,
                        const char *value) {
    bool has_one = chosen && (chosen->flags & ASDIC_KEY_ONE_OF);
    const char *comma = "{";
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        bool one = (key->flags & ASDIC_KEY_ONE_OF) && !has_one;
        if (key == chosen || (!(key->flags & ASDIC_KEY_REQUIRED) && !one)) {
            continue;
        }
        has_one |= one;
        asdic_text_format(text, "%s%s: ", comma, key->name);
        write_value(text, key);
        comma = ", ";
    }
    if (chosen) {
        asdic_text_format(text, "%s%s: %s", comma, chosen->name, value);
        comma = ", ";
    }
    asdic_text_add(text, *comma == '{' ? "{}" : "}");
}

/* Errors of TABLE alone, read from a map with CHOSEN = VALUE; freed by the caller. */
static char *errors_with(const asdic_table *table, const asdic_key *chosen, const char *value) {
    asdic_arena arena = {0};
    asdic_problems problems = {.name = "t"};
    asdic_text text = {0}, all = {0};
    asdic_yaml_node *root = NULL;
    write_table(&text, table, chosen, value);
    assert_true(asdic_yaml_read(text.data, text.length, &arena, &problems, &root));
    void *out = asdic_arena_alloc(&arena, table->size);
    asdic_schema_read(table, table, root, &arena, &problems, out);
    asdic_text_add(&all, "");
    for (size_t i = 0; i < problems.count; i++) {
        asdic_text_format(&all, "%s\n", problems.items[i].message);
    }
    if (problems.count > 1) {
        print_error("%s\n%s", text.data, all.data);
    }
    asdic_text_finish(&text);
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    return asdic_text_take(&all);
}

static void check_value(const asdic_table *table, const asdic_key *key, double value, bool good) {
    char number[64];
    asdic_text text = {0};
    snprintf(number, sizeof number, "%.17g", value);
    if (key->type == ASDIC_KEY_NUMBERS) {
        for (size_t i = 0; i < key->count; i++) { /* the last one is tried */
            asdic_text_format(&text, "%s%s", i ? ", " : "[", i + 1 < key->count ? "1" : number);
        }
        asdic_text_add(&text, "]");
    } else if (key->type == ASDIC_KEY_POINTS) {
        asdic_text_format(&text, "[[1, 1, 1], [1, %s, 1]]", number);
    } else {
        asdic_text_add(&text, number);
    }
    char *errors = errors_with(table, key, text.data);
    char expected[160];
    snprintf(expected, sizeof expected,
             key->max >= 1e15 ? "'%s' = %s is out of range [%.0f, %.0f]%s%s  ["
                              : "'%s' = %s is out of range [%.15g, %.15g]%s%s  [",
             key->name, number, key->min, key->max, key->unit ? " " : "",
             key->unit ? key->unit : "");
    if (good ? *errors != '\0' : strncmp(errors, expected, strlen(expected)) != 0) {
        print_error("%s = %s: %s\n", key->name, text.data, errors);
        fail();
    }
    free(errors);
    asdic_text_finish(&text);
}

static size_t check_bounds(const asdic_table *table) {
    size_t rows = 0;
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        bool number = key->type == ASDIC_KEY_NUMBER || key->type == ASDIC_KEY_NUMBERS ||
                      key->type == ASDIC_KEY_POINTS;
        if (key->table) {
            rows += check_bounds(key->table);
        }
        if (key->map_form) {
            rows += check_bounds(key->map_form);
        }
        if (!number && key->type != ASDIC_KEY_INTEGER) {
            continue;
        }
        assert_true(key->min <= key->max);
        check_value(table, key, key->min, true);
        check_value(table, key, key->max, true);
        check_value(table, key, number ? nextafter(key->min, -DBL_MAX) : key->min - 1, false);
        if (key->max < 9007199254740992.0) {
            check_value(table, key, number ? nextafter(key->max, DBL_MAX) : key->max + 1, false);
        }
        rows++;
    }
    return rows;
}

static void bounds_are_where_the_table_says(void **state) {
    (void)state;
    assert_true(check_bounds(asdic_scene_table()) >= 50);
}

/* Every row says what it is, and can be what it says. */
static void check_rows(const asdic_table *table) {
    assert_non_null(table->doc);
    for (size_t i = 0; i < table->key_count; i++) {
        const asdic_key *key = &table->keys[i];
        assert_non_null(key->doc);
        for (size_t j = 0; j < i; j++) {
            assert_string_not_equal(key->name, table->keys[j].name);
        }
        bool worded = key->type == ASDIC_KEY_WORD || key->type == ASDIC_KEY_WORDS;
        assert_true(!worded || key->words);
        assert_false((key->flags & ASDIC_KEY_REQUIRED) && key->fallback);
        assert_true(key->offset < table->size);
        for (const asdic_word *word = key->words; word && word->name; word++) {
            asdic_text list = {0};
            asdic_text_format(&list, key->type == ASDIC_KEY_WORDS ? "[%s]" : "%s", word->name);
            char *errors = errors_with(table, key, list.data);
            assert_string_equal(errors, "");
            free(errors);
            asdic_text_finish(&list);
        }
        if (key->fallback) {
            char *errors = errors_with(table, key, key->fallback);
            assert_string_equal(errors, "");
            free(errors);
        }
        if (key->table) {
            check_rows(key->table);
        }
        if (key->map_form) {
            check_rows(key->map_form);
        }
    }
}

static void rows_are_complete(void **state) {
    (void)state;
    check_rows(asdic_scene_table());
}

static void defaults_are_the_librarys(void **state) {
    (void)state;
    asdic_arena arena = {0};
    asdic_scene_file file;
    char *errors = read_errors(MINIMAL, strlen(MINIMAL), &arena, &file);
    assert_string_equal(errors, "");
    asdic_environment env = asdic_scene_file_environment(&file);
    asdic_environment env0 = asdic_environment_default();
    assert_close(env.temperature_degc, env0.temperature_degc, 0);
    assert_close(env.salinity_ppt, env0.salinity_ppt, 0);
    assert_close(env.ph, env0.ph, 0);
    assert_close(env.wind_speed_kn, env0.wind_speed_kn, 0);
    assert_close(env.shipping_density, env0.shipping_density, 0);
    assert_close(env.particle_strength_db, env0.particle_strength_db, 0);
    assert_true(isnan(env.sound_speed_mps) && isnan(env0.sound_speed_mps));
    assert_true(isnan(env.max_depth_m) && isnan(env0.max_depth_m));
    assert_int_equal(env.variant, env0.variant);
    asdic_sonar sonar = asdic_scene_file_sonar(&file);
    asdic_sonar sonar0 = asdic_sonar_default();
    assert_close(sonar.frequency_hz, sonar0.frequency_hz, 0);
    assert_close(sonar.bandwidth_hz, sonar0.bandwidth_hz, 0);
    assert_close(sonar.ping_rate_hz, sonar0.ping_rate_hz, 0);
    assert_true(isnan(sonar.max_range_m) && isnan(sonar0.max_range_m));
    assert_close(sonar.source_level_db, sonar0.source_level_db, 0);
    assert_close(sonar.bin_length_m, sonar0.bin_length_m, 0);
    assert_close(sonar.blanking_m, sonar0.blanking_m, 0);
    assert_close(sonar.transmitter.length_h_m, sonar0.transmitter.length_h_m, 0);
    assert_close(sonar.transmitter.length_v_m, sonar0.transmitter.length_v_m, 0);
    assert_close(sonar.transmitter.pitch_rad, 0, 0);
    assert_int_equal(sonar.noise_enabled, sonar0.noise_enabled);
    assert_int_equal(sonar.noise_directivity, sonar0.noise_directivity);
    assert_close(sonar.self_noise_db, sonar0.self_noise_db, 0);
    assert_int_equal(sonar.speckle, sonar0.speckle);
    assert_close(sonar.rear_floor_db, sonar0.rear_floor_db, 0);
    assert_int_equal(sonar.receiver_count, 1);
    assert_true(file.surface.enabled);
    asdic_material_file rows;
    asdic_material sand = asdic_scene_file_bottom(&file, &rows);
    assert_ptr_equal(sand.law, asdic_law_find("searay"));
    assert_true(isnan(asdic_material_get(&sand, "type"))); /* the law's own */
    assert_int_equal(file.sampling.rays, FILE_RAYS_AUTO);
    assert_int_equal(file.sampling.seed, 1);
    assert_int_equal(file.output.images, 31);
    free(errors);
    asdic_arena_finish(&arena);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bounds_are_where_the_table_says),
        cmocka_unit_test(rows_are_complete),
        cmocka_unit_test(defaults_are_the_librarys),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
