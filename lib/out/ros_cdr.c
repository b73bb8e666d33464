#include "ros_cdr.h"

#include <stdlib.h>
#include <string.h>

/* What stands before a message: whose first byte says CDR, the second its order; options none. */
#define HEAD_BYTES 4
#define BIG_ENDIAN_CDR 0
#define LITTLE_ENDIAN_CDR 1

void asdic_bytes_add(asdic_bytes *out, const void *bytes, size_t size) {
    if (out->failed || size == 0) {
        return;
    }
    if (size > out->capacity - out->size) {
        size_t capacity = 2 * out->capacity + size;
        uint8_t *more = realloc(out->bytes, capacity);
        if (!more) {
            out->failed = true;
            return;
        }
        out->bytes = more;
        out->capacity = capacity;
    }
    memcpy(out->bytes + out->size, bytes, size);
    out->size += size;
}

void asdic_bytes_finish(asdic_bytes *bytes) {
    free(bytes->bytes);
    *bytes = (asdic_bytes){0};
}

/* Of an item in memory and, but for strings and messages, in CDR. */
static size_t item_bytes(const asdic_ros_field *field) {
    static const size_t bytes[] = {[ASDIC_ROS_BOOL] = sizeof(bool),
                                   [ASDIC_ROS_U8] = 1,
                                   [ASDIC_ROS_I32] = 4,
                                   [ASDIC_ROS_U32] = 4,
                                   [ASDIC_ROS_F32] = sizeof(float),
                                   [ASDIC_ROS_F64] = sizeof(double),
                                   [ASDIC_ROS_STRING] = sizeof(char *)};
    return field->kind == ASDIC_ROS_MESSAGE ? field->type->bytes : bytes[field->kind];
}

/* How far OFFSET, counted behind the head, is from the next multiple of ALIGNMENT, a power of 2. */
static size_t padding(size_t offset, size_t alignment) {
    return (alignment - (offset - HEAD_BYTES)) & (alignment - 1);
}

/* --- writing ---------------------------------------------------------------------------------- */

static void write_numbers(asdic_bytes *out, const void *items, size_t count, size_t size) {
    static const uint8_t zeros[8] = {0};
    if (count > 0) {
        asdic_bytes_add(out, zeros, padding(out->size, size));
        asdic_bytes_add(out, items, count * size);
    }
}

static void write_string(asdic_bytes *out, const char *text) {
    uint32_t size = (uint32_t)strlen(text) + 1; /* with the zero */
    write_numbers(out, &size, 1, sizeof size);
    asdic_bytes_add(out, text, size);
}

static void write_message(asdic_bytes *out, const asdic_ros_type *type, const char *message);

static void write_items(asdic_bytes *out, const asdic_ros_field *field, const char *items,
                        size_t count) {
    size_t size = item_bytes(field);
    if (field->kind < ASDIC_ROS_STRING) {
        write_numbers(out, items, count, size);
        return;
    }
    for (size_t i = 0; i < count; i++, items += size) {
        if (field->kind == ASDIC_ROS_STRING) {
            const char *text;
            memcpy(&text, items, sizeof text);
            write_string(out, text);
        } else {
            write_message(out, field->type, items);
        }
    }
}

static void write_message(asdic_bytes *out, const asdic_ros_type *type, const char *message) {
    for (size_t i = 0; i < type->field_count; i++) {
        const asdic_ros_field *field = &type->fields[i];
        struct {
            const char *items;
            size_t count;
        } sequence = {message + field->offset, field->count};
        if (field->form == ASDIC_ROS_SEQUENCE) {
            memcpy(&sequence, message + field->offset, sizeof sequence);
            uint32_t count = (uint32_t)sequence.count;
            write_numbers(out, &count, 1, sizeof count);
        }
        write_items(out, field, sequence.items, sequence.count);
    }
}

void asdic_ros_write(asdic_bytes *out, const asdic_ros_type *type, const void *message) {
    static const uint8_t head[HEAD_BYTES] = {0, LITTLE_ENDIAN_CDR, 0, 0};
    out->size = 0;
    out->failed = false;
    asdic_bytes_add(out, head, sizeof head);
    write_message(out, type, message);
}

/* --- reading ---------------------------------------------------------------------------------- */

typedef struct reader {
    const uint8_t *bytes;
    size_t size, at;
    bool swaps;
} reader;

static bool read_numbers(reader *in, char *items, size_t count, size_t size) {
    size_t skipped = padding(in->at, size);
    if (in->size - in->at < skipped || (in->size - in->at - skipped) / size < count) {
        return false;
    }
    in->at += skipped;
    for (size_t i = 0; i < count * size; i++) {
        size_t from = in->swaps ? i - i % size + (size - 1 - i % size) : i;
        items[i] = (char)in->bytes[in->at + from];
    }
    in->at += count * size;
    return true;
}

static bool read_string(reader *in, char *item) {
    uint32_t size = 0;
    if (!read_numbers(in, (char *)&size, 1, sizeof size) || size == 0 || in->size - in->at < size ||
        in->bytes[in->at + size - 1] != 0) {
        return false;
    }
    const char *text = (const char *)in->bytes + in->at;
    memcpy(item, &text, sizeof text);
    in->at += size;
    return true;
}

static bool read_message(reader *in, const asdic_ros_type *type, char *message) {
    for (size_t i = 0; i < type->field_count; i++) {
        const asdic_ros_field *field = &type->fields[i];
        char *item = message + field->offset;
        bool good = field->form != ASDIC_ROS_SEQUENCE &&
                    (field->kind == ASDIC_ROS_STRING ? read_string(in, item)
                     : field->kind == ASDIC_ROS_MESSAGE
                         ? read_message(in, field->type, item)
                         : read_numbers(in, item, field->count, item_bytes(field)));
        if (!good) {
            return false;
        }
    }
    return true;
}

bool asdic_ros_read(const asdic_ros_type *type, const void *bytes, size_t size, void *message) {
    reader in = {.bytes = bytes, .size = size, .at = HEAD_BYTES};
    if (size < HEAD_BYTES || in.bytes[0] != 0 || in.bytes[1] > LITTLE_ENDIAN_CDR) {
        return false;
    }
    in.swaps = in.bytes[1] == BIG_ENDIAN_CDR;
    return read_message(&in, type, message);
}
