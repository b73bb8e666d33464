/* What --device chooses, on made-up lists: no device is needed. */
#include "asserts.h"

#include "base/share.h"
#include "ocl/opencl.h"
#include "sim/simulator.h"

static asdic_context *ctx;

static asdic_listed entry(unsigned platform, unsigned device, asdic_device_kind kind,
                          const char *name, const char *unusable_why) {
    asdic_listed item = {0};
    item.info.platform = platform;
    item.info.device = device;
    item.info.kind = kind;
    item.info.usable = unusable_why == NULL;
    snprintf(item.info.name, sizeof item.info.name, "%s", name);
    snprintf(item.info.platform_name, sizeof item.info.platform_name, "Platform %u", platform);
    snprintf(item.info.unusable_why, sizeof item.info.unusable_why, "%s",
             unusable_why ? unusable_why : "");
    return item;
}

static asdic_listed machine[5];
static size_t chosen[5], chosen_count;

static int setup(void **state) {
    (void)state;
    machine[0] = entry(0, 0, ASDIC_DEVICE_CPU, "pthread", NULL);
    machine[1] = entry(0, 1, ASDIC_DEVICE_CPU, "basic", NULL);
    machine[2] = entry(1, 0, ASDIC_DEVICE_GPU, "Old Radeon", "its OpenCL is older than 1.2");
    machine[3] = entry(1, 1, ASDIC_DEVICE_GPU, "New Radeon", NULL);
    machine[4] = entry(2, 0, ASDIC_DEVICE_ACCELERATOR, "Board", NULL);
    return 0;
}

static asdic_status choose(size_t count, const char *selector) {
    return asdic_listed_select(ctx, machine, count, selector, chosen, &chosen_count);
}

static void assert_chosen(const char *selector, size_t n, size_t first, size_t second) {
    assert_ok(ctx, choose(5, selector));
    assert_int_equal(chosen_count, n);
    assert_int_equal(chosen[0], first);
    if (n > 1) {
        assert_int_equal(chosen[1], second);
    }
}

static void auto_prefers_gpu_then_accelerator_then_processor(void **state) {
    (void)state;
    assert_chosen(NULL, 1, 3, 0);
    assert_chosen("", 1, 3, 0);
    assert_chosen("auto", 1, 3, 0);
    machine[3].info.usable = false;
    assert_chosen("auto", 1, 4, 0);
    machine[4].info.usable = false;
    assert_chosen("auto", 1, 0, 0);
}

static void auto_takes_the_largest_of_a_kind(void **state) {
    (void)state;
    machine[0].info.compute_units = machine[1].info.compute_units = 2;
    assert_ok(ctx, choose(2, "auto"));
    assert_int_equal(chosen[0], 0);
    machine[1].info.compute_units = 8;
    assert_ok(ctx, choose(2, "auto"));
    assert_int_equal(chosen_count, 1);
    assert_int_equal(chosen[0], 1);
}

/* A GPU, then an accelerator, then a processor, whichever comes first and has more units. */
static void auto_takes_the_fastest_kind(void **state) {
    (void)state;
    static const asdic_device_kind kinds[] = {ASDIC_DEVICE_GPU, ASDIC_DEVICE_ACCELERATOR,
                                              ASDIC_DEVICE_CPU, ASDIC_DEVICE_OTHER};
    for (size_t better = 0; better < 4; better++) {
        for (size_t worse = better + 1; worse < 4; worse++) {
            for (int first = 0; first < 2; first++) {
                machine[first].info.kind = kinds[better];
                machine[first].info.compute_units = 2;
                machine[!first].info.kind = kinds[worse];
                machine[!first].info.compute_units = 8;
                assert_ok(ctx, choose(2, "auto"));
                assert_int_equal(chosen_count, 1);
                assert_int_equal(chosen[0], first);
            }
        }
    }
}

static void slow_drivers_come_last(void **state) {
    (void)state;
    snprintf(machine[0].info.platform_name, sizeof machine[0].info.platform_name, "rusticl");
    snprintf(machine[0].info.name, sizeof machine[0].info.name, "llvmpipe (LLVM 15.0.6, 256 bits)");
    snprintf(machine[3].info.platform_name, sizeof machine[3].info.platform_name, "Oclgrind");
    machine[0].info.compute_units = 8;
    machine[1].info.compute_units = 1;
    assert_ok(ctx, choose(2, "auto"));
    assert_int_equal(chosen[0], 1);
    assert_ok(ctx, choose(4, "auto"));
    assert_int_equal(chosen[0], 1);
    assert_chosen("all", 2, 1, 4);
    assert_chosen("cpu", 2, 0, 1); /* who asks for a kind, gets it */
    assert_ok(ctx, choose(1, "all"));
    assert_int_equal(chosen_count, 1);
}

static void some_drivers_get_no_vectors(void **state) {
    (void)state;
    assert_int_equal(asdic_layout_default(&machine[0].info).width, 8);
    snprintf(machine[0].info.platform_name, sizeof machine[0].info.platform_name, "rusticl");
    snprintf(machine[0].info.name, sizeof machine[0].info.name, "llvmpipe (LLVM 15.0.6, 256 bits)");
    assert_true(asdic_driver_refuses_vectors(&machine[0].info));
    assert_int_equal(asdic_layout_default(&machine[0].info).width, 1);
}

/* Who gives a part of a processor to the program gets no more threads than that on the host. */
static void a_part_of_a_processor_gets_as_many_threads(void **state) {
    (void)state;
    const asdic_device_info part = {.kind = ASDIC_DEVICE_CPU, .compute_units = 1};
    const asdic_device_info large = {.kind = ASDIC_DEVICE_CPU, .compute_units = 100000};
    const asdic_device_info card = {.kind = ASDIC_DEVICE_GPU, .compute_units = 1};
    assert_int_equal(asdic_layout_default(&part).threads, 1);
    assert_int_equal(asdic_layout_default(&large).threads, asdic_processors());
    assert_int_equal(asdic_layout_default(&card).threads, asdic_processors());
}

static void kinds_choose_all_usable_of_the_kind(void **state) {
    (void)state;
    assert_chosen("cpu", 2, 0, 1);
    assert_chosen("gpu", 1, 3, 0);
    assert_chosen("acc", 1, 4, 0);
    assert_chosen("all", 4, 0, 1);
}

static void pairs_choose_in_the_order_given(void **state) {
    (void)state;
    assert_chosen("0:1", 1, 1, 0);
    assert_chosen("2:0,0:0", 2, 4, 0);
    machine[4].info.platform = 12;
    machine[4].info.device = 345;
    assert_chosen("12:345,0:1", 2, 4, 1);
}

static void names_match_in_part_and_any_case(void **state) {
    (void)state;
    assert_chosen("name:NEW", 1, 3, 0);
    assert_chosen("name:platform 0", 2, 0, 1);
    assert_status(ctx, choose(5, "name:geforce"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "name:geforce");
}

static void what_is_not_there_is_a_device_error(void **state) {
    (void)state;
    assert_status(ctx, choose(5, "9:9"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "there is no device 9:9");
    assert_status(ctx, choose(5, "1:0"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "older than 1.2");
    machine[3].info.usable = false;
    snprintf(machine[3].info.unusable_why, sizeof machine[3].info.unusable_why, "no compiler");
    assert_status(ctx, choose(5, "gpu"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "no compiler");
    assert_status(ctx, choose(2, "gpu"), ASDIC_ERROR_DEVICE);
    assert_int_equal(chosen_count, 0);
}

static void no_platform_names_the_packages(void **state) {
    (void)state;
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "pocl-opencl-icd ocl-icd-libopencl1");
    assert_status(ctx, choose(0, "0:0"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "pocl-opencl-icd");
}

/* Sets the variable, or takes it away (NULL). What it was is the caller's to free. */
static char *replace(const char *variable, const char *value) {
    const char *before = getenv(variable);
    char *kept = before ? strdup(before) : NULL;
    if (value) {
        setenv(variable, value, 1);
    } else {
        unsetenv(variable);
    }
    return kept;
}

static void no_platform_names_the_variable_that_leaves_none(void **state) {
    (void)state;
    char *kept = replace("POCL_DEVICES", "nonsense");
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "POCL_DEVICES limits it to 'nonsense': unset that");
    assert_contains(asdic_context_error(ctx), "pocl-opencl-icd ocl-icd-libopencl1");
    free(replace("POCL_DEVICES", ""));
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "POCL_DEVICES limits it to '': unset that");
    free(replace("POCL_DEVICES", NULL));
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_null(strstr(asdic_context_error(ctx), "POCL_DEVICES"));
    free(replace("POCL_DEVICES", kept));
    free(kept);
}

/* PoCL has no device there, installed or not. In /proc root may write, but nobody makes a folder. */
static void no_platform_names_the_folder_that_cannot_be_written(void **state) {
    (void)state;
    char *kept = replace("POCL_CACHE_DIR", "/dev/null/x");
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "set POCL_CACHE_DIR to a folder that can be written "
                                              "to: '/dev/null/x' cannot (Not a directory)");
    assert_contains(asdic_context_error(ctx), "pocl-opencl-icd ocl-icd-libopencl1");
    free(replace("POCL_CACHE_DIR", "/proc/x/y"));
    assert_status(ctx, choose(0, "auto"), ASDIC_ERROR_DEVICE);
    assert_contains(asdic_context_error(ctx), "'/proc/x/y' cannot (");
    free(replace("POCL_CACHE_DIR", kept));
    free(kept);
}

static void nonsense_is_an_argument_error(void **state) {
    (void)state;
    const char *bad[] = {
        "gpus",    "GPU",  "name:",         "0",    "0:",       ":0",  "0:0,", "0:0;0:1",
        "0:0,0:0", "0 :0", "99999999999:0", "-1:0", "auto,cpu", "0:0x"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_status(ctx, choose(5, bad[i]), ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), bad[i]);
    }
    assert_status(ctx, choose(0, "gpus"), ASDIC_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(auto_prefers_gpu_then_accelerator_then_processor, setup),
        cmocka_unit_test_setup(auto_takes_the_largest_of_a_kind, setup),
        cmocka_unit_test_setup(auto_takes_the_fastest_kind, setup),
        cmocka_unit_test_setup(slow_drivers_come_last, setup),
        cmocka_unit_test_setup(some_drivers_get_no_vectors, setup),
        cmocka_unit_test(a_part_of_a_processor_gets_as_many_threads),
        cmocka_unit_test_setup(kinds_choose_all_usable_of_the_kind, setup),
        cmocka_unit_test_setup(pairs_choose_in_the_order_given, setup),
        cmocka_unit_test_setup(names_match_in_part_and_any_case, setup),
        cmocka_unit_test_setup(what_is_not_there_is_a_device_error, setup),
        cmocka_unit_test_setup(no_platform_names_the_packages, setup),
        cmocka_unit_test_setup(no_platform_names_the_variable_that_leaves_none, setup),
        cmocka_unit_test_setup(no_platform_names_the_folder_that_cannot_be_written, setup),
        cmocka_unit_test_setup(nonsense_is_an_argument_error, setup),
    };
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return 1;
    }
    int failed = cmocka_run_group_tests_name("device_select", tests, NULL, NULL);
    asdic_context_destroy(&ctx);
    return failed;
}
