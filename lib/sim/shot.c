/*
 * One ping on its way: what the device is told about it. Where the sonar is and how its apertures are
 * aimed, the water, where the sampler's zones and lobes lie, and tables over the bins.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/vec.h"
#include "bent_ray.h"
#include "cones.h"
#include "laws/scatterer.h"
#include "passage.h"
#include "scene/scene.h"
#include "sonar_ray.h"

#include "../../kernels/mirror.h"
#include "../../kernels/random.h"

#include <math.h>
#include <string.h>

/* --- the fixed-point scale of the accumulator ------------------------------------------------------- */

/* Strengths are searched down to this sine of the grazing angle; what lies below is cut only if
 * it exceeds the loudest value above. */
#define MIN_SIN 1e-3
#define STEPS 256
/* The rays' solid angles may add up to too much: by this, divided by the number of rays. */
#define FEW_RAYS_SR 200.0
/* Layers of the water focus what a bin gets by so much, at most; single rays by more. */
#define FOCUS 16.0

/* Largest s / sin(Theta) of a material. */
static double loudest(const asdic_scatterer *s, const dev_ping *ping) {
    double most = 1e-12;
    for (int i = 0; i <= STEPS; i++) {
        double sin_grazing = pow(MIN_SIN, 1.0 - (double)i / STEPS);
        /* The narrowest lobe: of a flat patch without end. */
        asdic_incidence at = {.sine = sin_grazing,
                              .cos2 = (1.0 - sin_grazing) * (1.0 + sin_grazing),
                              .coherent_m2 = 1e12,
                              .range_m = 2.0 * ping->range_m};
        most = fmax(most, s->material.law->strength_lin(s, &at) / sin_grazing);
    }
    bool tabled = s->material.law->formula == DEV_LAW_TABLE;
    most = tabled ? fmax(most, asdic_scatterer_steepest(s, MIN_SIN)) : most;
    return s->silent ? 1e-12 : most;
}

/* Not less than the solid angle that an aperture's pattern covers: of [sinc(L vy) sinc(M vz)]^2
 * dvy dvz / vx the part within 60 degrees of the axis is at most 2 / (L M); beyond, one direction
 * cosine exceeds 0.61, where the pattern is below 1 / (0.61 pi L)^2, over pi sr. */
static double pattern_sr(const asdic_beam *beam, const dev_ping *ping) {
    double l = beam->length_h_m / ping->wavelength_m, m = beam->length_v_m / ping->wavelength_m;
    double lobes = fmin(1.0, 0.28 / pow(fmin(l, m), 2.0));
    double front = fmin(2.0 / (l * m) + ASDIC_PI * lobes, 2.0 * ASDIC_PI);
    return front + 2.0 * ASDIC_PI * ping->rear_lin;
}

/* The most that a deposit's loss may be above that of its bin's middle (ray_relative_loss): in the first bin at its
 * beginning or where receiving begins, elsewhere at ranges of half the middle's or more. */
static double relative_loss_most(const dev_ping *ping) {
    double middle_m = 0.5 * ping->bin_m, np = 2.0 * ping->absorption_np_per_m;
    double nearest_m = fmin(ping->blanking_m, middle_m), ratio = middle_m / nearest_m;
    return fmax(ratio * ratio * exp(np * (middle_m - nearest_m)), 4.0 * exp(np * middle_m));
}

/* Fills the scale and limit of PING's sums from its water, its rays, the transmitter and what the
 * scene's parts are made of (SCATTERERS, as the scene numbers its materials, then the surface), for all
 * pings of a simulator; LAYERS: its water has several, which focus.
 * If rays were exact, sums would come to 2^61 at most, of 2^63 that there are. The quantum is about 180 dB
 * below the loudest possible sum of its component, before range. */
static void set_scales(const asdic_scene *scene, const asdic_beam *transmitter,
                       const asdic_scatterer *scatterers, bool layers, dev_ping *ping) {
    double bottom = 1e-12, object = 1e-12;
    double surface = loudest(&scatterers[scene->material_count], ping);
    if (scene->has_bottom_plane) {
        bottom = loudest(&scatterers[scene->bottom_plane_material], ping);
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        double *most = scene->parts[i].kind == DEV_KIND_BOTTOM ? &bottom : &object;
        *most = fmax(*most, loudest(&scatterers[scene->parts[i].material], ping));
    }
    double bound[DEV_DEPOSIT_COUNT];
    bound[DEV_DEPOSIT_BOTTOM] = bottom;
    bound[DEV_DEPOSIT_OBJECT] = object;
    bound[DEV_DEPOSIT_MULTIPATH] = fmax(fmax(bottom, object), surface);
    bound[DEV_DEPOSIT_SURFACE] = surface;
    bound[DEV_DEPOSIT_VOLUME] = layers ? FOCUS : 1.0;
    /* All that the transmitter sends out meets the loudest thing there is. Multipath also comes from where
     * the transmitter does not look: there, all directions count at full gain. With few rays one of them may
     * stand for much, and gets room. A factor of 2 covers the wavelength at another depth, whose square a facet's
     * peak depends on. */
    double sphere = 4.0 * ASDIC_PI, loss = relative_loss_most(ping);
    double sent = fmin(pattern_sr(transmitter, ping) + FEW_RAYS_SR / ping->batch.rays, sphere);
    for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
        double sum = 2.0 * loss * (c == DEV_DEPOSIT_MULTIPATH ? sphere : sent) * bound[c];
        ping->sums.scale[c] = (float)exp2(floor(61.0 - log2(sum)));
    }
    /* A sum overflows at 64 such deposits, that of depressions, which weigh up to 2, at 32. Each needs a ray that stands for half of what the
     * transmitter sends out or more and meets the loudest thing there is. */
    ping->sums.limit = (float)exp2(57.0);
}

#define ZONE_CAP_RAD 0.1745
static const float zone_share[5] = {0.03f, 0.57f, 0.07f, 0.30f, 0.03f};

/* A sonar that lies on a bottom plane is taken to be this share of the range above it: what the
 * bottom returns hardly depends on so little, and grazing angles stay in reach of single precision.
 * Where rays bend away from the plane they meet it up to sqrt(2 height / bend) away, which is then
 * to be no more than this share of the range that a sonar listens from. */
#define LEAST_PLANE 2e-6
#define UNHEARD 0.5
/* Meshes as near as this have slopes that the zones of a plane would starve. */
#define LEAST_MESH 2e-3

/* The least height above a bottom plane. */
static double least_height_m(const asdic_simulator *sim, double depth_m) {
    const dev_ping *ping = &sim->setup.ping;
    double from_m = UNHEARD * (ping->blanking_m > 0.0f ? ping->blanking_m : ping->bin_m);
    double least_m = LEAST_PLANE * ping->reach_m;
    asdic_layers layers;
    asdic_layers_of(&sim->setup.env, depth_m, &layers);
    const asdic_layer *layer = &layers.layer[asdic_layers_find(&layers, depth_m)];
    double bend = layer->gradient_per_s / asdic_layer_speed_mps(layer, depth_m);
    return bend > 0.0 ? fmin(0.5 * bend * from_m * from_m, least_m) : least_m;
}

/* Whether rays up there matter: what a surface mirrors is heard even where its own echo is not. */
static bool surface_counts(const asdic_simulator *sim) {
    return sim->setup.scene->has_surface &&
           (!(sim->setup.sampling.left_out & (1u << ASDIC_TERM_SURFACE)) ||
            asdic_simulator_boundaries_mirror(sim));
}

/* The zones end where rays that bend away from a plane graze it, with this share of their sine at the sonar, which
 * double precision still knows, and leave a gap of GAP's sine between them. */
#define GRAZE 1e-6
#define GAP 0.005

/* The range up to which rays meet a plane HEIGHT below the sonar, or above it with BEND the other way. */
static double zone_far(double height, double bend, double reach) {
    double turn = 2.0 * bend * height * (1.0 + 0.5 * bend * height);
    double sine = sqrt(fmax(turn, 0.0) * (1.0 + GRAZE * GRAZE) / (1.0 + turn));
    return turn > 0.0 ? fmin(ray_plane_range(height, sine, bend), reach) : reach;
}

/* The plane AWAY_M below the sonar or above it as rays are laid out for it. */
static asdic_bent_plane plane_for_rays(const asdic_simulator *sim, const dev_ping *ping,
                                       double depth_m, double away_m, bool below) {
    if (sim->setup.layer_count == 0 || !(away_m > 0.0) || isinf(away_m)) {
        double bend = asdic_sonar_bend(ping);
        return (asdic_bent_plane){away_m, below ? bend : -bend};
    }
    asdic_layers layers;
    asdic_flat_scene flat = {
        .depth_m = depth_m, .altitude_m = away_m, .has_surface = !below, .has_bottom = below};
    asdic_layers_between(&sim->setup.env, &flat, &layers);
    return asdic_bent_plane_through(&layers, depth_m, below, ping->reach_m);
}

/* Where rays bend, one plane may hide part of the other. */
static void end_zones(dev_ping *ping, bool bottom, bool surface) {
    dev_zones *z = &ping->sampling.zones;
    double bend = z->bottom_bend_per_m, bends = z->surface_bend_per_m, reach = ping->reach_m;
    double h = z->bottom_m, hs = z->surface_m;
    double far = bottom ? zone_far(h, bend, reach) : reach;
    double fars = surface ? zone_far(hs, bends, reach) : reach;
    if (bottom && surface) {
        double high = ray_plane_sine(h, far, bend), low = -ray_plane_sine(hs, fars, bends);
        if (high < low + GAP && bend < 0.0 && bends < 0.0) { /* level rays bend to either */
            far = fmin(ray_plane_range(h, 0.5 * GAP, bend), far);
            fars = fmin(ray_plane_range(hs, 0.5 * GAP, bends), fars);
        } else if (high < low + GAP && bend < 0.0) {
            far = fmin(ray_plane_range(h, low + GAP, bend), far);
        } else if (high < low + GAP) {
            fars = fmin(ray_plane_range(hs, GAP - high, bends), fars);
        }
    }
    z->bottom_far_m = (float)far;
    z->surface_far_m = (float)fars;
}

/* A zone that ends beyond the range leaves its share to the gap. */
static void place_zones(const asdic_simulator *sim, const asdic_pose *pose, dev_ping *ping) {
    double range = ping->reach_m;
    double altitude = asdic_scene_altitude_m(sim->setup.scene, pose->position_m);
    bool plane = sim->setup.scene->has_bottom_plane &&
                 altitude == sim->setup.scene->bottom_plane_depth_m - pose->position_m.z;
    double least = plane ? least_height_m(sim, pose->position_m.z) : LEAST_MESH * range;
    double depth = surface_counts(sim) ? pose->position_m.z : INFINITY;
    double share = sim->learnt.zone_altitude, own_m = pose->position_m.z;
    asdic_bent_plane below = plane_for_rays(sim, ping, own_m, altitude, true),
                     above = plane_for_rays(sim, ping, own_m, depth, false);
    if (plane && share == ASDIC_ZONE_ALTITUDE &&
        zone_far(below.height_m, below.bend_per_m, 2.0 * range) < 2.0 * range) {
        share = 1.0; /* the nearer the shadow, the worse a zone for another height fits */
    }
    double h = fmax(share * below.height_m, least), hs = fmax(above.height_m, LEAST_PLANE * range);
    bool bottom = h < 0.95 * range, surface = hs < 0.95 * range;
    ping->sampling.zones.bottom_m = (float)(bottom ? h : 2.0 * range);
    ping->sampling.zones.surface_m = (float)(surface ? hs : 2.0 * range);
    ping->sampling.zones.cap_rad = (float)ZONE_CAP_RAD;
    ping->sampling.zones.bottom_bend_per_m = (float)below.bend_per_m;
    ping->sampling.zones.surface_bend_per_m = (float)above.bend_per_m;
    memcpy(ping->sampling.zones.share, zone_share, sizeof zone_share);
    if (!bottom) {
        ping->sampling.zones.share[2] +=
            ping->sampling.zones.share[0] + ping->sampling.zones.share[1];
        ping->sampling.zones.share[0] = ping->sampling.zones.share[1] = 0.0f;
    }
    if (!surface) {
        ping->sampling.zones.share[2] +=
            ping->sampling.zones.share[3] + ping->sampling.zones.share[4];
        ping->sampling.zones.share[3] = ping->sampling.zones.share[4] = 0.0f;
    }
    end_zones(ping, bottom, surface);
}

/* How far the lattices of a calibration's pings lie from the first's, in turns of the golden coordinate:
 * shifts drawn independently now and then lie beside each other, and the pings then agree by chance. */
static const double CALIBRATION_APART[ASDIC_MOST_CALIBRATION] = {0.0,  2.0 / 15.0, 0.35, 0.59,
                                                                 0.83, 0.46,       0.71, 0.24};

/* The ping's lattice shift: the same for every device and order of pings. */
static void place_lattice(dev_ping *ping, uint32_t stream) {
    random4 shift = random_draw(stream, ping->ping[0], ping->ping[1], RANDOM_SHIFT, ping->seed[0],
                                ping->seed[1]);
    ping->sampling.lattice_offset = (float)random_uniform(shift.v[0]);
    ping->sampling.lattice_shift = shift.v[1];
    ping->sampling.stream = stream;
    for (uint32_t nth = 0; nth < ASDIC_MOST_CALIBRATION; nth++) {
        if (stream == ASDIC_STREAM_CALIBRATION(nth)) {
            random4 first = random_draw(ASDIC_STREAM_CALIBRATION(0u), ping->ping[0], ping->ping[1],
                                        RANDOM_SHIFT, ping->seed[0], ping->seed[1]);
            ping->sampling.lattice_shift = first.v[1] + (uint32_t)(CALIBRATION_APART[nth] * 0x1p32);
        }
    }
}

/* Share of the rays that is aimed at faces, where there are any. */
#define FACE_SHARE 0.1

static void place_faces(const asdic_simulator *sim, dev_ping *ping) {
    ping->sampling.faces = (dev_uint)sim->learnt.faces.count;
    ping->sampling.face_count =
        sim->learnt.faces.count ? (dev_uint)(FACE_SHARE * ping->batch.rays) : 0;
    ping->sampling.background -= ping->sampling.face_count;
    ping->sampling.face_first = ping->sampling.background;
}

/* Objects, and their images in planes that mirror. */
static void place_objects(const asdic_simulator *sim, asdic_ping_shot *shot) {
    asdic_passage ways[ASDIC_MOST_PASSAGES];
    const asdic_part *parts = sim->placement->parts;
    const asdic_vec3 from_m = shot->pose.position_m;
    const dev_beam *beams = asdic_shot_beams(shot);
    size_t count = sim->setup.scene->part_count;
    size_t way_count = count > 0 ? asdic_passages_find(sim, from_m.z, ways) : 0;
    if (way_count > 0) {
        asdic_pairs_place(parts, count, from_m, beams, ways, shot->ping);
    }
    if (shot->ping->sampling.sampler == DEV_SAMPLER_ADAPTIVE) {
        asdic_cones_place(parts, count, from_m, beams, ways, way_count, shot->ping);
        asdic_glints_place(&sim->learnt.glints, parts, from_m, ways, shot->ping);
    }
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
    const asdic_scene *scene = sim->setup.scene;
    size_t beams = sim->setup.sonar.receiver_count, groups = sim->setup.groups,
           workers = sim->setup.layout.workers;
    bool collects = sim->setup.layout.deposit == ASDIC_DEPOSIT_COLLECT,
         wide = collects && beams > 2;
    size_t columns = wide ? (beams <= 4 ? 4 : (beams + 7) / 8 * 8) : beams;
    size_t rows = (sim->setup.bins + MOST_RUN - 1) / MOST_RUN * MOST_RUN;
    size_t cells = sim->setup.components * rows * columns + MOST_WIDTH;
    fixed->sums.columns = (dev_uint)columns;
    fixed->sums.component_rows = (dev_uint)rows;
    fixed->sums.group_cells = (dev_uint)(((cells + 7) / 8 | 1) * 8);
    if (workers == 0 || workers > groups ||
        groups * sim->setup.per_group < sim->setup.sampling.rays) {
        workers = groups;
    }
    fixed->sums.blocks = (dev_uint)(collects ? 2 * workers : groups);
    fixed->sums.total_cells = (dev_uint)((rows * columns / 16 | 1) * 16);
    fixed->sums.present = 1u << DEV_DEPOSIT_VOLUME;
    if (scene->has_bottom_plane || asdic_simulator_has(sim, DEV_KIND_BOTTOM)) {
        fixed->sums.present |= 1u << DEV_DEPOSIT_BOTTOM;
    }
    if (scene->has_surface) {
        fixed->sums.present |= 1u << DEV_DEPOSIT_SURFACE;
    }
    if (sim->setup.components > DEV_DEPOSIT_OBJECT && asdic_simulator_has(sim, DEV_KIND_OBJECT)) {
        fixed->sums.present |= 1u << DEV_DEPOSIT_OBJECT;
    }
    if (sim->setup.components > DEV_DEPOSIT_MULTIPATH) {
        fixed->sums.present |= 1u << DEV_DEPOSIT_MULTIPATH;
    }
}

/* From where on the device listens: at the end of a bin it has the very float of that. */
static float listens_from(const asdic_setup *setup) {
    float bin_m = (float)setup->sonar.bin_length_m;
    double whole = round(setup->from_m / setup->sonar.bin_length_m);
    return setup->from_m == whole * setup->sonar.bin_length_m ? (float)whole * bin_m
                                                              : (float)setup->from_m;
}

void asdic_simulator_prepare(asdic_simulator *sim, const asdic_water_column *water) {
    dev_ping *fixed = &sim->setup.ping;
    *fixed = (dev_ping){
        .blanking_m = listens_from(&sim->setup),
        .range_m = (float)((double)sim->setup.bins * sim->setup.sonar.bin_length_m),
        .reach_m = (float)(((double)sim->setup.bins + 0.25) * sim->setup.sonar.bin_length_m),
        .bin_m = (float)sim->setup.sonar.bin_length_m,
        .absorption_np_per_m = (float)water->absorption_np_per_m,
        .rear_lin = (float)pow(10.0, sim->setup.sonar.rear_floor_db / 10.0),
        .bottom_material = (dev_uint)sim->setup.scene->bottom_plane_material,
        .surface_material = (dev_uint)sim->setup.scene->material_count,
        .batch.rays = sim->setup.sampling.rays,
        .batch.groups = sim->setup.groups,
        .beams = (dev_uint)sim->setup.sonar.receiver_count,
        .states_errors = !sim->setup.sampling.without_errors,
        .stride = (dev_uint)asdic_simulator_ping_bytes(sim),
        .sums.result_words = (dev_uint)(asdic_simulator_results_bytes(sim) / sizeof(int64_t)),
        .bins = (dev_uint)sim->setup.bins,
        .sums.components = (dev_uint)sim->setup.components,
        .sampling.sampler = sampler_code(sim->setup.sampling.sampler),
        .seed = {(dev_uint)sim->setup.sampling.seed, (dev_uint)(sim->setup.sampling.seed >> 32)},
        .boundary_mirrors = sim->setup.sampling.multipath == ASDIC_MULTIPATH_BOUNDARIES,
        .wavelength_m = (float)water->wavelength_m,
    };
    shape_accumulator(sim, fixed);
    set_scales(sim->setup.scene, &sim->setup.sonar.transmitter, sim->setup.scatterers,
               sim->setup.layer_count > 0, fixed);
}

/* Rays that are traced as one packet. */
#define PACKET 16.0

/* In which order the rays lie in memory: kernels/order.h says why. */
static void order_rays(dev_ping *ping) {
    double slots = (double)ping->batch.groups * ping->batch.per_group;
    /* A packet of a block of F rays out of N spans F / N of elevation and PACKET / F of azimuth. */
    dev_uint before = 1, block = 1, flips = 0;
    while ((double)block * block < PACKET * slots) {
        dev_uint next = before + block;
        before = block;
        block = next;
        flips ^= 1;
    }
    /* The square of a Fibonacci number is 1 or -1 modulo the next, in turn. */
    ping->batch.order_block = block;
    ping->batch.order_inverse = flips ? block - before : before;
    for (dev_uint k = 0; k < 16; k++) {
        ping->batch.order_lanes[k] = k * ping->batch.order_inverse % block;
    }
}

/* Where the sonar is, in which water. */
static void place_sonar(const asdic_simulator *sim, const asdic_ping_shot *shot) {
    const asdic_scene *scene = sim->setup.scene;
    const asdic_pose *pose = &shot->pose;
    dev_ping *ping = shot->ping;
    asdic_vec3 origin = asdic_vec3_sub(pose->position_m, sim->placement->origin_m);
    ping->origin[0] = (float)origin.x;
    ping->origin[1] = (float)origin.y;
    ping->origin[2] = (float)origin.z;
    ping->bend_per_m = (float)sim->setup.bend_per_m;
    ping->shift_m = sim->setup.layer_count > 0 ? fabsf(sim->setup.layers[0].shift_m) : 0.0f;
    ping->surface_m = scene->has_surface ? (float)pose->position_m.z : INFINITY;
    ping->bottom_m = scene->has_bottom_plane
                         ? (float)fmax(scene->bottom_plane_depth_m - pose->position_m.z,
                                       least_height_m(sim, pose->position_m.z))
                         : INFINITY;
    ping->absorption_np_per_m = (float)shot->water.absorption_np_per_m;
    ping->wavelength_m = (float)shot->water.wavelength_m;
}

/* How the apertures are aimed, and where rays should look for them. */
static void aim_beams(const asdic_simulator *sim, const asdic_ping_shot *shot) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    dev_ping *ping = shot->ping;
    dev_beam *beams = asdic_shot_beams(shot);
    double wavelength_m = shot->water.wavelength_m;
    beams[0] = asdic_aim_beam(&sonar->transmitter, &shot->pose, wavelength_m);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        beams[b + 1] = asdic_aim_beam(&sonar->receivers[b], &shot->pose, wavelength_m);
    }
    ping->sampling.lobes =
        asdic_aim_lobes(sim->setup.sampling.sampler, beams, sonar->receiver_count,
                        ping->rear_lin > 0.0f, ping->sampling.lobe);
    ping->sampling.footprint_rays = (float)asdic_aim_footprint_rays(ping->sampling.lobe);
    memcpy(ping->sampling.front, beams[0].rows, sizeof ping->sampling.front);
    asdic_aim_side(&beams[0], false, ping->sampling.sender_y);
    asdic_aim_side(&beams[0], true, ping->sampling.sender_z);
    ping->sampling.front_azimuth_rad = atan2f(ping->sampling.front[1], ping->sampling.front[0]);
    if (sim->fan.common_axis) {
        memcpy(ping->fan_rows, beams[1].rows, sizeof ping->fan_rows);
    }
}

void asdic_shot_aim(const asdic_simulator *sim, asdic_ping_shot *shot, const asdic_pose *pose,
                    uint64_t index, uint32_t stream, uint32_t rays) {
    dev_ping *ping = shot->ping;
    shot->pose = *pose;
    shot->index = index;
    shot->stream = stream;
    shot->water = asdic_water_column_at(&sim->setup.env, &sim->setup.sonar, pose->position_m.z);
    *ping = sim->setup.ping;
    ping->batch.rays = rays;
    ping->batch.per_group = (dev_uint)asdic_simulator_per_group(sim, rays);
    order_rays(ping);
    ping->ping[0] = (dev_uint)index;
    ping->ping[1] = (dev_uint)(index >> 32);
    place_sonar(sim, shot);
    aim_beams(sim, shot);
    ping->sampling.azimuths_learnt = sim->learnt.azimuths;
    ping->sampling.background = rays;
    ping->sampling.cones = ping->sampling.face_count = 0;
    if (ping->sampling.sampler == DEV_SAMPLER_ADAPTIVE) {
        place_faces(sim, ping);
    }
    place_objects(sim, shot);
    place_zones(sim, pose, ping);
    place_lattice(ping, stream);
}

/* Per bin: TL d^2 and the water's integral; what turns a part of that integral into a share of the
 * bin, and water quanta into the bin's TL d^2. */
bool asdic_shot_tabulate(const asdic_simulator *sim, asdic_ping_shot *shot) {
    const asdic_water_column *water = &shot->water;
    if (shot->tables_np_per_m == water->absorption_np_per_m) {
        return false;
    }
    double strength = asdic_volume_strength_lin(&sim->setup.env, &sim->setup.sonar);
    float *inverse = shot->for_device, *ratio = inverse + sim->setup.bins;
    for (size_t n = 0; n < sim->setup.bins; n++) {
        double loss = asdic_water_column_loss(water, sim->setup.sonar.bin_length_m, n);
        double center = ((double)n + 0.5) * sim->setup.sonar.bin_length_m;
        double volume =
            asdic_water_column_volume(water, sim->setup.sonar.bin_length_m, sim->setup.from_m, n);
        /* The device works relative to the bin's centre: integral of d^-2 exp(-2 k (d - d_n)). */
        double local = volume / (loss * center * center);
        inverse[n] = local > 0.0 && isfinite(local) ? (float)(1.0 / local) : 0.0f;
        ratio[n] = isfinite(volume) ? (float)(strength * volume / loss) : 0.0f;
        shot->loss[n] = loss;
        shot->volume[n] = strength * volume;
    }
    shot->tables_np_per_m = water->absorption_np_per_m;
    return true;
}
