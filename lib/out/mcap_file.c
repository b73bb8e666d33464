#include "mcap_file.h"

#include "base/context.h"
#include "base/try.h"
#include "file.h"

#include <asdic/common.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* A chunk is written when it has grown to this. */
#define CHUNK_BYTES ((size_t)4 << 20)

enum {
    OP_HEADER = 1,
    OP_FOOTER,
    OP_SCHEMA,
    OP_CHANNEL,
    OP_MESSAGE,
    OP_CHUNK,
    OP_MESSAGE_INDEX,
    OP_CHUNK_INDEX,
    OP_STATISTICS = 0x0B,
    OP_METADATA,
    OP_METADATA_INDEX,
    OP_SUMMARY_OFFSET,
    OP_DATA_END
};
static const uint8_t magic[8] = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

/* Of a channel's messages in the chunk at hand: time and place, both 64 bits. */
typedef struct entry {
    uint64_t time_ns, offset;
} entry;

typedef struct channel {
    const asdic_ros_type *type;
    char topic[64];
    uint64_t messages;
    asdic_bytes entries; /* of the chunk at hand */
    uint64_t index_at;   /* where the index of the last chunk lies; 0: it has none */
} channel;

struct asdic_mcap {
    asdic_context *ctx;
    char *path;
    asdic_file *file;
    uint64_t at;  /* bytes written */
    uint32_t sum; /* of them; of the summary from its beginning */
    channel channels[ASDIC_MCAP_CHANNELS];
    size_t channel_count;
    asdic_bytes record, chunk, chunk_indexes;
    uint64_t chunks, first_ns, last_ns;                  /* of the file */
    uint64_t chunk_messages, chunk_from_ns, chunk_to_ns; /* of the chunk at hand */
    uint64_t metadata_at, metadata_bytes;
    char name[32];
};

/* --- values ----------------------------------------------------------------------------------- */

static void put_16(asdic_bytes *out, uint16_t value) {
    asdic_bytes_add(out, &value, sizeof value);
}
static void put_32(asdic_bytes *out, uint32_t value) {
    asdic_bytes_add(out, &value, sizeof value);
}
static void put_64(asdic_bytes *out, uint64_t value) {
    asdic_bytes_add(out, &value, sizeof value);
}
static void put_text(asdic_bytes *out, const char *text) {
    put_32(out, (uint32_t)strlen(text));
    asdic_bytes_add(out, text, strlen(text));
}

/* A record's code and the place of its length, which end_record fills in. */
static size_t begin_record(asdic_bytes *out, uint8_t code) {
    asdic_bytes_add(out, &code, 1);
    put_64(out, 0);
    return out->size;
}

/* FOLLOWING: bytes of the record that are written after these. */
static void end_part(asdic_bytes *out, size_t began, uint64_t following) {
    uint64_t length = out->size - began + following;
    if (!out->failed) {
        memcpy(out->bytes + began - sizeof length, &length, sizeof length);
    }
}

static void end_record(asdic_bytes *out, size_t began) {
    end_part(out, began, 0);
}

/* The same for a list, whose length has 32 bits. */
static size_t begin_list(asdic_bytes *out) {
    put_32(out, 0);
    return out->size;
}

static void end_list(asdic_bytes *out, size_t began) {
    uint32_t length = (uint32_t)(out->size - began);
    if (!out->failed) {
        memcpy(out->bytes + began - sizeof length, &length, sizeof length);
    }
}

/* --- the file --------------------------------------------------------------------------------- */

static void write_bytes(asdic_mcap *m, const void *bytes, size_t size) {
    fwrite(bytes, 1, size, asdic_file_stream(m->file));
    m->sum = (uint32_t)crc32_z(m->sum, bytes, size);
    m->at += size;
}

/* RECORD, as it was begun and ended, and makes it empty. */
static asdic_status write_record(asdic_mcap *m, asdic_bytes *record) {
    if (record->failed) {
        return asdic_fail_memory(m->ctx, "an MCAP file");
    }
    write_bytes(m, record->bytes, record->size);
    record->size = 0;
    return ferror(asdic_file_stream(m->file)) ? asdic_file_fail(m->ctx, m->path, errno) : ASDIC_OK;
}

static asdic_status begin_file(asdic_mcap *m, const char *const *facts) {
    asdic_bytes *r = &m->record;
    char library[32];
    snprintf(library, sizeof library, "asdic %s", asdic_version());
    write_bytes(m, magic, sizeof magic);
    size_t began = begin_record(r, OP_HEADER);
    put_text(r, "ros2");
    put_text(r, library);
    end_record(r, began);
    TRY(write_record(m, r));
    began = begin_record(r, OP_METADATA);
    put_text(r, m->name);
    size_t list = begin_list(r);
    for (size_t i = 0; facts[i]; i++) {
        put_text(r, facts[i]);
    }
    end_list(r, list);
    end_record(r, began);
    m->metadata_at = m->at;
    m->metadata_bytes = r->size;
    return write_record(m, r);
}

asdic_status asdic_mcap_create(asdic_context *ctx, const char *path, const char *name,
                               const char *const *facts, asdic_mcap **out) {
    asdic_mcap *m = *out = calloc(1, sizeof *m);
    if (!m || !(m->path = strdup(path))) {
        asdic_mcap_discard(out);
        return asdic_fail_memory(ctx, "an MCAP file");
    }
    m->ctx = ctx;
    m->first_ns = UINT64_MAX;
    snprintf(m->name, sizeof m->name, "%s", name);
    asdic_status status = asdic_file_create(ctx, path, &m->file);
    status = status ? status : begin_file(m, facts);
    if (status) {
        asdic_mcap_discard(out);
    }
    return status;
}

/* A schema and the channel of it, both by the channel's number; schemas count from 1. */
static void put_channel(const asdic_mcap *m, asdic_bytes *out, size_t number) {
    const channel *c = &m->channels[number];
    size_t began = begin_record(out, OP_CHANNEL);
    put_16(out, (uint16_t)number);
    put_16(out, (uint16_t)(number + 1));
    put_text(out, c->topic);
    put_text(out, "cdr");
    put_32(out, 0);
    end_record(out, began);
}

static void put_schema(const asdic_mcap *m, asdic_bytes *out, size_t number) {
    const asdic_ros_type *type = m->channels[number].type;
    size_t began = begin_record(out, OP_SCHEMA);
    put_16(out, (uint16_t)(number + 1));
    put_text(out, type->name);
    put_text(out, "ros2msg");
    put_text(out, type->schema);
    end_record(out, began);
}

size_t asdic_mcap_channel(asdic_mcap *m, const char *topic, const asdic_ros_type *type) {
    channel *c = &m->channels[m->channel_count];
    c->type = type;
    snprintf(c->topic, sizeof c->topic, "%s", topic);
    return m->channel_count++;
}

/* --- chunks ----------------------------------------------------------------------------------- */

static void put_message_index(asdic_bytes *out, size_t number, const channel *c) {
    size_t began = begin_record(out, OP_MESSAGE_INDEX);
    put_16(out, (uint16_t)number);
    put_32(out, (uint32_t)c->entries.size);
    asdic_bytes_add(out, c->entries.bytes, c->entries.size);
    end_record(out, began);
}

/* What of the summary says where the chunk lies that was just written. */
static void put_chunk_index(asdic_mcap *m, uint64_t chunk_at, uint64_t indexes_at, size_t bytes) {
    asdic_bytes *out = &m->chunk_indexes;
    size_t began = begin_record(out, OP_CHUNK_INDEX);
    put_64(out, m->chunk_from_ns);
    put_64(out, m->chunk_to_ns);
    put_64(out, chunk_at);
    put_64(out, indexes_at - chunk_at);
    size_t list = begin_list(out);
    for (size_t i = 0; i < m->channel_count; i++) {
        if (m->channels[i].index_at) {
            put_16(out, (uint16_t)i);
            put_64(out, m->channels[i].index_at);
        }
    }
    end_list(out, list);
    put_64(out, m->at - indexes_at);
    put_text(out, "");
    put_64(out, bytes);
    put_64(out, bytes);
    end_record(out, began);
}

static asdic_status write_message_indexes(asdic_mcap *m) {
    for (size_t i = 0; i < m->channel_count; i++) {
        channel *c = &m->channels[i];
        c->index_at = 0;
        if (c->entries.failed) {
            return asdic_fail_memory(m->ctx, "an MCAP file");
        }
        if (c->entries.size) {
            c->index_at = m->at;
            put_message_index(&m->record, i, c);
            TRY(write_record(m, &m->record));
            c->entries.size = 0;
        }
    }
    return ASDIC_OK;
}

static asdic_status write_chunk(asdic_mcap *m) {
    asdic_bytes *r = &m->record;
    uint64_t chunk_at = m->at, bytes = m->chunk.size;
    if (m->chunk.failed) {
        return asdic_fail_memory(m->ctx, "an MCAP file");
    }
    size_t began = begin_record(r, OP_CHUNK);
    put_64(r, m->chunk_from_ns);
    put_64(r, m->chunk_to_ns);
    put_64(r, bytes);
    put_32(r, (uint32_t)crc32_z(0, m->chunk.bytes, bytes));
    put_text(r, "");
    put_64(r, bytes);
    end_part(r, began, bytes); /* the messages are not copied */
    TRY(write_record(m, r));
    TRY(write_record(m, &m->chunk));
    uint64_t indexes_at = m->at;
    TRY(write_message_indexes(m));
    put_chunk_index(m, chunk_at, indexes_at, bytes);
    m->chunks++;
    m->chunk_messages = 0;
    return ASDIC_OK;
}

/* Schemas and channels stand before their first messages, in the first chunk. */
static void put_channels(asdic_mcap *m) {
    for (size_t i = 0; i < m->channel_count; i++) {
        put_schema(m, &m->chunk, i);
        put_channel(m, &m->chunk, i);
    }
}

static uint64_t least(uint64_t a, uint64_t b) {
    return a < b ? a : b;
}

static uint64_t most(uint64_t a, uint64_t b) {
    return a > b ? a : b;
}

asdic_status asdic_mcap_message(asdic_mcap *m, size_t number, int64_t signed_ns, const void *bytes,
                                size_t size) {
    channel *c = &m->channels[number];
    uint64_t time_ns = signed_ns < 0 ? 0 : (uint64_t)signed_ns;
    if (m->chunks == 0 && m->chunk.size == 0) {
        put_channels(m);
    }
    const entry here = {time_ns, m->chunk.size};
    size_t began = begin_record(&m->chunk, OP_MESSAGE);
    put_16(&m->chunk, (uint16_t)number);
    put_32(&m->chunk, (uint32_t)c->messages++);
    put_64(&m->chunk, time_ns);
    put_64(&m->chunk, time_ns);
    asdic_bytes_add(&m->chunk, bytes, size);
    end_record(&m->chunk, began);
    asdic_bytes_add(&c->entries, &here, sizeof here);
    m->chunk_from_ns = m->chunk_messages++ ? least(m->chunk_from_ns, time_ns) : time_ns;
    m->chunk_to_ns = m->chunk_messages > 1 ? most(m->chunk_to_ns, time_ns) : time_ns;
    m->first_ns = least(m->first_ns, time_ns);
    m->last_ns = most(m->last_ns, time_ns);
    return m->chunk.size >= CHUNK_BYTES ? write_chunk(m) : ASDIC_OK;
}

/* --- the summary ------------------------------------------------------------------------------ */

static void put_statistics(const asdic_mcap *m, asdic_bytes *out) {
    uint64_t messages = 0;
    for (size_t i = 0; i < m->channel_count; i++) {
        messages += m->channels[i].messages;
    }
    size_t began = begin_record(out, OP_STATISTICS);
    put_64(out, messages);
    put_16(out, (uint16_t)m->channel_count);
    put_32(out, (uint32_t)m->channel_count);
    put_32(out, 0); /* attachments */
    put_32(out, 1); /* metadata */
    put_32(out, (uint32_t)m->chunks);
    put_64(out, messages ? m->first_ns : 0);
    put_64(out, m->last_ns);
    size_t list = begin_list(out);
    for (size_t i = 0; i < m->channel_count; i++) {
        put_16(out, (uint16_t)i);
        put_64(out, m->channels[i].messages);
    }
    end_list(out, list);
    end_record(out, began);
}

static void put_metadata_index(const asdic_mcap *m, asdic_bytes *out) {
    size_t began = begin_record(out, OP_METADATA_INDEX);
    put_64(out, m->metadata_at);
    put_64(out, m->metadata_bytes);
    put_text(out, m->name);
    end_record(out, began);
}

/* Records of one code, and in OFFSETS where they lie. */
static asdic_status write_group(asdic_mcap *m, uint8_t code, asdic_bytes *records,
                                asdic_bytes *offsets) {
    if (records->size == 0 && !records->failed) {
        return ASDIC_OK;
    }
    size_t began = begin_record(offsets, OP_SUMMARY_OFFSET);
    asdic_bytes_add(offsets, &code, 1);
    put_64(offsets, m->at);
    put_64(offsets, records->size);
    end_record(offsets, began);
    return write_record(m, records);
}

static asdic_status write_groups(asdic_mcap *m, asdic_bytes *offsets) {
    asdic_bytes *r = &m->record;
    for (size_t i = 0; i < m->channel_count; i++) {
        put_schema(m, r, i);
    }
    TRY(write_group(m, OP_SCHEMA, r, offsets));
    for (size_t i = 0; i < m->channel_count; i++) {
        put_channel(m, r, i);
    }
    TRY(write_group(m, OP_CHANNEL, r, offsets));
    put_statistics(m, r);
    TRY(write_group(m, OP_STATISTICS, r, offsets));
    TRY(write_group(m, OP_CHUNK_INDEX, &m->chunk_indexes, offsets));
    put_metadata_index(m, r);
    return write_group(m, OP_METADATA_INDEX, r, offsets);
}

/* The footer's own sum is of all from the summary on, up to where the sum stands. */
static asdic_status write_summary(asdic_mcap *m, asdic_bytes *offsets) {
    asdic_bytes *r = &m->record;
    size_t began = begin_record(r, OP_DATA_END);
    put_32(r, m->sum);
    end_record(r, began);
    TRY(write_record(m, r));
    uint64_t summary_at = m->at;
    m->sum = 0;
    TRY(write_groups(m, offsets));
    uint64_t offsets_at = m->at;
    TRY(write_record(m, offsets));
    began = begin_record(r, OP_FOOTER);
    put_64(r, summary_at);
    put_64(r, offsets_at);
    end_part(r, began, sizeof m->sum);
    TRY(write_record(m, r));
    uint32_t sum = m->sum;
    write_bytes(m, &sum, sizeof sum);
    write_bytes(m, magic, sizeof magic);
    return ASDIC_OK;
}

asdic_status asdic_mcap_commit(asdic_mcap **mcap) {
    asdic_mcap *m = *mcap;
    asdic_bytes offsets = {0};
    if (m->chunks == 0 && m->chunk.size == 0) {
        put_channels(m);
    }
    asdic_status status = m->chunk.size ? write_chunk(m) : ASDIC_OK;
    status = status ? status : write_summary(m, &offsets);
    status = status ? status : asdic_file_commit(&m->file);
    asdic_bytes_finish(&offsets);
    asdic_mcap_discard(mcap);
    return status;
}

void asdic_mcap_discard(asdic_mcap **mcap) {
    asdic_mcap *m = *mcap;
    if (m) {
        asdic_file_discard(&m->file);
        for (size_t i = 0; i < m->channel_count; i++) {
            asdic_bytes_finish(&m->channels[i].entries);
        }
        asdic_bytes_finish(&m->record);
        asdic_bytes_finish(&m->chunk);
        asdic_bytes_finish(&m->chunk_indexes);
        free(m->path);
        free(m);
        *mcap = NULL;
    }
}
