#include "run_footprint.h"

#include "base/context.h"
#include "base/vec.h"
#include "out/beam_width.h"
#include "out/raster.h"
#include "sim/bent_ray.h"
#include "sim/ring.h"

#include <math.h>
#include <stdlib.h>

/* Directions across one beam, across one of many that are drawn at once, and at most across a fan. */
#define ACROSS 17
#define ACROSS_ROUGH 5
#define MOST_ACROSS 129
/* Directions from a lobe's lower edge to its upper one, and halvings of what lies between one that meets the
 * bottom and one that does not. */
#define DOWNWARD 17
#define HALVINGS 16
/* Steps along a ray over terrain, at most. */
#define MOST_STEPS 4000.0

/* A direction (world, unit), and the range at which it meets the bottom; NAN: it does not. */
typedef struct sight {
    asdic_vec3 along;
    double at_m;
} sight;

/* A section of a lobe, upright through its axis or beside it. */
typedef struct cut {
    const asdic_beam *beam;
    double azimuth_rad, half_rad; /* from the axis; half the section's height */
    sight lower, upper;           /* its edges, or the last before them that meets the bottom */
} cut;

/* AZIMUTH and DOWN from the axis of BEAM. */
static asdic_vec3 direction(const asdic_pose *pose, const asdic_beam *beam, double azimuth_rad,
                            double down_rad) {
    asdic_mat3 vehicle = asdic_mat3_of(pose);
    asdic_mat3 aim = asdic_face_mount(beam);
    asdic_vec3 v = {cos(down_rad) * cos(azimuth_rad), cos(down_rad) * sin(azimuth_rad),
                    sin(down_rad)};
    return asdic_mat3_apply(vehicle, asdic_mat3_apply(aim, v));
}

static cut cut_at(const asdic_swath *s, const asdic_beam *beam, double azimuth_rad) {
    return (cut){.beam = beam,
                 .azimuth_rad = azimuth_rad,
                 .half_rad = 0.5 * asdic_half_power_rad(s->wavelength_m, beam->length_v_m)};
}

/* Beam I of the swath, from port. */
static const asdic_beam *beam_at(const asdic_swath *s, size_t i) {
    return &s->beams[asdic_beam_from_port(s->beams, s->count, i)];
}

/* Whether the beams are all round, so that the outermost are neighbours. */
static bool goes_round(const asdic_swath *s) {
    const asdic_beam *first = beam_at(s, 0), *last = beam_at(s, s->count - 1);
    return last->yaw_rad - first->yaw_rad +
               0.5 * asdic_half_power_rad(s->wavelength_m, first->length_h_m) +
               0.5 * asdic_half_power_rad(s->wavelength_m, last->length_h_m) >=
           2.0 * ASDIC_PI;
}

/* From port to starboard; all round, from the first beam's axis to the same again. */
static size_t cut_swath(const asdic_swath *s, bool is_round, cut cuts[MOST_ACROSS]) {
    size_t n = 0;
    const asdic_beam *first = beam_at(s, 0), *last = beam_at(s, s->count - 1);
    double half_rad = 0.5 * asdic_half_power_rad(s->wavelength_m, first->length_h_m);
    if (s->count == 1) {
        size_t across = s->is_rough ? ACROSS_ROUGH : ACROSS;
        while (n < across) {
            double share = 2.0 * (double)n / (double)(across - 1) - 1.0;
            cuts[n++] = cut_at(s, first, share * half_rad);
        }
        return n;
    }
    size_t step = (s->count - 1) / (MOST_ACROSS - 3) + 1;
    double last_rad = 0.5 * asdic_half_power_rad(s->wavelength_m, last->length_h_m);
    if (!is_round) {
        cuts[n++] = cut_at(s, first, -half_rad);
    }
    for (size_t i = 0; i < s->count; i += step) {
        cuts[n++] = cut_at(s, beam_at(s, i), 0.0);
    }
    cuts[n++] = is_round ? cuts[0] : cut_at(s, last, last_rad);
    return n;
}

double asdic_seafloor_depth_m(const asdic_seafloor *g, double north_m, double east_m) {
    const asdic_relief *r = g->relief;
    double depth_m = g->plane_depth_m;
    if (r->columns > 0) {
        double column = floor((east_m - r->west_m) / r->cell_m);
        double row = (double)r->rows - 1.0 - floor((north_m - r->south_m) / r->cell_m);
        if (column >= 0.0 && column < (double)r->columns && row >= 0.0 && row < (double)r->rows) {
            double cell_m = (double)r->depth_m[(size_t)row * r->columns + (size_t)column];
            depth_m = isnan(cell_m) ? depth_m : fmin(depth_m, cell_m);
        }
    }
    return depth_m;
}

/* A ray that leaves the sonar ALONG a direction; where it bends, the leg that it is on. */
typedef struct way {
    const asdic_layers *layers;
    asdic_vec3 along;
    double depth_m, speed_mps; /* of the sonar */
    asdic_bent_ray leg;
} way;

static way set_out(const asdic_swath *s, const asdic_pose *pose, asdic_vec3 along) {
    way w = {.layers = s->layers, .along = along, .depth_m = pose->position_m.z};
    if (w.layers) {
        w.leg = asdic_bent_ray_start(w.layers, w.depth_m, asin(fmin(fmax(along.z, -1.0), 1.0)));
        w.speed_mps = w.leg.speed_mps;
    }
    return w;
}

/* From the sonar to where the ray is at RANGE_M, which is not less than the one before. */
static asdic_vec3 reach(way *w, double range_m) {
    if (!w->layers) {
        return asdic_vec3_scale(w->along, range_m);
    }
    double time_s = range_m / w->speed_mps;
    for (;;) {
        int end;
        double exit_s = asdic_bent_ray_exit(w->layers, &w->leg, &end);
        if (!(w->leg.time_s + exit_s < time_s)) {
            break;
        }
        w->leg = asdic_bent_ray_at_plane(w->layers, &w->leg, exit_s, end);
        asdic_bent_ray_cross(w->layers, &w->leg, end);
    }
    asdic_bent_ray now = asdic_bent_ray_later(w->layers, &w->leg, time_s - w->leg.time_s);
    double out = now.level_spm * now.area_m2_per_s / fmax(hypot(w->along.x, w->along.y), 1e-12);
    return (asdic_vec3){out * w->along.x, out * w->along.y, now.z_m - w->depth_m};
}

/* Range at which the ray meets the bottom; NAN when it does not within the swath's, or where it bends up to the
 * surface before. */
static double meet(const asdic_seafloor *g, const asdic_swath *s, const asdic_pose *pose,
                   asdic_vec3 along) {
    asdic_vec3 from_m = pose->position_m;
    if (g->relief->columns == 0 && !s->layers) {
        double at_m = (g->plane_depth_m - from_m.z) / along.z;
        return along.z > 0.0 && at_m <= s->range_m ? at_m : NAN;
    }
    double step_m = s->range_m / MOST_STEPS, above_m = g->plane_depth_m - from_m.z;
    step_m = g->relief->columns > 0 ? fmax(0.5 * g->relief->cell_m, step_m) : step_m;
    way w = set_out(s, pose, along);
    for (double at_m = step_m; at_m <= s->range_m; at_m += step_m) {
        asdic_vec3 here_m = asdic_vec3_add(from_m, reach(&w, at_m));
        double below_m = here_m.z - asdic_seafloor_depth_m(g, here_m.x, here_m.y);
        if (below_m >= 0.0) { /* between two steps a plane is met where it lies */
            return g->relief->columns > 0 ? at_m : at_m - step_m * below_m / (below_m + above_m);
        }
        if (s->layers && here_m.z < 0.0) {
            return NAN;
        }
        above_m = -below_m;
    }
    return NAN;
}

/* DOWN from the axis of CUT. */
static sight look(const asdic_seafloor *g, const asdic_swath *s, const asdic_pose *pose,
                  const cut *c, double down_rad) {
    asdic_vec3 along = direction(pose, c->beam, c->azimuth_rad, down_rad);
    return (sight){along, meet(g, s, pose, along)};
}

/* The last direction from MET, which meets the bottom, towards MISSED that does. */
static sight last_met(const asdic_seafloor *g, const asdic_swath *s, const asdic_pose *pose,
                      const cut *c, double met_rad, double missed_rad) {
    sight last = look(g, s, pose, c, met_rad);
    for (int i = 0; i < HALVINGS; i++) {
        double middle_rad = 0.5 * (met_rad + missed_rad);
        sight middle = look(g, s, pose, c, middle_rad);
        if (isnan(middle.at_m)) {
            missed_rad = middle_rad;
        } else {
            met_rad = middle_rad;
            last = middle;
        }
    }
    return last;
}

static void find_edges(const asdic_seafloor *g, const asdic_swath *s, const asdic_pose *pose,
                       cut *c) {
    double half_rad = c->half_rad, met_rad = NAN;
    c->lower = look(g, s, pose, c, half_rad);
    c->upper = look(g, s, pose, c, -half_rad);
    bool has_lower = !isnan(c->lower.at_m), has_upper = !isnan(c->upper.at_m);
    if (has_lower || has_upper) {
        met_rad = has_lower ? half_rad : -half_rad;
    }
    for (int i = 1; i < DOWNWARD - 1 && isnan(met_rad); i++) {
        double down_rad = half_rad * (1.0 - 2.0 * i / (DOWNWARD - 1));
        met_rad = isnan(look(g, s, pose, c, down_rad).at_m) ? NAN : down_rad;
    }
    if (!has_lower && !isnan(met_rad)) {
        c->lower = last_met(g, s, pose, c, met_rad, half_rad);
    }
    if (!has_upper && !isnan(met_rad)) {
        c->upper = last_met(g, s, pose, c, met_rad, -half_rad);
    }
}

static void add_point(asdic_chart_area *area, const asdic_swath *s, const asdic_pose *pose,
                      asdic_vec3 along, double at_m) {
    way w = set_out(s, pose, along);
    asdic_vec3 there_m = reach(&w, at_m);
    area->north_m[area->count] = pose->position_m.x + there_m.x;
    area->east_m[area->count++] = pose->position_m.y + there_m.y;
}

void asdic_swath_take(asdic_swath *s, const asdic_sonar *sonar, size_t index) {
    bool is_apart = sonar->receiver_count <= ASDIC_SWATH_APART,
         is_fan = asdic_beams_make_fan(sonar);
    size_t end = is_fan && !is_apart ? sonar->receiver_count : index + 1;
    for (; !is_apart && end < sonar->receiver_count; end++) {
        const asdic_beam *beam = &sonar->receivers[end], *before = beam - 1;
        double step_rad = beam->yaw_rad - before->yaw_rad;
        double touch_rad = 0.5 * asdic_half_power_rad(s->wavelength_m, beam->length_h_m) +
                           0.5 * asdic_half_power_rad(s->wavelength_m, before->length_h_m);
        if (!(step_rad > 0.0 && step_rad <= touch_rad)) {
            break;
        }
    }
    s->beams = &sonar->receivers[index];
    s->count = end - index;
}

asdic_status asdic_footprint_find(asdic_context *ctx, const asdic_swath *s, const asdic_pose *pose,
                                  const asdic_seafloor *ground, asdic_chart_area *out) {
    cut cuts[MOST_ACROSS];
    bool is_round = goes_round(s);
    size_t n = cut_swath(s, is_round, cuts);
    *out = (asdic_chart_area){.north_m = malloc(2 * MOST_ACROSS * sizeof(double)),
                              .east_m = malloc(2 * MOST_ACROSS * sizeof(double))};
    if (!out->north_m || !out->east_m) {
        asdic_footprint_finish(out);
        return asdic_fail_memory(ctx, "a footprint");
    }
    out->dashed = true;
    for (size_t i = 0; i < n; i++) {
        find_edges(ground, s, pose, &cuts[i]);
        out->dashed = out->dashed && isnan(cuts[i].lower.at_m);
    }
    if (out->dashed && !is_round) {
        add_point(out, s, pose, cuts[0].upper.along, 0.0);
    }
    /* The lobe ends with the outermost cuts that meet the bottom. Between them, one that misses it
     * has no width, at the full range: a chord between its neighbours would enclose what no beam
     * sees. */
    size_t begin = 0, end = n;
    while (!out->dashed && isnan(cuts[begin].lower.at_m)) {
        begin++;
    }
    while (!out->dashed && isnan(cuts[end - 1].lower.at_m)) {
        end--;
    }
    for (size_t i = begin; i < end && !out->dashed; i++) {
        bool is_missed = isnan(cuts[i].lower.at_m);
        add_point(out, s, pose, is_missed ? cuts[i].upper.along : cuts[i].lower.along,
                  is_missed ? s->range_m : cuts[i].lower.at_m);
    }
    for (size_t i = end; i-- > begin;) {
        const sight *upper = &cuts[i].upper;
        asdic_vec3 axis = direction(pose, cuts[i].beam, cuts[i].azimuth_rad, 0.0);
        add_point(out, s, pose, out->dashed ? axis : upper->along,
                  isnan(upper->at_m) ? s->range_m : upper->at_m);
    }
    return ASDIC_OK;
}

void asdic_footprint_finish(asdic_chart_area *area) {
    free(area->north_m);
    free(area->east_m);
    *area = (asdic_chart_area){0};
}
