#include "record.h"

#include "base/decibel.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <zlib.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "records are written as they lie");
_Static_assert(sizeof(asdic_record_head) == 88, "records are packed");

const char *const asdic_record_names[ASDIC_RECORD_ARRAYS] = {
    [ASDIC_TOTAL] = "level_db",     [ASDIC_BOTTOM] = "bottom_db",
    [ASDIC_SURFACE] = "surface_db", [ASDIC_VOLUME] = "volume_db",
    [ASDIC_OBJECT] = "object_db",   [ASDIC_MULTIPATH] = "multipath_db",
    [ASDIC_NOISE] = "noise_db",     [ASDIC_COMPONENT_COUNT] = "stderr_db",
};

size_t asdic_record_bytes(size_t beams, size_t bins) {
    return sizeof(asdic_record_head) + ASDIC_RECORD_ARRAYS * beams * bins * sizeof(float) +
           sizeof(uint32_t);
}

void asdic_record_dtype(char text[ASDIC_RECORD_DTYPE_SIZE], size_t beams, size_t bins) {
    int used = snprintf(text, ASDIC_RECORD_DTYPE_SIZE,
                        "[('ping', '<u8'), ('time_s', '<f8'), ('position_m', '<f8', (3,)), "
                        "('attitude_rad', '<f8', (3,)), ('altitude_m', '<f8'), ('rays', '<u8'), "
                        "('saturated', '<u8')");
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        used += snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used,
                         ", ('%s', '<f4', (%zu, %zu))", asdic_record_names[i], beams, bins);
    }
    snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used, ", ('crc32', '<u4')]");
}

/* zlib's sum of all that stands before it. */
static uint32_t sum_of(const void *bytes, size_t record_bytes) {
    return (uint32_t)crc32_z(0, bytes, record_bytes - sizeof(uint32_t));
}

bool asdic_record_is_whole(const void *bytes, size_t record_bytes, uint64_t ping) {
    asdic_record_head head;
    uint32_t sum;
    memcpy(&head, bytes, sizeof head);
    memcpy(&sum, (const char *)bytes + record_bytes - sizeof sum, sizeof sum);
    return head.ping == ping && sum == sum_of(bytes, record_bytes);
}

void asdic_record_pack(const asdic_record_head *head, const asdic_ping *ping, void *bytes) {
    size_t cells = ping->beams * ping->bins;
    memcpy(bytes, head, sizeof *head);
    float *out = (float *)(void *)((char *)bytes + sizeof *head);
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        asdic_decibels(ping->intensity_lin[c], cells, out);
        out += cells;
    }
    for (size_t i = 0; i < cells; i++) {
        bool is_known = ping->intensity_lin[ASDIC_TOTAL][i] > 0.0 && isfinite(ping->stderr_db[i]);
        *out++ = is_known ? ping->stderr_db[i] : NAN;
    }
    uint32_t sum = sum_of(bytes, asdic_record_bytes(ping->beams, ping->bins));
    memcpy(out, &sum, sizeof sum);
}

void asdic_record_view(const void *bytes, size_t beams, size_t bins, asdic_record *record) {
    asdic_record_head head;
    size_t cells = beams * bins;
    memcpy(&head, bytes, sizeof head);
    *record = (asdic_record){
        .ping = head.ping,
        .time_s = head.time_s,
        .pose = {.position_m = {head.position_m[0], head.position_m[1], head.position_m[2]},
                 .roll_rad = head.attitude_rad[0],
                 .pitch_rad = head.attitude_rad[1],
                 .yaw_rad = head.attitude_rad[2]},
        .altitude_m = head.altitude_m,
        .rays = head.rays,
        .saturated = head.saturated};
    const float *values = (const float *)(const void *)((const char *)bytes + sizeof head);
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        record->level_db[c] = values + (size_t)c * cells;
    }
    record->stderr_db = values + ASDIC_COMPONENT_COUNT * cells;
}
