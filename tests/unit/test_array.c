/*
 * Beams of an array as pings of intensities know them, against sums over its elements: main lobes of the same height
 * and width wherever they are steered, and the noise of as many elements as take it in.
 */
#include "asserts.h"

#include "sim/array.h"
#include "sim/noise_level.h"
#include "sim/ring.h"

#include <complex.h>

#define PI 3.14159265358979323846
#define WAVELENGTH_M 0.015
#define SPEED_MPS 1500.0

static const struct {
    size_t elements;
    double spacing_wl, element_wl;
    asdic_shading shading;
    double yaw_rad, pitch_rad;
} arrays[] = {
    {64, 0.5, 0.5, ASDIC_SHADING_NONE, 0.0, 0.0},
    {64, 0.5, 0.03, ASDIC_SHADING_NONE, 0.3, 0.0},
    {33, 0.5, 0.5, ASDIC_SHADING_HANN, 0.0, 0.2},
    {20, 0.37, 0.3, ASDIC_SHADING_NONE, 0.0, 0.0},
    {48, 0.45, 0.45, ASDIC_SHADING_TAYLOR, -1.0, 0.0},
};
#define ARRAYS (sizeof arrays / sizeof *arrays)

static asdic_array array_of(size_t i) {
    return (asdic_array){.elements = arrays[i].elements,
                         .spacing_m = arrays[i].spacing_wl * WAVELENGTH_M,
                         .shading = arrays[i].shading,
                         .side_lobe_db = -30.0,
                         .element = {.yaw_rad = arrays[i].yaw_rad,
                                     .pitch_rad = arrays[i].pitch_rad,
                                     .length_h_m = arrays[i].element_wl * WAVELENGTH_M,
                                     .length_v_m = 0.04}};
}

/* In the array's plane, TO_RAD from its front, of a beam that is steered STEER_RAD from it. */
static double heard_lin(const asdic_array *array, double steer_rad, double to_rad) {
    double weights[ASDIC_ARRAY_MAX_ELEMENTS];
    asdic_array_weights(array, weights);
    double turn = 2.0 * PI * array->spacing_m / WAVELENGTH_M * (sin(to_rad) - sin(steer_rad));
    double complex sum = 0.0;
    for (size_t e = 0; e < array->elements; e++) {
        sum += weights[e] * cexp(I * turn * (double)e);
    }
    double x = PI * array->element.length_h_m / WAVELENGTH_M * sin(to_rad);
    double element = x == 0.0 ? 1.0 : sin(x) / x;
    return creal(sum * conj(sum)) * element * element;
}

/* An untilted array's beam. */
static asdic_beam beam_at(const asdic_array *array, double steer_rad) {
    asdic_beam beam = {.yaw_rad = array->element.yaw_rad + steer_rad};
    asdic_array_form(array, WAVELENGTH_M, &beam, 1);
    return beam;
}

static void beams_are_as_high_and_wide_as_sums_over_elements(void **state) {
    (void)state;
    for (size_t i = 0; i < ARRAYS; i++) {
        asdic_array array = array_of(i);
        array.element.pitch_rad = 0.0;
        for (int steer_deg = -60; steer_deg <= 60; steer_deg += 20) {
            double steer_rad = steer_deg * (PI / 180.0), sum = 0.0, beams_sum = 0.0;
            asdic_beam beam = beam_at(&array, steer_rad);
            asdic_face face = asdic_face_aim(&beam, &(asdic_pose){0}, WAVELENGTH_M);
            double most = heard_lin(&array, steer_rad, steer_rad);
            assert_close(beam.sensitivity_db, 10.0 * log10(most), 1e-9);
            for (double to_rad = -0.5 * PI + 5e-5; to_rad < 0.5 * PI; to_rad += 1e-4) {
                double bearing_rad = array.element.yaw_rad + to_rad;
                asdic_vec3 towards = {cos(bearing_rad), sin(bearing_rad), 0.0};
                sum += heard_lin(&array, steer_rad, to_rad);
                beams_sum += asdic_face_gain(&face, towards, 0.0);
            }
            assert_close(10.0 * log10(beams_sum / sum), 0.0, 0.35);
        }
    }
}

static void tilted_arrays_are_steered_in_their_plane(void **state) {
    (void)state;
    asdic_array array = array_of(2), level = array;
    level.element.pitch_rad = 0.0;
    asdic_mat3 front = asdic_face_mount(&array.element);
    for (int steer_deg = -60; steer_deg <= 60; steer_deg += 30) {
        double s = sin(steer_deg * (PI / 180.0)), c = cos(steer_deg * (PI / 180.0));
        double x = front.m[0][0] * c + front.m[0][1] * s, y = front.m[1][0] * c + front.m[1][1] * s;
        asdic_beam beam = {.yaw_rad = atan2(y, x),
                           .pitch_rad = asin(front.m[2][0] * c + front.m[2][1] * s)};
        asdic_beam beside = beam_at(&level, steer_deg * (PI / 180.0));
        asdic_array_form(&array, WAVELENGTH_M, &beam, 1);
        assert_close(beam.length_h_m, beside.length_h_m, 1e-12);
        assert_close(beam.sensitivity_db, beside.sensitivity_db, 1e-9);
    }
}

/* Elements of two wavelengths, as far apart, hear nothing at 30 degrees: a beam is formed there all the same. */
static void beams_at_an_elements_null_are_silent(void **state) {
    (void)state;
    asdic_array array = array_of(0);
    array.spacing_m = array.element.length_h_m = 2.0 * WAVELENGTH_M;
    asdic_beam beam = beam_at(&array, PI / 6.0);
    asdic_sonar sonar = asdic_sonar_default();
    sonar.receivers = &beam;
    sonar.receiver_count = 1;
    assert_true(beam.sensitivity_db < -250.0);
    assert_int_equal(asdic_sonar_check(NULL, &sonar), ASDIC_OK);
}

/* A level of 50 dB re 1 uPa^2/Hz at SPEED_MPS, in bins of one cell. */
static asdic_sonar sonar_of(const asdic_array *array) {
    asdic_sonar sonar = asdic_sonar_default();
    sonar.frequency_hz = SPEED_MPS / WAVELENGTH_M;
    sonar.bin_length_m = SPEED_MPS / (2.0 * sonar.bandwidth_hz);
    sonar.array = *array;
    return sonar;
}

static void beams_take_in_what_their_elements_do(void **state) {
    (void)state;
    const asdic_environment env = asdic_environment_default();
    for (size_t i = 0; i < ARRAYS; i++) {
        asdic_array array = array_of(i);
        double weights[ASDIC_ARRAY_MAX_ELEMENTS], share = 0.0;
        asdic_array_weights(&array, weights);
        for (size_t e = 0; e < array.elements; e++) {
            share += weights[e] * weights[e];
        }
        for (int k = 0; k < 8; k++) {
            asdic_sonar sonar = sonar_of(&array);
            sonar.self_noise_db = k & 1 ? 40.0 : -INFINITY;
            sonar.noise_directivity = k & 2;
            double element = asdic_noise_element_lin(&env, &sonar, share, SPEED_MPS);
            array.element.pitch_rad = 0.0;
            asdic_beam beam = beam_at(&array, k & 4 ? 0.9 : 0.0);
            sonar.array = array;
            assert_close_relative(asdic_noise_lin(&env, &sonar, &beam, SPEED_MPS), share * element,
                                  1e-9);
        }
    }
}

/* Elements that leave gaps of less than half a wavelength hear the noise between them: together as much as an
 * aperture of their line takes in. Farther apart they hear apart. */
static void thin_elements_take_in_what_an_aperture_does(void **state) {
    (void)state;
    const asdic_environment env = asdic_environment_default();
    static const struct {
        double spacing_wl, element_wl, aperture_wl;
    } cases[] = {{0.5, 0.5, 0.5},  {0.5, 0.03, 0.5}, {0.3, 0.03, 0.3},
                 {2.0, 0.03, 0.5}, {2.0, 1.3, 1.3},  {2.0, 2.0, 2.0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        asdic_array array = array_of(0);
        array.spacing_m = cases[i].spacing_wl * WAVELENGTH_M;
        array.element.length_h_m = cases[i].element_wl * WAVELENGTH_M;
        asdic_sonar sonar = sonar_of(&array);
        asdic_beam beam = beam_at(&array, 0.0);
        double heard = asdic_noise_lin(&env, &sonar, &beam, SPEED_MPS);
        sonar.array.elements = 0;
        beam.length_h_m = 64.0 * cases[i].aperture_wl * WAVELENGTH_M;
        assert_close_relative(heard, asdic_noise_lin(&env, &sonar, &beam, SPEED_MPS), 1e-9);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beams_are_as_high_and_wide_as_sums_over_elements),
        cmocka_unit_test(beams_at_an_elements_null_are_silent),
        cmocka_unit_test(tilted_arrays_are_steered_in_their_plane),
        cmocka_unit_test(beams_take_in_what_their_elements_do),
        cmocka_unit_test(thin_elements_take_in_what_an_aperture_does),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
