/*
 * A Kalman filter of constant velocity in the plane.
 */
#ifndef ASDIC_DETECT_KALMAN_H
#define ASDIC_DETECT_KALMAN_H

#include <asdic/scan.h>

/* Order of the covariance: north, its rate, east, its rate. */
typedef struct asdic_kalman {
    double mean[2][2]; /* [axis][position, rate] */
    double covariance[4][4];
} asdic_kalman;

asdic_kalman asdic_kalman_begin(const asdic_plot_point *plot, double speed_mps);

/* STEP_S later; ACCELERATION is a spectral density, m^2/s^3. */
void asdic_kalman_predict(asdic_kalman *k, double step_s, double acceleration);

/* Squared Mahalanobis distance of a plot from where it is expected. */
double asdic_kalman_distance2(const asdic_kalman *k, const asdic_plot_point *plot);

void asdic_kalman_update(asdic_kalman *k, const asdic_plot_point *plot);

#endif
