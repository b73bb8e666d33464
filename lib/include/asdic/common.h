/*
 * Vocabulary shared by every asdic header: export macro, version, status codes, frames, poses.
 *
 * Frames. World: north-east-down (NED), metres, x north, y east, z down, sea surface at z = 0.
 * Body and sonar: x forward, y starboard, z down. Attitude: yaw about z, then pitch about the new
 * y, then roll about the new x (aerospace order); positive vehicle pitch raises the bow. A *beam*
 * is aimed by yaw (positive to starboard) and pitch, and positive pitch of a beam looks DOWN, as
 * the paper's theta_p does.
 *
 * Units are part of every name: _m _s _hz _khz _mps _kn _rad _deg _db _db_per_km _degc _ppt.
 * Linear quantities of energy or intensity end in _lin.
 */
#ifndef ASDIC_COMMON_H
#define ASDIC_COMMON_H

#include <stddef.h>
#include <stdint.h>
#include <stdbool.h>

#if defined(__GNUC__)
#define ASDIC_API __attribute__((visibility("default")))
#else
#define ASDIC_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define ASDIC_VERSION_MAJOR 0
#define ASDIC_VERSION_MINOR 1
#define ASDIC_VERSION_PATCH 0

/* "0.1.0", of the library that is linked (the macros give the headers' version). */
ASDIC_API const char *asdic_version(void);

typedef enum asdic_status {
    ASDIC_OK = 0,
    ASDIC_ERROR_ARGUMENT = 1,    /* the caller passed something outside the documented domain */
    ASDIC_ERROR_INPUT = 2,       /* an input file is missing, malformed or out of range */
    ASDIC_ERROR_DEVICE = 3,      /* no usable OpenCL device, or its compiler refused the kernels */
    ASDIC_ERROR_DEVICE_LOST = 4, /* a device failed while working */
    ASDIC_ERROR_MEMORY = 5,      /* host or device memory exhausted, or a limit known beforehand */
    ASDIC_ERROR_IO = 6,          /* writing or reading failed half-way */
    ASDIC_ERROR_EXISTS = 7,      /* output exists and neither force nor resume was asked for */
    ASDIC_ERROR_INTERRUPTED = 8, /* stopped on request; what is written is valid */
    ASDIC_ERROR_UNSUPPORTED = 9, /* built, or running, without what was asked for */
} asdic_status;

/* "bad input file" and the like; never NULL. */
ASDIC_API const char *asdic_status_text(asdic_status status);

typedef struct asdic_vec3 {
    double x, y, z;
} asdic_vec3;

/* Where a body is and how it is turned: each number within +-1e7. */
typedef struct asdic_pose {
    asdic_vec3 position_m; /* world, NED */
    double roll_rad, pitch_rad, yaw_rad;
} asdic_pose;

/* How many bytes the character of UTF-8 at TEXT has, of LEFT that may be read: 1 to 4; 0 where none
 * begins, as when LEFT is 0 or TEXT is NULL. RFC 3629: neither overlong forms nor surrogates. Any
 * thread. */
ASDIC_API size_t asdic_utf8_character(const char *text, size_t left);

/* How many bytes the byte-order mark has with which TEXT begins, as spreadsheets write it before
 * UTF-8, of LEFT that may be read: 3, or 0 where there is none. Any thread. */
ASDIC_API size_t asdic_utf8_mark(const char *text, size_t left);

/* Longest name of a beam or object, terminating zero included. */
#define ASDIC_NAME_SIZE 64

#ifdef __cplusplus
}
#endif

#endif
