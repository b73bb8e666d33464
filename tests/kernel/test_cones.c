/*
 * Objects get rays of their own: a small target is never missed, whatever the number of rays, and
 * what the cones add to its bins they take from nowhere else.
 */
#include "ping_rig.h"

#include "base/vec.h"

#include "sim/cones.h"

#include <math.h>

static test_device t;

/* The benchmark's sphere of 0.5 m diameter, 30 m ahead on the axis of a narrow beam. */
static ping_rig sphere_rig(void) {
    ping_rig r = rig_create(&t);
    r.sonar.frequency_hz = 450e3;
    r.sonar.receiver_count = 1;
    r.sonar.transmitter.length_h_m = r.receivers[0].length_h_m = 0.0331134;
    r.sonar.transmitter.length_v_m = r.receivers[0].length_v_m = 0.0165567;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.25, 64, &mesh));
    asdic_pose pose = {.position_m = {30.0, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "sphere", mesh, pose,
                                            asdic_material_facet(45.0, 2e-4, 0.2)));
    asdic_mesh_destroy(&mesh);
    return r;
}

#define TARGET_BIN 59 /* 29.5 to 30 m */

typedef struct spread {
    double mean, relative; /* of the object's energy in its bin, over pings */
    double least;
} spread;

static spread target_spread(ping_rig *r, int pings) {
    asdic_simulator *sim = rig_simulator(r);
    asdic_ping *ping = rig_ping(r, sim);
    double sum = 0.0, square = 0.0, least = INFINITY;
    for (int k = 0; k < pings; k++) {
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, (uint64_t)k, ping));
        double e = ping->intensity_lin[ASDIC_OBJECT][TARGET_BIN];
        sum += e / pings;
        square += e * e / pings;
        least = fmin(least, e);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return (spread){sum, sqrt(fmax(square - sum * sum, 0.0)) / sum, least};
}

static void target_is_never_missed(void **state) {
    (void)state;
    static const struct {
        uint32_t rays;
        double relative, off_db;
    } cases[] = {{64, 1.0, 0.35}, {1024, 0.05, 0.5}, {4096, 0.02, 0.15}, {20000, 0.005, 0.03}};
    ping_rig r = sphere_rig();
    r.sampling.rays = 1u << 20;
    double truth = target_spread(&r, 4).mean;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        r.sampling.rays = cases[k].rays;
        spread s = target_spread(&r, k == 0 ? 1024 : 64); /* each of a cone's seven rays counts */
        double off_db = fabs(asdic_level_db(s.mean) - asdic_level_db(truth));
        print_message("%u rays: standard deviation %.3f %%, mean %.3f dB off, least %.2f of it\n",
                      cases[k].rays, 100.0 * s.relative, off_db, s.least / truth);
        assert_true(s.least > 0.0);
        assert_true(s.relative < cases[k].relative);
        assert_true(off_db < cases[k].off_db);
    }
    rig_destroy(&r);
}

/* Samplers that know of no objects, and no cones, must agree with the one that does. */
static void cones_agree_with_beam_sampler(void **state) {
    (void)state;
    ping_rig r = sphere_rig();
    r.sampling.rays = 65536;
    double adaptive = target_spread(&r, 4).mean;
    r.sampling.sampler = ASDIC_SAMPLER_BEAM;
    r.sampling.rays = 1u << 19;
    enum { PINGS = 16 };
    spread beam = target_spread(&r, PINGS);
    double sigmas = (beam.mean - adaptive) / (beam.mean * beam.relative / sqrt(PINGS - 1));
    print_message("beam sampler %.3f dB off, %.2f standard errors\n",
                  asdic_level_db(beam.mean) - asdic_level_db(adaptive), sigmas);
    assert_true(fabs(sigmas) < 3.5 && beam.relative < 0.1);
    rig_destroy(&r);
}

/* A ball in open water of layers: sent along the bend of one layer fitted to them, rays would miss it. */
typedef struct layered_case {
    double sonar_m, across_m, depth_m;
    asdic_sound_profile profile;
} layered_case;

static const layered_case layered_cases[] = {
    {7.0, 60.0, 9.5, {5, {0.0, 3.0, 6.0, 9.0, 13.0}, {1482.0, 1480.0, 1468.0, 1440.0, 1431.0}}},
    {4.9, 40.0, 4.8, {3, {0.0, 5.0, 10.0}, {1500.0, 1500.0, 1480.0}}},
};

/* One beam in open water that returns nothing. */
static ping_rig silent_rig(void) {
    ping_rig r = rig_create(&t);
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, false);
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    r.sonar.receiver_count = 1;
    return r;
}

static ping_rig layered_rig(const layered_case *c) {
    ping_rig r = silent_rig();
    r.env.sound_speed_profile = c->profile;
    r.pose.position_m.z = c->sonar_m;
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.3, 32, &mesh));
    asdic_pose pose = {.position_m = {c->across_m, 0.0, c->depth_m}};
    assert_ok(t.ctx,
              asdic_scene_add_object(r.scene, "ball", mesh, pose, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
    return r;
}

/* Relative to the ball's own echo, in all bins: of PINGS pings the mean and the root of the mean square of true over
 * stated errors. */
typedef struct layered_echo {
    double mean, least, honesty;
} layered_echo;

static double echo_of(const asdic_ping *ping, double *error) {
    double sum = 0.0, square = 0.0;
    for (size_t n = 0; n < ping->bins; n++) {
        double e = ping->intensity_lin[ASDIC_OBJECT][n];
        sum += e;
        square += pow(e * (double)ping->stderr_db[n] / 4.343, 2.0);
    }
    *error = sqrt(square);
    return sum;
}

static layered_echo layered_pings(const layered_case *c, uint32_t rays, int pings, double truth) {
    ping_rig r = layered_rig(c);
    r.sampling.rays = rays;
    layered_echo echo = {0.0, INFINITY, 0.0};
    for (int k = 0; k < pings; k++) {
        asdic_ping *ping = rig_shoot(&r, ASDIC_LEARN_BLOCK * (uint64_t)k, true);
        double error, heard = echo_of(ping, &error);
        echo.mean += heard / pings;
        echo.least = fmin(echo.least, heard);
        echo.honesty += pow((heard - truth) / fmax(error, 1e-30), 2.0) / pings;
        asdic_ping_destroy(&ping);
    }
    echo.honesty = sqrt(echo.honesty);
    rig_destroy(&r);
    return echo;
}

static void layers_hide_no_target(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof layered_cases / sizeof *layered_cases; k++) {
        const layered_case *c = &layered_cases[k];
        double truth = layered_pings(c, 1u << 19, 2, 1.0).mean;
        layered_echo few = layered_pings(c, 16384u, 16, truth);
        print_message("case %zu: mean %.3f dB off, least %.3f of it, true over stated %.2f\n", k,
                      asdic_level_db(few.mean / truth), few.least / truth, few.honesty);
        assert_true(truth > 0.0 && few.least > 0.75 * truth);
        assert_true(fabs(asdic_level_db(few.mean / truth)) < 0.1);
        assert_true(few.honesty < 1.5);
    }
}

/* A ball that fills a beam: rays of its cone are weighed by how dense all others are there, which the beam makes
 * uneven. A sampler without cones hears the same. */
static void near_objects_are_as_loud_as_they_are(void **state) {
    (void)state;
    ping_rig r = sphere_rig();
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, false);
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    asdic_mesh *mesh = NULL;
    asdic_pose pose = {.position_m = {8.5, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 2.0, 64, &mesh));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, pose,
                                            asdic_material_facet(45.0, 1e-3, 0.2)));
    asdic_mesh_destroy(&mesh);
    double heard[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        r.sampling.sampler = k ? ASDIC_SAMPLER_BEAM : ASDIC_SAMPLER_ADAPTIVE;
        r.sampling.rays = k ? 1u << 17 : 1u << 16;
        asdic_ping *ping = rig_shoot(&r, 0, false);
        for (size_t n = 0; n < ping->bins; n++) {
            heard[k] += ping->intensity_lin[ASDIC_OBJECT][n];
        }
        asdic_ping_destroy(&ping);
    }
    double off_db = asdic_level_db(heard[0]) - asdic_level_db(heard[1]);
    print_message("a ball nearby: %.3f dB beside the beam sampler\n", off_db);
    assert_true(fabs(off_db) < 0.1);
    rig_destroy(&r);
}

/* COUNT small balls STEP_RAD apart round about, the first FIRST_M away, the Ith then START_M + 2 I. */
static void add_balls(ping_rig *r, int count, double step_rad, double first_m, double start_m) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.01, 8, &mesh));
    for (int i = 0; i < count; i++) {
        double azimuth = step_rad * i, range = i == 0 ? first_m : start_m + 2.0 * i;
        asdic_pose pose = {.position_m = {range * cos(azimuth), range * sin(azimuth), 7.0}};
        char name[16];
        snprintf(name, sizeof name, "ball%d", i);
        assert_ok(t.ctx, asdic_scene_add_object(r->scene, name, mesh, pose,
                                                asdic_material_facet(1.6, 1e-2, 0.5)));
    }
    asdic_mesh_destroy(&mesh);
}

/* What surface and bottom send back to R's one beam. */
static asdic_ping *expected_of_planes(const ping_rig *r, size_t bins) {
    asdic_ping *truth = NULL;
    asdic_flat_scene flat = rig_flat(r);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &truth));
    assert_ok(t.ctx, asdic_expected_compute(t.ctx, &flat, &r->env, &r->sonar, &r->pose, truth));
    return truth;
}

/* More objects than cones, some behind, one round the sonar, one out of range: nothing is lost, and
 * the flat bins keep their truth. */
static void crowds_keep_the_flat_bins(void **state) {
    (void)state;
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    add_balls(&r, 24, 0.5, 200.0, 6.0);
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){0.1, 0.1, 0.1}, &mesh));
    asdic_pose around = {.position_m = {-0.2, 0.0, 7.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "hull", mesh, around,
                                            asdic_material_facet(45.0, 1e-3, 0.2)));
    asdic_mesh_destroy(&mesh);
    asdic_ping *ping = rig_shoot(&r, 0, true), *truth = expected_of_planes(&r, ping->bins);
    double sum = 0.0;
    for (size_t n = 4; n < ping->bins; n++) {
        double flat_lin =
            ping->intensity_lin[ASDIC_TOTAL][n] - ping->intensity_lin[ASDIC_OBJECT][n];
        double d = asdic_level_db(flat_lin) - asdic_level_db(truth->intensity_lin[ASDIC_TOTAL][n]);
        sum += d * d;
    }
    double rms = sqrt(sum / (double)(ping->bins - 4));
    print_message("flat bins among 24 balls: RMS %.4f dB\n", rms);
    assert_true(rms < 0.03);
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    rig_destroy(&r);
}

/* So few rays that a ray a steradian more or less in the cones' place would be heard: the mean of many pings. */
static void few_rays_keep_the_flat_bins(void **state) {
    (void)state;
    enum { PINGS = 1024, FIRST = 10, LAST = 16 };
    ping_rig r = rig_create(&t);
    r.sonar.receiver_count = 1;
    r.sampling.rays = 512;
    add_balls(&r, 8, 0.7, 12.0, 12.0);
    asdic_simulator *sim = rig_simulator(&r);
    size_t bins = asdic_simulator_bin_count(sim);
    asdic_ping *ping = NULL, *truth = expected_of_planes(&r, bins);
    assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, bins, &ping));
    double sum = 0.0, square = 0.0;
    for (int k = 0; k < PINGS; k++) {
        double heard = 0.0;
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r.pose, (uint64_t)k, ping));
        for (size_t n = FIRST; n < LAST; n++) {
            heard += (ping->intensity_lin[ASDIC_TOTAL][n] - ping->intensity_lin[ASDIC_OBJECT][n]) /
                     truth->intensity_lin[ASDIC_TOTAL][n] / (LAST - FIRST);
        }
        sum += heard / PINGS;
        square += heard * heard / PINGS;
    }
    double error = sqrt((square - sum * sum) / PINGS);
    print_message("few rays among cones: %.4f of what is expected, standard error %.4f\n", sum,
                  error);
    assert_true(error < 0.01);
    assert_true(fabs(sum - 1.0) < 0.005 + 3.5 * error);
    asdic_ping_destroy(&truth);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Half a metre away: the axis is a direction, the cap that of the ball with its margin, and the rays' step in range
 * that of twice the half-angle. */
static void near_objects_have_cones(void **state) {
    (void)state;
    const asdic_part ball = {.kind = DEV_KIND_OBJECT, .center_m = {0.3, 0.4, 7.0}, .radius_m = 0.1};
    const dev_beam ahead = {
        .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .length_h_wl = 1.0f, .length_v_wl = 1.0f};
    const dev_beam beams[2] = {ahead, ahead};
    dev_ping *ping = calloc(1, sizeof *ping);
    assert_non_null(ping);
    ping->range_m = 50.0f;
    ping->beams = 1;
    ping->batch.rays = ping->sampling.background = 1000;
    asdic_cones_place(&ball, 1, (asdic_vec3){0.0, 0.0, 7.0}, beams, NULL, 0, ping);
    assert_int_equal(ping->sampling.cones, 1);
    const dev_cone *cone = &ping->sampling.cone[0];
    assert_close((double)cone->rows[6], 0.6, 1e-6);
    assert_close((double)cone->rows[7], 0.8, 1e-6);
    assert_close((double)cone->rows[8], 0.0, 1e-6);
    double sine = sin(2.0 * asin(0.5 * (double)cone->chord[0]));
    assert_close((double)cone->chord[1], (double)cone->chord[0], 1e-7);
    assert_true(sine >= 0.2 && sine < 0.22);
    assert_close((double)cone->splat * cone->count, 8.0 * asin(sine), 1e-5);
    assert_int_equal(cone->first, ping->sampling.background);
    assert_int_equal(ping->sampling.background + cone->count, 1000);
    free(ping);
}

/* Of a ball that lies as deep in a sound channel as the sonar rays show several bundles, each with its cone; none comes to
 * one in the shadow above a thermocline's knee. */
static void layers_have_a_cone_for_each_bundle(void **state) {
    static const struct {
        asdic_sound_profile profile;
        double sonar_m, across_m, depth_m;
        dev_uint least, most;
    } cases[] = {
        {{3, {0.0, 10.0, 20.0}, {1520.0, 1480.0, 1520.0}}, 10.0, 200.0, 10.0, 2, DEV_MAX_BUNDLES},
        {{2, {0.0, 20.0}, {1500.0, 1440.0}}, 2.0, 100.0, 0.5, 0, 0},
        {{3, {0.0, 5.0, 10.0}, {1500.0, 1500.0, 1480.0}}, 3.0, 40.0, 2.0, 1, 1},
    };
    const dev_beam beam = {
        .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .length_h_wl = 1.0f, .length_v_wl = 1.0f};
    const dev_beam beams[2] = {beam, beam};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        asdic_passage way = {.top_m = 0.0, .bottom_m = 20.0};
        asdic_environment env = asdic_environment_default();
        env.sound_speed_profile = cases[k].profile;
        asdic_layers_of(&env, cases[k].sonar_m, &way.layers);
        const asdic_part ball = {.kind = DEV_KIND_OBJECT,
                                 .center_m = {cases[k].across_m, 0.0, cases[k].depth_m},
                                 .radius_m = 0.2};
        dev_ping *ping = calloc(1, sizeof *ping);
        assert_non_null(ping);
        ping->range_m = 300.0f;
        ping->beams = 1;
        ping->batch.rays = ping->sampling.background = 1000;
        asdic_cones_place(&ball, 1, (asdic_vec3){0.0, 0.0, cases[k].sonar_m}, beams, &way, 1, ping);
        print_message("case %zu: %u cones\n", k, ping->sampling.cones);
        assert_in_range(ping->sampling.cones, cases[k].least, cases[k].most);
        free(ping);
    }
}

/* Of a ball below a surface that mirrors it a second cone looks at its image; of one on the other side none does. */
static void images_have_cones(void **state) {
    (void)state;
    const asdic_material steel = asdic_material_facet(45.0, 1e-3, 0.1);
    const asdic_law_water water = {
        .frequency_hz = 1e5, .sound_speed_mps = 1500.0, .wavelength_m = 0.015};
    const asdic_scatterer mirror = asdic_scatterer_at(&steel, &water);
    const asdic_passage ways[2] = {{.plane_m = 0.0}, {.mirror = &mirror, .plane_m = 1.0}};
    const dev_beam beam = {
        .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .length_h_wl = 1.0f, .length_v_wl = 1.0f};
    const dev_beam beams[2] = {beam, beam};
    for (int above = 0; above < 2; above++) {
        const double z = above ? -1.0 : 4.0;
        const asdic_part ball = {
            .kind = DEV_KIND_OBJECT, .center_m = {12.0, 3.0, z}, .radius_m = 0.2};
        dev_ping *ping = calloc(1, sizeof *ping);
        assert_non_null(ping);
        ping->range_m = 50.0f;
        ping->beams = 1;
        ping->batch.rays = ping->sampling.background = 1000;
        asdic_cones_place(&ball, 1, (asdic_vec3){0.0, 0.0, 7.0}, beams, ways, 2, ping);
        assert_int_equal(ping->sampling.cones, above ? 1 : 2);
        for (dev_uint k = 0; k < ping->sampling.cones; k++) {
            const float *towards = ping->sampling.cone[k].rows + 6;
            double down = (k ? 2.0 - z : z) - 7.0, far = sqrt(144.0 + 9.0 + down * down);
            assert_close((double)towards[0], 12.0 / far, 1e-6);
            assert_close((double)towards[1], 3.0 / far, 1e-6);
            assert_close((double)towards[2], down / far, 1e-6);
        }
        free(ping);
    }
}

/* Each of several gets its part of the rays, less than one alone: four as many as two together. */
static void several_objects_share_rays(void **state) {
    (void)state;
    static const asdic_vec3 at[4] = {{4, 0, 7}, {3, 2, 7}, {3, -2, 7}, {3, 0, 9}};
    const dev_beam beam = {
        .rows = {1, 0, 0, 0, 1, 0, 0, 0, 1}, .length_h_wl = 1.0f, .length_v_wl = 1.0f};
    const dev_beam beams[2] = {beam, beam};
    asdic_part balls[4];
    dev_uint counts[5] = {0};
    for (size_t count = 1; count <= 4; count *= 2) {
        dev_ping *ping = calloc(1, sizeof *ping);
        assert_non_null(ping);
        ping->range_m = 50.0f;
        ping->beams = 1;
        ping->batch.rays = ping->sampling.background = 1000;
        for (size_t i = 0; i < count; i++) {
            balls[i] = (asdic_part){.kind = DEV_KIND_OBJECT, .center_m = at[i], .radius_m = 0.1};
        }
        asdic_cones_place(balls, count, (asdic_vec3){0.0, 0.0, 7.0}, beams, NULL, 0, ping);
        assert_int_equal(ping->sampling.cones, count);
        counts[count] = ping->sampling.cone[0].count;
        assert_int_equal(ping->sampling.background, 1000 - count * counts[count]);
        free(ping);
    }
    print_message("%u rays of 1000 at one, %u at each of two, %u of four\n", counts[1], counts[2],
                  counts[4]);
    assert_close((double)counts[4], 0.5 * counts[1], 1.0);
    assert_close((double)counts[2], sqrt(0.5) * counts[1], 1.0);
}

/* One ball aside in empty water: pilots show its elevation, and among the elevations near it its azimuth, also at the
 * ends of the azimuths in front of the sonar. */
static void pilots_learn_where_a_ball_is(void **state) {
    enum { CELLS = DEV_TABLE_CELLS, ROWS = DEV_TABLE_ROWS, AZIMUTHS = DEV_AZIMUTH_CELLS };
    static const double yaws_deg[] = {40.0, -80.0, 80.0};
    int cells[3];
    (void)state;
    for (int at = 0; at < 3; at++) {
        ping_rig r = silent_rig();
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 0.5, 32, &mesh));
        double yaw_rad = yaws_deg[at] * RIG_DEGREE;
        asdic_pose pose = {.position_m = {30.0 * cos(yaw_rad), 30.0 * sin(yaw_rad), 7.0}};
        assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, pose,
                                                asdic_material_facet(45.0, 2e-4, 0.2)));
        asdic_mesh_destroy(&mesh);
        asdic_simulator *sim = rig_simulator(&r);
        assert_ok(t.ctx, asdic_simulator_learn(sim, &r.pose, 0));
        const float *table = sim->learnt.table;
        int loudest = 0;
        for (int i = 0; i < CELLS; i++) {
            loudest = table[i + 1] - table[i] > table[loudest + 1] - table[loudest] ? i : loudest;
        }
        const float *row = table + CELLS + 1 + loudest / (CELLS / ROWS) * (AZIMUTHS + 1);
        cells[at] = 0;
        for (int k = 0; k < AZIMUTHS; k++) {
            cells[at] = row[k + 1] - row[k] > row[cells[at] + 1] - row[cells[at]] ? k : cells[at];
        }
        double elevation = (double)(table[loudest + 1] - table[loudest]) * CELLS,
               azimuth = (double)(row[cells[at] + 1] - row[cells[at]]) * AZIMUTHS;
        print_message("elevation %d has %.2f of an even share, its azimuth %d %.2f\n", loudest,
                      elevation, cells[at], azimuth);
        assert_true(elevation > 3.0);
        assert_true(sim->learnt.azimuths && azimuth > 1.5);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    assert_int_equal(cells[1], 0);
    assert_int_equal(cells[2], AZIMUTHS - 1);
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(target_is_never_missed),
        cmocka_unit_test(cones_agree_with_beam_sampler),
        cmocka_unit_test(layers_hide_no_target),
        cmocka_unit_test(near_objects_are_as_loud_as_they_are),
        cmocka_unit_test(crowds_keep_the_flat_bins),
        cmocka_unit_test(few_rays_keep_the_flat_bins),
        cmocka_unit_test(near_objects_have_cones),
        cmocka_unit_test(images_have_cones),
        cmocka_unit_test(layers_have_a_cone_for_each_bundle),
        cmocka_unit_test(several_objects_share_rays),
        cmocka_unit_test(pilots_learn_where_a_ball_is),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
