/*
 * Integrals in one dimension, in double precision.
 */
#ifndef ASDIC_BASE_QUADRATURE_H
#define ASDIC_BASE_QUADRATURE_H

typedef double (*asdic_integrand)(double x, void *user);

/* Integral of F from A to B to the relative accuracy TOLERANCE of an integrand that keeps its sign:
 * adaptive Gauss-Kronrod (7, 15), at most 40 halvings deep and 100,000 panels in all: it ends whatever F gives. 0 when
 * B <= A; NAN where F is. */
double asdic_quadrature(asdic_integrand f, void *user, double a, double b, double tolerance);

/* Gauss-Legendre nodes and weights on [-1, 1]: +-asdic_gauss16_node[i]. */
#define ASDIC_GAUSS16_HALF 8
extern const double asdic_gauss16_node[ASDIC_GAUSS16_HALF];
extern const double asdic_gauss16_weight[ASDIC_GAUSS16_HALF];

#endif
