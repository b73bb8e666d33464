#include "governor.h"

#include <math.h>

/* A mission learns every 32 pings, which costs the time of some pings: a fair mean spans a whole
 * block. A machine that is far too slow shows it in a few pings. */
#define FAIR_STEPS 32
#define FEW_STEPS 6
#define HOPELESS 1.5
/* Busy shares of the period. Above the first, rays fall until the second is met; below the third
 * they rise. They lie far enough apart not to oscillate. */
#define TOO_BUSY 0.95
#define AIM 0.80
#define IDLE 0.50
#define MOST_RISE 1.5
#define MOST_FALL 0.4

uint32_t asdic_governor_floor(size_t beams) {
    size_t floor = ASDIC_GOVERNOR_RAYS_A_BEAM * beams;
    return floor > ASDIC_GOVERNOR_LEAST_RAYS ? (uint32_t)floor : ASDIC_GOVERNOR_LEAST_RAYS;
}

uint32_t asdic_governor_enough(size_t beams, size_t bins) {
    double rays = (double)asdic_governor_floor(beams) * (double)bins / ASDIC_GOVERNOR_BINS;
    return (uint32_t)fmin(fmax(ceil(rays), ASDIC_GOVERNOR_LEAST_RAYS), UINT32_MAX);
}

size_t asdic_governor_joined(uint32_t rays, size_t beams, size_t bins) {
    double enough = ASDIC_GOVERNOR_RAYS_A_BEAM * (double)beams * (double)bins / ASDIC_GOVERNOR_BINS;
    size_t joined = 1;
    while (2 * joined * ASDIC_GOVERNOR_BINS <= bins && (double)rays * (double)joined < enough) {
        joined *= 2;
    }
    return joined;
}

void asdic_governor_init(asdic_governor *g, double period_s, uint32_t wanted, uint32_t least,
                         bool follows) {
    *g = (asdic_governor){.period_s = period_s,
                          .wanted = wanted,
                          .least = least,
                          .rays = wanted,
                          .follows = follows,
                          .stretch = 1.0};
}

static void restart(asdic_governor *g, uint32_t rays) {
    g->rays = rays;
    g->busy_s = 0.0;
    g->steps = 0;
}

void asdic_governor_want(asdic_governor *g, uint32_t rays) {
    g->wanted = rays;
    restart(g, rays);
}

/* The number of rays that brings SHARE of the period to AIM, if all work grew with rays. */
static uint32_t fitting(const asdic_governor *g, double share) {
    double factor = fmin(fmax(AIM / share, MOST_FALL), MOST_RISE);
    double rays =
        fmin(fmax(factor * g->rays, g->least), g->wanted); /* fewer than LEAST if so wanted */
    return (uint32_t)rays;
}

bool asdic_governor_note(asdic_governor *g, double busy_s, double wall_s) {
    g->busy_s += busy_s;
    g->steps++;
    if (wall_s > 0.0) {
        /* Averages over some seconds: a single late ping shows and fades. */
        double now = wall_s / g->period_s;
        g->stretch += 0.1 * (now - g->stretch);
    }
    double share = g->busy_s / ((double)g->steps * g->period_s);
    bool tells = g->steps >= FAIR_STEPS || (g->steps >= FEW_STEPS && share > HOPELESS);
    if (!g->follows || !tells) {
        return false;
    }
    uint32_t before = g->rays, after = before;
    if (share > TOO_BUSY || (share < IDLE && before < g->wanted)) {
        after = fitting(g, share);
    }
    restart(g, after);
    return after != before;
}

uint32_t asdic_governor_rays(const asdic_governor *g) {
    return g->rays;
}

double asdic_governor_stretch(const asdic_governor *g) {
    return fabs(g->stretch - 1.0) < 0.03 ? 1.0 : g->stretch;
}
