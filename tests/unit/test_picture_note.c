/*
 * The note below a run's pictures says how rough they are, where that is more than one may overlook.
 */
#include "asserts.h"

#include "mission/run/run_picture.h"

#include <math.h>
#include <string.h>

static void describe(double rms_db, asdic_render *r) {
    static asdic_run run;
    static asdic_summary summary;
    static asdic_sonar sonar;
    sonar = asdic_sonar_default();
    run.facts.version = "1";
    summary.statistics.stderr_rms_db = rms_db;
    *r = (asdic_render){.run = &run, .summary = &summary, .info.sonar = &sonar};
    r->info.sampling = asdic_sampling_default();
    asdic_render_describe(r);
}

static void rough_pictures_say_so(void **state) {
    (void)state;
    asdic_render r;
    describe(2.71, &r);
    assert_contains(r.note, "20,000 rays a ping");
    assert_contains(r.note, "stated error 2.7 dB r.m.s.");
    assert_true(strlen(r.note) + 1 < sizeof r.note);
}

static void fine_ones_say_nothing(void **state) {
    (void)state;
    const double fine_db[] = {0.0, 0.5, 1.0, NAN};
    for (size_t i = 0; i < sizeof fine_db / sizeof *fine_db; i++) {
        asdic_render r;
        describe(fine_db[i], &r);
        assert_null(strstr(r.note, "stated"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rough_pictures_say_so),
        cmocka_unit_test(fine_ones_say_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
