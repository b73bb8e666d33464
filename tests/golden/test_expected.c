/* The expected ping against values of an independent program, and against itself where geometry or
 * symmetry says what must come out. */
#include "asserts.h"

#include <asdic/asdic.h>

#include "flat_expected.h"

#define BINS 149
#define DEGREE (3.14159265358979323846 / 180.0)

/* The paper's first scenario. */
typedef struct setup {
    asdic_context *ctx;
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receiver;
    asdic_flat_scene flat;
    asdic_pose pose;
    asdic_ping *ping;
} setup;

static setup *begin(size_t bins) {
    static setup s;
    s = (setup){.env = asdic_environment_default(), .sonar = asdic_sonar_default()};
    s.env.max_depth_m = 12.0;
    s.sonar.noise_enabled = false;
    s.sonar.receiver_count = 1;
    s.sonar.receivers = &s.receiver;
    s.receiver = s.sonar.transmitter;
    s.flat = (asdic_flat_scene){true, true, 5.0, 7.0, 2.0};
    assert_int_equal(asdic_context_create(&s.ctx), ASDIC_OK);
    assert_ok(s.ctx, asdic_ping_create(s.ctx, 1, bins, &s.ping));
    return &s;
}

static void end(setup *s) {
    asdic_ping_destroy(&s->ping);
    asdic_context_destroy(&s->ctx);
}

static void compute(setup *s) {
    assert_ok(s->ctx,
              asdic_expected_compute(s->ctx, &s->flat, &s->env, &s->sonar, &s->pose, s->ping));
}

static double level(const setup *s, asdic_component c, size_t bin) {
    return asdic_level_db(s->ping->intensity_lin[c][bin]);
}

static void scenario_1_meets_independent_values(void **state) {
    (void)state;
    static const asdic_component component[4] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                 ASDIC_VOLUME};
    setup *s = begin(BINS);
    double worst = 0.0;
    compute(s);
    for (size_t n = 0; n < BINS; n++) {
        for (int c = 0; c < 4; c++) {
            double expected = flat_expected_db[n][c];
            if (isnan(expected)) {
                assert_true(s->ping->intensity_lin[component[c]][n] == 0.0);
            } else {
                assert_close(level(s, component[c], n), expected, 1e-6);
                worst = fmax(worst, fabs(level(s, component[c], n) - expected));
            }
        }
    }
    print_message("worst of 149 bins x 4: %.2g dB\n", worst);
    end(s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenario_1_meets_independent_values),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
