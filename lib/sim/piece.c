#include "piece.h"

#include <math.h>

asdic_vec3 asdic_piece_middle(const asdic_piece *p) {
    double share = p->folded ? 1.0 / 3.0 : 0.5;
    if (p->form == DEV_FORM_EDGE) {
        return asdic_vec3_add(p->corner, asdic_vec3_scale(p->edge1, 0.5));
    }
    return asdic_vec3_add(p->corner, asdic_vec3_scale(asdic_vec3_add(p->edge1, p->edge2), share));
}

double asdic_piece_area(const asdic_piece *p) {
    if (p->form == DEV_FORM_EDGE) {
        return asdic_vec3_length(p->edge1);
    }
    double area = asdic_vec3_length(asdic_vec3_cross(p->edge1, p->edge2));
    return p->folded ? 0.5 * area : area;
}

double asdic_piece_reach(const asdic_piece *p) {
    asdic_vec3 middle = asdic_piece_middle(p),
               ends[4] = {p->corner, asdic_vec3_add(p->corner, p->edge1),
                          asdic_vec3_add(p->corner, p->edge2)};
    if (p->form == DEV_FORM_EDGE) {
        return 0.5 * asdic_vec3_length(p->edge1);
    }
    ends[3] = p->folded ? p->corner : asdic_vec3_add(ends[1], p->edge2);
    double most = 0.0;
    for (int i = 0; i < 4; i++) {
        most = fmax(most, asdic_vec3_length(asdic_vec3_sub(ends[i], middle)));
    }
    return most;
}

asdic_piece asdic_piece_quarter(const asdic_piece *p, uint32_t k) {
    asdic_vec3 a = asdic_vec3_scale(p->edge1, 0.5), b = asdic_vec3_scale(p->edge2, 0.5);
    asdic_vec3 far = asdic_vec3_add(p->corner, asdic_vec3_add(a, b));
    const asdic_vec3 corner[4] = {p->corner, asdic_vec3_add(p->corner, a),
                                  asdic_vec3_add(p->corner, b), far};
    bool over = p->folded && k == 3; /* the triangle in the middle stands on its head */
    asdic_piece part = *p;
    part.corner = corner[k];
    part.edge1 = over ? asdic_vec3_scale(a, -1.0) : a;
    part.edge2 = over ? asdic_vec3_scale(b, -1.0) : b;
    part.name[2] = 4u * p->name[2] + k + 1u;
    return part;
}

asdic_piece asdic_piece_half(const asdic_piece *p, int edge, uint32_t k) {
    asdic_vec3 a = p->corner, b = asdic_vec3_add(a, p->edge1), c = asdic_vec3_add(a, p->edge2);
    /* The corner across, and the ends of the edge. */
    asdic_vec3 top = edge == 0 ? c : edge == 1 ? b : a;
    asdic_vec3 left = edge == 2 ? b : a, right = edge == 0 ? b : c;
    asdic_vec3 middle = asdic_vec3_scale(asdic_vec3_add(left, right), 0.5);
    asdic_piece part = *p;
    part.corner = top;
    part.edge1 = asdic_vec3_sub(k ? middle : left, top);
    part.edge2 = asdic_vec3_sub(k ? right : middle, top);
    part.name[2] = 2u * p->name[2] + k + 1u;
    return part;
}

asdic_piece asdic_piece_side(const asdic_piece *p, int k) {
    const asdic_vec3 corner[3] = {p->corner, asdic_vec3_add(p->corner, p->edge1),
                                  asdic_vec3_add(p->corner, p->edge2)};
    asdic_piece side = *p;
    side.corner = corner[k];
    side.edge1 = asdic_vec3_sub(corner[(k + 1) % 3], corner[k]);
    side.edge2 = asdic_vec3_sub(asdic_piece_middle(p), corner[k]);
    side.form = DEV_FORM_EDGE;
    side.name[2] = 4u * p->name[2] + (uint32_t)k + 1u;
    return side;
}

asdic_piece asdic_piece_half_side(const asdic_piece *p, uint32_t k) {
    asdic_vec3 half = asdic_vec3_scale(p->edge1, 0.5);
    asdic_piece part = *p;
    part.edge1 = half;
    part.corner = k ? asdic_vec3_add(p->corner, half) : p->corner;
    part.edge2 = k ? asdic_vec3_sub(p->edge2, half) : p->edge2;
    part.name[2] = 2u * p->name[2] + k + 1u;
    return part;
}
