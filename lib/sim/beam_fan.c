#include "beam_fan.h"

#include "aim.h"
#include "base/vec.h"

#include <string.h>

#define LEAST_RECEIVERS 16
#define TILE 128 /* as in fan.cl */
/* Cells per wavelength of aperture and radian. */
#define CELLS_PER_WAVELENGTH 3.0
#define LEAST_CELLS 64
#define ENTRY_BYTES 8 /* of a fan_entry */
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
    fan->stride = (unsigned)((sonar->receiver_count + TILE - 1) / TILE * TILE);
}

asdic_status asdic_beam_fan_init(asdic_beam_fan *fan, asdic_device *device, const char *options,
                                 size_t rows) {
    if (fan->cells == 0) {
        return ASDIC_OK;
    }
    rows *= DEV_FAN_LEVELS;
    const size_t columns = (size_t)DEV_FAN_LEVELS * fan->cells;
    asdic_status status =
        asdic_kernel_create(device, "fan.cl", options, "fan_table", &fan->make_table);
    if (!status) {
        status = asdic_kernel_create(device, "fan.cl", options, "fan_pack", &fan->pack);
    }
    if (!status) {
        status = asdic_kernel_create(device, "fan.cl", options, "fan_project", &fan->project);
    }
    if (!status) {
        status =
            asdic_buffer_create(device, columns * fan->stride * sizeof(float), NULL, &fan->table);
    }
    if (!status) {
        status = asdic_buffer_create(device, rows * fan->cells * ENTRY_BYTES, NULL, &fan->entries);
    }
    if (!status) {
        status = asdic_buffer_create(device, rows * sizeof(uint32_t), NULL, &fan->counts);
    }
    return status;
}

void asdic_beam_fan_finish(asdic_beam_fan *fan) {
    asdic_kernel_destroy(&fan->make_table);
    asdic_kernel_destroy(&fan->pack);
    asdic_kernel_destroy(&fan->project);
    asdic_buffer_destroy(&fan->table);
    asdic_buffer_destroy(&fan->entries);
    asdic_buffer_destroy(&fan->counts);
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

asdic_status asdic_beam_fan_project(asdic_beam_fan *fan, const dev_ping *ping,
                                    asdic_buffer *ping_buffer, asdic_buffer *accumulator,
                                    asdic_buffer *saturated, asdic_buffer *results) {
    asdic_status status = ASDIC_OK;
    dev_uint stride = fan->stride;
    size_t rows = ping->components * (size_t)ping->bins;
    /* The table depends on how the fan is built and on the wavelength, not on the pose. */
    if (fan->table_wavelength_m != (double)ping->wavelength_m) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(fan->table),
                                   ASDIC_ARG_VALUE(stride)};
        status = asdic_kernel_run(fan->make_table, args, 3, (size_t)ping->columns * stride, 64);
        fan->table_wavelength_m = ping->wavelength_m;
    }
    if (!status) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(accumulator),
                                   ASDIC_ARG_BUFFER(fan->entries), ASDIC_ARG_BUFFER(fan->counts)};
        status = asdic_kernel_run(fan->pack, args, 4, rows * DEV_FAN_LEVELS, 16);
    }
    if (!status) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(ping_buffer), ASDIC_ARG_BUFFER(fan->entries),
                                   ASDIC_ARG_BUFFER(fan->counts), ASDIC_ARG_BUFFER(fan->table),
                                   ASDIC_ARG_BUFFER(saturated),   ASDIC_ARG_BUFFER(results),
                                   ASDIC_ARG_VALUE(stride)};
        status = asdic_kernel_run(fan->project, args, 7, rows * (stride / TILE), 16);
    }
    return status;
}
