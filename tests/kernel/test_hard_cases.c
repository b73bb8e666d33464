/*
 * Hard cases, one a row: the error measured and the error allowed. With the argument "full", sums run
 * over ten times as many rays.
 */
#include "asserts.h"
#include "hard_cases.h"

test_device hard_device;
bool hard_full;

typedef struct hard_case {
    const char *name;
    double (*measure)(void);
    double tolerance;
    const char *unit;
} hard_case;

static const hard_case numbers[] = {
    {"bottom law, 0 to 90 degrees, 0.1 to 3000 kHz, on the device", hard_bottom_law, 1e-3, "dB"},
    {"surface law to the zenith, 0 to 40 kn, on the device", hard_surface_law, 1e-3, "dB"},
    {"facet law, 0 to 90 degrees, lobes down to 1e-6", hard_facet_law, 1e-3, "dB"},
    {"beam pattern 1e-4 of a lobe beside its nulls", hard_patterns_beside_nulls, 1e-9,
     "of the main lobe"},
    {"zero energy: empty bins, nulls, behind a face", hard_zero_energy, 0, "values not -inf"},
    {"-273 degC, f < 0, NaN: refused; 0 ppt, 0 kn: taken", hard_wrong_input, 0, "wrong answers"},
    {"10 million rays into two bins", hard_one_bin, 2e-3, "dB"},
    {"repeats and layouts, a million rays", hard_same_bytes, 0, "values that differ"},
    {"source level -300 dB", hard_quiet_source, 1e-9, "dB"},
    {"bottom, surface and water 180 dB below a mirror", hard_dynamic_range, 1e-3, "dB"},
    {"an object 110 dB below a mirror, both objects", hard_faint_object, 0.02, "dB"},
};

static const hard_case geometry[] = {
    {"a mesh's corner and edges on the axis", hard_shared_edges, 1e-3, "dB"},
    {"a plate of 4,000 slivers, 1 : 40,000", hard_slivers, 0.02, "dB"},
    {"500 and 4,500 km off the origin", hard_far_coordinates, 0.01, "dB"},
    {"limb of a rock sphere", hard_limb, 0.02, "dB"},
    {"wall on a bin's edge: what leaks before it", hard_wall_on_edge, 1e-3, "relative"},
    {"sphere of 1 cm at 70 m, 4,096 rays", hard_tiny_sphere, 0.1, "dB"},
    {"sonar within a hull: d to 0", hard_inside_hull, 0, "values not finite"},
};

static const hard_case planes[] = {
    {"planes on bins' edges, 5 and 7 m", hard_bin_edges, 0.05, "dB"},
    {"zenith, beam straight up", hard_zenith, 0.02, "dB"},
    {"zenith 0.1 mm inside a bin", hard_near_zenith, 0.1, "dB"},
    {"nadir, beam straight down", hard_nadir, 0.02, "dB"},
    {"deep nulls, three beams, 20,000 rays", hard_nulls, 0.6, "dB"},
    {"nearer than 1 m, altitude 0.55 m", hard_below_a_metre, 0.1, "dB"},
    {"the bottom 0.3 m below, in a bin of 20 m", hard_long_bin, 0.1, "dB"},
    {"sonar on the bottom", hard_on_the_bottom, 0.05, "dB"},
    {"sonar on the bottom, layers", hard_on_the_bottom_in_layers, 0.05, "dB"},
    {"sonar 10 um above it, layers", hard_over_the_bottom_in_layers, 0.05, "dB"},
    {"sonar 0 to 1 mm above it, rays bend away", hard_bent_off_the_bottom, 0.05, "dB"},
    {"the bottom right below where blanking ends, layers", hard_where_blanking_ends, 0.05, "dB"},
    {"sonar in the surface, layers", hard_in_the_surface_in_layers, 0.05, "dB"},
    {"sonar where layers meet", hard_between_layers, 0.05, "dB"},
    {"sonar in the surface", hard_in_the_surface, 0.05, "dB"},
    {"any axis: eight attitudes, r.m.s.", hard_every_attitude, 0.05, "dB"},
    {"bins of 0.1 m, r.m.s.", hard_narrow_bins, 0.05, "dB"},
    {"3 MHz, of which 75 m of water absorb 430 dB, r.m.s.", hard_absorbed, 0.05, "dB"},
    {"receivers that look back, r.m.s.", hard_looking_back, 0.5, "dB"},
    {"the same of faces that leak, r.m.s.", hard_leaking_back, 2.2, "dB"},
};

static void check(const hard_case *cases, size_t count) {
    int missed = 0;
    for (size_t i = 0; i < count; i++) {
        double error = cases[i].measure();
        bool good = error <= cases[i].tolerance; /* false for NaN */
        print_message("%-62s %9.2g of %-7.2g %s%s\n", cases[i].name, error, cases[i].tolerance,
                      cases[i].unit, good ? "" : "  MISSED");
        missed += !good;
    }
    assert_int_equal(missed, 0);
}

static void numbers_hold(void **state) {
    (void)state;
    check(numbers, sizeof numbers / sizeof *numbers);
}

static void geometry_holds(void **state) {
    (void)state;
    check(geometry, sizeof geometry / sizeof *geometry);
}

static void planes_hold(void **state) {
    (void)state;
    check(planes, sizeof planes / sizeof *planes);
}

int main(int argc, char **argv) {
    hard_full = argc == 2 && strcmp(argv[1], "full") == 0;
    hard_device = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_hold),
        cmocka_unit_test(geometry_holds),
        cmocka_unit_test(planes_hold),
    };
    return test_device_end(&hard_device, cmocka_run_group_tests(tests, NULL, NULL));
}
