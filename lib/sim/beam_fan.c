#include "beam_fan.h"

#include "aim.h"
#include "base/context.h"
#include "base/vec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LEAST_RECEIVERS 16
/* Bins of a work-item that projects, where work-items are not one another's neighbours: a cache line
 * of results. */
#define WIDE_RUN 16
/* Cells per wavelength of aperture and radian. */
#define CELLS_PER_WAVELENGTH 3.0
#define LEAST_CELLS 64
#define ENTRY_BYTES 8 /* of a fan_entry, and of a fan_list */
/* Widest transmitter, in apertures of the receivers: what arrives is taken to be even over a receiver's
 * width. Against beam by beam, steep bins are up to 0.3 dB off at this, 1.3 at an equal width. */
#define WIDEST_SENDER 0.25

static bool same(float a, float b) {
    return fabsf(a - b) < 1e-5f;
}

/* How wide an aperture is across AXIS, in wavelengths. */
static double width_across(const dev_beam *beam, const float axis[3]) {
    double width = 0.0;
    for (int side = 1; side < 3; side++) {
        const float *row = beam->rows + 3 * side;
        double along = row[0] * axis[0] + row[1] * axis[1] + row[2] * axis[2];
        double length = side == 1 ? beam->length_h_wl : beam->length_v_wl;
        width = fmax(width, length * sqrt(fmax(1.0 - along * along, 0.0)));
    }
    return width;
}

void asdic_beam_fan_plan(const asdic_sonar *sonar, double wavelength_m, asdic_beam_fan *fan) {
    memset(fan, 0, sizeof *fan);
    if (sonar->receiver_count < LEAST_RECEIVERS) {
        return;
    }
    const asdic_pose level = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    dev_beam first = asdic_aim_beam(&sonar->receivers[0], &level, wavelength_m);
    for (size_t r = 1; r < sonar->receiver_count; r++) {
        dev_beam beam = asdic_aim_beam(&sonar->receivers[r], &level, wavelength_m);
        for (int i = 6; i < 9; i++) {
            if (!same(beam.rows[i], first.rows[i])) {
                return;
            }
        }
        if (beam.length_h_wl != first.length_h_wl || beam.length_v_wl != first.length_v_wl) {
            return;
        }
    }
    dev_beam sender = asdic_aim_beam(&sonar->transmitter, &level, wavelength_m);
    if (width_across(&sender, first.rows + 6) > WIDEST_SENDER * first.length_h_wl) {
        return;
    }
    double tilt = sender.rows[0] * first.rows[6] + sender.rows[1] * first.rows[7] +
                  sender.rows[2] * first.rows[8];
    fan->circle = fabs(tilt) > 1e-5 || isfinite(sonar->rear_floor_db);
    double arc = fan->circle ? 2.0 * ASDIC_PI : ASDIC_PI;
    double cells = ceil(arc * CELLS_PER_WAVELENGTH * first.length_h_wl) + 1.0;
    fan->cells = (unsigned)fmax(cells, LEAST_CELLS);
    fan->stride =
        (unsigned)((sonar->receiver_count + DEV_FAN_TILE - 1) / DEV_FAN_TILE * DEV_FAN_TILE);
}

unsigned asdic_beam_fan_flags(size_t columns) {
    size_t flags = (columns + DEV_FAN_CHUNK - 1) / DEV_FAN_CHUNK;
    return (unsigned)((flags + 7) / 8 * 8);
}

size_t asdic_beam_fan_tail_bytes(const asdic_beam_fan *fan, size_t rows) {
    size_t flags = asdic_beam_fan_flags((size_t)DEV_FAN_LEVELS * fan->cells);
    return fan->cells ? rows * flags + sizeof(uint32_t) : 0;
}

/* x: the transmitter's axis in the plane across the fan's axis z; y: z cross x. */
static void fan_frame(const dev_beam *beams, float rows[9]) {
    const float *front = beams[0].rows, *z = beams[1].rows + 6;
    double along = front[0] * z[0] + front[1] * z[1] + front[2] * z[2];
    double x[3], length = 0.0;
    for (int i = 0; i < 3; i++) {
        x[i] = front[i] - along * z[i];
        length += x[i] * x[i];
    }
    length = sqrt(length);
    if (length < 1e-3) { /* the transmitter looks along the axis: any direction will do */
        memcpy(rows, beams[1].rows, 9 * sizeof(float));
        return;
    }
    for (int i = 0; i < 3; i++) {
        rows[i] = (float)(x[i] / length);
        rows[6 + i] = z[i];
    }
    rows[3] = z[1] * rows[2] - z[2] * rows[1];
    rows[4] = z[2] * rows[0] - z[0] * rows[2];
    rows[5] = z[0] * rows[1] - z[1] * rows[0];
}

/* Where the receivers look, in the fan's frame; of a vehicle that lies level, as aimed at any pose they
 * would differ by its rounding, and pings by the poses before them. */
static asdic_status make_bearings(asdic_beam_fan *fan, asdic_device *device,
                                  const asdic_sonar *sonar) {
    const asdic_pose level = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    dev_beam beams[2] = {asdic_aim_beam(&sonar->transmitter, &level, 1.0),
                         asdic_aim_beam(&sonar->receivers[0], &level, 1.0)};
    float rows[9], *bearings_rad = malloc(sonar->receiver_count * sizeof *bearings_rad);
    if (!bearings_rad) {
        return asdic_fail_memory(asdic_device_context(device), "a fan");
    }
    fan_frame(beams, rows);
    for (size_t r = 0; r < sonar->receiver_count; r++) {
        dev_beam beam = asdic_aim_beam(&sonar->receivers[r], &level, 1.0);
        const float *x = beam.rows;
        bearings_rad[r] = atan2f(x[0] * rows[3] + x[1] * rows[4] + x[2] * rows[5],
                                 x[0] * rows[0] + x[1] * rows[1] + x[2] * rows[2]);
    }
    asdic_status status = asdic_buffer_create(device, sonar->receiver_count * sizeof *bearings_rad,
                                              bearings_rad, &fan->bearings);
    free(bearings_rad);
    return status;
}

asdic_status asdic_beam_fan_init(asdic_beam_fan *fan, asdic_device *device,
                                 const asdic_sonar *sonar, unsigned width, size_t rows) {
    if (fan->cells == 0) {
        return ASDIC_OK;
    }
    char options[64];
    fan->run = width == 1 ? 1 : WIDE_RUN;
    snprintf(options, sizeof options, "-D ASDIC_FAN=1 -D ASDIC_RUN=%u", fan->run);
    const size_t columns = (size_t)DEV_FAN_LEVELS * fan->cells;
    const struct {
        const char *name;
        asdic_kernel **kernel;
    } kernels[] = {
        {"fan_table", &fan->make_table}, {"fan_pack", &fan->pack}, {"fan_project", &fan->project}};
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } buffers[] = {{columns * fan->stride * sizeof(float), &fan->table},
                   {rows * columns * ENTRY_BYTES, &fan->entries},
                   {rows * ENTRY_BYTES, &fan->lists}};
    fan->fetches = calloc(fan->stride / DEV_FAN_TILE, sizeof(asdic_fetch *));
    if (!fan->fetches) {
        return asdic_fail_memory(asdic_device_context(device), "a fan");
    }
    asdic_status status = make_bearings(fan, device, sonar);
    for (size_t i = 0; !status && i < sizeof kernels / sizeof *kernels; i++) {
        status = asdic_kernel_create(device, "fan.cl", options, kernels[i].name, kernels[i].kernel);
    }
    for (size_t i = 0; !status && i < sizeof buffers / sizeof *buffers; i++) {
        status = asdic_buffer_create(device, buffers[i].bytes, NULL, buffers[i].buffer);
    }
    return status;
}

void asdic_beam_fan_finish(asdic_beam_fan *fan, asdic_device *device) {
    for (size_t tile = 0; fan->fetches && tile < fan->stride / DEV_FAN_TILE; tile++) {
        asdic_fetch_wait(device, &fan->fetches[tile]);
    }
    free(fan->fetches);
    asdic_kernel_destroy(&fan->make_table);
    asdic_kernel_destroy(&fan->pack);
    asdic_kernel_destroy(&fan->project);
    asdic_buffer_destroy(&fan->bearings);
    asdic_buffer_destroy(&fan->table);
    asdic_buffer_destroy(&fan->entries);
    asdic_buffer_destroy(&fan->lists);
}

void asdic_beam_fan_describe(const asdic_beam_fan *fan, const dev_beam *beams, dev_ping *ping) {
    if (fan->cells == 0) {
        return;
    }
    double arc = fan->circle ? 2.0 * ASDIC_PI : ASDIC_PI;
    ping->fan_cells = fan->cells;
    ping->fan_begin_rad = (float)(-0.5 * arc);
    ping->fan_cells_per_rad = (float)((fan->cells - 1) / arc);
    fan_frame(beams, ping->fan_rows);
}

/* The table depends on how the fan is built and on the wavelength, not on the pose. */
static asdic_status tabulate(asdic_beam_fan *fan, const dev_ping *ping, asdic_buffer *ping_buffer) {
    const dev_beam *beams = (const dev_beam *)(ping + 1); /* as for beams_of on the device */
    float length_wl = beams[1].length_h_wl;
    if (fan->table_length_wl == length_wl) {
        return ASDIC_OK;
    }
    dev_uint stride = fan->stride;
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(fan->bearings),
                               ASDIC_ARG_BUFFER(fan->table), ASDIC_ARG_VALUE(stride)};
    asdic_status status =
        asdic_kernel_run(fan->make_table, args, 4, (size_t)ping->columns * stride, 64);
    fan->table_length_wl = status ? 0.0f : length_wl;
    return status;
}

asdic_status asdic_beam_fan_project(asdic_beam_fan *fan, const dev_ping *ping,
                                    asdic_buffer *ping_buffer, asdic_buffer *accumulator,
                                    asdic_buffer *saturated, asdic_buffer *results,
                                    float *host_results) {
    dev_uint stride = fan->stride;
    size_t rows = ping->components * (size_t)ping->bins, beams = ping->beams;
    size_t runs = (ping->bins + fan->run - 1) / fan->run * ping->components;
    asdic_status status = tabulate(fan, ping, ping_buffer);
    if (!status) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(accumulator),
                                   ASDIC_ARG_BUFFER(fan->entries), ASDIC_ARG_BUFFER(fan->lists)};
        status = asdic_kernel_run(fan->pack, args, 4, rows, 16);
    }
    for (dev_uint tile = 0; !status && tile * DEV_FAN_TILE < beams; tile++) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(fan->entries),
                                   ASDIC_ARG_BUFFER(fan->lists),  ASDIC_ARG_BUFFER(fan->table),
                                   ASDIC_ARG_BUFFER(accumulator), ASDIC_ARG_BUFFER(saturated),
                                   ASDIC_ARG_BUFFER(results),     ASDIC_ARG_VALUE(stride),
                                   ASDIC_ARG_VALUE(tile)};
        status = asdic_kernel_run(fan->project, args, 9, runs, fan->run == 1 ? 16 : 1);
        size_t first = (size_t)tile * DEV_FAN_TILE, end = first + DEV_FAN_TILE;
        size_t words = end >= beams ? (beams - first) * rows + 1 : DEV_FAN_TILE * rows;
        if (!status) {
            status =
                asdic_buffer_fetch(results, first * rows * sizeof(float), words * sizeof(float),
                                   host_results + first * rows, &fan->fetches[tile]);
        }
    }
    return status;
}

asdic_status asdic_beam_fan_wait(asdic_beam_fan *fan, asdic_device *device, size_t tile) {
    return asdic_fetch_wait(device, &fan->fetches[tile]);
}
