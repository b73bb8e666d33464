/*
 * Files that are written: whole under their name or not at all, and never over another writer's; their
 * sums; and what of a PNG file is found damaged.
 */
#include "asserts.h"

#include "base/context.h"
#include "base/text.h"
#include "out/file.h"
#include "out/png_file.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

static asdic_context *ctx;
static char folder[] = "/tmp/asdic-files-XXXXXX";
static char name[64], part[70]; /* of the file that a test writes */

static int set_up(void **state) {
    (void)state;
    if (asdic_context_create(&ctx) != ASDIC_OK || !mkdtemp(folder)) {
        return -1;
    }
    snprintf(name, sizeof name, "%s/a", folder);
    snprintf(part, sizeof part, "%s.part", name);
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return rmdir(folder); /* fails when a test or the library left something behind */
}

/* Whether PATH is a file that holds TEXT and nothing else; a link is none. */
static bool holds(const char *path, const char *text) {
    struct stat st;
    char found[64];
    if (lstat(path, &st) != 0 || !S_ISREG(st.st_mode)) {
        return false;
    }
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t length = fread(found, 1, sizeof found, file);
    fclose(file);
    return length == strlen(text) && memcmp(found, text, length) == 0;
}

static bool is_missing(const char *path) {
    struct stat st;
    return lstat(path, &st) != 0;
}

static bool is_link(const char *path) {
    struct stat st;
    return lstat(path, &st) == 0 && S_ISLNK(st.st_mode);
}

static void put(const char *path, const void *bytes, size_t length) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, length, file), length);
    assert_int_equal(fclose(file), 0);
}

/* The descriptor that is opened next: none before it may stay open. */
static int lowest_free(void) {
    int fd = dup(STDOUT_FILENO);
    close(fd);
    return fd;
}

static asdic_file *begin(const char *text) {
    asdic_file *file;
    assert_ok(ctx, asdic_file_create(ctx, name, &file));
    fputs(text, asdic_file_stream(file));
    return file;
}

static void a_name_has_the_old_file_until_the_new_one_is_whole(void **state) {
    (void)state;
    put(name, "old", 3);
    asdic_file *file = begin("new");
    assert_true(holds(name, "old"));
    assert_false(is_missing(part));
    assert_ok(ctx, asdic_file_commit(&file));
    assert_null(file);
    assert_true(holds(name, "new") && is_missing(part));
    file = begin("newer");
    asdic_file_discard(&file);
    assert_null(file);
    asdic_file_discard(&file);
    asdic_file_discard(NULL);
    assert_true(holds(name, "new") && is_missing(part));
    assert_ok(ctx, asdic_file_write_all(ctx, name, "newest", 5));
    assert_true(holds(name, "newes"));
    struct stat st;
    mode_t mask = umask(022);
    assert_ok(ctx, asdic_file_write_all(ctx, name, "", 0));
    assert_int_equal(stat(name, &st), 0);
    assert_int_equal(st.st_mode & 07777, 0644);
    umask(mask);
    assert_int_equal(unlink(name), 0);
}

static void a_text_is_written_whole_or_not_at_all(void **state) {
    (void)state;
    asdic_text text = {0};
    asdic_text_add(&text, "grown");
    assert_ok(ctx, asdic_file_write_text(ctx, name, &text, "a text", false));
    assert_true(holds(name, "grown") && !text.data && text.length == 0);
    asdic_text_add(&text, "cut");
    text.failed = true;
    assert_status(ctx, asdic_file_write_text(ctx, name, &text, "a text", false),
                  ASDIC_ERROR_MEMORY);
    assert_contains(asdic_context_error(ctx), "a text");
    assert_true(holds(name, "grown") && is_missing(part) && !text.data && !text.failed);
    text.failed = true; /* before the first byte */
    assert_status(ctx, asdic_file_write_text(ctx, name, &text, "a text", true), ASDIC_ERROR_MEMORY);
    assert_ok(ctx, asdic_file_write_text(ctx, name, &text, "a text", true)); /* of nothing */
    struct stat st;
    assert_int_equal(stat(name, &st) | st.st_size | unlink(name), 0);
}

/* Two files of one process hold locks against each other as those of two do. */
static void another_writers_file_is_left_to_it(void **state) {
    (void)state;
    int free_before = lowest_free();
    put(name, "old", 3);
    put(part, "left", 4); /* by a writer that is gone */
    errno = 0;
    asdic_file *file = begin("first"), *other;
    assert_status(ctx, asdic_file_create(ctx, name, &other), ASDIC_ERROR_IO);
    assert_null(other);
    assert_contains(asdic_context_error(ctx), "a.part': another process is writing it just now");
    assert_ok(ctx, asdic_file_commit(&file));
    assert_true(holds(name, "first"));
    for (int i = 0; i < 2; i++) { /* who comes without looking for locks */
        file = begin("second");
        assert_int_equal(unlink(part), 0);
        put(part, "other", 5);
        if (i == 0) {
            assert_status(ctx, asdic_file_commit(&file), ASDIC_ERROR_IO);
            assert_contains(asdic_context_error(ctx), "another process is writing it just now");
        } else {
            asdic_file_discard(&file);
        }
        assert_true(holds(name, "first") && holds(part, "other"));
    }
    file = begin("third"); /* nobody writes it any more */
    assert_ok(ctx, asdic_file_commit(&file));
    assert_true(holds(name, "third"));
    assert_int_equal(lowest_free(), free_before);
    assert_int_equal(unlink(name), 0);
}

/* Memory for a stream is short when told to be. */
static bool fdopen_fails;

FILE *__real_fdopen(int fd, const char *mode);
FILE *__wrap_fdopen(int fd, const char *mode);

FILE *__wrap_fdopen(int fd, const char *mode) {
    if (fdopen_fails) {
        errno = ENOMEM;
        return NULL;
    }
    return __real_fdopen(fd, mode);
}

/* Whoever starts a program may have closed its standard input: then files get its number, 0. */
static void descriptor_0_is_one_as_all_others(void **state) {
    (void)state;
    asdic_file *file, *other;
    asdic_sum sum;
    int kept = dup(STDIN_FILENO);
    assert_true(kept > STDIN_FILENO);
    file = begin("first");
    close(STDIN_FILENO);
    assert_status(ctx, asdic_file_create(ctx, name, &other), ASDIC_ERROR_IO);
    assert_int_equal(lowest_free(), STDIN_FILENO);
    assert_ok(ctx, asdic_file_commit(&file));
    file = begin("new");
    assert_int_not_equal(lowest_free(), STDIN_FILENO);
    assert_status(ctx, asdic_file_create(ctx, name, &other), ASDIC_ERROR_IO);
    assert_ok(ctx, asdic_file_commit(&file));
    assert_true(holds(name, "new"));
    assert_int_equal(lowest_free(), STDIN_FILENO);
    assert_ok(ctx, asdic_file_sum(ctx, name, &sum));
    assert_int_equal(sum.bytes, 3);
    assert_int_equal(lowest_free(), STDIN_FILENO);
    fdopen_fails = true;
    assert_status(ctx, asdic_file_create(ctx, name, &other), ASDIC_ERROR_IO);
    fdopen_fails = false;
    assert_contains(asdic_context_error(ctx), "Cannot allocate memory");
    assert_int_equal(lowest_free(), STDIN_FILENO);
    assert_ok(ctx, asdic_file_write_all(ctx, name, "newer", 5)); /* it left no lock behind */
    assert_true(holds(name, "newer"));
    assert_int_equal(dup2(kept, STDIN_FILENO), STDIN_FILENO);
    close(kept);
    assert_int_equal(unlink(name), 0);
}

static void links_are_replaced(void **state) {
    (void)state;
    char target[64];
    snprintf(target, sizeof target, "%s/b", folder);
    put(target, "mine", 4);
    assert_int_equal(symlink(target, name) | symlink(target, part), 0);
    asdic_file *file = begin("new");
    assert_ok(ctx, asdic_file_commit(&file));
    assert_true(holds(name, "new") && is_missing(part) && holds(target, "mine"));
    assert_int_equal(unlink(name) | symlink(target, name) | symlink(target, part), 0);
    assert_ok(ctx, asdic_file_write_soon(ctx, name, "soon", 4));
    assert_true(holds(name, "soon") && is_missing(part) && holds(target, "mine"));
    assert_int_equal(unlink(name) | unlink(target), 0);
}

/* Devices are named by links: what went wrong would replace a link, and not the machine's device. */
static void what_the_disk_refuses_is_told(void **state) {
    (void)state;
    asdic_file *file;
    assert_int_equal(symlink("/dev/null", name), 0);
    assert_ok(ctx, asdic_file_write_all(ctx, name, "text", 4));
    assert_true(is_link(name) && is_missing(part));
    assert_int_equal(unlink(name) | symlink("/dev/full", name), 0);
    assert_status(ctx, asdic_file_write_all(ctx, name, "text", 4), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/a': No space left on device");
    assert_ok(ctx, asdic_file_create(ctx, name, &file)); /* not at the end, but before */
    for (size_t i = 0; i < 1 << 16; i++) {
        fputc('x', asdic_file_stream(file));
    }
    errno = 0;
    assert_status(ctx, asdic_file_commit(&file), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/a': No space left on device");
    assert_true(is_link(name) && is_missing(part));
    assert_int_equal(unlink(name) | mkdir(name, 0777), 0);
    assert_status(ctx, asdic_file_write_all(ctx, name, "text", 4), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "Is a directory");
    assert_true(is_missing(part));
    char here[80];
    snprintf(here, sizeof here, "%s/.", name);
    assert_status(ctx, asdic_file_create(ctx, here, &file), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/a/.': Is a directory");
    assert_int_equal(rmdir(name) | mkdir(part, 0777), 0);
    assert_status(ctx, asdic_file_create(ctx, name, &file), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/a.part': Is a directory");
    assert_int_equal(rmdir(part), 0);
}

/* Under its name when it is whole; where that cannot be, nothing stays. */
static void files_written_soon_are_whole(void **state) {
    (void)state;
    char none[80];
    assert_int_equal(asdic_file_write_soon(ctx, name, "whole", 5), ASDIC_OK);
    assert_true(holds(name, "whole"));
    assert_int_equal(unlink(name), 0);
    assert_int_equal(mkdir(name, 0777), 0);
    assert_int_equal(asdic_file_write_soon(ctx, name, "whole", 5), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "Is a directory");
    assert_int_equal(rmdir(name), 0);
    snprintf(none, sizeof none, "%s/none/soon", folder);
    assert_int_equal(asdic_file_write_soon(ctx, none, "x", 1), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "No such file or directory");
}

/* The check value of CRC-32 is that of the nine digits; of many bytes it is zlib's in one piece. */
static void sums_are_zlibs(void **state) {
    (void)state;
    enum { MANY = 100000 };
    static unsigned char many[MANY];
    for (size_t i = 0; i < MANY; i++) {
        many[i] = (unsigned char)(i * i >> 7);
    }
    const struct {
        const void *bytes;
        size_t length;
        unsigned long crc32;
    } rows[] = {{"123456789", 9, 0xcbf43926}, {"", 0, 0}, {many, MANY, crc32_z(0, many, MANY)}};
    asdic_sum sum;
    int free_before = lowest_free();
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        put(name, rows[i].bytes, rows[i].length);
        assert_ok(ctx, asdic_file_sum(ctx, name, &sum));
        assert_int_equal(sum.bytes, rows[i].length);
        assert_int_equal(sum.crc32, rows[i].crc32);
    }
    assert_int_equal(unlink(name), 0);
    assert_status(ctx, asdic_file_sum(ctx, name, &sum), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "No such file or directory");
    assert_status(ctx, asdic_file_sum(ctx, folder, &sum), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "Is a directory");
    assert_int_equal(lowest_free(), free_before);
}

/* ---- PNG ------------------------------------------------------------------------------------- */

enum { MOST = 80000 };
static unsigned char png[MOST];

/* Writes an image of 12 x 2 and reads its bytes into PNG. */
static size_t write_png(double pixels_per_m, const char *value) {
    const uint8_t rgb[12 * 2 * 3] = {1, 2, 3};
    const char *const texts[] = {"Key", value, NULL};
    const asdic_png image = {
        .width = 12, .height = 2, .rgb = rgb, .pixels_per_m = pixels_per_m, .texts = texts};
    assert_ok(ctx, asdic_png_write(ctx, name, &image));
    assert_ok(ctx, asdic_png_check(ctx, name));
    FILE *file = fopen(name, "rb");
    size_t length = fread(png, 1, MOST, file);
    fclose(file);
    return length;
}

static void png_says_resolution_and_letters(void **state) {
    (void)state;
    /* 3937 = 0xf61 both ways, by the metre; PNG's chunks are tEXt for Latin-1, iTXt for UTF-8 */
    size_t length = write_png(3937.46, "plain");
    assert_non_null(memmem(png, length, "\0\0\0\x09pHYs\0\0\x0f\x61\0\0\x0f\x61\x01", 17));
    length = write_png(3937.54, "plain");
    assert_non_null(memmem(png, length, "\0\0\0\x09pHYs\0\0\x0f\x62\0\0\x0f\x62\x01", 17));
    assert_non_null(memmem(png, length, "tEXtKey\0plain", 13));
    assert_null(memmem(png, length, "iTXt", 4));
    length = write_png(0.0, "\u00b5");
    assert_null(memmem(png, length, "pHYs", 4));
    assert_non_null(memmem(png, length, "iTXtKey\0", 8));
    assert_null(memmem(png, length, "tEXt", 4));
    assert_int_equal(unlink(name), 0);
}

/* USER: the row that is asked for next. */
static asdic_status fill_row(void *user, size_t y, uint16_t *row) {
    size_t *next = user;
    assert_int_equal(y, (*next)++);
    memset(row, 0x55, 12 * sizeof *row);
    return y < 3 ? ASDIC_OK : asdic_fail(ctx, ASDIC_ERROR_INPUT, "no row %zu", y);
}

static void png_asks_for_each_row_once(void **state) {
    (void)state;
    for (size_t height = 3; height < 6; height++) {
        size_t next = 0;
        const asdic_png image = {
            .width = 12, .height = height, .grey_row = fill_row, .user = &next};
        assert_status(ctx, asdic_png_write(ctx, name, &image),
                      height == 3 ? ASDIC_OK : ASDIC_ERROR_INPUT);
        assert_int_equal(next, height == 3 ? 3 : 4);
        if (height == 3) {
            assert_int_equal(unlink(name), 0);
        } else {
            assert_contains(asdic_context_error(ctx), "no row 3");
        }
        assert_true(is_missing(name) && is_missing(part));
    }
}

static void assert_damaged(size_t length) {
    put(name, png, length);
    assert_status(ctx, asdic_png_check(ctx, name), ASDIC_ERROR_INPUT);
    assert_contains(asdic_context_error(ctx), "/a' is no whole PNG file");
}

static void png_is_whole_to_its_last_byte(void **state) {
    (void)state;
    size_t length = write_png(100.0, "plain");
    for (size_t cut = 0; cut < length; cut++) {
        assert_damaged(cut);
    }
    png[length] = 0;
    assert_damaged(length + 1);
    for (size_t i = 0; i < length; i++) {
        for (int bit = 0x80; bit; bit = bit == 0x80 ? 1 : 0) {
            png[i] ^= (unsigned char)bit;
            assert_damaged(length);
            png[i] ^= (unsigned char)bit;
        }
    }
    assert_int_equal(unlink(name), 0);
    assert_int_not_equal(asdic_png_check(ctx, name), ASDIC_OK);
}

/* A chunk of 0x10170 bytes with its sum. */
static void png_chunks_may_be_long(void **state) {
    (void)state;
    const size_t body = 0x10170, at = 8 + 8 + body;
    memcpy(png, "\x89PNG\r\n\x1a\n\0\x01\x01\x70teSt", 16);
    memset(png + 16, 'x', body);
    uint32_t sum = (uint32_t)crc32_z(0, png + 12, body + 4);
    for (size_t i = 0; i < 4; i++) {
        png[at + i] = (unsigned char)(sum >> (24 - 8 * i));
    }
    memcpy(png + at + 4, "\0\0\0\0IEND\xae\x42\x60\x82", 12);
    put(name, png, at + 16);
    assert_ok(ctx, asdic_png_check(ctx, name));
    assert_int_equal(unlink(name), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_name_has_the_old_file_until_the_new_one_is_whole),
        cmocka_unit_test(a_text_is_written_whole_or_not_at_all),
        cmocka_unit_test(another_writers_file_is_left_to_it),
        cmocka_unit_test(descriptor_0_is_one_as_all_others),
        cmocka_unit_test(links_are_replaced),
        cmocka_unit_test(what_the_disk_refuses_is_told),
        cmocka_unit_test(files_written_soon_are_whole),
        cmocka_unit_test(sums_are_zlibs),
        cmocka_unit_test(png_says_resolution_and_letters),
        cmocka_unit_test(png_asks_for_each_row_once),
        cmocka_unit_test(png_is_whole_to_its_last_byte),
        cmocka_unit_test(png_chunks_may_be_long),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
