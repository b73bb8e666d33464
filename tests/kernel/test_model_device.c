/*
 * Every formula in single precision on the device against double on the host, over its whole
 * domain: corners and a low-discrepancy set of points. 77 without a device.
 */
#include "asserts.h"
#include "test_device.h"

#include "sim/model_table.h"

#include "../../kernels/formulas.h"

#include <stdio.h>
#include <string.h>
#include <stdlib.h>

#define POINTS 4096 /* at least the corners of 12 keys */

static test_device place;

/* Coordinate K of point I of a Kronecker sequence on the square roots of primes, [0, 1). */
static double coordinate(size_t i, size_t k) {
    static const double prime[ASDIC_MODEL_MAX_KEYS] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};
    double x = (double)(i + 1) * sqrt(prime[k]);
    return x - floor(x);
}

/* U in [0, 1] over [min, max]: in equal ratios where the domain spans more than two decades, in
 * whole steps for words; the ends are met exactly, NAN fallbacks are replaced. */
static double spread(const asdic_model_key *key, double u) {
    if (!key->numeric) {
        return fmin(floor(u * (key->max + 1.0)), key->max);
    }
    bool ratio = key->min > 0.0 && key->max / key->min > 100.0;
    double x =
        ratio ? key->min * pow(key->max / key->min, u) : key->min + u * (key->max - key->min);
    bool is_steep =
        strcmp(key->name, "grazing_deg") == 0 || strcmp(key->name, "incidence_deg") == 0;
    return fmin(fmax(is_steep ? x : (float)x, key->min), key->max); /* 89.99 is no float */
}

/* What makes a point meaningful for single precision, written over the plain domain: apertures up
 * to 100 wavelengths; probabilities that a float can hold; whole looks. */
static void narrow(size_t model, double *key, size_t i) {
    if (model == MODEL_BEAM_PATTERN) {
        key[4] = (float)(0.001 + 0.1 * coordinate(i, 4));
        key[2] = (float)(key[4] * 100.0 * coordinate(i, 2) + 1e-3);
        key[3] = (float)(key[4] * 100.0 * coordinate(i, 3) + 1e-3);
    } else if (model == MODEL_SURFACE_BACKSCATTER && key[3] > 0.5) {
        key[2] = fmin(key[2], 89.9); /* uncapped it exceeds what a float holds as energy */
    } else if (model == MODEL_PFA || model == MODEL_PD) {
        size_t last = asdic_model_get(model)->key_count - 1;
        key[2] = (float)pow(10.0, 6.0 * coordinate(i, 2) - 3.0);
        key[1] = (float)(key[2] * 20.0 * coordinate(i, 1));
        key[last - 1] = floor(key[last - 1] < 500.0 ? 1.0 + 20.0 * coordinate(i, 7) : 1.0);
        key[last] = i % 2 ? INFINITY : key[last];
    }
}

/* Beam patterns are compared as intensities: at a null the dB value means nothing. */
static double measure(size_t model, double value, double reference) {
    const asdic_model_info *info = asdic_model_get(model);
    if (model == MODEL_BEAM_PATTERN) {
        double floor_lin = 1e-6; /* -60 dB */
        double a = pow(10.0, 0.1 * value) + floor_lin, b = pow(10.0, 0.1 * reference) + floor_lin;
        return fabs(10.0 * log10(a / b)) / 1e-3;
    }
    if (value == reference) {
        return 0.0;
    }
    bool decibel = strcmp(info->unit, "dB") == 0;
    double allowed = 1e-5 * fabs(reference) + (decibel ? 1e-3 : 1e-30);
    return fabs(value - reference) / allowed;
}

static void device_agrees_with_host(void **state) {
    size_t model = *(const size_t *)*state;
    const asdic_model_info *info = asdic_model_get(model);
    double *keys = calloc((POINTS + 1) * ASDIC_MODEL_MAX_KEYS, sizeof *keys);
    double *host = calloc(POINTS + 1, sizeof *host), *device = calloc(POINTS + 1, sizeof *device);
    assert_true(keys && host && device);
    host[POINTS] = device[POINTS] = -7.0; /* of nobody */
    size_t corners = (size_t)1 << info->key_count;
    for (size_t i = 0; i < POINTS; i++) {
        for (size_t k = 0; k < info->key_count; k++) {
            double u = i < corners ? (double)(i >> k & 1) : coordinate(i, k);
            keys[i * ASDIC_MODEL_MAX_KEYS + k] = spread(&info->keys[k], u);
        }
        narrow(model, keys + i * ASDIC_MODEL_MAX_KEYS, i);
    }
    assert_ok(place.ctx, asdic_model_evaluate_many(place.ctx, NULL, model, keys, POINTS, host));
    assert_ok(place.ctx,
              asdic_model_evaluate_many(place.ctx, place.device, model, keys, POINTS, device));
    assert_true(host[POINTS] == -7.0 && device[POINTS] == -7.0);
    double worst = 0.0;
    size_t worst_at = 0;
    for (size_t i = 0; i < POINTS; i++) {
        assert_true(host[i] < INFINITY && device[i] < INFINITY); /* -INFINITY dB: no energy */
        double off = measure(model, device[i], host[i]);
        if (!(off <= worst)) {
            worst = off;
            worst_at = i;
        }
    }
    print_message("%s: worst %.3f of the tolerance: %.9g, host %.9g, at", info->name, worst,
                  device[worst_at], host[worst_at]);
    for (size_t k = 0; k < info->key_count; k++) {
        print_message(" %s=%.9g", info->keys[k].name, keys[worst_at * ASDIC_MODEL_MAX_KEYS + k]);
    }
    print_message("\n");
    free(keys);
    free(host);
    free(device);
    assert_true(worst <= 1.0);
}

int main(void) {
    static size_t numbers[MODEL_COUNT];
    struct CMUnitTest tests[MODEL_COUNT];
    place = test_device_open_or_skip();
    for (size_t i = 0; i < MODEL_COUNT; i++) {
        numbers[i] = i;
        tests[i] = (struct CMUnitTest){asdic_model_get(i)->name, device_agrees_with_host, NULL,
                                       NULL, &numbers[i]};
    }
    return test_device_end(&place, cmocka_run_group_tests_name("model_device", tests, NULL, NULL));
}
