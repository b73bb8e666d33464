/* How the time of a ping grows with triangles and bins, and falls with compute units: `asdic bench
 * pings` on the whole device and on one unit of it. */
#include "bench_pings.h"
#include "kinds.h"

#define MOST_PINGS 192

/* UNIT: NULL where the device has one, or cannot be split. */
static asdic_status measure(bench *b, asdic_device *unit, const bench_case *of, double *ping_s,
                            double *gain) {
    bench_rate whole, one;
    TRY(bench_pings_measure(b, b->device, of, &whole));
    bench_pings_add(b, "floor", &whole);
    *ping_s = whole.ping_s;
    if (unit) {
        TRY(bench_pings_measure(b, unit, of, &one));
        bench_pings_add(b, "floor", &one);
        *gain = one.ping_s / whole.ping_s;
    }
    return ASDIC_OK;
}

static asdic_status measure_floors(bench *b, asdic_device *unit) {
    size_t floors = BENCH_FLOORS - (b->quick ? 2 : 0), count = floors * BENCH_BIN_COUNTS;
    double ping_s[BENCH_FLOORS * BENCH_BIN_COUNTS], gains[BENCH_FLOORS * BENCH_BIN_COUNTS];
    asdic_scene *scene = NULL;
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < count; i++) {
        if (i % BENCH_BIN_COUNTS == 0) {
            asdic_scene_destroy(&scene);
            status =
                bench_terrain(cli_context(b->c), bench_floors[i / BENCH_BIN_COUNTS], 0, &scene);
        }
        bench_case of = {.scene = scene,
                         .bins = bench_bin_counts[i % BENCH_BIN_COUNTS],
                         .pings = b->quick ? 8 : MOST_PINGS};
        status = status ? status : measure(b, unit, &of, &ping_s[i], &gains[i]);
    }
    asdic_scene_destroy(&scene);
    if (status) {
        return status;
    }
    bench_say(b, "%zu times the triangles: %.2f times the time; %zu times the bins: %.2f times\n",
              bench_floors[floors - 1] / bench_floors[0],
              ping_s[count - BENCH_BIN_COUNTS] / ping_s[0],
              bench_bin_counts[BENCH_BIN_COUNTS - 1] / bench_bin_counts[0],
              ping_s[BENCH_BIN_COUNTS - 1] / ping_s[0]);
    if (unit) {
        bench_say(b, "all units are %.2f times as fast as one (median of the rows)\n",
                  bench_median(gains, count));
    }
    return ASDIC_OK;
}

asdic_status growth(bench *b) {
    unsigned count = asdic_device_get_info(b->device)->compute_units;
    asdic_device **units = NULL;
    if (count > 1) { /* a device that cannot be split is measured whole alone */
        asdic_device_split(b->device, count, &units);
    }
    asdic_status status = measure_floors(b, units ? units[0] : NULL);
    asdic_devices_close(&units, count);
    return status;
}
