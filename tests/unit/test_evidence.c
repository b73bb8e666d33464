/* What a ping says of every direction and range. */
#include "map_rig.h"

#include "detect/evidence.h"

/* Directions a quarter of the narrowest width apart; beams hear them within 1.5 of their own widths and 0.03 of what
 * they hear on their axes, the best in this first, whose axis all gains refer to. Beams that hear the same share
 * its weight. */
static void headings_know_who_hears_them(void **state) {
    (void)state;
    static const double yaw_rad[] = {0.2, 0.0, 0.08, 0.85, 0.21},
                        wide_m[] = {0.1, 0.05, 0.1, 0.2, 0.05};
    map_rig r;
    asdic_evidence seen = {0};
    double width_rad[5], axis_lin[5], weight[5], narrowest_rad = 7.0;
    map_begin(&r, 5);
    r.sonar.transmitter.length_h_m = 0.01;
    for (size_t b = 0; b < 5; b++) {
        r.beams[b].yaw_rad = yaw_rad[b];
        r.beams[b].length_h_m = wide_m[b];
    }
    for (size_t b = 0; b < 5; b++) {
        width_rad[b] = asdic_beam_width_rad(&r.sonar, b, SPEED);
        narrowest_rad = fmin(narrowest_rad, width_rad[b]);
        axis_lin[b] = face_gain(&r.sonar, 0.01, yaw_rad[b]);
        double sum = 0.0;
        for (size_t k = 0; k < 5; k++) {
            double aside = yaw_rad[k] - yaw_rad[b];
            sum += fabs(aside) < 4.0 * width_rad[b] ? face_gain(&r.sonar, wide_m[b], aside) : 0.0;
        }
        weight[b] = 1.0 / sum;
    }
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    assert_int_equal(seen.arcs, 1);
    assert_int_equal(seen.azimuths, (size_t)ceil(8.0 * acos(-1.0) / narrowest_rad));
    size_t several = 0;
    for (size_t k = 0; k < seen.azimuths; k++) {
        const asdic_heading *h = &seen.headings[k];
        const asdic_hearing *heard = seen.hearings + h->hearing;
        double at = remainder((double)k * seen.step_rad, 2.0 * acos(-1.0));
        double lin[5], best = 0.0;
        size_t count = 0;
        for (size_t b = 0; b < 5; b++) {
            double aside = fabs(at - yaw_rad[b]);
            lin[b] = face_gain(&r.sonar, 0.01, at) * face_gain(&r.sonar, wide_m[b], aside);
            bool hears = aside <= 1.5 * width_rad[b] && lin[b] / axis_lin[b] >= 0.03;
            lin[b] = hears ? lin[b] : 0.0;
            best = fmax(best, lin[b] / axis_lin[b]);
            count += hears;
        }
        assert_int_equal(h->hearing_count, count);
        for (size_t i = 0; i < count; i++) {
            size_t b = heard[i].beam;
            assert_true(b < 5 && lin[b] > 0.0);
            assert_close(heard[i].gain_lin, lin[b] / axis_lin[heard[0].beam], 1e-6);
            assert_close(heard[i].weight, weight[b], 1e-6);
            lin[b] = i == 0 ? lin[b] : 0.0; /* each once */
        }
        if (count > 0) {
            size_t first = heard[0].beam;
            assert_close(lin[first] / axis_lin[first], best, 1e-9);
        }
        several += count > 1;
    }
    assert_true(several > 10);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

static double within(double rad, double most_rad) {
    return fmin(fmax(rad, -most_rad), most_rad);
}

/* Headings have the elevation, height and width of the beam of their arc that is nearest, up to 7 dB down and no
 * steeper than 1.5 rad. */
static void headings_have_their_beams_shape(void **state) {
    (void)state;
    static const double pitch_rad[] = {0.2, 0.9, -0.4}, yaw_rad[] = {0.0, 0.3, -0.2},
                        tall_m[] = {0.1, 0.012, 0.08}, wide_m[] = {0.1, 0.06, 0.15};
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 3);
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 1e-4;
    for (size_t b = 0; b < 3; b++) {
        r.beams[b].pitch_rad = pitch_rad[b];
        r.beams[b].yaw_rad = yaw_rad[b];
        r.beams[b].length_v_m = tall_m[b];
        r.beams[b].length_h_m = wide_m[b];
    }
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    assert_int_equal(seen.arcs, 3);
    static const size_t beam_of_arc[] = {2, 1, 0}; /* by elevation in their own heights */
    size_t shaped[3] = {0};
    for (size_t i = 0; i < seen.arcs * seen.azimuths; i++) {
        const asdic_heading *h = &seen.headings[i];
        size_t b = beam_of_arc[i / seen.azimuths];
        double at =
            remainder((double)(i % seen.azimuths) * seen.step_rad - yaw_rad[b], 2.0 * acos(-1.0));
        double height_rad = asdic_beam_height_rad(&r.sonar, b, SPEED);
        double width_rad = asdic_beam_width_rad(&r.sonar, b, SPEED);
        bool is_near = fabs(at) <= 1.5 * width_rad;
        shaped[b] += is_near;
        assert_close(h->elevation_rad, is_near ? pitch_rad[b] : 0.0, 1e-6);
        assert_close(h->half_height_rad, is_near ? 0.5 * height_rad : 0.0, 1e-9);
        assert_close(h->width_rad, is_near ? width_rad : 0.0, 1e-9);
        if (is_near) {
            assert_close(h->slope, tan(pitch_rad[b]), 1e-6);
            assert_close_relative(h->slope_low, tan(within(pitch_rad[b] - 0.75 * height_rad, 1.5)),
                                  1e-6);
            assert_close_relative(h->slope_high, tan(within(pitch_rad[b] + 0.75 * height_rad, 1.5)),
                                  1e-6);
        }
    }
    assert_true(shaped[0] > 4 && shaped[1] > 4 && shaped[2] > 4);
    assert_true(pitch_rad[1] + 0.75 * asdic_beam_height_rad(&r.sonar, 1, SPEED) > 1.5);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* A beam that looks 80 degrees down, 56 degrees tall, is asked up to 80 - 0.75 x 56 = 38 degrees down, and no heading is
 * heard farther aside or flatter; one that looks straight down is not asked. */
static void beams_are_asked_within_their_range(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 2);
    r.sonar.transmitter.pitch_rad = r.beams[0].pitch_rad = 80.0 * DEGREE;
    r.beams[1].pitch_rad = 90.0 * DEGREE;
    double height_m = 0.443 * SPEED / 100e3 / sin(28.0 * DEGREE) / sqrt(2.0);
    r.sonar.transmitter.length_v_m = r.beams[0].length_v_m = height_m;
    asdic_vec3 axis = asdic_beam_axis(&r.beams[0], &r.pose);
    asdic_hearing_range range = asdic_evidence_range(&r.sonar, 0, axis, SPEED);
    assert_close(range.plane_share, cos(38.0 * DEGREE), 1e-6);
    /* Headings are a quarter of a width apart: those within 1.5 widths reach half as far beyond. */
    assert_close(range.aside_rad, 1.625 * asdic_beam_width_rad(&r.sonar, 0, SPEED), 1e-12);
    axis = asdic_beam_axis(&r.beams[1], &r.pose);
    assert_close(asdic_evidence_range(&r.sonar, 1, axis, SPEED).plane_share, 0.0, 0.0);
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    size_t heard = 0;
    for (size_t i = 0; i < seen.arcs * seen.azimuths; i++) {
        const asdic_heading *h = &seen.headings[i];
        double at = remainder((double)(i % seen.azimuths) * seen.step_rad, 2.0 * acos(-1.0));
        if (h->hearing_count > 0) {
            assert_true(fabs(at) + 0.5 * seen.step_rad <= range.aside_rad + 1e-9);
            assert_true(cos(atan(h->slope_low)) <= range.plane_share + 1e-9);
            heard++;
        }
    }
    assert_true(heard > 4);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* A transmitter of two wavelengths sends nothing 30 degrees aside, where a receiver looks: it is not the one by
 * which directions beside its axis are heard best. */
static void a_beam_in_a_null_is_no_better_than_others(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 2);
    r.sonar.transmitter.length_h_m = 2.0 * SPEED / r.sonar.frequency_hz;
    r.beams[0].yaw_rad = 22.0 * DEGREE;
    r.beams[1].yaw_rad = 30.0 * DEGREE;
    r.beams[0].length_h_m = r.beams[1].length_h_m = 5.0 * SPEED / r.sonar.frequency_hz;
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    size_t heard = 0;
    for (size_t k = 0; k < seen.azimuths; k++) {
        const asdic_heading *h = &seen.headings[k];
        double at = remainder((double)k * seen.step_rad, 2.0 * acos(-1.0));
        for (size_t i = 0; i < h->hearing_count; i++) {
            assert_true(seen.hearings[h->hearing + i].gain_lin < 20.0);
        }
        if (h->hearing_count > 0 && at < 22.5 * DEGREE) {
            assert_int_equal(seen.hearings[h->hearing].beam, 0);
            heard++;
        }
    }
    assert_true(heard > 2);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* Straight ahead of one beam: of the detector's strength, 10 dB over a background of 1, and of the loudest, what is there
 * less the background, which is as much rarer as it is louder, the mean. */
static void strengths_are_averaged(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 1);
    r.intensity[50] = 25.0;
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    double faint = 25.0 * 10.0 / 11.0 - log(11.0), loud = 25.0 * 24.0 / 25.0 - log(25.0);
    assert_close(log(seen.ratio[50]), log(0.5 * (exp(faint) + exp(loud) * 10.0 / 24.0)), 1e-6);
    assert_close(log(seen.ratio[49]), 0.3 * 10.0 / 11.0 - log(11.0), 1e-6);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* Where nothing is known of a beam's background nothing is said of what it alone hears, there alone. */
static void an_unknown_background_says_nothing(void **state) {
    (void)state;
    map_rig r;
    asdic_evidence seen = {0};
    map_begin(&r, 2);
    r.beams[1].yaw_rad = 40.0 * DEGREE;
    r.background[30] = NAN;
    r.background[31] = 0.0;
    r.background[MAP_BINS + 50] = NAN;
    const asdic_look look = look_of(&r);
    assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
    size_t heard[2] = {0};
    for (size_t k = 0; k < seen.azimuths; k++) {
        const asdic_heading *h = &seen.headings[k];
        if (h->hearing_count == 1) {
            size_t beam = seen.hearings[h->hearing].beam;
            const double *ratio = seen.ratio + k * MAP_BINS;
            for (size_t n = 0; n < MAP_BINS; n++) {
                assert_true(!isnan(ratio[n]) == (r.background[beam * MAP_BINS + n] > 0.0));
            }
            heard[beam]++;
        }
    }
    assert_true(heard[0] > 2 && heard[1] > 2);
    asdic_evidence_finish(&seen);
    asdic_occupancy_destroy(&r.map);
}

/* K speckle of a shape so large that it is all but Rayleigh's says what that says, by its tables of strengths; of a
 * small one, in which high values are common without an object, an echo says less. */
static void k_speckle_is_weighed_by_its_shape(void **state) {
    (void)state;
    map_rig r;
    static const double shapes[] = {0.0, 999.0, 1.5,
                                    1000.0}; /* the last is the greatest there is */
    double on_axis[4], loud[4], worst = 0.0;
    asdic_evidence rayleigh = {0};
    map_begin(&r, 2);
    r.beams[1].yaw_rad = 9.0 * DEGREE;
    r.intensity[40] = 1e4; /* cut at the greatest that a ratio can be */
    r.intensity[50] = 25.0;
    r.intensity[MAP_BINS + 60] = 8.0;
    for (int k = 0; k < 4; k++) {
        asdic_evidence seen = {0};
        r.sonar.speckle = k == 0 ? ASDIC_SPECKLE_RAYLEIGH : ASDIC_SPECKLE_K;
        r.sonar.speckle_shape = k == 0 ? 1.5 : shapes[k];
        const asdic_look look = look_of(&r);
        assert_ok(ctx, asdic_evidence_create(ctx, &look, NULL, &seen));
        on_axis[k] = seen.ratio[50]; /* straight ahead */
        loud[k] = seen.ratio[40];
        for (size_t i = 0; k == 1 && i < seen.arcs * seen.azimuths * MAP_BINS; i++) {
            if (seen.headings[i / MAP_BINS].hearing_count > 0 && i % MAP_BINS > 0) {
                double a = log(rayleigh.ratio[i]), b = log(seen.ratio[i]);
                worst = fmax(worst, fabs(a - b) / (1.0 + fabs(a)));
            }
        }
        if (k == 0) {
            rayleigh = seen;
        } else {
            asdic_evidence_finish(&seen);
        }
    }
    assert_true(worst < 0.05);
    assert_close(log(on_axis[3]), log(on_axis[1]), 2e-4 * fabs(log(on_axis[1])));
    assert_close(log(loud[3]), log(loud[1]), 2e-4 * fabs(log(loud[1])));
    assert_true(on_axis[0] > 10.0 && on_axis[2] > 2.0 && on_axis[2] < 0.6 * on_axis[1]);
    asdic_evidence_finish(&rayleigh);
    asdic_occupancy_destroy(&r.map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(headings_know_who_hears_them),
        cmocka_unit_test(headings_have_their_beams_shape),
        cmocka_unit_test(beams_are_asked_within_their_range),
        cmocka_unit_test(a_beam_in_a_null_is_no_better_than_others),
        cmocka_unit_test(strengths_are_averaged),
        cmocka_unit_test(an_unknown_background_says_nothing),
        cmocka_unit_test(k_speckle_is_weighed_by_its_shape),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
