#include "scatterer.h"

#include "base/vec.h"

#include <math.h>

/* Angles at which a law is looked at, in equal steps of the logarithm of the sine and of the cosine,
 * besides its knots. */
#define STEPS 256
#define LEAST 1e-6

asdic_scatterer asdic_scatterer_at(const asdic_material *material, const asdic_law_water *water) {
    asdic_scatterer s = {.material = *material, .water = *water};
    const asdic_law *law = material->law;
    s.device.law = law->formula;
    for (size_t i = 0; i < law->model.key_count; i++) {
        bool given = !isnan(material->value[i]);
        s.value[i] = given ? material->value[i] : law->model.keys[i].fallback;
    }
    if (law->prepare) {
        law->prepare(&s);
    }
    return s;
}

double asdic_scatterer_uncertainty_db(const asdic_scatterer *s) {
    const asdic_law *law = s->material.law;
    return law && law->uncertainty_db ? law->uncertainty_db(s) : NAN;
}

double asdic_scatterer_knot_deg(const asdic_scatterer *s, size_t index) {
    const asdic_law *law = s->material.law;
    return law->knot_deg ? law->knot_deg(s, index) : NAN;
}

size_t asdic_scatterer_knots(const asdic_scatterer *s) {
    size_t count = 0;
    while (!isnan(asdic_scatterer_knot_deg(s, count))) {
        count++;
    }
    return count;
}

void asdic_scatterer_silence(asdic_scatterer *s) {
    s->silent = true;
    s->device.formula[0] = 0.0f; /* the gain of the surface's formula */
}

double asdic_scatterer_strength(const asdic_scatterer *s, double sine) {
    double bounded = fmin(fmax(sine, 0.0), 1.0);
    asdic_incidence at = asdic_incidence_on_plane(bounded, (1.0 - bounded) * (1.0 + bounded));
    return s->material.law->strength_lin(s, &at);
}

/* Calls VISIT at sines that miss nothing a law may have: close near normal incidence, at its knots. */
static void visit_angles(const asdic_scatterer *s,
                         void (*visit)(const asdic_scatterer *, double, void *), void *user) {
    for (int i = 0; i <= STEPS; i++) {
        double cosine = pow(LEAST, (double)i / STEPS);
        visit(s, sqrt((1.0 - cosine) * (1.0 + cosine)), user);
    }
    for (size_t i = 0; !isnan(asdic_scatterer_knot_deg(s, i)); i++) {
        visit(s, sin(asdic_scatterer_knot_deg(s, i) * (ASDIC_PI / 180.0)), user);
    }
    visit(s, 1.0, user);
}

typedef struct largest {
    double least, step, most;
} largest;

static void largest_visit(const asdic_scatterer *s, double sine, void *user) {
    largest *l = user;
    l->most = fmax(l->most, asdic_scatterer_strength(s, sine));
}

static void steepest_visit(const asdic_scatterer *s, double sine, void *user) {
    largest *l = user;
    if (sine >= l->least) {
        l->most = fmax(l->most, asdic_scatterer_strength(s, sine) / fmax(sine / l->step, l->least));
    }
}

double asdic_scatterer_most(const asdic_scatterer *s, double range_m) {
    const asdic_law *law = s->material.law;
    largest l = {.least = LEAST};
    if (law->most_lin) {
        return law->most_lin(s, range_m);
    }
    for (int i = 0; i <= STEPS; i++) {
        largest_visit(s, pow(LEAST, 1.0 - (double)i / STEPS), &l);
    }
    visit_angles(s, largest_visit, &l);
    return l.most;
}

double asdic_scatterer_steepest(const asdic_scatterer *s, double least) {
    double from = fmin(fmax(least, LEAST), 1.0);
    largest l = {.least = from, .step = pow(1.0 / from, 1.0 / STEPS)};
    for (int i = 0; i < STEPS; i++, from *= l.step) {
        double most =
            fmax(asdic_scatterer_strength(s, from), asdic_scatterer_strength(s, from * l.step));
        l.most = fmax(l.most, most / from);
    }
    visit_angles(s, steepest_visit, &l);
    return l.most;
}
