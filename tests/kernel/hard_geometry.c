/* Meshes at their worst: edges on rays, needles, far from the origin, seen edge on. */
#include "hard_cases.h"
#include "target_bodies.h"
#include "target_rig.h"

#include "kernels/backscatter.h"

/* The strength of MESH (destroyed here), 40 m ahead, seen by a beam that is even over it. */
static double strength_db(asdic_mesh *mesh, asdic_material material) {
    double deviation;
    target_rig r = target_rig_create(&hard_device, 100e3, 40.0, 0.05);
    r.sampling.rays = 1 << 17;
    target_rig_add(&r, mesh, 40.0, 0.0, material);
    double energy = target_rig_energy(&r, ASDIC_OBJECT, 1, &deviation);
    double db = target_rig_strength_db(&r, energy, 40.0);
    target_rig_destroy(&r);
    return db;
}

static asdic_mesh *plain_plate(double side_m) {
    asdic_mesh *mesh = NULL;
    assert_ok(hard_device.ctx, asdic_mesh_plate(hard_device.ctx, side_m, side_m, &mesh));
    return mesh;
}

static asdic_material sand(void) {
    return asdic_material_bottom(2.0);
}

/* Cut into 16 x 16 cells whose corners and edges lie on the beam's axis and its planes. */
double hard_shared_edges(void) {
    asdic_mesh *cut = body_plate(hard_device.ctx, 2.0, 2.0, 16);
    return fabs(strength_db(cut, sand()) - strength_db(plain_plate(2.0), sand()));
}

/* Strips of half a millimetre across two metres, cut along their diagonals, in a fan of edges. */
double hard_slivers(void) {
    enum { STRIPS = 2000 };
    soup s = soup_create(2 * STRIPS, NULL);
    for (unsigned i = 0; i < STRIPS; i++) {
        double corner[2][2][3];
        for (unsigned k = 0; k < 4; k++) {
            double *p = corner[k / 2][k % 2];
            double step = (i + k / 2) / (double)STRIPS;
            /* Every other strip is twenty times as thin as its neighbour. */
            step += (i + k / 2) % 2 ? -0.95 / STRIPS : 0.0;
            p[0] = 0.0;
            p[1] = 2.0 * (step - 0.5);
            p[2] = k % 2 ? 1.0 : -1.0;
        }
        soup_cell(&s, corner, i % 2);
    }
    return fabs(strength_db(soup_mesh(hard_device.ctx, &s), sand()) -
                strength_db(plain_plate(2.0), sand()));
}

/* The same scene with the world's origin far away: a rough bottom as a mesh, a ball over it. */
double hard_far_coordinates(void) {
    asdic_ping *pings[2];
    for (int far = 0; far < 2; far++) {
        target_rig r = target_rig_create(&hard_device, 100e3, 60.0, 0.1);
        asdic_vec3 at = {far ? 4512345.6 : 0.0, far ? 498765.4 : 0.0, 0.0};
        asdic_mesh *mesh = NULL;
        asdic_simulator *sim = NULL;
        asdic_pose lying = {.position_m = {at.x + 40.0, at.y, 106.0}, .pitch_rad = 1.5};
        asdic_pose ball = {.position_m = {at.x + 33.3, at.y + 1.0, 101.0}};
        asdic_context *ctx = hard_device.ctx;
        assert_ok(ctx, asdic_scene_add_bottom(r.scene, mesh = plain_plate(100.0), lying, sand()));
        asdic_mesh_destroy(&mesh);
        assert_ok(ctx, asdic_mesh_sphere(ctx, 0.5, 48, &mesh));
        assert_ok(ctx, asdic_scene_add_object(r.scene, "ball", mesh, ball, sand()));
        asdic_mesh_destroy(&mesh);
        assert_ok(ctx, asdic_scene_commit(r.scene));
        r.pose.position_m = (asdic_vec3){at.x, at.y, 100.0};
        r.sonar.receivers = &r.receiver;
        assert_ok(ctx, asdic_simulator_create(ctx, hard_device.device, r.scene, &r.env, &r.sonar,
                                              &r.sampling, 100.0, &sim));
        assert_ok(ctx, asdic_ping_create(ctx, 1, asdic_simulator_bin_count(sim), &pings[far]));
        assert_ok(ctx, asdic_simulator_learn(sim, &r.pose, 0));
        assert_ok(ctx, asdic_simulator_ping(sim, &r.pose, 0, pings[far]));
        asdic_simulator_destroy(&sim);
        target_rig_destroy(&r);
    }
    double most = 0.0, ball = 0.0;
    for (size_t n = 0; n < pings[0]->bins; n++) {
        double a = pings[0]->intensity_lin[ASDIC_TOTAL][n];
        double b = pings[1]->intensity_lin[ASDIC_TOTAL][n];
        ball += pings[1]->intensity_lin[ASDIC_OBJECT][n];
        most = a > 0.0 || b > 0.0 ? fmax(most, fabs(asdic_level_db(b / a))) : most;
    }
    assert_true(ball > 0.0);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
    return most;
}

/* Rock returns at grazing incidence, too: integral of s(cos i) over the visible half of a sphere of
 * radius A, 2 pi a^2 integral of s(c) dc, seen from far away. */
double hard_limb(void) {
    const double radius_m = 0.5, range_m = 300.0;
    double gain = bottom_gain(4.0, 100.0), peak = bottom_peak(4.0), sum = 0.0, deviation;
    for (int i = 0; i < 100000; i++) {
        sum += bottom_backscatter_lin(gain, peak, 4.0, (i + 0.5) / 1e5) / 1e5;
    }
    target_rig r = target_rig_create(&hard_device, 100e3, range_m, 10.0 * radius_m / range_m);
    r.sampling.rays = 1 << 17;
    double corner[3] = {radius_m, radius_m, radius_m};
    target_rig_add(&r, body_ellipsoid(hard_device.ctx, corner, 6), range_m, 0.0,
                   asdic_material_bottom(4.0));
    double energy = target_rig_energy(&r, ASDIC_OBJECT, 4, &deviation);
    /* The limb is as far as the centre, the rest nearer: by half the radius on average. */
    double db = target_rig_strength_db(&r, energy, range_m - 0.5 * radius_m);
    target_rig_destroy(&r);
    return fabs(db - 10.0 * log10(2.0 * BODY_PI * radius_m * radius_m * sum));
}

/* A wall at 35 m across the beam: its middle lies on the edge of bins 69 and 70. */
double hard_wall_on_edge(void) {
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_context *ctx = hard_device.ctx;
    target_rig r = target_rig_create(&hard_device, 100e3, 35.0, 0.05);
    target_rig_add(&r, plain_plate(20.0), 35.0, 0.0, sand());
    assert_ok(ctx, asdic_scene_commit(r.scene));
    r.sonar.receivers = &r.receiver;
    assert_ok(ctx, asdic_simulator_create(ctx, hard_device.device, r.scene, &r.env, &r.sonar,
                                          &r.sampling, 100.0, &sim));
    assert_ok(ctx, asdic_ping_create(ctx, 1, asdic_simulator_bin_count(sim), &ping));
    assert_ok(ctx, asdic_simulator_ping(sim, &r.pose, 0, ping));
    double before = ping->intensity_lin[ASDIC_OBJECT][69];
    double after = ping->intensity_lin[ASDIC_OBJECT][70];
    assert_true(after > 0.0);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    target_rig_destroy(&r);
    return before / after;
}

/* Rough, so that its strength is 2 a^2 / 3. */
double hard_tiny_sphere(void) {
    const double radius_m = 0.01, range_m = 70.0;
    double deviation;
    asdic_mesh *mesh = NULL;
    target_rig r = target_rig_create(&hard_device, 1e6, range_m, 1e-3);
    r.sampling.rays = 4096;
    assert_ok(hard_device.ctx, asdic_mesh_sphere(hard_device.ctx, radius_m, 256, &mesh));
    target_rig_add(&r, mesh, range_m, 0.0, asdic_material_facet(0.0, 2e-3, 0.1));
    double energy = target_rig_energy(&r, ASDIC_OBJECT, 1, &deviation);
    double db = target_rig_strength_db(&r, energy, range_m - 2.0 / 3.0 * radius_m);
    target_rig_destroy(&r);
    return fabs(db - 10.0 * log10(2.0 / 3.0 * radius_m * radius_m));
}

/* A vehicle's hull, closed and 1 mm from the face: within the blanking, so that nothing is heard but
 * what is finite. */
double hard_inside_hull(void) {
    double deviation, wrong = 0.0;
    for (int polished = 0; polished < 2; polished++) {
        asdic_mesh *mesh = NULL;
        target_rig r = target_rig_create(&hard_device, 100e3, 20.0, 0.05);
        r.sampling.multipath = ASDIC_MULTIPATH_FIRST;
        assert_ok(hard_device.ctx,
                  asdic_mesh_box(hard_device.ctx, (asdic_vec3){0.002, 0.2, 0.2}, &mesh));
        target_rig_add(&r, mesh, 0.0, 0.0, polished ? asdic_material_facet(0.0, 0.0, 0.0) : sand());
        double energy = target_rig_energy(&r, ASDIC_OBJECT, 1, &deviation);
        wrong += !isfinite(energy) || energy != 0.0;
        target_rig_destroy(&r);
    }
    return wrong;
}
