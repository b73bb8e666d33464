/*
 * A picture of the scene as a diver's lamp and the daylight would show it: one ray a pixel through
 * the hierarchy that sound uses, shaded, fogged by water, with the sonar's beams as light.
 *
 * Decoration, not physics: nothing here touches a level.
 */
#include "camera_types.h"
#include "vector.h"

static vector load3(__constant const float *p) {
    return vector_of(p[0], p[1], p[2]);
}

static vector mix3(vector a, vector b, float t) {
    return vector_add(vector_scale(a, 1.0f - t), vector_scale(b, t));
}

static vector mul3(vector a, vector b) {
    return vector_of(a.x * b.x, a.y * b.y, a.z * b.z);
}

static vector unit3(vector a) {
    return vector_scale(a, rsqrt(max(vector_dot(a, a), 1e-30f)));
}

static vector turn3(__constant const float *rows, vector v) {
    return vector_of(vector_dot(load3(rows), v), vector_dot(load3(rows + 3), v),
                     vector_dot(load3(rows + 6), v));
}

/* exp(-x) for x >= 0 to 5e-4, at a tenth of the price: a picture needs no more. */
static float fade(float x) {
    return 1.0f / (1.0f + x * (1.0f + x * (0.48f + x * 0.235f)));
}

/* Column and row of ray I: tiles from left to right, then down. Past the picture: clamped. */
static void pixel_of(__constant const dev_camera *c, uint i, uint *x, uint *y) {
    uint tiles = (c->width + DEV_CAMERA_TILE - 1) / DEV_CAMERA_TILE;
    uint tile = i / (DEV_CAMERA_TILE * DEV_CAMERA_TILE),
         in = i % (DEV_CAMERA_TILE * DEV_CAMERA_TILE);
    *x = tile % tiles * DEV_CAMERA_TILE + in % DEV_CAMERA_TILE;
    *y = tile / tiles * DEV_CAMERA_TILE + in / DEV_CAMERA_TILE;
}

static vector direction_of(__constant const dev_camera *c, uint x, uint y) {
    float u = (2.0f * ((float)x + 0.5f) / (float)c->width - 1.0f) * c->tan_x;
    float v = (2.0f * ((float)y + 0.5f) / (float)c->height - 1.0f) * c->tan_y;
    return unit3(vector_add(load3(c->ahead), vector_add(vector_scale(load3(c->right), u),
                                                        vector_scale(load3(c->down), v))));
}

__kernel void camera_rays(__constant dev_camera *c, __global dev_ray *rays) {
    uint i = (uint)get_global_id(0), x, y;
    pixel_of(c, i, &x, &y);
    vector d = direction_of(c, x, y);
    dev_ray ray;
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = c->eye[k];
    }
    ray.t_max = c->far_m;
    ray.direction[0] = d.x;
    ray.direction[1] = d.y;
    ray.direction[2] = d.z;
    ray.source = 0u;
    rays[i] = ray;
}

/* --- textures ----------------------------------------------------------------------------------- */

static float hash2(int x, int y) {
    uint h = (uint)x * 374761393u + (uint)y * 668265263u;
    h = (h ^ (h >> 13)) * 1274126177u;
    return (float)((h ^ (h >> 16)) & 0xffffu) * (1.0f / 65535.0f);
}

/* Smooth noise of unit cells, 0..1. */
static float noise2(float x, float y) {
    float fx = floor(x), fy = floor(y), u = x - fx, v = y - fy;
    int ix = (int)fx, iy = (int)fy;
    u = u * u * (3.0f - 2.0f * u);
    v = v * v * (3.0f - 2.0f * v);
    float top = mix(hash2(ix, iy), hash2(ix + 1, iy), u);
    float bottom = mix(hash2(ix, iy + 1), hash2(ix + 1, iy + 1), u);
    return mix(top, bottom, v);
}

/* 1 on a line of the grid, its width kept to about a pixel, fading where lines crowd. */
static float grid_line(float at, float step, float pixel_m) {
    float cell = at / step, away = fabs(cell - rint(cell)) * step;
    float half_m = max(0.5f * pixel_m, 0.03f);
    return (1.0f - smoothstep(half_m, half_m + pixel_m, away)) *
           (1.0f - smoothstep(0.03f, 0.15f, pixel_m / step));
}

/* --- what was met ------------------------------------------------------------------------------- */

typedef struct sight {
    float t;
    vector at, normal, albedo;
    int what; /* 0 nothing, 1 ground, 2 object, 3 sea surface, 4 vehicle */
} sight;

/* The body: a capsule along x from -length/2 to length/2, and a cross of fins at its stern. */
static void meet_body(__constant const dev_camera *c, vector d, sight *s) {
    vector from = load3(c->body_eye), dir = turn3(c->body_rows, d);
    float r = c->body_radius_m, half_m = 0.5f * c->body_length_m - r;
    float toward = vector_dot(from, dir), ball_m = half_m + 2.0f * r; /* fins included */
    if (vector_dot(from, from) - toward * toward > ball_m * ball_m) {
        return;
    }
    float a = dir.y * dir.y + dir.z * dir.z, b = from.y * dir.y + from.z * dir.z;
    float e = from.y * from.y + from.z * from.z - r * r, disc = b * b - a * e;
    float t = disc > 0.0f ? (-b - sqrt(disc)) / max(a, 1e-9f) : -1.0f;
    float along = from.x + t * dir.x;
    vector n = vector_of(0.0f, from.y + t * dir.y, from.z + t * dir.z);
    if (t < 0.0f || fabs(along) > half_m) { /* round ends */
        float cap = along > 0.0f || disc <= 0.0f ? half_m : -half_m;
        float gap = from.x - cap, b2 = gap * dir.x + b;
        float disc2 = b2 * b2 - (gap * gap + e);
        t = disc2 > 0.0f ? -b2 - sqrt(disc2) : -1.0f;
        along = from.x + t * dir.x;
        n = vector_of(along - cap, from.y + t * dir.y, from.z + t * dir.z);
    }
    vector paint =
        along > half_m - 0.6f * r ? vector_of(0.10f, 0.11f, 0.12f) : vector_of(1.0f, 0.74f, 0.10f);
    paint = fabs(along - 0.25f * half_m) < 0.10f * half_m ? vector_of(0.95f, 0.95f, 0.92f) : paint;
    for (int fin = 0; fin < 2; fin++) { /* planes y = 0 and z = 0 */
        float across = fin ? dir.y : dir.z, start = fin ? from.y : from.z;
        float tf = fabs(across) > 1e-6f ? -start / across : -1.0f;
        float x = from.x + tf * dir.x, high = fabs(fin ? from.z + tf * dir.z : from.y + tf * dir.y);
        float root = -half_m + 0.15f * half_m, tip = root - 0.25f * half_m;
        bool inside =
            x < root - 0.25f * (high - r) && x > tip - 0.1f * (high - r) && high < 2.6f * r;
        if (tf > 0.0f && inside && (t < 0.0f || tf < t)) {
            t = tf;
            n = fin ? vector_of(0.0f, 1.0f, 0.0f) : vector_of(0.0f, 0.0f, 1.0f);
            paint = vector_of(0.16f, 0.17f, 0.19f);
        }
    }
    if (t > 0.0f && t < s->t) {
        vector un = unit3(n);
        s->t = t;
        s->what = 4;
        s->albedo = paint;
        s->normal =
            vector_of(c->body_rows[0] * un.x + c->body_rows[3] * un.y + c->body_rows[6] * un.z,
                      c->body_rows[1] * un.x + c->body_rows[4] * un.y + c->body_rows[7] * un.z,
                      c->body_rows[2] * un.x + c->body_rows[5] * un.y + c->body_rows[8] * un.z);
    }
}

static void meet_planes(__constant const dev_camera *c, vector d, sight *s) {
    float floor_t = d.z > 1e-6f ? (c->bottom_z - c->eye[2]) / d.z : INFINITY;
    float roof_t = d.z < -1e-6f ? (c->surface_z - c->eye[2]) / d.z : INFINITY;
    if (floor_t > 0.0f && floor_t < s->t) {
        s->t = floor_t;
        s->what = 1;
        s->normal = vector_of(0.0f, 0.0f, -1.0f);
    }
    if (roof_t > 0.0f && roof_t < s->t) {
        s->t = roof_t;
        s->what = 3;
        s->normal = vector_of(0.0f, 0.0f, 1.0f);
    }
}

static sight look(__constant const dev_camera *c, vector d, dev_hit hit,
                  __global const dev_triangle *triangles, __global const dev_part *parts) {
    sight s;
    s.t = hit.triangle == ~0u ? INFINITY : hit.t_m;
    s.what = 0;
    s.normal = vector_of(0.0f, 0.0f, -1.0f);
    s.albedo = vector_of(0.0f, 0.0f, 0.0f);
    if (hit.triangle != ~0u) {
        __global const dev_triangle *tri = &triangles[hit.triangle];
        s.normal = vector_of(tri->normal[0], tri->normal[1], tri->normal[2]);
        s.what = parts[tri->part].kind == DEV_KIND_BOTTOM ? 1 : 2;
        float tone = 0.9f + 0.2f * hash2((int)tri->part, 7);
        s.albedo = vector_of(0.80f * tone, 0.76f * tone, 0.70f * tone);
    }
    meet_planes(c, d, &s);
    if (c->body_length_m > 0.0f) {
        meet_body(c, d, &s);
    }
    s.t = min(s.t, c->far_m);
    s.at = vector_add(load3(c->eye), vector_scale(d, s.t));
    if (vector_dot(s.normal, d) > 0.0f) { /* facets may be wound either way */
        s.normal = vector_scale(s.normal, -1.0f);
    }
    return s;
}

/* Sand: two scales of noise and a grid of lines. */
static vector ground(__constant const dev_camera *c, vector at, float pixel_m) {
    float x = at.x - c->grid_origin[0], y = at.y - c->grid_origin[1];
    float fine = 1.0f - smoothstep(0.1f, 0.8f, pixel_m);
    float shade = 0.76f + 0.20f * noise2(0.23f * x, 0.23f * y);
    if (fine > 0.0f) {
        shade += 0.30f * fine * (noise2(2.1f * x, 2.1f * y) - 0.5f);
    }
    vector sand = vector_scale(vector_of(0.78f, 0.70f, 0.53f), shade);
    float line = max(grid_line(x, c->grid_m, pixel_m), grid_line(y, c->grid_m, pixel_m));
    return mix3(sand, vector_of(0.25f, 0.32f, 0.33f), 0.30f * line);
}

/* Seen from below: bright within the cone that lets the sky in (48.6 degrees), dark beyond. */
static vector sea_surface(__constant const dev_camera *c, vector at, vector d) {
    float ripple = noise2(0.5f * at.x + 0.8f * c->time_s, 0.5f * at.y) +
                   noise2(1.3f * at.x, 1.3f * at.y - 0.6f * c->time_s);
    float window = smoothstep(0.45f, 0.85f, -d.z + 0.10f * (ripple - 1.0f));
    return mix3(vector_of(0.10f, 0.30f, 0.38f), vector_of(0.75f, 0.95f, 0.98f),
                window * 0.8f + 0.15f * ripple);
}

static vector lit(__constant const dev_camera *c, vector d, const sight *s) {
    float depth_m = max(s->at.z - c->sea_level_z, 0.0f);
    float day = 0.35f + 0.65f * fade(0.012f * depth_m);
    vector sun = vector_of(-0.35f, -0.30f, -0.887f); /* from above, a little behind */
    float diffuse = max(vector_dot(s->normal, sun), 0.0f), up = 0.5f - 0.5f * s->normal.z;
    float lamp = max(-vector_dot(s->normal, d), 0.0f) / (1.0f + 0.004f * s->t * s->t);
    float light = day * (0.22f + 0.28f * up + 0.75f * diffuse) + 0.30f * lamp;
    vector water = vector_of(0.72f, 0.96f, 1.0f); /* daylight has lost its red */
    return mul3(vector_scale(s->albedo, light), s->what == 4 ? vector_of(1.0f, 1.0f, 1.0f) : water);
}

/* Length of the ray's part inside a cone, before T_MAX: the ray leaves O along V, both as the cone
 * sees them. */
static float inside_cone(vector o, vector v, float range_m, float t_max) {
    float a = v.y * v.y + v.z * v.z - v.x * v.x, b = o.y * v.y + o.z * v.z - o.x * v.x;
    float e = o.y * o.y + o.z * o.z - o.x * o.x, disc = b * b - a * e;
    if (disc <= 0.0f) { /* misses */
        return 0.0f;
    }
    /* The slab in front of the face, up to the range. */
    float slow = 1.0f / v.x, near_t = -o.x * slow, far_t = (range_m - o.x) * slow;
    float lo = max(min(near_t, far_t), 0.0f), hi = min(max(near_t, far_t), t_max);
    float root = sqrt(disc), over = 1.0f / a, t0 = (-b - root) * over, t1 = (-b + root) * over;
    float first = min(t0, t1), last = max(t0, t1);
    if (a > 0.0f) {
        return max(min(hi, last) - max(lo, first), 0.0f);
    }
    /* Both ends lie in the cone: the half in front is either before the first or behind the last. */
    bool ahead = v.x > 0.0f;
    return ahead ? max(hi - max(lo, last), 0.0f) : max(min(hi, first) - lo, 0.0f);
}

/* How much of a beam falls on a point that it sees at P: 1 on its axis, 1/2 at its edge. */
static float footprint(vector p) {
    float q = (p.y * p.y + p.z * p.z) / (p.x * p.x);
    return p.x > 0.0f ? fade(0.6931f * q) : 0.0f;
}

/* The beams' light on what was met, and in the water before it. */
static void see_beams(__constant const dev_camera *c, vector d, const sight *s, vector *spot,
                      vector *glow) {
    vector from = vector_add(s->at, vector_scale(load3(c->sonar), -1.0f));
    bool is_lit =
        (s->what == 1 || s->what == 2) && vector_dot(from, from) < c->range_m * c->range_m;
    *spot = *glow = vector_of(0.0f, 0.0f, 0.0f);
    for (uint k = 0; k < c->cones; k++) {
        __constant const dev_cone_view *cone = &c->cone[k];
        vector o = load3(cone->eye), v = turn3(cone->rows, d), rgb = load3(cone->rgb);
        float inside_m = inside_cone(o, v, c->range_m, s->t);
        if (is_lit) {
            *spot = vector_add(
                *spot, vector_scale(rgb, 0.30f * cone->strength *
                                             footprint(vector_add(o, vector_scale(v, s->t)))));
        }
        if (inside_m > 0.0f) {
            float thick = 2.2f * cone->strength * inside_m / c->range_m;
            *glow = vector_add(*glow, vector_scale(rgb, 0.55f * (1.0f - fade(thick))));
        }
    }
}

static uint pack(vector v) {
    /* A gentle shoulder, then the display's curve. */
    float r = v.x / (1.0f + 0.25f * v.x), g = v.y / (1.0f + 0.25f * v.y),
          b = v.z / (1.0f + 0.25f * v.z);
    uint ir = (uint)(255.0f * sqrt(clamp(r, 0.0f, 1.0f)) + 0.5f);
    uint ig = (uint)(255.0f * sqrt(clamp(g, 0.0f, 1.0f)) + 0.5f);
    uint ib = (uint)(255.0f * sqrt(clamp(b, 0.0f, 1.0f)) + 0.5f);
    return ir << 16 | ig << 8 | ib;
}

/* RGB and distance of every pixel, row by row; a pixel's ray is where pixel_of puts it. */
__kernel void camera_shade(__constant dev_camera *c, __global const dev_hit *hits, uint has_mesh,
                           __global const dev_triangle *triangles, __global const dev_part *parts,
                           __global uint *rgb, __global float *far_m) {
    uint i = (uint)get_global_id(0), x, y;
    pixel_of(c, i, &x, &y);
    if (x >= c->width || y >= c->height) {
        return;
    }
    vector d = direction_of(c, x, y);
    dev_hit none;
    none.t_m = INFINITY;
    none.triangle = ~0u;
    sight s = look(c, d, has_mesh ? hits[i] : none, triangles, parts);
    float pixel_m =
        s.t * 2.0f * c->tan_x / (float)c->width / max(fabs(vector_dot(s.normal, d)), 0.08f);
    vector color = load3(c->fog_rgb);
    if (s.what == 1) {
        s.albedo = ground(c, s.at, pixel_m);
    }
    if (s.what == 3) {
        color = sea_surface(c, s.at, d);
    } else if (s.what != 0) {
        color = lit(c, d, &s);
    }
    vector spot, glow;
    see_beams(c, d, &s, &spot, &glow);
    color = vector_add(color, spot);
    /* Water darkens towards the deep and brightens towards the day. */
    float up = 0.5f - 0.5f * d.z;
    vector fog = vector_scale(load3(c->fog_rgb), 0.55f + 0.9f * up * up);
    vector through = vector_of(fade(c->fog_per_m[0] * s.t), fade(c->fog_per_m[1] * s.t),
                               fade(c->fog_per_m[2] * s.t));
    color = vector_add(mul3(color, through),
                       mul3(fog, vector_of(1.0f - through.x, 1.0f - through.y, 1.0f - through.z)));
    color = vector_add(color, glow);
    rgb[y * c->width + x] = pack(color);
    far_m[y * c->width + x] = s.t;
}
