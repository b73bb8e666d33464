/* Buffers, programs and kernels on the device at hand. */
#include "asserts.h"
#include "test_device.h"

#include "ocl/opencl.h"

#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static test_device t;

static int use_test_kernels(void **state) {
    (void)state;
    return setenv("ASDIC_KERNEL_DIR", TEST_DIR "/unit/kernels", 1);
}

static int use_embedded_kernels(void **state) {
    (void)state;
    return unsetenv("ASDIC_KERNEL_DIR");
}

static void buffer_gives_back_what_was_written(void **state) {
    (void)state;
    asdic_buffer *buffer = NULL;
    int in[5] = {1, 2, 3, 4, 5}, out[5] = {0};
    assert_ok(t.ctx, asdic_buffer_create(t.device, sizeof in, in, &buffer));
    assert_int_equal(asdic_buffer_bytes(buffer), sizeof in);
    assert_ok(t.ctx, asdic_buffer_write(buffer, 4, 4, &in[4]));
    assert_ok(t.ctx, asdic_buffer_read(buffer, 0, sizeof out, out));
    assert_int_equal(out[0], 1);
    assert_int_equal(out[1], 5);
    assert_int_equal(out[4], 5);
    asdic_buffer_destroy(&buffer);
    assert_null(buffer);
    asdic_buffer_destroy(&buffer);
}

/* In a buffer's own memory is what was written last to the part that is read, by whatever way, once it has been waited
 * for: of a small buffer, of one that a processor shares, and of one in huge pages. */
static void buffer_is_read_to_its_own_memory(void **state) {
    (void)state;
    const size_t sizes[] = {64, (size_t)1 << 14, (size_t)5 << 20};
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        size_t bytes = sizes[k], half = bytes / 2;
        asdic_buffer *buffer = NULL;
        asdic_fetch fetch;
        unsigned char *out = malloc(bytes), *in = out;
        memset(in, 0xa5, bytes);
        assert_ok(t.ctx, asdic_buffer_create(t.device, bytes, in, &buffer));
        unsigned char *own = asdic_buffer_memory(buffer);
        assert_non_null(own);
        assert_ptr_equal(asdic_buffer_memory(buffer), own);
        assert_ok(t.ctx, asdic_buffer_read(buffer, 0, bytes, own));
        assert_memory_equal(own, in, bytes);
        assert_ok(t.ctx, asdic_buffer_zero(buffer, half));
        assert_ok(t.ctx, asdic_buffer_fetch(buffer, half - 8, 16, own + half - 8, &fetch));
        assert_ok(t.ctx, asdic_fetch_wait(&fetch));
        assert_memory_equal(own + half - 8, "\0\0\0\0\0\0\0\0\245\245\245\245\245\245\245\245", 16);
        assert_ok(t.ctx, asdic_buffer_read(buffer, 8, bytes - 8, out));
        assert_int_equal(out[0], 0);
        assert_int_equal(out[bytes - 9], 0xa5);
        assert_int_equal(asdic_buffer_read(buffer, bytes - 4, 8, own + bytes - 4),
                         ASDIC_ERROR_ARGUMENT);
        asdic_buffer_destroy(&buffer);
        free(out);
    }
}

static void buffer_zero_clears_exactly_the_bytes_asked_for(void **state) {
    (void)state;
    const size_t lengths[] = {0, 1, 4, 7, 16, 20, 32};
    for (size_t k = 0; k < sizeof lengths / sizeof lengths[0]; k++) {
        asdic_buffer *buffer = NULL;
        unsigned char bytes[33];
        memset(bytes, 0xa5, sizeof bytes);
        assert_ok(t.ctx, asdic_buffer_create(t.device, sizeof bytes, bytes, &buffer));
        assert_ok(t.ctx, asdic_buffer_zero(buffer, lengths[k]));
        assert_ok(t.ctx, asdic_buffer_read(buffer, 0, sizeof bytes, bytes));
        for (size_t i = 0; i < sizeof bytes; i++) {
            assert_int_equal(bytes[i], i < lengths[k] ? 0 : 0xa5);
        }
        asdic_buffer_destroy(&buffer);
    }
}

/* However often a device says that its driver may compile, and that it has: the context counts the device once, and
 * one that has ended is forgotten. */
static void a_device_compiles_or_does_not(void **state) {
    (void)state;
    asdic_device_has_compiled(t.device);
    for (int k = 0; k < 2; k++) {
        assert_false(asdic_context_compiles(t.ctx));
        asdic_device_may_compile(t.device);
        asdic_device_may_compile(t.device);
        assert_true(asdic_context_compiles(t.ctx));
        asdic_device_has_compiled(t.device);
        assert_false(asdic_context_compiles(t.ctx));
        asdic_device_has_compiled(t.device);
    }
}

static void empty_buffer_can_be_an_argument(void **state) {
    (void)state;
    asdic_buffer *buffer = NULL;
    assert_ok(t.ctx, asdic_buffer_create(t.device, 0, NULL, &buffer));
    assert_non_null(buffer);
    assert_ok(t.ctx, asdic_buffer_write(buffer, 0, 0, NULL));
    asdic_buffer_destroy(&buffer);
}

static void access_beyond_a_buffer_is_refused(void **state) {
    (void)state;
    asdic_buffer *buffer = NULL;
    char bytes[8] = {0};
    assert_ok(t.ctx, asdic_buffer_create(t.device, 4, NULL, &buffer));
    assert_status(t.ctx, asdic_buffer_write(buffer, 0, 8, bytes), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_buffer_read(buffer, 5, 0, bytes), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_buffer_read(buffer, SIZE_MAX, 2, bytes), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_buffer_zero(buffer, 5), ASDIC_ERROR_ARGUMENT);
    asdic_buffer_destroy(&buffer);
}

static void allocation_beyond_the_limit_names_both_numbers(void **state) {
    (void)state;
    asdic_buffer *buffer = NULL;
    const asdic_device_info *info = asdic_device_get_info(t.device);
    size_t bytes = (size_t)info->max_alloc_bytes + 1048576;
    char text[64];
    assert_status(t.ctx, asdic_buffer_create(t.device, bytes, NULL, &buffer), ASDIC_ERROR_MEMORY);
    assert_null(buffer);
    snprintf(text, sizeof text, "%.1f MiB in one buffer", (double)info->max_alloc_bytes / 1048576);
    assert_contains(asdic_context_error(t.ctx), text);
    snprintf(text, sizeof text, "%.1f MiB are needed", (double)bytes / 1048576);
    assert_contains(asdic_context_error(t.ctx), text);
}

static void no_device_has_no_information(void **state) {
    (void)state;
    assert_null(asdic_device_get_info(NULL));
}

static void kernel_computes(void **state) {
    (void)state;
    asdic_buffer *a = NULL, *b = NULL;
    asdic_kernel *kernel = NULL;
    int values[100];
    cl_uint n = 100;
    int amount = 7;
    for (int i = 0; i < 100; i++) {
        values[i] = i;
    }
    assert_ok(t.ctx,
              asdic_kernel_create(t.device, "simple.cl", "-D AMOUNT_SCALE=2", "add", &kernel));
    assert_ok(t.ctx, asdic_buffer_create(t.device, sizeof values, values, &a));
    assert_ok(t.ctx, asdic_buffer_create(t.device, sizeof values, NULL, &b));
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(a), ASDIC_ARG_BUFFER(b), ASDIC_ARG_VALUE(amount),
                               ASDIC_ARG_VALUE(n)};
    for (int run = 0; run < 2; run++) { /* a driver may compile for the first alone */
        assert_ok(t.ctx, asdic_kernel_run(kernel, args, 4, 100, 64));
        assert_int_equal(asdic_context_compiles(t.ctx), run == 0);
        assert_ok(t.ctx, asdic_device_finish(t.device));
        assert_false(asdic_context_compiles(t.ctx));
    }
    assert_ok(t.ctx, asdic_buffer_read(b, 0, sizeof values, values));
    for (int i = 0; i < 100; i++) {
        assert_int_equal(values[i], i + 14);
    }
    asdic_buffer_destroy(&a);
    asdic_buffer_destroy(&b);
    asdic_kernel_destroy(&kernel);
    assert_null(kernel);
}

/* Global and local size a launch of the kernel "sizes" really had. */
static void launch_sizes(asdic_kernel *kernel, size_t global, size_t local, cl_uint out[3]) {
    asdic_buffer *buffer = NULL;
    assert_ok(t.ctx, asdic_buffer_create(t.device, 3 * sizeof *out, NULL, &buffer));
    asdic_kernel_arg args[] = {
        ASDIC_ARG_BUFFER(buffer),
        ASDIC_ARG_LOCAL(sizeof(cl_uint) * asdic_kernel_max_work_group(kernel))};
    memset(out, 0, 3 * sizeof *out);
    assert_ok(t.ctx, asdic_buffer_write(buffer, 0, 3 * sizeof *out, out));
    assert_ok(t.ctx, asdic_kernel_run(kernel, args, 2, global, local));
    assert_ok(t.ctx, asdic_buffer_read(buffer, 0, 3 * sizeof *out, out));
    asdic_buffer_destroy(&buffer);
}

static void work_group_is_lowered_and_range_rounded_up(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    cl_uint got[3];
    assert_ok(t.ctx, asdic_kernel_create(t.device, "simple.cl", "", "sizes", &kernel));
    size_t most = asdic_kernel_max_work_group(kernel);
    assert_true(most >= 1);

    launch_sizes(kernel, 5, 4 < most ? 4 : most, got);
    assert_int_equal(got[1], 4 < most ? 4 : most);
    assert_int_equal(got[0], 4 < most ? 8 : 5);
    assert_int_equal(got[2], 1);

    for (size_t global = 1; global <= 9; global++) { /* whole groups, and none too many */
        size_t local = most < 3 ? most : 3;
        launch_sizes(kernel, global, local, got);
        assert_int_equal(got[0], global % local ? global + local - global % local : global);
    }

    launch_sizes(kernel, most + 1, most * 16, got);
    assert_int_equal(got[1], most);
    assert_int_equal(got[0], most == 1 ? 2 : 2 * most);

    launch_sizes(kernel, 6, 0, got); /* the device chooses: the range stays */
    assert_int_equal(got[0], 6);

    launch_sizes(kernel, 0, 4, got); /* nothing to do */
    assert_int_equal(got[0], 0);
    asdic_kernel_destroy(&kernel);
}

/* What a kernel may have by the driver's word: less than the device, where registers run short. 0: as it is. */
static size_t kernel_limit;

cl_int __real_clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
                                       cl_kernel_work_group_info what, size_t room, void *to,
                                       size_t *length);
cl_int __wrap_clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
                                       cl_kernel_work_group_info what, size_t room, void *to,
                                       size_t *length);

cl_int __wrap_clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
                                       cl_kernel_work_group_info what, size_t room, void *to,
                                       size_t *length) {
    cl_int code = __real_clGetKernelWorkGroupInfo(kernel, device, what, room, to, length);
    if (code == CL_SUCCESS && what == CL_KERNEL_WORK_GROUP_SIZE && kernel_limit > 0) {
        memcpy(to, &kernel_limit, sizeof kernel_limit);
    }
    return code;
}

static void a_kernel_may_take_less_than_its_device(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    cl_uint got[3];
    assert_ok(t.ctx, asdic_kernel_create(t.device, "simple.cl", "", "sizes", &kernel));
    size_t most = asdic_kernel_max_work_group(kernel);
    asdic_kernel_destroy(&kernel);
    if (most < 4) {
        skip();
    }
    kernel_limit = 3;
    asdic_status status = asdic_kernel_create(t.device, "simple.cl", "", "sizes", &kernel);
    kernel_limit = 0;
    assert_ok(t.ctx, status);
    assert_int_equal(asdic_kernel_max_work_group(kernel), 3);
    launch_sizes(kernel, 7, 64, got);
    assert_int_equal(got[0], 9);
    assert_int_equal(got[1], 3);
    asdic_kernel_destroy(&kernel);
}

static size_t program_count(void) {
    size_t count = 0;
    for (const asdic_program *p = t.device->programs; p; p = p->next) {
        count++;
    }
    return count;
}

static void same_source_and_options_share_a_program(void **state) {
    (void)state;
    asdic_kernel *a = NULL, *b = NULL, *c = NULL;
    size_t before = program_count();
    assert_ok(t.ctx, asdic_kernel_create(t.device, "simple.cl", "-D CACHE=1", "add", &a));
    assert_int_equal(program_count(), before + 1);
    assert_ok(t.ctx, asdic_kernel_create(t.device, "simple.cl", "-D CACHE=1", "sizes", &b));
    assert_int_equal(program_count(), before + 1);
    assert_ok(t.ctx, asdic_kernel_create(t.device, "simple.cl", "-D CACHE=2", "add", &c));
    assert_int_equal(program_count(), before + 2);
    asdic_kernel_destroy(&a);
    asdic_kernel_destroy(&b);
    asdic_kernel_destroy(&c);
}

/* Copies of text that there is memory for. */
static int copies_left = INT_MAX;

char *__real_strdup(const char *text);
char *__wrap_strdup(const char *text);

char *__wrap_strdup(const char *text) {
    return copies_left-- > 0 ? __real_strdup(text) : NULL;
}

/* A program has a copy of its name and one of its options. */
static void programs_without_names_are_none(void **state) {
    (void)state;
    size_t before = program_count();
    for (int copies = 0; copies < 2; copies++) {
        cl_program id = NULL;
        copies_left = copies;
        asdic_status status = asdic_program_get(t.device, "simple.cl", "-D CACHE=3", &id);
        copies_left = INT_MAX;
        assert_int_equal(status, ASDIC_ERROR_MEMORY);
        assert_null(id);
        assert_int_equal(program_count(), before);
    }
}

static void compile_error_names_file_and_line(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    size_t before = program_count();
    assert_status(t.ctx, asdic_kernel_create(t.device, "broken.cl", "", "broken", &kernel),
                  ASDIC_ERROR_DEVICE);
    assert_null(kernel);
    if (strstr(asdic_device_get_info(t.device)->name, "Oclgrind")) {
        assert_contains(asdic_context_error(t.ctx), "kernels/broken.cl"); /* it ignores #line */
    } else {
        assert_contains(asdic_context_error(t.ctx), "kernels/broken.cl:4");
    }
    assert_contains(asdic_context_error(t.ctx), "nowhere");
    assert_null(strchr(asdic_context_error(t.ctx), '\n'));
    assert_int_equal(program_count(), before); /* a failure is not cached */
}

static void missing_kernel_and_source_are_named(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    assert_status(t.ctx, asdic_kernel_create(t.device, "simple.cl", "", "absent", &kernel),
                  ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(t.ctx), "no kernel 'absent' in kernels/simple.cl");
    assert_status(t.ctx, asdic_kernel_create(t.device, "absent.cl", "", "add", &kernel),
                  ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(t.ctx), "absent.cl");
    assert_null(kernel);
}

static void unknown_embedded_source_is_named(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    assert_status(t.ctx, asdic_kernel_create(t.device, "broken.cl", "", "add", &kernel),
                  ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(t.ctx), "no kernel source 'broken.cl'");
}

/* Lets the lock on the cache go after a while. */
static void *release_later(void *fd) {
    const struct timespec a_while = {.tv_nsec = 300000000};
    nanosleep(&a_while, NULL);
    close(*(int *)fd);
    return NULL;
}

static double now_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void pocl_builds_one_program_at_a_time(void **state) {
    (void)state;
    asdic_kernel *kernel = NULL;
    pthread_t thread;
    const char *cache = getenv("POCL_CACHE_DIR");
    if (!cache || !strstr(asdic_device_get_info(t.device)->platform_name, "Portable Computing")) {
        skip();
    }
    int fd = open(cache, O_RDONLY | O_DIRECTORY);
    assert_true(fd >= 0);
    assert_int_equal(flock(fd, LOCK_EX), 0);
    double begin_s = now_s();
    assert_int_equal(pthread_create(&thread, NULL, release_later, &fd), 0);
    asdic_status status = asdic_kernel_create(t.device, "simple.cl", "-D LOCK=1", "add", &kernel);
    double took_s = now_s() - begin_s;
    pthread_join(thread, NULL);
    assert_ok(t.ctx, status);
    assert_true(took_s >= 0.3);
    asdic_kernel_destroy(&kernel);
}

/* Sets NAME to VALUE; NULL: takes it out. */
static void put_in_environment(const char *name, const char *value) {
    assert_int_equal(value ? setenv(name, value, 1) : unsetenv(name), 0);
}

/* The folder in which PoCL keeps what it compiled is what is locked, wherever the environment has it; nothing is where
 * there is none, or the driver is another. */
static void the_cache_that_is_used_is_locked(void **state) {
    (void)state;
    static const char *const names[] = {"POCL_CACHE_DIR", "XDG_CACHE_HOME", "HOME"};
    static const struct {
        const char *values[3], *locked;
    } cases[] = {{{"c", "x", "h"}, "c"},
                 {{"", "x", "h"}, "x/pocl/kcache"},
                 {{NULL, "x", "h"}, "x/pocl/kcache"},
                 {{NULL, "", "h"}, "h/.cache/pocl/kcache"},
                 {{NULL, NULL, "h"}, "h/.cache/pocl/kcache"},
                 {{"none", "x", "h"}, NULL},
                 {{NULL, NULL, NULL}, NULL}};
    char folder[] = "/tmp/asdic-cache-XXXXXX", command[256], *kept[3];
    asdic_device device = {.info = {.platform_name = "Portable Computing Language"}};
    asdic_device other = {.info = {.platform_name = "Portable"}};
    int here = open(".", O_RDONLY | O_DIRECTORY);
    assert_non_null(mkdtemp(folder));
    assert_int_equal(chdir(folder), 0);
    assert_int_equal(system("mkdir -p c x/pocl/kcache h/.cache/pocl/kcache"), 0);
    for (int k = 0; k < 3; k++) {
        const char *value = getenv(names[k]);
        kept[k] = value ? strdup(value) : NULL;
    }
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        struct stat locked, expected;
        for (int k = 0; k < 3; k++) {
            put_in_environment(names[k], cases[i].values[k]);
        }
        int lock = asdic_build_lock(&device);
        assert_int_equal(asdic_build_lock(&other), -1);
        if (cases[i].locked) {
            assert_int_equal(fstat(lock, &locked), 0);
            assert_int_equal(stat(cases[i].locked, &expected), 0);
            assert_true(locked.st_ino == expected.st_ino && locked.st_dev == expected.st_dev);
            int fd = open(cases[i].locked, O_RDONLY | O_DIRECTORY);
            assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), -1);
            asdic_build_unlock(lock);
            assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
            close(fd);
        } else {
            assert_int_equal(lock, -1);
        }
    }
    for (int k = 0; k < 3; k++) {
        put_in_environment(names[k], kept[k]);
        free(kept[k]);
    }
    assert_int_equal(fchdir(here), 0);
    close(here);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

static void devices_split_where_the_platform_can(void **state) {
    (void)state;
    asdic_device **parts = NULL;
    const asdic_device_info *info = asdic_device_get_info(t.device);
    asdic_status status = asdic_device_split(t.device, info->compute_units + 1, &parts);
    assert_int_equal(status, ASDIC_ERROR_UNSUPPORTED);
    assert_null(parts);
    assert_int_equal(asdic_device_split(t.device, 0, &parts), ASDIC_ERROR_ARGUMENT);
    cl_device_partition_property ways[16] = {0};
    bool equally = false;
    assert_int_equal(
        clGetDeviceInfo(t.device->id, CL_DEVICE_PARTITION_PROPERTIES, sizeof ways, ways, NULL),
        CL_SUCCESS);
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        equally = equally || ways[i] == CL_DEVICE_PARTITION_EQUALLY;
    }
    if (info->compute_units < 2 || !equally) {
        skip();
    }
    assert_ok(t.ctx, asdic_device_split(t.device, 2, &parts));
    asdic_buffer *buffer = NULL;
    int value = 42, back = 0;
    for (int i = 0; i < 2; i++) {
        assert_int_equal(asdic_device_get_info(parts[i])->compute_units, info->compute_units / 2);
        assert_ok(t.ctx, asdic_buffer_create(parts[i], sizeof value, &value, &buffer));
        assert_ok(t.ctx, asdic_buffer_read(buffer, 0, sizeof back, &back));
        assert_int_equal(back, 42);
        asdic_buffer_destroy(&buffer);
    }
    asdic_devices_close(&parts, 2);
    assert_null(parts);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(buffer_gives_back_what_was_written),
        cmocka_unit_test(buffer_is_read_to_its_own_memory),
        cmocka_unit_test(buffer_zero_clears_exactly_the_bytes_asked_for),
        cmocka_unit_test(a_device_compiles_or_does_not),
        cmocka_unit_test(empty_buffer_can_be_an_argument),
        cmocka_unit_test(no_device_has_no_information),
        cmocka_unit_test(access_beyond_a_buffer_is_refused),
        cmocka_unit_test(allocation_beyond_the_limit_names_both_numbers),
        cmocka_unit_test_setup(kernel_computes, use_test_kernels),
        cmocka_unit_test_setup(work_group_is_lowered_and_range_rounded_up, use_test_kernels),
        cmocka_unit_test_setup(a_kernel_may_take_less_than_its_device, use_test_kernels),
        cmocka_unit_test_setup(same_source_and_options_share_a_program, use_test_kernels),
        cmocka_unit_test_setup(programs_without_names_are_none, use_test_kernels),
        cmocka_unit_test_setup(compile_error_names_file_and_line, use_test_kernels),
        cmocka_unit_test_setup(missing_kernel_and_source_are_named, use_test_kernels),
        cmocka_unit_test_setup(pocl_builds_one_program_at_a_time, use_test_kernels),
        cmocka_unit_test(the_cache_that_is_used_is_locked),
        cmocka_unit_test_setup(unknown_embedded_source_is_named, use_embedded_kernels),
        cmocka_unit_test(devices_split_where_the_platform_can),
    };
    return test_device_end(&t, cmocka_run_group_tests_name("ocl", tests, NULL, NULL));
}
