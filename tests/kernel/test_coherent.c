/* Coherent pings against closed forms, quadrature and a reference in double. */
#include "coherent_rig.h"

#include "sim/patches.h"

static test_device t;

static double sinc(double x) {
    return fabs(x) < 1e-9 ? 1.0 : sin(0.5 * TURN * x) / (0.5 * TURN * x);
}

/* A point's pressure at every element: level by the sonar equation, phase by the way there and back, and half a turn in a
 * face's first side lobe, to the side or below. */
static void a_point_has_level_and_phase(void **state) {
    (void)state;
    /* Transmitter and element: sides h and v. */
    static const double faces_m[][4] = {{1e-4, 1e-4, 1e-4, 1e-4}, {0.06, 1e-4, 1e-4, 1e-4},
                                        {1e-4, 0.35, 1e-4, 1e-4}, {1e-4, 1e-4, 0.06, 1e-4},
                                        {1e-4, 1e-4, 1e-4, 0.35}, {0.06, 0.05, 0.01, 0.35}};
    asdic_vec3 at = {30.0, 12.0, 9.0};
    double range = sqrt(30.0 * 30 + 12 * 12 + 2 * 2), worst_db = 0.0, worst_turns = 0.0;
    for (int k = 0; k < 6; k++) {
        ping_rig r = empty_array(&t);
        const double *m = faces_m[k];
        r.sonar.transmitter.length_h_m = m[0];
        r.sonar.transmitter.length_v_m = m[1];
        r.sonar.array.element.length_h_m = m[2];
        r.sonar.array.element.length_v_m = m[3];
        double side = at.y / range / WAVELENGTH_M, below = 2.0 / range / WAVELENGTH_M;
        double pattern =
            sinc(m[0] * side) * sinc(m[1] * below) * sinc(m[2] * side) * sinc(m[3] * below);
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, -20.0));
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, 100e3, 7.0);
        double level = -20.0 - 40.0 * log10(range) - 2.0 * (range - 1.0) * alpha / 1000.0 +
                       20.0 * log10(fabs(pattern));
        for (size_t e = 0; e < ping->elements; e++) {
            double y = ((double)e - 15.5) * 0.0075;
            double back = sqrt(30.0 * 30 + (12 - y) * (12 - y) + 2 * 2);
            size_t n = (size_t)(0.5 * (range + back) / ping->sample_m);
            const float *p = array_at(ping, e, n);
            double turns = atan2(p[1], p[0]) / TURN + (range + back) / 0.015;
            turns -= pattern < 0.0 ? 0.5 : 0.0;
            worst_turns = fmax(worst_turns, fabs(turns - rint(turns)));
            worst_db = fmax(worst_db, fabs(20.0 * log10(hypot(p[0], p[1])) - level));
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    print_message("off by %.2g dB and %.2g turns\n", worst_db, worst_turns);
    assert_true(worst_db < 1e-3 && worst_turns < 1e-3);
}

/* At 1 MHz and 150 m there and back are 200,000 wavelengths, of a sonar NORTH_M from the scene's origin. */
static void hold_phase(double north_m) {
    ping_rig r = empty_array(&t);
    const double wavelength_m = 0.0015;
    r.sonar.frequency_hz = 1e6;
    r.sonar.array.spacing_m = 0.5 * wavelength_m;
    r.sonar.ping_rate_hz = 4.0;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.sonar.array.element.length_h_m = r.sonar.array.element.length_v_m = 1e-4;
    r.pose.position_m = (asdic_vec3){north_m + 1.2345678, -3.456789, 7.1};
    asdic_vec3 at[] = {{130.0, 70.0, 20.0}, {149.0, -3.0, 9.0}, {90.25, -119.5, 8.0}};
    for (int i = 0; i < 3; i++) {
        at[i].x += north_m;
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at[i], 0.0));
    }
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    double worst = 0.0;
    for (int i = 0; i < 3; i++) {
        double x = at[i].x - r.pose.position_m.x, y = at[i].y - r.pose.position_m.y;
        double z = at[i].z - r.pose.position_m.z, range = sqrt(x * x + y * y + z * z);
        for (size_t e = 0; e < ping->elements; e++) {
            double own = ((double)e - 15.5) * r.sonar.array.spacing_m;
            double back = sqrt(x * x + (y - own) * (y - own) + z * z);
            size_t n = (size_t)(0.5 * (range + back) / ping->sample_m);
            const float *p = array_at(ping, e, n);
            double turns = atan2(p[1], p[0]) / TURN + (range + back) / wavelength_m;
            worst = fmax(worst, fabs(turns - rint(turns)));
        }
    }
    print_message("%g m from the origin off by %.2g wavelengths\n", north_m, worst);
    assert_true(worst < 1e-3);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

static void phase_holds_at_a_megahertz(void **state) {
    (void)state;
    hold_phase(0.0);
    hold_phase(3000.1234567);
    hold_phase(-250000.7654321);
}

/* The sums of the scatterers that the device made, in double: of each element the samples from BEGIN on, short of
 * SAMPLES. */
static double *sum_elements(const dev_coherent *c, const dev_echo *echoes, size_t count,
                            size_t begin, size_t samples) {
    double *p = calloc(2 * c->elements * samples, sizeof *p);
    assert_non_null(p);
    for (size_t i = 0; i < count; i++) {
        for (size_t e = 0; e < c->elements; e++) {
            double y = ((double)e - 0.5 * (c->elements - 1.0)) * (double)c->spacing_m;
            double longer = element_longer(y, echoes[i].y, echoes[i].range_m);
            double way = echoes[i].way_m + 0.5 * longer;
            phasor turn =
                phasor_of(-longer * ((double)c->turns_per_m + (double)c->turns_per_m_low));
            double reach = PULSE_REACH * (double)c->pulse_m,
                   first = (way - reach) / c->sample_m - 0.5;
            for (size_t n = (size_t)fmax(ceil(first), (double)begin);
                 n < samples && (n + 0.5) * c->sample_m <= way + reach; n++) {
                double size = 1.0 + (echoes[i].tilt + echoes[i].bend * y) * y;
                double x = (way - (n + 0.5) * (double)c->sample_m) / c->pulse_m;
                phasor s = {size * pulse_at(x, 1.0), size * echoes[i].rise * pulse_slope(x)};
                phasor echo = phasor_times(turn, (phasor){echoes[i].re, echoes[i].im});
                double *to = p + 2 * (e * samples + n);
                to[0] += phasor_times(echo, s).re;
                to[1] += phasor_times(echo, s).im;
            }
        }
    }
    return p;
}

static void elements_agree_with_double(void **state) {
    (void)state;
    ping_rig r = array_rig(&t);
    r.env.particle_strength_db = -50.0;
    r.sonar.array.elements = 21; /* no whole number of vectors */
    asdic_mesh *plate = NULL;
    const asdic_pose pose = {.position_m = {6.0, 1.0, 7.0}};
    assert_ok(t.ctx, asdic_mesh_plate(t.ctx, 0.3, 0.3, &plate));
    assert_ok(t.ctx, asdic_scene_add_object(r.scene, "plate", plate, pose,
                                            asdic_material_facet(1.7, 0.0, 0.0)));
    asdic_mesh_destroy(&plate);
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    dev_echo *echoes = NULL;
    size_t count = 0;
    assert_ok(t.ctx, asdic_coherent_echoes(sim, &echoes, &count));
    assert_in_range(count, 10000, 200000);
    size_t begin = (size_t)ceil(r.sonar.blanking_m / ping->sample_m - 0.5 - 1e-6);
    double *p =
        sum_elements(asdic_coherent_told(sim->coherent), echoes, count, begin, ping->samples);
    double power = 0.0, difference = 0.0, worst = 0.0;
    for (size_t e = 0; e < ping->elements; e++) {
        for (size_t n = 0; n < ping->samples; n++) {
            size_t at = 2 * (e * ping->samples + n);
            double dx = ping->pressure[at] - p[at], dy = ping->pressure[at + 1] - p[at + 1];
            double own = p[at] * p[at] + p[at + 1] * p[at + 1];
            power += own;
            difference += dx * dx + dy * dy;
            worst = fmax(worst, own > 0.0 ? (dx * dx + dy * dy) / own : 0.0);
        }
    }
    print_message("%zu scatterers: %.1f dB below the pressure, %.1f dB at most\n", count,
                  10.0 * log10(difference / power), 10.0 * log10(worst));
    assert_true(difference < 1e-9 * power);
    free(p);
    free(echoes);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Points just before and behind the end of the blanking and of the range: samples between are those of a sonar that hears
 * from nearer and farther; before the blanking's end no echo is heard, at elements and in beams. */
static void pulses_are_cut_by_the_ends_alone(void **state) {
    (void)state;
    static const double ranges_m[] = {4.95, 5.02, 19.98, 20.03};
    asdic_ping *pings[2];
    for (int wider = 0; wider < 2; wider++) {
        ping_rig r = empty_array(&t);
        r.sonar.bandwidth_hz = 2500.0; /* 0.3 m */
        r.sonar.bin_length_m = 0.1;
        r.sonar.blanking_m = wider ? 1.0 : 5.0;
        r.sonar.max_range_m = wider ? 22.0 : 20.0;
        for (int i = 0; i < 4; i++) {
            asdic_vec3 at = {ranges_m[i], 0.0, 7.0};
            assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        }
        asdic_simulator *sim = rig_simulator(&r);
        pings[wider] = array_shoot(&r, sim, 0);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    for (size_t e = 0; e < pings[0]->elements; e++) {
        for (size_t n = 0; n < pings[0]->samples; n++) {
            bool heard = ((double)n + 0.5) * pings[0]->sample_m > 5.0;
            for (size_t part = 0; part < 2; part++) {
                double wide = heard ? array_at(pings[1], e, n)[part] : 0.0;
                assert_close(array_at(pings[0], e, n)[part], wide, heard ? 1e-7 : 0.0);
            }
        }
    }
    for (size_t n = 0; n < pings[0]->bins; n++) {
        double level = pings[0]->intensity_lin[ASDIC_TOTAL][n];
        double whole = pings[1]->intensity_lin[ASDIC_TOTAL][n];
        assert_close(level, n < 50 ? 0.0 : whole, n < 50 ? 0.0 : 1e-9);
    }
    assert_true(pings[0]->intensity_lin[ASDIC_TOTAL][50] > 1e-4 &&
                pings[0]->intensity_lin[ASDIC_TOTAL][199] > 1e-6 &&
                pings[1]->intensity_lin[ASDIC_TOTAL][49] > 1e-4);
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

#define PATTERN_BEAMS 121

/* The energy of a point summed over bins, as of all looks at it, over what is due: the least and the most of the places
 * in a bin, ahead and 30 degrees to starboard. */
static void hold_energy(double cells, double least_db, double most_db) {
    enum { PLACES = 24 };
    ping_rig r = empty_array(&t);
    double sums[2] = {0.0}, least = INFINITY, most = -INFINITY, yaw[2] = {0.0, 30.0 * RIG_DEGREE};
    r.sonar.array.elements = 64;
    r.sonar.array.element.length_h_m = r.sonar.array.element.length_v_m = 1e-4;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    r.sonar.bandwidth_hz = 1e4;
    r.sonar.bin_length_m = 0.075 * cells;
    r.sonar.max_range_m = 30.0;
    r.receivers[1] = r.receivers[0];
    r.receivers[1].yaw_rad = yaw[1];
    r.sonar.receiver_count = 2;
    assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", (asdic_vec3){0.0, 0.0, 7.0}, 0.0));
    asdic_simulator *sim = rig_simulator(&r);
    for (int k = 0; k < 2 * PLACES; k++) {
        int beam = k % 2;
        double range = 20.0 + (k / 2 + 0.3) / PLACES * r.sonar.bin_length_m;
        r.pose.position_m = (asdic_vec3){-range * cos(yaw[beam]), -range * sin(yaw[beam]), 7.0};
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double alpha = asdic_environment_absorption_db_per_km(&r.env, 100e3, 7.0), energy = 0.0;
        double due_db = -40.0 * log10(range) - 2.0 * (range - 1.0) * alpha / 1000.0;
        for (size_t n = 0; n < ping->bins; n++) {
            energy += ping->intensity_lin[ASDIC_TOTAL][(size_t)beam * ping->bins + n];
        }
        double off_db = 10.0 * log10(energy) - due_db;
        sums[beam] += pow(10.0, 0.1 * off_db) / PLACES;
        least = fmin(least, off_db);
        most = fmax(most, off_db);
        asdic_ping_destroy(&ping);
    }
    print_message("bins of %.2f cells: %.3f to %.3f dB, mean %.3f ahead, %.3f aside\n", cells,
                  least, most, 10.0 * log10(sums[0]), 10.0 * log10(sums[1]));
    assert_true(least > least_db && most < most_db);
    assert_true(fabs(10.0 * log10(sums[0])) < 0.02 && fabs(10.0 * log10(sums[1])) < 0.02);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Bins of other parts of a cell than whole ones miss some of an echo, or take it in twice: as one sample of it does. */
static void a_point_is_as_loud_anywhere_in_a_bin(void **state) {
    (void)state;
    static const double cells[] = {1.0, 0.5, 0.25, 0.05, 1.2, 1.51, 2.0, 2.5, 2.52};
    for (size_t i = 0; i < sizeof cells / sizeof *cells; i++) {
        hold_energy(cells[i], -0.08, 0.08);
    }
    hold_energy(0.77, -1.3, 1.6);
}

/* Beams of every shading from -60 to 60 degrees, heard by a point 10 degrees to starboard. */
static void beams_have_the_pattern_of_their_weights(void **state) {
    (void)state;
    for (int shading = ASDIC_SHADING_NONE; shading <= ASDIC_SHADING_CHEBYSHEV; shading++) {
        ping_rig r = empty_array(&t);
        asdic_beam beams[PATTERN_BEAMS] = {0};
        r.sonar.bandwidth_hz = 1000.0;
        r.sonar.bin_length_m = 0.75;
        r.sonar.array.shading = (asdic_shading)shading;
        r.sonar.array.side_lobe_db = -30.0;
        for (int b = 0; b < PATTERN_BEAMS; b++) {
            beams[b] = r.receivers[0];
            beams[b].yaw_rad = (b - 60) * RIG_DEGREE;
        }
        double range = 53.5 * 0.75, bearing = 10.0 * RIG_DEGREE, worst = 0.0;
        asdic_vec3 at = {range * cos(bearing), range * sin(bearing), 7.0};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        assert_ok(t.ctx, asdic_scene_commit(r.scene));
        r.sonar.receivers = beams;
        r.sonar.receiver_count = PATTERN_BEAMS;
        asdic_simulator *sim = NULL;
        assert_ok(t.ctx, asdic_simulator_create(t.ctx, t.device, r.scene, &r.env, &r.sonar,
                                                &r.sampling, 7.0, &sim));
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double weights[32], none = ping->intensity_lin[ASDIC_TOTAL][70 * ping->bins + 53];
        asdic_array_weights(&r.sonar.array, weights);
        for (int b = 0; b < PATTERN_BEAMS; b++) {
            double re = 0.0, im = 0.0, off = sin((b - 60) * RIG_DEGREE) - sin(bearing);
            for (int e = 0; e < 32; e++) {
                re += weights[e] * cos(TURN * 0.5 * off * (e - 15.5));
                im += weights[e] * sin(TURN * 0.5 * off * (e - 15.5));
            }
            double expected = 10.0 * log10(re * re + im * im);
            double level = asdic_level_db(
                ping->intensity_lin[ASDIC_TOTAL][(size_t)b * ping->bins + 53] / none);
            worst = fmax(worst, expected > -40.0 ? fabs(level - expected) : 0.0);
        }
        print_message("shading %d: off by %.3f dB\n", shading, worst);
        assert_true(worst < 0.1);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* Work-groups of any size: the same bytes, at elements and in beams. */
static void work_groups_change_no_byte(void **state) {
    (void)state;
    static const size_t locals[] = {16, 1, 8, 40, 256, 4096};
    asdic_ping *first = NULL;
    for (size_t k = 0; k < sizeof locals / sizeof *locals; k++) {
        ping_rig r = array_rig(&t);
        asdic_mesh *mesh = NULL;
        assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &mesh));
        asdic_pose pose = {.position_m = {12.0, 2.0, 11.0}};
        assert_ok(t.ctx,
                  asdic_scene_add_object(r.scene, "box", mesh, pose, asdic_material_bottom(2.0)));
        r.env.particle_strength_db = -60.0;
        r.sonar.noise_enabled = true;
        r.sonar.max_range_m = 20.0;
        r.layout.local = locals[k];
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 3);
        first = first ? first : ping;
        assert_memory_equal(ping->pressure, first->pressure,
                            2 * ping->elements * ping->samples * sizeof(float));
        assert_true(rig_same(ping, first));
        if (ping != first) {
            asdic_ping_destroy(&ping);
        }
        asdic_mesh_destroy(&mesh);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    asdic_ping_destroy(&first);
}

/* What lies to either side and ahead is heard alike, on whichever side of the scene's zero the sonar is. */
static void both_sides_are_heard(void **state) {
    static const double at_m[] = {-0.5, 0.0, 0.5};
    double first = 0.0;
    (void)state;
    for (int k = 0; k < 9; k++) {
        ping_rig r = array_rig(&t);
        r.sonar.receiver_count = 2;
        r.sonar.max_range_m = 20.0;
        r.sampling.rays = 4000;
        r.pose.position_m.x = at_m[k / 3];
        r.pose.position_m.y = at_m[k % 3];
        for (int b = 0; b < 2; b++) {
            r.receivers[b].length_h_m = 0.12;
            r.receivers[b].yaw_rad = (b ? 40.0 : -40.0) * RIG_DEGREE;
        }
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        double sum[2] = {0.0, 0.0};
        for (size_t i = 0; i < 2 * ping->bins; i++) {
            sum[i / ping->bins] += ping->intensity_lin[ASDIC_TOTAL][i];
        }
        print_message("at (%g, %g): port %.2f dB above starboard\n", r.pose.position_m.x,
                      r.pose.position_m.y, 10.0 * log10(sum[0] / sum[1]));
        first = k == 0 ? sum[0] + sum[1] : first;
        assert_close(10.0 * log10(sum[0] / sum[1]), 0.0, 3.0);
        assert_close(10.0 * log10((sum[0] + sum[1]) / first), 0.0, 3.0);
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

/* What scatters in the water is new in every ping, were it 2^32 pings later. */
static void water_is_new_in_every_ping(void **state) {
    static const uint64_t indices[] = {5, 6, 5 + (1ull << 32), 5 + (1ull << 63)};
    asdic_ping *first = NULL;
    (void)state;
    ping_rig r = empty_array(&t);
    r.env.particle_strength_db = -50.0;
    r.sonar.max_range_m = 20.0;
    r.sampling.rays = 1000;
    asdic_simulator *sim = rig_simulator(&r);
    for (size_t k = 0; k < sizeof indices / sizeof *indices; k++) {
        asdic_ping *ping = array_shoot(&r, sim, indices[k]);
        first = first ? first : ping;
        size_t bytes = 2 * ping->elements * ping->samples * sizeof(float);
        assert_true(ping == first || memcmp(ping->pressure, first->pressure, bytes) != 0);
        if (ping != first) {
            asdic_ping_destroy(&ping);
        }
    }
    asdic_ping_destroy(&first);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Where scatterers of facets begin is even over them, along either edge and by both; on a plane, whose pieces join,
 * it is one place. */
static void scatterers_lie_anywhere_on_facets(void **state) {
    (void)state;
    asdic_mesh *mesh = NULL;
    asdic_patches patches = {0};
    ping_rig r = array_rig(&t);
    assert_ok(t.ctx, asdic_mesh_sphere(t.ctx, 1.5, 32, &mesh));
    asdic_pose pose = {.position_m = {12.0, 2.0, 9.0}};
    assert_ok(t.ctx,
              asdic_scene_add_object(r.scene, "ball", mesh, pose, asdic_material_bottom(2.0)));
    asdic_mesh_destroy(&mesh);
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 3);
    assert_ok(t.ctx, asdic_patches_find(sim, &sim->shots[0], &patches));
    const dev_patch *plane = NULL;
    double n = 0.0, u = 0.0, v = 0.0, uu = 0.0, vv = 0.0, uv = 0.0;
    for (size_t i = 0; i < patches.count; i++) {
        const dev_patch *p = &patches.items[i];
        if (p->kind == DEV_KIND_OBJECT) {
            double x = p->start[0] / 0x1p32 - 0.5, y = p->start[1] / 0x1p32 - 0.5;
            n += 1.0, u += x, v += y, uu += x * x, vv += y * y, uv += x * y;
        } else if (p->kind == DEV_KIND_BOTTOM) {
            plane = plane ? plane : p;
            assert_memory_equal(p->start, plane->start, sizeof p->start);
            assert_true(p == plane || memcmp(p->key, plane->key, sizeof p->key) != 0);
        }
    }
    print_message("%.0f facets: on average %.3f and %.3f, correlation %.3f\n", n, u / n, v / n,
                  12.0 * uv / n);
    assert_true(n > 500.0 && plane);
    assert_close(u / n, 0.0, 4.0 / sqrt(12.0 * n));
    assert_close(v / n, 0.0, 4.0 / sqrt(12.0 * n));
    assert_close(12.0 * uu / n, 1.0, 4.0 / sqrt(n));
    assert_close(12.0 * vv / n, 1.0, 4.0 / sqrt(n));
    assert_close(12.0 * uv / n, 0.0, 4.0 / sqrt(n));
    /* Where there is no room for all they are looked for no longer. */
    patches.most = patches.slots / 3;
    assert_ok(t.ctx, asdic_patches_find(sim, &sim->shots[0], &patches));
    assert_in_range(patches.slots, patches.most + 1, patches.most + DEV_PATCH_SCATTERERS);
    asdic_patches_finish(&patches);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Points and water a whole number of steps of the frame away (scene/placement.h): the same pressures. */
static void places_far_away_are_as_exact(void **state) {
    (void)state;
    asdic_ping *pings[2];
    for (int far = 0; far < 2; far++) {
        ping_rig r = empty_array(&t);
        const double north_m = far ? 600 * 8192.0 : 0.0, east_m = far ? -70 * 8192.0 : 0.0;
        r.env.particle_strength_db = -60.0;
        r.sampling.rays = 1000;
        r.pose.position_m = (asdic_vec3){north_m + 0.125, east_m - 0.25, 7.0};
        asdic_vec3 at = {north_m + 30.015625, east_m + 3.0, 9.0};
        assert_ok(t.ctx, asdic_scene_add_point(r.scene, "p", at, 0.0));
        asdic_simulator *sim = rig_simulator(&r);
        pings[far] = array_shoot(&r, sim, 0);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
    size_t floats = 2 * pings[0]->elements * pings[0]->samples;
    assert_memory_equal(pings[0]->pressure, pings[1]->pressure, floats * sizeof(float));
    asdic_ping_destroy(&pings[0]);
    asdic_ping_destroy(&pings[1]);
}

/* Beyond the last bin nothing is heard, and no memory asked for. */
static void blanking_may_leave_no_bin(void **state) {
    (void)state;
    ping_rig r = array_rig(&t);
    r.env.particle_strength_db = -50.0;
    r.sonar.max_range_m = 20.0;
    r.sonar.blanking_m = 25.0;
    r.sampling.rays = 1000;
    asdic_simulator *sim = rig_simulator(&r);
    asdic_ping *ping = array_shoot(&r, sim, 0);
    for (size_t i = 0; i < 2 * ping->elements * ping->samples; i++) {
        assert_true(ping->pressure[i] == 0.0f);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    rig_destroy(&r);
}

/* Boundaries that mirror scatter as they do where they do not mirror, by the same scatterers. */
static void boundaries_that_mirror_scatter_as_before(void **state) {
    (void)state;
    double worst = 0.0;
    for (int is_surface = 0; is_surface < 2; is_surface++) {
        asdic_ping *pings[2];
        for (int mirrors = 0; mirrors < 2; mirrors++) {
            ping_rig r = is_surface ? empty_array(&t) : array_rig(&t);
            asdic_scene_set_surface(r.scene, is_surface);
            r.env.wind_speed_kn = 0.0;
            r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
            r.sampling.multipath = mirrors ? ASDIC_MULTIPATH_BOUNDARIES : ASDIC_MULTIPATH_OFF;
            asdic_simulator *sim = rig_simulator(&r);
            pings[mirrors] = array_shoot(&r, sim, 0);
            asdic_simulator_destroy(&sim);
            rig_destroy(&r);
        }
        const double *before = pings[0]->intensity_lin[ASDIC_TOTAL],
                     *after = pings[1]->intensity_lin[ASDIC_TOTAL];
        for (size_t n = is_surface ? 0 : 20; n < pings[0]->bins; n++) { /* 5 m above the sand */
            worst = fmax(worst, fabs(after[n] - before[n]) / fmax(before[n], 1e-300));
        }
        asdic_ping_destroy(&pings[0]);
        asdic_ping_destroy(&pings[1]);
    }
    print_message("direct echoes off by %.2g at most\n", worst);
    assert_true(worst < 5e-3);
}

/* Nothing in reach, and water left out: a ping of nothing, or of noise alone. */
static void a_ping_may_have_no_scatterer(void **state) {
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        ping_rig r = empty_array(&t);
        r.sampling.left_out = 1u << ASDIC_TERM_VOLUME;
        r.sonar.max_range_m = 20.0;
        r.sonar.noise_enabled = kind % 2;
        if (kind / 2) { /* far away */
            asdic_mesh *mesh = NULL;
            assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){1.0, 1.0, 1.0}, &mesh));
            assert_ok(t.ctx, asdic_scene_add_object(r.scene, "box", mesh,
                                                    (asdic_pose){.position_m = {500.0, 0.0, 7.0}},
                                                    asdic_material_bottom(2.0)));
            asdic_mesh_destroy(&mesh);
        }
        asdic_simulator *sim = rig_simulator(&r);
        asdic_ping *ping = array_shoot(&r, sim, 0);
        for (size_t i = 0; i < 2 * ping->elements * ping->samples; i++) {
            assert_true((ping->pressure[i] != 0.0f) == r.sonar.noise_enabled);
        }
        asdic_ping_destroy(&ping);
        asdic_simulator_destroy(&sim);
        rig_destroy(&r);
    }
}

int main(void) {
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_point_has_level_and_phase),
        cmocka_unit_test(phase_holds_at_a_megahertz),
        cmocka_unit_test(elements_agree_with_double),
        cmocka_unit_test(pulses_are_cut_by_the_ends_alone),
        cmocka_unit_test(a_point_is_as_loud_anywhere_in_a_bin),
        cmocka_unit_test(beams_have_the_pattern_of_their_weights),
        cmocka_unit_test(work_groups_change_no_byte),
        cmocka_unit_test(both_sides_are_heard),
        cmocka_unit_test(water_is_new_in_every_ping),
        cmocka_unit_test(scatterers_lie_anywhere_on_facets),
        cmocka_unit_test(places_far_away_are_as_exact),
        cmocka_unit_test(blanking_may_leave_no_bin),
        cmocka_unit_test(a_ping_may_have_no_scatterer),
        cmocka_unit_test(boundaries_that_mirror_scatter_as_before),
    };
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
