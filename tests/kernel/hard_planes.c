/* Flat scenes at their worst, against the quadrature in double. */
#include "hard_cases.h"
#include "ping_rig.h"

/* How the levels of one ping differ from the expected ones. */
typedef struct difference {
    double rms_db, most_db;
    bool finite, deaf; /* where blanked */
} difference;

#define ALL_BINS 0, SIZE_MAX

static asdic_ping *expectation(const ping_rig *r, size_t bins) {
    asdic_flat_scene flat = rig_flat(r);
    asdic_ping *ping = NULL;
    assert_ok(r->device->ctx,
              asdic_ping_create(r->device->ctx, r->sonar.receiver_count, bins, &ping));
    assert_ok(r->device->ctx,
              asdic_expected_compute(r->device->ctx, &flat, &r->env, &r->sonar, &r->pose, ping));
    return ping;
}

/* Bins [FIRST, END) of COMPONENT; bins 60 dB below the total are left out, blanked ones as well.
 * Destroys the rig. */
static difference compare(ping_rig *r, asdic_component component, size_t first, size_t end) {
    asdic_ping *ping = rig_shoot(r, 0, true), *truth = expectation(r, ping->bins);
    size_t blanked = (size_t)floor(r->sonar.blanking_m / r->sonar.bin_length_m + 1e-9);
    difference d = {0.0, 0.0, true, true};
    double count = 0.0;
    first = first > blanked ? first : blanked;
    end = end < ping->bins ? end : ping->bins;
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        double e = truth->intensity_lin[component][i], got = ping->intensity_lin[component][i];
        d.finite = d.finite && isfinite(got) && isfinite(e) && got >= 0.0;
        d.deaf = d.deaf && (i % ping->bins >= blanked || got == 0.0);
        bool counts = e > 1e-6 * truth->intensity_lin[ASDIC_TOTAL][i];
        if (counts && i % ping->bins >= first && i % ping->bins < end) {
            double off = fabs(asdic_level_db(got / e));
            d.rms_db += off * off;
            d.most_db = fmax(d.most_db, off);
            count += 1.0;
        }
    }
    d.rms_db = sqrt(d.rms_db / count);
    assert_true(d.finite && d.deaf && count > 0.0);
    asdic_ping_destroy(&ping);
    asdic_ping_destroy(&truth);
    rig_destroy(r);
    return d;
}

static ping_rig one_beam(double depth_m, double pitch_deg) {
    ping_rig r = rig_create(&hard_device);
    r.sonar.receiver_count = 1;
    r.pose.position_m.z = depth_m;
    r.receivers[0].pitch_rad = r.sonar.transmitter.pitch_rad = pitch_deg * RIG_DEGREE;
    return r;
}

double hard_bin_edges(void) {
    ping_rig r = one_beam(7.0, 0.0);
    r.sampling.rays = 1 << 18; /* of 20,000, one ping scatters by 0.05 dB right below */
    return compare(&r, ASDIC_TOTAL, 9, 16).most_db;
}

double hard_zenith(void) {
    ping_rig r = one_beam(7.0, -90.0);
    return compare(&r, ASDIC_SURFACE, 14, 15).most_db;
}

/* The printed law spikes to +30 dB here. */
double hard_near_zenith(void) {
    ping_rig r = one_beam(7.2499, -90.0);
    return compare(&r, ASDIC_SURFACE, 14, 15).most_db;
}

double hard_nadir(void) {
    ping_rig r = one_beam(6.7, 90.0);
    return compare(&r, ASDIC_BOTTOM, 10, 11).most_db;
}

double hard_nulls(void) {
    ping_rig r = rig_create(&hard_device);
    r.sonar.frequency_hz = 450e3;
    for (int b = -1; b < RIG_BEAMS; b++) {
        asdic_beam *beam = b < 0 ? &r.sonar.transmitter : &r.receivers[b];
        beam->length_h_m = 0.0331134;
        beam->length_v_m = 0.0165567;
    }
    return compare(&r, ASDIC_TOTAL, ALL_BINS).most_db;
}

double hard_below_a_metre(void) {
    ping_rig r = one_beam(11.45, 20.0);
    r.sonar.bin_length_m = 0.1;
    r.sonar.blanking_m = 0.1;
    r.sampling.rays = 1 << 20;
    return compare(&r, ASDIC_TOTAL, 1, 10).most_db;
}

/* Half of what comes back does so from 30 times nearer than the bin's middle. */
double hard_long_bin(void) {
    ping_rig r = one_beam(11.7, 90.0);
    r.sonar.bin_length_m = 20.0;
    r.sonar.blanking_m = 0.1;
    r.sampling.rays = 1 << 18;
    return compare(&r, ASDIC_BOTTOM, 0, 1).most_db;
}

double hard_on_the_bottom(void) {
    ping_rig r = one_beam(12.0, 0.0);
    return compare(&r, ASDIC_TOTAL, ALL_BINS).most_db;
}

double hard_in_the_surface(void) {
    ping_rig r = one_beam(0.0, 0.0);
    return compare(&r, ASDIC_TOTAL, ALL_BINS).most_db;
}

/* Through layers of a cast that ends on the bottom. Its first bends rays down and the next up, or, UP, the reverse. */
static double through_layers(double depth_m, bool up) {
    ping_rig r = one_beam(depth_m, 0.0);
    r.env.sound_speed_profile =
        up ? (asdic_sound_profile){4, {0.0, 4.0, 8.0, 12.0}, {1470.0, 1480.0, 1475.0, 1490.0}}
           : (asdic_sound_profile){4, {0.0, 4.0, 8.0, 12.0}, {1490.0, 1480.0, 1485.0, 1470.0}};
    r.sampling.rays = 1 << 18;
    return compare(&r, ASDIC_TOTAL, ALL_BINS).most_db;
}

double hard_on_the_bottom_in_layers(void) {
    return fmax(through_layers(12.0, false), through_layers(12.0, true));
}

/* 10 um: less than a sonar on the bottom is taken to be above it. */
double hard_over_the_bottom_in_layers(void) {
    return fmax(through_layers(12.0 - 1e-5, false), through_layers(12.0 - 1e-5, true));
}

/* Rays bend away from the bottom, which a sonar on it does not hear, and one just above hears from as near as a bin. */
double hard_bent_off_the_bottom(void) {
    static const double above_m[] = {0.0, 1e-5, 1e-4, 1e-3}, gradient_per_s[] = {0.016, 0.3, 0.0};
    double most = 0.0;
    for (int k = 0; k < 12; k++) {
        ping_rig r = one_beam(12.0 - above_m[k % 4], 0.0);
        r.env.sound_speed_gradient_per_s = gradient_per_s[k / 4];
        if (k / 4 == 2) {
            r.env.sound_speed_profile =
                (asdic_sound_profile){3, {0.0, 10.0, 20.0}, {1480.0, 1482.0, 1490.0}};
        }
        r.sampling.rays = 1 << 16;
        most = fmax(most, compare(&r, ASDIC_TOTAL, ALL_BINS).most_db);
    }
    return most;
}

/* Sound that is faster there brings what is right below 40 um nearer than it is, and the blanking ends in its middle. */
double hard_where_blanking_ends(void) {
    ping_rig r = one_beam(11.5, 0.0);
    r.env.sound_speed_profile = (asdic_sound_profile){2, {0.0, 40.0}, {1480.0, 1500.0}};
    r.sampling.rays = 1 << 18;
    return compare(&r, ASDIC_TOTAL, 0, 100).most_db;
}

double hard_in_the_surface_in_layers(void) {
    return fmax(through_layers(0.0, false), through_layers(0.0, true));
}

/* Where sound is fastest; the plane where it is slowest is a channel's axis, on which rays fold without end. */
double hard_between_layers(void) {
    return fmax(through_layers(8.0, false), through_layers(4.0, true));
}

/* Around every axis, poles included. */
double hard_every_attitude(void) {
    static const double attitude_deg[][3] = {{0, 90, 0},   {0, -90, 0},    {90, 0, 0},
                                             {180, 0, 0},  {0, 0, 180},    {0, 180, 0},
                                             {45, 90, 45}, {-90, -90, -90}};
    double most = 0.0;
    for (size_t k = 0; k < sizeof attitude_deg / sizeof *attitude_deg; k++) {
        ping_rig r = one_beam(7.0, 0.0);
        r.pose.roll_rad = attitude_deg[k][0] * RIG_DEGREE;
        r.pose.pitch_rad = attitude_deg[k][1] * RIG_DEGREE;
        r.pose.yaw_rad = attitude_deg[k][2] * RIG_DEGREE;
        r.sampling.rays = 1 << 18;
        most = fmax(most, compare(&r, ASDIC_TOTAL, ALL_BINS).rms_db);
    }
    return most;
}

/* 0.1 m: the footprints of many rays are longer than a bin. */
double hard_narrow_bins(void) {
    ping_rig r = one_beam(7.0, 0.0);
    r.sonar.bin_length_m = 0.1;
    return compare(&r, ASDIC_TOTAL, ALL_BINS).rms_db;
}

/* Faces as many wavelengths wide as at 100 kHz. */
double hard_absorbed(void) {
    ping_rig r = one_beam(7.0, 0.0);
    r.sonar.frequency_hz = 3e6;
    r.sonar.transmitter.length_h_m = r.sonar.transmitter.length_v_m = 0.05 / 30.0;
    r.receivers[0].length_h_m = r.receivers[0].length_v_m = 0.05 / 30.0;
    return compare(&r, ASDIC_TOTAL, ALL_BINS).rms_db;
}

/* The worst of receivers that look where nothing is sent. */
static double worst_looking_back(double rear_floor_db) {
    static const double aims_deg[][4] = {/* the transmitter's yaw and pitch, the receiver's */
                                         {0, 0, 180, 10},
                                         {0, 0, 170, 0},
                                         {20, 10, -150, 5},
                                         {-30, 15, 95, -10},
                                         {0, 5, 180, 60}};
    double most = 0.0;
    for (size_t k = 0; k < sizeof aims_deg / sizeof *aims_deg; k++) {
        ping_rig r = one_beam(7.0, aims_deg[k][1]);
        r.sonar.transmitter.yaw_rad = aims_deg[k][0] * RIG_DEGREE;
        r.sonar.rear_floor_db = rear_floor_db;
        r.receivers[0].yaw_rad = aims_deg[k][2] * RIG_DEGREE;
        r.receivers[0].pitch_rad = aims_deg[k][3] * RIG_DEGREE;
        most = fmax(most, compare(&r, ASDIC_TOTAL, ALL_BINS).rms_db);
    }
    return most;
}

/* They hear the edges of both fronts. */
double hard_looking_back(void) {
    return worst_looking_back(-INFINITY);
}

double hard_leaking_back(void) {
    return worst_looking_back(-30.0);
}
