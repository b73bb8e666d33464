/*
 * Noise in a bin by hand. At 1 MHz in a calm sea without ships nothing but the water's own heat counts:
 * -15 + 20 log f_kHz = 45 dB re 1 uPa^2 / Hz; the sea's 50 + 20 log f_kHz - 40 log(f_kHz + 0.4) is 55 dB below.
 */
#include "asserts.h"
#include "test_context.h"

#include "sim/noise_level.h"

#include <asdic/ping.h>

#define PI 3.14159265358979323846
#define SPEED_MPS 1500.0 /* a wavelength of 1.5 mm */
#define BANDWIDTH_HZ 1e4 /* cells of 75 mm */

static asdic_environment calm(void) {
    asdic_environment env = asdic_environment_default();
    env.wind_speed_kn = env.shipping_density = 0.0;
    return env;
}

/* A beam of so many wavelengths, which hears DIRECTIVITY times less than all round. */
static const struct {
    double across, up, directivity;
} beams[] = {{0.1, 0.1, 2.0},    /* of an open half-space */
             {0.1, 1.0, 4.0},    /* the integral over its pattern: 4.50 */
             {20.0, 0.05, 80.0}, /* the integral: 80.7 */
             {20.0, 2.0, 160.0 * PI}, {10.0, 5.0, 200.0 * PI},
             {20.0, 9.0, 720.0 * PI}}; /* not the sonar's */
#define BEAMS (sizeof beams / sizeof *beams - 1)

static asdic_sonar sonar_of(asdic_beam receivers[BEAMS + 1]) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.frequency_hz = 1e6;
    sonar.bandwidth_hz = BANDWIDTH_HZ;
    sonar.bin_length_m = 0.075;
    sonar.noise_enabled = sonar.noise_directivity = true;
    for (size_t b = 0; b <= BEAMS; b++) {
        receivers[b] = sonar.transmitter;
        receivers[b].length_h_m = 1.5e-3 * beams[b].across;
        receivers[b].length_v_m = 1.5e-3 * beams[b].up;
    }
    sonar.receivers = receivers;
    sonar.receiver_count = BEAMS;
    return sonar;
}

static void levels_are_as_by_hand(void **state) {
    (void)state;
    /* A bin is of as many cells as it holds, and of a part of one, as its echo is. */
    static const double bins[][2] = {{0.075, 1.0}, {0.3, 4.0}, {0.09, 1.2}, {0.03, 0.4}};
    const double band = pow(10.0, 4.5) * BANDWIDTH_HZ;
    asdic_beam receivers[BEAMS + 1];
    const asdic_environment env = calm();
    for (size_t i = 0; i < sizeof bins / sizeof *bins; i++) {
        asdic_sonar sonar = sonar_of(receivers);
        sonar.bin_length_m = bins[i][0];
        const double all_round = band * bins[i][1];
        for (size_t b = 0; b < BEAMS; b++) {
            sonar.noise_directivity = true;
            assert_close_relative(asdic_noise_lin(&env, &sonar, &receivers[b], SPEED_MPS),
                                  all_round / beams[b].directivity, 1e-5);
            sonar.noise_directivity = false;
            assert_close_relative(asdic_noise_lin(&env, &sonar, &receivers[b], SPEED_MPS),
                                  all_round, 1e-5);
        }
        sonar.noise_directivity = true;
        assert_close_relative(asdic_noise_least_lin(&env, &sonar, SPEED_MPS),
                              all_round / beams[BEAMS - 1].directivity, 1e-5);
        sonar.noise_enabled = false;
        assert_true(asdic_noise_least_lin(&env, &sonar, SPEED_MPS) == 0.0);
    }
}

/* 50 dB re 1 uPa^2 / Hz besides, from wherever beams look; of the 16 elements of a beam a sixteenth. */
static void the_sonars_own_noise_comes_from_nowhere(void **state) {
    (void)state;
    asdic_beam receivers[BEAMS + 1];
    const asdic_environment env = calm();
    asdic_sonar sonar = sonar_of(receivers);
    for (int k = 0; k < 4; k++) {
        sonar.noise_directivity = k % 2;
        sonar.array.elements = k / 2 ? 16 : 0;
        for (size_t b = 0; b < BEAMS; b++) {
            sonar.self_noise_db = -INFINITY;
            sonar.array.spacing_m = receivers[b].length_h_m / 16.0;
            double ambient = asdic_noise_lin(&env, &sonar, &receivers[b], SPEED_MPS);
            sonar.self_noise_db = 50.0;
            double all = asdic_noise_lin(&env, &sonar, &receivers[b], SPEED_MPS);
            assert_close_relative(all - ambient, 1e5 * BANDWIDTH_HZ / (k / 2 ? 16.0 : 1.0), 1e-9);
        }
    }
    sonar.noise_enabled = false;
    assert_true(asdic_noise_least_lin(&env, &sonar, SPEED_MPS) == 0.0);
}

static void every_bin_of_a_beam_has_its_noise(void **state) {
    (void)state;
    enum { BINS = 5 };
    asdic_beam receivers[BEAMS + 1];
    const asdic_environment env = calm();
    const asdic_sonar sonar = sonar_of(receivers);
    asdic_ping *ping = NULL;
    assert_ok(ctx, asdic_ping_create(ctx, BEAMS, BINS, &ping));
    asdic_noise_levels(&env, &sonar, SPEED_MPS, ping);
    for (size_t i = 0; i < BEAMS * BINS; i++) {
        assert_true(ping->intensity_lin[ASDIC_NOISE][i] ==
                    asdic_noise_lin(&env, &sonar, &receivers[i / BINS], SPEED_MPS));
    }
    asdic_ping_destroy(&ping);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(levels_are_as_by_hand),
        cmocka_unit_test(the_sonars_own_noise_comes_from_nowhere),
        cmocka_unit_test(every_bin_of_a_beam_has_its_noise),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
