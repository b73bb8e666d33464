#include "kalman.h"

#include <string.h>

/* Places of the positions in the state. */
static const int positions[2] = {0, 2};

asdic_kalman asdic_kalman_begin(const asdic_plot_point *plot, double speed_mps) {
    asdic_kalman k = {.mean = {{plot->north_m, 0.0}, {plot->east_m, 0.0}}};
    k.covariance[0][0] = plot->variance_nn_m2;
    k.covariance[2][2] = plot->variance_ee_m2;
    k.covariance[0][2] = k.covariance[2][0] = plot->variance_ne_m2;
    k.covariance[1][1] = k.covariance[3][3] = speed_mps * speed_mps;
    return k;
}

void asdic_kalman_predict(asdic_kalman *k, double step_s, double acceleration) {
    double t = step_s, (*p)[4] = k->covariance;
    for (int axis = 0; axis < 2; axis++) {
        int at = positions[axis];
        k->mean[axis][0] += t * k->mean[axis][1];
        for (int j = 0; j < 4; j++) { /* F P */
            p[at][j] += t * p[at + 1][j];
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        int at = positions[axis];
        for (int j = 0; j < 4; j++) { /* (F P) F^T */
            p[j][at] += t * p[j][at + 1];
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        int at = positions[axis];
        p[at][at] += acceleration * t * t * t / 3.0;
        p[at][at + 1] += acceleration * t * t / 2.0;
        p[at + 1][at] += acceleration * t * t / 2.0;
        p[at + 1][at + 1] += acceleration * t;
    }
}

/* The inverse of the innovation's covariance. */
static void invert(const asdic_kalman *k, const asdic_plot_point *plot, double out[2][2]) {
    double nn = k->covariance[0][0] + plot->variance_nn_m2;
    double ne = k->covariance[0][2] + plot->variance_ne_m2;
    double ee = k->covariance[2][2] + plot->variance_ee_m2;
    double determinant = nn * ee - ne * ne;
    out[0][0] = ee / determinant;
    out[1][1] = nn / determinant;
    out[0][1] = out[1][0] = -ne / determinant;
}

double asdic_kalman_distance2(const asdic_kalman *k, const asdic_plot_point *plot) {
    double s[2][2], n = plot->north_m - k->mean[0][0], e = plot->east_m - k->mean[1][0];
    invert(k, plot, s);
    return n * (s[0][0] * n + s[0][1] * e) + e * (s[1][0] * n + s[1][1] * e);
}

void asdic_kalman_update(asdic_kalman *k, const asdic_plot_point *plot) {
    double s[2][2], gain[4][2], before[4][4];
    double innovation[2] = {plot->north_m - k->mean[0][0], plot->east_m - k->mean[1][0]};
    invert(k, plot, s);
    memcpy(before, k->covariance, sizeof before);
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 2; j++) {
            gain[i][j] = before[i][0] * s[0][j] + before[i][2] * s[1][j];
        }
    }
    for (int i = 0; i < 4; i++) {
        k->mean[i / 2][i % 2] += gain[i][0] * innovation[0] + gain[i][1] * innovation[1];
        for (int j = 0; j < 4; j++) {
            k->covariance[i][j] -= gain[i][0] * before[0][j] + gain[i][1] * before[2][j];
        }
    }
}
