/* What coherent pings have on average, anywhere: elements over terrain and past an object against pings of
 * intensities, beams of every shading against their weights. */
#include "coherent_rig.h"
#include "kernels/backscatter.h"
#include "pulse.h"

#include <complex.h>

static test_device t;
static bool full;

/* Bins of a metre, of 53 looks. */
static ping_rig wide_band(void) {
    ping_rig r = array_rig(&t);
    r.sonar.bandwidth_hz = 40e3;
    r.sonar.bin_length_m = 1.0;
    r.sonar.max_range_m = 60.0;
    r.sonar.transmitter.length_h_m = 0.0075;
    r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
    r.sampling.rays = 100000;
    return r;
}

/* Intensities by bin, the mean over as many pings and all elements. */
typedef struct means {
    double *element, *beams; /* [bin]; [beam][bin] */
    size_t bins;
} means;

static means average(ping_rig *r, uint64_t pings) {
    means m = {0};
    for (uint64_t seed = 1; seed <= pings; seed++) {
        r->sampling.seed = seed;
        asdic_simulator *sim = rig_simulator(r);
        asdic_ping *ping = array_shoot(r, sim, seed);
        m.bins = ping->bins;
        m.element = m.element ? m.element : calloc(m.bins, sizeof *m.element);
        m.beams = m.beams ? m.beams : calloc(ping->beams * m.bins, sizeof *m.beams);
        assert_true(m.element && m.beams);
        /* The pulse's energy on the grid is its length, that of a look, over a sample's. */
        unsigned looks = asdic_sonar_looks(&r->sonar, 1500.0);
        double pulse_m = r->sonar.bin_length_m / looks;
        double unit = ping->sample_m / pulse_m / (double)(pings * ping->elements);
        for (size_t e = 0; e < ping->elements; e++) {
            for (size_t n = 0; n < ping->samples; n++) {
                const float *p = array_at(ping, e, n);
                m.element[n * m.bins / ping->samples] +=
                    unit * ((double)p[0] * p[0] + (double)p[1] * p[1]);
            }
        }
        for (size_t i = 0; i < ping->beams * m.bins; i++) {
            m.beams[i] += ping->intensity_lin[ASDIC_TOTAL][i] / (double)pings;
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
    }
    return m;
}

/* The same bins of what R's element hears as a receiver, without phase. */
static double *without_phase(ping_rig *r, size_t bins) {
    enum { PINGS = 6 };
    double *level = calloc(bins, sizeof *level);
    assert_non_null(level);
    r->sampling.coherent = false;
    r->sampling.rays = full ? 4000000 : 300000;
    r->receivers[0] = r->sonar.array.element;
    r->sonar.array.elements = 0;
    asdic_simulator *sim = rig_simulator(r);
    for (uint64_t k = 0; k < PINGS; k++) {
        asdic_ping *ping = NULL;
        assert_ok(t.ctx, asdic_ping_create(t.ctx, 1, asdic_simulator_bin_count(sim), &ping));
        assert_ok(t.ctx, asdic_simulator_ping(sim, &r->pose, k, ping));
        assert_int_equal(ping->bins, bins);
        for (size_t n = 0; n < bins; n++) {
            level[n] += ping->intensity_lin[ASDIC_TOTAL][n] / PINGS;
        }
        asdic_ping_destroy(&ping);
    }
    asdic_simulator_destroy(&sim);
    return level;
}

/* Hills of a metre over a square of 130 m, 12 m down: their heights are two waves. */
static void add_terrain(ping_rig *r) {
    enum { SIDE = 66 };
    static double vertices[SIDE * SIDE * 3];
    static uint32_t corners[(SIDE - 1) * (SIDE - 1) * 6];
    uint32_t *corner = corners;
    for (int i = 0; i < SIDE; i++) {
        for (int j = 0; j < SIDE; j++) {
            double x = 2.0 * i - SIDE + 1.0, y = 2.0 * j - SIDE + 1.0;
            double *v = vertices + 3 * (i * SIDE + j);
            v[0] = x;
            v[1] = y;
            v[2] = 12.0 + 0.6 * sin(0.31 * x + 0.17 * y) + 0.4 * sin(0.23 * y - 0.4 * x);
            if (i + 1 < SIDE && j + 1 < SIDE) {
                uint32_t at = (uint32_t)(i * SIDE + j);
                const uint32_t both[6] = {at, at + 1, at + SIDE, at + SIDE, at + 1, at + SIDE + 1};
                memcpy(corner, both, sizeof both);
                corner += 6;
            }
        }
    }
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, vertices, SIDE * SIDE, corners,
                                               sizeof corners / sizeof *corners / 3, &mesh));
    rig_empty(r);
    assert_ok(t.ctx,
              asdic_scene_add_bottom(r->scene, mesh, (asdic_pose){0}, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
}

static void add_ball(ping_rig *r) {
    asdic_mesh *mesh = NULL;
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.5, 32, &mesh));
    asdic_pose pose = {.position_m = {24.0, 5.0, 10.5}};
    assert_ok(t.ctx,
              asdic_scene_add_object(r->scene, "ball", mesh, pose, asdic_material_bottom(3.0)));
    asdic_mesh_destroy(&mesh);
}

/* Elements over hills, with the sea's surface, and an object that hides some of both. */
static void elements_hear_as_much_as_intensities(void **state) {
    (void)state;
    const uint64_t pings = full ? 120 : 12;
    ping_rig r = wide_band();
    add_terrain(&r);
    add_ball(&r);
    asdic_scene_set_surface(r.scene, true);
    r.sonar.array.elements = 37;
    r.sonar.array.spacing_m = 0.6 * WAVELENGTH_M;
    r.sonar.array.element.length_h_m = 0.6 * WAVELENGTH_M;
    means m = average(&r, pings);
    double *level = without_phase(&r, m.bins), squares = 0.0, offset = 0.0, worst = 0.0;
    size_t count = 0;
    for (size_t n = 9; n + 1 < m.bins; n++, count++) { /* beyond the surface's first echo */
        double db = 10.0 * log10(m.element[n] / level[n]);
        squares += db * db;
        offset += db;
        worst = fabs(db) > fabs(worst) ? db : worst;
    }
    squares = sqrt(squares / (double)count);
    offset /= (double)count;
    print_message("terrain and ball: off by %.3f dB r.m.s. over %zu bins, %.3f on average, %.3f at "
                  "most\n",
                  squares, count, offset, worst);
    assert_true(squares < (full ? 0.05 : 0.15) && fabs(offset) < (full ? 0.03 : 0.06));
    free(level);
    free(m.element);
    free(m.beams);
    rig_destroy(&r);
}

/* A rough ball below a calm surface: straight, by way of the surface one way, and both ways. Out over the surface and
 * straight home is as long as its reverse: with phase both add to four times one, without to twice. */
static void ways_of_one_length_add_in_phase(void **state) {
    (void)state;
    const uint64_t pings = full ? 400 : 60;
    ping_rig r = wide_band();
    asdic_mesh *mesh = NULL;
    rig_empty(&r);
    asdic_scene_set_surface(r.scene, true);
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.0, 64, &mesh));
    asdic_pose pose = {.position_m = {16.0, 0.0, 6.0}};
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "ball", mesh, pose,
                                            asdic_material_facet(0.0, 3e-3, 0.2)));
    asdic_mesh_destroy(&mesh);
    r.env.wind_speed_kn = 0.0;
    r.pose.position_m.z = 6.0;
    r.sonar.max_range_m = 25.0;
    r.sonar.transmitter.length_v_m = r.sonar.array.element.length_v_m = 0.002;
    r.sonar.transmitter.length_h_m = r.sonar.array.element.length_h_m = 0.0075;
    r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    r.sampling.rays = 5000;
    means m = average(&r, pings);
    double *level = without_phase(&r, m.bins);
    static const size_t edges[] = {14, 16, 18, 22};
    for (int way = 0; way < 3; way++) {
        double with = 0.0, without = 0.0;
        for (size_t n = edges[way]; n < edges[way + 1]; n++) {
            with += m.element[n];
            without += level[n];
        }
        double more_db = 10.0 * log10(with / without), expected_db = way == 1 ? 3.01 : 0.0;
        print_message("%d of both legs by the mirror: %.2f dB more with phase, %.2f expected\n",
                      way, more_db, expected_db);
        assert_close(more_db, expected_db, full ? 0.3 : 0.8);
    }
    free(level);
    free(m.element);
    free(m.beams);
    rig_destroy(&r);
}

/* Elements and a transmitter that hear alike wherever they face: UP, or, where they do not, everywhere. */
static ping_rig hears_alike(bool up) {
    ping_rig r = wide_band();
    asdic_beam *faces[] = {&r.sonar.transmitter, &r.sonar.array.element, &r.receivers[0]};
    for (int i = 0; i < 3; i++) {
        faces[i]->length_h_m = faces[i]->length_v_m = 1e-4;
        faces[i]->pitch_rad = up ? -0.25 * TURN : 0.0;
    }
    r.sonar.rear_floor_db = up ? -INFINITY : 0.0;
    r.sonar.array.elements = 2; /* as close as one: away from the transmitter ways differ */
    r.sonar.array.spacing_m = 1e-4;
    r.sonar.max_range_m = 24.0;
    r.env.wind_speed_kn = 0.0;
    r.sampling.rays = 5000;
    r.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    return r;
}

/* Water below a calm surface, H above. Straight it is a sphere, or the upper half of one, whose cap beyond the surface
 * is that of the image; one leg by the surface, spheroids about both, of which either way adds in phase. */
static void water_is_heard_by_way_of_the_surface(void **state) {
    (void)state;
    const double h = 7.0;
    const uint64_t pings = full ? 100 : 8;
    for (int up = 0; up < 2; up++) {
        ping_rig r = hears_alike(up);
        rig_empty(&r);
        asdic_scene_set_surface(r.scene, true);
        r.env.particle_strength_db = -50.0;
        r.sampling.left_out = 1u << ASDIC_TERM_SURFACE;
        means m = average(&r, pings);
        double loss = asdic_environment_absorption_db_per_km(&r.env, 100e3, h) / 1000.0;
        double strength_db = volume_backscatter_db(-50.0, 100.0);
        static const size_t first[] = {1, 8, 14}, end[] = {7, 14, 24};
        for (int k = 0; k < 3; k++) {
            double heard = 0.0, expected = 0.0;
            for (size_t n = first[k]; n < end[k]; n++) {
                double d = (double)n + 0.5, far = fmin(h / d, 1.0);
                double between = d > h ? atanh(up ? far * far : far) / (h * d) : 0.0;
                expected += TURN * ((up ? 1.0 : 2.0) / (double)(n * n + n) + 4.0 * between) *
                            pow(10.0, 0.1 * (strength_db - 2.0 * loss * (d - 1.0)));
                heard += m.element[n];
            }
            double db = 10.0 * log10(heard / expected);
            print_message("%s, %zu to %zu m: off by %.2f dB\n", up ? "up" : "all around", first[k],
                          end[k], db);
            assert_close(db, 0.0, full ? 0.15 : 0.3);
        }
        free(m.element);
        free(m.beams);
        rig_destroy(&r);
    }
}

/* What lies behind a sonar that looks up is before it by way of a calm surface: a bottom 3 m below, or mirrored one of 17 m.
 * A sonar that looks down on such a bottom hears as much. */
static void what_lies_behind_is_heard_by_way_of_a_mirror(void **state) {
    (void)state;
    double heard[2] = {0.0, 0.0};
    for (int up = 0; up < 2; up++) {
        ping_rig r = hears_alike(true);
        if (!up) {
            r.sonar.transmitter.pitch_rad = r.sonar.array.element.pitch_rad = 0.25 * TURN;
        }
        r.sonar.max_range_m = 28.0;
        r.sonar.blanking_m = 5.0; /* beyond the way straight down */
        r.sampling.left_out |= 1u << ASDIC_TERM_SURFACE;
        assert_ok(t.ctx, asdic_scene_set_bottom_plane(r.scene, up ? 10.0 : 24.0,
                                                      asdic_material_bottom(2.0)));
        asdic_scene_set_surface(r.scene, up);
        means m = average(&r, full ? 100 : 20);
        for (size_t n = 19; n < 28; n++) {
            heard[up] += m.element[n];
        }
        free(m.element);
        free(m.beams);
        rig_destroy(&r);
    }
    double db = 10.0 * log10(heard[1] / heard[0]);
    print_message("behind, by way of the surface: off by %.2f dB\n", db);
    assert_close(db, 0.0, full ? 0.15 : 0.3);
}

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* The energy of a beam towards STEER over that of an element, from a ring of bottom RANGE away and 5 m down, at SCALE times
 * the carrier's frequency: quadrature over azimuth of what transmitter, element and weights take in. */
static double taken_in(const asdic_array *array, const double *weights, double steer, double range,
                       double scale) {
    double level = sqrt(1.0 - 25.0 / (range * range)), beam = 0.0, all = 0.0;
    for (int i = -400; i < 400; i++) {
        double y = level * sin((i + 0.5) / 400.0 * 0.25 * TURN);
        double heard = pow(sinc(0.5 * y) * sinc(array->element.length_h_m / WAVELENGTH_M * y), 2.0);
        double turns = scale * array->spacing_m / WAVELENGTH_M * (y - steer);
        double complex sum = 0.0, phase = 1.0, step = cexp(I * TURN * turns);
        for (size_t e = 0; e < array->elements; e++) {
            sum += weights[e] * phase;
            phase *= step;
        }
        beam += heard * creal(sum * conj(sum));
        all += heard;
    }
    return beam / all;
}

/* The same over the pulse's spectrum, BAND wide over the carrier's frequency: above it neighbours of the visible
 * directions are heard as well. */
static double taken_in_band(const asdic_array *array, const double *weights, double steer,
                            double range, double band) {
    double sum = 0.0, all = 0.0;
    for (int i = -30; i <= 30; i++) {
        double amplitude = 0.0, part = 0.1 * i;
        for (int k = 0; k < 300; k++) {
            double x = (k + 0.5) / 400.0;
            amplitude += pulse_amplitude(x) * cos(TURN * part * x) / 200.0;
        }
        double share = amplitude * amplitude;
        sum += share * taken_in(array, weights, steer, range, 1.0 + part * band);
        all += share;
    }
    return sum / all;
}

/* An aperture of 22.2 wavelengths, elements 0.6 apart, every shading. */
static void beams_take_in_what_their_weights_say(void **state) {
    (void)state;
    enum { ELEMENTS = 37 };
    static const double yaw_deg[RIG_BEAMS] = {0.0, -21.0, 38.0};
    double worst = 0.0;
    for (int shading = full ? 0 : 2; shading < (full ? 4 : 3); shading++) {
        ping_rig r = wide_band();
        asdic_scene_set_surface(r.scene, false);
        r.sonar.array.elements = ELEMENTS;
        r.sonar.array.spacing_m = 0.6 * WAVELENGTH_M;
        r.sonar.array.element.length_h_m = 0.6 * WAVELENGTH_M;
        r.sonar.array.shading = (asdic_shading)shading;
        r.sonar.array.side_lobe_db = -30.0;
        r.sonar.receiver_count = RIG_BEAMS;
        for (int b = 0; b < RIG_BEAMS; b++) {
            r.receivers[b] = r.receivers[0];
            r.receivers[b].yaw_rad = yaw_deg[b] * RIG_DEGREE;
        }
        double weights[ELEMENTS];
        asdic_array_weights(&r.sonar.array, weights);
        means m = average(&r, full ? 20 : 4);
        for (int b = 0; b < RIG_BEAMS; b++) {
            double sum = 0.0, steer = sin(r.receivers[b].yaw_rad);
            double expected = taken_in_band(&r.sonar.array, weights, steer, 37.0, 0.4);
            for (size_t n = 20; n < 59; n++) {
                sum += m.beams[(size_t)b * m.bins + n] / m.element[n] / 39.0;
            }
            double db = 10.0 * log10(sum / expected);
            print_message("shading %d, beam at %.0f degrees: off by %.3f dB\n", shading, yaw_deg[b],
                          db);
            worst = fmax(worst, fabs(db));
        }
        free(m.element);
        free(m.beams);
        rig_destroy(&r);
    }
    assert_true(worst < 0.3);
}

int main(int argc, char **argv) {
    full = argc > 1 && strcmp(argv[1], "--full") == 0;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elements_hear_as_much_as_intensities),
        cmocka_unit_test(ways_of_one_length_add_in_phase),
        cmocka_unit_test(water_is_heard_by_way_of_the_surface),
        cmocka_unit_test(what_lies_behind_is_heard_by_way_of_a_mirror),
        cmocka_unit_test(beams_take_in_what_their_weights_say),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
