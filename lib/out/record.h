/*
 * A ping as it is stored: how asdic_record lies in pings.npy.
 */
#ifndef ASDIC_OUT_RECORD_H
#define ASDIC_OUT_RECORD_H

#include <asdic/run.h>

/* Level of each component, then the standard error. */
#define ASDIC_RECORD_ARRAYS (ASDIC_COMPONENT_COUNT + 1)

/* "level_db" ... "stderr_db": the columns of bins.csv. */
extern const char *const asdic_record_names[ASDIC_RECORD_ARRAYS];

/* Little-endian, packed, as NPY wants it; the arrays follow, each float32 [beam, bin], and the
 * CRC-32 of all before it. */
typedef struct asdic_record_head {
    uint64_t ping;
    double time_s;
    double position_m[3];   /* north, east, down */
    double attitude_rad[3]; /* roll, pitch, yaw */
    double altitude_m;
    uint64_t rays, saturated;
} asdic_record_head;

size_t asdic_record_bytes(size_t beams, size_t bins);

/* The NumPy dtype of a record: "[('ping', '<u8'), ...]". */
#define ASDIC_RECORD_DTYPE_SIZE 768
void asdic_record_dtype(char text[ASDIC_RECORD_DTYPE_SIZE], size_t beams, size_t bins);

/* Fills BYTES (asdic_record_bytes, aligned for double) from a ping. */
void asdic_record_pack(const asdic_record_head *head, const asdic_ping *ping, void *bytes);

/* Whether BYTES are the record of PING as it was packed. */
bool asdic_record_is_whole(const void *bytes, size_t record_bytes, uint64_t ping);

/* Points RECORD into BYTES. */
void asdic_record_view(const void *bytes, size_t beams, size_t bins, asdic_record *record);

#endif
