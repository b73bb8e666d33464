/*
 * A fan of many receivers: one map of azimuth cells for all of them, see kernels/receive.h.
 */
#ifndef ASDIC_SIM_BEAM_FAN_H
#define ASDIC_SIM_BEAM_FAN_H

#include <asdic/ping.h>

#include "../../kernels/ping_types.h"
#include "ocl/ocl.h"

typedef struct asdic_beam_fan {
    unsigned cells;        /* azimuth cells; 0: the receivers are not a fan */
    unsigned stride;       /* beams rounded up to a tile of fan.cl */
    unsigned run;          /* bins of a work-item that projects */
    bool circle;           /* cells go all round, not only over the front */
    float table_length_wl; /* apertures that the table is of */
    asdic_kernel *make_table, *pack, *project;
    asdic_buffer *bearings, *table, *entries, *lists;
    asdic_fetch **fetches; /* a tile's each, on their way to the host */
} asdic_beam_fan;

/* Fills CELLS, STRIDE and CIRCLE: a fan is at least 16 receivers of one size whose faces differ in
 * yaw about a common axis only, with a transmitter at most a quarter as wide. */
void asdic_beam_fan_plan(const asdic_sonar *sonar, double wavelength_m, asdic_beam_fan *fan);

/* Kernels and buffers for a planned fan of SONAR with ROWS of (component, bin) and vectors of WIDTH;
 * nothing when there is none. */
asdic_status asdic_beam_fan_init(asdic_beam_fan *fan, asdic_device *device,
                                 const asdic_sonar *sonar, unsigned width, size_t rows);
void asdic_beam_fan_finish(asdic_beam_fan *fan, asdic_device *device);

/* The fan's frame and cells of a ping whose beams (transmitter first) are aimed. */
void asdic_beam_fan_describe(const asdic_beam_fan *fan, const dev_beam *beams, dev_ping *ping);

/* Flags of a row of COLUMNS, see receive.h. */
unsigned asdic_beam_fan_flags(size_t columns);
/* Bytes behind the accumulator's cells: ROWS of flags, and a count; none where there is no fan. */
size_t asdic_beam_fan_tail_bytes(const asdic_beam_fan *fan, size_t rows);

/* Enqueues cells to beams, tile by tile: ACCUMULATOR, which is cleared, to RESULTS, floats
 * [beam][component][bin] and one word of cut deposits, which are fetched to HOST_RESULTS. */
asdic_status asdic_beam_fan_project(asdic_beam_fan *fan, const dev_ping *ping,
                                    asdic_buffer *ping_buffer, asdic_buffer *accumulator,
                                    asdic_buffer *saturated, asdic_buffer *results,
                                    float *host_results);
/* Blocks until the beams of TILE are there; with the last one, the word of cut deposits. */
asdic_status asdic_beam_fan_wait(asdic_beam_fan *fan, asdic_device *device, size_t tile);

#endif
