/*
 * A netCDF-4 file that appears complete or not at all. Calls after a failure do nothing, so that a
 * file can be described without a check after each line; the end reports the failure.
 *
 * After a failed write HDF5 1.10.8 crashes when the file is closed or aborted, and otherwise at the end of the
 * process, when it flushes what is left. A file that failed is therefore never touched again, and its process
 * must end by _exit() (format.h).
 */
#ifndef ASDIC_OUT_NETCDF_FILE_H
#define ASDIC_OUT_NETCDF_FILE_H

#include <asdic/context.h>

#include <netcdf.h>

/* netCDF's functions, found when a file is made: the library loads forty others, which a run
 * without this file need not wait for. */
#define ASDIC_NC_FUNCTIONS(X)                                                                      \
    X(close)                                                                                       \
    X(create)                                                                                      \
    X(def_dim)                                                                                     \
    X(def_grp)                                                                                     \
    X(def_var)                                                                                     \
    X(def_var_chunking)                                                                            \
    X(def_var_deflate)                                                                             \
    X(def_var_fill)                                                                                \
    X(put_att_text)                                                                                \
    X(put_var1_string)                                                                             \
    X(put_var_double)                                                                              \
    X(put_vara)                                                                                    \
    X(put_vara_double)                                                                             \
    X(put_vara_float)                                                                              \
    X(put_vara_ulonglong)                                                                          \
    X(set_var_chunk_cache)                                                                         \
    X(strerror)

typedef struct asdic_nc_functions {
#define MEMBER(name) __typeof__(nc_##name) *name;
    ASDIC_NC_FUNCTIONS(MEMBER)
#undef MEMBER
} asdic_nc_functions;

typedef struct asdic_nc {
    asdic_context *ctx;
    asdic_nc_functions call;
    char *path, *part;
    int folder; /* stays open where netCDF would misread its name; 0: none */
    int id;
    int failure; /* NC_NOERR, or the first that failed */
} asdic_nc;

/* A dimension or variable that could not be made is -1. */
typedef struct asdic_nc_attribute {
    const char *name, *value; /* text; NULL ends a list */
} asdic_nc_attribute;

/* Why no file can be made, and what to do; NULL: it can. */
const char *asdic_nc_missing(void);

asdic_status asdic_nc_create(asdic_context *ctx, const char *path, asdic_nc *out);

/* Keeps the first failure; true while there is none. */
bool asdic_nc_check(asdic_nc *nc, int code);

int asdic_nc_group(asdic_nc *nc, int parent, const char *name);
int asdic_nc_dimension(asdic_nc *nc, int group, const char *name, size_t length);
void asdic_nc_texts(asdic_nc *nc, int group, int variable, const asdic_nc_attribute *attributes);
int asdic_nc_variable(asdic_nc *nc, int group, const char *name, nc_type type, int rank,
                      const int *dimensions, const char *long_name, const char *units);

/* ASDIC_ERROR_IO with the first failure's reason. */
asdic_status asdic_nc_status(const asdic_nc *nc);

/* Closes; renames unless something failed. */
asdic_status asdic_nc_commit(asdic_nc *nc);

/* Removes the file; what the library holds of it remains, see above. Safe on zeros and after commit. */
void asdic_nc_discard(asdic_nc *nc);

#endif
