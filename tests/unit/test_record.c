/*
 * A ping on its way into files: pings.npy and truth.npy byte by byte, the rows of bins.csv, and the
 * levels in NumPy's numbers.
 */
#include "asserts.h"

#include "out/csv.h"
#include "out/format.h"
#include "out/half.h"
#include "out/npy.h"

#include <asdic/asdic.h>

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define CELLS ((size_t)6)
#define HEAD ((size_t)88) /* bytes before levels: eleven numbers of eight */

static asdic_context *ctx;
static char folder[] = "/tmp/asdic-record-XXXXXX";
static char path[64];

/* Reads and deletes the file of a test; the caller frees. */
static char *take(size_t *length) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *length = (size_t)ftell(file);
    rewind(file);
    char *bytes = malloc(*length + 1);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *length, file), *length);
    bytes[*length] = 0;
    fclose(file);
    assert_int_equal(unlink(path), 0);
    return bytes;
}

/* ---- records --------------------------------------------------------------------------------- */

static asdic_record_head head = {.ping = 70000,
                                 .time_s = 2.5,
                                 .position_m = {1.5, -2.5, 3.5},
                                 .attitude_rad = {0.1, 0.2, 0.3},
                                 .altitude_m = 4.5,
                                 .rays = 5000000000,
                                 .saturated = 6};

/* Exact in dB: 10 times a whole number. Of component c, bin i; none at the fifth of them. */
static double level_db(size_t c, size_t i) {
    return i == 4 ? NAN : -10.0 * (double)(1 + 2 * c + i);
}

static double stderr_db(size_t i) { /* none without energy, none that is no number */
    return i == 4 || i == 1 ? NAN : 0.125 * (double)(i + 1);
}

/* Of field 0 or 1, objects; of the others, shares. */
static double truth_value(size_t field, size_t i) {
    return field < 2 ? (double)i * 100.0 - (double)field : (double)field + (double)i / 8.0;
}

/* 2 beams of 3 bins, packed; the caller frees. */
static void *pack(bool truth) {
    int16_t numbers[2][CELLS];
    float shares[ASDIC_TRUTH_FIELDS - 2][CELLS];
    asdic_ping_truth full = {
        .strongest = numbers[0],
        .object = numbers[1],
        .share = shares[0],
        .object_share = shares[1],
        .path = {shares[2], shares[3], shares[4], shares[5], shares[6]},
        .depression_rad = shares[7],
    };
    asdic_ping *ping;
    assert_ok(ctx, asdic_ping_create(ctx, 2, 3, &ping));
    for (size_t i = 0; i < CELLS; i++) {
        for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            ping->intensity_lin[c][i] = i == 4 ? 0.0 : pow(10.0, 0.1 * level_db(c, i));
        }
        ping->stderr_db[i] = i == 1 ? INFINITY : 0.125f * (float)(i + 1);
        for (size_t f = 0; f < ASDIC_TRUTH_FIELDS; f++) {
            if (f < 2) {
                numbers[f][i] = (int16_t)truth_value(f, i);
            } else {
                shares[f - 2][i] = (float)truth_value(f, i);
            }
        }
    }
    ping->truth = truth ? &full : NULL;
    void *bytes = calloc(1, asdic_record_bytes(2, 3));
    assert_non_null(bytes);
    asdic_record_pack(&head, ping, bytes);
    ping->truth = NULL;
    asdic_ping_destroy(&ping);
    return bytes;
}

static void assert_level(double found, double wanted, double tolerance) {
    if (isnan(wanted)) {
        assert_true(isnan(found));
    } else {
        assert_close(found, wanted, tolerance);
    }
}

/* All of BYTES: the parts in KEPT with an error of at most HALF of their size, errors where HAS_ERRORS. */
static void assert_record(const void *bytes, unsigned kept, double half, bool truth) {
    asdic_record r;
    asdic_record_view(bytes, 2, 3, &r);
    assert_true(r.ping == head.ping && r.time_s == head.time_s && r.altitude_m == head.altitude_m);
    assert_true(r.rays == head.rays && r.saturated == head.saturated);
    assert_true(r.pose.position_m.x == 1.5 && r.pose.position_m.y == -2.5 &&
                r.pose.position_m.z == 3.5);
    assert_true(r.pose.roll_rad == 0.1 && r.pose.pitch_rad == 0.2 && r.pose.yaw_rad == 0.3);
    for (size_t i = 0; i < CELLS; i++) {
        for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            assert_level(r.level_db[c][i], kept >> c & 1u ? level_db(c, i) : NAN,
                         c == ASDIC_TOTAL ? 1e-5 : 1e-5 + half * fabs(level_db(c, i)));
        }
        assert_level(r.stderr_db[i], stderr_db(i), 0.0);
    }
    assert_true((r.truth.share != NULL) == truth);
    for (size_t f = 0; f < ASDIC_TRUTH_FIELDS && truth; f++) {
        const void *values = asdic_truth_values(&r.truth, f);
        for (size_t i = 0; i < CELLS; i++) {
            double found =
                f < 2 ? ((const int16_t *)values)[i] : (double)((const float *)values)[i];
            assert_close(found, truth_value(f, i), 0.0);
        }
    }
    if (truth) { /* behind the last of its numbers, its sum, and nothing more */
        assert_ptr_equal((const char *)(r.truth.depression_rad + CELLS) + sizeof(uint32_t),
                         (const char *)bytes + asdic_record_bytes(2, 3));
    }
}

#define ALL ((1u << ASDIC_COMPONENT_COUNT) - 1)
#define SOME (1u << ASDIC_BOTTOM | 1u << ASDIC_NOISE)
#define LEVEL (1u << ASDIC_TOTAL)

static void records_keep_what_their_form_says(void **state) {
    (void)state;
    const struct {
        asdic_record_form form;
        unsigned parts, kept;
        size_t bytes; /* of levels in a bin */
    } rows[] = {{ASDIC_RECORD_FULL, SOME, ALL, 8 * 4},
                {ASDIC_RECORD_COMPACT, ALL, ALL, 4 + 6 * 2 + 2},
                {ASDIC_RECORD_COMPACT, SOME, SOME | LEVEL, 4 + 2 * 2 + 2},
                {ASDIC_RECORD_LEVELS, ALL, LEVEL, 4 + 2}};
    /* 280 bytes, a sum and a mark, each at a multiple of eight, and 228 of truth */
    assert_int_equal(asdic_record_bytes(2, 3), 288 + 8 + 228);
    for (size_t k = 0; k < 2 * sizeof rows / sizeof *rows; k++) {
        bool truth = k % 2;
        head.ping = k < 4 ? 0 : 70000;
        const asdic_record_layout layout = {.beams = 2,
                                            .bins = 3,
                                            .form = rows[k / 2].form,
                                            .truth = truth,
                                            .parts = rows[k / 2].parts};
        bool is_full = layout.form == ASDIC_RECORD_FULL;
        size_t bytes = asdic_record_stored_bytes(&layout);
        assert_int_equal(bytes, HEAD + CELLS * rows[k / 2].bytes + 4);
        void *memory = pack(truth), *stored = is_full ? memory : malloc(bytes);
        assert_record(memory, ALL, 0.0, truth);
        asdic_record_store(&layout, memory, stored);
        assert_true(asdic_record_is_whole(stored, bytes, head.ping));
        assert_false(asdic_record_is_whole(stored, bytes, head.ping + 1));
        for (size_t i = 0; i < bytes; i++) {
            ((char *)stored)[i] ^= 0x10;
            assert_false(asdic_record_is_whole(stored, bytes, head.ping));
            ((char *)stored)[i] ^= 0x10;
        }
        size_t truth_bytes = asdic_record_truth_bytes(&layout);
        assert_int_equal(truth_bytes, truth ? 8 + CELLS * (2 * 2 + 8 * 4) + 4 : 0);
        char *back = calloc(1, asdic_record_bytes(2, 3));
        if (truth) {
            const void *kept = asdic_record_store_truth(&layout, memory);
            assert_true(asdic_record_is_whole(kept, truth_bytes, head.ping));
            memcpy(asdic_record_truth(&layout, back), kept, truth_bytes);
            assert_record(memory, ALL, 0.0, truth);
        }
        if (is_full) {
            memcpy(back, stored, bytes);
        }
        asdic_record_restore(&layout, is_full ? back : stored, back);
        assert_record(back, rows[k / 2].kept, is_full ? 0.0 : 1.0 / 2048, truth);
        free(back);
        if (!is_full) {
            free(stored);
        }
        free(memory);
    }
}

static void numpy_is_told_every_field(void **state) {
    (void)state;
    char text[ASDIC_RECORD_DTYPE_SIZE];
    asdic_record_layout layout = {
        .beams = 512, .bins = 3, .form = ASDIC_RECORD_FULL, .truth = true};
#define BEGINNING                                                                                  \
    "[('ping', '<u8'), ('time_s', '<f8'), ('position_m', '<f8', (3,)), ('attitude_rad', '<f8', "   \
    "(3,)), ('altitude_m', '<f8'), ('rays', '<u8'), ('saturated', '<u8'), "                        \
    "('level_db', '<f4', (512, 3)), "
#define END ", ('crc32', '<u4')]"
    asdic_record_dtype(text, &layout);
    assert_string_equal(text, BEGINNING "('bottom_db', '<f4', (512, 3)), "
                                        "('surface_db', '<f4', (512, 3)), "
                                        "('volume_db', '<f4', (512, 3)), "
                                        "('object_db', '<f4', (512, 3)), "
                                        "('multipath_db', '<f4', (512, 3)), "
                                        "('noise_db', '<f4', (512, 3)), "
                                        "('stderr_db', '<f4', (512, 3))" END);
    layout.form = ASDIC_RECORD_COMPACT;
    layout.parts = 1u << ASDIC_VOLUME;
    asdic_record_dtype(text, &layout);
    assert_string_equal(text, BEGINNING "('volume_db', '<f2', (512, 3)), "
                                        "('stderr_db', '<f2', (512, 3))" END);
    asdic_record_truth_dtype(text, &layout);
    assert_string_equal(text, "[('ping', '<u8'), ('strongest', '<i2', (512, 3)), "
                              "('object', '<i2', (512, 3)), ('share', '<f4', (512, 3)), "
                              "('object_share', '<f4', (512, 3)), ('direct', '<f4', (512, 3)), "
                              "('by_surface', '<f4', (512, 3)), ('by_bottom', '<f4', (512, 3)), "
                              "('by_object', '<f4', (512, 3)), ('noise', '<f4', (512, 3)), "
                              "('depression_rad', '<f4', (512, 3))" END);
}

/* ---- bins.csv -------------------------------------------------------------------------------- */

/* The longest name, in the longest field: all quotes, set by set_up; another with a comma. */
static asdic_beam beams[2] = {{.name = ""}, {.name = "port, 1"}};
static char all_quotes[2 * ASDIC_NAME_SIZE + 1];
static const char *const fields[2] = {all_quotes, "\"port, 1\""};

/* Levels of BINS bins that are told apart; the caller frees LEVELS. */
static asdic_record numbered(size_t bins, float **levels) {
    asdic_record record = {.ping = 12, .time_s = 0.1};
    float *values = *levels = malloc(ASDIC_RECORD_ARRAYS * 2 * bins * sizeof *values);
    assert_non_null(values);
    for (size_t i = 0; i < ASDIC_RECORD_ARRAYS * 2 * bins; i++) {
        values[i] = i % 7 == 3 ? NAN : -100.0f - (float)i / 3.0f;
    }
    for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        record.level_db[c] = values + 2 * bins * c;
    }
    record.stderr_db = values + 2 * bins * ASDIC_COMPONENT_COUNT;
    return record;
}

static void put_value(FILE *out, float value) {
    if (!isnan(value)) {
        fprintf(out, "%.9g", (double)value);
    }
}

/* As printf writes them: a row for each bin, or for each beam. */
static void put_rows(FILE *out, const asdic_record *r, size_t bins, bool is_wide) {
    for (size_t i = 0; i < 2 * bins; i++) {
        if (!is_wide || i % bins == 0) {
            fprintf(out, "%" PRIu64 ",0.1,%s", r->ping, fields[i / bins]);
        }
        if (is_wide) {
            fputc(',', out);
            put_value(out, r->level_db[ASDIC_TOTAL][i]);
            fputs(i % bins == bins - 1 ? "\n" : "", out);
            continue;
        }
        fprintf(out, ",%zu,%.15g,", i % bins, ((double)(i % bins) + 0.5) * 0.5);
        for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            put_value(out, r->level_db[c][i]);
            fputc(',', out);
        }
        put_value(out, r->stderr_db[i]);
        fputc('\n', out);
    }
}

/* Of a few bins and of many, more text than is written at once. */
static void tables_are_as_printf_writes_them(void **state) {
    (void)state;
    const asdic_sonar sonar = {.receivers = beams, .receiver_count = 2, .bin_length_m = 0.5};
    const size_t counts[] = {1, 3, 40000};
    for (size_t k = 0; k < 2 * sizeof counts / sizeof *counts; k++) {
        bool is_wide = k % 2;
        size_t bins = counts[k / 2], length, right_length;
        float *levels;
        asdic_record record = numbered(bins, &levels);
        asdic_csv *csv;
        assert_ok(ctx, asdic_csv_create(ctx, path, &sonar, bins,
                                        is_wide ? ASDIC_CSV_WIDE : ASDIC_CSV_LONG, &csv));
        char *right;
        FILE *out = open_memstream(&right, &right_length);
        fputs(is_wide ? "ping,time_s,beam"
                      : "ping,time_s,beam,bin,range_m,level_db,bottom_db,surface_db,volume_db,"
                        "object_db,multipath_db,noise_db,stderr_db",
              out);
        for (size_t i = 0; is_wide && i < bins; i++) {
            fprintf(out, ",%.15g_m", ((double)i + 0.5) * 0.5);
        }
        fputc('\n', out);
        for (; record.ping < 14; record.ping++) {
            assert_ok(ctx, asdic_csv_add(csv, &record));
            put_rows(out, &record, bins, is_wide);
        }
        fclose(out);
        assert_ok(ctx, asdic_csv_commit(&csv));
        assert_null(csv);
        char *found = take(&length);
        assert_int_equal(length, right_length);
        assert_memory_equal(found, right, length);
        free(found);
        free(right);
        free(levels);
    }
}

static void no_table_is_no_file(void **state) {
    (void)state;
    const asdic_sonar sonar = {.receivers = beams, .receiver_count = 2, .bin_length_m = 0.5};
    const asdic_record record = {0};
    asdic_csv *csv;
    assert_ok(ctx, asdic_csv_create(ctx, path, &sonar, 3, ASDIC_CSV_NONE, &csv));
    assert_null(csv);
    assert_ok(ctx, asdic_csv_add(csv, &record));
    assert_ok(ctx, asdic_csv_commit(&csv));
    asdic_csv_discard(&csv);
    asdic_csv_discard(NULL);
    assert_int_not_equal(access(path, F_OK), 0);
    assert_ok(ctx, asdic_csv_create(ctx, path, &sonar, 3, ASDIC_CSV_LONG, &csv));
    asdic_csv_discard(&csv);
    assert_null(csv);
    assert_int_not_equal(access(path, F_OK), 0);
}

/* In the middle of a ping already, when it is large. By a link, not to risk the machine's device. */
static void a_full_disk_ends_the_table(void **state) {
    (void)state;
    const asdic_sonar sonar = {.receivers = beams, .receiver_count = 2, .bin_length_m = 0.5};
    assert_int_equal(symlink("/dev/full", path), 0);
    for (int form = ASDIC_CSV_LONG; form <= ASDIC_CSV_WIDE; form++) {
        float *levels;
        asdic_record record = numbered(40000, &levels);
        asdic_csv *csv;
        assert_ok(ctx, asdic_csv_create(ctx, path, &sonar, 40000, (asdic_csv_form)form, &csv));
        assert_status(ctx, asdic_csv_add(csv, &record), ASDIC_ERROR_IO);
        assert_contains(asdic_context_error(ctx), "/a': No space left on device");
        asdic_csv_discard(&csv);
        free(levels);
    }
    assert_int_equal(unlink(path), 0);
}

/* ---- NumPy ----------------------------------------------------------------------------------- */

/* As NumPy's format 1.0 has it; of one length for any count, the least that the longest count needs. */
static void headers_have_room_for_any_count(void **state) {
    (void)state;
    char first[ASDIC_NPY_HEADER_SIZE], header[ASDIC_NPY_HEADER_SIZE], dtype[2100], text[2200];
    for (size_t letters = 1; letters < sizeof dtype; letters++) {
        memset(dtype, 'x', letters);
        dtype[letters] = 0;
        int longest = snprintf(text, sizeof text,
                               "{'descr': %s, 'fortran_order': False, 'shape': (%zu, 3, ), }",
                               dtype, (size_t)UINT64_C(18446744073709551615));
        size_t wanted = (size_t)(10 + longest + 1 + 63) / 64 * 64;
        size_t length = asdic_npy_header(first, dtype, SIZE_MAX, "3, ");
        assert_int_equal(length, wanted > ASDIC_NPY_HEADER_SIZE ? 0 : wanted);
        if (length == 0) {
            assert_true(letters > 1900);
            continue;
        }
        assert_memory_equal(first + 10, text, longest);
        assert_int_equal(asdic_npy_header(header, dtype, 7, "3, "), length);
        longest = snprintf(text, sizeof text,
                           "{'descr': %s, 'fortran_order': False, 'shape': (7, 3, ), }", dtype);
        assert_memory_equal(header, "\x93NUMPY\1", 8);
        assert_int_equal((uint8_t)header[8] | (uint8_t)header[9] << 8, length - 10);
        assert_memory_equal(header + 10, text, longest);
        for (size_t i = 10 + (size_t)longest; i < length; i++) {
            assert_int_equal(header[i], i == length - 1 ? '\n' : ' ');
        }
    }
}

/* The value of binary16's BITS, a number. */
static double half_value(unsigned bits) {
    int exponent = (int)(bits >> 10 & 31u);
    double fraction = (bits & 1023u) / 1024.0;
    return (bits & 0x8000u ? -1.0 : 1.0) *
           (exponent ? ldexp(1.0 + fraction, exponent - 15) : ldexp(fraction, -14));
}

/* Of every number and its neighbour, whose mean goes to the even one; 2^16 would follow the largest. */
static void halves_are_the_nearest(void **state) {
    (void)state;
    for (unsigned i = 0; i < 2 * 0x7c00; i++) {
        uint16_t bits = (uint16_t)(i >> 1 | i << 15), next = bits + 1, half[4];
        float value, mean = (float)(0.5 * (half_value(bits) + half_value(next)));
        const float values[4] = {(float)half_value(bits), nextafterf(mean, 0.0f), mean,
                                 nextafterf(mean, mean * 2.0f)};
        asdic_half_values(&bits, 1, &value);
        assert_true(value == values[0] && !signbit(value) == !(bits & 0x8000));
        asdic_halves_of(values, 4, half);
        assert_int_equal(half[0], bits);
        assert_int_equal(half[1], bits);
        assert_int_equal(half[2], bits % 2 ? next : bits);
        assert_int_equal(half[3], next);
    }
    const float beyond[4] = {INFINITY, -INFINITY, 1e30f, NAN};
    const uint16_t wanted[4] = {0x7c00, 0xfc00, 0x7c00, 0x7e00}, other_nan = 0x7c01;
    uint16_t half[4];
    float values[4];
    asdic_halves_of(beyond, 4, half);
    assert_memory_equal(half, wanted, sizeof half);
    asdic_half_values(half, 4, values);
    assert_true(values[0] == INFINITY && values[1] == -INFINITY && isnan(values[3]));
    asdic_half_values(&other_nan, 1, values);
    assert_true(isnan(values[0]));
}

/* -100 is 1.5625 times 2^6: in binary16 sign, 6 + 15 and 0.5625. */
static void levels_are_numpys_numbers(void **state) {
    (void)state;
    const float levels_db[2][4] = {{-100.0f, NAN, 0.0f, 1.0f},
                                   {-1000.0f, 400.004f, -2.0f, -2.004f}};
    const int16_t hundredths[8] = {-10000, INT16_MIN, 0, 100, -32767, 32767, -200, -200};
    const uint16_t halves[8] = {
        0x8000 | 21 << 10 | 0x240, 0x7e00, 0, 0x3c00, 0xe3d0, 0x5e40, 0xc000, 0xc002};
    const struct {
        const asdic_format *format;
        const char *file, *type;
        const void *numbers;
    } rows[] = {{asdic_formats[ASDIC_FORMAT_npy], "levels.npy", "'<f4'", levels_db},
                {asdic_formats[ASDIC_FORMAT_npy_float16], "levels_float16.npy", "'<f2'", halves},
                {asdic_formats[ASDIC_FORMAT_npy_int16], "levels_int16.npy", "'<i2'", hundredths}};
    const asdic_sonar sonar = {.receivers = beams, .receiver_count = 2};
    const asdic_format_about about = {.sonar = &sonar, .pings = 2, .bins = 2};
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        const asdic_format *f = rows[k].format;
        char header[ASDIC_NPY_HEADER_SIZE];
        size_t length, head_length = asdic_npy_header(header, rows[k].type, 2, "2, 2");
        void *file;
        assert_string_equal(f->file, rows[k].file);
        for (int is_kept = 0; is_kept < 2; is_kept++) {
            assert_ok(ctx, f->open(ctx, path, &about, &file));
            for (size_t ping = 0; ping < 2; ping++) {
                asdic_record record = {.level_db = {levels_db[ping]}};
                assert_ok(ctx, f->write(file, &record));
            }
            if (is_kept) {
                assert_ok(ctx, f->commit(&file));
            } else {
                f->discard(&file);
                assert_int_not_equal(access(path, F_OK), 0);
            }
            assert_null(file);
            f->discard(&file);
        }
        char *found = take(&length);
        assert_int_equal(length, head_length + 8 * f->level_bytes);
        assert_memory_equal(found, header, head_length);
        assert_memory_equal(found + head_length, rows[k].numbers, 8 * f->level_bytes);
        free(found);
        assert_int_not_equal(f->open(ctx, "/none/levels", &about, &file), ASDIC_OK);
        assert_null(file);
    }
}

static int set_up(void **state) {
    (void)state;
    if (asdic_context_create(&ctx) != ASDIC_OK || !mkdtemp(folder)) {
        return -1;
    }
    snprintf(path, sizeof path, "%s/a", folder);
    memset(beams[0].name, '"', ASDIC_NAME_SIZE - 1);
    memset(all_quotes, '"', 2 * ASDIC_NAME_SIZE);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return rmdir(folder); /* fails when a test or the library left something behind */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(records_keep_what_their_form_says),
        cmocka_unit_test(numpy_is_told_every_field),
        cmocka_unit_test(tables_are_as_printf_writes_them),
        cmocka_unit_test(no_table_is_no_file),
        cmocka_unit_test(a_full_disk_ends_the_table),
        cmocka_unit_test(headers_have_room_for_any_count),
        cmocka_unit_test(halves_are_the_nearest),
        cmocka_unit_test(levels_are_numpys_numbers),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
