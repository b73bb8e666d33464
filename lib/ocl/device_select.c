#include "opencl.h"

#include <ctype.h>
#include <string.h>

#define SELECTOR_HELP "auto, all, cpu, gpu, acc, P:D[,P:D...] or name:TEXT"
#define NO_DEVICE "no OpenCL device was found; "
#define INSTALL                                                                                    \
    "install a driver for your device, or a processor's on Debian and Ubuntu with "                \
    "'apt-get install pocl-opencl-icd ocl-icd-libopencl1'"

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

/* Whether `auto` takes A rather than B: a driver that is not slow, then a GPU, then an accelerator,
 * then a processor, then more compute units. */
static bool is_better(const asdic_device_info *a, const asdic_device_info *b) {
    static const int place[] = {[ASDIC_DEVICE_GPU] = 0,
                                [ASDIC_DEVICE_ACCELERATOR] = 1,
                                [ASDIC_DEVICE_CPU] = 2,
                                [ASDIC_DEVICE_OTHER] = 3};
    bool a_slow = asdic_driver_is_slow(a), b_slow = asdic_driver_is_slow(b);
    if (a_slow != b_slow) {
        return b_slow;
    }
    return a->kind != b->kind ? place[a->kind] < place[b->kind]
                              : a->compute_units > b->compute_units;
}

/* The best of the usable devices, of equal ones the first; COUNT: none is usable. */
static size_t best_of(const asdic_listed *list, size_t count) {
    size_t best = count;
    for (size_t i = 0; i < count; i++) {
        if (list[i].info.usable && (best == count || is_better(&list[i].info, &list[best].info))) {
            best = i;
        }
    }
    return best;
}

/* Whether `all` goes without the device: it would be waited for, where another would long be done. */
static bool is_left_out(asdic_context *ctx, const asdic_device_info *info,
                        const asdic_device_info *best) {
    if (!asdic_driver_is_slow(info) || asdic_driver_is_slow(best)) {
        return false;
    }
    asdic_log(ctx, ASDIC_LOG_WARNING,
              "device %u:%u (%s) is left out of 'all', since its driver is far slower than that of "
              "'%s'; name it to have it",
              info->platform, info->device, info->name, best->name);
    return true;
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

/* So it looks, too, where PoCL cannot keep what it compiles, or is told to use drivers that it does not have. */
static asdic_status no_device(asdic_context *ctx) {
    char folder[ASDIC_CACHE_SIZE];
    const char *why = asdic_cache_refusal(folder), *drivers = getenv("POCL_DEVICES");
    if (!why && drivers) { /* an empty one leaves none, too */
        return asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                          NO_DEVICE
                          "where PoCL is installed, POCL_DEVICES limits it to '%s': unset "
                          "that, or name a driver that PoCL has, as 'pthread'; else " INSTALL,
                          drivers);
    }
    return why ? asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                            NO_DEVICE "where PoCL is installed, set POCL_CACHE_DIR to a folder "
                                      "that can be written to: '%s' cannot (%s); else " INSTALL,
                            folder, why)
               : asdic_fail(ctx, ASDIC_ERROR_DEVICE, NO_DEVICE INSTALL);
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
        return no_device(ctx);
    }
    if (!known && !is_auto) {
        return select_pairs(ctx, list, count, selector, chosen, chosen_count);
    }
    size_t best = best_of(list, count);
    if (is_auto && best < count) {
        chosen[(*chosen_count)++] = best;
    }
    for (size_t i = 0; i < count; i++) {
        if (!is_auto && !word_matches(selector, &list[i].info, &known)) {
            continue;
        }
        if (!list[i].info.usable) {
            unusable = list[i].info.unusable_why;
        } else if (!is_auto && !(strcmp(selector, "all") == 0 &&
                                 is_left_out(ctx, &list[i].info, &list[best].info))) {
            chosen[(*chosen_count)++] = i;
        }
    }
    if (*chosen_count == 0) {
        return none(ctx, selector, unusable ? unusable : "none is of that kind or name");
    }
    return ASDIC_OK;
}
