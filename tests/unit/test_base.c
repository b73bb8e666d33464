/*
 * Texts, arenas, hashes, files: what the rest is built from.
 */
#include "asserts.h"

#include "base/arena.h"
#include "base/clear.h"
#include "base/context.h"
#include "base/file_read.h"
#include "base/memory_left.h"
#include "base/number.h"
#include "base/quadrature.h"
#include "base/sha256.h"
#include "base/share.h"
#include "base/sort.h"
#include "base/text.h"
#include "de_locale.h"

#include <regex.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct ranked {
    long rank;
    size_t nth; /* as it came */
} ranked;

static bool ranks_higher(const void *a, const void *b) {
    return ((const ranked *)a)->rank > ((const ranked *)b)->rank;
}

/* Of 40 items of four ranks each list keeps what stands first of them all, equals as they came, and nothing is written
 * behind its room. */
static void first_of_many_are_kept(void **state) {
    enum { MOST = 40 };
    (void)state;
    for (size_t room = 1; room <= MOST + 1; room++) {
        ranked list[MOST + 2], items[MOST];
        size_t count = 0;
        memset(list, 0x5a, sizeof list);
        const ranked untouched = list[0];
        for (size_t i = 0; i < MOST; i++) {
            items[i] = (ranked){(long)(i * i * 5 % 7), i};
            asdic_sort_keep(list, &count, room, &items[i], sizeof *list, ranks_higher);
            assert_int_equal(count, i + 1 < room ? i + 1 : room);
            assert_memory_equal(&list[count], &untouched, sizeof untouched);
        }
        for (size_t i = 0; i < MOST; i++) {
            size_t place = 0;
            for (size_t k = 0; k < MOST; k++) {
                place += items[k].rank > items[i].rank || (items[k].rank == items[i].rank && k < i);
            }
            if (place < room) {
                assert_int_equal(list[place].nth, i);
                assert_int_equal(list[place].rank, items[i].rank);
            }
        }
    }
}

/* FIPS 180-4 test vectors as NIST publishes them (CSRC, Cryptographic Standards: SHA-256 examples
 * and the long-message example of FIPS 180-2, B.3). */
static void sha256_meets_published_vectors(void **state) {
    (void)state;
    char hex[65];
    asdic_sha256_hex("abc", 3, hex);
    assert_string_equal(hex, "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    asdic_sha256_hex(NULL, 0, hex);
    assert_string_equal(hex, "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    asdic_sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq", 56, hex);
    assert_string_equal(hex, "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    char *million = malloc(1000000);
    assert_non_null(million);
    memset(million, 'a', 1000000);
    asdic_sha256_hex(million, 1000000, hex);
    assert_string_equal(hex, "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    free(million);
}

/* Inputs of 0 to 199 bytes, more than three blocks; Python's hashlib gave one digest over all of their digests. */
static void sha256_takes_every_length(void **state) {
    (void)state;
    enum { LENGTHS = 200, HEX = 64 };
    static char all[LENGTHS * HEX + 1];
    uint8_t text[LENGTHS];
    char hex[HEX + 1];
    for (size_t i = 0; i < LENGTHS; i++) {
        text[i] = (uint8_t)(7 * i + i / 3);
        asdic_sha256_hex(text, i, all + HEX * i);
    }
    asdic_sha256_hex(all, sizeof all - 1, hex);
    assert_string_equal(hex, "35f092a37f973ce610e136f7ea4a13bf34853f85a44c1b6cf1f085c72010ed14");
}

static void text_grows_and_quotes(void **state) {
    (void)state;
    asdic_text text = {0};
    for (int i = 0; i < 1000; i++) {
        asdic_text_format(&text, "%d,", i);
    }
    assert_int_equal(text.length, strlen(text.data));
    assert_string_equal(text.data + text.length - 8, "998,999,");
    char *taken = asdic_text_take(&text);
    assert_null(text.data);
    free(taken);
    asdic_text_add_json(&text, "a\"b\\c\n\x01\x7f\xc3\xa4");
    assert_string_equal(text.data, "\"a\\\"b\\\\c\\n\\u0001\\u007f\xc3\xa4\"");
    asdic_text_finish(&text);
    /* Half a character, and what JSON allows and YAML does not. */
    asdic_text_add_json(&text, "b\xe9ton \xe6\x97 \xc2\x85\xc2\xa0\xe6\x97\xa5\U0001d11e");
    assert_string_equal(text.data,
                        "\"b\\ufffdton \\ufffd\\ufffd \\u0085\xc2\xa0\xe6\x97\xa5\U0001d11e\"");
    asdic_text_finish(&text);
    char *empty = asdic_text_take(&text);
    assert_string_equal(empty, "");
    free(empty);
}

/* Files are read everywhere, and messages quote them, whatever the locale of the program. */
static void text_has_a_decimal_point(void **state) {
    (void)state;
    asdic_text text = {0};
    asdic_context *ctx = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    if (!set_german_locale()) {
        skip();
    }
    asdic_text_format(&text, "%.1f %g", 0.5, 1.25);
    asdic_fail(ctx, ASDIC_ERROR_INPUT, "%g is out of range [%g, %g]", 0.5, 1.25, 2.5);
    char comma[16];
    snprintf(comma, sizeof comma, "%.1f", 0.5);
    setlocale(LC_ALL, "C");
    assert_string_equal(text.data, "0.5 1.25");
    assert_string_equal(asdic_context_error(ctx), "0.5 is out of range [1.25, 2.5]");
    asdic_context_destroy(&ctx);
    assert_string_equal(comma, "0,5"); /* the caller's locale is as it was */
    asdic_text_finish(&text);
}

static void arena_gives_aligned_zeros(void **state) {
    (void)state;
    asdic_arena arena = {0};
    for (size_t bytes = 1; bytes < 100000; bytes = bytes * 3 + 1) {
        char *object = asdic_arena_alloc(&arena, bytes);
        assert_non_null(object);
        assert_int_equal((uintptr_t)object % _Alignof(max_align_t), 0);
        for (size_t i = 0; i < bytes; i++) {
            assert_int_equal(object[i], 0);
        }
        memset(object, 0xaa, bytes);
    }
    assert_string_equal(asdic_arena_string(&arena, "abc", 2), "ab");
    assert_null(asdic_arena_alloc(&arena, SIZE_MAX));
    asdic_arena_finish(&arena);
    assert_null(arena.blocks);
}

static void whole_numbers_are_whole(void **state) {
    (void)state;
    int64_t value = 0;
    assert_null(asdic_integer_parse("2e4", 3, &value));
    assert_int_equal(value, 20000);
    assert_null(asdic_integer_parse("-9007199254740992", 17, &value));
    assert_int_equal(value, -9007199254740992);
    assert_string_equal(asdic_integer_parse("1e16", 4, &value),
                        "is too large: whole numbers go to 2^53 = 9007199254740992");
    assert_string_equal(asdic_integer_parse("1.5", 3, &value), "is not a whole number");
    assert_string_equal(asdic_integer_parse("x", 1, &value), "is not a number");
    assert_int_equal(value, -9007199254740992);
    /* Whatever a double rounds them to. */
    static const struct {
        const char *text;
        int64_t value; /* -1: not whole; -2: too large */
    } near[] = {{"9007199254740992.5", -1},
                {"9007199254740991.5", -1},
                {"9007199254740991.4", -1},
                {"4503599627370496.3", -1},
                {"20000.00000000000000001", -1},
                {"0.99999999999999999999", -1},
                {"1e-400", -1},
                {"1e-99999999999999999999", -1},
                {"12345e-1", -1},
                {"9007199254740993", -2},
                {"900719925474099.3e1", -2},
                {"9007199254740994", -2},
                {"9007199254740992.0", 9007199254740992},
                {"9.007199254740992e15", 9007199254740992},
                {"9007199254740991", 9007199254740991},
                {"90071992547409910e-1", 9007199254740991},
                {"0.5e1", 5},
                {".5e1", 5},
                {"-0.000e-5", 0},
                {"0e99999999999999999999", 0},
                {"+120.", 120}};
    for (size_t i = 0; i < sizeof near / sizeof *near; i++) {
        const char *why = asdic_integer_parse(near[i].text, strlen(near[i].text), &value);
        print_message("%s: %s\n", near[i].text, why ? why : "whole");
        assert_true(!why == (near[i].value >= 0) && (why || value == near[i].value));
        assert_true(!why || !strstr(why, "too large") == (near[i].value == -1));
    }
}

/* "-" alone is standard input; a path that begins or ends with it is a file's. */
static void a_dash_is_standard_input(void **state) {
    (void)state;
    char *data = NULL;
    size_t bytes = 0;
    int saved = dup(STDIN_FILENO), ends[2];
    assert_int_equal(pipe(ends), 0);
    assert_int_equal(write(ends[1], "depth", 5), 5);
    close(ends[1]);
    assert_int_equal(dup2(ends[0], STDIN_FILENO), STDIN_FILENO);
    assert_int_equal(asdic_file_read_piped(NULL, "-", 5, &data, &bytes), ASDIC_OK);
    assert_int_equal(bytes, 5);
    assert_string_equal(data, "depth");
    free(data);
    dup2(saved, STDIN_FILENO);
    close(saved);
    close(ends[0]);
    assert_int_equal(asdic_file_read_piped(NULL, "--", 5, &data, &bytes), ASDIC_ERROR_INPUT);
}

static void files_are_read_whole_or_refused(void **state) {
    (void)state;
    asdic_context *ctx = NULL;
    char *data = NULL;
    size_t bytes = 0;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    FILE *file = tmpfile();
    assert_non_null(file);
    for (int i = 0; i < 100000; i++) {
        fprintf(file, "%09d\n", i);
    }
    fflush(file);
    char path[64];
    snprintf(path, sizeof path, "/proc/self/fd/%d", fileno(file));
    assert_int_equal(asdic_file_read(ctx, path, 1000000, &data, &bytes), ASDIC_OK);
    assert_int_equal(bytes, 1000000);
    assert_int_equal(data[bytes], 0);
    assert_string_equal(data + 999990, "000099999\n");
    free(data);
    data = NULL;
    assert_int_equal(asdic_file_read(ctx, path, 999999, &data, &bytes), ASDIC_ERROR_INPUT);
    assert_null(data);
    assert_non_null(strstr(asdic_context_error(ctx), ": longer than 999999 bytes"));
    fclose(file);
    assert_int_equal(asdic_file_read(ctx, "/tmp", 1000, &data, &bytes), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx), "/tmp: cannot read: Is a directory");
    assert_int_equal(asdic_file_read(ctx, "/nonexistent/a", 9, &data, &bytes), ASDIC_ERROR_INPUT);
    assert_string_equal(asdic_context_error(ctx),
                        "/nonexistent/a: cannot open: No such file or directory");
    asdic_context_destroy(&ctx);
}

typedef struct tally {
    size_t step, count;
    atomic_int taken[100];
    atomic_int at_work[ASDIC_SHARE_MOST]; /* by worker */
} tally;

static void take(void *user, unsigned worker, size_t first, size_t end) {
    tally *t = user;
    assert_int_equal(atomic_fetch_add(&t->at_work[worker], 1), 0);
    assert_int_equal(first % t->step, 0);
    assert_true(end == first + t->step || (end == t->count && end < first + t->step));
    for (size_t i = first; i < end; i++) {
        atomic_fetch_add(&t->taken[i], 1);
    }
    sched_yield();
    atomic_fetch_sub(&t->at_work[worker], 1);
}

static void shares_are_taken_once(void **state) {
    (void)state;
    static const size_t counts[] = {0, 1, 7, 64, 100}, steps[] = {1, 3, 64, 200};
    static const unsigned threads[] = {0, 1, 2, 5, 1000};
    for (size_t k = 0; k < 5 * 4 * 5; k++) {
        tally t = {.step = steps[k / 5 % 4], .count = counts[k % 5]};
        asdic_share(threads[k / 20], t.count, t.step, take, &t);
        for (size_t i = 0; i < 100; i++) {
            assert_int_equal(t.taken[i], i < t.count ? 1 : 0);
        }
    }
}

/* A process that was given one processor of many counts one. */
static void processors_are_those_that_may_be_used(void **state) {
    (void)state;
    cpu_set_t all, one;
    assert_int_equal(sched_getaffinity(0, sizeof all, &all), 0);
    assert_int_equal(asdic_processors(), CPU_COUNT(&all));
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; i++) {
        if (CPU_ISSET(i, &all)) {
            CPU_SET(i, &one);
        }
    }
    assert_int_equal(sched_setaffinity(0, sizeof one, &one), 0);
    assert_int_equal(asdic_processors(), 1);
    assert_int_equal(sched_setaffinity(0, sizeof all, &all), 0);
}

/* The process has no more than the system, and than its limit leaves beside what it has. */
static void memory_is_what_limits_leave(void **state) {
    (void)state;
    unsigned long long pages = 0;
    struct rlimit before, limit;
    FILE *file = fopen("/proc/self/statm", "re");
    if (!file || fscanf(file, "%llu", &pages) != 1) {
        skip();
    }
    fclose(file);
    assert_int_equal(getrlimit(RLIMIT_AS, &before), 0);
    if (before.rlim_cur != RLIM_INFINITY) {
        skip();
    }
    const uint64_t has = pages * (uint64_t)sysconf(_SC_PAGESIZE), room = 64u << 20;
    limit = (struct rlimit){has + room, before.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
    uint64_t left = asdic_memory_left();
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    assert_in_range(left, room / 2, room);
    assert_true(asdic_memory_left() > room);
    limit.rlim_cur = (rlim_t)1 << 60; /* more than any system has */
    assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
    left = asdic_memory_left();
    assert_int_equal(setrlimit(RLIMIT_AS, &before), 0);
    assert_true(left < (uint64_t)1 << 50);
}

static void put(const char *root, const char *name, const char *text) {
    char path[256];
    snprintf(path, sizeof path, "%s/%s", root, name);
    for (char *slash = strchr(path + strlen(root) + 1, '/'); slash;
         slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

/* What each group leaves: its limit less what it holds; of cached files it holds none. */
static void memory_is_what_control_groups_leave(void **state) {
    (void)state;
    static const struct {
        const char *name, *text;
    } files[] = {
        /* version 2: a job of 1000 bytes, a step without a limit, a task of 600 */
        {"two/job/memory.max", "1000\n"},
        {"two/job/memory.current", "800\n"},
        {"two/job/memory.stat", "anon 500\nfile 300\ninactive_file 200\nactive_file 100\n"},
        {"two/job/step/memory.max", "max\n"},
        {"two/job/step/memory.current", "800\n"},
        {"two/job/step/task/memory.max", "600\n"},
        {"two/job/step/task/memory.current", "190\n"},
        {"two/full/memory.max", "600\n"},
        {"two/full/memory.current", "700\n"},
        /* version 1: no limit is a large one */
        {"one/memory/memory.limit_in_bytes", "9223372036854771712\n"},
        {"one/memory/memory.usage_in_bytes", "5000\n"},
        {"one/memory/job/memory.limit_in_bytes", "2000\n"},
        {"one/memory/job/memory.usage_in_bytes", "1500\n"},
        {"one/memory/job/memory.stat", "inactive_file 7\ntotal_inactive_file 400\n"
                                       "total_active_file 50\n"},
        {"one/memory/job/step/memory.limit_in_bytes", "9223372036854771712\n"},
        /* a container's root */
        {"box/memory.max", "300\n"},
        {"box/memory.current", "100\n"},
    };
    static const struct {
        const char *root, *table;
        uint64_t left;
    } cases[] = {
        {"two", "0::/job/step/task\n", 410},
        {"two", "0::/job/step\n", 500},
        {"two", "0::/full\n", 0},
        {"two", "0::/\n", UINT64_MAX},
        {"two", "0::/other\n", UINT64_MAX},
        {"one", "5:cpu:/job\n4:memory:/job/step\n0::/\n", 950},
        {"one", "4:hugetlb,memory:/job\n", 950},
        {"one", "4:memory:/\n", 9223372036854771712u - 5000},
        {"one", "4:memory_not:/job\n5:cpuset:/memory/job\nnothing\n", UINT64_MAX},
        {"box", "0::/\n", 200},
        {"box", "0::/system.slice/docker-12ab.scope\n", 200},
    };
    char root[] = "/tmp/asdic-groups-XXXXXX", below[64], table[64], remove[64];
    assert_non_null(mkdtemp(root));
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        put(root, files[i].name, files[i].text);
    }
    snprintf(table, sizeof table, "%s/table", root);
    assert_true(asdic_memory_groups_left(table, root) == UINT64_MAX);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        put(root, "table", cases[i].table);
        snprintf(below, sizeof below, "%s/%s", root, cases[i].root);
        uint64_t left = asdic_memory_groups_left(table, below);
        if (left != cases[i].left) {
            fail_msg("case %zu: %llu", i, (unsigned long long)left);
        }
    }
    snprintf(remove, sizeof remove, "rm -r %s", root);
    assert_int_equal(system(remove), 0);
}

static bool fits(const regex_t *form, const char *text) {
    return regexec(form, text, 0, NULL, 0) == 0;
}

/* Every text of up to five of these bytes, against what a grammar makes of it and strtod. */
static void numbers_are_those_of_a_grammar(void **state) {
    (void)state;
    static const char bytes[] = "02.e+-,_x"; /* and its NUL */
    regex_t zeros, number, other, digit;
    const int flags = REG_EXTENDED | REG_NOSUB;
    assert_int_equal(regcomp(&zeros, "^[+-]?0[0-9]", flags), 0);
    assert_int_equal(regcomp(&number, "^[+-]?([0-9]+[.]?[0-9]*|[.][0-9]+)(e[+-]?[0-9]+)?$", flags),
                     0);
    assert_int_equal(regcomp(&other, "[^-0-9+.,_e]", flags), 0);
    assert_int_equal(regcomp(&digit, "[0-9]", flags), 0);
    for (size_t length = 0, texts = 1; length <= 5; length++, texts *= sizeof bytes) {
        for (size_t n = 0; n < texts; n++) {
            char text[6] = "", shown[6] = "";
            for (size_t i = 0, left = n; i < length; i++, left /= sizeof bytes) {
                text[i] = bytes[left % sizeof bytes];
                shown[i] = text[i] ? text[i] : 'x';
            }
            bool has_digit = fits(&digit, shown), is_other = fits(&other, shown);
            const char *want = "is not a number";
            if (fits(&zeros, shown)) {
                want = "is not a decimal number; leave out leading zeros";
            } else if (fits(&number, shown)) {
                want = isfinite(strtod(shown, NULL)) ? NULL : "is too large for a double";
            } else if (has_digit && !is_other && strchr(shown, ',')) {
                want = "is not a number; the decimal separator is a point, digits are not grouped";
            } else if (has_digit && !is_other && strchr(shown, '_')) {
                want = "is not a number; digits are not grouped";
            }
            double value = -1.0;
            const char *why = asdic_number_parse(text, length, &value);
            if (!want) {
                assert_null(why);
                assert_true(value == strtod(shown, NULL));
            } else if (!why || strcmp(why, want) != 0) {
                fail_msg("'%s' %s; expected: it %s", shown, why ? why : "is a number", want);
            }
        }
    }
    regfree(&zeros);
    regfree(&number);
    regfree(&other);
    regfree(&digit);
}

enum { SQUARE, NOTHING, HOLE, PEAK, NOISE, KINDS };

typedef struct counted {
    size_t calls;
    int kind;
} counted;

static double integrand(double x, void *user) {
    counted *c = user;
    bool is_middle = fabs(x - 0.5) < 0.01;
    c->calls++;
    return c->kind == SQUARE                 ? x * x
           : c->kind == NOISE                ? 1.0 + fmod(43758.5453 * sin(1e9 * x), 1.0)
           : c->kind == PEAK && is_middle    ? (double)INFINITY
           : c->kind == NOTHING || is_middle ? (double)NAN
                                             : 1.0;
}

/* What is no number anywhere once asked for 2^40 panels. */
static void integrals_end(void **state) {
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        counted c = {0, kind};
        double sum = asdic_quadrature(integrand, &c, 0.0, 1.0, 1e-7);
        assert_true(c.calls <= 15 * 100002);
        assert_true(kind != SQUARE || fabs(sum - 1.0 / 3.0) < 1e-12);
        assert_true((kind != NOTHING && kind != HOLE) || isnan(sum));
    }
}

/* Of any length, with anything anywhere, and nothing beside it. */
static void what_is_cleared_is_zero(void **state) {
    (void)state;
    enum { MOST = 150, EDGE = 3 };
    for (size_t length = 0; length <= MOST; length++) {
        for (size_t at = 0; at <= length; at++) {
            unsigned char bytes[EDGE + MOST + EDGE] = {0};
            bytes[EDGE - 1] = bytes[EDGE + length] = 7;
            bytes[EDGE + at] |= 0x80; /* at the very end: beside it */
            asdic_clear(bytes + EDGE, length);
            for (size_t i = 0; i < length; i++) {
                assert_int_equal(bytes[EDGE + i], 0);
            }
            assert_int_equal(bytes[EDGE - 1], 7);
            assert_int_equal(bytes[EDGE + length], at == length ? 0x87 : 7);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_those_of_a_grammar),
        cmocka_unit_test(integrals_end),
        cmocka_unit_test(what_is_cleared_is_zero),
        cmocka_unit_test(first_of_many_are_kept),
        cmocka_unit_test(sha256_meets_published_vectors),
        cmocka_unit_test(sha256_takes_every_length),
        cmocka_unit_test(text_grows_and_quotes),
        cmocka_unit_test(text_has_a_decimal_point),
        cmocka_unit_test(arena_gives_aligned_zeros),
        cmocka_unit_test(whole_numbers_are_whole),
        cmocka_unit_test(files_are_read_whole_or_refused),
        cmocka_unit_test(a_dash_is_standard_input),
        cmocka_unit_test(shares_are_taken_once),
        cmocka_unit_test(processors_are_those_that_may_be_used),
        cmocka_unit_test(memory_is_what_limits_leave),
        cmocka_unit_test(memory_is_what_control_groups_leave),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
