#include <asdic/ping.h>

#include "base/context.h"
#include "base/decibel.h"

#include <math.h>
#include <stdlib.h>

asdic_sampling asdic_sampling_default(void) {
    return (asdic_sampling){.rays = 20000,
                            .sampler = ASDIC_SAMPLER_ADAPTIVE,
                            .multipath = ASDIC_MULTIPATH_FIRST,
                            .seed = 1};
}

asdic_status asdic_ping_create(asdic_context *ctx, size_t beams, size_t bins, asdic_ping **out) {
    if (!out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_ping_create: out is NULL");
    }
    *out = NULL;
    if (beams == 0 || bins == 0 || bins > SIZE_MAX / sizeof(double) / beams) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a ping of %zu beams and %zu bins", beams,
                          bins);
    }
    asdic_ping *ping = calloc(1, sizeof *ping);
    if (!ping) {
        goto fail;
    }
    ping->beams = beams;
    ping->bins = bins;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        ping->intensity_lin[c] = calloc(beams * bins, sizeof(double));
        if (!ping->intensity_lin[c]) {
            goto fail;
        }
    }
    ping->stderr_db = calloc(beams * bins, sizeof(float));
    if (!ping->stderr_db) {
        goto fail;
    }
    *out = ping;
    return ASDIC_OK;

fail:
    asdic_ping_destroy(&ping);
    return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                      "out of memory while allocating a ping of %zu beams and %zu bins", beams,
                      bins);
}

asdic_status asdic_ping_add_elements(asdic_context *ctx, asdic_ping *ping, size_t elements,
                                     size_t samples) {
    if (!ping || elements == 0 || samples == 0 || ping->pressure) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_ping_add_elements: %zu elements and %zu samples%s", elements,
                          samples, ping && ping->pressure ? ", a second time" : "");
    }
    ping->pressure = samples <= SIZE_MAX / elements
                         ? calloc(elements * samples, 2 * sizeof *ping->pressure)
                         : NULL;
    if (!ping->pressure) {
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "out of memory while allocating %zu elements of %zu samples", elements,
                          samples);
    }
    ping->elements = elements;
    ping->samples = samples;
    return ASDIC_OK;
}

void asdic_ping_destroy(asdic_ping **ping) {
    if (!ping || !*ping) {
        return;
    }
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        free((*ping)->intensity_lin[c]);
    }
    free((*ping)->stderr_db);
    free((*ping)->pressure);
    free((*ping)->truth);
    free(*ping);
    *ping = NULL;
}

asdic_status asdic_ping_add_truth(asdic_context *ctx, asdic_ping *ping) {
    if (!ping || ping->beams == 0 || ping->bins == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_ping_add_truth: a ping with beams and bins is needed");
    }
    if (ping->truth) {
        return ASDIC_OK;
    }
    /* One block: the struct, the floats, the numbers. */
    size_t cells = ping->beams * ping->bins, floats = ASDIC_PATH_COUNT + 3;
    asdic_ping_truth *truth =
        calloc(1, sizeof *truth + cells * (floats * sizeof(float) + 2 * sizeof(int16_t)));
    if (!truth) {
        return asdic_fail_memory(ctx, "the truth of a ping");
    }
    float *values = (float *)(void *)(truth + 1);
    int16_t *numbers = (int16_t *)(void *)(values + floats * cells);
    truth->share = values;
    truth->object_share = values + cells;
    truth->depression_rad = values + 2 * cells;
    for (size_t p = 0; p < ASDIC_PATH_COUNT; p++) {
        truth->path[p] = values + (3 + p) * cells;
    }
    truth->strongest = numbers;
    truth->object = numbers + cells;
    ping->truth = truth;
    return ASDIC_OK;
}

const char *asdic_path_name(asdic_path path) {
    static const char *const names[ASDIC_PATH_COUNT] = {"direct", "by_surface", "by_bottom",
                                                        "by_object", "noise"};
    return (unsigned)path < ASDIC_PATH_COUNT ? names[path] : "?";
}

double asdic_level_db(double intensity_lin) {
    return intensity_lin > 0.0 ? 10.0 * log10(intensity_lin) : -INFINITY;
}

asdic_status asdic_ping_levels(const asdic_ping *ping, asdic_component component, float *level_db) {
    if (!ping || !level_db || (unsigned)component >= ASDIC_COMPONENT_COUNT) {
        return ASDIC_ERROR_ARGUMENT;
    }
    asdic_decibels(ping->intensity_lin[component], ping->beams * ping->bins, level_db);
    return ASDIC_OK;
}
