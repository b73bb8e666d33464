/*
 * What the device is told about a ping: where the sonar is and how its apertures are aimed, the
 * water, and where the sampler's zones and lobes lie.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/vec.h"
#include "cones.h"
#include "deposit_scale.h"
#include "ray_order.h"
#include "scene/scene.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/mirror.h"
#include "../../kernels/random.h"

#include <math.h>
#include <string.h>

#define ZONE_CAP_RAD 0.1745
static const float zone_share[5] = {0.03f, 0.57f, 0.07f, 0.30f, 0.03f};

/* A sonar that lies on a bottom plane is taken to be this share of the range above it: what the
 * bottom returns hardly depends on so little, and grazing angles stay in reach of single precision. */
#define LEAST_PLANE 2e-6
/* Meshes as near as this have slopes that the zones of a plane would starve. */
#define LEAST_MESH 2e-3

static bool surface_is_silent(const asdic_simulator *sim) {
    return sim->sampling.left_out & (1u << ASDIC_TERM_SURFACE);
}

/* A zone that ends beyond the range leaves its share to the gap. */
static void place_zones(const asdic_simulator *sim, const asdic_pose *pose, dev_ping *ping) {
    double range = ping->reach_m;
    double altitude = asdic_scene_altitude_m(sim->scene, pose->position_m);
    bool plane = sim->scene->has_bottom_plane &&
                 altitude == sim->scene->bottom_plane_depth_m - pose->position_m.z;
    double least = (plane ? LEAST_PLANE : LEAST_MESH) * range;
    bool sounds = sim->scene->has_surface && !surface_is_silent(sim);
    double depth = sounds ? pose->position_m.z : INFINITY;
    double h = fmax(sim->zone_altitude * altitude, least), hs = fmax(depth, LEAST_PLANE * range);
    bool bottom = h < 0.95 * range, surface = hs < 0.95 * range;
    ping->zone_bottom_m = (float)(bottom ? h : 2.0 * range);
    ping->zone_surface_m = (float)(surface ? hs : 2.0 * range);
    ping->zone_cap_rad = (float)ZONE_CAP_RAD;
    memcpy(ping->zone_share, zone_share, sizeof zone_share);
    if (!bottom) {
        ping->zone_share[2] += ping->zone_share[0] + ping->zone_share[1];
        ping->zone_share[0] = ping->zone_share[1] = 0.0f;
    }
    if (!surface) {
        ping->zone_share[2] += ping->zone_share[3] + ping->zone_share[4];
        ping->zone_share[3] = ping->zone_share[4] = 0.0f;
    }
}

/* How far the lattices of a calibration's pings lie from the first's, in turns of the golden coordinate:
 * shifts drawn independently now and then lie beside each other, and the pings then agree by chance. */
static const double CALIBRATION_APART[] = {0.0, 2.0 / 15.0, 0.35};

/* The ping's lattice shift: the same for every device and order of pings. */
static void place_lattice(dev_ping *ping, uint32_t stream) {
    random4 shift = random_draw(stream, ping->ping[0], ping->ping[1], RANDOM_SHIFT, ping->seed[0],
                                ping->seed[1]);
    ping->lattice_offset = (float)random_uniform(shift.v[0]);
    ping->lattice_shift = shift.v[1];
    if (stream >= ASDIC_STREAM_CALIBRATION && stream < ASDIC_STREAM_PILOT) {
        random4 first = random_draw(ASDIC_STREAM_CALIBRATION, ping->ping[0], ping->ping[1],
                                    RANDOM_SHIFT, ping->seed[0], ping->seed[1]);
        uint32_t nth = stream - ASDIC_STREAM_CALIBRATION;
        ping->lattice_shift = first.v[1] + (uint32_t)(CALIBRATION_APART[nth] * 0x1p32);
    }
}

/* Share of the rays that is aimed at faces, where there are any. */
#define FACE_SHARE 0.1

static void place_faces(const asdic_simulator *sim, dev_ping *ping) {
    ping->faces = (dev_uint)sim->faces.count;
    ping->face_count = sim->faces.count ? (dev_uint)(FACE_SHARE * ping->rays) : 0;
    ping->background -= ping->face_count;
    ping->face_first = ping->background;
}

static dev_uint sampler_code(asdic_sampler sampler) {
    return sampler == ASDIC_SAMPLER_ADAPTIVE ? DEV_SAMPLER_ADAPTIVE
           : sampler == ASDIC_SAMPLER_BEAM   ? DEV_SAMPLER_BEAM
                                             : DEV_SAMPLER_UNIFORM_SPHERE;
}

/* Cells of a run of reduce.cl, at most, and of a vector that reaches beyond its row in collect.cl. */
#define MOST_RUN 64u
#define MOST_WIDTH 16u

/* Components begin at whole runs, groups at an odd number of cache lines from each other: at a power
 * of two they would all want the same place in a cache. Where a work-item owns its cells, collect.cl
 * adds to rows of four or eights of columns as vectors. */
static void shape_accumulator(const asdic_simulator *sim, dev_ping *fixed) {
    const asdic_scene *scene = sim->scene;
    size_t beams = sim->sonar.receiver_count, groups = sim->groups, owners = sim->layout.owners;
    bool owned = sim->layout.deposit == ASDIC_DEPOSIT_OWNED, wide = owned && beams > 2;
    size_t columns = wide ? (beams <= 4 ? 4 : (beams + 7) / 8 * 8) : beams;
    size_t rows = (sim->bins + MOST_RUN - 1) / MOST_RUN * MOST_RUN;
    size_t cells = sim->components * rows * columns + MOST_WIDTH;
    fixed->columns = (dev_uint)columns;
    fixed->component_rows = (dev_uint)rows;
    fixed->group_cells = (dev_uint)(((cells + 7) / 8 | 1) * 8);
    if (owners == 0 || owners > groups || groups * sim->per_group < sim->sampling.rays) {
        owners = groups;
    }
    fixed->blocks = (dev_uint)(owned ? 2 * owners : groups);
    fixed->total_cells = (dev_uint)((rows * columns / 16 | 1) * 16);
    fixed->present = 1u << DEV_DEPOSIT_VOLUME;
    if (scene->has_bottom_plane || asdic_simulator_has(sim, DEV_KIND_BOTTOM)) {
        fixed->present |= 1u << DEV_DEPOSIT_BOTTOM;
    }
    if (scene->has_surface) {
        fixed->present |= 1u << DEV_DEPOSIT_SURFACE;
    }
    if (sim->components > DEV_DEPOSIT_OBJECT && asdic_simulator_has(sim, DEV_KIND_OBJECT)) {
        fixed->present |= 1u << DEV_DEPOSIT_OBJECT;
    }
    if (sim->components > DEV_DEPOSIT_MULTIPATH) {
        fixed->present |= 1u << DEV_DEPOSIT_MULTIPATH;
    }
}

void asdic_simulator_prepare(asdic_simulator *sim, const asdic_water_column *water) {
    dev_ping *fixed = &sim->fixed;
    *fixed = (dev_ping){
        .blanking_m = (float)sim->sonar.blanking_m,
        .range_m = (float)((double)sim->bins * sim->sonar.bin_length_m),
        .reach_m = (float)(((double)sim->bins + 0.25) * sim->sonar.bin_length_m),
        .bin_m = (float)sim->sonar.bin_length_m,
        .rear_lin = (float)pow(10.0, sim->sonar.rear_floor_db / 10.0),
        .bottom_material = (dev_uint)sim->scene->bottom_plane_material,
        .surface_material = (dev_uint)sim->scene->material_count,
        .rays = sim->sampling.rays,
        .groups = sim->groups,
        .beams = (dev_uint)sim->sonar.receiver_count,
        .states_errors = !sim->sampling.without_errors,
        .stride = (dev_uint)asdic_simulator_ping_bytes(sim),
        .result_words = (dev_uint)(asdic_simulator_results_bytes(sim) / sizeof(int64_t)),
        .bins = (dev_uint)sim->bins,
        .components = (dev_uint)sim->components,
        .sampler = sampler_code(sim->sampling.sampler),
        .seed = {(dev_uint)sim->sampling.seed, (dev_uint)(sim->sampling.seed >> 32)},
        .boundary_mirrors = sim->sampling.multipath == ASDIC_MULTIPATH_BOUNDARIES,
        .wavelength_m = (float)water->wavelength_m,
    };
    shape_accumulator(sim, fixed);
    asdic_deposit_scales(sim->scene, &sim->sonar.transmitter, sim->scatterers, fixed);
}

void asdic_simulator_describe(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                              uint32_t stream, uint32_t rays) {
    const asdic_scene *scene = sim->scene;
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    asdic_vec3 origin = asdic_vec3_sub(pose->position_m, scene->origin_m);
    dev_ping *ping = sim->ping;
    dev_beam *beams = asdic_simulator_beams(sim);
    *ping = sim->fixed;
    ping->rays = rays;
    ping->per_group = (dev_uint)asdic_simulator_per_group(sim, rays);
    asdic_ray_order(ping);
    ping->origin[0] = (float)origin.x;
    ping->origin[1] = (float)origin.y;
    ping->origin[2] = (float)origin.z;
    ping->surface_m = scene->has_surface ? (float)pose->position_m.z : INFINITY;
    ping->bottom_m = scene->has_bottom_plane
                         ? (float)fmax(scene->bottom_plane_depth_m - pose->position_m.z,
                                       LEAST_PLANE * ping->reach_m)
                         : INFINITY;
    ping->absorption_np_per_m = (float)water.absorption_np_per_m;
    ping->wavelength_m = (float)water.wavelength_m;
    ping->ping[0] = (dev_uint)index;
    ping->ping[1] = (dev_uint)(index >> 32);
    beams[0] = asdic_aim_beam(&sim->sonar.transmitter, pose, water.wavelength_m);
    for (size_t b = 0; b < sim->sonar.receiver_count; b++) {
        beams[b + 1] = asdic_aim_beam(&sim->sonar.receivers[b], pose, water.wavelength_m);
    }
    ping->lobes = asdic_aim_lobes(sim->sampling.sampler, beams, sim->sonar.receiver_count,
                                  ping->rear_lin > 0.0f, ping->lobe);
    ping->footprint_rays = (float)asdic_aim_footprint_rays(ping->lobe);
    memcpy(ping->front, beams[0].rows, sizeof ping->front);
    ping->front_azimuth_rad = atan2f(ping->front[1], ping->front[0]);
    asdic_beam_fan_describe(&sim->fan, beams, ping);
    ping->azimuths_learnt = sim->azimuths_learnt;
    ping->background = rays;
    ping->cones = ping->face_count = 0;
    if (ping->sampler == DEV_SAMPLER_ADAPTIVE) {
        place_faces(sim, ping);
        asdic_cones_place(sim->placement->parts, scene->part_count, pose->position_m, beams, ping);
    }
    place_zones(sim, pose, ping);
    place_lattice(ping, stream);
}
