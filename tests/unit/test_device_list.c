/* What drivers say of their devices, and which of these can be used: on made-up drivers, in the place of OpenCL's
 * loader. */
#include "asserts.h"
#include "test_context.h"

#include "ocl/opencl.h"

#define IS_LITTLE (__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)

typedef struct made_device {
    const char *name, *version, *profile, *extensions; /* NULL: no answer */
    cl_device_type type;
    cl_bool is_little, is_available, has_compiler, is_mute; /* mute: no answer to anything */
} made_device;

typedef struct made_platform {
    const char *name;
    cl_uint count;
    made_device *devices;
    bool is_gone; /* when it is asked which */
} made_platform;

static made_device devices[2];
static made_platform platforms[3];
static cl_uint platform_count;
static bool are_platforms_gone;

/* ---- in the place of the loader --------------------------------------------------------------- */

cl_int __wrap_clGetPlatformIDs(cl_uint room, cl_platform_id *ids, cl_uint *count);
cl_int __wrap_clGetPlatformIDs(cl_uint room, cl_platform_id *ids, cl_uint *count) {
    if (ids && are_platforms_gone) {
        return CL_OUT_OF_HOST_MEMORY;
    }
    for (cl_uint i = 0; ids && i < room; i++) {
        ids[i] = (cl_platform_id)(void *)&platforms[i];
    }
    if (count) {
        *count = platform_count;
    }
    return platform_count ? CL_SUCCESS : -1001;
}

cl_int __wrap_clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room,
                             cl_device_id *ids, cl_uint *count);
cl_int __wrap_clGetDeviceIDs(cl_platform_id platform, cl_device_type type, cl_uint room,
                             cl_device_id *ids, cl_uint *count) {
    const made_platform *p = (void *)platform;
    assert_true(type == CL_DEVICE_TYPE_ALL);
    if (!p->count || (ids && p->is_gone)) {
        return CL_DEVICE_NOT_FOUND;
    }
    for (cl_uint i = 0; ids && i < room; i++) {
        ids[i] = (cl_device_id)(void *)&p->devices[i];
    }
    if (count) {
        *count = p->count;
    }
    return CL_SUCCESS;
}

static cl_int answer(const void *from, size_t bytes, size_t room, void *to) {
    if (!from || bytes > room) {
        return CL_INVALID_VALUE;
    }
    memcpy(to, from, bytes);
    return CL_SUCCESS;
}

static cl_int answer_text(const char *text, size_t room, void *to) {
    return answer(text, text ? strlen(text) + 1 : 0, room, to);
}

cl_int __wrap_clGetPlatformInfo(cl_platform_id id, cl_platform_info what, size_t room, void *to,
                                size_t *got);
cl_int __wrap_clGetPlatformInfo(cl_platform_id id, cl_platform_info what, size_t room, void *to,
                                size_t *got) {
    (void)got;
    assert_int_equal(what, CL_PLATFORM_NAME);
    return answer_text(((const made_platform *)(void *)id)->name, room, to);
}

cl_int __wrap_clGetDeviceInfo(cl_device_id id, cl_device_info what, size_t room, void *to,
                              size_t *got);
cl_int __wrap_clGetDeviceInfo(cl_device_id id, cl_device_info what, size_t room, void *to,
                              size_t *got) {
    static const cl_uint units = 7;
    static const size_t group = 1000;
    static const cl_ulong global = 40000000000u, local = 49152, alloc = 10000000000u;
    const made_device *d = (void *)id;
    (void)got;
    if (d->is_mute) {
        return CL_INVALID_DEVICE;
    }
    switch (what) {
    case CL_DEVICE_NAME:
        return answer_text(d->name, room, to);
    case CL_DEVICE_VENDOR:
        return answer_text("Maker", room, to);
    case CL_DRIVER_VERSION:
        return answer_text("5.1", room, to);
    case CL_DEVICE_VERSION:
        return answer_text(d->version, room, to);
    case CL_DEVICE_PROFILE:
        return answer_text(d->profile, room, to);
    case CL_DEVICE_EXTENSIONS:
        return answer_text(d->extensions, room, to);
    case CL_DEVICE_TYPE:
        return answer(&d->type, sizeof d->type, room, to);
    case CL_DEVICE_ENDIAN_LITTLE:
        return answer(&d->is_little, sizeof d->is_little, room, to);
    case CL_DEVICE_AVAILABLE:
        return answer(&d->is_available, sizeof d->is_available, room, to);
    case CL_DEVICE_COMPILER_AVAILABLE:
        return answer(&d->has_compiler, sizeof d->has_compiler, room, to);
    case CL_DEVICE_MAX_COMPUTE_UNITS:
        return answer(&units, sizeof units, room, to);
    case CL_DEVICE_MAX_WORK_GROUP_SIZE:
        return answer(&group, sizeof group, room, to);
    case CL_DEVICE_GLOBAL_MEM_SIZE:
        return answer(&global, sizeof global, room, to);
    case CL_DEVICE_LOCAL_MEM_SIZE:
        return answer(&local, sizeof local, room, to);
    case CL_DEVICE_MAX_MEM_ALLOC_SIZE:
        return answer(&alloc, sizeof alloc, room, to);
    default:
        return CL_INVALID_VALUE;
    }
}

/* ----------------------------------------------------------------------------------------------- */

/* One platform with two sound devices. */
static int setup(void **state) {
    (void)state;
    for (int i = 0; i < 2; i++) {
        devices[i] = (made_device){.name = "Card",
                                   .version = "OpenCL 1.2 made",
                                   .profile = "FULL_PROFILE",
                                   .extensions = "",
                                   .type = CL_DEVICE_TYPE_GPU,
                                   .is_little = IS_LITTLE,
                                   .is_available = CL_TRUE,
                                   .has_compiler = CL_TRUE};
    }
    platforms[0] = (made_platform){"Made", 2, devices, false};
    platform_count = 1;
    are_platforms_gone = false;
    return 0;
}

static void assert_listed(size_t count) {
    asdic_device_info *list = NULL;
    size_t listed = 99;
    assert_ok(ctx, asdic_device_list(ctx, &list, &listed));
    assert_int_equal(listed, count);
    assert_int_equal(list == NULL, count == 0);
    asdic_device_info_free(&list);
    assert_null(list);
}

static asdic_device_info first_listed(void) {
    asdic_device_info *list = NULL;
    size_t listed = 0;
    assert_ok(ctx, asdic_device_list(ctx, &list, &listed));
    assert_true(listed > 0);
    asdic_device_info info = list[0];
    asdic_device_info_free(&list);
    return info;
}

/* A platform without devices and one that is gone have none, and keep their numbers. */
static void devices_are_numbered_by_platform(void **state) {
    (void)state;
    asdic_device_info *list = NULL;
    size_t listed = 0;
    platforms[1] = platforms[0];
    platforms[0] = (made_platform){"Empty", 0, NULL, false};
    platforms[2] = (made_platform){"Single", 1, &devices[1], false};
    platform_count = 3;
    devices[1].name = "  Board, padded";
    assert_ok(ctx, asdic_device_list(ctx, &list, &listed));
    static const struct {
        unsigned platform, device;
        const char *name, *platform_name;
    } right[] = {
        {1, 0, "Card", "Made"}, {1, 1, "Board, padded", "Made"}, {2, 0, "Board, padded", "Single"}};
    assert_int_equal(listed, 3);
    for (size_t i = 0; i < 3; i++) {
        assert_int_equal(list[i].platform, right[i].platform);
        assert_int_equal(list[i].device, right[i].device);
        assert_string_equal(list[i].name, right[i].name);
        assert_string_equal(list[i].platform_name, right[i].platform_name);
    }
    asdic_device_info_free(&list);
    platforms[1].is_gone = true;
    assert_listed(1);
}

static void without_a_platform_there_is_no_device(void **state) {
    (void)state;
    size_t listed;
    asdic_device_info *list = NULL;
    assert_listed(2);
    are_platforms_gone = true;
    assert_listed(0);
    platform_count = 0;
    assert_listed(0);
    assert_status(ctx, asdic_device_list(ctx, NULL, &listed), ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_device_list(ctx, &list, NULL), ASDIC_ERROR_ARGUMENT);
    asdic_device_info_free(NULL);
}

static void a_device_is_as_its_driver_says(void **state) {
    (void)state;
    asdic_device_info info = first_listed();
    assert_string_equal(info.vendor, "Maker");
    assert_string_equal(info.driver, "5.1");
    assert_string_equal(info.version, "OpenCL 1.2 made");
    assert_string_equal(info.unusable_why, "");
    assert_int_equal(info.compute_units, 7);
    assert_int_equal(info.max_work_group, 1000);
    assert_true(info.global_bytes == 40000000000u && info.max_alloc_bytes == 10000000000u);
    assert_int_equal(info.local_bytes, 49152);
    assert_true(info.usable && info.available && info.has_compiler);
    /* Nothing is made up where a driver does not answer. */
    devices[0].is_mute = CL_TRUE;
    info = first_listed();
    assert_string_equal(info.name, "");
    assert_int_equal(info.kind, ASDIC_DEVICE_OTHER);
    assert_true(info.compute_units == 0 && info.max_work_group == 0 && info.global_bytes == 0 &&
                info.local_bytes == 0 && info.max_alloc_bytes == 0);
    assert_false(info.usable || info.available || info.has_compiler || info.has_fp64);
}

/* A simulator on the processor sets all of them. */
static void kinds_are_bits(void **state) {
    (void)state;
    static const struct {
        cl_device_type type;
        asdic_device_kind kind;
    } cases[] = {
        {CL_DEVICE_TYPE_CPU, ASDIC_DEVICE_CPU},
        {CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_DEFAULT, ASDIC_DEVICE_GPU},
        {CL_DEVICE_TYPE_ACCELERATOR, ASDIC_DEVICE_ACCELERATOR},
        {CL_DEVICE_TYPE_GPU | CL_DEVICE_TYPE_ACCELERATOR, ASDIC_DEVICE_GPU},
        {CL_DEVICE_TYPE_CUSTOM | CL_DEVICE_TYPE_DEFAULT, ASDIC_DEVICE_OTHER},
        {CL_DEVICE_TYPE_ALL, ASDIC_DEVICE_CPU},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        devices[0].type = cases[i].type;
        assert_int_equal(first_listed().kind, cases[i].kind);
    }
}

/* OpenCL 1.2, a compiler, 64-bit integers and this machine's byte order are needed. */
static void what_cannot_be_used_says_why(void **state) {
    (void)state;
    static const struct {
        made_device is; /* what is left out is as in setup() */
        bool is_foreign, is_away, is_binary_only;
        const char *why; /* "": it can be used */
    } cases[] = {
        {.why = ""},
        {.is.version = "OpenCL 2.0", .why = ""},
        {.is.version = "OpenCL 3.0 x", .why = ""},
        {.is.version = "OpenCL 1.1", .why = "its OpenCL is older than 1.2"},
        {.is.version = "OpenCL 0.9", .why = "its OpenCL is older than 1.2"},
        {.is.version = "OpenCL 2", .why = "its OpenCL is older than 1.2"},
        {.is_away = true, .why = "its driver says it is not available"},
        {.is_binary_only = true, .why = "it has no compiler for OpenCL C"},
        {.is_foreign = true, .why = "its byte order differs"},
        {.is.profile = "EMBEDDED_PROFILE", .why = "it has no 64-bit integers"},
        {.is.profile = "EMBEDDED_PROFILE", .is.extensions = "a cles_khr_int64", .why = ""},
        {.is.extensions = "cles_khr_int64", .why = ""},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        setup(state);
        made_device *d = &devices[0];
        d->version = cases[i].is.version ? cases[i].is.version : d->version;
        d->profile = cases[i].is.profile ? cases[i].is.profile : d->profile;
        d->extensions = cases[i].is.extensions ? cases[i].is.extensions : d->extensions;
        d->is_little = cases[i].is_foreign ? !IS_LITTLE : IS_LITTLE;
        d->is_available = !cases[i].is_away;
        d->has_compiler = !cases[i].is_binary_only;
        asdic_device_info info = first_listed();
        assert_contains(info.unusable_why, cases[i].why);
        assert_int_equal(info.usable, cases[i].why[0] == '\0');
        assert_int_equal(info.usable, info.unusable_why[0] == '\0');
    }
}

static void extensions_are_whole_words(void **state) {
    (void)state;
    static const struct {
        const char *text;
        bool has_fp64;
    } cases[] = {
        {"", false},
        {"cl_khr_fp64", true},
        {"cl_khr_fp64 b", true},
        {"a cl_khr_fp64", true},
        {"a cl_khr_fp64 b", true},
        {"cl_khr_fp64_x", false},
        {"x_cl_khr_fp64", false},
        {"x_cl_khr_fp64 b", false},
        {"cl_khr_fp64_x cl_khr_fp64", true},
        {"cl_khr_int64_base_atomics", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        devices[0].extensions = cases[i].text;
        assert_int_equal(first_listed().has_fp64, cases[i].has_fp64);
    }
    assert_true(first_listed().has_int64_atomics);
}

/* A driver's list that is longer than any is as none. */
static void a_text_without_end_is_none(void **state) {
    (void)state;
    static char text[100000];
    memset(text, ' ', sizeof text - 1);
    memcpy(text, "cl_khr_fp64", strlen("cl_khr_fp64"));
    devices[0].extensions = text;
    assert_false(first_listed().has_fp64);
    text[8000] = '\0';
    assert_true(first_listed().has_fp64);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(devices_are_numbered_by_platform, setup),
        cmocka_unit_test_setup(without_a_platform_there_is_no_device, setup),
        cmocka_unit_test_setup(a_device_is_as_its_driver_says, setup),
        cmocka_unit_test_setup(kinds_are_bits, setup),
        cmocka_unit_test_setup(what_cannot_be_used_says_why, setup),
        cmocka_unit_test_setup(extensions_are_whole_words, setup),
        cmocka_unit_test_setup(a_text_without_end_is_none, setup),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
