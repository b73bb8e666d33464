#include "patches.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/context.h"
#include "base/vec.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Scatterers lie as dense as this share of what they would in the beam's middle, at least. */
#define LEAST_LOUD 0.0625
/* A resolution cell has this many scatterers in the directions of beams, at least: the variance of its energy
 * is then below 1 %, and speckle is Rayleigh's. */
#define LEAST_OF_CELL 5.0
/* Lattices of seeds that follow each other begin far apart: the plastic number's inverse powers. */
#define STEP_1 0xC13FA9A9u
#define STEP_2 0x91E10DA5u
/* Share of the scatterers that is in the water. */
#define WATER_SHARE 0.25
/* Pieces are cut to this share of their distance, at most. */
#define WIDEST_PIECE 0.125
/* Half of the energy that roughness leaves to the mirror direction is lost at g = ln 2. Beyond this g, nothing
 * is left of phase: exp(-14) is 60 dB. */
#define MOST_ROUGHNESS 14.0
#define LEAST_ROUGHNESS 1e-6

/* A patch before it is cut: a parallelogram, or one half of it. */
typedef struct piece {
    asdic_vec3 corner, edge1, edge2; /* scene frame */
    bool folded, smooth;
    dev_uint triangle, kind;
    uint32_t name[3]; /* the same for the same piece of the world */
} piece;

typedef struct finder {
    const asdic_simulator *sim;
    const asdic_ping_shot *shot;
    asdic_patches *out; /* NULL: scatterers are counted */
    asdic_vec3 at;      /* the sonar, scene frame */
    double mirror_m[2]; /* depths of the planes that mirror, scene frame */
    size_t mirrors;
    double counted, smooth_m2;
    double least_per_m2;         /* density that LEAST_OF_CELL asks for, 1 m away */
    float line[3];               /* the array's */
    double beams_from, beams_to; /* direction cosines along the line between which beams look */
} finder;

static asdic_vec3 middle_of(const piece *p) {
    double share = p->folded ? 1.0 / 3.0 : 0.5;
    return asdic_vec3_add(p->corner, asdic_vec3_scale(asdic_vec3_add(p->edge1, p->edge2), share));
}

static double area_of(const piece *p) {
    double area = asdic_vec3_length(asdic_vec3_cross(p->edge1, p->edge2));
    return p->folded ? 0.5 * area : area;
}

static double length_of(const piece *p) {
    return fmax(fmax(asdic_vec3_length(p->edge1), asdic_vec3_length(p->edge2)),
                asdic_vec3_length(asdic_vec3_sub(p->edge1, p->edge2)));
}

/* Farthest that a point of the piece is from its middle. */
static double reach_of(const piece *p) {
    asdic_vec3 middle = middle_of(p), ends[4] = {p->corner, asdic_vec3_add(p->corner, p->edge1),
                                                 asdic_vec3_add(p->corner, p->edge2)};
    ends[3] = p->folded ? p->corner : asdic_vec3_add(ends[1], p->edge2);
    double most = 0.0;
    for (int i = 0; i < 4; i++) {
        most = fmax(most, asdic_vec3_length(asdic_vec3_sub(ends[i], middle)));
    }
    return most;
}

/* Envelope of sinc^2, nulls filled. */
static double envelope(double x) {
    return 1.0 / (1.0 + ASDIC_PI * ASDIC_PI * x * x);
}

/* How dense scatterers lie towards U, a piece away that reaches over SINE of its distance; 0: nothing is
 * heard from there. */
static double loudness(const finder *f, asdic_vec3 u, double sine) {
    const dev_beam *beam = asdic_shot_beams(f->shot);
    const float *r = beam->rows;
    double x = r[0] * u.x + r[1] * u.y + r[2] * u.z, y = r[3] * u.x + r[4] * u.y + r[5] * u.z;
    double z = r[6] * u.x + r[7] * u.y + r[8] * u.z;
    if (x < -sine && !(f->shot->ping->rear_lin > 0.0f)) {
        return 0.0;
    }
    y = fmax(fabs(y) - sine, 0.0);
    z = fmax(fabs(z) - sine, 0.0);
    return fmax(sqrt(envelope(beam->length_h_wl * y) * envelope(beam->length_v_wl * z)),
                LEAST_LOUD);
}

static void add_patch(finder *f, const piece *p, uint32_t count) {
    asdic_patches *all = f->out;
    if (all->count == all->capacity) {
        size_t capacity = all->capacity ? 2 * all->capacity : 4096;
        dev_patch *items = realloc(all->items, capacity * sizeof *items);
        if (!items) {
            all->out_of_memory = true;
            return;
        }
        all->items = items;
        all->capacity = capacity;
    }
    const dev_uint *seed = f->sim->setup.ping.seed;
    bool plane = p->kind <= DEV_KIND_OBJECT && p->triangle == ~0u; /* lattices join */
    random4 key =
        random_draw(p->name[0], p->name[1], p->name[2], RANDOM_SCATTERER, seed[0], seed[1]);
    all->items[all->count++] = (dev_patch){
        .corner = {(float)p->corner.x, (float)p->corner.y, (float)p->corner.z},
        .edge1 = {(float)p->edge1.x, (float)p->edge1.y, (float)p->edge1.z},
        .edge2 = {(float)p->edge2.x, (float)p->edge2.y, (float)p->edge2.z},
        .share = (float)(area_of(p) / count),
        .first = (dev_uint)all->slots,
        .count = count,
        .triangle = p->triangle,
        .kind = p->kind,
        .folded = p->folded,
        .smooth = p->smooth,
        .key = {key.v[0] ^ (p->smooth ? 1u : 0u), key.v[1]},
        .start = {plane ? STEP_1 * seed[0] : key.v[0], plane ? STEP_2 * seed[0] : key.v[1]},
    };
    all->slots += count;
}

static void cut_piece(finder *f, const piece *p);

/* Four pieces of half the size. */
static void cut_in_four(finder *f, const piece *p) {
    asdic_vec3 a = asdic_vec3_scale(p->edge1, 0.5), b = asdic_vec3_scale(p->edge2, 0.5);
    asdic_vec3 far = asdic_vec3_add(p->corner, asdic_vec3_add(a, b));
    const asdic_vec3 corner[4] = {p->corner, asdic_vec3_add(p->corner, a),
                                  asdic_vec3_add(p->corner, b), far};
    for (uint32_t k = 0; k < 4; k++) {
        piece part = *p;
        part.corner = corner[k];
        part.edge1 = a;
        part.edge2 = b;
        if (p->folded && k == 3) { /* the triangle in the middle stands on its head */
            part.edge1 = asdic_vec3_scale(a, -1.0);
            part.edge2 = asdic_vec3_scale(b, -1.0);
        }
        part.name[2] = 4u * p->name[2] + k + 1u;
        cut_piece(f, &part);
    }
}

/* A triangle in two, through the middle of its longest edge. */
static void cut_in_two(finder *f, const piece *p) {
    asdic_vec3 a = p->corner, b = asdic_vec3_add(a, p->edge1), c = asdic_vec3_add(a, p->edge2);
    double ab = asdic_vec3_length(p->edge1), ac = asdic_vec3_length(p->edge2);
    double bc = asdic_vec3_length(asdic_vec3_sub(c, b));
    asdic_vec3 top = c, left = a, right = b; /* of the edge, and the corner across */
    if (bc >= ab && bc >= ac) {
        top = a, left = b, right = c;
    } else if (ac >= ab) {
        top = b, left = c, right = a;
    }
    asdic_vec3 middle = asdic_vec3_scale(asdic_vec3_add(left, right), 0.5);
    for (uint32_t k = 0; k < 2; k++) {
        piece part = *p;
        part.corner = top;
        part.edge1 = asdic_vec3_sub(k ? middle : left, top);
        part.edge2 = asdic_vec3_sub(k ? right : middle, top);
        part.name[2] = 2u * p->name[2] + k + 1u;
        cut_piece(f, &part);
    }
}

/* A smooth piece: until equal parts of it, as long as smooth_m, cover it. Slivers are not cut across. */
static void cut_smooth(finder *f, const piece *p) {
    if (!f->out) {
        f->smooth_m2 += area_of(p);
        return;
    }
    double length = length_of(p), side = ceil(length / f->out->smooth_m);
    double width = 2.0 * area_of(p) / length;
    double needed = side * fmax(width / f->out->smooth_m, 1.0);
    if (side * side > DEV_PATCH_SCATTERERS || side * side > 2.0 * needed + 1.0) {
        cut_in_two(f, p);
    } else {
        add_patch(f, p, (uint32_t)(side * side));
    }
}

/* Whether beams look at a piece that is WAY off and reaches over REACH. */
static bool near_beams(const finder *f, asdic_vec3 way, double reach) {
    double range = fmax(asdic_vec3_length(way), 1e-9), sine = fmin(reach / range, 1.0);
    const float *line = f->line;
    double y = (line[0] * way.x + line[1] * way.y + line[2] * way.z) / range;
    return y + sine > f->beams_from && y - sine < f->beams_to;
}

/* What beams look at, and how dense scatterers then are: a cell is as wide as the unshaded array's beam, and as
 * long as the pulse. */
static void look_at_beams(finder *f) {
    const asdic_sonar *sonar = &f->sim->setup.sonar;
    const dev_beam *beams = asdic_shot_beams(f->shot);
    double wavelength_m = f->shot->water.wavelength_m;
    dev_beam element = asdic_aim_beam(&sonar->array.element, &f->shot->pose, wavelength_m);
    double wide =
        fmin(wavelength_m / (sonar->array.spacing_m * (double)sonar->array.elements), 1.0);
    double cell = 0.5 * f->shot->water.sound_speed_mps / sonar->bandwidth_hz;
    f->least_per_m2 = LEAST_OF_CELL / (wide * cell);
    memcpy(f->line, element.rows + 3, sizeof f->line);
    f->beams_from = 1.0;
    f->beams_to = -1.0;
    for (size_t b = 1; b <= sonar->receiver_count; b++) {
        const float *axis = beams[b].rows;
        double y = axis[0] * f->line[0] + axis[1] * f->line[1] + axis[2] * f->line[2];
        f->beams_from = fmin(f->beams_from, y - wide);
        f->beams_to = fmax(f->beams_to, y + wide);
    }
}

/* How many scatterers a piece asks for, in any unit, and for what beams look at, at least; how far away it is heard
 * from at most. */
typedef struct demand {
    double wanted, least, farthest_m;
} demand;

/* The most of what the straight way asks for, and those by way of mirrors: what lies behind may be loud there. */
static demand ask(const finder *f, const piece *p, double reach, double area) {
    demand most = {0.0, 0.0, 0.0};
    for (size_t k = 0; k <= f->mirrors; k++) {
        asdic_vec3 at = middle_of(p);
        at.z = k > 0 ? 2.0 * f->mirror_m[k - 1] - at.z : at.z;
        asdic_vec3 way = asdic_vec3_sub(at, f->at);
        double range = asdic_vec3_length(way), near = fmax(range, 0.5 * f->shot->ping->blanking_m);
        double loud = loudness(f, asdic_vec3_scale(way, 1.0 / fmax(range, 1e-9)),
                               fmin(reach / fmax(range, 1e-9), 1.0));
        most.wanted = fmax(most.wanted, area * loud / near);
        if (loud > 0.0 && near_beams(f, way, reach)) {
            most.least = fmax(most.least, area * f->least_per_m2 / near);
        }
        most.farthest_m = fmax(most.farthest_m, range);
    }
    return most;
}

/* Cuts a piece until DEV_PATCH_SCATTERERS suffice it, and takes what may be heard. */
static void cut_piece(finder *f, const piece *p) {
    const dev_ping *ping = f->shot->ping;
    double range = asdic_vec3_length(asdic_vec3_sub(middle_of(p), f->at));
    double reach = reach_of(p), area = area_of(p);
    if (range - reach > ping->range_m || area <= 0.0) {
        return;
    }
    demand asked = ask(f, p, reach, area);
    if (asked.wanted == 0.0 || asked.farthest_m + reach < ping->blanking_m) {
        return;
    }
    if (p->smooth) {
        cut_smooth(f, p);
        return;
    }
    double near = fmax(range, 0.5 * ping->blanking_m), wanted = asked.wanted;
    bool wide = reach > WIDEST_PIECE * near && reach > 0.05;
    if (!f->out) {
        if (wide) {
            cut_in_four(f, p);
        } else {
            f->counted += wanted;
        }
        return;
    }
    wanted = fmax(wanted * f->out->per_m2, asked.least);
    if (wide || wanted > DEV_PATCH_SCATTERERS) {
        cut_in_four(f, p);
        return;
    }
    uint32_t count = 1;
    while (count < wanted) {
        count *= 2;
    }
    add_patch(f, p, count);
}

/* A plane at DEPTH: squares whose corners have whole numbers. */
static void cut_plane(finder *f, double depth_m, dev_uint kind) {
    const asdic_ping_shot *shot = f->shot;
    asdic_vec3 origin = f->sim->placement->origin_m;
    double side = exp2(ceil(log2(shot->ping->range_m)));
    double x = floor(shot->pose.position_m.x / side), y = floor(shot->pose.position_m.y / side);
    for (int i = -1; i <= 1; i++) {
        for (int j = -1; j <= 1; j++) {
            piece p = {
                .corner = {(x + i) * side - origin.x, (y + j) * side - origin.y,
                           depth_m - origin.z},
                .edge1 = {side, 0.0, 0.0},
                .edge2 = {0.0, side, 0.0},
                .triangle = ~0u,
                .kind = kind,
                .name = {(uint32_t)(int32_t)(x + i), (uint32_t)(int32_t)(y + j) ^ kind << 28, 0}};
            cut_piece(f, &p);
        }
    }
}

/* What of a material keeps its phase, and what does not. */
static void cut_triangle(finder *f, size_t index) {
    const dev_triangle *t = asdic_placement_triangle(f->sim->placement, index);
    const asdic_part *part = &f->sim->setup.scene->parts[t->part];
    const dev_material *law = &f->sim->setup.scatterers[part->material].device;
    asdic_vec3 v0 = {t->v0[0], t->v0[1], t->v0[2]}, v1 = {t->v1[0], t->v1[1], t->v1[2]},
               v2 = {t->v2[0], t->v2[1], t->v2[2]};
    piece p = {.corner = v0,
               .edge1 = asdic_vec3_sub(v1, v0),
               .edge2 = asdic_vec3_sub(v2, v0),
               .folded = true,
               .triangle = (dev_uint)index,
               .kind = part->kind,
               .name = {(uint32_t)index, 0x80000000u, 0}};
    bool mirrors = law->law == DEV_LAW_FACET && !(law->formula[0] > 0.0f);
    if (!mirrors || law->roughness_g > LEAST_ROUGHNESS) {
        cut_piece(f, &p);
    }
    if (mirrors && law->roughness_g < MOST_ROUGHNESS) {
        p.smooth = true;
        cut_piece(f, &p);
    }
}

static void cut_surfaces(finder *f) {
    const asdic_simulator *sim = f->sim;
    const asdic_scene *scene = sim->setup.scene;
    if (scene->has_bottom_plane) {
        cut_plane(f, scene->bottom_plane_depth_m, DEV_KIND_BOTTOM);
    }
    if (scene->has_surface && !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_SURFACE))) {
        cut_plane(f, 0.0, DEV_KIND_SURFACE);
    }
    bool objects = !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_OBJECTS));
    for (size_t i = 0; sim->tracer && i < scene->triangle_count; i++) {
        const dev_triangle *t = asdic_placement_triangle(sim->placement, i);
        if (objects || scene->parts[t->part].kind == DEV_KIND_BOTTOM) {
            cut_triangle(f, i);
        }
    }
}

/* Shells of water, new in every ping: what scatters there drifts. */
static void cut_water(finder *f, double wanted) {
    const dev_ping *ping = f->shot->ping;
    /* What is too near straight may be heard by way of a mirror. */
    double from = f->mirrors > 0 ? 0.0 : ping->blanking_m, depth = ping->range_m - from;
    if (f->sim->setup.sampling.left_out & (1u << ASDIC_TERM_VOLUME) ||
        ping->range_m <= ping->blanking_m) {
        return;
    }
    double pulse = 0.5 * f->shot->water.sound_speed_mps / f->sim->setup.sonar.bandwidth_hz;
    double thick = fmin(0.5 * pulse, fmax(0.25 * pulse, 8.0 * depth / wanted));
    size_t shells = (size_t)ceil(depth / thick);
    /* Even: as many go where the transmitter is loud as anywhere (scatterers.cl). */
    uint32_t each = (uint32_t)fmin(fmax(wanted / (double)shells, 8.0), DEV_PATCH_SCATTERERS) & ~1u;
    thick = depth / (double)shells;
    for (size_t i = 0; i < shells && !f->out->out_of_memory; i++) {
        piece p = {.edge1 = {thick, 0.0, 0.0},
                   .edge2 = {0.0, thick, 0.0},
                   .triangle = ~0u,
                   .kind = DEV_KIND_WATER,
                   .name = {(uint32_t)i, ping->ping[0], 0x40000000u + ping->ping[1]}};
        p.corner.x = from + (double)i * thick;
        add_patch(f, &p, each);
        if (!f->out->out_of_memory) {
            f->out->items[f->out->count - 1].share = (float)(thick / each);
        }
    }
}

static void add_points(finder *f) {
    const asdic_scene *scene = f->sim->setup.scene;
    for (size_t i = 0; i < scene->point_count && !f->out->out_of_memory; i++) {
        const asdic_point *point = &f->sim->placement->points[i];
        asdic_vec3 at = asdic_vec3_sub(point->position_m, f->sim->placement->origin_m);
        piece p = {.corner = at,
                   .triangle = ~0u,
                   .kind = DEV_KIND_POINT,
                   .name = {(uint32_t)i, 0, 0xc0000000u}};
        add_patch(f, &p, 1);
        if (!f->out->out_of_memory) {
            dev_patch *made = &f->out->items[f->out->count - 1];
            const double exact[3] = {at.x, at.y, at.z};
            for (int axis = 0; axis < 3; axis++) {
                made->edge1[axis] = (float)(exact[axis] - (double)made->corner[axis]);
            }
            made->share = (float)pow(10.0, 0.1 * point->target_strength_db);
        }
    }
}

/* The side of smooth pieces: a quarter of a wavelength resolves every lobe. More than COUNT of them cost too
 * much; larger ones lose lobes far from the mirror direction. */
static double smooth_side(const finder *f, double count) {
    return fmax(0.25 * f->shot->water.wavelength_m, sqrt(2.0 * f->smooth_m2 / count));
}

size_t asdic_patches_mirrors(const asdic_simulator *sim, double depth_m[2]) {
    const asdic_scene *scene = sim->setup.scene;
    size_t count = 0;
    if (sim->setup.sampling.multipath != ASDIC_MULTIPATH_BOUNDARIES ||
        sim->setup.sampling.left_out & (1u << ASDIC_TERM_MULTIPATH)) {
        return 0;
    }
    if (scene->has_surface) {
        depth_m[count++] = 0.0;
    }
    if (scene->has_bottom_plane) {
        depth_m[count++] = scene->bottom_plane_depth_m;
    }
    return count;
}

asdic_status asdic_patches_find(const asdic_simulator *sim, const asdic_ping_shot *shot,
                                asdic_patches *out) {
    finder f = {.sim = sim,
                .shot = shot,
                .at = asdic_vec3_sub(shot->pose.position_m, sim->placement->origin_m)};
    double wanted = sim->setup.sampling.rays;
    f.mirrors = asdic_patches_mirrors(sim, f.mirror_m);
    for (size_t i = 0; i < f.mirrors; i++) {
        f.mirror_m[i] -= sim->placement->origin_m.z;
    }
    out->count = out->slots = 0;
    out->out_of_memory = false;
    cut_surfaces(&f); /* counts */
    /* Counts are rounded up to powers of two, on average by 1.44. */
    out->per_m2 = (1.0 - WATER_SHARE) * wanted / (1.44 * fmax(f.counted, 1e-12));
    out->smooth_m = smooth_side(&f, wanted);
    look_at_beams(&f);
    f.out = out;
    cut_surfaces(&f);
    cut_water(&f, WATER_SHARE * wanted);
    add_points(&f);
    return out->out_of_memory ? asdic_fail_memory(sim->ctx, "scatterers") : ASDIC_OK;
}

void asdic_patches_finish(asdic_patches *patches) {
    free(patches->items);
    *patches = (asdic_patches){0};
}
