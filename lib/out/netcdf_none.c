/*
 * A build without netCDF.
 */
#include "netcdf_run.h"

#include "base/context.h"

bool asdic_netcdf_available(void) {
    return false;
}

asdic_status asdic_netcdf_create(asdic_context *ctx, const char *path,
                                 const asdic_netcdf_about *about, asdic_netcdf **out) {
    (void)about;
    *out = NULL;
    return asdic_fail(
        ctx, ASDIC_ERROR_UNSUPPORTED,
        "cannot write '%s': built without netCDF; install libnetcdf-dev and build again", path);
}

asdic_status asdic_netcdf_add(asdic_netcdf *file, const asdic_record *record) {
    (void)file;
    (void)record;
    return ASDIC_ERROR_UNSUPPORTED;
}

asdic_status asdic_netcdf_commit(asdic_netcdf **file) {
    *file = NULL;
    return ASDIC_ERROR_UNSUPPORTED;
}

void asdic_netcdf_discard(asdic_netcdf **file) {
    (void)file;
}
