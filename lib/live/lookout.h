/*
 * What a lookout keeps, so that it may go on from mission to mission.
 */
#ifndef ASDIC_LIVE_LOOKOUT_H
#define ASDIC_LIVE_LOOKOUT_H

#include "mission/mission.h"

#include <asdic/lookout.h>

#define ASDIC_LOOKOUT_PLACES 1024

/* Levels expected at a place. */
typedef struct lookout_place {
    asdic_expected_place place;
    double *total_lin, *noise_lin; /* NULL: not computed yet */
} lookout_place;

struct asdic_lookout {
    asdic_context *ctx;
    const asdic_mission *mission;
    asdic_scan *scan; /* kept from mission to mission with what it is made for: */
    bool scan_is_flat;
    asdic_cfar_kind scan_cfar;
    asdic_detector scan_detector;
    bool is_flat; /* a bin is compared with what is expected */
    bool tells;   /* at the next decision, how bins are judged */
    struct asdic_ring_shelf *shelf;
    size_t shelf_attitudes;
    asdic_ping *scratch;
    /* Expected levels, kept from mission to mission as long as water and sonar stay the same. */
    lookout_place places[ASDIC_LOOKOUT_PLACES];
    size_t place_count;
    asdic_environment environment;
    asdic_sonar sonar;             /* with receivers of its own */
    size_t bins, known;            /* of a beam; of these, what is expected in the first */
    double *total_lin, *noise_lin; /* of a ping, NAN behind those */
};

/* What makes figures other than they seem; of several missions each is told once. */
enum { ASDIC_LOOKOUT_SPIKES, ASDIC_LOOKOUT_MIRRORS, ASDIC_LOOKOUT_WARNINGS };

/* Whether bins are held against what is expected over a plane; else against their neighbours. */
bool asdic_lookout_is_flat(const asdic_mission *mission);

void asdic_lookout_warn(asdic_context *ctx, const asdic_mission *mission,
                        bool told[ASDIC_LOOKOUT_WARNINGS]);

/* LOOKOUT is zero but for ctx at first; the next mission opens it again. Nothing is detected beyond
 * REACH_M where levels are compared with what is expected, since to expect them takes longer than to
 * simulate them. */
asdic_status asdic_lookout_open(asdic_lookout *lookout, const asdic_mission *mission, size_t bins,
                                double reach_m);

/* Safe on zeros. */
void asdic_lookout_finish(asdic_lookout *lookout);

#endif
