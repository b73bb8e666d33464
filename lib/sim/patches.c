#include "patches.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/context.h"
#include "base/grow.h"
#include "base/vec.h"
#include "border.h"
#include "piece.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Scatterers lie as dense as this share of what they would in the beam's middle, at least. */
#define LEAST_LOUD 0.0625
/* A resolution cell has this many scatterers in the directions of beams, at least: the variance of its energy
 * is then below 1 %, and speckle is Rayleigh's. */
#define LEAST_OF_CELL 5.0
/* A face that meets bottom or surface may cross it by this much, for rounding. */
#define TOUCHING_M 1e-4
/* Lattices of seeds that follow each other begin far apart: the plastic number's inverse powers, by which the water's
 * scatterers follow each other as well. */
#define STEP_1 0xC13FA9A9u
#define STEP_2 0x91E10DA5u
/* Share of the scatterers that is in the water, and into how many strips each shell of it is cut. */
#define WATER_SHARE 0.25
/* Of the water, whose lattice has three dimensions and no borders, fewer do: its energy then varies by 1 %. */
#define LEAST_OF_WATER 3.5
#define STRIPS 48
/* Pieces are cut to this share of their distance, at most. */
#define WIDEST_PIECE 0.125
/* Half of the energy that roughness leaves to the mirror direction is lost at g = ln 2. Beyond this g, nothing
 * is left of phase: exp(-14) is 60 dB. */
#define MOST_ROUGHNESS 14.0
#define LEAST_ROUGHNESS 1e-6
/* A smooth piece is one number, that of its middle, for every element and all of the pulse (facet_form.h). So along each edge
 * the phase there and back may turn by this much, */
#define SMOOTH_TURNS 0.5
/* of an edge that stands for an area, where those of unlike parts would add up, by half of that, */
#define EDGE_TURNS 0.25
/* depart from even by this many wavelengths, edge^2 / range, */
#define SMOOTH_BENT 0.02
/* and what it turns by, times what more it turns by to the end of the array, or of a face, than to its middle, be this much: as
 * that product goes what the form factor differs by. Along the array this is told, as a parabola (dev_echo). */
#define SMOOTH_ASIDE 0.1
#define SMOOTH_FACE_ASIDE 0.0075
/* Triangles longer than this many times their height are cut across first. */
#define SLIVER 4.0
/* Where a smooth face mirrors elsewhere its edges stand for its area, which is then cut no more. What an echo turns by along the
 * face goes with the sum of both ways' sines there; what this changes by to the end of the array, or of a face, is less than the
 * sum by this factor, so that what an edge sends goes evenly over the elements, */
#define EDGE_ASIDE 3.0
#define EDGE_FACE_ASIDE 8.0
/* and the square of the sum is so many times wavelength / range, at least, so that it goes evenly along a piece of the edge. */
#define EDGE_BENT 8.0
/* Faces and planes less high than this many wavelengths keep their area, which takes fewer parts than their edges. */
#define LEAST_HEIGHT_WL 0.25
/* Whether that holds for a face is asked of its quarters, so many times over. */
#define QUARTERINGS 3
/* Edges are cut to as many parts, at most, before what faces share of them is left out. */
#define PARTS_OF_SIDE 16.0

typedef struct finder {
    const asdic_simulator *sim;
    const asdic_ping_shot *shot;
    asdic_patches *out; /* NULL: scatterers are counted */
    asdic_border border;
    asdic_vec3 at;      /* the sonar, scene frame */
    double mirror_m[2]; /* depths of the planes that mirror, scene frame */
    size_t mirrors;
    double counted;
    double least_per_m2;         /* density that LEAST_OF_CELL asks for, 1 m away */
    float line[3];               /* the array's */
    double beams_from, beams_to; /* direction cosines along the line between which beams look */
    double aside_m;              /* EDGE_ASIDE and EDGE_FACE_ASIDE times that */
    double half_m;               /* from the middle of the array, or of a face, to an end */
    double face_m;               /* of a face alone */
    asdic_vec3 ahead[2];         /* the transmitter's axis, and that of elements */
    double tall_wl; /* of transmitter or element, the one that hears less of the water */
} finder;

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

/* Whether no more patches can be taken. */
static bool is_full(const finder *f) {
    const asdic_patches *all = f->out;
    return all->out_of_memory || (all->most > 0 && all->slots + f->border.count > all->most);
}

static void add_patch(finder *f, const asdic_piece *p, uint32_t count) {
    asdic_patches *all = f->out;
    if (!asdic_grow(&all->items, all->count, &all->capacity, sizeof *all->items)) {
        all->out_of_memory = true;
        return;
    }
    const dev_uint *seed = f->sim->setup.ping.seed;
    bool plane = p->kind <= DEV_KIND_OBJECT && p->triangle == ~0u; /* lattices join */
    random4 key =
        random_draw(p->name[0], p->name[1], p->name[2], RANDOM_SCATTERER, seed[0], seed[1]);
    all->items[all->count++] = (dev_patch){
        .corner = {(float)p->corner.x, (float)p->corner.y, (float)p->corner.z},
        .edge1 = {(float)p->edge1.x, (float)p->edge1.y, (float)p->edge1.z},
        .edge2 = {(float)p->edge2.x, (float)p->edge2.y, (float)p->edge2.z},
        .share = (float)(asdic_piece_area(p) / count),
        .first = (dev_uint)all->slots,
        .count = count,
        .triangle = p->triangle,
        .kind = p->kind,
        .folded = p->folded,
        .form = p->form,
        .key = {key.v[0] ^ (p->form != DEV_FORM_ROUGH ? 1u : 0u), key.v[1]},
        .start = {plane ? STEP_1 * seed[0] : key.v[0], plane ? STEP_2 * seed[0] : key.v[1]},
    };
    all->slots += count;
    all->smooth += p->form != DEV_FORM_ROUGH ? count : 0;
}

static const dev_material *law_of(const asdic_simulator *sim, size_t part) {
    return &sim->setup.scatterers[sim->setup.scene->parts[part].material].device;
}

static bool mirrors(const dev_material *law) {
    return law->law == DEV_LAW_FACET && !(law->formula[0] > 0.0f);
}

static bool keeps_phase(const dev_material *law) {
    return mirrors(law) && law->roughness_g < MOST_ROUGHNESS;
}

/* Triangle INDEX as a whole. */
static asdic_piece face_of(const finder *f, uint32_t index) {
    const dev_triangle *t = asdic_placement_triangle(f->sim->placement, index);
    asdic_vec3 v0 = {t->v0[0], t->v0[1], t->v0[2]}, v1 = {t->v1[0], t->v1[1], t->v1[2]},
               v2 = {t->v2[0], t->v2[1], t->v2[2]};
    return (asdic_piece){.corner = v0,
                         .edge1 = asdic_vec3_sub(v1, v0),
                         .edge2 = asdic_vec3_sub(v2, v0),
                         .folded = true,
                         .form = DEV_FORM_FACE,
                         .triangle = index,
                         .kind = f->sim->setup.scene->parts[t->part].kind,
                         .name = {index, 0x80000000u, 0}};
}

static void cut_piece(finder *f, const asdic_piece *p);

/* Four pieces of half the size. */
static void cut_in_four(finder *f, const asdic_piece *p) {
    for (uint32_t k = 0; k < 4; k++) {
        asdic_piece part = asdic_piece_quarter(p, k);
        cut_piece(f, &part);
    }
}

/* A piece as seen straight, and by way of every mirror. */
static size_t ways_to(const finder *f, const asdic_piece *p, asdic_vec3 way[3]) {
    for (size_t k = 0; k <= f->mirrors; k++) {
        asdic_vec3 at = asdic_piece_middle(p);
        at.z = k > 0 ? 2.0 * f->mirror_m[k - 1] - at.z : at.z;
        way[k] = asdic_vec3_sub(at, f->at);
    }
    return f->mirrors + 1;
}

/* EDGE, or a normal, as WAY number K meets it. */
static asdic_vec3 as_met(asdic_vec3 edge, size_t k) {
    edge.z = k > 0 ? -edge.z : edge.z;
    return edge;
}

/* Into how many parts an EDGE of a smooth piece P, which reaches over REACH, is to fall. */
static double parts_of(const finder *f, const asdic_piece *p, asdic_vec3 edge, double reach) {
    double wavelength_m = f->shot->water.wavelength_m, length = asdic_vec3_length(edge), most = 0.0;
    double most_turns = p->form == DEV_FORM_EDGE ? EDGE_TURNS : SMOOTH_TURNS;
    asdic_vec3 way[3];
    size_t ways = ways_to(f, p, way);
    for (size_t k = 0; k < ways; k++) {
        double range = fmax(asdic_vec3_length(way[k]), wavelength_m);
        double along = (fabs(asdic_vec3_dot(as_met(edge, k), way[k])) + length * reach) / range;
        double turns = 2.0 * fmin(along, length) / wavelength_m;
        double bent = length / sqrt(SMOOTH_BENT * wavelength_m * range);
        double per_m = length / (wavelength_m * range), more = per_m * f->half_m;
        double aside = sqrt((turns + more) * more / SMOOTH_ASIDE);
        more = per_m * f->face_m;
        aside = fmax(aside, sqrt((turns + more) * more / SMOOTH_FACE_ASIDE));
        most = fmax(fmax(most, turns / most_turns), fmax(bent, aside));
    }
    return most;
}

/* The edge of a smooth face: until equal parts of it, small enough, make it up. Where two faces share it both are cut alike. */
static void cut_side(finder *f, const asdic_piece *p, double reach) {
    if (parts_of(f, p, p->edge1, reach) <= PARTS_OF_SIDE) {
        f->out->out_of_memory |= !asdic_border_add(&f->border, p);
        return;
    }
    for (uint32_t k = 0; k < 2; k++) {
        asdic_piece half = asdic_piece_half_side(p, k);
        cut_piece(f, &half);
    }
}

/* Whether a triangle lies in the sonar's water and in front of its faces, or all elsewhere: the edges of one that is cut know
 * nothing of the cut. */
static bool is_whole(const finder *f, const asdic_piece *p) {
    const asdic_vec3 corner[3] = {p->corner, asdic_vec3_add(p->corner, p->edge1),
                                  asdic_vec3_add(p->corner, p->edge2)};
    const dev_ping *ping = f->shot->ping;
    int above = 0, below = 0, behind[2] = {0, 0}, ways = 0;
    for (int i = 0; i < 3; i++) {
        double down = corner[i].z - f->at.z;
        below += down > (double)ping->bottom_m + TOUCHING_M;
        above += -down > (double)ping->surface_m + TOUCHING_M;
        asdic_piece at = {.corner = corner[i]};
        asdic_vec3 way[3];
        size_t count = ways_to(f, &at, way);
        for (size_t k = 0; k < count; k++, ways++) {
            behind[0] += asdic_vec3_dot(f->ahead[0], way[k]) < 0.0;
            behind[1] += asdic_vec3_dot(f->ahead[1], way[k]) < 0.0;
        }
    }
    return above % 3 == 0 && below % 3 == 0 && behind[0] % ways == 0 && behind[1] % ways == 0;
}

/* Whether the edges of a triangle may stand for its area, by any pair of ways there and back. */
static bool is_aside(const finder *f, const asdic_piece *p) {
    double wavelength_m = f->shot->water.wavelength_m, reach = asdic_piece_reach(p);
    asdic_vec3 normal = asdic_vec3_cross(p->edge1, p->edge2), way[3], flat[3];
    double changes[3], least[3];
    normal = asdic_vec3_scale(normal, 1.0 / asdic_vec3_length(normal));
    size_t ways = ways_to(f, p, way);
    for (size_t k = 0; k < ways; k++) {
        double range = asdic_vec3_length(way[k]), near = range - reach;
        if (!(near > f->half_m)) {
            return false;
        }
        asdic_vec3 u = asdic_vec3_scale(as_met(way[k], k), 1.0 / range);
        flat[k] = asdic_vec3_sub(u, asdic_vec3_scale(normal, asdic_vec3_dot(u, normal)));
        changes[k] = reach / near;
        least[k] = fmax(f->aside_m / near, sqrt(EDGE_BENT * wavelength_m / near));
    }
    for (size_t i = 0; i < ways; i++) {
        for (size_t k = 0; k <= i; k++) {
            double sum = asdic_vec3_length(asdic_vec3_add(flat[i], flat[k]));
            bool is_pair = i == k || k == 0;
            if (is_pair && sum - changes[i] - changes[k] < fmax(least[i], least[k])) {
                return false;
            }
        }
    }
    return is_whole(f, p);
}

/* The same of a triangle, or of all its quarters. */
static bool has_edges_alone(const finder *f, const asdic_piece *p, int quarterings) {
    bool all = is_aside(f, p);
    for (uint32_t k = 0; !all && quarterings > 0; k++) {
        asdic_piece part = asdic_piece_quarter(p, k);
        if (!has_edges_alone(f, &part, quarterings - 1)) {
            return false;
        }
        all = k == 3;
    }
    return all;
}

/* Whether edges stand for a face of a plane that is high: of small faces each has an area that takes the carrier's wavelength for
 * the whole pulse, and the pulse at one place, where those of all that lies aside cancel but for the outline. */
static bool has_outline(const finder *f, uint32_t index) {
    asdic_planes *planes = &f->out->planes;
    if (planes->height_m[index] <= LEAST_HEIGHT_WL * f->shot->water.wavelength_m) {
        return false;
    }
    if (planes->form[index] == DEV_FORM_ROUGH) {
        asdic_piece face = face_of(f, index);
        planes->form[index] =
            has_edges_alone(f, &face, QUARTERINGS) ? DEV_FORM_EDGE : DEV_FORM_FACE;
    }
    return planes->form[index] == DEV_FORM_EDGE;
}

/* The sides of a smooth piece that edges stand for; of a whole face in a plane those of its outline. */
static void cut_sides(finder *f, const asdic_piece *p) {
    const uint32_t *beyond = &f->out->planes.beyond[3 * (size_t)p->triangle];
    bool whole = p->name[2] == 0;
    for (int k = 0; k < 3; k++) {
        if (!whole || beyond[k] == ASDIC_NO_FACE || !has_outline(f, beyond[k])) {
            asdic_piece side = asdic_piece_side(p, k);
            cut_piece(f, &side);
        }
    }
}

/* A smooth piece: until equal parts of it, small enough, cover it. Cut in four it has borders along its own edges, where what
 * parts of different size leave out matters least; slivers are cut across. */
static void cut_smooth(finder *f, const asdic_piece *p, double reach, double area) {
    const asdic_vec3 edge[3] = {p->edge1, p->edge2, asdic_vec3_sub(p->edge1, p->edge2)};
    const double least_m = LEAST_HEIGHT_WL * f->shot->water.wavelength_m;
    bool in_plane = f->out->planes.height_m[p->triangle] > least_m;
    double parts = 1.0, longest_m = 0.0;
    int longest = 0;
    for (int i = 0; i < 3; i++) {
        double length = asdic_vec3_length(edge[i]);
        parts = fmax(parts, ceil(parts_of(f, p, edge[i], reach)));
        longest = length > longest_m ? i : longest;
        longest_m = fmax(longest_m, length);
    }
    double height_m = 2.0 * area / longest_m, across = fmax(parts * height_m / longest_m, 1.0);
    bool large = in_plane || (parts > 1.0 && height_m > least_m);
    if (in_plane && p->name[2] == 0 ? has_outline(f, p->triangle)
                                    : large && has_edges_alone(f, p, QUARTERINGS)) {
        cut_sides(f, p);
    } else if (parts > SLIVER * across) {
        for (uint32_t k = 0; k < 2; k++) {
            asdic_piece half = asdic_piece_half(p, longest, k);
            cut_piece(f, &half);
        }
    } else if (parts * parts > DEV_PATCH_SCATTERERS) {
        cut_in_four(f, p);
    } else {
        add_patch(f, p, (uint32_t)(parts * parts));
    }
}

/* Whether beams look at a piece that is WAY off and reaches over REACH. */
static bool near_beams(const finder *f, asdic_vec3 way, double reach) {
    double range = fmax(asdic_vec3_length(way), 1e-9), sine = fmin(reach / range, 1.0);
    const float *line = f->line;
    double y = (line[0] * way.x + line[1] * way.y + line[2] * way.z) / range;
    return y + sine > f->beams_from && y - sine < f->beams_to;
}

/* As long as the pulse. */
static double cell_m(const finder *f) {
    return 0.5 * f->shot->water.sound_speed_mps / f->sim->setup.sonar.bandwidth_hz;
}

/* How large the sonar is, what its beams look at, and how dense scatterers then are: a cell is as wide as the unshaded
 * array's beam, and as long as the pulse. */
static void look_at_beams(finder *f) {
    const asdic_sonar *sonar = &f->sim->setup.sonar;
    const dev_beam *beams = asdic_shot_beams(f->shot);
    double wavelength_m = f->shot->water.wavelength_m;
    dev_beam element = asdic_aim_beam(&sonar->array.element, &f->shot->pose, wavelength_m);
    double wide =
        fmin(wavelength_m / (sonar->array.spacing_m * (double)sonar->array.elements), 1.0);
    f->least_per_m2 = LEAST_OF_CELL / (wide * cell_m(f));
    /* Where an element looks as high as the transmitter does, the taller one. */
    const asdic_beam *faces[] = {&sonar->transmitter, &sonar->array.element};
    f->half_m = 0.5 * sonar->array.spacing_m * (double)(sonar->array.elements - 1);
    f->aside_m = EDGE_ASIDE * f->half_m;
    for (int k = 0; k < 2; k++) {
        double half_m = 0.5 * fmax(faces[k]->length_h_m, faces[k]->length_v_m);
        f->face_m = fmax(f->face_m, half_m);
        f->half_m = fmax(f->half_m, half_m);
        f->aside_m = fmax(f->aside_m, EDGE_FACE_ASIDE * half_m);
    }
    const float *ahead = beams[0].rows, *down = element.rows + 6;
    double apart = fabs(ahead[0] * down[0] + ahead[1] * down[1] + ahead[2] * down[2]);
    for (int k = 0; k < 2; k++) {
        const float *axis = k ? element.rows : ahead;
        f->ahead[k] = (asdic_vec3){axis[0], axis[1], axis[2]};
    }
    bool alike = apart * element.length_v_wl < 0.5;
    f->tall_wl = fmax(beams[0].length_v_wl, alike ? element.length_v_wl : 0.0f);
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
static demand ask(const finder *f, const asdic_piece *p, double reach, double area) {
    demand most = {0.0, 0.0, 0.0};
    asdic_vec3 to[3];
    size_t ways = ways_to(f, p, to);
    for (size_t k = 0; k < ways; k++) {
        asdic_vec3 way = to[k];
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
static void cut_piece(finder *f, const asdic_piece *p) {
    const dev_ping *ping = f->shot->ping;
    double range = asdic_vec3_length(asdic_vec3_sub(asdic_piece_middle(p), f->at));
    double reach = asdic_piece_reach(p), area = asdic_piece_area(p);
    if (range - reach > ping->range_m || area <= 0.0 || (f->out && is_full(f))) {
        return;
    }
    demand asked = ask(f, p, reach, area);
    if (asked.wanted == 0.0 || asked.farthest_m + reach < ping->blanking_m) {
        return;
    }
    if (p->form == DEV_FORM_EDGE) {
        cut_side(f, p, reach);
        return;
    }
    if (p->form == DEV_FORM_FACE) {
        cut_smooth(f, p, reach, area);
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
            asdic_piece p = {
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
    asdic_piece p = face_of(f, (uint32_t)index);
    const dev_triangle *t = asdic_placement_triangle(f->sim->placement, index);
    const dev_material *law = law_of(f->sim, t->part);
    if (!mirrors(law) || law->roughness_g > LEAST_ROUGHNESS) {
        asdic_piece rough = p;
        rough.form = DEV_FORM_ROUGH;
        cut_piece(f, &rough);
    }
    /* As many smooth ones as phase asks for: they are not counted first. */
    if (f->out && keeps_phase(law)) {
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
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = asdic_placement_triangle(sim->placement, i);
        if (objects || scene->parts[t->part].kind == DEV_KIND_BOTTOM) {
            cut_triangle(f, i);
        }
    }
}

/* What is left of the edges of smooth faces, when all are known; where there is no room they are counted alone. */
static void add_border(finder *f) {
    if (is_full(f)) {
        f->out->slots += f->border.count;
        f->border.count = 0;
    }
    asdic_border_join(&f->border, f->sim->placement);
    for (size_t i = 0; i < f->border.count && !f->out->out_of_memory; i++) {
        const asdic_piece *p = &f->border.sides[i];
        double parts = ceil(parts_of(f, p, p->edge1, asdic_piece_reach(p)));
        add_patch(f, p, (uint32_t)fmax(parts, 1.0));
    }
    free(f->border.sides);
    f->border = (asdic_border){0};
}

/* How many scatterers a shell of water has in each of STRIPS equal shares of the azimuth about the transmitter. */
typedef struct strips {
    double begin_rad, width_rad, count[STRIPS];
} strips;

/* WANTED of a shell that is THICK: as loud as the transmitter is there, and LEAST_OF_CELL in cells that beams look at. */
static strips strips_of(const finder *f, double wanted, double thick) {
    const float *r = asdic_shot_beams(f->shot)->rows;
    bool behind = f->shot->ping->rear_lin > 0.0f || f->mirrors > 0;
    double half = behind ? ASDIC_PI : 0.5 * ASDIC_PI, rise = fmin(1.0 / f->tall_wl, 1.0);
    strips s = {.begin_rad = -half, .width_rad = 2.0 * half / STRIPS};
    /* How far, as a sine, what is heard of a strip lies from its middle: by azimuth, and by elevation. */
    double sine = 0.5 * s.width_rad + 1.0 - sqrt(1.0 - rise * rise), loud[STRIPS], sum = 0.0;
    for (int i = 0; i < STRIPS; i++) {
        double phi = s.begin_rad + (i + 0.5) * s.width_rad, x = cos(phi), y = sin(phi);
        asdic_vec3 u = {r[0] * x + r[3] * y, r[1] * x + r[4] * y, r[2] * x + r[5] * y};
        loud[i] = fmax(loudness(f, u, sine), LEAST_LOUD);
        sum += loud[i];
        double least = LEAST_OF_WATER / LEAST_OF_CELL * f->least_per_m2 * thick * s.width_rad;
        s.count[i] = near_beams(f, u, sine) ? least : 0.0;
    }
    for (int i = 0; i < STRIPS; i++) {
        s.count[i] = ceil(fmax(s.count[i], wanted * loud[i] / sum));
    }
    return s;
}

/* Shells of water, each as thick as the pulse is long, new in every ping: what scatters there drifts. Those of a shell are
 * numbers of one lattice (scatterers.cl), which all shells of a ping begin alike: neighbours join. */
static void cut_water(finder *f, double wanted) {
    const dev_ping *ping = f->shot->ping;
    const dev_uint *seed = f->sim->setup.ping.seed;
    /* What is too near straight may be heard by way of a mirror. */
    double from = f->mirrors > 0 ? 0.0 : ping->blanking_m, depth = ping->range_m - from;
    if (f->sim->setup.sampling.left_out & (1u << ASDIC_TERM_VOLUME) ||
        ping->range_m <= ping->blanking_m) {
        return;
    }
    size_t shells = (size_t)ceil(depth / cell_m(f));
    double thick = depth / (double)shells;
    strips s = strips_of(f, wanted / (double)shells, thick);
    asdic_piece p = {.edge1 = {thick, 0.0, 0.0},
                     .triangle = ~0u,
                     .kind = DEV_KIND_WATER,
                     .name = {0, ping->ping[0], 0x40000000u + ping->ping[1]}};
    random4 begin = random_draw(~0u, p.name[1], p.name[2], RANDOM_SCATTERER, seed[0], seed[1]);
    p.corner.z = f->tall_wl;
    for (size_t i = 0; i < shells; i++) {
        p.corner.x = from + (double)i * thick;
        uint32_t number = 0;
        for (int k = 0; k < STRIPS; k++) {
            double parts = ceil(s.count[k] / DEV_PATCH_SCATTERERS);
            uint32_t count = (uint32_t)ceil(s.count[k] / fmax(parts, 1.0));
            p.edge1.y = s.width_rad / parts;
            for (int part = 0; part < parts && !is_full(f); part++, p.name[0]++) {
                double shift = random_uniform(begin.v[2]) - 0.5; /* of the lattice, by azimuth */
                p.corner.y = s.begin_rad + k * s.width_rad + (part + shift / count) * p.edge1.y;
                add_patch(f, &p, count);
                if (f->out->out_of_memory) {
                    return;
                }
                dev_patch *made = &f->out->items[f->out->count - 1];
                made->share = (float)(thick * p.edge1.y / count);
                made->start[0] = begin.v[0] + STEP_1 * number;
                made->start[1] = begin.v[1] + STEP_2 * number;
                number += count;
            }
        }
    }
}

static void add_points(finder *f) {
    const asdic_scene *scene = f->sim->setup.scene;
    for (size_t i = 0; i < scene->point_count && !f->out->out_of_memory; i++) {
        const asdic_point *point = &f->sim->placement->points[i];
        asdic_vec3 at = asdic_vec3_sub(point->position_m, f->sim->placement->origin_m);
        asdic_piece p = {.corner = at,
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

/* The planes of what keeps its phase; none are looked for where nothing does. Moved bodies keep theirs. */
static bool find_planes(const asdic_simulator *sim, asdic_planes *planes) {
    size_t parts = sim->setup.scene->part_count;
    bool any = false, *smooth = calloc(parts + 1, sizeof *smooth);
    for (size_t i = 0; smooth && i < parts; i++) {
        smooth[i] = keeps_phase(law_of(sim, i));
        any |= smooth[i];
    }
    bool found = smooth && (!any || asdic_planes_find(sim->placement, smooth, planes));
    free(smooth);
    return found;
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
    out->count = out->slots = out->smooth = 0;
    out->out_of_memory = false;
    if (!out->planes.form && !find_planes(sim, &out->planes)) {
        return asdic_fail_memory(sim->ctx, "the planes of smooth bodies");
    }
    if (out->planes.form) {
        memset(out->planes.form, DEV_FORM_ROUGH, out->planes.count);
    }
    cut_surfaces(&f); /* counts */
    /* Counts are rounded up to powers of two, on average by 1.44. */
    out->per_m2 = (1.0 - WATER_SHARE) * wanted / (1.44 * fmax(f.counted, 1e-12));
    look_at_beams(&f);
    f.out = out;
    cut_surfaces(&f);
    add_border(&f);
    cut_water(&f, WATER_SHARE * wanted);
    add_points(&f);
    return out->out_of_memory ? asdic_fail_memory(sim->ctx, "scatterers") : ASDIC_OK;
}

void asdic_patches_finish(asdic_patches *patches) {
    free(patches->items);
    asdic_planes_finish(&patches->planes);
    *patches = (asdic_patches){0};
}
