#include "place.h"

static asdic_vec3 corner(const double *v) {
    return (asdic_vec3){v[0], v[1], v[2]};
}

void asdic_place_corners(const double mesh_m[9], asdic_mat3 turn, asdic_vec3 position_m,
                         double world_m[9]) {
    for (int k = 0; k < 9; k += 3) {
        asdic_vec3 at = asdic_vec3_add(position_m, asdic_mat3_apply(turn, corner(mesh_m + k)));
        world_m[k] = at.x;
        world_m[k + 1] = at.y;
        world_m[k + 2] = at.z;
    }
}

static void round_corner(asdic_vec3 world, asdic_vec3 origin, float out[3]) {
    asdic_vec3 local = asdic_vec3_sub(world, origin);
    out[0] = (float)local.x;
    out[1] = (float)local.y;
    out[2] = (float)local.z;
}

/* The normal comes from the corners before rounding: a facet of centimetres in a scene of
 * kilometres keeps its direction. */
void asdic_place_triangle(const double world_m[9], asdic_vec3 origin_m, dev_triangle *out) {
    asdic_vec3 a = corner(world_m), b = corner(world_m + 3), c = corner(world_m + 6);
    asdic_vec3 n = asdic_vec3_cross(asdic_vec3_sub(b, a), asdic_vec3_sub(c, a));
    double length = asdic_vec3_length(n);
    round_corner(a, origin_m, out->v0);
    round_corner(b, origin_m, out->v1);
    round_corner(c, origin_m, out->v2);
    /* A facet of a mesh has an area, but far from the origin a tiny one may lose it to rounding. */
    n = length > 0.0 ? asdic_vec3_scale(n, 1.0 / length) : (asdic_vec3){0.0, 0.0, -1.0};
    out->normal[0] = (float)n.x;
    out->normal[1] = (float)n.y;
    out->normal[2] = (float)n.z;
}

void asdic_place_sphere(const double *world_m, size_t count, asdic_part *part, asdic_vec3 *lo_m,
                        asdic_vec3 *hi_m) {
    asdic_vec3 lo = {INFINITY, INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * count; i++) {
        asdic_vec3 v = corner(world_m + 3 * i);
        lo = (asdic_vec3){fmin(lo.x, v.x), fmin(lo.y, v.y), fmin(lo.z, v.z)};
        hi = (asdic_vec3){fmax(hi.x, v.x), fmax(hi.y, v.y), fmax(hi.z, v.z)};
    }
    part->center_m = asdic_vec3_scale(asdic_vec3_add(lo, hi), 0.5);
    part->radius_m = 0.0;
    for (size_t i = 0; i < 3 * count; i++) {
        asdic_vec3 from_centre = asdic_vec3_sub(corner(world_m + 3 * i), part->center_m);
        part->radius_m = fmax(part->radius_m, asdic_vec3_length(from_centre));
    }
    *lo_m = lo;
    *hi_m = hi;
}

/* Areas, as vectors, of what closes round a volume have no sum; holes leave a little. */
#define CLOSED 1e-3

void asdic_place_faces(const double *world_m, size_t count, asdic_part *part) {
    asdic_vec3 sum = {0.0, 0.0, 0.0};
    double area = 0.0, volume = 0.0;
    for (size_t i = 0; i < count; i++) {
        asdic_vec3 a = asdic_vec3_sub(corner(world_m + 9 * i), part->center_m);
        asdic_vec3 b = asdic_vec3_sub(corner(world_m + 9 * i + 3), part->center_m);
        asdic_vec3 c = asdic_vec3_sub(corner(world_m + 9 * i + 6), part->center_m);
        asdic_vec3 n = asdic_vec3_cross(asdic_vec3_sub(b, a), asdic_vec3_sub(c, a));
        sum = asdic_vec3_add(sum, n);
        area += asdic_vec3_length(n);
        volume += asdic_vec3_dot(a, n);
    }
    part->area_m2 = 0.5 * area;
    part->outward = asdic_vec3_length(sum) > CLOSED * area ? 0 : volume < 0.0 ? -1 : 1;
}
