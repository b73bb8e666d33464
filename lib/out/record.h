/*
 * A ping as it is stored: how asdic_record lies in pings.npy and truth.npy.
 */
#ifndef ASDIC_OUT_RECORD_H
#define ASDIC_OUT_RECORD_H

#include <asdic/run.h>

/* Level of each component, then the standard error. */
#define ASDIC_RECORD_ARRAYS (ASDIC_COMPONENT_COUNT + 1)

/* "level_db" ... "stderr_db": the columns of bins.csv. */
extern const char *const asdic_record_names[ASDIC_RECORD_ARRAYS];

/* The numbers before a record's levels; little-endian, packed. */
typedef struct asdic_record_head {
    uint64_t ping;
    double time_s;
    double position_m[3];   /* north, east, down */
    double attitude_rad[3]; /* roll, pitch, yaw */
    double altitude_m;
    uint64_t rays, saturated;
} asdic_record_head;

/* What of a ping's truth is kept, in its order. */
typedef struct asdic_truth_field {
    const char *name, *type; /* as NumPy has it */
    size_t width;            /* bytes */
} asdic_truth_field;

#define ASDIC_TRUTH_FIELDS (ASDIC_PATH_COUNT + 5)
/* Bytes of a bin's. */
#define ASDIC_TRUTH_BYTES (2 * sizeof(int16_t) + (ASDIC_PATH_COUNT + 3) * sizeof(float))
extern const asdic_truth_field asdic_truth_fields[ASDIC_TRUTH_FIELDS];

/* The array of FIELD; NULL where TRUTH has none. */
const void *asdic_truth_values(const asdic_ping_truth *truth, size_t field);

/* In memory: the head, the arrays, each float32 [beam, bin], whether truth follows, and room for that
 * and sums. */
size_t asdic_record_bytes(size_t beams, size_t bins);

/* Fills BYTES (asdic_record_bytes, aligned for double) from a ping. */
void asdic_record_pack(const asdic_record_head *head, const asdic_ping *ping, void *bytes);

/* The same from a record, as asdic_record_view finds it. */
void asdic_record_copy(const asdic_record *record, size_t beams, size_t bins, void *bytes);

/* Points RECORD into BYTES. */
void asdic_record_view(const void *bytes, size_t beams, size_t bins, asdic_record *record);

/* What of it is stored. */
typedef enum asdic_record_form {
    ASDIC_RECORD_FULL,    /* all, as it lies in memory */
    ASDIC_RECORD_COMPACT, /* levels in float32; PARTS and errors in float16 */
    ASDIC_RECORD_LEVELS,  /* the same without parts */
} asdic_record_form;

typedef struct asdic_record_layout {
    size_t beams, bins;
    asdic_record_form form;
    bool truth;
    unsigned parts; /* 1u << asdic_component; what has energy in no ping need not be among them */
} asdic_record_layout;

/* In pings.npy: the head, the arrays, and the CRC-32 of all before it; packed. */
size_t asdic_record_stored_bytes(const asdic_record_layout *layout);
/* In truth.npy: the ping's number, the fields, and their CRC-32; packed. 0: no truth. */
size_t asdic_record_truth_bytes(const asdic_record_layout *layout);

/* The NumPy dtypes: "[('ping', '<u8'), ...]". */
#define ASDIC_RECORD_DTYPE_SIZE 1536
void asdic_record_dtype(char text[ASDIC_RECORD_DTYPE_SIZE], const asdic_record_layout *layout);
void asdic_record_truth_dtype(char text[ASDIC_RECORD_DTYPE_SIZE],
                              const asdic_record_layout *layout);

/* From memory, BYTES, to the form in pings.npy, and back: what is not stored is NAN then. In the form
 * ASDIC_RECORD_FULL levels lie in memory as they do in the file, and STORED is BYTES. */
void asdic_record_store(const asdic_record_layout *layout, const void *bytes, void *stored);
void asdic_record_restore(const asdic_record_layout *layout, const void *stored, void *bytes);

/* Where truth lies in BYTES, as it does in the file; and the same with number and sum put in. */
void *asdic_record_truth(const asdic_record_layout *layout, void *bytes);
const void *asdic_record_store_truth(const asdic_record_layout *layout, void *bytes);

/* Whether STORED is the record of PING as it was made. */
bool asdic_record_is_whole(const void *stored, size_t stored_bytes, uint64_t ping);

#endif
