/*
 * MCAP files byte for byte: records put together here as the specification has them
 * (https://mcap.dev/spec), in one chunk, in two, in none; and what a full disk leaves.
 */
#include "asserts.h"

#include "out/mcap_file.h"

#include <asdic/common.h>

#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#define CHUNK ((size_t)4 << 20) /* bytes at which a chunk ends */
#define ROOM (CHUNK + (1 << 16))

static asdic_context *ctx;
static char folder[] = "/tmp/asdic-mcap-XXXXXX";
static char name[64];

static const asdic_ros_type types[2] = {
    {.name = "a_msgs/msg/A", .schema = "int32 x\n"},
    {.name = "a_msgs/msg/Long", .schema = "float64[] values\n"}};
static const char *const topics[2] = {"/a", "/long"};
static const char *const facts[] = {"scene", "pool", "seed", "7", NULL};

static int set_up(void **state) {
    (void)state;
    if (asdic_context_create(&ctx) != ASDIC_OK || !mkdtemp(folder)) {
        return -1;
    }
    snprintf(name, sizeof name, "%s/a.mcap", folder);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return rmdir(folder); /* fails when a test or the library left something behind */
}

/* --- what a file is made of ------------------------------------------------------------------- */

typedef struct text {
    uint8_t *bytes;
    size_t size;
} text;

static text text_new(void) {
    text made = {.bytes = malloc(ROOM)};
    assert_non_null(made.bytes);
    return made;
}

static void put(text *out, const void *bytes, size_t size) {
    assert_true(out->size + size <= ROOM);
    memcpy(out->bytes + out->size, bytes, size);
    out->size += size;
}

/* The SIZE lowest bytes, the lowest first. */
static void number(text *out, uint64_t value, size_t size) {
    for (size_t i = 0; i < size; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * i);
        put(out, &byte, 1);
    }
}

static void string(text *out, const char *letters) {
    number(out, strlen(letters), 4);
    put(out, letters, strlen(letters));
}

/* Opcode, length, content; the content is empty then. */
static void record(text *out, int opcode, text *content) {
    number(out, (uint64_t)opcode, 1);
    number(out, content->size, 8);
    put(out, content->bytes, content->size);
    content->size = 0;
}

static void schema(text *out, text *c, size_t i) {
    number(c, i + 1, 2);
    string(c, types[i].name);
    string(c, "ros2msg");
    string(c, types[i].schema);
    record(out, 0x03, c);
}

static void channel(text *out, text *c, size_t i) {
    number(c, i, 2);
    number(c, i + 1, 2);
    string(c, topics[i]);
    string(c, "cdr");
    number(c, 0, 4);
    record(out, 0x04, c);
}

/* A message of SIZE bytes, all alike, in a chunk. */
typedef struct row {
    size_t chunk, channel;
    int64_t time_ns;
    size_t size;
} row;

static uint64_t logged_ns(const row *r) { /* times are not negative in a file */
    return r->time_ns < 0 ? 0 : (uint64_t)r->time_ns;
}

static uint8_t filling(size_t i) {
    return (uint8_t)(0x41 + i);
}

static const row *rows;
static size_t row_count;

/* Of the rows of CHUNK, or of all for SIZE_MAX. */
static void span(size_t chunk, uint64_t *first, uint64_t *last) {
    *first = *last = 0;
    bool any = false;
    for (size_t i = 0; i < row_count; i++) {
        uint64_t t = logged_ns(&rows[i]);
        if (chunk == SIZE_MAX || rows[i].chunk == chunk) {
            *first = !any || t < *first ? t : *first;
            *last = !any || t > *last ? t : *last;
            any = true;
        }
    }
}

static size_t messages_of(size_t number, size_t before) {
    size_t count = 0;
    for (size_t i = 0; i < before; i++) {
        count += rows[i].channel == number;
    }
    return count;
}

/* The chunk with the indexes of its messages, and in INDEX what the summary says of it. */
static void put_chunk(text *out, text *index, size_t chunk) {
    text c = text_new(), inside = text_new(), places[2] = {text_new(), text_new()};
    uint64_t first, last, indexes_at[2] = {0};
    span(chunk, &first, &last);
    if (chunk == 0) {
        for (size_t i = 0; i < 2; i++) {
            schema(&inside, &c, i);
            channel(&inside, &c, i);
        }
    }
    for (size_t i = 0; i < row_count; i++) {
        const row *r = &rows[i];
        if (r->chunk == chunk) {
            number(&places[r->channel], logged_ns(r), 8);
            number(&places[r->channel], inside.size, 8);
            number(&c, r->channel, 2);
            number(&c, messages_of(r->channel, i), 4);
            number(&c, logged_ns(r), 8);
            number(&c, logged_ns(r), 8);
            memset(c.bytes + c.size, filling(i), r->size);
            c.size += r->size;
            record(&inside, 0x05, &c);
        }
    }
    size_t chunk_at = out->size;
    number(&c, first, 8);
    number(&c, last, 8);
    number(&c, inside.size, 8);
    number(&c, crc32_z(0, inside.bytes, inside.size), 4);
    string(&c, "");
    number(&c, inside.size, 8);
    put(&c, inside.bytes, inside.size);
    record(out, 0x06, &c);
    size_t chunk_end = out->size;
    for (size_t i = 0; i < 2; i++) {
        if (places[i].size) {
            indexes_at[i] = out->size;
            number(&c, i, 2);
            number(&c, places[i].size, 4);
            put(&c, places[i].bytes, places[i].size);
            record(out, 0x07, &c);
        }
    }
    number(&c, first, 8);
    number(&c, last, 8);
    number(&c, chunk_at, 8);
    number(&c, chunk_end - chunk_at, 8);
    number(&c, 10 * ((places[0].size > 0) + (places[1].size > 0)), 4);
    for (size_t i = 0; i < 2; i++) {
        if (places[i].size) {
            number(&c, i, 2);
            number(&c, indexes_at[i], 8);
        }
    }
    number(&c, out->size - chunk_end, 8);
    string(&c, "");
    number(&c, inside.size, 8);
    number(&c, inside.size, 8);
    record(index, 0x08, &c);
    free(c.bytes);
    free(inside.bytes);
    free(places[0].bytes);
    free(places[1].bytes);
}

/* One kind of records of the summary, and where they lie. */
static void group(text *out, text *offsets, int opcode, size_t begin) {
    text c = text_new();
    number(&c, (uint64_t)opcode, 1);
    number(&c, begin, 8);
    number(&c, out->size - begin, 8);
    record(offsets, 0x0e, &c);
    free(c.bytes);
}

static void put_summary(text *out, const text *index, size_t chunks, size_t metadata_at,
                        size_t metadata_size) {
    text c = text_new(), offsets = text_new();
    size_t summary = out->size, begin = summary;
    schema(out, &c, 0);
    schema(out, &c, 1);
    group(out, &offsets, 0x03, begin);
    begin = out->size;
    channel(out, &c, 0);
    channel(out, &c, 1);
    group(out, &offsets, 0x04, begin);
    begin = out->size;
    uint64_t first, last;
    span(SIZE_MAX, &first, &last);
    number(&c, row_count, 8);
    number(&c, 2, 2); /* schemas */
    number(&c, 2, 4); /* channels */
    number(&c, 0, 4); /* attachments */
    number(&c, 1, 4); /* metadata */
    number(&c, chunks, 4);
    number(&c, first, 8);
    number(&c, last, 8);
    number(&c, 2 * (2 + 8), 4);
    for (size_t i = 0; i < 2; i++) {
        number(&c, i, 2);
        number(&c, messages_of(i, row_count), 8);
    }
    record(out, 0x0b, &c);
    group(out, &offsets, 0x0b, begin);
    begin = out->size;
    put(out, index->bytes, index->size);
    group(out, &offsets, 0x08, begin);
    begin = out->size;
    number(&c, metadata_at, 8);
    number(&c, metadata_size, 8);
    string(&c, "about");
    record(out, 0x0d, &c);
    group(out, &offsets, 0x0d, begin);
    size_t offsets_at = out->size;
    put(out, offsets.bytes, offsets.size);
    number(out, 0x02, 1);
    number(out, 8 + 8 + 4, 8);
    number(out, summary, 8);
    number(out, offsets_at, 8);
    number(out, crc32_z(0, out->bytes + summary, out->size - summary), 4);
    free(c.bytes);
    free(offsets.bytes);
}

static text expected_file(size_t chunks) {
    text out = {.bytes = malloc(2 * ROOM)}, c = text_new(), index = text_new();
    char library[64];
    assert_non_null(out.bytes);
    put(&out, "\x89MCAP0\r\n", 8);
    string(&c, "ros2");
    snprintf(library, sizeof library, "asdic %s", asdic_version());
    string(&c, library);
    record(&out, 0x01, &c);
    size_t metadata_at = out.size;
    string(&c, "about");
    number(&c, 4 + 5 + 4 + 4 + 4 + 4 + 4 + 1, 4);
    for (size_t i = 0; facts[i]; i++) {
        string(&c, facts[i]);
    }
    record(&out, 0x0c, &c);
    size_t metadata_size = out.size - metadata_at;
    for (size_t i = 0; i < chunks; i++) {
        put_chunk(&out, &index, i);
    }
    number(&c, crc32_z(0, out.bytes, out.size), 4);
    record(&out, 0x0f, &c);
    put_summary(&out, &index, chunks, metadata_at, metadata_size);
    put(&out, "\x89MCAP0\r\n", 8);
    free(c.bytes);
    free(index.bytes);
    return out;
}

/* --- files ------------------------------------------------------------------------------------ */

static asdic_mcap *begin(void) {
    asdic_mcap *mcap;
    assert_ok(ctx, asdic_mcap_create(ctx, name, "about", facts, &mcap));
    for (size_t i = 0; i < 2; i++) {
        assert_int_equal(asdic_mcap_channel(mcap, topics[i], &types[i]), i);
    }
    return mcap;
}

static void check_file(const row *all, size_t count, size_t chunks) {
    uint8_t *bytes = malloc(2 * ROOM);
    rows = all;
    row_count = count;
    asdic_mcap *mcap = begin();
    for (size_t i = 0; i < count; i++) {
        memset(bytes, filling(i), all[i].size);
        assert_ok(ctx,
                  asdic_mcap_message(mcap, all[i].channel, all[i].time_ns, bytes, all[i].size));
    }
    assert_ok(ctx, asdic_mcap_commit(&mcap));
    assert_null(mcap);
    text expected = expected_file(chunks);
    FILE *file = fopen(name, "rb");
    assert_non_null(file);
    size_t size = fread(bytes, 1, 2 * ROOM, file);
    fclose(file);
    for (size_t i = 0; i < size && i < expected.size; i++) {
        if (bytes[i] != expected.bytes[i]) {
            print_error("byte %zu is %#x, expected %#x\n", i, bytes[i], expected.bytes[i]);
            fail();
        }
    }
    assert_int_equal(size, expected.size);
    free(bytes);
    free(expected.bytes);
    assert_int_equal(unlink(name), 0);
}

static void a_few_messages_are_one_chunk(void **state) {
    (void)state;
    const row few[] = {
        {0, 0, 300, 5}, {0, 1, 200, 0}, {0, 1, 250, 17}, {0, 0, 900, 3}, {0, 1, 800, 1}};
    const row before[] = {{0, 1, -5, 4}, {0, 0, 7, 4}};
    check_file(few, sizeof few / sizeof *few, 1);
    check_file(few, 1, 1); /* one channel has none */
    check_file(before, 2, 1);
    check_file(NULL, 0, 1);
}

/* Before its messages the first chunk has schemas and channels: LEAD bytes; a message has 31. */
static void a_chunk_ends_at_4_mib(void **state) {
    (void)state;
    text c = text_new(), lead = text_new();
    for (size_t i = 0; i < 2; i++) {
        schema(&lead, &c, i);
        channel(&lead, &c, i);
    }
    const size_t rest = CHUNK - lead.size - 2 * 31 - 1000;
    free(c.bytes);
    free(lead.bytes);
    const row full[] = {{0, 0, 50, 1000}, {0, 1, 70, rest}, {1, 1, 90, 10}, {1, 1, 95, 20}};
    const row back[] = {{0, 0, 50, 1000}, {0, 1, 70, rest}, {1, 0, 60, 10}}; /* of the other */
    check_file(full, 4, 2);
    check_file(back, 3, 2);
    check_file(full, 2, 1);
    const row below[] = {{0, 0, 50, 1000}, {0, 1, 70, rest - 1}, {0, 0, 60, 10}};
    check_file(below, 3, 1);
}

static void what_is_discarded_leaves_nothing(void **state) {
    (void)state;
    asdic_mcap *mcap = begin();
    assert_ok(ctx, asdic_mcap_message(mcap, 0, 1, "text", 4));
    asdic_mcap_discard(&mcap);
    assert_null(mcap);
    asdic_mcap_discard(&mcap);
    assert_int_not_equal(access(name, F_OK), 0);
    char none[96];
    snprintf(none, sizeof none, "%s/none/a.mcap", folder);
    assert_status(ctx, asdic_mcap_create(ctx, none, "about", facts, &mcap), ASDIC_ERROR_IO);
    assert_null(mcap);
}

/* Whatever was kept of a file: what the heap holds is as before. */
static void a_file_that_is_complete_keeps_no_memory(void **state) {
    (void)state;
    size_t before = 0;
    for (int i = 0; i < 3; i++) { /* the first also makes what lasts */
        asdic_mcap *mcap = begin();
        for (size_t k = 0; k < 2; k++) {
            assert_ok(ctx, asdic_mcap_message(mcap, k, 1, "text", 4));
        }
        assert_ok(ctx, asdic_mcap_commit(&mcap));
        if (i == 1) {
            before = mallinfo2().uordblks;
        }
    }
    assert_int_equal(mallinfo2().uordblks, before);
    assert_int_equal(unlink(name), 0);
}

/* At the message that ends the chunk, not at the end of the mission. */
static void a_full_disk_is_told_at_once(void **state) {
    (void)state;
    const size_t size = CHUNK;
    uint8_t *bytes = calloc(1, size);
    struct rlimit before;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
    const struct rlimit less = {.rlim_cur = 1 << 20, .rlim_max = before.rlim_max};
    void (*handler)(int) = signal(SIGXFSZ, SIG_IGN);
    asdic_mcap *mcap = begin();
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &less), 0);
    asdic_status status = asdic_mcap_message(mcap, 0, 1, bytes, size);
    setrlimit(RLIMIT_FSIZE, &before);
    signal(SIGXFSZ, handler);
    assert_int_equal(status, ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/a.mcap': File too large");
    asdic_mcap_discard(&mcap);
    free(bytes);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_few_messages_are_one_chunk),
        cmocka_unit_test(a_chunk_ends_at_4_mib),
        cmocka_unit_test(what_is_discarded_leaves_nothing),
        cmocka_unit_test(a_file_that_is_complete_keeps_no_memory),
        cmocka_unit_test(a_full_disk_is_told_at_once),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
