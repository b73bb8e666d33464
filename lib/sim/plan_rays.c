/*
 * Whether rays are needed: what a flat scene without objects holds follows by quadrature, once for
 * every depth and attitude that the mission has. That costs some ten milliseconds a beam: it pays when
 * many pings share it.
 */
#include "plan_row.h"

#include "quadrature_ping.h"
#include "scene/scene.h"

#include <math.h>

/* Pings per beam that one quadrature must serve. */
#define PINGS_PER_BEAM 32

/* How many depths and attitudes there are, or one more than a simulator remembers. */
static size_t count_views(const asdic_plan_case *c) {
    const asdic_pose *views[ASDIC_QUADRATURE_VIEWS];
    size_t count = 0;
    for (size_t i = 0; i < c->count; i++) {
        size_t k = 0;
        while (k < count && !asdic_quadrature_same_view(views[k], &c->poses[i])) {
            k++;
        }
        if (k == count && count == ASDIC_QUADRATURE_VIEWS) {
            return ASDIC_QUADRATURE_VIEWS + 1;
        }
        views[k] = k == count ? &c->poses[i] : views[k];
        count += k == count;
    }
    return count;
}

void asdic_plan_rays(const asdic_plan_case *c, asdic_plan *plan) {
    size_t views = count_views(c);
    if (!asdic_quadrature_knows(c->scene, c->env, c->sampling, c->depth_least_m,
                                c->altitude_least_m)) {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, true, INFINITY, "%u a ping", c->sampling->rays);
    } else if (views > ASDIC_QUADRATURE_VIEWS ||
               c->count < PINGS_PER_BEAM * c->sonar->receiver_count * views) {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, true, 0.0,
                           "%u a ping: a quadrature would serve too few pings", c->sampling->rays);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_RAYS, false, 0.0,
                           "a flat scene without objects: %zu quadratures for %zu pings", views,
                           c->count);
    }
}
