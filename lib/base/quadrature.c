#include "quadrature.h"

#include <math.h>

#define DEEPEST 40
/* A panel this deep is judged by what it holds: the first look may have missed all of it. */
#define OWN_DEPTH 12

const double asdic_gauss16_node[ASDIC_GAUSS16_HALF] = {
    0.0950125098376374402, 0.281603550779258913, 0.458016777657227386, 0.617876244402643748,
    0.755404408355003034,  0.865631202387831744, 0.944575023073232576, 0.989400934991649933};
const double asdic_gauss16_weight[ASDIC_GAUSS16_HALF] = {
    0.189450610455068496, 0.182603415044923589,  0.169156519395002538,  0.149595988816576732,
    0.124628971255533872, 0.0951585116824927848, 0.0622535239386478929, 0.0271524594117540949};

/* QUADPACK's qk15 (Piessens et al. 1983): the odd nodes are Gauss's seven. */
static const double node[8] = {
    0.991455371120812639, 0.949107912342758525, 0.864864423359769073, 0.741531185599394440,
    0.586087235467691130, 0.405845151377397167, 0.207784955007898468, 0.0};
static const double kronrod[8] = {
    0.0229353220105292250, 0.0630920926299785533, 0.104790010322250184, 0.140653259715525919,
    0.169004726639267903,  0.190350578064785410,  0.204432940075298892, 0.209482141084727828};
static const double gauss[4] = {0.129484966168869693, 0.279705391489276668, 0.381830050505118945,
                                0.417959183673469388};

/* One integral may ask for this many panels: those in use ask for hundreds. Beyond it, of an integrand without end of
 * kinks, what is known of a panel stands. */
#define PANELS_MOST 100000

typedef struct panel {
    double integral, error;
} panel;

typedef struct integral {
    asdic_integrand f;
    void *user;
    double tolerance;
    int panels; /* that may still be asked for */
} integral;

static panel rule(integral *in, double a, double b) {
    double centre = 0.5 * (a + b), half = 0.5 * (b - a);
    double middle = in->f(centre, in->user);
    double k = kronrod[7] * middle, g = gauss[3] * middle;
    for (int i = 0; i < 7; i++) {
        double pair =
            in->f(centre - half * node[i], in->user) + in->f(centre + half * node[i], in->user);
        k += kronrod[i] * pair;
        g += i % 2 ? gauss[i / 2] * pair : 0.0;
    }
    in->panels--;
    return (panel){k * half, fabs((k - g) * half)};
}

static double refine(integral *in, double a, double b, panel whole, double allowed, int depth) {
    double centre = 0.5 * (a + b);
    /* NAN, too, is no error above what is allowed. */
    if (!(whole.error > allowed) || depth == DEEPEST || centre <= a || centre >= b ||
        in->panels <= 0) {
        return whole.integral;
    }
    panel left = rule(in, a, centre), right = rule(in, centre, b);
    double seen = fabs(left.integral) + fabs(right.integral);
    allowed = depth < OWN_DEPTH ? 0.5 * allowed : fmax(allowed, in->tolerance * seen);
    return refine(in, a, centre, left, allowed, depth + 1) +
           refine(in, centre, b, right, allowed, depth + 1);
}

double asdic_quadrature(asdic_integrand f, void *user, double a, double b, double tolerance) {
    integral in = {f, user, tolerance, PANELS_MOST};
    if (!(b > a)) {
        return 0.0;
    }
    panel whole = rule(&in, a, b);
    double result = refine(&in, a, b, whole, tolerance * fabs(whole.integral), 0);
    if (fabs(result) < 0.5 * fabs(whole.integral)) { /* the first look was too bright */
        result = refine(&in, a, b, whole, tolerance * fabs(result), 0);
    }
    return result;
}
