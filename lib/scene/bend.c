/*
 * S. Rusinkiewicz, "Estimating curvatures and their derivatives on triangle meshes", 3DPVT 2004.
 */
#include "bend.h"

#include "../base/vec.h"

/* A surface that bends this much more one way than the other is straight the other way. */
#define STRAIGHT 1e-4

/* Solves the symmetric 3 x 3 system A x = B by Cramer's rule; false when it is singular. */
static bool solve3(const double a[3][3], const double b[3], double x[3]) {
    double c0 = a[1][1] * a[2][2] - a[1][2] * a[2][1];
    double c1 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
    double c2 = a[1][0] * a[2][1] - a[1][1] * a[2][0];
    double det = a[0][0] * c0 + a[0][1] * c1 + a[0][2] * c2;
    if (!(fabs(det) > 0.0)) {
        return false;
    }
    x[0] = (b[0] * c0 + b[1] * (a[0][2] * a[2][1] - a[0][1] * a[2][2]) +
            b[2] * (a[0][1] * a[1][2] - a[0][2] * a[1][1])) /
           det;
    x[1] = (b[0] * c1 + b[1] * (a[0][0] * a[2][2] - a[0][2] * a[2][0]) +
            b[2] * (a[0][2] * a[1][0] - a[0][0] * a[1][2])) /
           det;
    x[2] = (b[0] * c2 + b[1] * (a[0][1] * a[2][0] - a[0][0] * a[2][1]) +
            b[2] * (a[0][0] * a[1][1] - a[0][1] * a[1][0])) /
           det;
    return true;
}

asdic_bend asdic_bend_of(const asdic_surface *s, uint32_t facet, const asdic_vec3 normals[3]) {
    asdic_vec3 n = asdic_surface_normal(s, facet), p[3];
    asdic_bend m = {.x = {0}}; /* of a facet that is a line */
    for (int k = 0; k < 3; k++) {
        p[k] = asdic_surface_corner(s, 3 * (size_t)facet + k);
    }
    m.u = asdic_vec3_sub(p[1], p[0]);
    m.u = asdic_vec3_scale(m.u, 1.0 / asdic_vec3_length(m.u));
    m.v = asdic_vec3_cross(n, m.u);
    double a[3][3] = {{0}}, b[3] = {0};
    for (int k = 0; k < 3; k++) {
        asdic_vec3 edge = asdic_vec3_sub(p[(k + 1) % 3], p[k]);
        asdic_vec3 turn = asdic_vec3_sub(normals[(k + 1) % 3], normals[k]);
        double eu = asdic_vec3_dot(edge, m.u), ev = asdic_vec3_dot(edge, m.v);
        double tu = asdic_vec3_dot(turn, m.u), tv = asdic_vec3_dot(turn, m.v);
        a[0][0] += eu * eu;
        a[0][1] += eu * ev;
        a[1][1] += eu * eu + ev * ev;
        a[1][2] += eu * ev;
        a[2][2] += ev * ev;
        b[0] += tu * eu;
        b[1] += tu * ev + tv * eu;
        b[2] += tv * ev;
    }
    a[1][0] = a[0][1];
    a[2][1] = a[1][2];
    solve3((const double(*)[3])a, b, m.x);
    return m;
}

double asdic_bend_larger_radius(const asdic_bend *m) {
    double mean = 0.5 * (m->x[0] + m->x[2]), root = hypot(0.5 * (m->x[0] - m->x[2]), m->x[1]);
    double least = fmin(fabs(mean + root), fabs(mean - root));
    double most = fmax(fabs(mean + root), fabs(mean - root));
    return least > STRAIGHT * most ? 1.0 / least : 0.0;
}

double asdic_bend_along(const asdic_bend *m, asdic_vec3 way) {
    double a = asdic_vec3_dot(way, m->u), b = asdic_vec3_dot(way, m->v);
    return fabs(m->x[0] * a * a + 2.0 * m->x[1] * a * b + m->x[2] * b * b) / (a * a + b * b);
}
