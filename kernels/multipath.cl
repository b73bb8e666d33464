/*
 * First-order multipath: what a mirror adds to a ping.
 *
 * A ray that meets an object O (or, where boundaries are mirrors, bottom or surface) at d1 goes on in
 * the mirror direction with the share mu = R^2 exp(-4 k^2 s^2 sin^2 Theta) of its energy and meets X
 * at d2. Two echoes come back:
 *
 *   same way, S-O-X-O-S, at range D = d1 + d2:
 *     E = mu^2 B_T B_R(ray) s_X dOmega / sin Theta_X D^-2 exp(-2 k (D - 1))
 *   across, S-O-X-S and S-X-O-S, at range D = (d1 + d2 + d3) / 2, if X is visible from S:
 *     E = mu [B_T(ray) B_R(X) + B_T(X) B_R(ray)] s_X(in, out) dOmega / sin Theta_X
 *         d3^-2 exp(-2 k (D - 1))
 *
 * The tube's outgoing spreading cancels against its area, so that only the return spreads. D^-2 is
 * for flat mirrors; at a curved one it becomes 1 / J (ray_mirror_gain). Facets tell s_X(in, out); of other laws it is
 * sqrt(s_X(in) s_X(out)), which is exact for Lambert's law. Of two facets that mirror both are O and X by turns, and share
 * one lobe (lobe_of_reverse).
 *
 * Through layers the way home is found by its launch elevation, and both echoes follow from cross-sections of tubes of
 * one steradian: A over O to X (mirrored_tube), A' from X straight to the sonar. With q the sound speed at X over that
 * at the sonar and L the length of all legs, D^-2 becomes q^2 / A, d3^-2 becomes 1 / A', and k is counted along L.
 */
#include "intersect.h"
#include "leg.h"
#include "mirror_ray.h"
#include "receive.h"
#include "ping_batch.h"

#if ASDIC_LAYERS

/* Steps of the search for a ray home, and by what such a ray may miss the sonar, m and of the distance. */
#define HOME_STEPS 12u
#define HOME_MISS R(2e-3)
#define HOME_MISS_FAR R(1e-5)

/* Where mirror rays and ways home lie, and the layers. */
typedef struct leg_sets {
    __global const float *bounced;
    __global float *returning;
    layer_stack layers;
} leg_sets;

/* A ray from X in the plane through the sonar, in direction U of unit length, at the sonar's distance. */
typedef struct way_home {
    ray r; /* its last leg */
    triple u;
    real t, miss; /* there; how far below the sonar it is */
    mask found;
} way_home;

/* The ray from X with sine and cosine of its elevation towards TOWARDS, ACROSS far. PACE: at X. */
static way_home try_home(const layer_stack *to, triple x, triple towards, real across, triple sonar,
                         real sine, real cosine, real pace) {
    way_home way;
    way.u.x = cosine * towards.x;
    way.u.y = cosine * towards.y;
    way.u.z = sine;
    natural layer;
    LANES {
        AT(layer, uint) = first_layer(to, AT(x.z, float), AT(sine, float));
    }
    ray_medium water = {planes_of(to, layer).bend, R(1.0)};
    way.r = ray_start(x, way.u, water);
    way.r.pace = pace;
    way.r.slope = R(1.0);
    way.r.fan = R(1.0) / pace;
    way.t = R(0.0);
    mask on = (mask)(-1);
    for (uint i = 0; i < LEG_MOST && any_true(on); i++) {
        leg_planes p = planes_of(to, layer);
        real below = to_below(&way.r, p.below), above = to_above(&way.r, p.above);
        real rest = (sonar.x - way.r.from.x) * towards.x + (sonar.y - way.r.from.y) * towards.y;
        real level = sqrt(way.r.u.x * way.r.u.x + way.r.u.y * way.r.u.y);
        real end = r_max(r_min(rest, across), R(0.0)) / r_max(level, R(1e-6));
        real t = r_min(below, above);
        mask over = on & (t < end), down = below <= above;
        way.t = choose(on, end, way.t);
        ray next = next_leg(&way.r, choose(over, t, R(0.0)), down, &p);
        way.r = choose_ray(over, &next, &way.r);
        natural beyond = choose_natural(down, layer + 1u, layer - 1u);
        layer = choose_natural(over, min(beyond, (natural)(to->count - 1u)), layer);
        on = over;
    }
    way.miss = ray_point(&way.r, way.t).z - sonar.z;
    way.found = (on == 0) & (r_abs(way.miss) < HOME_MISS + HOME_MISS_FAR * across);
    return way;
}

/* Newton's method on the launch elevation: at the sonar's distance a ray is W / cos(theta) lower by radian. A step that
 * does not come nearer is cut. Only ways that are WANTED are searched for; of several home this is one near the straight
 * line. */
static way_home find_home(const layer_stack *to, triple x, triple sonar, real pace, mask wanted) {
    triple apart = {sonar.x - x.x, sonar.y - x.y, sonar.z - x.z};
    real across = r_max(sqrt(apart.x * apart.x + apart.y * apart.y), R(1e-6));
    triple towards = {apart.x / across, apart.y / across, R(0.0)};
    real chord = sqrt(across * across + apart.z * apart.z);
    real sine = apart.z / chord, cosine = across / chord, step = R(0.0);
    way_home best = try_home(to, x, towards, across, sonar, sine, cosine, pace);
    for (uint i = 0; i < HOME_STEPS && any_true(wanted & (best.found == 0)); i++) {
        triple u = ray_direction(&best.r, best.t);
        real level = sqrt(u.x * u.x + u.y * u.y);
        real width = best.r.along + best.r.slope * best.t;
        width = choose(width < R(0.0), r_min(width, R(-1e-3)), r_max(width, R(1e-3)));
        real newton = r_min(r_max(-best.miss * level / width, R(-0.2)), R(0.2));
        step = choose(step == R(0.0), newton, step);
        real s = sine + step * (cosine - R(0.5) * step * sine);
        s = r_min(r_max(s, R(-0.9999999)), R(0.9999999));
        real c = sqrt((R(1.0) - s) * (R(1.0) + s));
        way_home next = try_home(to, x, towards, across, sonar, s, c, pace);
        mask nearer = (best.found == 0) & (r_abs(next.miss) < r_abs(best.miss));
        best.r = choose_ray(nearer, &next.r, &best.r);
        best.u.x = choose(nearer, next.u.x, best.u.x);
        best.u.y = choose(nearer, next.u.y, best.u.y);
        best.u.z = choose(nearer, next.u.z, best.u.z);
        best.t = choose(nearer, next.t, best.t);
        best.miss = choose(nearer, next.miss, best.miss);
        best.found |= nearer & next.found;
        sine = choose(nearer, s, sine);
        cosine = choose(nearer, c, cosine);
        step = choose(nearer, R(0.0), R(0.3) * step);
    }
    return best;
}

#else

static ray load_rays(__global const dev_ray *rays, natural slots, ray_medium water) {
    triple at;
    LANES {
        __global const float *from = rays[AT(slots, uint)].origin;
        AT(at.x, float) = from[0];
        AT(at.y, float) = from[1];
        AT(at.z, float) = from[2];
    }
    return ray_of_traced(ray_unlift(at, water), load_directions(rays, slots), water);
}

#endif

/* How far the mirror rays in SLOTS go; 0: there is none. */
static real reach_of(__global const dev_ray *bounced, natural slots) {
    real limit;
    LANES {
        AT(limit, float) = bounced[AT(slots, uint)].t_max;
    }
    return limit;
}

/* What the mirror rays R in SLOTS met up to LIMIT. */
static meeting meet_bounced(const world *w, __global const dev_hit *hits, natural slots,
                            const ray *r, real limit) {
    meeting m = meet(w, hits, slots, r, limit);
    mask off = limit <= R(0.0);
    m.kind = choose_natural(off, (natural)(DEV_KIND_NONE), m.kind);
    return m;
}

#if ASDIC_HAS_MESH
/* How far from an edge, of a triangle's size, its rim may begin: bent rays meet triangles a little aside. */
#define RIM (ASDIC_BENT ? 10.0f * TRACE_TOLERANCE : TRACE_TOLERANCE)

/* Whether P, in the plane of T, is at or beyond an edge. */
static bool is_on_rim(__global const dev_triangle *t, vector normal, vector p) {
    vector a = vector_of(t->v0[0] - p.x, t->v0[1] - p.y, t->v0[2] - p.z);
    vector b = vector_of(t->v1[0] - p.x, t->v1[1] - p.y, t->v1[2] - p.z);
    vector c = vector_of(t->v2[0] - p.x, t->v2[1] - p.y, t->v2[2] - p.z);
    float u = vector_dot(vector_cross(b, c), normal), v = vector_dot(vector_cross(c, a), normal);
    float w = vector_dot(vector_cross(a, b), normal);
    return min(min(u, v), w) < RIM * (u + v + w);
}
#endif

/* Forgets what the mirror rays R from SLOT on met of their mirror's own part only because tracers give triangles a rim
 * (intersect.h): mirror and target are both met there, or one of them and their sides are not the same. A convex body
 * shows nothing of itself. SONAR_HITS: of the sonar's rays. */
static void forget_rims(const world *w, __global const dev_ray *bounced,
                        __global const dev_hit *sonar_hits, __global dev_hit *hits, const ray *r,
                        uint slot) {
#if ASDIC_HAS_MESH
    real t;
    LANES {
        bool met = bounced[slot + lane].source != NO_RAY && hits[slot + lane].triangle != NO_RAY;
        AT(t, float) = met ? hits[slot + lane].t_m : 0.0f;
    }
    triple at = ray_point(r, t), going = ray_direction(r, t);
    LANES {
        uint source = bounced[slot + lane].source; /* NO_RAY is a plane's, too */
        uint from =
            source & MIRROR_IS_PLANE ? NO_RAY : sonar_hits[source & MIRROR_SLOT_MASK].triangle;
        uint to = hits[slot + lane].triangle;
        if (from == NO_RAY || to == NO_RAY || AT(t, float) <= 0.0f) {
            continue;
        }
        __global const dev_triangle *a = w->triangles + from, *b = w->triangles + to;
        vector left = vector_of(a->normal[0], a->normal[1], a->normal[2]);
        vector reached = vector_of(b->normal[0], b->normal[1], b->normal[2]);
        float out = vector_dot(left, lane_of(&r->u, lane));
        bool through = out * vector_dot(reached, lane_of(&going, lane)) > 0.0f;
        int rims =
            is_on_rim(a, left, lane_of(&r->from, lane)) + is_on_rim(b, reached, lane_of(&at, lane));
        if (a->part == b->part && rims > (through ? 0 : 1)) {
            hits[slot + lane].triangle = NO_RAY;
        }
    }
#else
    (void)w;
    (void)bounced;
    (void)sonar_hits;
    (void)hits;
    (void)r;
    (void)slot;
#endif
}

#if ASDIC_LAYERS

/* Appends the ways back of the mirror rays from SLOT on to RETURNING from AT on; the next AT. */
static uint connect_rays(const world *w, __global const dev_ray *bounced,
                         __global const dev_hit *sonar_hits, __global dev_hit *hits,
                         const leg_sets *sets, __global dev_ray *returning, uint slot, uint at) {
    natural slots = slots_from(slot);
    __global const real *row = leg_rows(sets->bounced, slot);
    ray r = load_leg(row);
    forget_rims(w, bounced, sonar_hits, hits, &r, slot);
    real there = reach_of(bounced, slots);
    real limit = choose(there > R(0.0), ray_at_range(&r, row[LEG_UNTIL]), R(0.0));
    meeting m = meet_bounced(w, hits, slots, &r, limit);
    mask met = m.kind != DEV_KIND_NONE;
    if (!any_true(met)) {
        return at;
    }
    real t2 = choose(met, m.t, R(0.0)), range = ray_range(&r, t2);
    real along = dot3(m.facet, ray_direction(&r, t2));
    triple x = clear_of(w, ray_point(&r, choose(met, m.traced, R(0.0))), m.facet,
                        choose(along > R(0.0), R(-1.0), R(1.0)));
    real pace = r.pace / bent_at(&r, t2).q;
    way_home home = find_home(&sets->layers, x, sonar_of(w->ping), pace, met);
    real d3 = ray_range(&home.r, home.t);
    mask faces = dot3(home.u, m.facet) * along < R(0.0);
    mask near = range + d3 < (real)(2.0002f * w->ping->reach_m);
    real t_max = choose(home.found & faces & near, R(1.0), R(0.0));
    ray first = home.r;
    first.from = x;
    first.u = home.u;
    first.pace = pace;
    first.range = first.arc = first.across = first.along = R(0.0);
    first.slope = R(1.0);
    LANES {
        if (AT(met, int) != 0) {
            put_first_leg(sets->returning, at, &first, d3 * R(0.9999), d3, lane);
            returning[at++] = lane_ray(&x, &home.u, t_max, slot + lane, lane);
        }
    }
    return at;
}

#else

/* Appends the ways back of the mirror rays from SLOT on to RETURNING from AT on; the next AT. */
APART static uint connect_rays(const world *w, __global const dev_ray *bounced,
                               __global const dev_hit *sonar_hits, __global dev_hit *hits,
                               __global const float4 *mirrors, __global dev_ray *returning,
                               uint slot, uint at) {
    natural slots = slots_from(slot);
    real d1;
    LANES {
        AT(d1, float) = bounced[slot + lane].source == NO_RAY ? 0.0f : mirrors[slot + lane].y;
    }
    ray_medium water = medium_of(w->ping);
    ray r = load_rays(bounced, slots, water);
    forget_rims(w, bounced, sonar_hits, hits, &r, slot);
    meeting m = meet_bounced(w, hits, slots, &r, reach_of(bounced, slots));
    mask met = m.kind != DEV_KIND_NONE;
    if (!any_true(met)) {
        return at;
    }
    real t2 = choose(met, m.t, R(0.0)), d2 = ray_range(&r, t2);
    real along = dot3(m.facet, ray_direction(&r, t2));
    triple x = clear_of(w, ray_point(&r, choose(met, m.traced, R(0.0))), m.facet,
                        choose(along > R(0.0), R(-1.0), R(1.0)));
    ray_way home = ray_between(x, sonar_of(w->ping), water, R(1e-6));
    triple from = ray_lift(x, water), along_it = ray_traced(&home.r, water);
    /* Both legs at X must be on one side of it. */
    mask faces = dot3(home.r.u, m.facet) * along < R(0.0);
    /* What comes back across from beyond the range is not received; let rounding pass. */
    mask near = d1 + d2 + ray_range(&home.r, home.t) < (real)(2.0002f * w->ping->reach_m);
    real t_max = choose(faces & near, home.t * R(0.9999), R(0.0));
    LANES {
        if (AT(met, int) != 0) {
            returning[at++] = lane_ray(&from, &along_it, t_max, slot + lane, lane);
        }
    }
    return at;
}

#endif

/*
 * connect: from every X back to the sonar, to learn whether it is visible. The ray starts off X on
 * the side the mirror ray came from and ends just short of the sonar. One work-item per piece.
 */
__kernel void LEAST_WAVES(3)
    connect(__global const dev_ping *pings, __global const dev_ray *bounced,
            __global const dev_hit *sonar_hits, __global dev_hit *hits,
            __global const dev_triangle *triangles, __global const dev_part *parts,
            __global const uint *materials, __global const float4 *mirrors,
            __global dev_ray *returning, __global const dev_layer *layers, uint count,
            __global const float *bounced_legs, __global float *returning_legs) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    bounced += own;
    sonar_hits += own;
    hits += own;
    mirrors += own;
    returning += own;
    uint first = (uint)(get_global_id(0)) * PIECE, at = first;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, 0};
#if ASDIC_LAYERS
    leg_sets sets = {bounced_legs + DEV_LEG_FLOATS * own,
                     returning_legs + DEV_LEG_FLOATS * own,
                     {layers, count}};
    (void)mirrors;
#else
    (void)layers;
    (void)count;
    (void)bounced_legs;
    (void)returning_legs;
#endif
    for (uint slot = first; slot < end && bounced[slot].source != NO_RAY;
         slot = slot_after(slot, ASDIC_WIDTH, end)) {
#if ASDIC_LAYERS
        at = connect_rays(&w, bounced, sonar_hits, hits, &sets, returning, slot, at);
#else
        at = connect_rays(&w, bounced, sonar_hits, hits, mirrors, returning, slot, at);
#endif
    }
    end_piece(returning, at, end);
}

typedef struct bounce_store {
    __global const dev_ray *rays, *bounced, *returning;
    __global const dev_hit *hits, *bounced_hits, *returning_hits;
    __global const float *solid_angles, *splats;
    __global const float4 *mirrors;
    __global const float *legs, *bounced_legs, *returning_legs;
} bounce_store;

/* What the kernel bounce makes echoes from: the way over a mirror to X, and that from X home. MIRROR: as mirror_store. */
typedef struct bounce_way {
    natural mirrors, slots;
    mask on;
    real mirror[4];
    meeting m;
    triple u, v, x, back; /* directions: sent, at X in and out, at the sonar in reverse */
    real sin_grazing;     /* of V */
    real same_range, cross_range;
    real same, cross; /* losses, relative to TL d^2 of these ranges, same without share */
} bounce_way;

/* The losses of a ray R by way of a mirror and of HOME, which end at T2 and T3; see above. */
#if ASDIC_LAYERS
static void follow_bounces(const world *w, const bounce_store *store, uint slot, bounce_way *way) {
    __global const dev_ping *ping = w->ping;
    ray r = gather_leg(store->bounced_legs, way->mirrors);
    real until = gather_row(store->bounced_legs, way->mirrors, LEG_UNTIL);
    real before = gather_row(store->bounced_legs, way->mirrors, LEG_BEFORE);
    way->m = meet_bounced(w, store->bounced_hits, way->mirrors, &r, ray_at_range(&r, until));
    mask met = way->on & (way->m.kind != DEV_KIND_NONE);
    real t2 = choose(met, way->m.t, R(0.0));
    bent_place at = bent_at(&r, t2);
    real range = ray_range(&r, t2), q = at.q / r.pace, minus_2k = -2.0f * ping->absorption_np_per_m;
    real arc = r.arc + bent_arc(&r, &at);
    way->v = ray_direction(&r, t2);
    way->sin_grazing = r_max(grazing(&way->m, way->v), ray_least_grazing(&r));
    real tube = mirrored_tube(&r, t2, before, way->mirror[1], way->mirror[2], way->mirror[3]);
    tube = r_max(tube, (real)(BENT_CAUSTIC)*range * range * q);
    way->same_range = range;
    way->same = range * range * q * q / tube * exp(minus_2k * (arc - range));

    __global const real *row = leg_rows(store->returning_legs, slot);
    ray home = load_leg(row);
    real d3 = row[LEG_BEFORE], t3 = ray_at_range(&home, d3);
    mask clear = met;
    LANES {
        dev_ray back = store->returning[slot + lane];
        AT(way->x.x, float) = back.direction[0];
        AT(way->x.y, float) = back.direction[1];
        AT(way->x.z, float) = back.direction[2];
        AT(clear, int) = back.t_max > 0.0f ? AT(clear, int) : 0;
#if ASDIC_HAS_MESH
        AT(clear, int) = store->returning_hits[slot + lane].triangle == NO_RAY ? AT(clear, int) : 0;
#endif
    }
    real drop = home.from.z - (real)(ping->origin[2]);
    clear &= ray_to_plane((real)(ping->bottom_m) - drop, home.u.z, home.bend) > t3;
    clear &= ray_to_plane((real)(ping->surface_m) + drop, -home.u.z, -home.bend) > t3;
    bent_place end = bent_at(&home, t3);
    /* Widths across are counted from c at the sonar, and these rays start with c at X. */
    real tube_home = bent_across(&home, t3) * bent_along(&home, t3) * r.pace / at.q;
    way->cross_range = R(0.5) * (range + d3);
    real length = R(0.5) * (arc + home.arc + bent_arc(&home, &end));
    real loss = way->cross_range * way->cross_range / r_max(tube_home, R(1e-6));
    loss *= exp(minus_2k * (length - way->cross_range));
    way->cross_range = choose(clear, way->cross_range, range);
    way->cross = choose(clear, loss, R(0.0));
    triple back = ray_back(&home, t3);
    way->back.x = choose(clear, back.x, way->x.x);
    way->back.y = choose(clear, back.y, way->x.y);
    way->back.z = choose(clear, back.z, way->x.z);
}
#else
static void follow_bounces(const world *w, const bounce_store *store, uint slot, bounce_way *way) {
    ray_medium water = medium_of(w->ping);
    ray r = load_rays(store->bounced, way->mirrors, water);
    ray home = load_rays(store->returning, way->slots, water);
    way->x = home.u;
    way->m = meet_bounced(w, store->bounced_hits, way->mirrors, &r,
                          reach_of(store->bounced, way->mirrors));
    mask met = way->on & (way->m.kind != DEV_KIND_NONE);
    real t2 = choose(met, way->m.t, R(0.0)), d1 = way->mirror[1], d2 = ray_range(&r, t2);
    way->v = ray_direction(&r, t2);
    way->sin_grazing = r_max(grazing(&way->m, way->v), ray_least_grazing(&r));
    real visible = R(0.0), t3 = R(1.0);
    LANES {
        dev_ray back = store->returning[slot + lane];
        bool clear = back.t_max > 0.0f;
#if ASDIC_HAS_MESH
        clear = clear && store->returning_hits[slot + lane].triangle == 0xffffffffu;
#endif
        AT(visible, float) = clear ? 1.0f : 0.0f;
        AT(t3, float) = back.t_max > 0.0f ? back.t_max / 0.9999f : 1.0f;
    }
#if ASDIC_BENT
    /* An arc home may leave the water; it ends just short of the sonar. */
    real drop = home.from.z - (real)(w->ping->origin[2]), end = R(0.9999) * t3;
    mask in_water = ray_to_plane((real)(w->ping->bottom_m) - drop, home.u.z, home.bend) > end;
    in_water &= ray_to_plane((real)(w->ping->surface_m) + drop, -home.u.z, -home.bend) > end;
    visible = choose(in_water, visible, R(0.0));
#endif
    real d3 = ray_range(&home, t3);
    way->same_range = d1 + d2;
    way->cross_range = R(0.5) * (d1 + d2 + d3);
    real minus_2k = (real)(-2.0f * w->ping->absorption_np_per_m);
    real second_leg = sqrt(ray_bending(&r, t2, d2, minus_2k));
    way->same = second_leg * ray_mirror_gain(d1, d2, way->mirror[2], way->mirror[3]) * second_leg;
    /* split() works relative to TL d^2 at the echo's own range; this leg spreads over d3. */
    real ratio = way->cross_range / r_max(d3, R(1e-3));
    way->cross = visible * second_leg * ratio * ratio;
    way->cross *= sqrt(ray_bending(&home, t3, d3, minus_2k));
    way->back = ray_back(&home, t3);
}
#endif

/* Over what ranges the echoes of the two ways are spread, as those of the sonar's own rays are: else each bin would hear a
 * few mirror rays, where rays by way of a plane bring echoes as smooth as direct ones. Seen from the image of the sonar
 * a step SPLAT in elevation moves X by D splat (w - (w.n / v.n) v), w across v in its upright plane, and the way home by
 * what of that lies along it. Bending is left out: it is for smoothness alone. */
typedef struct bounce_footprint {
    real same, cross;
} bounce_footprint;

static bounce_footprint bounce_footprints(const world *w, const bounce_way *way, real splat) {
    real sin_grazing = way->sin_grazing;
    const triple *v = &way->v, *n = &way->m.facet;
    real level = sqrt(r_max((R(1.0) - v->z) * (R(1.0) + v->z), R(1e-12)));
    triple across = {-v->z * v->x / level, -v->z * v->y / level, level};
    real over = dot3(across, *n) / choose(dot3(*v, *n) < R(0.0), -sin_grazing, sin_grazing);
    real step = way->same_range * splat;
    real home = over * (dot3(*v, way->x) - R(1.0)) - dot3(across, way->x);
    bounce_footprint f;
    f.same = held_footprint(w->ping, &way->m, step * r_abs(over), sin_grazing);
    f.cross = held_footprint(w->ping, &way->m, R(0.5) * step * r_abs(home), sin_grazing);
    return f;
}

/* What the facet law asks of the mirrors on the WAY: whether they follow it, their slopes and flat areas. */
static law_lanes mirror_facets(const world *w, const bounce_store *store, const bounce_way *way) {
    law_lanes l;
    LANES {
        uint source = store->bounced[AT(way->mirrors, const uint)].source;
        uint material = source >> MIRROR_KIND_SHIFT == DEV_KIND_SURFACE ? w->ping->surface_material
                                                                        : w->ping->bottom_material;
        float flat_m2 = ASDIC_PLANE_M2;
#if ASDIC_HAS_MESH
        if ((source & MIRROR_IS_PLANE) == 0u) {
            uint triangle = store->hits[source & MIRROR_SLOT_MASK].triangle;
            __global const dev_triangle *t = w->triangles + triangle;
            __global const dev_part *part = w->parts + t->part;
            material = part->material;
            flat_m2 = smooth_flat_m2(t, w->ping->wavelength_m, part->size_m2);
        }
#endif
        __global const dev_material *c = (__global const dev_material *)w->materials + material;
        AT(l.is_facet, int) = c->law == DEV_LAW_FACET ? -1 : 0;
        AT(l.formula[0], float) = c->formula[0];
        AT(l.coherent_area_m2, float) = c->formula[1] > 0.0f ? c->formula[1] : flat_m2;
    }
    return l;
}

/* Half of what turns BEFORE into AFTER, both of unit length; bistatic_wavelength. */
static triple half_turn(triple after, triple before) {
    triple turn = {R(0.5) * (after.x - before.x), R(0.5) * (after.y - before.y),
                   R(0.5) * (after.z - before.z)};
    return turn;
}

/* What the LOBE of X over a mirror O loses to that of O over X: of two that mirror and have lobes, S-O-X-S is met twice,
 * with O as mirror and, in reverse, with X as one. TURN_O, TURN_X: half_turn at both. The wider lobe keeps more: a small
 * plate lights little of a wall, and the whole wall's lobe would tell too much. */
static real lobe_of_reverse(const world *w, const bounce_store *store, const bounce_way *way,
                            const law_lanes *x, triple turn_x, triple turn_o, real lobe) {
    law_lanes o = mirror_facets(w, store, way);
    real narrow = slope_ms(&o, bistatic_wavelength(w, turn_o), way->cross_range) /
                  slope_ms(x, bistatic_wavelength(w, turn_x), way->cross_range);
    mask mirrors = way->m.kind == DEV_KIND_OBJECT;
    mirrors |= (mask)(w->ping->boundary_mirrors != 0u ? -1 : 0);
    real square = narrow * narrow;
    return choose(o.is_facet & x->is_facet & mirrors, lobe * square / (R(1.0) + square), R(0.0));
}

/* The echoes of what ASDIC_WIDTH mirror rays met, by their ways back from SLOT on. */
APART static uint shade_bounces(const world *w, const bounce_store *store, const sink *to,
                                uint slot) {
    __global const dev_ping *ping = w->ping;
    real weight, splat;
    natural sources, targets;
    arrivals along, direct;
    bounce_way way;
    way.slots = slots_from(slot);
    LANES { /* the first lane is on; lanes that are off compute with its mirror ray */
        uint own = store->returning[slot + lane].source;
        uint mirror = own == NO_RAY ? store->returning[slot].source : own;
        float4 what = store->mirrors[mirror];
        uint source = store->bounced[mirror].source;
#if ASDIC_TRUTH
        uint kind = source >> MIRROR_KIND_SHIFT;
        AT(along.truth_row, uint) = kind == DEV_KIND_SURFACE  ? DEV_TRUTH_BY_SURFACE
                                    : kind == DEV_KIND_BOTTOM ? DEV_TRUTH_BY_BOTTOM
                                                              : 0u;
#endif
        bool plane = (source & MIRROR_IS_PLANE) != 0u;
        source &= MIRROR_SLOT_MASK;
#if ASDIC_LAYERS
        float step = store->bounced_legs[leg_at(mirror, LEG_SPLAT)];
#else
        float step = store->splats[source];
#endif
        AT(splat, float) = plane ? max(step, 0.0f) : 0.0f; /* faces.h: negative, where aimed */
        AT(way.on, int) = own == NO_RAY ? 0 : -1;
        AT(way.mirrors, uint) = mirror;
        AT(sources, uint) = source;
        AT(targets, uint) = own == NO_RAY ? NO_RAY : ray_in(ping, source);
        AT(way.mirror[0], float) = what.x;
        AT(way.mirror[1], float) = what.y;
        AT(way.mirror[2], float) = what.z;
        AT(way.mirror[3], float) = what.w;
        AT(weight, float) = store->solid_angles[source];
    }
#if ASDIC_LAYERS
    triple u = {gather_row(store->legs, sources, LEG_SENT),
                gather_row(store->legs, sources, LEG_SENT + 1),
                gather_row(store->legs, sources, LEG_SENT + 2)};
#else
    triple u = load_sonar_rays(ping, store->rays, 0, sources).sent;
#endif
    follow_bounces(w, store, slot, &way);
    law_lanes laws = laws_met(w, &way.m);
    mask met = way.on & (way.m.kind != DEV_KIND_NONE);
    real share = way.mirror[0];
    slant in = surface_slant(&way.m, way.v), out = surface_slant(&way.m, way.x);
    real s_in = strength(w, &laws, in, way.same_range);
    real s_out = strength(w, &laws, out, way.same_range);
    weight *= share / way.sin_grazing;
    real same = choose(met, weight * share * s_in * way.same, R(0.0));
    triple middle = half_turn(way.x, way.v);
    real between =
        strength_between(w, &laws, &way.m, in, s_in, out, s_out, middle, way.cross_range);
    real diffuse = laws.reflection2 * facet_diffuse_lin(in.sine, out.sine, laws.roughness_g);
    between -=
        lobe_of_reverse(w, store, &way, &laws, middle, half_turn(way.v, u), between - diffuse);
    real cross = choose(met, weight * between * way.cross, R(0.0));
    bounce_footprint spread = bounce_footprints(w, &way, splat);
    real nearest = way.same_range * way.sin_grazing;
    split_echo same_echo = split(ping, way.same_range, nearest, same, spread.same);
    nearest += (R(2.0) * way.cross_range - way.same_range) * out.sine;
    split_echo cross_echo = split(ping, way.cross_range, R(0.5) * nearest, cross, spread.cross);
    triple back = way.back;
    real ray_out = gain_towards(ping, w->beams, u.x, u.y, u.z);
    real x_out = gain_towards(ping, w->beams, back.x, back.y, back.z);
    /* What returns along the ray: the same-way echo, and the across echo sent towards X. */
    natural component = (natural)(DEV_DEPOSIT_MULTIPATH);
    along.count = direct.count = 0u;
#if ASDIC_TRUTH
    direct.truth_row = along.truth_row;
#endif
    split_echo sent_to_x = cross_echo, sent_to_mirror = cross_echo;
    sent_to_x.first *= x_out;
    sent_to_x.second *= x_out;
    sent_to_mirror.first *= ray_out;
    sent_to_mirror.second *= ray_out;
    same_echo.first *= ray_out;
    same_echo.second *= ray_out;
    arrivals_add_echo(w, &along, component, &same_echo);
    arrivals_add_echo(w, &along, component, &sent_to_x);
    arrivals_add_echo(w, &direct, component, &sent_to_mirror);
    return receive(w, to, DEV_ARRIVAL_ALONG, &along, targets, u) +
           receive(w, to, DEV_ARRIVAL_ACROSS, &direct, targets, back);
}

/* bounce: both kinds of echo. One work-item per piece. */
__kernel void LEAST_WAVES(3)
    bounce(__global const dev_ping *pings, __global const dev_ray *rays,
           __global const float *solid_angles, __global const float *splats,
           __global const dev_hit *hits, __global const dev_ray *bounced,
           __global const dev_hit *bounced_hits, __global const dev_ray *returning,
           __global const dev_hit *returning_hits, __global const float4 *mirrors,
           __global const dev_triangle *triangles, __global const dev_part *parts,
           __global const uint *materials, __global dev_arrival *arrivals,
           __global long *accumulator, __global uint *saturated, __global const dev_truth_row *rows,
           __global long *truth, __global const float *legs, __global const float *bounced_legs,
           __global const float *returning_legs) {
    __global const dev_ping *ping = row_ping(pings);
    size_t own = row_slots(ping);
    returning += own;
    uint first = (uint)(get_global_id(0)) * PIECE, cut = 0u;
    uint end = min(first + PIECE, batch_slots(ping));
    world w = {ping, beams_of(ping), triangles, parts, materials, 0};
    sink to = {row_cells(ping, accumulator), arrivals + ARRIVAL_SETS * own, truth_rows(ping, rows),
               truth + (size_t)(ping->sums.truth_first) * ping->sums.truth_columns};
    bounce_store store = {
        rays + own,           bounced + own,      returning,    hits + own,    bounced_hits + own,
        returning_hits + own, solid_angles + own, splats + own, mirrors + own, legs,
        bounced_legs,         returning_legs};
#if ASDIC_LAYERS
    store.legs += DEV_LEG_FLOATS * own;
    store.bounced_legs += DEV_LEG_FLOATS * own;
    store.returning_legs += DEV_LEG_FLOATS * own;
#endif
    for (uint slot = first; slot < end && returning[slot].source != NO_RAY;
         slot = slot_after(slot, ASDIC_WIDTH, end)) {
        cut += shade_bounces(&w, &store, &to, slot);
    }
    if (cut != 0u) {
        atomic_add(saturated + get_group_id(1), cut);
    }
}
