#include "ring.h"

#include "base/quadrature.h"
#include "base/sort.h"
#include "base/widest.h"

#include "../../kernels/beam.h"

/* A stretch of azimuth in which neither face's front edge is crossed. */
typedef struct arc {
    double begin_rad, end_rad;
    bool front_t, front_r; /* in front of the transmitter, of the receiver */
} arc;

asdic_mat3 asdic_face_mount(const asdic_beam *beam) {
    return asdic_mat3_attitude(beam->roll_rad, -beam->pitch_rad, beam->yaw_rad);
}

double asdic_beam_axis_lin(const asdic_beam *beam) {
    return pow(10.0, 0.1 * beam->sensitivity_db);
}

asdic_face asdic_face_aim(const asdic_beam *beam, const asdic_pose *pose, double wavelength_m) {
    asdic_mat3 vehicle = asdic_mat3_of(pose);
    asdic_mat3 face_to_world = asdic_mat3_multiply(vehicle, asdic_face_mount(beam));
    asdic_face face = {.length_h_wl = beam->length_h_m / wavelength_m,
                       .length_v_wl = beam->length_v_m / wavelength_m,
                       .axis_lin = asdic_beam_axis_lin(beam)};
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            face.world_to_face.m[row][column] = face_to_world.m[column][row];
        }
    }
    return face;
}

double asdic_face_gain(const asdic_face *face, asdic_vec3 towards, double rear_lin) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, towards);
    return face->axis_lin *
           beam_pattern_lin(v.x, v.y, v.z, face->length_h_wl, face->length_v_wl, rear_lin);
}

/* Re the transmitter's axis. */
#define LEAST_SENT 0.01

size_t asdic_receivers_in_the_dark(const asdic_sonar *sonar, double wavelength_m) {
    asdic_pose level = {0};
    asdic_face transmitter = asdic_face_aim(&sonar->transmitter, &level, wavelength_m);
    size_t count = 0;
    for (size_t i = 0; i < sonar->receiver_count; i++) {
        asdic_mat3 m = asdic_face_mount(&sonar->receivers[i]);
        asdic_vec3 axis = {m.m[0][0], m.m[1][0], m.m[2][0]};
        count += asdic_face_gain(&transmitter, axis, 0.0) < LEAST_SENT;
    }
    return count;
}

/* Azimuths at which the face's edge crosses the ring: cos(phi - middle) = -offset / reach. Returns
 * 0 or 2. */
static size_t crossings(const asdic_face *face, double sin_e, double cos_e, double out[2]) {
    const double *axis = face->world_to_face.m[0];
    double reach = cos_e * hypot(axis[0], axis[1]), offset = sin_e * axis[2];
    if (fabs(offset) >= reach) {
        return 0;
    }
    double middle = atan2(axis[1], axis[0]), spread = acos(-offset / reach);
    for (int i = 0; i < 2; i++) {
        double phi = middle + (i ? spread : -spread);
        out[i] = phi - 2.0 * ASDIC_PI * floor(phi / (2.0 * ASDIC_PI));
    }
    return 2;
}

static bool in_front(const asdic_face *face, asdic_vec3 direction) {
    return asdic_mat3_apply(face->world_to_face, direction).x > 0.0;
}

/* Narrower arcs, rad, are what rounding makes of none: where faces look opposite ways, what one sees as its front the
 * other must not. */
#define NO_ARC 1e-9

/* At most 5 arcs that cover the circle of elevation E (positive down) once; returns how many. */
static size_t find_arcs(const asdic_ring *ring, double elevation_rad, arc arcs[5]) {
    double sin_e = sin(elevation_rad), cos_e = cos(elevation_rad);
    double edge[4];
    size_t edges = crossings(&ring->transmitter, sin_e, cos_e, edge);
    edges += crossings(&ring->receiver, sin_e, cos_e, edge + edges);
    asdic_sort_doubles(edge, edges);
    size_t count = edges ? edges : 1;
    for (size_t i = 0; i < count; i++) {
        arcs[i].begin_rad = edges ? edge[i] : 0.0;
        arcs[i].end_rad = i + 1 < count ? edge[i + 1] : arcs[0].begin_rad + 2.0 * ASDIC_PI;
        double phi = 0.5 * (arcs[i].begin_rad + arcs[i].end_rad);
        asdic_vec3 u = {cos_e * cos(phi), cos_e * sin(phi), sin_e};
        bool is_arc = arcs[i].end_rad - arcs[i].begin_rad > NO_ARC;
        arcs[i].front_t = is_arc && in_front(&ring->transmitter, u);
        arcs[i].front_r = is_arc && in_front(&ring->receiver, u);
    }
    return count;
}

double asdic_ring_cycles(const asdic_ring *ring) {
    return hypot(ring->transmitter.length_h_wl + ring->receiver.length_h_wl,
                 ring->transmitter.length_v_wl + ring->receiver.length_v_wl);
}

/* One-way pattern without the question of front and rear. */
static inline double pattern(const asdic_face *face, double x, double y, double z) {
    const double *h = face->world_to_face.m[1], *v = face->world_to_face.m[2];
    return sinc2(face->length_h_wl * (h[0] * x + h[1] * y + h[2] * z)) *
           sinc2(face->length_v_wl * (v[0] * x + v[1] * y + v[2] * z));
}

/* Panels of 16 Gauss points hold four cycles to 1e-8. Their nodes turn with the panel's centre, which
 * turns from panel to panel. */
WIDEST static double arc_sum(const asdic_ring *ring, const arc *part, double sin_e, double cos_e) {
    const asdic_face *t = &ring->transmitter, *r = &ring->receiver;
    double length = part->end_rad - part->begin_rad;
    int panels = 1 + (int)(length * cos_e * asdic_ring_cycles(ring) / 4.0);
    double half = 0.5 * length / panels, sum = 0.0;
    double cos_node[ASDIC_GAUSS16_HALF], sin_node[ASDIC_GAUSS16_HALF], two_way[ASDIC_GAUSS16_HALF];
    for (int k = 0; k < ASDIC_GAUSS16_HALF; k++) {
        cos_node[k] = cos_e * cos(half * asdic_gauss16_node[k]);
        sin_node[k] = cos_e * sin(half * asdic_gauss16_node[k]);
    }
    double c = cos(part->begin_rad + half), s = sin(part->begin_rad + half);
    double cos_step = cos(2.0 * half), sin_step = sin(2.0 * half);
    for (int p = 0; p < panels; p++) {
        for (int k = 0; k < ASDIC_GAUSS16_HALF; k++) {
            double cc = c * cos_node[k], ss = s * sin_node[k];
            double sc = s * cos_node[k], cs = c * sin_node[k];
            two_way[k] = pattern(t, cc - ss, sc + cs, sin_e) * pattern(r, cc - ss, sc + cs, sin_e) +
                         pattern(t, cc + ss, sc - cs, sin_e) * pattern(r, cc + ss, sc - cs, sin_e);
        }
        for (int k = 0; k < ASDIC_GAUSS16_HALF; k++) {
            sum += asdic_gauss16_weight[k] * two_way[k];
        }
        double turned = c * cos_step - s * sin_step;
        s = s * cos_step + c * sin_step;
        c = turned;
    }
    return sum * half;
}

double asdic_ring_sum(const asdic_ring *ring, double elevation_rad) {
    double sin_e = sin(elevation_rad), cos_e = cos(elevation_rad), sum = 0.0;
    arc arcs[5];
    size_t count = find_arcs(ring, elevation_rad, arcs);
    for (size_t i = 0; i < count; i++) {
        double gain =
            (arcs[i].front_t ? 1.0 : ring->rear_lin) * (arcs[i].front_r ? 1.0 : ring->rear_lin);
        if (gain > 0.0) {
            sum += gain * arc_sum(ring, &arcs[i], sin_e, cos_e);
        }
    }
    return sum;
}

size_t asdic_ring_kinks(const asdic_ring *ring, double kinks_rad[4]) {
    const asdic_face *faces[2] = {&ring->transmitter, &ring->receiver};
    size_t count = 0;
    for (int f = 0; f < 2; f++) {
        const double *axis = faces[f]->world_to_face.m[0];
        double kink = atan2(hypot(axis[0], axis[1]), fabs(axis[2]));
        if (kink < 0.5 * ASDIC_PI && kink > 0.0) {
            kinks_rad[count++] = -kink;
            kinks_rad[count++] = kink;
        }
    }
    asdic_sort_doubles(kinks_rad, count);
    return count;
}
