#include "opencl.h"

#include <string.h>

/* What is known of drivers, by parts of their platform's and their device's names. A driver that is
 * not here is quick and takes vectors. */
static const struct driver {
    const char *platform, *device;
    bool is_slow;         /* many times slower than a processor's own driver, on the same cores */
    bool refuses_vectors; /* its compiler crashes, or takes minutes */
} drivers[] = {
    /* Mesa 22.3: pkt16 and frustum64 end in a segmentation fault, vectors of eight compile for
     * minutes. */
    {"rusticl", "llvmpipe", true, true},
    /* An interpreter, which looks for faults. */
    {"Oclgrind", "", true, false},
};

static const struct driver *driver_of(const asdic_device_info *info) {
    for (size_t i = 0; i < sizeof drivers / sizeof *drivers; i++) {
        if (strstr(info->platform_name, drivers[i].platform) &&
            strstr(info->name, drivers[i].device)) {
            return &drivers[i];
        }
    }
    return NULL;
}

bool asdic_driver_is_pocl(const asdic_device_info *info) {
    return strcmp(info->platform_name, "Portable Computing Language") == 0;
}

bool asdic_driver_is_slow(const asdic_device_info *info) {
    const struct driver *driver = driver_of(info);
    return driver && driver->is_slow;
}

bool asdic_driver_refuses_vectors(const asdic_device_info *info) {
    const struct driver *driver = driver_of(info);
    return driver && driver->refuses_vectors;
}
