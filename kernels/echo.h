/*
 * From a ray to an echo: what it met, how strongly that scatters, how the apertures weigh it, and
 * which bins it falls in.
 */
#ifndef ASDIC_KERNEL_ECHO_H
#define ASDIC_KERNEL_ECHO_H

#include "backscatter.h"
#include "beam.h"
#include "deposit.h"
#include "law_table.h"
#include "mirror.h"
#include "ping_types.h"
#include "ray.h"
#include "smooth.h"
#include "target.h"

#ifndef ASDIC_HAS_MIRRORS
#define ASDIC_HAS_MIRRORS 0
#endif

#define LANES for (uint lane = 0; lane < ASDIC_WIDTH; lane++)
#define AT(vector, type) ((type *)&(vector))[lane]

/* A plane's flat area: as good as endless. */
#define ASDIC_PLANE_M2 1e12f

/* The scene as kernels see it; bundles what every ray needs. */
typedef struct world {
    __global const dev_ping *ping;
    __global const dev_beam *beams; /* transmitter, then receivers */
    __global const dev_triangle *triangles;
    __global const dev_part *parts;
    /* Words: dev_material each, and behind them tables of laws. Mesa 22's compiler strides over the words of a
     * pointer to structures as if they were structures. */
    __global const uint *materials;
    __global const float *face_density; /* by triangle, see faces.h */
} world;

/* The apertures that follow a ping in its buffer. */
static __global const dev_beam *beams_of(__global const dev_ping *ping) {
    return (__global const dev_beam *)(ping + 1);
}

/* Where the sonar is. */
static triple sonar_of(__global const dev_ping *ping) {
    triple at = {(real)(ping->origin[0]), (real)(ping->origin[1]), (real)(ping->origin[2])};
    return at;
}

/* The sound speed where its rays go. */
static ray_medium medium_of(__global const dev_ping *ping) {
    ray_medium water = {(real)(ping->bend_per_m),
                        (real)(1.0f + ping->bend_per_m * ping->origin[2])};
    return water;
}

/* SLOT and those that follow it, a lane each. */
static natural slots_from(uint slot) {
    natural slots = (natural)(0u);
    LANES {
        AT(slots, uint) = slot + lane;
    }
    return slots;
}

static vector lane_of(const triple *v, uint lane) {
    return vector_of(AT(v->x, const float), AT(v->y, const float), AT(v->z, const float));
}

/* Directions of the rays in SLOTS, as a tracer sees them. */
static triple load_directions(__global const dev_ray *rays, natural slots) {
    triple d;
    LANES {
        __global const float *from = rays[AT(slots, uint)].direction;
        AT(d.x, float) = from[0];
        AT(d.y, float) = from[1];
        AT(d.z, float) = from[2];
    }
    return d;
}

/* Rays of the sonar: their last legs, and how they left it. */
typedef struct sonar_rays {
    ray r;
    triple sent;
} sonar_rays;

#if ASDIC_LAYERS

/* The last leg of a ray through layers so far: where and how it begins, how the ray left the sonar, what it has
 * gone through before (ray.h). A vector of each for the rays of ASDIC_WIDTH slots, one behind the other. */
enum {
    LEG_FROM = 0,
    LEG_SENT = 3,
    LEG_U = 6,
    LEG_BEND = 9,
    LEG_PACE,
    LEG_RANGE,
    LEG_ARC,
    LEG_ACROSS,
    LEG_ALONG,
    LEG_SLOPE,
    LEG_LAYER,
    /* In the place of LEG_SENT, of rays that do not leave the sonar: the range at which they end, the width of
     * their tube across the plane of the ray at the mirror, and the splat of the sonar's ray. */
    LEG_UNTIL = LEG_SENT,
    LEG_BEFORE,
    LEG_SPLAT
};

/* The vectors of the rays from SLOT on. */
static __global const real *leg_rows(__global const float *legs, uint slot) {
    return (__global const real *)(legs + (size_t)(slot)*DEV_LEG_FLOATS);
}

static ray load_leg(__global const real *row) {
    ray r;
    r.from.x = row[LEG_FROM];
    r.from.y = row[LEG_FROM + 1];
    r.from.z = row[LEG_FROM + 2];
    r.u.x = row[LEG_U];
    r.u.y = row[LEG_U + 1];
    r.u.z = row[LEG_U + 2];
    r.bend = row[LEG_BEND];
    r.pace = row[LEG_PACE];
    r.range = row[LEG_RANGE];
    r.arc = row[LEG_ARC];
    r.across = row[LEG_ACROSS];
    r.along = row[LEG_ALONG];
    r.slope = row[LEG_SLOPE];
    r.fan = R(1.0) / r.pace;
    return r;
}

/* A number of one ray. */
static size_t leg_at(uint slot, uint row) {
    return (size_t)(slot - slot % ASDIC_WIDTH) * DEV_LEG_FLOATS + row * ASDIC_WIDTH +
           slot % ASDIC_WIDTH;
}

/* ROW of the rays in SLOTS, which need not be neighbours. */
static real gather_row(__global const float *legs, natural slots, uint row) {
    real values;
    LANES {
        AT(values, float) = legs[leg_at(AT(slots, uint), row)];
    }
    return values;
}

static ray gather_leg(__global const float *legs, natural slots) {
    ray r;
    r.from.x = gather_row(legs, slots, LEG_FROM);
    r.from.y = gather_row(legs, slots, LEG_FROM + 1);
    r.from.z = gather_row(legs, slots, LEG_FROM + 2);
    r.u.x = gather_row(legs, slots, LEG_U);
    r.u.y = gather_row(legs, slots, LEG_U + 1);
    r.u.z = gather_row(legs, slots, LEG_U + 2);
    r.bend = gather_row(legs, slots, LEG_BEND);
    r.pace = gather_row(legs, slots, LEG_PACE);
    r.range = gather_row(legs, slots, LEG_RANGE);
    r.arc = gather_row(legs, slots, LEG_ARC);
    r.across = gather_row(legs, slots, LEG_ACROSS);
    r.along = gather_row(legs, slots, LEG_ALONG);
    r.slope = gather_row(legs, slots, LEG_SLOPE);
    r.fan = R(1.0) / r.pace;
    return r;
}

/* The first leg of a ray that does not leave the sonar, of one lane; its layer and bend are found later. */
static void put_first_leg(__global float *legs, uint slot, const ray *r, real until, real before,
                          uint lane) {
    legs[leg_at(slot, LEG_FROM)] = AT(r->from.x, const float);
    legs[leg_at(slot, LEG_FROM + 1)] = AT(r->from.y, const float);
    legs[leg_at(slot, LEG_FROM + 2)] = AT(r->from.z, const float);
    legs[leg_at(slot, LEG_U)] = AT(r->u.x, const float);
    legs[leg_at(slot, LEG_U + 1)] = AT(r->u.y, const float);
    legs[leg_at(slot, LEG_U + 2)] = AT(r->u.z, const float);
    legs[leg_at(slot, LEG_PACE)] = AT(r->pace, const float);
    legs[leg_at(slot, LEG_RANGE)] = AT(r->range, const float);
    legs[leg_at(slot, LEG_ARC)] = AT(r->arc, const float);
    legs[leg_at(slot, LEG_ACROSS)] = AT(r->across, const float);
    legs[leg_at(slot, LEG_ALONG)] = AT(r->along, const float);
    legs[leg_at(slot, LEG_SLOPE)] = AT(r->slope, const float);
    legs[leg_at(slot, LEG_UNTIL)] = AT(until, float);
    legs[leg_at(slot, LEG_BEFORE)] = AT(before, float);
}

#endif

/* The rays that leave the sonar in SLOTS; through layers these are neighbours. */
static sonar_rays load_sonar_rays(__global const dev_ping *ping, __global const dev_ray *rays,
                                  __global const float *legs, natural slots) {
    sonar_rays s;
#if ASDIC_LAYERS
    __global const real *row = leg_rows(legs, ((const uint *)&slots)[0]);
    s.r = load_leg(row);
    s.sent.x = row[LEG_SENT];
    s.sent.y = row[LEG_SENT + 1];
    s.sent.z = row[LEG_SENT + 2];
    (void)ping;
    (void)rays;
#else
    s.r = ray_of_traced(sonar_of(ping), load_directions(rays, slots), medium_of(ping));
    s.sent = s.r.u;
    (void)legs;
#endif
    return s;
}

/* What ASDIC_WIDTH rays met: the nearest of mesh, bottom plane and surface. */
typedef struct meeting {
    real t;           /* along the ray (ray.h); INFINITY where nothing was met within its length */
    real traced;      /* where the tracer met it: rays that go on from there start clear of it */
    natural triangle; /* ~0u: none */
    natural kind;     /* DEV_KIND_* */
    triple facet;     /* unit normal of what was hit, either side: for areas */
    triple surface;   /* of the surface it stands for: for angles of scattering and reflection */
    real coherent_m2; /* flat area that reflects in phase */
    natural material;
} meeting;

#if ASDIC_HAS_MESH
/* One lane's facet: normals, flat area, kind, material. */
static void meet_facet(const world *w, uint triangle, vector at, meeting *m, uint lane) {
    __global const dev_triangle *t = w->triangles + triangle;
    __global const dev_part *part = w->parts + t->part;
    vector normal = smooth_normal(t, at);
    AT(m->facet.x, float) = t->normal[0];
    AT(m->facet.y, float) = t->normal[1];
    AT(m->facet.z, float) = t->normal[2];
    AT(m->surface.x, float) = normal.x;
    AT(m->surface.y, float) = normal.y;
    AT(m->surface.z, float) = normal.z;
    AT(m->coherent_m2, float) = smooth_flat_m2(t, w->ping->wavelength_m, part->size_m2);
    AT(m->kind, uint) = part->kind;
    AT(m->material, uint) = part->material;
}

/* Whether the side from P to Q, seen from the ray, leaves it outside by more than SKIN. */
static bool is_beyond(vector p, vector q, vector normal, float skin) {
    vector side = vector_add(q, vector_scale(p, -1.0f));
    float out = -vector_dot(vector_cross(p, q), normal);
    return out > 0.0f && out * out > skin * skin * vector_dot(side, side);
}

/* Tracers widen triangles by a little of their size (TRACE_TOLERANCE), so that those of a long side stick out past a
 * body's end. Whether the ray along U meets T there, at P beyond an edge by more than coordinates and RANGE are
 * rounded, where the mesh bends to the side that the ray comes from: nobody sees that, and it would return as a whole
 * wall does. */
static bool is_lip(__global const dev_triangle *t, vector p, vector u, float range) {
    vector normal = vector_of(t->normal[0], t->normal[1], t->normal[2]);
    float away = vector_dot(normal, u);
    uint rims = (away > 0.0f ? t->rims : t->rims >> 3) & 7u;
    if (rims == 0u) {
        return false;
    }
    vector a = vector_of(t->v0[0] - p.x, t->v0[1] - p.y, t->v0[2] - p.z);
    vector b = vector_of(t->v1[0] - p.x, t->v1[1] - p.y, t->v1[2] - p.z);
    vector c = vector_of(t->v2[0] - p.x, t->v2[1] - p.y, t->v2[2] - p.z);
    float most = max(max(fabs(p.x), fabs(p.y)), max(fabs(p.z), range));
    float skin = 2.0f * TRACE_SKIN * most / fabs(away);
    return ((rims & 1u) != 0u && is_beyond(a, b, normal, skin)) ||
           ((rims & 2u) != 0u && is_beyond(b, c, normal, skin)) ||
           ((rims & 4u) != 0u && is_beyond(c, a, normal, skin));
}

#if ASDIC_BENT
/* T at which the rays meet the planes of their triangles, which are flat only before they are lifted. */
static real meet_flat(const world *w, const meeting *m, const ray *r) {
    triple corner = ray_point(r, m->t), normal = {R(0.0), R(0.0), R(1.0)};
    LANES {
        uint triangle = AT(m->triangle, const uint);
        if (triangle != 0xffffffffu) {
            __global const dev_triangle *t = w->triangles + triangle;
            AT(corner.x, float) = t->v0[0];
            AT(corner.y, float) = t->v0[1];
            AT(corner.z, float) = t->v0[2];
            AT(normal.x, float) = t->normal[0];
            AT(normal.y, float) = t->normal[1];
            AT(normal.z, float) = t->normal[2];
        }
    }
    return ray_onto(r, m->t, corner, normal);
}
#endif
#endif

/* Takes the mesh hits in SLOTS, of the rays R, and the planes; nothing beyond LIMIT counts. */
static meeting meet(const world *w, __global const dev_hit *hits, natural slots, const ray *r,
                    real limit) {
    meeting m;
    real uz = r->u.z, drop = r->from.z - (real)(w->ping->origin[2]); /* below the sonar */
    m.t = m.traced = (real)(INFINITY);
    m.triangle = (natural)(0xffffffffu);
    m.kind = (natural)(DEV_KIND_NONE);
    m.material = (natural)(w->ping->bottom_material);
    m.facet.x = m.facet.y = R(0.0);
    m.facet.z = R(-1.0);
    m.surface = m.facet;
    m.coherent_m2 = (real)(ASDIC_PLANE_M2);
#if ASDIC_HAS_MESH
    LANES {
        dev_hit hit = hits[AT(slots, uint)];
        AT(m.triangle, uint) = hit.triangle;
        if (hit.triangle != 0xffffffffu) {
            AT(m.t, float) = hit.t_m;
        }
    }
    m.traced = m.t;
#if ASDIC_BENT
    m.t = meet_flat(w, &m, r);
#endif
    triple at = ray_point(r, m.t), along = ray_direction(r, m.t);
    LANES {
        uint triangle = AT(m.triangle, uint);
        if (triangle != 0xffffffffu && is_lip(w->triangles + triangle, lane_of(&at, lane),
                                              lane_of(&along, lane), AT(m.t, float))) {
            AT(m.triangle, uint) = triangle = 0xffffffffu;
            AT(m.t, float) = AT(m.traced, float) = INFINITY;
        }
        if (triangle != 0xffffffffu) {
            meet_facet(w, triangle, lane_of(&at, lane), &m, lane);
        }
    }
#endif
    real down = ray_to_plane((real)(w->ping->bottom_m) - drop, uz, r->bend);
    mask plane = down < m.t;
    m.t = choose(plane, down, m.t);
    m.kind = choose_natural(plane, (natural)(DEV_KIND_BOTTOM), m.kind);
    m.material = choose_natural(plane, (natural)(w->ping->bottom_material), m.material);
    real up = ray_to_plane((real)(w->ping->surface_m) + drop, -uz, -r->bend);
    mask surface = up < m.t;
    m.t = choose(surface, up, m.t);
    m.kind = choose_natural(surface, (natural)(DEV_KIND_SURFACE), m.kind);
    m.material = choose_natural(surface, (natural)(w->ping->surface_material), m.material);
    mask flat = plane | surface;
    m.traced = choose(flat, m.t, m.traced);
    m.triangle = choose_natural(flat, (natural)(0xffffffffu), m.triangle);
    m.facet.x = choose(flat, R(0.0), m.facet.x);
    m.facet.y = choose(flat, R(0.0), m.facet.y);
    m.facet.z = choose(flat, R(-1.0), m.facet.z);
    m.surface.x = choose(flat, R(0.0), m.surface.x);
    m.surface.y = choose(flat, R(0.0), m.surface.y);
    m.surface.z = choose(flat, R(-1.0), m.surface.z);
    m.coherent_m2 = choose(flat, (real)(ASDIC_PLANE_M2), m.coherent_m2);
    mask far = m.t > limit;
    m.kind = choose_natural(far, (natural)(DEV_KIND_NONE), m.kind);
    m.t = choose(far, (real)(INFINITY), m.t);
    return m;
}

/* The scattering laws' coefficients of what was met, lane by lane. */
typedef struct law_lanes {
    mask is_table, is_searay, is_facet, is_course; /* which law */
    real formula[4];                               /* as dev_material */
    real reflection2, roughness_g;
    real density_ratio, index, loss_ratio;
    natural strength, reflected; /* tables */
    real coherent_area_m2;
} law_lanes;

static law_lanes laws_met(const world *w, const meeting *m) {
    law_lanes l;
    natural law = (natural)(DEV_LAW_TABLE);
    l.formula[0] = l.formula[1] = l.formula[2] = l.formula[3] = R(1.0);
    l.reflection2 = l.roughness_g = R(0.0);
    l.density_ratio = l.index = R(1.0);
    l.loss_ratio = R(0.0);
    l.strength = l.reflected = (natural)(0u);
    LANES {
        __global const dev_material *c =
            (__global const dev_material *)w->materials + AT(m->material, const uint);
        AT(law, uint) = c->law;
        AT(l.formula[0], float) = c->formula[0];
        AT(l.formula[1], float) = c->formula[1];
        AT(l.formula[2], float) = c->formula[2];
        AT(l.formula[3], float) = c->formula[3];
        AT(l.reflection2, float) = c->reflection2;
        AT(l.roughness_g, float) = c->roughness_g;
        AT(l.density_ratio, float) = c->density_ratio;
        AT(l.index, float) = c->index;
        AT(l.loss_ratio, float) = c->loss_ratio;
        AT(l.strength, uint) = c->strength;
        AT(l.reflected, uint) = c->reflected;
    }
    mask met = m->kind != DEV_KIND_NONE;
    l.is_table = met & (law == DEV_LAW_TABLE);
    l.is_searay = met & (law == DEV_LAW_SEARAY);
    l.is_facet = met & (law == DEV_LAW_FACET);
    l.is_course = met & (law == DEV_LAW_COURSE);
    l.coherent_area_m2 = choose(l.formula[1] > R(0.0), l.formula[1], m->coherent_m2);
    return l;
}

/* A grazing angle. Near normal incidence its sine does not hold the squared cosine in single
 * precision, where a plate's lobe is 1e-5 wide. */
typedef struct slant {
    real sine, cos2;
} slant;

/* Mean-square slope of a facet; RANGE limits the area that reflects in phase. */
static real slope_ms(const law_lanes *l, real wavelength, real range) {
    return facet_slope_ms(l->formula[0], l->coherent_area_m2, wavelength, r_max(range, R(1e-3)));
}

/* s(Theta), linear, 1/sr; RANGE limits the area that reflects in phase. */
static real strength(const world *w, const law_lanes *l, slant a, real range) {
    real s = R(0.0);
    if (any_true(l->is_searay)) {
        real f = bottom_backscatter_lin(l->formula[1], l->formula[2], l->formula[0], a.sine);
        s = choose(l->is_searay, f, s);
    }
    if (any_true(l->is_facet)) {
        real slope = slope_ms(l, (real)(w->ping->wavelength_m), range);
        real f = facet_strength_angle_lin(a.sine, a.cos2, l->reflection2, l->roughness_g, slope);
        s = choose(l->is_facet, f, s);
    }
    if (any_true(l->is_course)) {
        real f = surface_backscatter_angle_lin(l->formula[0], l->formula[1], l->formula[2],
                                               l->formula[3], a.sine, a.cos2);
        s = choose(l->is_course, f, s);
    }
    if (any_true(l->is_table)) {
        real f = law_table_lin(w->materials, l->strength, a.sine, a.cos2);
        s = choose(l->is_table, f, s);
    }
    return s;
}

/* Sine of the grazing angle between a direction and the facet that was met: what turns the ray's
 * cross-section into area. Never 0; on an object at least 1e-3, which leaves out less than 1e-3 of
 * its area and bounds the weight of rays that touch its limb. */
static real grazing(const meeting *m, triple u) {
    real s = r_abs(dot3(m->facet, u));
    mask object = (m->kind == DEV_KIND_OBJECT);
    return r_max(r_min(s, R(1.0)), choose(object, R(1e-3), R(1e-9)));
}

/* The grazing angle on the surface that the facet stands for, which scattering laws ask for. Where that
 * surface faces away although the facet does not, it counts as seen edge on. */
static slant surface_slant(const meeting *m, triple u) {
    real s = dot3(m->surface, u);
    s = choose(dot3(m->facet, u) < R(0.0), -s, s);
    triple across = cross3(m->surface, u);
    slant a;
    a.sine = r_max(r_min(s, R(1.0)), R(1e-6));
    a.cos2 = r_min(dot3(across, across), R(1.0));
    return a;
}

/* The wavelength at which a flat piece returns along MIDDLE, half the sum of the directions of two ways, what it passes on
 * from one to the other: longer by the cosine of half the angle between both (R. E. Kell, "On the derivation of bistatic
 * RCS from monostatic measurements", Proc. IEEE 53, 983 (1965)). In the mirror direction that makes (A cos i / lambda)^2
 * of a plate's (A / lambda)^2, as physical optics does. */
static real bistatic_wavelength(const world *w, triple middle) {
    real cos2_half = r_min(r_max(dot3(middle, middle), R(1e-6)), R(1.0));
    return (real)(w->ping->wavelength_m) / sqrt(cos2_half);
}

/* The strength of M for what comes IN and goes OUT, where the strengths towards both are S_IN and S_OUT; MIDDLE: as above.
 * Laws but that of facets do not tell: theirs is the mean in decibels, which is right for Lambert's. */
static real strength_between(const world *w, const law_lanes *l, const meeting *m, slant in,
                             real s_in, slant out, real s_out, triple middle, real range) {
    real s = sqrt(s_in * s_out);
    if (any_true(l->is_facet)) {
        real unit2 = R(1.0) / r_max(dot3(middle, middle), R(1e-12));
        triple across = cross3(m->surface, middle);
        real slope = slope_ms(l, bistatic_wavelength(w, middle), range);
        real f = facet_strength_between_lin(
            in.sine, out.sine, r_abs(dot3(m->surface, middle)) * sqrt(unit2),
            dot3(across, across) * unit2, l->reflection2, l->roughness_g, slope);
        s = choose(l->is_facet, f, s);
    }
    return s;
}

/* Share of the arriving energy that goes on in the mirror direction. Objects mirror by the law of the
 * facet alone, bottom and surface by any law where boundaries are mirrors. */
static real mirrored(const world *w, const law_lanes *l, const meeting *m, slant a) {
    mask object = (m->kind == DEV_KIND_OBJECT);
    real facet = mirror_share(a.sine, l->reflection2, l->roughness_g);
    real share = choose(l->is_facet & object, facet, R(0.0));
    if (w->ping->boundary_mirrors != 0u) {
        real bottom = fluid_reflection2(a.sine, l->density_ratio, l->index);
        bottom = mirror_share(a.sine, bottom, l->roughness_g);
        share = choose(l->is_facet | l->is_course, facet, share);
        share = choose(l->is_searay & (m->kind == DEV_KIND_BOTTOM), bottom, share);
        mask table = l->is_table & (m->kind != DEV_KIND_OBJECT);
        if (any_true(table)) {
            real f = law_table_lin(w->materials, l->reflected, a.sine, a.cos2);
            share = choose(table, f, share);
        }
    }
    return share;
}

/* A direction of the world in the frame of a face. */
static triple in_face(__global const float *rows, triple u) {
    triple v = {rows[0] * u.x + rows[1] * u.y + rows[2] * u.z,
                rows[3] * u.x + rows[4] * u.y + rows[5] * u.z,
                rows[6] * u.x + rows[7] * u.y + rows[8] * u.z};
    return v;
}

/* One-way gain of an aperture towards a world direction. */
static real gain_towards(__global const dev_ping *ping, __global const dev_beam *beam, real ux,
                         real uy, real uz) {
    triple u = {ux, uy, uz}, v = in_face(beam->rows, u);
    return beam_pattern_lin(v.x, v.y, v.z, (real)(beam->length_h_wl), (real)(beam->length_v_wl),
                            (real)(ping->rear_lin));
}

/* An echo, split over at most two neighbouring bins. */
typedef struct split_echo {
    natural bin;
    real first, second; /* energies in bin and bin + 1, relative to TL d^2 at their centres */
} split_echo;

/* A FOOTPRINT in range on what M met, no longer than is harmless. Near normal incidence it is cut: it would leak from
 * the peak there into neighbouring bins. */
static real held_footprint(__global const dev_ping *ping, const meeting *m, real footprint,
                           real sin_grazing) {
    real most = (real)(ping->bin_m) * (R(0.5) - R(0.4) * sin_grazing * sin_grazing);
    return r_min(footprint, choose(m->kind == DEV_KIND_OBJECT, R(0.1), most));
}

/*
 * An echo of ENERGY (relative to TL d^2 at its range) AT a range, spread evenly over FOOTPRINT metres
 * of range, at most half a bin. NEAREST is the nearest that such an echo can come from: the footprint
 * ends there. What falls before the blanking or beyond the range is lost, which lets echoes from just
 * beyond give their part.
 */
static split_echo split(__global const dev_ping *ping, real at, real nearest, real energy,
                        real footprint) {
    split_echo e;
    real bin = (real)(ping->bin_m), end = (real)(ping->range_m);
    real range = r_min(at, end + bin);
    real half_width = R(0.5) * r_min(footprint, R(0.5) * bin);
    real lo = r_max(range - half_width, nearest), hi = range + half_width;
    natural last = (natural)(ping->bins - 1u);
    mask point = hi - lo < R(1e-5); /* rounding of ranges would show */
    e.bin = min(to_natural(choose(point, range, lo) / bin), last);
    real edge = (to_real(e.bin) + R(1.0)) * bin;
    real begin = r_max(lo, (real)(ping->blanking_m));
    real first = r_max(r_min(hi, edge) - begin, R(0.0)) / (hi - lo);
    real second = r_max(r_min(hi, end) - r_max(edge, begin), R(0.0)) / (hi - lo);
    mask received = (at >= (real)(ping->blanking_m)) & (at <= end);
    first = choose(point, choose(received, R(1.0), R(0.0)), first);
    second = choose(point, R(0.0), second);
    range = r_max(range, R(1e-3));
    real minus_2k = (real)(-2.0f * ping->absorption_np_per_m);
    e.first = energy * first * ray_relative_loss(minus_2k, range, edge - R(0.5) * bin);
    e.second = energy * second * ray_relative_loss(minus_2k, range, edge + R(0.5) * bin);
    return e;
}

/* How much of its last bin's water a ray has crossed when it meets something (or the range ends): its
 * part of the bin's integral, ray_water. */
static real crossed_part(__global const dev_ping *ping, __global const float *volume_inverse,
                         real range, natural bin_index) {
    real bin = (real)(ping->bin_m);
    real center = (to_real(bin_index) + R(0.5)) * bin;
    real begin = r_max(center - R(0.5) * bin, (real)(ping->blanking_m));
    begin = r_max(begin, R(1e-6));
    real inverse = R(0.0);
    LANES {
        AT(inverse, float) = volume_inverse[AT(bin_index, uint)];
    }
    real minus_2k = (real)(-2.0f * ping->absorption_np_per_m);
    return r_min(ray_water_part(minus_2k, begin, range, center) * inverse, R(1.0));
}

/* Where the water of ASDIC_WIDTH rays ends, and how much of the last bin's they cross: crossed_part. */
typedef struct water_end {
    natural last;
    real part;
} water_end;

static water_end find_water_end(__global const dev_ping *ping, __global const float *volume_inverse,
                                real range) {
    real reach = (real)(ping->range_m), end = r_min(range, reach);
    water_end e;
    e.last = min(to_natural(end / (real)(ping->bin_m)), (natural)(ping->bins - 1u));
    e.part = choose(range >= reach, R(1.0), crossed_part(ping, volume_inverse, end, e.last));
    return e;
}

/* Starts to bring the triangles that HITS from FIRST to END met into the cache, where the compiler is known to know
 * how: of a large mesh no cache holds them, and to wait for one after the other takes longer than to shade. */
static inline void fetch_met(const world *w, __global const dev_hit *hits, uint first, uint end) {
#if ASDIC_HAS_MESH && ASDIC_WIDTH > 1 && defined(__clang__) &&                                     \
    (defined(__x86_64__) || defined(__aarch64__))
    for (uint i = first; i < end; i++) {
        if (hits[i].triangle != ~0u) {
            __global const char *at = (__global const char *)&w->triangles[hits[i].triangle];
            __builtin_prefetch(at);
            __builtin_prefetch(at + sizeof(dev_triangle) - 1);
        }
    }
#endif
}

#endif
