/* What only phase shows: lobes of plates and cylinders, and a point's interference with its image. */
#include "coherent_rig.h"

static test_device t;

#define RANGE_M (53.5 * 0.75) /* the middle of a bin of 0.75 m */

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* A pulse much longer than a body, and small apertures. */
static ping_rig long_pulse(void) {
    ping_rig r = empty_array(&t);
    r.sonar.bandwidth_hz = 1000.0;
    r.sonar.bin_length_m = 0.75;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.sonar.array.elements = 3;
    r.sonar.array.element.length_h_m = r.sonar.array.element.length_v_m = 1e-4;
    r.sampling.rays = 200000;
    return r;
}

/* 10 log10 of what the middle element hears, re a point of 0 dB at RANGE_M. */
static double strength_db(const ping_rig *r, const asdic_ping *ping, double range_m) {
    double alpha = asdic_environment_absorption_db_per_km(&r->env, 100e3, 7.0);
    const float *p = array_at(ping, 1, (size_t)(range_m / ping->sample_m));
    return 10.0 * log10((double)p[0] * p[0] + (double)p[1] * p[1]) + 40.0 * log10(range_m) +
           2.0 * (range_m - 1.0) * alpha / 1000.0;
}

/* Turns the object BODY, and compares its lobes, down to 26 dB below the first: beyond, edges and ends show, with PEAK_DB and the pattern of
 * a line of LENGTH_M (Urick 1983, table 9.1). */
static double worst_lobe(const asdic_mesh *mesh, asdic_pose pose, double peak_db, double length_m) {
    ping_rig r = long_pulse();
    asdic_material rigid = asdic_material_facet(200.0, 0.0, 0.0);
    assert_ok(t.ctx, asdic_scene_add_moving_object(r.scene, "body", mesh, pose, rigid));
    asdic_simulator *sim = rig_simulator(&r);
    double water = 1e-6 * 1025.0 * 1500.0, reflection = (200.0 - water) / (200.0 + water);
    double worst = 0.0, yaw = pose.yaw_rad;
    for (int lobe = 0; lobe <= 6; lobe++) { /* lobe 0 is the main one; others peak near n + 1/2 */
        double x = lobe == 0 ? 0.0 : lobe + 0.5, sine = x * WAVELENGTH_M / (2.0 * length_m);
        pose.yaw_rad = yaw + asin(sine);
        assert_ok(t.ctx, asdic_simulator_move(sim, "body", &pose));
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double expected = peak_db + 20.0 * log10(fabs(sinc(x)) * sqrt(1.0 - sine * sine)) +
                          20.0 * log10(reflection);
        double level = strength_db(&r, ping, RANGE_M);
        print_message("lobe %d: %.2f dB, closed form %.2f dB\n", lobe, level, expected);
        worst = fmax(worst, fabs(level - expected));
        asdic_ping_destroy(&ping);
    }
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
    return worst;
}

static void a_plate_has_its_lobes(void **state) {
    (void)state;
    const double side = 0.2;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.002, side, side}, &mesh));
    asdic_pose pose = {.position_m = {RANGE_M, 0.0, 7.0}};
    double worst = worst_lobe(mesh, pose, 20.0 * log10(side * side / WAVELENGTH_M), side);
    print_message("plate: off by %.2f dB\n", worst);
    assert_true(worst < 0.5);
    asdic_mesh_destroy(&mesh);
}

static void a_cylinder_has_its_lobes(void **state) {
    (void)state;
    const double radius = 0.1, length = 0.25;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_cylinder(t.ctx, radius, length, 256, &mesh));
    asdic_pose pose = {.position_m = {RANGE_M + radius, 0.0, 7.0}};
    double peak = 10.0 * log10(radius * length * length / (2.0 * WAVELENGTH_M));
    double worst = worst_lobe(mesh, pose, peak, length);
    print_message("cylinder: off by %.2f dB\n", worst);
    assert_true(worst < 0.5);
    asdic_mesh_destroy(&mesh);
}

/* Lloyd's mirror: a point under a smooth surface, heard straight and by way of the surface, both ways. */
static void a_point_interferes_with_its_image(void **state) {
    (void)state;
    double worst = 0.0, least = INFINITY, most = -INFINITY;
    for (int i = 0; i < 24; i++) {
        ping_rig r = long_pulse();
        asdic_scene_set_surface(r.scene, true);
        r.env.wind_speed_kn = 0.0;
        r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
        r.sampling.left_out = 1u << ASDIC_TERM_SURFACE;
        r.pose.position_m.z = 1.5;
        double depth = 0.6 + 0.03 * i, own = 1.5, across = RANGE_M;
        asdic_vec3 at = {across, 0.0, depth};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double direct = hypot(across, depth - own), image = hypot(across, depth + own);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, 100e3, 7.0) * log(10.0) / 2e4;
        double a = exp(-alpha * (direct - 1.0)) / direct, b = exp(-alpha * (image - 1.0)) / image;
        double phase = TURN * (image - direct) / WAVELENGTH_M; /* the surface turns the sign */
        double re = a - b * cos(phase), im = b * sin(phase), one_way = re * re + im * im;
        double expected = 20.0 * log10(one_way);
        const float *p = array_at(ping, 1, (size_t)(direct / ping->sample_m));
        double level = 10.0 * log10((double)p[0] * p[0] + (double)p[1] * p[1]);
        least = fmin(least, expected);
        most = fmax(most, expected);
        worst =
            expected > -40.0 * log10(RANGE_M) - 30.0 ? fmax(worst, fabs(level - expected)) : worst;
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    print_message("fringes of %.0f dB: off by %.3f dB\n", most - least, worst);
    assert_true(most - least > 20.0);
    assert_true(worst < 0.2);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plate_has_its_lobes),
        cmocka_unit_test(a_cylinder_has_its_lobes),
        cmocka_unit_test(a_point_interferes_with_its_image),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    test_device_close(&t);
    return failed;
}
