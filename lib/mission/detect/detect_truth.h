/*
 * The object that an echo comes from. The run recorded how much energy of each bin comes from
 * objects. Where the scene has several, the one that should be heard loudest in the bin by its scattering law and the
 * beams gives the name. A body hides its own far side, and points behind or in it; what it hides of other bodies counts.
 */
#ifndef ASDIC_MISSION_DETECT_TRUTH_H
#define ASDIC_MISSION_DETECT_TRUTH_H

#include "mission/run/run_open.h"

typedef struct asdic_namer asdic_namer;

/* MISSION, which is borrowed, has the objects' shapes. Where it is NULL objects are all called "object",
 * which is logged. */
asdic_status asdic_namer_create(asdic_run *run, const asdic_mission *mission, asdic_namer **out);
void asdic_namer_destroy(asdic_namer **namer);

/* Names are counted from 0. */
size_t asdic_namer_count(const asdic_namer *namer);
const char *asdic_namer_name(const asdic_namer *namer, size_t index);

/* How far the object's echo may be off by its scattering law, dB; of the one with the most where objects have no
 * names. NAN: not stated. */
double asdic_namer_uncertainty_db(const asdic_namer *namer, size_t index);

/* Before a ping's bins are asked for. */
asdic_status asdic_namer_begin_ping(asdic_namer *namer, const asdic_record *record);

/* The object whose echo BIN of BEAM holds. */
size_t asdic_namer_find(const asdic_namer *namer, size_t beam, size_t bin);

#endif
