/*
 * Whether a mission needs phase: what interferes that pings of intensities only add.
 */
#include "mission.h"

#include "base/vec.h"
#include "out/beam_width.h"
#include "scene/scene.h"
#include "sim/environment.h"
#include "sim/array.h"
#include "sim/ring.h"

#include <math.h>
#include <stdio.h>

/* What of an echo must keep its phase, exp(-g): more roughness leaves no lobes or fringes worth a dB. */
#define MOST_ROUGHNESS 1.0

/* A body whose own lobes have phase: flat or curved, and smooth. */
static const asdic_part *smooth_part(const asdic_mission *mission, const asdic_law_water *water) {
    const asdic_scene *scene = mission->scene;
    for (size_t i = 0; i < scene->part_count; i++) {
        const asdic_part *part = &scene->parts[i];
        asdic_scatterer s = asdic_scatterer_at(&scene->materials[part->material], water);
        if (part->kind == DEV_KIND_OBJECT && s.device.law == DEV_LAW_FACET &&
            !(s.device.formula[0] > 0.0f) && s.device.roughness_g < MOST_ROUGHNESS &&
            asdic_mission_reaches(mission, part->name)) {
            return part;
        }
    }
    return NULL;
}

/* Whether the straight way from the sonar AT to a target and that by way of the surface, which keeps its phase,
 * come within one resolution cell of CELL_M. */
static bool has_image(asdic_vec3 at, asdic_vec3 target, float roughness_g, double cell_m) {
    double range = asdic_vec3_length(asdic_vec3_sub(target, at));
    double sine = (at.z + target.z) / range, longer = 2.0 * at.z * target.z / range;
    return at.z > 0.0 && target.z > 0.0 && sine < 1.0 && longer < cell_m &&
           (double)roughness_g * sine * sine < MOST_ROUGHNESS;
}

/* What has such an image; its name. */
static const char *fringed(const asdic_mission *mission, const asdic_law_water *water,
                           double cell_m) {
    const asdic_scene *scene = mission->scene;
    asdic_vec3 at = asdic_mission_pose(mission, 0, NULL).position_m;
    float g = asdic_scatterer_at(&scene->surface, water).device.roughness_g;
    if (!scene->has_surface) {
        return NULL;
    }
    for (size_t i = 0; i < scene->point_count; i++) {
        if (has_image(at, scene->points[i].position_m, g, cell_m) &&
            asdic_mission_reaches(mission, scene->points[i].name)) {
            return scene->points[i].name;
        }
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        if (scene->parts[i].kind == DEV_KIND_OBJECT &&
            has_image(at, scene->parts[i].center_m, g, cell_m) &&
            asdic_mission_reaches(mission, scene->parts[i].name)) {
            return scene->parts[i].name;
        }
    }
    return NULL;
}

/* The sine by which the outermost beam is steered from the array's front. */
static double outermost_sine(const asdic_sonar *sonar) {
    double farthest = 0.0;
    for (size_t i = 0; i < sonar->receiver_count; i++) {
        farthest = fmax(farthest, fabs(asdic_array_sine(&sonar->array, &sonar->receivers[i])));
    }
    return farthest;
}

/* Whether a beam, steered by the sine U from the array's front, hears another direction in phase as well: that of
 * U less a whole turn between elements. */
static bool has_grating_lobes(const asdic_sonar *sonar, double wavelength_m) {
    return sonar->array.elements > 0 &&
           wavelength_m / sonar->array.spacing_m < 1.0 + outermost_sine(sonar);
}

/* How far out of the array's plane sound is sent and heard, to half its power; radians. */
static double height_rad(const asdic_sonar *sonar, double wavelength_m) {
    asdic_pose level = {0};
    asdic_mat3 element = asdic_face_mount(&sonar->array.element);
    asdic_vec3 upright = {element.m[0][2], element.m[1][2], element.m[2][2]};
    double tilt = asdic_vec3_dot(asdic_beam_axis(&sonar->transmitter, &level), upright);
    double tallest_m = fmax(sonar->array.element.length_v_m, sonar->transmitter.length_v_m);
    return asin(fmin(fabs(tilt), 1.0)) + 0.5 * asdic_half_power_rad(wavelength_m, tallest_m);
}

/* How far aside of the upright plane that pings of intensities have, the outermost beam's cone lies there; NAN: by no
 * more than half its width. */
static double cone_apart_rad(const asdic_sonar *sonar, double wavelength_m) {
    const asdic_array *a = &sonar->array;
    double sine = outermost_sine(sonar);
    double level_cosine = cos(fmin(height_rad(sonar, wavelength_m), 0.5 * ASDIC_PI));
    double apart_rad = asin(fmin(sine / fmax(level_cosine, 1e-9), 1.0)) - asin(fmin(sine, 1.0));
    double seen_m = (double)a->elements * a->spacing_m * sqrt(fmax(1.0 - sine * sine, 1e-9));
    double width_rad = asdic_half_power_rad(wavelength_m, seen_m);
    return a->elements > 0 && apart_rad > 0.5 * width_rad ? apart_rad : NAN;
}

bool asdic_mission_needs_phase(const asdic_mission *mission, char *reason, size_t size) {
    if (!mission) {
        snprintf(reason, size, "there is no mission");
        return false;
    }
    const asdic_settings *s = &mission->settings;
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_water_column column = asdic_water_column_at(&s->environment, &s->sonar, depth_m);
    asdic_law_water water = asdic_water_column_laws(&column, &s->environment, &s->sonar);
    double cell_m = 0.5 * column.sound_speed_mps / s->sonar.bandwidth_hz;
    const asdic_part *smooth = smooth_part(mission, &water);
    const char *image = fringed(mission, &water, cell_m);
    bool grating = has_grating_lobes(&s->sonar, column.wavelength_m);
    double apart_rad = cone_apart_rad(&s->sonar, column.wavelength_m);
    bool shaded = s->sonar.array.elements > 0 && s->sonar.array.shading != ASDIC_SHADING_NONE;
    if (smooth) {
        snprintf(reason, size, "'%s' is smooth: its side lobes have phase", smooth->name);
    } else if (image) {
        snprintf(reason, size, "'%s' and its image in the surface are in one cell, and interfere",
                 image);
    } else if (grating) {
        snprintf(reason, size,
                 "the array's elements are so far apart that its beams have grating lobes");
    } else if (!isnan(apart_rad)) {
        snprintf(reason, size,
                 "the array's beams are cones: above and below its plane the outermost lies up to "
                 "%.3g degrees beside where pings of intensities have it",
                 apart_rad * (180.0 / ASDIC_PI));
    } else if (shaded) {
        snprintf(reason, size, "the side lobes of a shaded array are not those of an aperture");
    } else {
        snprintf(reason, size,
                 "nothing here interferes but scatterers, whose speckle can be drawn");
    }
    return smooth || image || grating || shaded || !isnan(apart_rad);
}
