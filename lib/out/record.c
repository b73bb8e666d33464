#include "record.h"

#include "base/decibel.h"
#include "half.h"

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

const asdic_truth_field asdic_truth_fields[ASDIC_TRUTH_FIELDS] = {
    {"strongest", "<i2", sizeof(int16_t)}, {"object", "<i2", sizeof(int16_t)},
    {"share", "<f4", sizeof(float)},       {"object_share", "<f4", sizeof(float)},
    {"direct", "<f4", sizeof(float)},      {"by_surface", "<f4", sizeof(float)},
    {"by_bottom", "<f4", sizeof(float)},   {"by_object", "<f4", sizeof(float)},
    {"noise", "<f4", sizeof(float)},       {"depression_rad", "<f4", sizeof(float)},
};

const void *asdic_truth_values(const asdic_ping_truth *truth, size_t field) {
    const void *const values[ASDIC_TRUTH_FIELDS] = {truth->strongest,
                                                    truth->object,
                                                    truth->share,
                                                    truth->object_share,
                                                    truth->path[ASDIC_PATH_DIRECT],
                                                    truth->path[ASDIC_PATH_BY_SURFACE],
                                                    truth->path[ASDIC_PATH_BY_BOTTOM],
                                                    truth->path[ASDIC_PATH_BY_OBJECT],
                                                    truth->path[ASDIC_PATH_NOISE],
                                                    truth->depression_rad};
    return values[field];
}

/* Bytes of a record in memory before its truth: head, arrays, their sum; the last eight say whether there is
 * truth. */
static size_t levels_bytes(size_t cells) {
    size_t bytes = sizeof(asdic_record_head) + ASDIC_RECORD_ARRAYS * cells * sizeof(float);
    return (bytes + sizeof(uint32_t) + 7) / 8 * 8 + sizeof(uint64_t);
}

static uint64_t *truth_mark(const void *bytes, size_t cells) {
    return (uint64_t *)(uintptr_t)((const char *)bytes + levels_bytes(cells)) - 1;
}

/* As it lies in the file: the ping's number, the fields, their sum. */
static char *truth_of(const void *bytes, size_t cells) {
    return (char *)(uintptr_t)bytes + levels_bytes(cells);
}

static size_t truth_bytes(size_t cells) {
    return sizeof(uint64_t) + cells * ASDIC_TRUTH_BYTES + sizeof(uint32_t);
}

size_t asdic_record_bytes(size_t beams, size_t bins) {
    return levels_bytes(beams * bins) + truth_bytes(beams * bins);
}

/* Bytes of a number of ARRAY in the file; 0: not stored. */
static size_t width_of(const asdic_record_layout *layout, int array) {
    if (layout->form == ASDIC_RECORD_FULL || array == ASDIC_TOTAL) {
        return sizeof(float);
    }
    bool is_part = array < ASDIC_COMPONENT_COUNT;
    bool is_kept = layout->form == ASDIC_RECORD_COMPACT && layout->parts & 1u << array;
    return !is_part || is_kept ? sizeof(uint16_t) : 0;
}

size_t asdic_record_stored_bytes(const asdic_record_layout *layout) {
    size_t each = 0;
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        each += width_of(layout, i);
    }
    return sizeof(asdic_record_head) + layout->beams * layout->bins * each + sizeof(uint32_t);
}

size_t asdic_record_truth_bytes(const asdic_record_layout *layout) {
    return layout->truth ? truth_bytes(layout->beams * layout->bins) : 0;
}

void asdic_record_dtype(char text[ASDIC_RECORD_DTYPE_SIZE], const asdic_record_layout *layout) {
    int used = snprintf(text, ASDIC_RECORD_DTYPE_SIZE,
                        "[('ping', '<u8'), ('time_s', '<f8'), ('position_m', '<f8', (3,)), "
                        "('attitude_rad', '<f8', (3,)), ('altitude_m', '<f8'), ('rays', '<u8'), "
                        "('saturated', '<u8')");
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++) {
        size_t width = width_of(layout, i);
        if (width > 0) {
            used += snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used,
                             ", ('%s', '<f%zu', (%zu, %zu))", asdic_record_names[i], width,
                             layout->beams, layout->bins);
        }
    }
    snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used, ", ('crc32', '<u4')]");
}

void asdic_record_truth_dtype(char text[ASDIC_RECORD_DTYPE_SIZE],
                              const asdic_record_layout *layout) {
    int used = snprintf(text, ASDIC_RECORD_DTYPE_SIZE, "[('ping', '<u8')");
    for (size_t i = 0; i < ASDIC_TRUTH_FIELDS; i++) {
        used += snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used,
                         ", ('%s', '%s', (%zu, %zu))", asdic_truth_fields[i].name,
                         asdic_truth_fields[i].type, layout->beams, layout->bins);
    }
    snprintf(text + used, ASDIC_RECORD_DTYPE_SIZE - (size_t)used, ", ('crc32', '<u4')]");
}

/* zlib's sum of all that stands before it. */
static uint32_t sum_of(const void *stored, size_t stored_bytes) {
    return (uint32_t)crc32_z(0, stored, stored_bytes - sizeof(uint32_t));
}

bool asdic_record_is_whole(const void *stored, size_t stored_bytes, uint64_t ping) {
    uint64_t number;
    uint32_t sum;
    memcpy(&number, stored, sizeof number);
    memcpy(&sum, (const char *)stored + stored_bytes - sizeof sum, sizeof sum);
    return number == ping && sum == sum_of(stored, stored_bytes);
}

/* Puts the sum behind the rest of STORED. */
static void seal(void *stored, size_t stored_bytes) {
    uint32_t sum = sum_of(stored, stored_bytes);
    memcpy((char *)stored + stored_bytes - sizeof sum, &sum, sizeof sum);
}

/* A whole record to the arrays that LAYOUT keeps, in their widths. */
static void shorten(const asdic_record_layout *layout, const void *bytes, void *stored) {
    size_t cells = layout->beams * layout->bins;
    const float *from =
        (const float *)(const void *)((const char *)bytes + sizeof(asdic_record_head));
    char *to = (char *)stored + sizeof(asdic_record_head);
    memcpy(stored, bytes, sizeof(asdic_record_head));
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++, from += cells) {
        size_t width = width_of(layout, i);
        if (width == sizeof(float)) {
            memcpy(to, from, cells * sizeof *from);
        }
        if (width == sizeof(uint16_t)) {
            asdic_halves_of(from, cells, (uint16_t *)(void *)to);
        }
        to += cells * width;
    }
}

void asdic_record_store(const asdic_record_layout *layout, const void *bytes, void *stored) {
    if (layout->form != ASDIC_RECORD_FULL) {
        shorten(layout, bytes, stored);
    }
    seal(stored, asdic_record_stored_bytes(layout));
}

void asdic_record_restore(const asdic_record_layout *layout, const void *stored, void *bytes) {
    size_t cells = layout->beams * layout->bins;
    const char *from = (const char *)stored + sizeof(asdic_record_head);
    float *to = (float *)(void *)((char *)bytes + sizeof(asdic_record_head));
    *truth_mark(bytes, cells) = layout->truth;
    if (layout->form == ASDIC_RECORD_FULL) {
        return;
    }
    memcpy(bytes, stored, sizeof(asdic_record_head));
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++, to += cells) {
        size_t width = width_of(layout, i);
        if (width == sizeof(float)) {
            memcpy(to, from, cells * sizeof *to);
        }
        if (width == sizeof(uint16_t)) {
            asdic_half_values((const uint16_t *)(const void *)from, cells, to);
        }
        for (size_t k = 0; k < cells && width == 0; k++) {
            to[k] = NAN;
        }
        from += cells * width;
    }
}

void *asdic_record_truth(const asdic_record_layout *layout, void *bytes) {
    return truth_of(bytes, layout->beams * layout->bins);
}

const void *asdic_record_store_truth(const asdic_record_layout *layout, void *bytes) {
    void *stored = asdic_record_truth(layout, bytes);
    memcpy(stored, bytes, sizeof(uint64_t)); /* the ping's number */
    seal(stored, asdic_record_truth_bytes(layout));
    return stored;
}

/* Behind the levels; NULL: no truth. */
static void put_truth(const asdic_ping_truth *truth, size_t cells, void *bytes) {
    *truth_mark(bytes, cells) = truth != NULL;
    char *to = truth_of(bytes, cells) + sizeof(uint64_t);
    for (size_t i = 0; truth && i < ASDIC_TRUTH_FIELDS; i++) {
        size_t width = cells * asdic_truth_fields[i].width;
        memcpy(to, asdic_truth_values(truth, i), width);
        to += width;
    }
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
    put_truth(ping->truth, cells, bytes);
}

void asdic_record_copy(const asdic_record *record, size_t beams, size_t bins, void *bytes) {
    const asdic_vec3 *at = &record->pose.position_m;
    const asdic_record_head head = {
        .ping = record->ping,
        .time_s = record->time_s,
        .position_m = {at->x, at->y, at->z},
        .attitude_rad = {record->pose.roll_rad, record->pose.pitch_rad, record->pose.yaw_rad},
        .altitude_m = record->altitude_m,
        .rays = record->rays,
        .saturated = record->saturated};
    size_t cells = beams * bins;
    memcpy(bytes, &head, sizeof head);
    float *out = (float *)(void *)((char *)bytes + sizeof head);
    for (int i = 0; i < ASDIC_RECORD_ARRAYS; i++, out += cells) {
        memcpy(out, i < ASDIC_COMPONENT_COUNT ? record->level_db[i] : record->stderr_db,
               cells * sizeof *out);
    }
    put_truth(record->truth.share ? &record->truth : NULL, cells, bytes);
}

/* Points TRUTH to the fields that lie behind FROM. */
static void view_truth(const char *from, size_t cells, asdic_ping_truth *truth) {
    float *values = (float *)(void *)(uintptr_t)(from + 2 * cells * sizeof(int16_t));
    *truth = (asdic_ping_truth){.strongest = (int16_t *)(void *)(uintptr_t)from,
                                .object = (int16_t *)(void *)(uintptr_t)from + cells,
                                .share = values,
                                .object_share = values + cells,
                                .depression_rad = values + (2 + ASDIC_PATH_COUNT) * cells};
    for (size_t p = 0; p < ASDIC_PATH_COUNT; p++) {
        truth->path[p] = values + (2 + p) * cells;
    }
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
    if (*truth_mark(bytes, cells)) {
        view_truth(truth_of(bytes, cells) + sizeof(uint64_t), cells, &record->truth);
    }
}
