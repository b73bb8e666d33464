/*
 * The expected ping by quadrature. With d slant range, e elevation (positive down), sin Theta = h/d
 * and G(e) the two-way pattern summed around the ring of elevation e:
 *
 *     E_bottom = int_bin  d   TL(d) s_B(asin h/d)    G(+asin h/d)   dd     (dA = d dd dphi, exact)
 *     E_surf   = int_bin  d   TL(d) s_S(asin hd/d)   G(-asin hd/d)  dd
 *     E_vol    = int_bin  d^2 TL(d) s_V  int_{-asin(hd/d)}^{asin(h/d)} cos e G(e) de  dd
 *
 * where the paper multiplies averages taken at the middle of a bin. A pulse longer than a bin then
 * spreads them, as in simulated pings.
 */
#include "expected.h"

#include "base/context.h"
#include "base/quadrature.h"
#include "base/share.h"
#include "base/try.h"
#include "noise_level.h"
#include "pulse.h"
#include "scene/scene.h"

#include <stdlib.h>
#include <string.h>

#include "../../kernels/ray.h"
#include "../../kernels/water.h"

/* On the difference of two rules, of which the better one is kept: 1e-10 is reached. */
#define TOLERANCE 1e-7
/* Over so little of a pattern's cycle seven nodes may do for that; and three hold an integral to 0.1 %, unless they
 * differ by more than a SHARE from the one in the middle, as at an edge. */
#define SMOOTH_CYCLES 2.0
#define SHORT_CYCLES 0.5
#define SHARE 0.02
/* An octave of rounded wavelengths. */
#define WAVELENGTHS 8192.0

asdic_flat_laws asdic_flat_laws_at(const asdic_flat_scene *flat, const asdic_environment *env,
                                   const asdic_sonar *sonar) {
    asdic_water_column column = asdic_water_column_at(env, sonar, flat->depth_m);
    asdic_flat_laws laws = {
        .flat = *flat,
        .water = column,
        .absorption_db_per_km =
            asdic_environment_absorption_db_per_km(env, sonar->frequency_hz, flat->depth_m),
        .source_lin = asdic_water_column_source_lin(&column, env, sonar),
        .volume_lin = asdic_volume_strength_lin(env, sonar),
    };
    asdic_law_water water = asdic_water_column_laws(&laws.water, env, sonar);
    if (flat->has_bottom) {
        laws.bottom = asdic_scatterer_at(&flat->bottom, &water);
    }
    if (flat->has_surface) {
        asdic_material course = asdic_material_of(asdic_law_find("course"));
        laws.surface = asdic_scatterer_at(flat->surface.law ? &flat->surface : &course, &water);
    }
    return laws;
}

double asdic_flat_strength(const asdic_flat_laws *laws, bool surface, double sin_grazing) {
    return asdic_scatterer_strength(surface ? &laws->surface : &laws->bottom, sin_grazing);
}

/* One receiver over one plane or through the water. */
typedef struct integrand {
    const asdic_flat_laws *laws;
    const asdic_ring_profile *profile;
    double height_m; /* of the sonar from the plane */
    bool surface;    /* the plane is the surface */
    bool is_quick;   /* few nodes do */
    double cycles;   /* of the pattern in a radian */
    size_t knots;    /* of the scattering law that lie further out than what is integrated */
} integrand;

/* F at either side of a stretch's centre. */
static double sides(asdic_integrand f, integrand *in, double centre, double off) {
    return f(centre - off, in) + f(centre + off, in);
}

/* Over a stretch in which elevations turn by TURN_RAD; where that is little by Gauss's three nodes, or by Kronrod's
 * four beside these (Kronrod, Nodes and weights of quadrature formulas, 1965). */
static double integrate(asdic_integrand f, integrand *in, double a, double b, double turn_rad) {
    double cycles = turn_rad * in->cycles;
    if (b > a && cycles < SMOOTH_CYCLES) {
        double centre = 0.5 * (a + b), half = 0.5 * (b - a);
        double middle = f(centre, in), near = sides(f, in, centre, sqrt(0.6) * half);
        double mean = (5.0 * near + 8.0 * middle) / 18.0;
        if (in->is_quick && cycles < SHORT_CYCLES && fabs(mean - middle) <= SHARE * mean) {
            return mean * (b - a);
        }
        double better =
            0.5 * (0.450916538658474142 * middle + 0.268488089868333440 * near +
                   0.401397414775962222 * sides(f, in, centre, 0.434243749346802558 * half) +
                   0.104656226026467265 * sides(f, in, centre, 0.960491268708020283 * half));
        if (fabs(better - mean) <= TOLERANCE * better) {
            return better * (b - a);
        }
    }
    return asdic_quadrature(f, in, a, b, TOLERANCE);
}

/* By how much the elevation of a plane turns, HEIGHT_M away, from one range to another. */
static double turn_of(double height_m, double begin_m, double end_m) {
    return end_m <= height_m ? 0.0
                             : ray_plane_elevation(height_m, fmax(begin_m, height_m)) -
                                   ray_plane_elevation(height_m, end_m);
}

static double transmission(const asdic_flat_laws *laws, double d_m) {
    return transmission_lin(d_m, laws->absorption_db_per_km);
}

/* By the coordinate of ray_ring_at. */
static double boundary_density(double s, void *user) {
    const integrand *in = user;
    ray_ring ring = ray_ring_at(in->height_m, s);
    double strength = asdic_flat_strength(in->laws, in->surface, ring.grazing);
    double sum =
        asdic_ring_profile_sum(in->profile, in->surface ? -ring.elevation : ring.elevation);
    return ring.area * transmission(in->laws, ring.range) * strength * sum;
}

static const asdic_scatterer *law_of(const integrand *in) {
    return in->surface ? &in->laws->surface : &in->laws->bottom;
}

/* Cut at the knots of the scattering law, steeper angles first, which are nearer; bins further out follow. */
static double boundary_energy(integrand *in, double begin_m, double end_m) {
    double h = in->height_m, from_m = begin_m, sum = 0.0;
    while (from_m < end_m && end_m > h) {
        double knot_m = INFINITY;
        if (in->knots > 0) {
            double deg = asdic_scatterer_knot_deg(law_of(in), in->knots - 1);
            knot_m = h / sin(deg * (ASDIC_PI / 180.0));
        }
        double to_m = fmin(fmax(knot_m, from_m), end_m);
        sum += integrate(boundary_density, in, ray_ring_coordinate(h, from_m),
                         ray_ring_coordinate(h, to_m), turn_of(h, from_m, to_m));
        from_m = to_m;
        in->knots -= !(knot_m > end_m); /* NAN: at a height of 0 */
    }
    return sum;
}

double asdic_flat_solid_angle(const asdic_flat_scene *flat, const asdic_ring_profile *profile,
                              double d_m) {
    double low = flat->has_surface ? -ray_plane_elevation(flat->depth_m, d_m) : -0.5 * ASDIC_PI;
    double high = flat->has_bottom ? ray_plane_elevation(flat->altitude_m, d_m) : 0.5 * ASDIC_PI;
    return asdic_ring_profile_solid_angle(profile, high) -
           asdic_ring_profile_solid_angle(profile, low);
}

static double volume_density(double d, void *user) {
    const integrand *in = user;
    return ray_tube_area(d) * transmission(in->laws, d) *
           asdic_flat_solid_angle(&in->laws->flat, in->profile, d);
}

/* Cut where the shell meets the bottom and the surface. */
static double volume_energy(integrand *in, double begin_m, double end_m) {
    const asdic_flat_scene *flat = &in->laws->flat;
    double nearer = fmin(flat->altitude_m, flat->depth_m);
    double farther = fmax(flat->altitude_m, flat->depth_m);
    double cuts[4] = {begin_m, fmin(fmax(nearer, begin_m), end_m),
                      fmin(fmax(farther, begin_m), end_m), end_m};
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double turn_rad =
            fmax(turn_of(nearer, cuts[i], cuts[i + 1]), turn_of(farther, cuts[i], cuts[i + 1]));
        sum += integrate(volume_density, in, cuts[i], cuts[i + 1], turn_rad);
    }
    return in->laws->volume_lin * sum;
}

/* Beams that are computed on threads. */
typedef struct beams_job {
    asdic_context *ctx;
    const asdic_flat_laws *laws;
    const asdic_sonar *sonar;
    const asdic_bent_view *view;
    asdic_ping *ping;
} beams_job;

static void compute_beam(const beams_job *j, size_t beam) {
    const asdic_flat_laws *laws = j->laws;
    const asdic_sonar *sonar = j->sonar;
    asdic_ping *ping = j->ping;
    integrand bottom = {.laws = laws,
                        .profile = j->view->profiles[beam],
                        .height_m = laws->flat.altitude_m,
                        .is_quick = j->view->is_quick,
                        .cycles = asdic_ring_cycles(&j->view->rings[beam]),
                        .knots = laws->flat.has_bottom ? asdic_scatterer_knots(&laws->bottom) : 0};
    integrand surface = bottom;
    surface.surface = true;
    surface.height_m = laws->flat.depth_m;
    surface.knots = laws->flat.has_surface ? asdic_scatterer_knots(&laws->surface) : 0;
    for (size_t n = 0; n < ping->bins && !asdic_context_interrupted(j->ctx); n++) {
        double begin = fmax((double)n * sonar->bin_length_m, sonar->blanking_m);
        double end = (double)(n + 1) * sonar->bin_length_m;
        size_t at = beam * ping->bins + n;
        if (end <= begin) {
            continue;
        }
        if (laws->flat.has_bottom) {
            ping->intensity_lin[ASDIC_BOTTOM][at] =
                laws->source_lin * boundary_energy(&bottom, begin, end);
        }
        if (laws->flat.has_surface) {
            ping->intensity_lin[ASDIC_SURFACE][at] =
                laws->source_lin * boundary_energy(&surface, begin, end);
        }
        ping->intensity_lin[ASDIC_VOLUME][at] =
            laws->source_lin * volume_energy(&bottom, begin, end);
    }
}

static asdic_status check(asdic_context *ctx, const asdic_expected_place *place,
                          const asdic_environment *env, const asdic_sonar *sonar,
                          const asdic_ping *ping) {
    const asdic_flat_scene *flat = &place->flat;
    const asdic_pose *pose = &place->pose;
    const asdic_pose attitude = {{0.0, 0.0, 0.0}, pose->roll_rad, pose->pitch_rad, pose->yaw_rad};
    TRY(asdic_environment_check(ctx, env));
    TRY(asdic_sonar_check(ctx, sonar));
    TRY(asdic_pose_check(ctx, &attitude));
    if (!isfinite(flat->depth_m) || (flat->has_surface && flat->depth_m < 0.0)) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "flat scene: the sonar's depth, %g m, must be finite and at least 0 below "
            "a surface",
            flat->depth_m);
    }
    if (flat->has_bottom && !(flat->altitude_m >= 0.0 && isfinite(flat->altitude_m))) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "flat scene: the sonar's altitude, %g m above the bottom, must be finite "
                          "and at least 0",
                          flat->altitude_m);
    }
    const asdic_material *bottom = flat->has_bottom ? &flat->bottom : NULL;
    const asdic_material *surface = flat->has_surface && flat->surface.law ? &flat->surface : NULL;
    if ((bottom && asdic_material_check_use(ctx, bottom, ASDIC_LAW_BOTTOM)) ||
        (surface && asdic_material_check_use(ctx, surface, ASDIC_LAW_SURFACE))) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "flat scene: %s", asdic_context_error(ctx));
    }
    if (ping->beams != sonar->receiver_count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a ping of %zu beams for %zu receivers",
                          ping->beams, sonar->receiver_count);
    }
    return ASDIC_OK;
}

static asdic_ring aim(const asdic_sonar *sonar, size_t receiver, const asdic_pose *pose,
                      double wavelength_m) {
    return (asdic_ring){asdic_face_aim(&sonar->transmitter, pose, wavelength_m),
                        asdic_face_aim(&sonar->receivers[receiver], pose, wavelength_m),
                        pow(10.0, 0.1 * sonar->rear_floor_db)};
}

static void compute_beams(void *user, unsigned worker, size_t first, size_t end) {
    const beams_job *j = user;
    (void)worker;
    for (size_t b = first; b < end; b++) {
        compute_beam(j, b);
    }
}

/* Less than the profiles took, which have said how far they are. */
static asdic_status compute_straight(asdic_context *ctx, const asdic_flat_laws *laws,
                                     const asdic_sonar *sonar, const asdic_bent_view *view,
                                     asdic_ping *ping) {
    beams_job j = {ctx, laws, sonar, view, ping};
    asdic_share(asdic_processors(), ping->beams, 1, compute_beams, &j);
    return asdic_context_interrupted(ctx) ? asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED, "interrupted")
                                          : ASDIC_OK;
}

/* What many places share. */
typedef struct among {
    asdic_ring_shelf *shelf;
    bool is_quick;   /* the wavelength is rounded, rays that bend are fewer */
    double step_rad; /* between attitudes of profiles; 0: they are of this very attitude */
} among;

static double on_grid(double x, double step) {
    return step > 0.0 ? round(x / step) * step : x;
}

/* Rounded down: of a first echo that is expected late nothing is where it comes, and the bin would stand out. */
static double height_on_grid(double x_m, double step_m) {
    return step_m > 0.0 ? floor(x_m / step_m + 1e-6) * step_m : x_m;
}

static double axis_elevation(const asdic_face *face) {
    return asin(fmin(fmax(face->world_to_face.m[0][2], -1.0), 1.0));
}

/* By how much RING looks lower than KEPT, the same in another attitude: of its aperture that is narrower in the
 * horizontal, whose azimuth is that of the echoes. */
static double lower_than(const asdic_ring *kept, const asdic_ring *ring) {
    return ring->receiver.length_h_wl < ring->transmitter.length_h_wl
               ? axis_elevation(&ring->transmitter) - axis_elevation(&kept->transmitter)
               : axis_elevation(&ring->receiver) - axis_elevation(&kept->receiver);
}

/* Beyond this a turn moves a beam's axis across the circles of one elevation rather than along: of a beam that looks down
 * the profile is that of its very attitude. */
#define STEEP_RAD (60.0 * ASDIC_PI / 180.0)

static bool is_steep(const asdic_ring *ring) {
    return fmax(fabs(axis_elevation(&ring->receiver)), fabs(axis_elevation(&ring->transmitter))) >
           STEEP_RAD;
}

/* The boundaries and the water. */
static asdic_status compute_echoes(asdic_context *ctx, const among *with,
                                   const asdic_flat_laws *laws, const asdic_environment *env,
                                   const asdic_sonar *sonar, const asdic_pose *pose,
                                   asdic_ping *ping) {
    asdic_bent_view view = {.is_quick = with->is_quick};
    double wavelength_m = laws->water.wavelength_m;
    asdic_ring *rings = malloc(2 * ping->beams * sizeof *rings);
    if (!rings) {
        return asdic_fail_memory(ctx, "an expected ping");
    }
    asdic_ring *kept = rings + ping->beams;
    if (with->is_quick) {
        wavelength_m = exp2(round(WAVELENGTHS * log2(wavelength_m)) / WAVELENGTHS);
    }
    const asdic_pose near = {.roll_rad = on_grid(pose->roll_rad, with->step_rad),
                             .pitch_rad = on_grid(pose->pitch_rad, with->step_rad),
                             .yaw_rad = pose->yaw_rad};
    for (size_t b = 0; b < ping->beams; b++) {
        rings[b] = aim(sonar, b, pose, wavelength_m);
        kept[b] = with->step_rad > 0.0 ? aim(sonar, b, &near, wavelength_m) : rings[b];
        kept[b] = is_steep(&kept[b]) ? rings[b] : kept[b];
    }
    view.rings = rings;
    asdic_status status = asdic_ring_shelf_take(with->shelf, kept, ping->beams, &view.profiles);
    for (size_t b = 0; b < ping->beams && !status; b++) {
        asdic_ring_profile_lower(view.profiles[b], lower_than(&kept[b], &rings[b]));
    }
    if (!status) {
        status = asdic_environment_bends(env)
                     ? asdic_expected_bent(ctx, laws, env, sonar, &view, ping)
                     : compute_straight(ctx, laws, sonar, &view, ping);
    }
    free(rings);
    return status;
}

static void begin_ping(const asdic_sonar *sonar, asdic_ping *ping) {
    size_t count = ping->beams * ping->bins;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        memset(ping->intensity_lin[c], 0, count * sizeof(double));
    }
    memset(ping->stderr_db, 0, count * sizeof(float));
    ping->bin_length_m = sonar->bin_length_m;
    ping->rays = ping->saturated = 0;
}

/* Rings know nothing of the gain on a receiver's axis. */
static void weigh_beams(const asdic_sonar *sonar, asdic_ping *ping) {
    for (size_t b = 0; b < ping->beams; b++) {
        double gain = asdic_beam_axis_lin(&sonar->receivers[b]);
        for (size_t n = 0; gain < 1.0 && n < ping->bins; n++) {
            for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
                ping->intensity_lin[c][b * ping->bins + n] *= gain;
            }
        }
    }
}

/* PING before the pulse: what asdic_pulse_margin and asdic_pulse_from_m ask for, of beams at HEARD. */
static asdic_status fill(asdic_context *ctx, const among *with, const asdic_expected_place *place,
                         const asdic_flat_laws *laws, const asdic_environment *env,
                         const asdic_sonar *sonar, asdic_ping *ping) {
    asdic_sonar listening = *sonar;
    listening.blanking_m = asdic_pulse_from_m(sonar, laws->water.sound_speed_mps);
    begin_ping(sonar, ping);
    TRY(compute_echoes(ctx, with, laws, env, &listening, &place->pose, ping));
    weigh_beams(sonar, ping);
    asdic_noise_levels(env, sonar, laws->water.sound_speed_mps, ping);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        for (int c = ASDIC_TOTAL + 1; c < ASDIC_COMPONENT_COUNT; c++) {
            ping->intensity_lin[ASDIC_TOTAL][i] += ping->intensity_lin[c][i];
        }
    }
    return ASDIC_OK;
}

static asdic_status compute(asdic_context *ctx, const among *with,
                            const asdic_expected_place *place, const asdic_environment *env,
                            const asdic_sonar *sonar, asdic_ping *ping) {
    const asdic_flat_scene *flat = &place->flat;
    TRY(check(ctx, place, env, sonar, ping));
    double c_mps = asdic_environment_sound_speed_mps(env, flat->depth_m);
    size_t margin = asdic_pulse_margin(sonar, c_mps, ping->bins), bins = ping->bins + margin;
    double range_m = (double)bins * sonar->bin_length_m;
    TRY(asdic_environment_check_depths(
        ctx, env, flat->has_surface ? 0.0 : fmax(flat->depth_m - range_m, 0.0),
        flat->depth_m + (flat->has_bottom ? flat->altitude_m : range_m)));
    asdic_flat_laws laws = asdic_flat_laws_at(flat, env, sonar);
    if (margin == 0) {
        return fill(ctx, with, place, &laws, env, sonar, ping);
    }
    asdic_ping *wide = NULL;
    TRY(asdic_ping_create(ctx, ping->beams, bins, &wide));
    double *scratch = malloc(asdic_pulse_scratch(bins) * sizeof *scratch);
    asdic_status status = scratch ? fill(ctx, with, place, &laws, env, sonar, wide)
                                  : asdic_fail_memory(ctx, "an expected ping");
    if (!status) {
        asdic_pulse_smear(sonar, c_mps, 1, scratch, wide, ping);
    }
    free(scratch);
    asdic_ping_destroy(&wide);
    return status;
}

asdic_status asdic_expected_compute_among(asdic_context *ctx, asdic_ring_shelf *shelf,
                                          const asdic_expected_place *place, double step_rad,
                                          const asdic_environment *env, const asdic_sonar *sonar,
                                          asdic_ping *ping) {
    return compute(ctx, &(among){shelf, true, step_rad}, place, env, sonar, ping);
}

asdic_status asdic_expected_compute(asdic_context *ctx, const asdic_flat_scene *flat,
                                    const asdic_environment *env, const asdic_sonar *sonar,
                                    const asdic_pose *pose, asdic_ping *ping) {
    if (!flat || !env || !sonar || !pose || !ping) {
        return asdic_fail_null(ctx, __func__);
    }
    const asdic_expected_place place = {*flat, *pose};
    asdic_ring_shelf *shelf = NULL;
    TRY(asdic_ring_shelf_create(ctx, 1, &shelf));
    asdic_status status = compute(ctx, &(among){shelf, false, 0.0}, &place, env, sonar, ping);
    asdic_ring_shelf_destroy(&shelf);
    return status;
}

asdic_expected_place asdic_expected_place_on_grid(const asdic_flat_scene *flat,
                                                  const asdic_pose *pose, double step_m,
                                                  double step_rad) {
    asdic_expected_place place = {.flat = *flat,
                                  .pose = {.roll_rad = on_grid(pose->roll_rad, step_rad),
                                           .pitch_rad = on_grid(pose->pitch_rad, step_rad)}};
    place.flat.altitude_m = height_on_grid(flat->altitude_m, step_m);
    place.flat.depth_m = height_on_grid(flat->depth_m, step_m);
    return place;
}

static bool near(double a, double b, double share) {
    return fabs(a - b) <= share * fmax(fabs(a), 1.0);
}

bool asdic_expected_is_near(const asdic_expected_place *a, const asdic_expected_place *b,
                            double share, double angle_rad) {
    return a->flat.has_surface == b->flat.has_surface && a->flat.has_bottom == b->flat.has_bottom &&
           (!a->flat.has_bottom || asdic_material_equal(&a->flat.bottom, &b->flat.bottom)) &&
           asdic_material_equal(&a->flat.surface, &b->flat.surface) &&
           (!a->flat.has_bottom || near(a->flat.altitude_m, b->flat.altitude_m, share)) &&
           near(a->flat.depth_m, b->flat.depth_m, share) &&
           fabs(a->pose.pitch_rad - b->pose.pitch_rad) <= angle_rad &&
           fabs(a->pose.roll_rad - b->pose.roll_rad) <= angle_rad;
}
