#include "asserts.h"

#include "base/words.h"

#include <locale.h>

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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(number_reads_whole_finite_words),
        cmocka_unit_test(number_ignores_the_locale),
        cmocka_unit_test(nearest_finds_slips_only),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
