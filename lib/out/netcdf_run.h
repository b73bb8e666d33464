/*
 * run.nc: a run as netCDF-4. Groups and names are those of the SONAR-netCDF4 convention (Macaulay &
 * Pena, eds., ICES Cooperative Research Report 341, 2018) wherever it has one for what is said. The
 * file does not conform to it and does not claim to: levels are rectangular arrays in dB, where the
 * convention has ragged arrays of samples, and positions are metres from the scene's origin.
 */
#ifndef ASDIC_OUT_NETCDF_RUN_H
#define ASDIC_OUT_NETCDF_RUN_H

#include "record.h"

typedef struct asdic_netcdf asdic_netcdf;

/* What is said once. */
typedef struct asdic_netcdf_about {
    const asdic_sonar *sonar;
    double sound_speed_mps, absorption_db_per_km; /* at the first ping's depth */
    size_t pings, bins;
    const char *scene_name, *scene_hash, *version;
    uint64_t seed;
} asdic_netcdf_about;

/* Whether the library was built with netCDF. */
bool asdic_netcdf_available(void);

/* ASDIC_ERROR_UNSUPPORTED without netCDF. */
asdic_status asdic_netcdf_create(asdic_context *ctx, const char *path,
                                 const asdic_netcdf_about *about, asdic_netcdf **out);

/* The next ping. */
asdic_status asdic_netcdf_add(asdic_netcdf *file, const asdic_record *record);

/* Completes the file and gives it its name; *FILE becomes NULL either way. */
asdic_status asdic_netcdf_commit(asdic_netcdf **file);

/* Removes what was written. NULL-safe. */
void asdic_netcdf_discard(asdic_netcdf **file);

#endif
