/* Missions where the memory is said to be short. */
#include "mission_files_rig.h"

#include "base/memory_left.h"

static uint64_t left = UINT64_MAX;

uint64_t __wrap_asdic_memory_left(void); /* linked in place of the library's */

uint64_t __wrap_asdic_memory_left(void) {
    return left;
}

/* Two beams of 150 bins are some 90,000 bytes. */
static void scenes_beyond_the_memory_are_refused(void **state) {
    workshop *w = *state;
    static const char text[] = "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                               "sonar: {frequency_khz: 100, receivers: [{name: a}, {name: b}]}\n";
    left = 95000;
    asdic_mission *m = load_text(w, text);
    assert_non_null(m);
    asdic_mission_destroy(&m);
    left = 85000;
    m = load_text(w, text);
    left = UINT64_MAX;
    assert_null(m);
    assert_contains(asdic_context_error(w->ctx), "2 beams of 150 bins need 9");
    assert_contains(asdic_context_error(w->ctx), " bytes of memory, 85000 are available; use fewer "
                                                 "beams or a longer 'bin_length_m'");
    /* Smooth pulses of coherent pings reach three times as far, and elements beside the middle. */
    left = 100000;
    m = load_text(w, "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                     "sonar: {frequency_khz: 100, bandwidth_khz: 0.1,\n"
                     "  array: {elements: 16, beams: {count: 2, sector_deg: 9}}}\n"
                     "sampling: {coherent: true}\n");
    left = UINT64_MAX;
    assert_null(m);
    assert_contains(asdic_context_error(w->ctx), "2 beams of 150 bins need 1");
}

/* Copies of a mesh are counted before the first is made: those of its own file, and those that follow. */
static void copies_beyond_the_memory_are_refused(void **state) {
    workshop *w = *state;
    enum { BIG = 21, COPIES = 12 };
    char mesh[1024] = "v 0 0 0\n", text[2048];
    size_t used = strlen(mesh);
    for (int i = 0; i <= BIG; i++) {
        used += (size_t)snprintf(mesh + used, sizeof mesh - used, "v 1 %d %d\n", i, i * i);
    }
    for (int i = 0; i < BIG; i++) {
        used += (size_t)snprintf(mesh + used, sizeof mesh - used, "f 1 %d %d\n", i + 2, i + 3);
    }
    write_file(w, "big.obj", mesh);
    write_file(w, "small.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    for (int big_first = 0; big_first < 2; big_first++) {
        int length = snprintf(text, sizeof text,
                              "version: 1\nenvironment: {sound_speed_mps: 1500}\n" FLAT POSE
                              "sonar: {frequency_khz: 100, receivers: [{name: a}]}\nobjects:\n");
        for (int i = 0; i < COPIES + 1; i++) {
            bool big = big_first ? i == 0 : i < COPIES; /* once and eleven small ones; or twelve */
            length += snprintf(text + length, sizeof text - (size_t)length,
                               "  - {mesh: {file: %s.obj}, position_m: [%d, 0, 5], type: rock}\n",
                               big ? "big" : "small", 20 + 5 * i);
        }
        write_file(w, "scene.yaml", text);
        left = big_first ? (BIG + COPIES) * 304 + 46000 : 50000;
        asdic_mission *m = load_with(w, NULL, 0, NULL);
        left = UINT64_MAX;
        assert_int_equal(m != NULL, big_first);
        if (!m) {
            assert_contains(asdic_context_error(w->ctx), "a scene of 252 triangles or more needs");
        }
        asdic_mission_destroy(&m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_beyond_the_memory_are_refused),
        cmocka_unit_test(copies_beyond_the_memory_are_refused),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
