/*
 * S. Rusinkiewicz, "Estimating curvatures and their derivatives on triangle meshes", 3DPVT 2004.
 */
#include "bend.h"

#include "../base/vec.h"

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

void asdic_bend_add(asdic_bend *sum, double weight, const asdic_bend *m) {
    double uu = asdic_vec3_dot(sum->u, m->u), uv = asdic_vec3_dot(sum->u, m->v);
    double vu = asdic_vec3_dot(sum->v, m->u), vv = asdic_vec3_dot(sum->v, m->v);
    sum->x[0] += weight * (m->x[0] * uu * uu + 2.0 * m->x[1] * uu * uv + m->x[2] * uv * uv);
    sum->x[1] += weight * (m->x[0] * uu * vu + m->x[1] * (uu * vv + uv * vu) + m->x[2] * uv * vv);
    sum->x[2] += weight * (m->x[0] * vu * vu + 2.0 * m->x[1] * vu * vv + m->x[2] * vv * vv);
}

asdic_principal asdic_bend_principal(const asdic_bend *m) {
    double mean = 0.5 * (m->x[0] + m->x[2]), half = 0.5 * (m->x[0] - m->x[2]);
    double root = sqrt(half * half + m->x[1] * m->x[1]);
    /* Cosine of twice the angle from U to where the tensor is larger; of its negative, smaller. */
    double cosine = root > 0.0 ? (mean > 0.0 ? -half : half) / root : 1.0;
    double sine = copysign(sqrt(fmax(0.5 - 0.5 * cosine, 0.0)), mean > 0.0 ? -m->x[1] : m->x[1]);
    return (asdic_principal){
        .least = fabs(fabs(mean) - root),
        .most = fabs(mean) + root,
        .straightest = asdic_vec3_add(asdic_vec3_scale(m->u, sqrt(fmax(0.5 + 0.5 * cosine, 0.0))),
                                      asdic_vec3_scale(m->v, sine))};
}

double asdic_bend_along(const asdic_bend *m, asdic_vec3 way) {
    double a = asdic_vec3_dot(way, m->u), b = asdic_vec3_dot(way, m->v);
    return fabs(m->x[0] * a * a + 2.0 * m->x[1] * a * b + m->x[2] * b * b) / (a * a + b * b);
}
