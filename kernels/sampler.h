/*
 * Where rays go: three samplers, each a direction and its solid angle (1 / (N p(u))).
 *
 * Directions are in world axes (NED): z down. Sources: the paper, section IV (uniform sphere);
 * heavy-tailed importance sampling and multiple importance sampling by the balance heuristic:
 * Veach, "Robust Monte Carlo methods for light transport simulation", 1997, ch. 9; Kronecker
 * (rank-1, golden ratio) lattice: Niederreiter, "Random number generation and quasi-Monte Carlo
 * methods", 1992.
 */
#ifndef ASDIC_KERNEL_SAMPLER_H
#define ASDIC_KERNEL_SAMPLER_H

#include "ping_types.h"
#include "random.h"
#include "ray.h"

#ifdef __OPENCL_C_VERSION__
#define LOBE_SPACE __global
#else
#define LOBE_SPACE
#endif

typedef struct ray_sample {
    real x, y, z;
    real solid_angle; /* sr; 0: not used */
    real splat;       /* range footprint per (range x |normal . tangent| / sin grazing); 0: none */
} ray_sample;

/* An azimuth that is drawn at the end of its window may come out beyond it by so much, rounded. Its density is that at
 * the end: with none at all its ray would weigh without end. */
#define WINDOW_EDGE 4e-6f
/* A window ends so far, rad, inside the front that it covers, more than its arc and azimuths are rounded: a ray drawn
 * beyond the front hears nothing. Of a beam much smaller than a wavelength nothing else errs: with windows that reached
 * 1e-3 beyond it, one of 16 bins lost one of its hundred rays, 0.045 dB. What no ray meets is 2e-6 of the energy. */
#define WINDOW_MARGIN 2e-6f

FORMULA real front_window(real arc) {
    return r_max(arc - (real)(WINDOW_MARGIN), (real)(WINDOW_MARGIN));
}

FORMULA mask in_window(real x, real limit) {
    return r_abs(x) <= limit + (real)(WINDOW_EDGE);
}

/*
 * Student's t with two degrees of freedom, scale S, truncated to [-limit, limit]: closed form both
 * ways. Its tail falls as u^-3, slower than the u^-4 of a two-way sinc pattern, so that weights
 * stay bounded; with S far above the limit it is uniform.
 */
FORMULA real student_mass(real scale, real limit) {
    real t = limit / scale;
    return t / sqrt(R(2.0) + t * t);
}

FORMULA real student_sample(real xi, real scale, real limit) {
    real a = (R(2.0) * xi - R(1.0)) * student_mass(scale, limit);
    return scale * a * sqrt(R(2.0) / ((R(1.0) - a) * (R(1.0) + a)));
}

FORMULA real student_density(real x, real scale, real limit) {
    real t = x / scale;
    real q = R(2.0) + t * t;
    real inside = choose(in_window(x, limit), R(1.0), R(0.0));
    return inside / (scale * student_mass(scale, limit) * q * sqrt(q));
}

/*
 * Student's density with a share that is uniform over the window, so that directions far off the
 * beams (deep nulls get their echo from there) are never starved. Sampled by inverting the mixture's
 * distribution, not by splitting the rays: a lattice stays one lattice. Halley's steps from a lower
 * bound of the root rise monotonically; four leave 3e-7 of the window for any scale above 1e-4 of it.
 */
#define HEAVY_UNIFORM 0.06f

/* Density at an azimuth, and the share below it. */
typedef struct azimuth_at {
    real density, below;
} azimuth_at;

FORMULA azimuth_at heavy_of(real x, real scale, real limit) {
    const real even = (real)(HEAVY_UNIFORM), odd = (real)(1.0f - HEAVY_UNIFORM);
    real t = x / scale, q = R(2.0) + t * t, r = R(1.0) / sqrt(q);
    real mass = student_mass(scale, limit);
    azimuth_at at;
    at.density = odd * r / (scale * mass * q) + even * R(0.5) / limit;
    at.density = choose(in_window(x, limit), at.density, R(0.0));
    at.below = R(0.5) * (R(1.0) + odd * t * r / mass + even * x / limit);
    return at;
}

FORMULA real heavy_sample(real xi, real scale, real limit) {
    const real even = (real)(HEAVY_UNIFORM), odd = (real)(1.0f - HEAVY_UNIFORM);
    real mass = student_mass(scale, limit);
    real y = r_abs(R(2.0) * xi - R(1.0));
    real a = y * mass;
    real x = scale * a * sqrt(R(2.0) / ((R(1.0) - a) * (R(1.0) + a)));
    x = r_min(r_max(x, limit * (y - odd) / even), limit);
    for (int i = 0; i < 4; i++) {
        real t = x / scale;
        real q = R(2.0) + t * t;
        real r = R(1.0) / sqrt(q);
        real f = odd * t * r / mass + even * x / limit - y;
        real d = odd * R(2.0) * r / (scale * mass * q) + even / limit;
        real curl = odd * R(3.0) * t * r / (scale * scale * mass * q * q); /* -f'' / 2 */
        x = r_min(r_max(x - f / (d + f * curl / d), R(0.0)), limit);
    }
    return choose(xi < R(0.5), -x, x);
}

/* The same of a sector: even over a core, and with less even over what is left of the window. */
#define SECTOR_TAILS 0.0625f

FORMULA real sector_tails(real core, real limit) {
    return (real)(SECTOR_TAILS)*r_min(R(4.0) * (limit - core) / limit, R(1.0));
}

FORMULA azimuth_at sector_of(real x, real core, real limit) {
    real tails = sector_tails(core, limit), off = r_min(r_abs(x), limit);
    real width = r_max(limit - core, R(1e-6));
    mask inside = off <= core;
    azimuth_at at;
    at.density = R(0.5) * choose(inside, (R(1.0) - tails) / core, tails / width);
    at.density = choose(in_window(x, limit), at.density, R(0.0));
    real beyond = choose(inside, (R(1.0) - tails) * off / core,
                         R(1.0) - tails + tails * (off - core) / width);
    at.below = R(0.5) * (R(1.0) + choose(x < R(0.0), -beyond, beyond));
    return at;
}

FORMULA real sector_sample(real xi, real core, real limit) {
    real tails = sector_tails(core, limit);
    real y = r_abs(R(2.0) * xi - R(1.0)), even = R(1.0) - tails;
    real x = choose(y <= even, core * y / even,
                    core + (limit - core) * (y - even) / r_max(tails, R(1e-6)));
    x = r_min(x, limit);
    return choose(xi < R(0.5), -x, x);
}

/* Angle to (-pi, pi]. */
FORMULA real wrap_angle(real phi) {
    return phi - R(2.0) * R_PI * r_floor(phi * (R(0.5) / R_PI) + R(0.5));
}

/* The paper's sampler: N directions uniform on the sphere. */
FORMULA ray_sample sample_uniform_sphere(random4 random, real count) {
    ray_sample s;
    real uz = R(2.0) * random_uniform(random.v[0]) - R(1.0);
    real phi = R(2.0) * R_PI * random_uniform(random.v[1]);
    real m = sqrt((R(1.0) - uz) * (R(1.0) + uz));
    s.x = m * cos(phi);
    s.y = m * sin(phi);
    s.z = uz;
    s.solid_angle = R(4.0) * R_PI / count;
    s.splat = R(0.0);
    return s;
}

/* Density per steradian of beam lobe L at a world direction. */
FORMULA real beam_lobe_density(LOBE_SPACE const dev_lobe *lobe, real x, real y, real z) {
    real vx = lobe->rows[0] * x + lobe->rows[1] * y + lobe->rows[2] * z;
    real vy = lobe->rows[3] * x + lobe->rows[4] * y + lobe->rows[5] * z;
    real vz = lobe->rows[6] * x + lobe->rows[7] * y + lobe->rows[8] * z;
    real m = sqrt(r_max((R(1.0) - vz) * (R(1.0) + vz), R(1e-12)));
    real limit = (real)(lobe->limit_rad);
    return student_density(vz, (real)(lobe->scale_v), R(1.0)) *
           student_density(atan2(vy, vx), (real)(lobe->scale_h) / m, limit);
}

/* Importance from the beam patterns alone: a mixture of lobes around every aim, one of them wide. */
FORMULA ray_sample sample_beam(LOBE_SPACE const dev_lobe *lobes, uint lobe_count, random4 random,
                               real count) {
    ray_sample s;
    real pick = random_uniform(random.v[2]);
    real xi1 = random_uniform(random.v[0]), xi2 = random_uniform(random.v[1]);
    s.x = s.y = s.z = R(0.0);
    for (uint j = 0; j < lobe_count; j++) {
        LOBE_SPACE const dev_lobe *lobe = lobes + j;
        real vz = student_sample(xi1, (real)(lobe->scale_v), R(1.0));
        real m = sqrt(r_max((R(1.0) - vz) * (R(1.0) + vz), R(1e-12)));
        real phi = student_sample(xi2, (real)(lobe->scale_h) / m, (real)(lobe->limit_rad));
        real vx = m * cos(phi), vy = m * sin(phi);
        mask here = pick >= (real)(lobe->share_begin);
        s.x = choose(here, lobe->rows[0] * vx + lobe->rows[3] * vy + lobe->rows[6] * vz, s.x);
        s.y = choose(here, lobe->rows[1] * vx + lobe->rows[4] * vy + lobe->rows[7] * vz, s.y);
        s.z = choose(here, lobe->rows[2] * vx + lobe->rows[5] * vy + lobe->rows[8] * vz, s.z);
    }
    real density = R(0.0);
    for (uint j = 0; j < lobe_count; j++) {
        density += (real)(lobes[j].share) * beam_lobe_density(lobes + j, s.x, s.y, s.z);
    }
    s.solid_angle = R(1.0) / (count * density);
    s.splat = R(0.0);
    return s;
}

/*
 * Adaptive sampler: elevation. x in (0, 1) runs over five disjoint zones from nadir to zenith: a cap
 * equally spaced in polar angle (a specular spike or a rough mirror's peak lies within fractions of
 * a degree); rays that meet a bottom at h below the sonar, equally spaced in range; rays that meet
 * nothing; rays that meet the surface, equally spaced in range; a cap round the zenith.
 */
typedef struct elevation {
    real uz, across; /* sine (down positive) and cosine of the elevation */
    real density;    /* of uz */
} elevation;

typedef struct zones {
    real h, hs;
    real h1, hs1;   /* ranges at which the caps end */
    real far, fars; /* ranges at which they end */
    real bend, bends;
    real high, low; /* uz of the gap's ends */
    real begin[5], share[5];
} zones;

FORMULA zones zones_of(LOBE_SPACE const dev_ping *ping) {
    zones z;
    real cap = cos((real)(ping->sampling.zones.cap_rad));
    z.h = (real)(ping->sampling.zones.bottom_m);
    z.hs = (real)(ping->sampling.zones.surface_m);
    z.far = (real)(ping->sampling.zones.bottom_far_m);
    z.fars = (real)(ping->sampling.zones.surface_far_m);
    z.bend = (real)(ping->sampling.zones.bottom_bend_per_m);
    z.bends = (real)(ping->sampling.zones.surface_bend_per_m);
    z.h1 = ray_plane_range(z.h, cap, z.bend);
    z.hs1 = ray_plane_range(z.hs, cap, z.bends);
    z.high = z.low = R(1.0);
    if (ping->sampling.zones.share[1] > 0.0f) {
        z.high = ray_plane_sine(z.h, z.far, z.bend);
    }
    if (ping->sampling.zones.share[3] > 0.0f) {
        z.low = ray_plane_sine(z.hs, z.fars, z.bends);
    }
    z.low = -z.low;
    real begin = R(0.0);
    for (int i = 0; i < 5; i++) {
        z.begin[i] = begin;
        z.share[i] = r_max((real)(ping->sampling.zones.share[i]), R(1e-9));
        begin += (real)(ping->sampling.zones.share[i]);
    }
    return z;
}

/* Density of uz where rays of SHARE are equally spaced in polar angle within a cap. In the zones of bottom
 * and surface it is ray_plane_density. */
FORMULA real cap_zone_density(real share, real cap, real sin_polar) {
    return share / (cap * r_max(sin_polar, R(1e-7)));
}

FORMULA elevation elevation_of_x(LOBE_SPACE const dev_ping *ping, real x) {
    zones z = zones_of(ping);
    real cap = (real)(ping->sampling.zones.cap_rad);
    real part[5];
    for (int i = 0; i < 5; i++) {
        part[i] = r_min(r_max((x - z.begin[i]) / z.share[i], R(0.0)), R(1.0));
    }
    /* Gap. */
    elevation e;
    e.uz = z.high - part[2] * (z.high - z.low);
    e.uz = r_max(r_min(e.uz, ray_short_of(z.high)), -ray_short_of(-z.low));
    e.density = z.share[2] / (z.high - z.low);
    /* Bottom and surface. */
    real db = z.h1 + part[1] * (z.far - z.h1), ds = z.fars - part[3] * (z.fars - z.hs1);
    mask in_bottom = x < z.begin[2], in_surface = x >= z.begin[3];
    e.uz = choose(in_bottom, ray_plane_sine(z.h, db, z.bend), e.uz);
    e.density =
        choose(in_bottom, ray_plane_density(z.share[1], db, z.h, z.h1, z.far, z.bend), e.density);
    e.uz = choose(in_surface, -ray_plane_sine(z.hs, ds, z.bends), e.uz);
    e.density = choose(in_surface, ray_plane_density(z.share[3], ds, z.hs, z.hs1, z.fars, z.bends),
                       e.density);
    e.across = sqrt(r_max((R(1.0) - e.uz) * (R(1.0) + e.uz), R(1e-12)));
    /* Caps: polar angles, so that the cosine near 1 loses nothing. */
    mask nadir = x < z.begin[1], zenith = x >= z.begin[4];
    real polar = cap * choose(nadir, part[0], R(1.0) - part[4]);
    real share = choose(nadir, z.share[0], z.share[4]);
    real up = choose(nadir, R(1.0), R(-1.0));
    e.uz = choose(nadir | zenith, up * cos(polar), e.uz);
    e.across = choose(nadir | zenith, r_max(sin(polar), R(1e-7)), e.across);
    e.density = choose(nadir | zenith, cap_zone_density(share, cap, sin(polar)), e.density);
    return e;
}

/* The inverse: x of an elevation, with the same density. */
FORMULA real x_of_elevation(LOBE_SPACE const dev_ping *ping, real uz, real across, real *density) {
    zones z = zones_of(ping);
    real cap = (real)(ping->sampling.zones.cap_rad);
    real x = z.begin[2] + z.share[2] * (z.high - uz) / (z.high - z.low);
    real p = z.share[2] / (z.high - z.low);
    real db = ray_plane_range(z.h, uz, z.bend);
    real ds = ray_plane_range(z.hs, -uz, z.bends);
    mask in_bottom = uz > z.high, in_surface = uz < z.low;
    x = choose(in_bottom, z.begin[1] + z.share[1] * (db - z.h1) / (z.far - z.h1), x);
    p = choose(in_bottom, ray_plane_density(z.share[1], db, z.h, z.h1, z.far, z.bend), p);
    x = choose(in_surface, z.begin[3] + z.share[3] * (z.fars - ds) / (z.fars - z.hs1), x);
    p = choose(in_surface, ray_plane_density(z.share[3], ds, z.hs, z.hs1, z.fars, z.bends), p);
    real polar = asin(r_min(across, R(1.0)));
    mask nadir = in_bottom & (uz > R(0.0)) & (polar < cap);
    mask zenith = in_surface & (uz < R(0.0)) & (polar < cap);
    x = choose(nadir, z.share[0] * polar / cap, x);
    p = choose(nadir, cap_zone_density(z.share[0], cap, across), p);
    x = choose(zenith, z.begin[4] + z.share[4] * (R(1.0) - polar / cap), x);
    p = choose(zenith, cap_zone_density(z.share[4], cap, across), p);
    *density = p;
    return x;
}

/* Where a lobe's azimuths lie at an elevation: round its ridge's near and far crossing (beyond the nadir
 * or the zenith), each with its window, and the share of the near one. */
typedef struct azimuth_lobe {
    real near, near_limit, far, far_limit, scale, near_share;
    real near_core, far_core; /* of a sector: half its widths at the crossings; else 0 */
} azimuth_lobe;

/* Half of the arc of azimuths in front of an aperture with the axis F at an elevation; more than pi: all of
 * them, or none. */
FORMULA real arc_before(real fx, real fy, real fz, real uz, real m) {
    real fh = sqrt(fx * fx + fy * fy);
    real c = -fz * uz / r_max(m * fh, R(1e-6));
    real arc = acos(r_max(r_min(c, R(1.0)), R(-1.0)));
    return choose(r_abs(c) >= R(1.0), R(4.0), arc);
}

/* The same of the transmitter. */
FORMULA real front_arc(LOBE_SPACE const dev_ping *ping, real uz, real m) {
    return arc_before((real)(ping->sampling.front[0]), (real)(ping->sampling.front[1]),
                      (real)(ping->sampling.front[2]), uz, m);
}

/* How far an azimuth lies from the transmitter's. */
FORMULA real off_front(LOBE_SPACE const dev_ping *ping, real phi) {
    return r_abs(wrap_angle(phi - (real)(ping->sampling.front_azimuth_rad)));
}

/* A receiver may look where the transmitter does not: the near crossing of its lobe A then lies where nothing is
 * sent, and what it hears comes from the edges of both fronts. Unless it hears the far one, the lobe is spread over
 * the azimuths in front of both: from the receiver's edge to the transmitter's on its side, and on the other. ASIDE are
 * the lanes in question. */
FORMULA void look_aside(LOBE_SPACE const dev_ping *ping, LOBE_SPACE const dev_lobe *lobe, real uz,
                        real m, real front, mask aside, azimuth_lobe *a) {
    real fx = (real)(lobe->rows[0]), fy = (real)(lobe->rows[1]);
    real axis = (real)(ping->sampling.front_azimuth_rad);
    real turn = wrap_angle(atan2(fy, fx) - axis), apart = r_abs(turn);
    real side = choose(turn < R(0.0), R(-1.0), R(1.0));
    real own = r_min(arc_before(fx, fy, (real)(lobe->rows[2]), uz, m), R_PI);
    real near = r_max(apart - own, -front), far = R(2.0) * R_PI - apart - own;
    real near_arc = r_max(front - near, R(0.0)), far_arc = r_max(front - far, R(0.0));
    real crossing = side * wrap_angle(a->far - axis);
    mask heard = (r_abs(crossing) < front) & ((crossing > near) | (crossing < -far));
    aside = aside & !heard & (near_arc + far_arc > R(0.0));
    a->near = choose(aside, axis + side * R(0.5) * (front + near), a->near);
    a->far = choose(aside, axis - side * R(0.5) * (front + far), a->far);
    a->near_limit = choose(aside, front_window(R(0.5) * near_arc), a->near_limit);
    a->far_limit = choose(aside, front_window(R(0.5) * far_arc), a->far_limit);
    a->near_share = choose(aside, near_arc / r_max(near_arc + far_arc, R(1e-6)), a->near_share);
    a->scale = choose(aside, (real)(DEV_EVEN_SCALE), a->scale);
}

/* Two-way gain, about, where a lobe's ridge is at azimuth PHI: nulls filled, as asdic_aim_envelope. */
FORMULA real crossing_gain(LOBE_SPACE const dev_ping *ping, LOBE_SPACE const dev_lobe *lobe,
                           real uz, real m, real phi) {
    LOBE_SPACE const float *ahead = ping->sampling.front, *own = lobe->rows;
    LOBE_SPACE const float *y = ping->sampling.sender_y, *z = ping->sampling.sender_z;
    const real rear = r_max((real)(ping->rear_lin), R(1e-9)); /* its square is not to vanish */
    real ux = m * cos(phi), uy = m * sin(phi);
    real along = lobe->along[0] * ux + lobe->along[1] * uy + lobe->along[2] * uz;
    real h = y[0] * ux + y[1] * uy + y[2] * uz, v = z[0] * ux + z[1] * uy + z[2] * uz;
    real gain = choose(ahead[0] * ux + ahead[1] * uy + ahead[2] * uz < R(0.0), rear, R(1.0));
    gain *= choose(own[0] * ux + own[1] * uy + own[2] * uz < R(0.0), rear, R(1.0));
    return gain / ((R(1.0) + along * along) * (R(1.0) + h * h) * (R(1.0) + v * v));
}

/* At elevation UZ with cosine M and FRONT as from front_arc. A ridge crosses a ring of constant
 * elevation twice; where both crossings lie in front of the transmitter, as round nadir and zenith, they
 * share the lobe's rays. */
FORMULA azimuth_lobe azimuth_lobe_at(LOBE_SPACE const dev_ping *ping,
                                     LOBE_SPACE const dev_lobe *lobe, real uz, real m, real front) {
    azimuth_lobe a;
    real side = (real)(lobe->side);
    real q = -(real)(lobe->tilt) * uz / m;
    q = r_max(r_min(q, R(1.0)), R(-1.0));
    real ridge = acos(q), apart = R(0.0);
    real steep = sqrt(r_max((R(1.0) - q) * (R(1.0) + q), R(0.01)));
    a.scale = (real)(lobe->scale_h) / (m * steep);
    if (lobe->margin_rad > 0.0f) { /* a sector: from one ridge to another */
        real r = -(real)(lobe->most_tilt) * uz / m;
        r = r_max(r_min(r, R(1.0)), R(-1.0));
        apart = R(0.5) * (acos(r) - ridge);
    }
    a.near = (real)(lobe->beta_rad) + side * (ridge + apart);
    a.far = (real)(lobe->beta_rad) - side * (ridge + apart);
    real near_off = off_front(ping, a.near), far_off = off_front(ping, a.far);
    a.near_limit = r_min(front_window(front + near_off), R_PI);
    a.far_limit = r_min(front_window(front + far_off), R_PI);
    a.near_core = a.far_core = R(0.0);
    if (lobe->margin_rad > 0.0f) {
        /* Where ridges part at one crossing they close up at the other: round the axis that beams turn about all
         * of them. */
        real own = (real)(lobe->limit_rad), margin = (real)(lobe->margin_rad) / (m * steep);
        a.near_core = r_abs(own + side * apart) + margin;
        a.far_core = r_abs(own - side * apart) + margin;
    } else if (lobe->limit_rad >= 0.0f) {
        a.near_limit = a.far_limit = (real)(lobe->limit_rad);
    }
    mask both = (far_off < front) & (near_off < front);
    mask only_far = (far_off < front) & (near_off >= front);
    a.near_share = choose(both, R(0.5), choose(only_far, R(0.0), R(1.0)));
    if (ping->rear_lin > 0.0f) { /* what leaks backwards may be all that is heard here */
        real near_gain = crossing_gain(ping, lobe, uz, m, a.near);
        a.near_share = near_gain / (near_gain + crossing_gain(ping, lobe, uz, m, a.far));
    } else if (lobe->aside != 0u && any_true(near_off >= front)) {
        look_aside(ping, lobe, uz, m, front, near_off >= front, &a);
    }
    return a;
}

/* All lobes at one elevation. Vectors keep them; on a GPU an array would lie in slow memory, so that each
 * is computed whenever it is asked for. */
typedef struct azimuth_lobes {
#if ASDIC_WIDTH == 1
    real uz, m, front;
#else
    azimuth_lobe lobe[DEV_MAX_LOBES];
#endif
} azimuth_lobes;

FORMULA azimuth_lobes azimuth_lobes_at(LOBE_SPACE const dev_ping *ping, real uz, real m) {
    azimuth_lobes all;
    real front = front_arc(ping, uz, m);
#if ASDIC_WIDTH == 1
    all.uz = uz;
    all.m = m;
    all.front = front;
#else
    for (uint j = 0; j < ping->sampling.lobes; j++) {
        all.lobe[j] = azimuth_lobe_at(ping, ping->sampling.lobe + j, uz, m, front);
    }
#endif
    return all;
}

FORMULA azimuth_lobe azimuth_lobes_get(LOBE_SPACE const dev_ping *ping, const azimuth_lobes *all,
                                       uint j) {
#if ASDIC_WIDTH == 1
    return azimuth_lobe_at(ping, ping->sampling.lobe + j, all->uz, all->m, all->front);
#else
    (void)ping;
    return all->lobe[j];
#endif
}

/* Density, as share, of an azimuth OFF a crossing of lobe A, on its FAR side or not; and an azimuth from the quantile
 * XI. */
FORMULA azimuth_at lobe_of(const azimuth_lobe *a, real off, mask far) {
    real core = choose(far, a->far_core, a->near_core);
    real limit = choose(far, a->far_limit, a->near_limit);
    if (any_true(core > R(0.0))) {
        return sector_of(off, r_min(core, limit), limit);
    }
    return heavy_of(off, a->scale, limit);
}

FORMULA real lobe_sample(const azimuth_lobe *a, real xi, mask far) {
    real core = choose(far, a->far_core, a->near_core);
    real limit = choose(far, a->far_limit, a->near_limit);
    mask sector = core > R(0.0); /* lanes may have picked different lobes */
    real even = R(0.0), heavy = R(0.0);
    if (any_true(sector)) {
        even = sector_sample(xi, r_min(core, limit), limit);
    }
    if (any_true(core <= R(0.0))) {
        heavy = heavy_sample(xi, a->scale, limit);
    }
    return choose(sector, even, heavy);
}

/*
 * Objects: a small target is met by few rays of a sampler that knows nothing of it. Cones round
 * bounding spheres get rays of their own; a ray counts by the density of all the ways it could have
 * been drawn (balance heuristic, Veach 1997, section 9.2), so that no direction weighs more than
 * before.
 */

/* A direction uniform in solid angle within the cone, whose section is an ellipse where chords to its axis are as long
 * as in a plane (Lambert's azimuthal projection, which keeps areas). */
FORMULA ray_sample sample_cone(LOBE_SPACE const dev_cone *cone, real xi1, real xi2) {
    real wide = (real)(cone->chord[0]), high = (real)(cone->chord[1]), out = sqrt(xi1);
    real vx = wide * out * cos(R(2.0) * R_PI * xi2), vy = high * out * sin(R(2.0) * R_PI * xi2);
    real drop = R(0.5) * (vx * vx + vy * vy); /* 1 - cos of the angle to the axis */
    real across = sqrt(R(1.0) - R(0.5) * drop), along = R(1.0) - drop;
    vx *= across;
    vy *= across;
    ray_sample s;
    s.x = cone->rows[0] * vx + cone->rows[3] * vy + cone->rows[6] * along;
    s.y = cone->rows[1] * vx + cone->rows[4] * vy + cone->rows[7] * along;
    s.z = cone->rows[2] * vx + cone->rows[5] * vy + cone->rows[8] * along;
    s.solid_angle = R_PI * wide * high / (real)((float)(cone->count));
    s.splat = (real)(cone->splat);
    return s;
}

/* Whether a direction lies in the cone, from the chord to its axis, whose square is twice the drop:
 * in single precision, one minus a cosine would lose narrow cones. */
FORMULA mask in_cone(LOBE_SPACE const dev_cone *cone, real x, real y, real z) {
    real dx = x - cone->rows[6], dy = y - cone->rows[7], dz = z - cone->rows[8];
    real wide = (cone->rows[0] * dx + cone->rows[1] * dy + cone->rows[2] * dz) / cone->chord[0];
    real high = (cone->rows[3] * dx + cone->rows[4] * dy + cone->rows[5] * dz) / cone->chord[1];
    real drop = R(0.5) * (dx * dx + dy * dy + dz * dz);
    return wide * wide + high * high < R(1.0) - R(0.5) * drop;
}

#endif
