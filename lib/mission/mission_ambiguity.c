/*
 * The remark on meshes that may be of plates or of a round body that is cut coarsely, where the echo hangs on it.
 */
#include "mission.h"

#include "base/quadrature.h"
#include "base/vec.h"
#include "laws/scatterer.h"
#include "scene/ambiguity.h"

#include <math.h>
#include <stdlib.h>

/* From so many decibels on that hang on whether faces are flat or round it is remarked, of so many meshes. */
#define AT_STAKE_DB 1.0
#define MOST_MESHES 3

/* A flat face of a material, heard at a range. */
typedef struct face {
    asdic_scatterer material;
    double area_m2, range_m;
} face;

static double strength_at(const face *f, double incidence_rad) {
    double cosine = cos(incidence_rad), sine = sin(incidence_rad);
    const asdic_incidence at = {
        .sine = cosine, .cos2 = sine * sine, .coherent_m2 = f->area_m2, .range_m = f->range_m};
    return f->material.material.law->strength_lin(&f->material, &at);
}

/* The lobe may be a thousandth of a radian wide: the fourth power of X in [0, 1] is the incidence over pi / 2. */
static double lobe(double x, void *user) {
    return strength_at(user, 0.5 * ASDIC_PI * x * x * x * x) * 2.0 * ASDIC_PI * x * x * x;
}

/* What faces that each turn by TURN from the last send back square to one of them, over what the round surface does that
 * turns through all directions: a sum over the lobe by its integral. */
static double flash_db(const face *f, double turn_rad) {
    double sum = strength_at(f, 0.0);
    for (double at_rad = turn_rad; at_rad < 0.5 * ASDIC_PI; at_rad += turn_rad) {
        sum += 2.0 * strength_at(f, at_rad);
    }
    return 10.0 * log10(turn_rad * sum / (2.0 * asdic_quadrature(lobe, (void *)f, 0.0, 1.0, 1e-4)));
}

/* The triangles of the part that begins at BEGIN end there. */
static size_t end_of_part(const asdic_scene *scene, size_t begin) {
    size_t end = begin;
    while (end < scene->triangle_count &&
           scene->triangles[end].part == scene->triangles[begin].part) {
        end++;
    }
    return end;
}

/* What is found of a mesh, where it stands first. */
typedef struct searched {
    const asdic_part *part;
    size_t triangles;
    asdic_ambiguity found;
    bool is_told;
} searched;

/* Whether PART, of so many TRIANGLES, has the same mesh: of the same area, to what a rotation rounds. */
static bool is_copy(const searched *a, const asdic_part *part, size_t triangles) {
    return a->triangles == triangles &&
           fabs(a->part->area_m2 - part->area_m2) < 1e-5 * part->area_m2;
}

/* Each mesh is searched once, and told once, however often it stands there. */
void asdic_mission_remark_ambiguity(const asdic_mission *m, double speed_mps, asdic_remarks *out) {
    const asdic_scene *scene = m->scene;
    const asdic_sonar *sonar = &m->settings.sonar;
    const asdic_law_water water = {.frequency_hz = sonar->frequency_hz,
                                   .sound_speed_mps = speed_mps,
                                   .wavelength_m = speed_mps / sonar->frequency_hz};
    searched *all = calloc(scene->part_count + 1, sizeof *all);
    size_t meshes = 0, told = 0, end;
    for (size_t i = 0; all && i < scene->triangle_count && told < MOST_MESHES; i = end) {
        const asdic_part *part = &scene->parts[scene->triangles[i].part];
        size_t k = 0;
        end = end_of_part(scene, i);
        if (!asdic_scene_may_be_ambiguous(scene, part)) {
            continue;
        }
        while (k < meshes && !is_copy(&all[k], part, end - i)) {
            k++;
        }
        searched *a = &all[k];
        if (k == meshes) {
            *a = (searched){.part = part, .triangles = end - i};
            a->is_told =
                asdic_scene_find_ambiguity(scene, i, end, &a->found) || a->found.edges == 0;
            meshes++;
        }
        if (a->is_told || out->count >= ASDIC_MOST_REMARKS) {
            continue;
        }
        const face f = {asdic_scatterer_at(&scene->materials[part->material], &water),
                        a->found.area_m2, asdic_sonar_max_range_m(sonar, speed_mps)};
        double db = flash_db(&f, a->found.turn_rad);
        if (db > AT_STAKE_DB) {
            asdic_remark_add(
                out,
                "objects: '%s' has %zu edges of up to %.3g degrees where plates may meet, or a "
                "round body be cut: %.1f dB square to a face; default round below %g, "
                "'crease_deg: 0' all plates, %g all round",
                part->name, a->found.edges, a->found.most_rad * (180.0 / ASDIC_PI), db,
                ASDIC_CREASE_RAD * (180.0 / ASDIC_PI), ASDIC_ROUND_DEG);
            a->is_told = true;
            told++;
        }
    }
    free(all);
}
