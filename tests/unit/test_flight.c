/*
 * The vehicle that flies waypoints, held to what its kinematics promise.
 */
#include "asserts.h"

#include "base/context.h"
#include "base/vec.h"
#include "mission/track/flight.h"
#include "mission/track/track.h"

static asdic_flight nomoto(const double *points_m, size_t count, double speed_mps,
                           double turn_radius_m, double response_s, double dive_rate_mps) {
    return (asdic_flight){.points_m = points_m,
                          .count = count,
                          .vehicle = ASDIC_VEHICLE_NOMOTO,
                          .speed_mps = speed_mps,
                          .turn_radius_m = turn_radius_m,
                          .response_s = response_s,
                          .dive_rate_mps = dive_rate_mps,
                          .altitude_m = NAN};
}

static asdic_flight remus100(const double *points_m, size_t count, double speed_mps) {
    return (asdic_flight){.points_m = points_m,
                          .count = count,
                          .vehicle = ASDIC_VEHICLE_REMUS100,
                          .speed_mps = speed_mps,
                          .altitude_m = NAN};
}

static void set_current(asdic_flight *flight, double speed_mps, double towards_rad) {
    flight->current_mps[0] = speed_mps * cos(towards_rad);
    flight->current_mps[1] = speed_mps * sin(towards_rad);
}

static asdic_flight_miss missed; /* by the last flight */

static asdic_track *fly(asdic_flight flight) {
    asdic_context *ctx = NULL;
    asdic_track *track = NULL;
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    asdic_status status = asdic_flight_fly(ctx, &flight, &track, &missed);
    if (status != ASDIC_OK) {
        print_error("%s\n", asdic_context_error(ctx));
    }
    assert_int_equal(status, ASDIC_OK);
    asdic_context_destroy(&ctx);
    return track;
}

/* What holds everywhere: constant speed along the body's axis, turns no tighter and dives no
 * faster than allowed, steps of even time. */
static void check_kinematics(const asdic_flight *f, const asdic_track *track) {
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        double step_s = b->time_s - a->time_s;
        double dx = b->x_m - a->x_m, dy = b->y_m - a->y_m, dz = b->z_m - a->z_m;
        assert_close_relative(sqrt(dx * dx + dy * dy + dz * dz) / step_s, f->speed_mps, 1e-3);
        assert_true(fabs(dz) / step_s <= f->dive_rate_mps * (1 + 1e-9));
        double forward_mps = hypot(dx, dy) / step_s;
        double flip =
            step_s / f->response_s; /* of the rudder, within a step that takes the mean of two */
        assert_true(fabs(b->yaw_rad - a->yaw_rad) / step_s <=
                    f->speed_mps / f->turn_radius_m * (1 + 1e-9 + flip * flip));
        double yaw = 0.5 * (a->yaw_rad + b->yaw_rad), pitch = 0.5 * (a->pitch_rad + b->pitch_rad);
        assert_close(dx / step_s, forward_mps * cos(yaw), 2e-3 * f->speed_mps);
        assert_close(dy / step_s, forward_mps * sin(yaw), 2e-3 * f->speed_mps);
        assert_close(dz / step_s, -f->speed_mps * sin(pitch), 2e-3 * f->speed_mps);
        assert_close(b->roll_rad, 0, 0);
    }
}

static double nearest_m(const asdic_track *track, const double *point_m) {
    double best_m = INFINITY;
    for (size_t i = 0; i < track->count; i++) {
        const track_point *p = &track->points[i];
        best_m = fmin(best_m, hypot(p->x_m - point_m[0], p->y_m - point_m[1]));
    }
    return best_m;
}

static void straight_line_takes_length_over_speed(void **state) {
    (void)state;
    const double points_m[] = {10, 20, 5, 40, 60, 5}; /* 50 m */
    const asdic_flight flight = nomoto(points_m, 2, 2.0, 5.0, 1.0, 0.3);
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    assert_close(asdic_track_end_s(track), 25.0, 0.11);
    asdic_pose pose = asdic_track_pose(track, 12.5);
    assert_close(pose.position_m.x, 25, 1e-9);
    assert_close(pose.position_m.y, 40, 1e-9);
    assert_close(pose.position_m.z, 5, 0);
    assert_close(pose.yaw_rad, atan2(4, 3), 1e-12);
    asdic_track_destroy(&track);
}

static void box_is_flown_close_to_its_corners(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 5, 100, 60, 5, 0, 60, 5, 0, 0, 5};
    const asdic_flight flight = nomoto(points_m, 5, 1.5, 5.0, 0.5, 0.3);
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    for (size_t i = 0; i < 5; i++) {
        assert_true(nearest_m(track, points_m + 3 * i) < 0.6 * flight.turn_radius_m);
    }
    /* Half-way along each side the vehicle is on it. */
    const double middles_m[] = {50, 0, 100, 30, 50, 60, 0, 30};
    for (size_t i = 0; i < 4; i++) {
        assert_true(nearest_m(track, middles_m + 2 * i) < 0.5);
    }
    assert_close_relative(asdic_track_end_s(track), 320 / 1.5, 0.1);
    asdic_track_destroy(&track);
}

static double deep_m(const void *user, double north_m, double east_m) {
    (void)user;
    (void)east_m;
    return north_m < 100 ? 20 : 40;
}

/* What the dive rate leaves of a way; what a corner takes at speed; the worst of several; a step of the bottom. */
static void what_is_not_reached_is_told(void **state) {
    (void)state;
    const double steep_m[] = {0, 0, 5, 20, 0, 20},
                 square_m[] = {0, 0, 5, 50, 0, 5, 50, 50, 5, 0, 50, 5, 0, 0, 5};
    const double several_m[] = {0, 0, 5, 40, 0, 5, 60, 0, 12, 80, 0, 0, 200, 0, 0};
    asdic_track *track = fly(nomoto(steep_m, 2, 1.5, 5.0, 1.0, 0.3));
    double along_s =
        20 / sqrt(1.5 * 1.5 - 0.3 * 0.3); /* at the full rate, which takes a while to come */
    assert_int_equal(missed.point, 1);
    assert_close(missed.aside_m, 0, 0.2);
    assert_true(missed.deeper_m < -(15 - 0.3 * along_s) &&
                missed.deeper_m > -(15 - 0.3 * along_s) - 2 * 0.3);
    asdic_track_destroy(&track);
    track = fly(nomoto(square_m, 5, 4.0, 6.0, 3.0, 0.3)); /* the lag is two radii long */
    const track_point *last = &track->points[track->count - 1];
    assert_int_equal(missed.point, 4);
    assert_close(missed.aside_m, hypot(last->x_m, last->y_m), 0.2);
    assert_close(missed.deeper_m, 0, 1e-6);
    asdic_track_destroy(&track);
    track = fly(nomoto(square_m, 5, 1.5, 5.0, 0.5, 0.3));
    assert_int_equal(missed.point, 0);
    asdic_track_destroy(&track);
    track = fly(nomoto(several_m, 5, 1.5, 5.0, 1.0, 0.3));
    assert_int_equal(missed.point, 3); /* 5 m to 9 m of 12, then to 5 m of 0 */
    assert_true(missed.deeper_m > 4 && missed.deeper_m < 6);
    asdic_track_destroy(&track);
    asdic_flight above = nomoto(steep_m, 2, 1.5, 5.0, 1.0, 0.3);
    const double step_m[] = {0, 0, 5, 110, 0, 5};
    above.points_m = step_m;
    above.altitude_m = 5;
    above.bottom_m = deep_m;
    track = fly(above);
    assert_int_equal(missed.point, 1); /* 15 m, then 35 m deep */
    assert_true(missed.deeper_m < -17 && missed.deeper_m > -18.5);
    asdic_track_destroy(&track);
}

static void depth_is_reached_without_overshoot(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 15, 200, 0, 2};
    const asdic_flight flight = nomoto(points_m, 3, 1.5, 5.0, 1.0, 0.3);
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    double deepest_m = 0, fastest_mps = 0;
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        deepest_m = fmax(deepest_m, b->z_m);
        fastest_mps = fmax(fastest_mps, (b->z_m - a->z_m) / (b->time_s - a->time_s));
        assert_true(b->z_m <= 15.001 && b->z_m >= 1.999);
    }
    assert_close(deepest_m, 15, 0.01);
    assert_close_relative(fastest_mps, 0.3, 1e-3);
    assert_close(track->points[track->count - 1].z_m, 2, 0.01);
    asdic_track_destroy(&track);
}

/* Pings that come amid a turn of 120 degrees lie on its circle, at any speed, rate and response. */
static void steady_turns_have_the_radius(void **state) {
    (void)state;
    static const double cases[][3] = {/* speed, radius, response */
                                      {0.5, 5, 1}, {1, 5, 1},  {1.5, 5, 1}, {1.5, 10, 2},
                                      {2, 5, 0.5}, {3, 10, 1}, {2, 15, 2},  {4, 12, 1}};
    static const double rates_hz[] = {1, 2, 5, 20};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double speed_mps = cases[i][0], radius_m = cases[i][1], corner_m = 30 * radius_m;
        double points_m[] = {0, 0, 5, corner_m, 0, 5, 0.5 * corner_m, sqrt(0.75) * corner_m, 5};
        const asdic_flight flight = nomoto(points_m, 3, speed_mps, radius_m, cases[i][2], 0.3);
        asdic_track *track = fly(flight);
        check_kinematics(&flight, track);
        double least_m = INFINITY, most_m = 0;
        for (size_t r = 0; r < sizeof rates_hz / sizeof *rates_hz; r++) {
            double step_s = 1.0 / rates_hz[r];
            for (double t = step_s; t < asdic_track_end_s(track); t += step_s) {
                asdic_pose a = asdic_track_pose(track, t - step_s), b = asdic_track_pose(track, t);
                double chord_m =
                    hypot(b.position_m.x - a.position_m.x, b.position_m.y - a.position_m.y);
                if (a.yaw_rad > 0.45 * 2.0 / 3.0 * ASDIC_PI &&
                    b.yaw_rad < 0.7 * 2.0 / 3.0 * ASDIC_PI) {
                    double flown_m = chord_m / (2.0 * sin(0.5 * (b.yaw_rad - a.yaw_rad)));
                    least_m = fmin(least_m, flown_m);
                    most_m = fmax(most_m, flown_m);
                }
            }
        }
        print_message("%g m/s, %g m, %g s: turns of %.2f to %.2f m\n", speed_mps, radius_m,
                      cases[i][2], least_m, most_m);
        assert_close_relative(least_m, radius_m, 0.05);
        assert_close_relative(most_m, radius_m, 0.05);
        asdic_track_destroy(&track);
    }
}

/* A square corner is cut by the arc that touches both lines, and not swung out of. */
static void corners_are_cut_by_the_arc(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 5, 100, 100, 5};
    for (double speed_mps = 0.5; speed_mps < 2.1; speed_mps += 0.5) {
        asdic_track *track = fly(nomoto(points_m, 3, speed_mps, 5.0, 1.0, 0.3));
        double most_m = 0;
        for (size_t i = 0; i < track->count; i++) {
            most_m = fmax(most_m, track->points[i].x_m);
        }
        double aside_m = nearest_m(track, points_m + 3) - (sqrt(2) - 1) * 5.0;
        print_message("%g m/s: %.2f m aside of the arc, %.2f m beyond\n", speed_mps, aside_m,
                      most_m - 100);
        assert_true(aside_m > -0.3 && aside_m < 0.3 + 0.25 * speed_mps); /* what lags is rounder */
        assert_close(most_m, 100, 0.15);
        asdic_track_destroy(&track);
    }
}

/* Across the line from corner I on, away from where the turn comes from, at most; *SETTLED: along it, from where the vehicle
 * stays within a tenth of a radius. */
static double swings_out_m(const asdic_track *track, double corner_m, double turn_rad,
                           double radius_m, double *settled_m) {
    double most_m = 0, north = cos(turn_rad), east = sin(turn_rad);
    size_t i = 0;
    *settled_m = -INFINITY;
    while (track->points[i].yaw_rad < 0.9 * turn_rad) {
        i++;
    }
    for (; i < track->count; i++) {
        double x = track->points[i].x_m - corner_m, y = track->points[i].y_m;
        double across_m = y * north - x * east;
        most_m = fmax(most_m, -across_m);
        if (fabs(across_m) > 0.1 * radius_m) {
            *settled_m = x * north + y * east;
        }
    }
    return most_m;
}

/* Turns up to 120 degrees end on the next line, those back abeam of the corner, and the line is held soon, whatever lags. */
static void turns_end_on_the_next_line(void **state) {
    (void)state;
    static const double cases[][3] = {/* speed, radius, response; 0: REMUS 100 */
                                      {0.5, 0.5, 1}, {1.5, 0.5, 0.5}, {1.5, 0.5, 1},  {1.5, 5, 0.5},
                                      {1.5, 5, 1},   {1, 2, 2},       {2, 20, 0.1},   {4, 6, 3},
                                      {1, 4.41, 0},  {1.54, 4.41, 0}, {2.5, 4.41, 0}, {15, 50, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double speed_mps = cases[i][0], radius_m = cases[i][1], response_s = cases[i][2];
        bool is_remus = response_s == 0;
        double lag_m = speed_mps * (is_remus ? 1.36 : 1.25 * response_s);
        double free_m = 40 * (radius_m + lag_m);
        for (int k = 1; k <= 6; k++) {
            double turn_rad = k * ASDIC_PI / 6, settled_m;
            double points_m[] = {0, 0, 5, free_m, 0, 5, 0, 0, 5};
            points_m[6] = free_m * (1 + cos(turn_rad));
            points_m[7] = free_m * sin(turn_rad);
            asdic_track *track =
                fly(is_remus ? remus100(points_m, 3, speed_mps)
                             : nomoto(points_m, 3, speed_mps, radius_m, response_s, 0.3));
            double out_m = swings_out_m(track, free_m, turn_rad, radius_m, &settled_m);
            double aside_m = nearest_m(track, points_m + 3);
            print_message(
                "%g m/s, %g m, %g s, %d degrees: out %.2f, on it from %.1f, aside %.2f radii\n",
                speed_mps, radius_m, response_s, 30 * k, out_m / radius_m, settled_m / radius_m,
                aside_m / radius_m);
            assert_int_equal(missed.point, 0);
            if (k <= 4) {
                assert_true(out_m < 0.3 * (lag_m < 1.3 * radius_m ? radius_m : radius_m + lag_m));
            }
            if (k == 6) {
                assert_true(aside_m < radius_m);
            }
            assert_true(settled_m < 11 * (radius_m + lag_m));
            asdic_track_destroy(&track);
        }
    }
}

/* With a quick response the tightest turn is a circle of the given radius. */
static void tightest_turn_has_the_radius(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 200, 0, 5, 0, 1, 5};
    const asdic_flight flight = nomoto(points_m, 3, 2.0, 20.0, 0.1, 0.3);
    asdic_track *track = fly(flight);
    check_kinematics(&flight, track);
    double fastest = 0;
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        fastest = fmax(fastest, fabs(b->yaw_rad - a->yaw_rad) / (b->time_s - a->time_s));
    }
    assert_close_relative(flight.speed_mps / fastest, flight.turn_radius_m, 1e-3);
    asdic_track_destroy(&track);
}

/* The autopilots' gains: of the heading that a coast leaves, four in a response time; rudder and planes against rates, at
 * the fins' own time constant, up to 13.6 degrees. */
static void autopilots_answer_by_their_gains(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5};
    asdic_flight slow = nomoto(points_m, 2, 1.5, 5.0, 2.0, 0.5), fins = remus100(points_m, 2, 1.5);
    flight_state at = {.z_m = 5};
    flight_aim aim = {.yaw_rad = 0.01, .z_m = 5};
    assert_close(asdic_flight_model_nomoto(&slow).derivative(&slow, &aim, &at).yaw_rate,
                 4.0 * 0.01 / 2.0 / 2.0, 1e-15);
    at.yaw_rate = 0.003; /* coasts 0.006 */
    assert_close(asdic_flight_model_nomoto(&slow).derivative(&slow, &aim, &at).yaw_rate,
                 (4.0 * 0.004 / 2.0 - 0.003) / 2.0, 1e-15);
    at.yaw_rate = 0.0;
    flight_model model = asdic_flight_model_remus100();
    aim.yaw_rad = 0.0;
    at = (flight_state){.z_m = 5, .surge_mps = 1.5, .pitch_rate = 0.02};
    assert_close(model.derivative(&fins, &aim, &at).plane_rad, 1.5 * 0.02 / 0.1, 1e-12);
    at = (flight_state){.z_m = 5, .surge_mps = 1.5, .yaw_rate = 0.02};
    assert_close(model.derivative(&fins, &aim, &at).rudder_rad, 2.5 * 0.02 / 0.1, 1e-12);
    at = (flight_state){.z_m = 5, .surge_mps = 1.5};
    aim.yaw_rad = 3.0;
    assert_close(model.derivative(&fins, &aim, &at).rudder_rad, -13.6 * ASDIC_PI / 180.0 / 0.1,
                 1e-12);
    /* A fifth of a radian a metre of depth, half a radian at most; planes by what of it is missing. */
    at.yaw_rad = aim.yaw_rad = 3.1;
    aim.z_m = 5.1;
    at.pitch_rad = 0.01;
    assert_close(model.derivative(&fins, &aim, &at).plane_rad, 1.5 * (0.01 + 0.2 * 0.1) / 0.1,
                 1e-12);
    aim.z_m = 99.0;
    at.pitch_rad = -0.45;
    assert_close(model.derivative(&fins, &aim, &at).plane_rad, 1.5 * (0.5 - 0.45) / 0.1, 1e-12);
    /* The nearer way round, across south. */
    at = (flight_state){.z_m = 5, .surge_mps = 1.5, .yaw_rad = -3.1};
    assert_close(model.derivative(&fins, &aim, &at).rudder_rad, 1.5 * (2.0 * ASDIC_PI - 6.2) / 0.1,
                 1e-12);
}

/* By hand: a share of full rudder and of the rate in its circle, a share of the steepest dive; or the depth held. */
static void fins_answer_a_hand(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5};
    asdic_flight fins = remus100(points_m, 2, 1.5);
    flight_model model = asdic_flight_model_remus100();
    const flight_state at = {
        .z_m = 5, .surge_mps = 1.4, .pitch_rad = -0.1, .yaw_rate = 0.07, .yaw_rad = 1.0};
    flight_aim aim = {.z_m = 5.3, .by_hand = true, .rudder = 0.25, .planes = 0.3};
    flight_state d = model.derivative(&fins, &aim, &at);
    assert_close(d.rudder_rad,
                 (2.5 * (0.07 - 0.25 * 1.4 / 4.41) - 0.25 * 13.6 * ASDIC_PI / 180.0) / 0.1, 1e-12);
    assert_close(d.plane_rad, 1.5 * (0.3 * 0.5 - 0.1) / 0.1, 1e-12);
    aim.holds_depth = true;
    assert_close(model.derivative(&fins, &aim, &at).plane_rad, 1.5 * (0.2 * 0.3 - 0.1) / 0.1,
                 1e-12);
}

/* Full rudder: surge, sway and yaw rate at which forces and moments balance, found by integrating
 * the published equations by a program of its own; the circle is the same at any speed. */
static void remus_balances_in_its_circle(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5};
    const double fin_rad = 13.6 * ASDIC_PI / 180.0;
    flight_model model = asdic_flight_model_remus100();
    for (double speed_mps = 1.0; speed_mps < 2.6; speed_mps += 0.5) {
        asdic_flight flight = remus100(points_m, 2, speed_mps);
        for (int side = -1; side <= 1; side += 2) {
            flight_state s = {.z_m = 5,
                              .surge_mps = 0.62273705 * speed_mps,
                              .sway_mps = -0.10080344 * side * speed_mps,
                              .yaw_rate = 0.14316667 * side * speed_mps,
                              .rudder_rad = -fin_rad * side};
            flight_aim aim = {.yaw_rad = 3.0 * side, .z_m = 5};
            flight_state d = model.derivative(&flight, &aim, &s);
            assert_close(d.surge_mps, 0, 2e-6);
            assert_close(d.sway_mps, 0, 2e-6);
            assert_close(d.yaw_rate, 0, 2e-6);
            assert_close(d.rudder_rad, 0, 1e-9);
            assert_close_relative(hypot(s.surge_mps, s.sway_mps) / fabs(s.yaw_rate),
                                  model.turn_radius_m, 2e-3);
        }
        flight_state s = {.z_m = 5, .surge_mps = speed_mps};
        flight_aim straight = {.yaw_rad = 0, .z_m = 5};
        flight_state d = model.derivative(&flight, &straight, &s);
        assert_close(d.x_m, speed_mps, 0);
        assert_close(fabs(d.surge_mps) + fabs(d.sway_mps) + fabs(d.heave_mps), 0, 1e-12);
        assert_close(fabs(d.pitch_rate) + fabs(d.yaw_rate), 0, 1e-12);
    }
}

/* Changes of surge, sway and yaw rate with a sideways drag of Y_VV, of a vehicle that wants SPEED: Prestero (2001),
 * typed from his tables again. */
static void change(double speed, double y_vv, double u, double v, double r, double rudder,
                   double out[3]) {
    const double mass = 30.48;
    double x = -1.62 * (u * u - speed * speed) + (35.5 + mass) * v * r - 1.93 * r * r;
    double y = y_vv * v * fabs(v) + 0.632 * r * fabs(r) - 28.6 * u * v + (5.22 - mass) * u * r +
               9.64 * u * u * rudder;
    double n = -3.18 * v * fabs(v) - 94.0 * r * fabs(r) - 24.0 * u * v - 2.0 * u * r -
               6.15 * u * u * rudder;
    /* (m - Y_vdot) v' - Y_rdot r' = y; -N_vdot v' + (I_zz - N_rdot) r' = n */
    double a = mass + 35.5, b = -1.93, c = -1.93, d = 3.45 + 4.88, det = a * d - b * c;
    out[0] = x / (mass + 0.93);
    out[1] = (d * y - b * n) / det;
    out[2] = (a * n - c * y) / det;
}

/* In a wide turn the course of the REMUS 100 follows a heading that is wanted by so much: sway and yaw from the published
 * equations, small, with what the autopilot asks of the rudder. */
static void remus_lags_by_rudder_and_drift(void **state) {
    (void)state;
    const double u = 1.54, rate = 1e-3;
    double v = 0, rudder = 0, by[3];
    for (int i = 0; i < 50; i++) { /* Newton's, from two slopes */
        const double step = 1e-6;
        double dv[3], dr[3];
        change(u, 0, u, v, rate, rudder, by);
        change(u, 0, u, v + step, rate, rudder, dv);
        change(u, 0, u, v, rate, rudder + step, dr);
        double a = (dv[1] - by[1]) / step, b = (dr[1] - by[1]) / step;
        double c = (dv[2] - by[2]) / step, d = (dr[2] - by[2]) / step, det = a * d - b * c;
        v -= (d * by[1] - b * by[2]) / det;
        rudder -= (a * by[2] - c * by[1]) / det;
    }
    /* rudder = 2.5 rate - 1.5 error */
    double lag_s = (2.5 * rate - rudder) / 1.5 / rate - v / u / rate;
    assert_close(asdic_flight_model_remus100().lag_s, lag_s, 0.005);
}

/* Radius of the full-rudder circle: integrated until all is steady. */
static double circle_m(double y_vv) {
    const double rudder = -13.6 * ASDIC_PI / 180.0, speed = 1.54, step = 0.01;
    double u = speed, v = 0, r = 0, by[3];
    for (int i = 0; i < 10000; i++) {
        change(speed, y_vv, u, v, r, rudder, by);
        u += step * by[0];
        v += step * by[1];
        r += step * by[2];
    }
    return hypot(u, v) / fabs(r);
}

/* On the way into a turn, where added masses count. */
static void remus_turns_as_published(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5};
    static const double states[][4] = {
        {1.5, 0, 0, 0.1}, {1.5, 0.05, 0, 0}, {1.4, -0.08, 0.12, -0.2}, {1.1, 0.1, -0.2, 0.05}};
    const asdic_flight flight = remus100(points_m, 2, 1.5);
    const flight_aim aim = {.z_m = 5};
    flight_model model = asdic_flight_model_remus100();
    for (size_t i = 0; i < sizeof states / sizeof *states; i++) {
        const double *at = states[i];
        double right[3];
        change(1.5, -131.0, at[0], at[1], at[2], at[3], right);
        const flight_state aside = {.z_m = 5,
                                    .surge_mps = at[0],
                                    .sway_mps = at[1],
                                    .yaw_rate = at[2],
                                    .rudder_rad = at[3]};
        flight_state d = model.derivative(&flight, &aim, &aside);
        assert_close(d.surge_mps, right[0], 1e-12);
        assert_close(d.sway_mps, right[1], 1e-12);
        assert_close(d.yaw_rate, right[2], 1e-12);
    }
}

/* Heave and pitch, and what they take from surge: typed from the same tables again. */
static void remus_dives_as_published(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5};
    const double mass = 30.48;
    static const double states[][5] = {
        /* u, w, q, pitch, planes */
        {1.5, 0, 0, 0, 0.1}, {1.5, 0.06, 0, 0, 0},           {1.5, 0, 0.2, 0, 0},
        {1.5, 0, 0, 0.3, 0}, {1.4, -0.08, 0.12, -0.2, -0.2}, {1.1, 0.1, -0.2, 0.4, 0.05}};
    const asdic_flight flight = remus100(points_m, 2, 1.5);
    const flight_aim aim = {.z_m = 5};
    flight_model model = asdic_flight_model_remus100();
    for (size_t i = 0; i < sizeof states / sizeof *states; i++) {
        double u = states[i][0], w = states[i][1], q = states[i][2], pitch = states[i][3];
        double planes = states[i][4];
        double x = -1.62 * (u * u - 1.5 * 1.5) - (35.5 + mass) * w * q - 1.93 * q * q;
        double z = -131.0 * w * fabs(w) - 0.632 * q * fabs(q) + (mass - 5.22) * u * q -
                   28.6 * u * w - 9.64 * u * u * planes;
        double m = 3.18 * w * fabs(w) - 188.0 * q * fabs(q) - 2.0 * u * q + 24.0 * u * w -
                   6.15 * u * u * planes - 0.0196 * 299.0 * sin(pitch);
        /* (m - Z_wdot) w' - Z_qdot q' = z; -M_wdot w' + (I_yy - M_qdot) q' = m */
        double a = mass + 35.5, b = 1.93, c = 1.93, d = 3.45 + 4.88, det = a * d - b * c;
        const flight_state at = {.z_m = 5,
                                 .surge_mps = u,
                                 .heave_mps = w,
                                 .pitch_rate = q,
                                 .pitch_rad = pitch,
                                 .plane_rad = planes};
        flight_state found = model.derivative(&flight, &aim, &at);
        assert_close(found.surge_mps, x / (mass + 0.93), 1e-12);
        assert_close(found.heave_mps, (d * z - b * m) / det, 1e-12);
        assert_close(found.pitch_rate, (a * m - c * z) / det, 1e-12);
    }
}

/* Velocities and rates of the body's axes, turned by yaw and pitch into the world's, and the water's beside. */
static void remus_moves_along_its_axes(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 99, 0, 5}, yaw = 0.7, pitch = -0.3, u = 1.4, v = 0.2;
    const double w = -0.1;
    asdic_flight flight = remus100(points_m, 2, 1.5);
    set_current(&flight, 0.25, 2.0);
    const flight_aim aim = {.z_m = 5};
    const flight_state at = {.z_m = 5,
                             .surge_mps = u,
                             .sway_mps = v,
                             .heave_mps = w,
                             .yaw_rad = yaw,
                             .pitch_rad = pitch,
                             .yaw_rate = 0.11,
                             .pitch_rate = 0.07};
    flight_state d = asdic_flight_model_remus100().derivative(&flight, &aim, &at);
    /* Columns of the rotation by yaw about down, then by pitch, bow up, about starboard. */
    const double forward[] = {cos(pitch) * cos(yaw), cos(pitch) * sin(yaw), -sin(pitch)};
    const double starboard[] = {-sin(yaw), cos(yaw), 0.0};
    const double down[] = {sin(pitch) * cos(yaw), sin(pitch) * sin(yaw), cos(pitch)};
    const double found[] = {d.x_m, d.y_m, d.z_m}, water[] = {0.25 * cos(2.0), 0.25 * sin(2.0), 0.0};
    for (int i = 0; i < 3; i++) {
        assert_close(found[i], u * forward[i] + v * starboard[i] + w * down[i] + water[i], 1e-12);
    }
    assert_close(d.pitch_rad, 0.07, 0.0);
    assert_close(d.yaw_rad, 0.11 / cos(pitch), 1e-12);
}

/* The README and flight_remus.c give both radii. */
static void sideways_drag_is_a_tenth_of_what_is_printed(void **state) {
    (void)state;
    flight_model model = asdic_flight_model_remus100();
    print_message("radius %.3f m; as printed %.3f m\n", circle_m(-131.0), circle_m(-1310.0));
    assert_close(circle_m(-131.0), 4.41, 0.005);
    assert_close(circle_m(-1310.0), 6.04, 0.005);
    assert_close_relative(model.turn_radius_m, circle_m(-131.0), 2e-3);
}

static void remus_flies_a_box(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 100, 0, 5, 100, 60, 8, 0, 60, 8, 0, 0, 5};
    const asdic_flight flight = remus100(points_m, 5, 1.54);
    asdic_track *track = fly(flight);
    for (size_t i = 0; i < 5; i++) {
        assert_true(nearest_m(track, points_m + 3 * i) < 4.5);
    }
    const double middles_m[] = {50, 0, 100, 30, 50, 60, 0, 30};
    for (size_t i = 0; i < 4; i++) {
        assert_true(nearest_m(track, middles_m + 2 * i) < 1.0);
    }
    double slowest_mps = 9, fastest_mps = 0, steepest_rad = 0;
    for (size_t i = 1; i < track->count; i++) {
        const track_point *a = &track->points[i - 1], *b = &track->points[i];
        double mps = hypot(hypot(b->x_m - a->x_m, b->y_m - a->y_m), b->z_m - a->z_m) / 0.1;
        slowest_mps = fmin(slowest_mps, mps);
        fastest_mps = fmax(fastest_mps, mps);
        steepest_rad = fmax(steepest_rad, fabs(b->pitch_rad));
        assert_true(b->z_m > 4.8 && b->z_m < 8.2);
    }
    assert_true(slowest_mps < 1.2 && slowest_mps > 0.62 * 1.54); /* turns cost speed */
    assert_close(fastest_mps, 1.54, 0.02);
    assert_true(steepest_rad > 0.2 && steepest_rad < 0.55);
    assert_close(track->points[track->count / 4].z_m, 5, 0.01);
    assert_close(track->points[track->count - 1].z_m, 5, 0.1);
    asdic_track_destroy(&track);
}

/* In a current across, the vehicle points into it and stays on the line; along, it is carried. */
static void current_is_met_by_a_crab_angle(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 300, 0, 5};
    for (int k = 0; k < 2; k++) {
        asdic_flight flight = k ? remus100(points_m, 2, 1.5) : nomoto(points_m, 2, 1.5, 5, 1, 0.3);
        flight.current_mps[1] = 0.6;
        asdic_track *track = fly(flight);
        double over_ground_mps = sqrt(1.5 * 1.5 - 0.6 * 0.6);
        assert_close_relative(asdic_track_end_s(track), 300 / over_ground_mps, 0.01);
        for (size_t i = 0; i < track->count; i++) {
            assert_close(track->points[i].y_m, 0, 0.05);
            assert_close(track->points[i].yaw_rad, -asin(0.6 / 1.5), 0.01);
        }
        asdic_track_destroy(&track);
        flight.current_mps[0] = -0.7;
        flight.current_mps[1] = 0;
        track = fly(flight);
        assert_close_relative(asdic_track_end_s(track), 300 / 0.8, 1e-3);
        asdic_track_destroy(&track);
    }
}

/* A vehicle of 4 m/s in 5 knots from all sides, in nearly what it cannot hold, and, on one line alone,
 * carried faster than it goes itself. Lines are left at a turn only. */
static void strong_currents_are_flown_in(void **state) {
    (void)state;
    static const double points_m[] = {0, 0, 5, 400, 0, 5, 400, 400, 5};
    static const struct {
        double current_mps[2];
        size_t points;
    } cases[] = {{{0, 2.57}, 3},    {{0, -2.57}, 3},  {{2.57, 0}, 3}, {{-2.57, 0}, 3},
                 {{-2.7, -2.7}, 3}, {{3.8, -0.5}, 3}, {{6, -3.6}, 2}};
    for (size_t i = 0; i < 2 * sizeof cases / sizeof *cases; i++) {
        const double *current_mps = cases[i / 2].current_mps;
        size_t points = cases[i / 2].points;
        asdic_flight flight = nomoto(points_m, points, 4, 6, 1, 0.3);
        flight.current_mps[0] = current_mps[0];
        flight.current_mps[1] = current_mps[1];
        if (i % 2) { /* all of half the speed */
            flight = remus100(points_m, points, 2);
            flight.current_mps[0] = 0.5 * current_mps[0];
            flight.current_mps[1] = 0.5 * current_mps[1];
        }
        asdic_track *track = fly(flight);
        for (size_t n = 0; n < track->count; n++) {
            const track_point *p = &track->points[n];
            assert_true(fabs(p->y_m) < 1 || p->x_m > 330);
            assert_true(fabs(p->x_m - 400) < 1 || p->y_m < 200);
        }
        asdic_track_destroy(&track);
    }
}

/* Waves of 3 m, 200 m long, and a hole without a bottom. */
static double wavy_m(const void *user, double north_m, double east_m) {
    (void)user;
    (void)east_m;
    return north_m > 500 && north_m < 600 ? INFINITY : 30 + 3 * sin(2 * ASDIC_PI * north_m / 200);
}

static void altitude_is_held_over_the_bottom(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 11, 300, 0, 20, 900, 0, 20};
    for (int k = 0; k < 2; k++) {
        asdic_flight flight = k ? remus100(points_m, 3, 1.5) : nomoto(points_m, 3, 1.5, 5, 1, 0.3);
        flight.altitude_m = 6;
        flight.bottom_m = wavy_m;
        asdic_track *track = fly(flight);
        assert_close(track->points[0].z_m, 24, 0);
        double worst_m = 0, hole_m = 99;
        for (size_t i = 0; i < track->count; i++) {
            const track_point *p = &track->points[i];
            if (p->x_m < 500 || p->x_m > 640) {
                worst_m = fmax(worst_m, fabs(wavy_m(NULL, p->x_m, 0) - 6 - p->z_m));
            } else if (p->x_m < 600) {
                hole_m = fmin(hole_m, fabs(p->z_m - 20));
            }
        }
        /* The slope is 0.094: the vehicle lags by the time that its depth takes to answer. */
        assert_true(worst_m > 0.1 && worst_m < 0.8);
        assert_true(hole_m < 0.1);
        asdic_track_destroy(&track);
    }
}

static double shoal_m(const void *user, double north_m, double east_m) {
    (void)user;
    (void)east_m;
    return north_m > 100 && north_m < 200 ? 4 : 12;
}

/* Where the water is less deep than the altitude that is asked for, the vehicle is at the surface. */
static void altitude_ends_at_the_surface(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 9, 300, 0, 9};
    for (int k = 0; k < 2; k++) {
        asdic_flight flight = k ? remus100(points_m, 2, 1.5) : nomoto(points_m, 2, 1.5, 5, 1, 0.3);
        flight.altitude_m = 6;
        flight.bottom_m = shoal_m;
        asdic_track *track = fly(flight);
        double least_m = 99;
        for (size_t i = 0; i < track->count; i++) {
            const track_point *p = &track->points[i];
            least_m = fmin(least_m, p->z_m);
            if (p->x_m > 160 && p->x_m < 200) {
                assert_close(p->z_m, 0, 0.05);
            } else if (p->x_m < 100 || p->x_m > 270) {
                assert_close(p->z_m, 6, 0.05);
            }
        }
        assert_true(least_m >= 0);
        asdic_track_destroy(&track);
    }
}

/* A small generator of its own, the same everywhere. */
static double draw(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state / 4294967296.0;
}

/* Legs shorter than the turn, sharp turns, slow rudders: the flight ends all the same. */
static void any_waypoints_come_to_an_end(void **state) {
    (void)state;
    uint32_t random = 12345;
    for (int i = 0; i < 200; i++) {
        double points_m[30];
        for (size_t k = 0; k < 30; k++) {
            points_m[k] = (k % 3 == 2 ? 20 : 100) * draw(&random);
        }
        double speed_mps = 0.5 + 3 * draw(&random), radius_m = 0.5 + 30 * draw(&random);
        double response_s = 0.1 + 3 * draw(&random);
        asdic_flight flight =
            nomoto(points_m, 10, speed_mps, radius_m, response_s, 0.4 * draw(&random) + 0.01);
        asdic_track *track = fly(flight);
        check_kinematics(&flight, track);
        asdic_track_destroy(&track);
        set_current(&flight, 0.5 * speed_mps, 6.3 * draw(&random));
        track = fly(flight);
        asdic_track_destroy(&track);
        flight = remus100(points_m, 10, 1.0 + 1.5 * draw(&random));
        set_current(&flight, 0.5 * flight.speed_mps * draw(&random), 6.3 * draw(&random));
        track = fly(flight);
        asdic_track_destroy(&track);
    }
}

/* A current that is faster than the vehicle carries it away from all but where it begins. */
static void a_waypoint_out_of_reach_is_named(void **state) {
    (void)state;
    const double points_m[] = {0, 0, 5, 2000, 0, 5};
    asdic_context *ctx = NULL;
    asdic_track *track = NULL;
    asdic_flight flight = nomoto(points_m, 2, 1.5, 5.0, 1.0, 0.3);
    set_current(&flight, 2.0, ASDIC_PI);
    assert_int_equal(asdic_context_create(&ctx), ASDIC_OK);
    assert_int_equal(asdic_flight_fly(ctx, &flight, &track, &missed), ASDIC_ERROR_INPUT);
    assert_null(track);
    assert_contains(asdic_context_error(ctx), "waypoint 1 is not reached in ");
    assert_contains(asdic_context_error(ctx), " s; give a smaller turn radius");
    /* A straight way for which there are not enough steps. */
    flight = nomoto(points_m, 2, 0.05, 0.1, 0.1, 0.01);
    assert_int_equal(asdic_flight_fly(ctx, &flight, &track, &missed), ASDIC_ERROR_INPUT);
    assert_null(track);
    assert_contains(asdic_context_error(ctx), ", which is as long as a flight may be; fly faster");
    asdic_context_destroy(&ctx);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_line_takes_length_over_speed),
        cmocka_unit_test(box_is_flown_close_to_its_corners),
        cmocka_unit_test(what_is_not_reached_is_told),
        cmocka_unit_test(depth_is_reached_without_overshoot),
        cmocka_unit_test(steady_turns_have_the_radius),
        cmocka_unit_test(corners_are_cut_by_the_arc),
        cmocka_unit_test(turns_end_on_the_next_line),
        cmocka_unit_test(remus_lags_by_rudder_and_drift),
        cmocka_unit_test(tightest_turn_has_the_radius),
        cmocka_unit_test(autopilots_answer_by_their_gains),
        cmocka_unit_test(fins_answer_a_hand),
        cmocka_unit_test(remus_balances_in_its_circle),
        cmocka_unit_test(sideways_drag_is_a_tenth_of_what_is_printed),
        cmocka_unit_test(remus_turns_as_published),
        cmocka_unit_test(remus_dives_as_published),
        cmocka_unit_test(remus_moves_along_its_axes),
        cmocka_unit_test(remus_flies_a_box),
        cmocka_unit_test(current_is_met_by_a_crab_angle),
        cmocka_unit_test(strong_currents_are_flown_in),
        cmocka_unit_test(altitude_is_held_over_the_bottom),
        cmocka_unit_test(altitude_ends_at_the_surface),
        cmocka_unit_test(any_waypoints_come_to_an_end),
        cmocka_unit_test(a_waypoint_out_of_reach_is_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
