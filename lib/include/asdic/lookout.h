/*
 * The lookout: a detector beside a loop, which decides about each ping as it comes, as
 * `asdic serve --detect` and trials do.
 *
 *     asdic_loop_collect(loop, &ping);
 *     asdic_lookout_detect(lookout, &ping, &found);
 *     (ping.parts->intensity_lin[ASDIC_TOTAL][i] > found.threshold_lin[i])
 *
 * Over a plane a bin is held against what is expected without objects; over a bottom from a mesh
 * or grid, which stands out from a plane, against its neighbours (OS-CFAR). `background` in the
 * scene's section `trial` chooses.
 */
#ifndef ASDIC_LOOKOUT_H
#define ASDIC_LOOKOUT_H

#include <asdic/loop.h>
#include <asdic/scan.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_lookout asdic_lookout;

/* For pings of a loop of MISSION, which must outlive the lookout, with BINS a beam
 * (asdic_loop_bin_count), by the mission's detector. Its first detection tells by the context's log
 * what makes P_FA other than the detector's: neighbours that nobody asked for are such. */
ASDIC_API asdic_status asdic_lookout_create(asdic_context *ctx, const asdic_mission *mission,
                                            size_t bins, asdic_lookout **out);
ASDIC_API void asdic_lookout_destroy(asdic_lookout **lookout);

/* What is expected over a plane below the vehicle of PING without objects, noise included,
 * [beam * bins + bin]; valid until the next call for this lookout. It is that of a place on a grid,
 * 1 mm in altitude and depth, both rounded down, and 1e-4 degrees in roll and pitch, and a function
 * of that place alone: within 0.1 dB of asdic_expected_compute in nearly all bins within 40 dB of a
 * beam's loudest, but not in the first of a plane's echo, of which a bin may hold up to a mm more.
 * ASDIC_ERROR_ARGUMENT where PING has other beams or bins than the lookout is for. */
ASDIC_API asdic_status asdic_lookout_expect(asdic_lookout *lookout, const asdic_loop_ping *ping,
                                            const double **total_lin);

/* Decides about PING; FOUND is valid until the next call for this lookout. Errors as above. */
ASDIC_API asdic_status asdic_lookout_detect(asdic_lookout *lookout, const asdic_loop_ping *ping,
                                            asdic_scan_result *found);

#ifdef __cplusplus
}
#endif

#endif
