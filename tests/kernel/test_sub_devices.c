/*
 * A mission on the halves of a device: work for each, the bytes of the whole.
 */
#include "asserts.h"
#include "test_device.h"

#include <asdic/asdic.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static test_device t;
static char folder[] = "/tmp/asdic-sub-XXXXXX";

static const char *in_folder(const char *name) {
    static char paths[2][256];
    static int turn;
    char *path = paths[turn++ % 2];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void run(asdic_device **devices, size_t count, const char *name) {
    asdic_mission *mission;
    asdic_run_options options = asdic_run_options_default();
    options.folder = in_folder(name);
    assert_ok(t.ctx, asdic_mission_load(t.ctx, in_folder("scene.yaml"), &mission));
    assert_ok(t.ctx, asdic_mission_run(t.ctx, mission, devices, count, &options));
    asdic_mission_destroy(&mission);
}

static void assert_same_records(const char *a, const char *b) {
    asdic_run *runs[2];
    asdic_record records[2];
    assert_ok(t.ctx, asdic_run_open(t.ctx, in_folder(a), &runs[0]));
    assert_ok(t.ctx, asdic_run_open(t.ctx, in_folder(b), &runs[1]));
    asdic_run_info info = asdic_run_get_info(runs[0]);
    assert_int_equal(info.pings, 64);
    assert_int_equal(asdic_run_get_info(runs[1]).pings, 64);
    size_t bytes = info.beams * info.bins * sizeof(float);
    for (size_t i = 0; i < info.pings; i++) {
        assert_ok(t.ctx, asdic_run_read(runs[0], i, &records[0]));
        assert_ok(t.ctx, asdic_run_read(runs[1], i, &records[1]));
        assert_int_equal(records[0].ping, records[1].ping);
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            assert_memory_equal(records[0].level_db[c], records[1].level_db[c], bytes);
        }
        assert_memory_equal(records[0].stderr_db, records[1].stderr_db, bytes);
    }
    asdic_run_close(&runs[0]);
    asdic_run_close(&runs[1]);
}

static void halves_make_the_whole(void **state) {
    (void)state;
    asdic_device **halves = NULL;
    asdic_status status = asdic_device_split(t.device, 2, &halves);
    if (status == ASDIC_ERROR_UNSUPPORTED) {
        print_message("%s\n", asdic_context_error(t.ctx));
        skip();
    }
    assert_ok(t.ctx, status);
    run(t.devices, 1, "whole");
    run(halves, 2, "halves");
    run(halves + 1, 1, "half");
    assert_same_records("whole", "halves");
    assert_same_records("whole", "half");
    asdic_devices_close(&halves, 2);
}

int main(void) {
    t = test_device_open_or_skip();
    if (asdic_device_get_info(t.device)->compute_units < 2) {
        printf("skipped: a device of one compute unit has no halves\n");
        return 77;
    }
    if (!mkdtemp(folder)) {
        return 1;
    }
    FILE *file = fopen(in_folder("scene.yaml"), "w");
    fputs("version: 1\n"
          "bottom: {depth_m: 12, type: sand}\n"
          "objects: [{sphere: {radius_m: 1}, position_m: [15, 0, 6]}]\n"
          "sonar: {frequency_khz: 100, ping_rate_hz: 20, bin_length_m: 1, receivers: [{}]}\n"
          "mission: {pose: {position_m: [0, 0, 5]}, pings: 64}\n"
          "sampling: {rays: 1000}\n"
          "output: {images: []}\n",
          file);
    fclose(file);
    const struct CMUnitTest tests[] = {cmocka_unit_test(halves_make_the_whole)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    char command[300];
    snprintf(command, sizeof command, "rm -r '%s'", folder);
    failed += system(command) != 0;
    test_device_close(&t);
    return failed;
}
