/*
 * Scatterers of a coherent ping: where they are (coherent_place), what of them is seen, and what they send back
 * (coherent_shade).
 */
#include "coherent.h"
#include "echo.h"
#include "facet_form.h"

/* Rays end before a scatterer by what a tracer may err (TRACE_SKIN): facets that touch its own do not hide it, and the
 * far side of a sheet is hidden. Those to points end sooner, so that a point on a body's skin is seen, as in sim/points.c. */
#define SHORT_OF_POINT 0.9999f

/* A point of a patch as fractions of its edges. */
static float2 fractions_of(__global const dev_patch *patch, uint k) {
    float u = (float)(lattice_first(patch->start[0], k) >> 8) * 5.9604645e-8f;
    float v = (float)(lattice_second(patch->start[1], k) >> 8) * 5.9604645e-8f;
    bool beyond = patch->folded != 0u && u + v > 1.0f;
    return beyond ? (float2)(1.0f - u, 1.0f - v) : (float2)(u, v);
}

/* The middle of the k-th of the equal triangles that a smooth patch falls into; the third: -1 of one upside down. Row by
 * row: 2 (side - row) - 1 triangles, every other one upside down. */
static float3 grid_of(__global const dev_patch *patch, uint k) {
    uint side = (uint)(sqrt((float)(patch->count)) + 0.5f);
    float step = 1.0f / (float)(side);
    uint row = 0u;
    while (k >= 2u * (side - row) - 1u) {
        k -= 2u * (side - row) - 1u;
        row++;
    }
    bool over = (k & 1u) != 0u;
    float third = over ? 2.0f / 3.0f : 1.0f / 3.0f;
    return (float3)(((float)(k / 2u) + third) * step, ((float)(row) + third) * step,
                    over ? -1.0f : 1.0f);
}

/* A vector whose lanes agree as one number: elementary functions are of vectors. */
static float lane_0(real x) {
    return ((float *)&x)[0];
}

/* Number K of a shell of water, in the scene frame; the fourth: its share. By azimuth they are evenly spaced; by elevation as
 * dense as 1 / (1 + (pi L z)^2), the envelope of what hears them, L wavelengths tall; by elevation and range numbers of a
 * lattice (inverse powers of the plastic number), so that they are even in three dimensions. With 3.5 in a resolution cell its
 * energy varies by some 1 % (variance). What lies behind is heard by a leak, or by way of a mirror. */
static float4 in_water_of(__global const dev_ping *ping, __global const dev_patch *patch, uint k) {
    const float unit = 5.9604645e-8f; /* 2^-24 */
    __global const float *rows = beams_of(ping)->rows;
    float tall = M_PI_F * patch->corner[2], most = lane_0(atan2((real)(tall), R(1.0)));
    float raised = (float)((patch->start[0] + k * 0xC13FA9A9u) >> 8) * unit;
    float depth = (float)((patch->start[1] + k * 0x91E10DA5u) >> 8) * unit;
    float aside = ((float)(k) + 0.5f) / (float)(patch->count);
    real turn = (real)((2.0f * raised - 1.0f) * most);
    float z = lane_0(sin(turn)) / (tall * lane_0(cos(turn)));
    z = min(max(z, -1.0f), 1.0f);
    float solid = 2.0f * most / tall * (1.0f + tall * tall * z * z);
    float phi = patch->corner[1] + aside * patch->edge1[1], across = sqrt((1.0f - z) * (1.0f + z));
    float range = patch->corner[0] + depth * patch->edge1[0];
    float x = range * across * lane_0(cos((real)(phi))),
          y = range * across * lane_0(sin((real)(phi)));
    z *= range;
    return (float4)(ping->origin[0] + rows[0] * x + rows[3] * y + rows[6] * z,
                    ping->origin[1] + rows[1] * x + rows[4] * y + rows[7] * z,
                    ping->origin[2] + rows[2] * x + rows[5] * y + rows[8] * z,
                    patch->share * solid);
}

/* Where a patch's k-th scatterer is, in the scene frame; the fourth: its share, below 0 of a smooth one upside down. */
static float4 scatterer_of(__global const dev_ping *ping, __global const dev_patch *patch, uint k) {
    if (patch->kind == DEV_KIND_WATER) {
        return in_water_of(ping, patch, k);
    }
    float3 at =
        patch->form == DEV_FORM_FACE ? grid_of(patch, k) : (float3)(fractions_of(patch, k), 1.0f);
    at = patch->form == DEV_FORM_EDGE
             ? (float3)(((float)(k) + 0.5f) / (float)(patch->count), 0.0f, 1.0f)
             : at;
    at = patch->kind == DEV_KIND_POINT ? (float3)(0.0f, 0.0f, 1.0f) : at;
    return (float4)(patch->corner[0] + at.x * patch->edge1[0] + at.y * patch->edge2[0],
                    patch->corner[1] + at.x * patch->edge1[1] + at.y * patch->edge2[1],
                    patch->corner[2] + at.x * patch->edge1[2] + at.y * patch->edge2[2],
                    at.z * patch->share);
}

/* From an edge straight into its face. */
static vector inwards_of(__global const dev_patch *patch) {
    vector along = vector_of(patch->edge1[0], patch->edge1[1], patch->edge1[2]);
    vector in = vector_of(patch->edge2[0], patch->edge2[1], patch->edge2[2]);
    float share = vector_dot(in, along) / max(vector_dot(along, along), 1e-30f);
    return vector_add(in, vector_scale(along, -share));
}

/* An edge at P is seen where the face is, an eighth of a wavelength in, or of the way to its middle. */
static vector seen_of_edge(__global const dev_ping *ping, __global const dev_patch *patch,
                           float4 p) {
    vector in = inwards_of(patch), at = vector_of(p.x, p.y, p.z);
    float deep = sqrt(vector_dot(in, in));
    vector middle =
        vector_of(patch->corner[0] + patch->edge2[0], patch->corner[1] + patch->edge2[1],
                  patch->corner[2] + patch->edge2[2]);
    float share = 0.125f * min(ping->wavelength_m / max(deep, 1e-30f), 1.0f);
    return vector_add(at, vector_scale(vector_add(middle, vector_scale(at, -1.0f)), share));
}

/* One work-item per patch. OWNER: the patch of every slot; slots beyond the last scatterer have none. */
__kernel void coherent_place(__global const dev_ping *ping, __global const dev_coherent *c,
                             __global const dev_patch *patches, __global float4 *places,
                             __global uint *owner, __global dev_ray *rays) {
    uint at = (uint)(get_global_id(0));
    if (at >= c->patches) {
        return;
    }
    __global const dev_patch *patch = patches + at;
    for (uint k = 0; k < patch->count; k++) {
        uint slot = patch->first + k;
        float4 p = scatterer_of(ping, patch, k);
        places[slot] = p;
        owner[slot] = at;
#if ASDIC_HAS_MESH
        vector seen =
            patch->form == DEV_FORM_EDGE ? seen_of_edge(ping, patch, p) : vector_of(p.x, p.y, p.z);
        vector d = vector_of((seen.x - ping->origin[0]) - c->low[0],
                             (seen.y - ping->origin[1]) - c->low[1],
                             (seen.z - ping->origin[2]) - c->low[2]);
        float range = sqrt(vector_dot(d, d)), unit = 1.0f / max(range, 1e-9f);
        vector o = vector_of(ping->origin[0], ping->origin[1], ping->origin[2]);
        float skin = TRACE_SKIN * (2.0f * sqrt(vector_dot(o, o)) + range);
        dev_ray ray;
        for (int axis = 0; axis < 3; axis++) {
            ray.origin[axis] = ping->origin[axis];
        }
        ray.direction[0] = d.x * unit;
        ray.direction[1] = d.y * unit;
        ray.direction[2] = d.z * unit;
        ray.t_max = patch->kind == DEV_KIND_POINT ? SHORT_OF_POINT * range : range - skin;
        ray.source = slot;
        rays[slot] = ray;
#endif
    }
}

/* ---- What scatterers send back ---- */

/* Whether points at height Z lie in the water that the sonar is in. */
static mask in_water(__global const dev_ping *ping, real z) {
    real below = z - (real)(ping->origin[2]); /* the sonar */
    mask sunk = (below <= (real)(ping->bottom_m)) & (-below <= (real)(ping->surface_m));
    return sunk;
}

/* Patches of ASDIC_WIDTH scatterers, as formulas ask for them. */
typedef struct found {
    meeting m;
    natural kind, key0, key1, number;
    natural plane;  /* that mirrors: DEV_KIND_*; 0: none */
    mask out, back; /* which leg goes by way of it */
    mask there, smooth, edge;
    real share, pieces;
    real at_face;            /* how deep what is seen of it lies */
    triple at, edge1, edge2; /* of an edge, edge2: of length 1, straight into the face */
} found;

static found find(const world *w, __global const dev_coherent *c, __global const dev_patch *patches,
                  __global const float4 *places, __global const uint *owner,
                  __global const dev_hit *hits, uint slot) {
    found f;
    f.m.t = f.m.traced = R(0.0);
    f.m.triangle = (natural)(0xffffffffu);
    f.m.kind = (natural)(DEV_KIND_NONE);
    f.m.facet.x = f.m.facet.y = R(0.0);
    f.m.facet.z = R(-1.0);
    f.m.surface = f.m.facet;
    f.m.coherent_m2 = (real)(ASDIC_PLANE_M2);
    f.m.material = (natural)(w->ping->bottom_material);
    LANES {
        bool there = slot + lane < c->slots;
        uint way = (there ? slot + lane : slot) / c->scatterers;
        uint at = (there ? slot + lane : slot) - way * c->scatterers;
        uint leg = (way + DEV_MIRROR_WAYS - 1u) % DEV_MIRROR_WAYS; /* way 0 is straight */
        AT(f.plane, uint) = way == 0u ? 0u : c->mirrored[(way - 1u) / DEV_MIRROR_WAYS];
        AT(f.out, int) = way != 0u && leg != 0u ? -1 : 0;
        AT(f.back, int) = way != 0u && leg != 1u ? -1 : 0;
        __global const dev_patch *patch = patches + owner[at];
        float4 p = places[at];
        AT(f.at.x, float) = p.x;
        AT(f.at.y, float) = p.y;
        AT(f.at.z, float) = p.z;
        AT(f.at_face, float) = p.z;
        AT(f.share, float) = p.w;
        AT(f.kind, uint) = patch->kind;
        AT(f.key0, uint) = patch->key[0];
        AT(f.key1, uint) = patch->key[1];
        AT(f.number, uint) = at - patch->first;
        AT(f.smooth, int) = patch->form != DEV_FORM_ROUGH ? -1 : 0;
        AT(f.edge, int) = patch->form == DEV_FORM_EDGE ? -1 : 0;
        AT(f.pieces, float) = (float)(patch->count);
        AT(f.edge1.x, float) = patch->edge1[0];
        AT(f.edge1.y, float) = patch->edge1[1];
        AT(f.edge1.z, float) = patch->edge1[2];
        AT(f.edge2.x, float) = patch->edge2[0];
        AT(f.edge2.y, float) = patch->edge2[1];
        AT(f.edge2.z, float) = patch->edge2[2];
        if (patch->form == DEV_FORM_EDGE) {
            vector seen = seen_of_edge(w->ping, patch, p), in = inwards_of(patch);
            float unit = 1.0f / max(sqrt(vector_dot(in, in)), 1e-30f);
            AT(f.edge2.x, float) = unit * in.x;
            AT(f.edge2.y, float) = unit * in.y;
            AT(f.edge2.z, float) = unit * in.z;
            AT(f.at_face, float) = seen.z;
        }
        AT(f.m.triangle, uint) = patch->triangle;
        if (patch->kind <= DEV_KIND_OBJECT) {
            AT(f.m.kind, uint) = patch->kind;
            AT(f.m.material, uint) = patch->kind == DEV_KIND_SURFACE ? w->ping->surface_material
                                                                     : w->ping->bottom_material;
        }
#if ASDIC_HAS_MESH
        uint hit = hits[at].triangle;
        there = there && (hit == 0xffffffffu || hit == patch->triangle);
        if (patch->triangle != 0xffffffffu) {
            meet_facet(w, patch->triangle, vector_of(p.x, p.y, p.z), &f.m, lane);
        }
#else
        (void)hits;
#endif
        AT(f.there, int) = there ? -1 : 0;
    }
#if ASDIC_WIDTH == 1
    f.there = f.there != 0;
    f.out = f.out != 0;
    f.back = f.back != 0;
    f.smooth = f.smooth != 0;
    f.edge = f.edge != 0;
#endif
    return f;
}

/* What single precision leaves of a point's place. */
static triple left_over(const found *f) {
    mask point = f->kind == DEV_KIND_POINT;
    triple rest = {choose(point, f->edge1.x, R(0.0)), choose(point, f->edge1.y, R(0.0)),
                   choose(point, f->edge1.z, R(0.0))};
    return rest;
}

/* From the sonar to scatterers. */
typedef struct sight {
    two range;
    triple u;
} sight;

/* The image of AT in the planes that mirror. */
static triple image_of(__global const dev_ping *ping, const found *f, triple at) {
    real surface = (real)(ping->origin[2] - ping->surface_m);
    real bottom = (real)(ping->origin[2] + ping->bottom_m);
    real plane = choose(f->plane == DEV_KIND_SURFACE, surface, bottom);
    triple image = at;
    image.z = choose(f->plane != 0u, R(2.0) * plane - at.z, at.z);
    return image;
}

/* From the sonar to AT, of which single precision leaves REST. */
static sight see(__global const dev_ping *ping, __global const dev_coherent *c, triple at,
                 triple rest) {
    two x = two_sum(at.x, (real)(-ping->origin[0])), y = two_sum(at.y, (real)(-ping->origin[1])),
        z = two_sum(at.z, (real)(-ping->origin[2]));
    two lx = {rest.x - c->low[0], R(0.0)}, ly = {rest.y - c->low[1], R(0.0)},
        lz = {rest.z - c->low[2], R(0.0)};
    x = two_add(x, lx);
    y = two_add(y, ly);
    z = two_add(z, lz);
    sight s;
    s.range = two_length(x, y, z);
    real unit = R(1.0) / r_max(s.range.high, R(1e-9));
    s.u.x = x.high * unit;
    s.u.y = y.high * unit;
    s.u.z = z.high * unit;
    return s;
}

/* The scattering strength without the lobe that smooth pieces make themselves. */
static real rough_strength(const world *w, const found *f, const law_lanes *laws, slant met_out,
                           slant met, triple middle, real range) {
    real s_out = strength(w, laws, met_out, range), s_in = strength(w, laws, met, range);
    real s = strength_between(w, laws, &f->m, met_out, s_out, met, s_in, middle, range);
    real diffuse = laws->reflection2 * facet_diffuse_lin(met_out.sine, met.sine, laws->roughness_g);
    return choose(laws->is_facet & (laws->formula[0] <= R(0.0)), diffuse, s);
}

static two choose_two(mask which, two a, two b) {
    two out = {choose(which, a.high, b.high), choose(which, a.low, b.low)};
    return out;
}

static sight choose_sight(mask which, const sight *a, const sight *b) {
    sight s;
    s.range = choose_two(which, a->range, b->range);
    s.u.x = choose(which, a->u.x, b->u.x);
    s.u.y = choose(which, a->u.y, b->u.y);
    s.u.z = choose(which, a->u.z, b->u.z);
    return s;
}

/* As a scatterer meets it, the direction of a leg that leaves the sonar along U; MIRRORED, a plane has turned
 * it over. */
static triple met_along(triple u, mask mirrored_leg) {
    triple met = u;
    met.z = choose(mirrored_leg, -u.z, u.z);
    return met;
}

/* Half the sum of both legs' directions: the phase along a piece goes with it. */
static triple mean_of_legs(triple out, triple back) {
    triple mean = {R(0.5) * (out.x + back.x), R(0.5) * (out.y + back.y), R(0.5) * (out.z + back.z)};
    return mean;
}

/* Where the phase psi = 2 k U.p goes on over a flat face, U the mean of both legs' directions and U_t what of it lies in the
 * face, the face's integral is that over its edges,
 *
 *     integral of exp(-i psi) dS = i integral of (grad psi . n) / |grad psi|^2 exp(-i psi) dl
 *                                = i lambda / (4 pi) integral of (U.n) / |U_t|^2 exp(-i psi) dl,
 *
 * N out of the face; times cos i / lambda, of spherical waves, it is the boundary diffraction wave (K. Miyamoto, E. Wolf,
 * "Generalization of the Maggi-Rubinowicz theory of the boundary diffraction wave", J. Opt. Soc. Am. 52, 615 (1962); of plane
 * waves W. B. Gordon, see facet_form.h), without what a mirror returns where U_t = 0, which must be far. No wavelength is left in
 * it: it holds whatever the pulse. This is (U.n) cos i / |U_t|^2, n inwards, by RANGE. */
static real edge_size(const found *f, triple u, real range) {
    real length2 = r_max(dot3(f->edge1, f->edge1), R(1e-30));
    real inwards = dot3(u, f->edge2), along = dot3(u, f->edge1);
    real flat2 = r_max(inwards * inwards + along * along / length2, R(1e-12));
    return inwards * r_abs(dot3(u, f->m.facet)) / (flat2 * r_max(range, R(1e-3)));
}

/* What a smooth piece sends by U, the mean of both legs' directions, to RANGE, of its area re a wavelength (physical optics: the
 * integral of cos i exp(-2 i k r) / lambda over the piece, whose phase goes evenly); of an edge, re its length, what stands for
 * the area that it is a border of. */
static phasor piece_size(const found *f, triple u, real range, real wavelength_m) {
    real per_m = R(2.0) / wavelength_m, turns = per_m / sqrt(f->pieces);
    turns = choose(f->share < R(0.0), -turns, turns);
    real least = R(1e-4) / r_max(range, R(1e-3)); /* edge-on: others are told re the middle */
    phasor size = {R(0.0), R(0.0)};
    if (any_true(f->edge == 0)) {
        real wide = r_max(r_abs(dot3(u, f->m.facet)) / r_max(range, R(1e-3)), least);
        size = triangle_form(dot3(f->edge1, u) * turns, dot3(f->edge2, u) * turns);
        size.re *= wide;
        size.im *= wide;
    }
    if (any_true(f->edge)) {
        real along = dot3(f->edge1, u) * per_m / f->pieces;
        real edge = edge_size(f, u, range) * near_sinc(along * along);
        edge = choose(r_abs(edge) < least, choose(edge < R(0.0), -least, least), edge);
        size.re = choose(f->edge, R(0.0), size.re);
        size.im = choose(f->edge, edge * wavelength_m / (R(-4.0) * R_PI), size.im);
    }
    return size;
}

/* The same to the end of the line HALF_M from its middle, where BACK leads from; OUT is the other leg. */
static phasor piece_size_from(const found *f, triple out, triple back, real range, triple line,
                              real half_m, real wavelength_m) {
    triple to = {back.x * range - half_m * line.x, back.y * range - half_m * line.y,
                 back.z * range - half_m * line.z};
    real length = sqrt(r_max(dot3(to, to), R(1e-6))), unit = R(1.0) / length;
    triple u = {to.x * unit, to.y * unit, to.z * unit};
    return piece_size(f, mean_of_legs(out, u), length, wavelength_m);
}

/* How a smooth piece is met: its pressure re a point of 1 m2, and how that goes on at elements along the line and over the band,
 * as tilt, bend and rise of dev_echo say. */
typedef struct smooth_view {
    phasor form;
    real tilt, bend, rise;
} smooth_view;

/* What of SIZE turns with MIDDLE is more than that, re it. */
static real more_than(phasor middle, phasor size) {
    real square = middle.re * middle.re + middle.im * middle.im;
    return (size.re * middle.re + size.im * middle.im) / square - R(1.0);
}

/* Roughness takes exp(-g cos^2 i) of its energy. */
static smooth_view view_smooth(const world *w, __global const dev_coherent *c, const found *f,
                               const law_lanes *laws, slant met, triple out, triple back,
                               real range) {
    real half_m = (real)(0.5f * (float)(max(c->elements, 2u) - 1u) * c->spacing_m);
    real wavelength_m = (real)(w->ping->wavelength_m);
    triple line = {(real)(c->rows[3]), (real)(c->rows[4]), (real)(c->rows[5])};
    line = met_along(line, f->back);
    phasor middle = piece_size(f, mean_of_legs(out, back), range, wavelength_m);
    smooth_view v;
    /* One after the other, each with a direction of its own: graphics cards have the registers for one. */
    phasor there = piece_size_from(f, out, back, range, line, -half_m, wavelength_m);
    real to_port = more_than(middle, there);
    there = piece_size_from(f, out, back, range, line, half_m, wavelength_m);
    real to_starboard = more_than(middle, there);
    v.tilt = R(0.5) * (to_starboard - to_port) / half_m;
    v.bend = R(0.5) * (to_starboard + to_port) / (half_m * half_m);
    /* At the middle, of a frequency a fiftieth higher, re the same area. */
    const real higher = R(1.02);
    there = piece_size_from(f, out, back, range, line, R(0.0), wavelength_m / higher);
    real slope = (higher * (more_than(middle, there) + R(1.0)) - R(1.0)) / (higher - R(1.0));
    v.rise = slope * wavelength_m / (R(4.0) * R_PI * (real)(c->pulse_m));
    real amplitude = r_abs(f->share) * range / wavelength_m * sqrt(laws->reflection2) *
                     exp(R(-0.5) * laws->roughness_g * met.sine * met.sine);
    v.form.re = amplitude * middle.re;
    v.form.im = amplitude * middle.im;
    return v;
}

/* What the plane that mirrors makes of a pressure along U, where a leg goes BY way of it: the surface, soft, turns its
 * sign, a fluid bottom its phase. */
static phasor mirror_factor(const world *w, const found *f, mask by, triple u) {
    mask surface = f->plane == DEV_KIND_SURFACE;
    meeting m = f->m;
    m.kind = f->plane;
    m.triangle = (natural)(0xffffffffu);
    m.facet.x = m.facet.y = R(0.0);
    m.facet.z = R(-1.0);
    m.surface = m.facet;
    m.material = choose_natural(surface, (natural)(w->ping->surface_material),
                                (natural)(w->ping->bottom_material));
    law_lanes laws = laws_met(w, &m);
    slant a = surface_slant(&m, u);
    real amplitude = sqrt(mirrored(w, &laws, &m, a));
    phasor turn = fluid_reflection_phase(a.sine, laws.density_ratio, laws.index, laws.loss_ratio);
    mask turns = (surface == 0) & (laws.density_ratio > R(0.0));
    turn.re = choose(turns, turn.re, choose(surface, R(-1.0), R(1.0)));
    turn.im = choose(turns, turn.im, R(0.0));
    phasor out = {choose(by, amplitude * turn.re, R(1.0)), choose(by, amplitude * turn.im, R(0.0))};
    return out;
}

/* The pressure of a face of these sides towards V of its own frame, re on-axis: side lobes have their signs. */
static real pressure_towards(triple v, real length_h_wl, real length_v_wl, real rear_lin) {
    real size = sqrt(beam_pattern_lin(v.x, v.y, v.z, length_h_wl, length_v_wl, rear_lin));
    return size * sinc_sign(length_h_wl * v.y) * sinc_sign(length_v_wl * v.z);
}

/* Those of transmitter and element, out and back. */
static real lobes_towards(const world *w, __global const dev_coherent *c, triple out, triple back) {
    real rear = (real)(w->ping->rear_lin);
    return pressure_towards(in_face(w->beams->rows, out), (real)(w->beams->length_h_wl),
                            (real)(w->beams->length_v_wl), rear) *
           pressure_towards(in_face(c->rows, back), (real)(c->element_h_wl),
                            (real)(c->element_v_wl), rear);
}

/* Where a point is seen that was seen by S and has moved by STEP. */
static triple seen_moved(const sight *s, triple step) {
    real unit = R(1.0) / r_max(s->range.high, R(1e-3)), along = dot3(s->u, step);
    triple u = {s->u.x + unit * (step.x - along * s->u.x),
                s->u.y + unit * (step.y - along * s->u.y),
                s->u.z + unit * (step.z - along * s->u.z)};
    return u;
}

/* LOBES change along the face that an edge stands for: the next term of the integral by parts (edge_size) has their slope,
 *
 *     A + A1,  A1 = -i grad A . U_t / (2 k |U_t|^2);
 *
 * A1 / (i A), by a difference of a fiftieth of a lobe either way. */
static real lobes_slope(const world *w, __global const dev_coherent *c, const found *f,
                        const sight *sent, const sight *heard, real lobes) {
    triple mean = mean_of_legs(met_along(sent->u, f->out), met_along(heard->u, f->back));
    real across = dot3(mean, f->m.facet);
    triple flat = {mean.x - across * f->m.facet.x, mean.y - across * f->m.facet.y,
                   mean.z - across * f->m.facet.z};
    real flat2 = r_max(dot3(flat, flat), R(1e-9));
    real sent_wl = r_max((real)(w->beams->length_h_wl), (real)(w->beams->length_v_wl));
    real heard_wl = r_max((real)(c->element_h_wl), (real)(c->element_v_wl));
    real share =
        R(0.02) * heard->range.high / (r_max(r_max(sent_wl, heard_wl), R(1.0)) * sqrt(flat2));
    real change = R(0.0);
    for (int side = -1; side <= 1; side += 2) {
        real by = (real)(side)*share;
        triple step = {by * flat.x, by * flat.y, by * flat.z};
        change += (real)(side)*lobes_towards(w, c, seen_moved(sent, met_along(step, f->out)),
                                             seen_moved(heard, met_along(step, f->back)));
    }
    real slope =
        change / (R(2.0) * share * flat2) * (real)(w->ping->wavelength_m) / (R(4.0) * R_PI);
    return choose(f->edge & (r_abs(lobes) > R(1e-6)), -slope / lobes, R(0.0));
}

/* ASDIC_WIDTH slots a work-item. GATES: the gate of every slot. */
__kernel void coherent_shade(__global const dev_ping *ping, __global const dev_coherent *c,
                             __global const dev_patch *patches, __global const float4 *places,
                             __global const uint *owner, __global const dev_hit *hits,
                             __global const dev_triangle *triangles, __global const dev_part *parts,
                             __global const uint *materials, __global dev_echo *echoes,
                             __global uint *gates) {
    uint slot = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (slot >= c->slots) {
        return;
    }
    world w = {ping, beams_of(ping), triangles, parts, materials, 0};
    found f = find(&w, c, patches, places, owner, hits, slot);
    triple rest = left_over(&f), turned = {rest.x, rest.y, -rest.z};
    sight straight = see(ping, c, f.at, rest);
    sight image = see(ping, c, image_of(ping, &f, f.at), turned);
    sight sent = choose_sight(f.out, &image, &straight);
    sight heard_from = choose_sight(f.back, &image, &straight);
    law_lanes laws = laws_met(&w, &f.m);
    triple out = met_along(sent.u, f.out), back = met_along(heard_from.u, f.back);
    slant met_out = surface_slant(&f.m, out), met = surface_slant(&f.m, back);
    real range = heard_from.range.high;
    triple mean = mean_of_legs(out, back);
    real energy = rough_strength(&w, &f, &laws, met_out, met, mean, range) * f.share;
    energy = choose(f.kind == DEV_KIND_POINT, f.share, energy);
    /* Water's share is an angle as seen straight: an image has the same volume. */
    real tube = (real)(c->water_lin) * f.share * straight.range.high * straight.range.high;
    energy = choose(f.kind == DEV_KIND_WATER, tube, energy);
    met.sine = R(0.5) * (met_out.sine + met.sine);
    smooth_view mirror = {{R(0.0), R(0.0)}, R(0.0), R(0.0), R(0.0)};
    if (any_true(f.smooth)) {
        mirror = view_smooth(&w, c, &f, &laws, met, out, back, range);
    }
    real amplitude = choose(f.smooth, R(1.0), sqrt(energy));

    /* The transmitter and an element, and the loss of both ways. */
    triple v = in_face(c->rows, heard_from.u);
    real k = (real)(ping->absorption_np_per_m);
    real lobes = lobes_towards(&w, c, sent.u, heard_from.u);
    amplitude *= lobes;
    if (ASDIC_HAS_MESH && any_true(f.edge)) { /* else there are none */
        phasor with = {R(1.0), lobes_slope(&w, c, &f, &sent, &heard_from, lobes)};
        mirror.form = phasor_times(mirror.form, with);
    }
    amplitude *= sqrt(sqrt(ray_transmission(k, r_max(sent.range.high, R(1e-3))) *
                           ray_transmission(k, r_max(range, R(1e-3)))));
    phasor by = phasor_times(mirror_factor(&w, &f, f.out, sent.u),
                             mirror_factor(&w, &f, f.back, heard_from.u));

    random4 draw = {{f.number, f.key0, f.key1, (natural)(RANDOM_SCATTERER)}};
    draw = philox4x32(draw, ping->seed[0], ping->seed[1]);
    phasor chance = gaussian_of(draw.v[0], draw.v[1]);
    mask sure = f.smooth | (f.kind == DEV_KIND_POINT);
    chance.re = choose(f.smooth, mirror.form.re, choose(sure, R(1.0), chance.re));
    chance.im = choose(f.smooth, mirror.form.im, choose(sure, R(0.0), chance.im));
    two both = two_add(sent.range, heard_from.range);
    two turns = {(real)(c->turns_per_m), (real)(c->turns_per_m_low)};
    phasor way = phasor_times(phasor_of(-two_turns(both, turns)), by);
    real half_way = R(0.5) * both.high;

    mask plane = (f.m.triangle == 0xffffffffu) & (f.m.kind != DEV_KIND_NONE);
    /* Nothing goes through a facet, in on one side and out on the other. */
    mask one_side =
        (f.m.triangle == 0xffffffffu) | (dot3(f.m.facet, out) * dot3(f.m.facet, back) >= R(0.0));
    mask heard = f.there & one_side & (amplitude != R(0.0)) &
                 ((by.re != R(0.0)) | (by.im != R(0.0))) & (half_way >= (real)(ping->blanking_m)) &
                 (half_way < (real)(ping->range_m)) & (plane | in_water(ping, f.at_face)) &
                 ((f.plane == 0u) | (f.plane != f.m.kind));
    natural gate = to_natural(half_way / (real)(c->sample_m * DEV_GATE_SAMPLES));
    LANES {
        uint at = slot + lane;
        if (at < c->slots) {
            dev_echo e;
            e.y = AT(v.y, float) * AT(range, float);
            e.range_m = AT(range, float);
            e.way_m = AT(half_way, float);
            e.re = AT(amplitude, float) * (AT(chance.re, float) * AT(way.re, float) -
                                           AT(chance.im, float) * AT(way.im, float));
            e.im = AT(amplitude, float) * (AT(chance.re, float) * AT(way.im, float) +
                                           AT(chance.im, float) * AT(way.re, float));
            e.tilt = AT(f.smooth, int) != 0 ? AT(mirror.tilt, float) : 0.0f;
            e.bend = AT(f.smooth, int) != 0 ? AT(mirror.bend, float) : 0.0f;
            e.rise = AT(f.smooth, int) != 0 ? AT(mirror.rise, float) : 0.0f;
            echoes[at] = e;
            gates[at] = AT(heard, int) != 0 ? min(AT(gate, uint), c->gates - 1u) : NO_GATE;
        }
    }
}
