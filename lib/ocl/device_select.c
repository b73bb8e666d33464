#include "opencl.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#define SELECTOR_HELP "auto, all, cpu, gpu, acc, P:D[,P:D...] or name:TEXT"

static asdic_status none(asdic_context *ctx, const char *selector, const char *reason) {
    return asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                      "no device matches '%s': %s; 'asdic devices' lists what there is", selector,
                      reason);
}

/* POSIX names are compared without regard to case, in ASCII. */
static bool contains(const char *text, const char *part) {
    size_t length = strlen(part);
    for (; *text; text++) {
        if (strncasecmp(text, part, length) == 0) {
            return true;
        }
    }
    return false;
}

/* One decimal number of at most six digits; *TEXT moves behind it. */
static bool read_number(const char **text, unsigned *out) {
    const char *p = *text;
    *out = 0;
    while (isdigit((unsigned char)*p) && p - *text < 6) {
        *out = *out * 10 + (unsigned)(*p++ - '0');
    }
    bool any = p > *text && !isdigit((unsigned char)*p);
    *text = p;
    return any;
}

/* P:D,P:D,...: every pair must exist, be usable and be named once. */
static asdic_status select_pairs(asdic_context *ctx, const asdic_listed *list, size_t count,
                                 const char *selector, size_t *chosen, size_t *chosen_count) {
    const char *p = selector;
    for (;;) {
        unsigned platform, device;
        size_t i = 0;
        if (!read_number(&p, &platform) || *p++ != ':' || !read_number(&p, &device) ||
            (*p != ',' && *p != '\0')) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "device selector '%s' is not understood; expected " SELECTOR_HELP,
                              selector);
        }
        while (i < count && (list[i].info.platform != platform || list[i].info.device != device)) {
            i++;
        }
        if (i == count) {
            return asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                              "there is no device %u:%u; 'asdic devices' lists what there is",
                              platform, device);
        }
        if (!list[i].info.usable) {
            return asdic_fail(ctx, ASDIC_ERROR_DEVICE, "device %u:%u (%s) cannot be used: %s",
                              platform, device, list[i].info.name, list[i].info.unusable_why);
        }
        for (size_t k = 0; k < *chosen_count; k++) {
            if (chosen[k] == i) {
                return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                                  "device selector '%s' names %u:%u twice", selector, platform,
                                  device);
            }
        }
        chosen[(*chosen_count)++] = i;
        if (*p++ == '\0') {
            return ASDIC_OK;
        }
    }
}

/* Prefers, among usable devices, a GPU, then an accelerator, then a processor; among equals the one
 * with the most compute units, then the first. */
static void select_auto(const asdic_listed *list, size_t count, size_t *chosen,
                        size_t *chosen_count) {
    static const asdic_device_kind order[] = {ASDIC_DEVICE_GPU, ASDIC_DEVICE_ACCELERATOR,
                                              ASDIC_DEVICE_CPU, ASDIC_DEVICE_OTHER};
    for (size_t k = 0; k < sizeof order / sizeof order[0] && *chosen_count == 0; k++) {
        for (size_t i = 0; i < count; i++) {
            const asdic_device_info *info = &list[i].info;
            if (info->usable && info->kind == order[k] &&
                (*chosen_count == 0 || info->compute_units > list[chosen[0]].info.compute_units)) {
                chosen[0] = i;
                *chosen_count = 1;
            }
        }
    }
}

/* Whether SELECTOR is one of the words (or name:TEXT), and if INFO is not NULL, matches it. */
static bool word_matches(const char *selector, const asdic_device_info *info, bool *known) {
    *known = true;
    if (strcmp(selector, "all") == 0) {
        return true;
    }
    if (strcmp(selector, "cpu") == 0) {
        return info->kind == ASDIC_DEVICE_CPU;
    }
    if (strcmp(selector, "gpu") == 0) {
        return info->kind == ASDIC_DEVICE_GPU;
    }
    if (strcmp(selector, "acc") == 0) {
        return info->kind == ASDIC_DEVICE_ACCELERATOR;
    }
    if (strncmp(selector, "name:", 5) == 0 && selector[5] != '\0') {
        return contains(info->name, selector + 5) || contains(info->platform_name, selector + 5);
    }
    *known = false;
    return false;
}

asdic_status asdic_listed_select(asdic_context *ctx, const asdic_listed *list, size_t count,
                                 const char *selector, size_t *chosen, size_t *chosen_count) {
    const char *unusable = NULL;
    static const asdic_device_info nothing;
    bool known = false;

    *chosen_count = 0;
    if (!selector || selector[0] == '\0') {
        selector = "auto";
    }
    word_matches(selector, &nothing, &known);
    bool is_auto = strcmp(selector, "auto") == 0;
    if (!known && !is_auto && !isdigit((unsigned char)selector[0])) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "device selector '%s' is not understood; expected " SELECTOR_HELP,
                          selector);
    }
    if (count == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                          "no OpenCL device was found; install a driver for your device, or a "
                          "processor's on Debian and Ubuntu with 'apt-get install "
                          "pocl-opencl-icd ocl-icd-libopencl1'");
    }
    if (!known && !is_auto) {
        return select_pairs(ctx, list, count, selector, chosen, chosen_count);
    }
    if (is_auto) {
        select_auto(list, count, chosen, chosen_count);
    }
    for (size_t i = 0; i < count; i++) {
        if (!is_auto && !word_matches(selector, &list[i].info, &known)) {
            continue;
        }
        if (!list[i].info.usable) {
            unusable = list[i].info.unusable_why;
        } else if (!is_auto) {
            chosen[(*chosen_count)++] = i;
        }
    }
    if (*chosen_count == 0) {
        return none(ctx, selector, unusable ? unusable : "none is of that kind or name");
    }
    return ASDIC_OK;
}
