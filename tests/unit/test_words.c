#include "asserts.h"

#include "base/words.h"

#include <locale.h>
#include <string.h>

static void number_reads_whole_finite_words(void **state) {
    (void)state;
    double x = 0.0;
    assert_true(asdic_words_number("-1.5e3", &x));
    assert_close(x, -1500.0, 0.0);
    const char *wrong[] = {"", " 1", "1 ", "1,5", "1x", "nan", "inf", "1e999", "."};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        assert_false(asdic_words_number(wrong[i], &x));
    }
    assert_close(x, -1500.0, 0.0);
}

static void number_ignores_the_locale(void **state) {
    (void)state;
    if (!setlocale(LC_NUMERIC, "de_DE.UTF-8") && !setlocale(LC_NUMERIC, "fr_FR.UTF-8")) {
        skip();
    }
    double x = 0.0;
    assert_true(asdic_words_number("0.25", &x));
    setlocale(LC_NUMERIC, "C");
    assert_close(x, 0.25, 0.0);
}

static void nearest_finds_slips_only(void **state) {
    (void)state;
    const char *names[] = {"salinity_ppt", "temperature_degc", "ph", "wind_speed_kn"};
    assert_int_equal(asdic_words_nearest("salnity_ppt", names, 4), 0);
    assert_int_equal(asdic_words_nearest("temprature_degc", names, 4), 1);
    assert_int_equal(asdic_words_nearest("wind_sped_kn", names, 4), 3);
    assert_int_equal(asdic_words_nearest("widn_speed_kn", names, 4), 3);
    assert_int_equal(asdic_words_nearest("altitude_m", names, 4), 4);
    assert_int_equal(asdic_words_nearest("", names, 4), 4);
    assert_int_equal(asdic_words_nearest("x", names, 0), 0);
}

/* Words of 64 letters are the longest that are compared. */
static void nearest_takes_long_words(void **state) {
    (void)state;
    char right[65] = "", slip[66] = "", longer[66] = "";
    for (size_t i = 0; i < 65; i++) {
        longer[i] = (char)('a' + i * 7 % 26);
    }
    memcpy(right, longer, 64);
    memcpy(slip, right, 65);
    for (size_t i = 0; i < 21; i++) {
        slip[3 * i] = '_';
    }
    const char *names[] = {"salinity_ppt", right};
    assert_int_equal(asdic_words_nearest(slip, names, 2), 1);
    assert_int_equal(asdic_words_nearest(longer, names, 2), 2);
    slip[1] = '_'; /* 22 of 64 are more than a third */
    assert_int_equal(asdic_words_nearest(slip, names, 2), 2);
    names[1] = longer;
    assert_int_equal(asdic_words_nearest(right, names, 2), 2);
}

/* A third of the letters may be wrong, in the longer of the two words; capitals are letters. */
static void nearest_counts_edits(void **state) {
    (void)state;
    static const struct {
        const char *text, *name;
        bool is_near;
    } words[] = {
        {"abcdef", "abcdef", true},   {"abcxyf", "abcdef", true},
        {"abxxxf", "abcdef", false},  {"ABCDEF", "abcdef", true},
        {"abdcef", "abcdef", true},   {"badcef", "abcdef", true},
        {"badcfe", "abcdef", false},  {"abcdefxy", "abcdef", true},
        {"abcd", "abcdef", true},     {"abc", "abcdef", false},
        {"xyabcdef", "abcdef", true}, {"ab", "a", false},
        {"abc", "ab", true},          {"a", "b", false},
    };
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        size_t found = asdic_words_nearest(words[i].text, &words[i].name, 1);
        if (found != !words[i].is_near) {
            print_message("'%s' and '%s'\n", words[i].text, words[i].name);
        }
        assert_int_equal(found, !words[i].is_near);
    }
    /* The nearest, and of equals the first. */
    const char *names[] = {"abcxyz", "abcdez", "abcdxf"};
    assert_int_equal(asdic_words_nearest("abcdef", names, 3), 1);
}

static void cut_ends_with_a_character(void **state) {
    (void)state;
    assert_int_equal(asdic_words_cut("reef", 4, 4), 4);
    assert_int_equal(asdic_words_cut("reef", 4, 3), 3);
    assert_int_equal(asdic_words_cut("", 0, 3), 0);
    assert_int_equal(asdic_words_cut("a\u00e4b", 4, 1), 1);
    assert_int_equal(asdic_words_cut("a\u00e4b", 4, 2), 1); /* half of the second */
    assert_int_equal(asdic_words_cut("a\u00e4b", 4, 3), 3);
    assert_int_equal(asdic_words_cut("\U0001d11e", 4, 3), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cut_ends_with_a_character),
        cmocka_unit_test(number_reads_whole_finite_words),
        cmocka_unit_test(number_ignores_the_locale),
        cmocka_unit_test(nearest_finds_slips_only),
        cmocka_unit_test(nearest_takes_long_words),
        cmocka_unit_test(nearest_counts_edits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
