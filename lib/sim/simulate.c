/*
 * One ping: describe it to the device, draw, trace and shade its rays, turn sums into levels.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/context.h"
#include "base/vec.h"
#include "deposit_scale.h"
#include "noise_level.h"
#include "scene/scene.h"
#include "speckle.h"
#include "water_column.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/random.h"

#include <math.h>
#include <string.h>

/* The bottom zone of the adaptive sampler assumes a little less altitude than measured: too low
 * costs nothing, too high starves the last bins. */
#define ZONE_ALTITUDE 0.9
#define ZONE_CAP_RAD 0.1745
static const float zone_share[5] = {0.03f, 0.57f, 0.07f, 0.30f, 0.03f};

/* A zone that ends beyond the range leaves its share to the gap. */
static void place_zones(const asdic_simulator *sim, const asdic_pose *pose, dev_ping *ping) {
    double range = ping->range_m, least = 2e-3 * range;
    double altitude = asdic_scene_altitude_m(sim->scene, pose->position_m);
    bool silent = sim->sampling.left_out & (1u << ASDIC_TERM_SURFACE);
    double depth = sim->scene->has_surface && !silent ? pose->position_m.z : INFINITY;
    double h = fmax(ZONE_ALTITUDE * altitude, least), hs = fmax(depth, least);
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

/* The ping's lattice shift: the same for every device and order of pings. Calibration pings take
 * other STREAMs. */
static void place_lattice(dev_ping *ping, uint32_t stream) {
    random4 shift = random_draw(stream, ping->ping[0], ping->ping[1], RANDOM_SHIFT, ping->seed[0],
                                ping->seed[1]);
    ping->lattice_offset = (float)random_uniform(shift.v[0]);
    ping->lattice_shift = shift.v[1];
}

static void describe_water(const asdic_simulator *sim, const asdic_water_column *water,
                           dev_ping *ping) {
    double f_khz = sim->sonar.frequency_hz / 1e3, wind = sim->env.wind_speed_kn;
    ping->absorption_np_per_m = (float)water->absorption_np_per_m;
    ping->wavelength_m = (float)water->wavelength_m;
    bool silent = sim->sampling.left_out & (1u << ASDIC_TERM_SURFACE);
    ping->surface_gain = silent ? 0.0f : (float)surface_gain(wind, f_khz);
    ping->surface_beta0 = (float)surface_beta0(wind);
    ping->surface_beta1 = (float)surface_beta1(f_khz);
    ping->surface_cap_lin = (float)surface_cap_lin(wind);
}

static dev_ping describe_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                              uint32_t stream, const asdic_water_column *water, dev_lobe *lobes) {
    const asdic_scene *scene = sim->scene;
    asdic_vec3 origin = asdic_vec3_sub(pose->position_m, scene->origin_m);
    dev_ping ping = {
        .origin = {(float)origin.x, (float)origin.y, (float)origin.z},
        .surface_m = scene->has_surface ? (float)pose->position_m.z : INFINITY,
        .bottom_m = scene->has_bottom_plane
                        ? (float)(scene->bottom_plane_depth_m - pose->position_m.z)
                        : INFINITY,
        .blanking_m = (float)sim->sonar.blanking_m,
        .range_m = (float)((double)sim->bins * sim->sonar.bin_length_m),
        .bin_m = (float)sim->sonar.bin_length_m,
        .rear_lin = (float)pow(10.0, sim->sonar.rear_floor_db / 10.0),
        .bottom_material = (dev_uint)scene->bottom_plane_material,
        .rays = sim->sampling.rays,
        .per_group = (dev_uint)sim->per_group,
        .groups = sim->groups,
        .beams = (dev_uint)sim->sonar.receiver_count,
        .bins = (dev_uint)sim->bins,
        .seed = {(dev_uint)sim->sampling.seed, (dev_uint)(sim->sampling.seed >> 32)},
        .ping = {(dev_uint)index, (dev_uint)(index >> 32)},
    };
    ping.sampler = sim->sampling.sampler == ASDIC_SAMPLER_ADAPTIVE ? DEV_SAMPLER_ADAPTIVE
                   : sim->sampling.sampler == ASDIC_SAMPLER_BEAM   ? DEV_SAMPLER_BEAM
                                                                   : DEV_SAMPLER_UNIFORM_SPHERE;
    sim->host_beams[0] = asdic_aim_beam(&sim->sonar.transmitter, pose, water->wavelength_m);
    for (size_t b = 0; b < sim->sonar.receiver_count; b++) {
        sim->host_beams[b + 1] =
            asdic_aim_beam(&sim->sonar.receivers[b], pose, water->wavelength_m);
    }
    ping.lobes = asdic_aim_lobes(sim->sampling.sampler, sim->host_beams, sim->sonar.receiver_count,
                                 ping.rear_lin > 0.0f, lobes);
    memcpy(ping.front, sim->host_beams[0].rows, sizeof ping.front);
    ping.front_azimuth_rad = atan2f(ping.front[1], ping.front[0]);
    asdic_beam_fan_describe(&sim->fan, sim->host_beams, &ping);
    describe_water(sim, water, &ping);
    place_zones(sim, pose, &ping);
    place_lattice(&ping, stream);
    asdic_deposit_scales(sim->host_materials, sim->material_count, &ping);
    return ping;
}

asdic_status asdic_simulator_describe(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                      uint32_t stream, dev_ping *ping) {
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    dev_lobe lobes[DEV_MAX_LOBES];
    memset(lobes, 0, sizeof lobes);
    *ping = describe_ping(sim, pose, index, stream, &water, lobes);
    asdic_status status = asdic_buffer_write(
        sim->beam_buffer, 0, (sim->sonar.receiver_count + 1) * sizeof(dev_beam), sim->host_beams);
    if (!status) {
        status = asdic_buffer_write(sim->lobe_buffer, 0, sizeof lobes, lobes);
    }
    return status ? status
                  : asdic_buffer_write(sim->table_buffer, 0, sizeof sim->table, sim->table);
}

/* Per bin: what turns a part of the water's integral into a share of the bin, and water quanta
 * into the bin's TL d^2. */
static asdic_status upload_bins(asdic_simulator *sim, const asdic_water_column *water) {
    double strength = pow(10.0, 0.1 * volume_backscatter_db(sim->env.particle_strength_db,
                                                            sim->sonar.frequency_hz / 1e3));
    for (size_t n = 0; n < sim->bins; n++) {
        double loss = asdic_water_column_loss(water, sim->sonar.bin_length_m, n);
        double center = ((double)n + 0.5) * sim->sonar.bin_length_m;
        double volume =
            asdic_water_column_volume(water, sim->sonar.bin_length_m, sim->sonar.blanking_m, n);
        /* The device works relative to the bin's centre: integral of d^-2 exp(-2 k (d - d_n)). */
        double local = volume / (loss * center * center);
        sim->bin_table[n] = local > 0.0 && isfinite(local) ? (float)(1.0 / local) : 0.0f;
        sim->bin_table[sim->bins + n] = isfinite(volume) ? (float)(strength * volume / loss) : 0.0f;
    }
    size_t bytes = sim->bins * sizeof(float);
    asdic_status status = asdic_buffer_write(sim->volume_inverse, 0, bytes, sim->bin_table);
    return status ? status
                  : asdic_buffer_write(sim->volume_ratio, 0, bytes, sim->bin_table + sim->bins);
}

#define COUNT(args) (sizeof(args) / sizeof *(args))

/* Mirror rays, what they meet, the way back, the deposit. */
static asdic_status run_bounces(asdic_simulator *sim, const dev_ping *ping, dev_uint items) {
    size_t slots = (size_t)ping->groups * ping->per_group;
    asdic_buffer *triangles = asdic_tracer_triangles(sim->tracer);
    asdic_kernel_arg reflect[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer), ASDIC_ARG_BUFFER(sim->beam_buffer),
        ASDIC_ARG_BUFFER(sim->rays),        ASDIC_ARG_BUFFER(sim->hits),
        ASDIC_ARG_BUFFER(triangles),        ASDIC_ARG_BUFFER(sim->parts),
        ASDIC_ARG_BUFFER(sim->materials),   ASDIC_ARG_BUFFER(sim->bounced),
        ASDIC_ARG_BUFFER(sim->shares)};
    asdic_kernel_arg connect[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer), ASDIC_ARG_BUFFER(sim->beam_buffer),
        ASDIC_ARG_BUFFER(sim->bounced),     ASDIC_ARG_BUFFER(sim->bounced_hits),
        ASDIC_ARG_BUFFER(triangles),        ASDIC_ARG_BUFFER(sim->parts),
        ASDIC_ARG_BUFFER(sim->materials),   ASDIC_ARG_BUFFER(sim->returning)};
    asdic_kernel_arg bounce[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                 ASDIC_ARG_BUFFER(sim->beam_buffer),
                                 ASDIC_ARG_BUFFER(sim->rays),
                                 ASDIC_ARG_BUFFER(sim->solid_angles),
                                 ASDIC_ARG_BUFFER(sim->bounced),
                                 ASDIC_ARG_BUFFER(sim->bounced_hits),
                                 ASDIC_ARG_BUFFER(sim->returning),
                                 ASDIC_ARG_BUFFER(sim->returning_hits),
                                 ASDIC_ARG_BUFFER(sim->shares),
                                 ASDIC_ARG_BUFFER(triangles),
                                 ASDIC_ARG_BUFFER(sim->parts),
                                 ASDIC_ARG_BUFFER(sim->materials),
                                 ASDIC_ARG_BUFFER(sim->accumulator),
                                 ASDIC_ARG_BUFFER(sim->saturated),
                                 ASDIC_ARG_VALUE(items)};
    size_t vectors = slots / sim->layout.width, local = sim->layout.local;
    asdic_status status = asdic_kernel_run(sim->reflect, reflect, COUNT(reflect), vectors, local);
    if (!status) {
        status = asdic_tracer_run(sim->tracer, sim->bounced, sim->bounced_hits, slots);
    }
    if (!status) {
        status = asdic_kernel_run(sim->connect, connect, COUNT(connect), vectors, local);
    }
    if (!status) {
        status = asdic_tracer_run(sim->tracer, sim->returning, sim->returning_hits, slots);
    }
    if (!status) {
        local = sim->layout.deposit == ASDIC_DEPOSIT_OWNED ? 1 : local;
        status = asdic_kernel_run(sim->bounce, bounce, COUNT(bounce), (size_t)ping->groups * items,
                                  local);
    }
    return status;
}

asdic_status asdic_simulator_draw(asdic_simulator *sim, const dev_ping *ping) {
    asdic_status status = asdic_buffer_write(sim->ping_buffer, 0, sizeof *ping, ping);
    if (status) {
        return status;
    }
    size_t slots = (size_t)ping->groups * ping->per_group;
    asdic_kernel_arg sample[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer),  ASDIC_ARG_BUFFER(sim->lobe_buffer),
        ASDIC_ARG_BUFFER(sim->table_buffer), ASDIC_ARG_BUFFER(sim->rays),
        ASDIC_ARG_BUFFER(sim->solid_angles), ASDIC_ARG_BUFFER(sim->splats)};
    status = asdic_kernel_run(sim->sample, sample, COUNT(sample), slots / sim->layout.width,
                              sim->layout.local);
    if (!status && sim->tracer) {
        status = asdic_tracer_run(sim->tracer, sim->rays, sim->hits, slots);
    }
    return status;
}

static asdic_status run_batch(asdic_simulator *sim, const dev_ping *ping) {
    asdic_status status = asdic_simulator_draw(sim, ping);
    if (status) {
        return status;
    }
    dev_uint items =
        sim->layout.deposit == ASDIC_DEPOSIT_OWNED ? 1 : ping->per_group / sim->layout.width;
    asdic_buffer *triangles = sim->tracer ? asdic_tracer_triangles(sim->tracer) : sim->no_triangles;
    asdic_kernel_arg shade[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                ASDIC_ARG_BUFFER(sim->beam_buffer),
                                ASDIC_ARG_BUFFER(sim->rays),
                                ASDIC_ARG_BUFFER(sim->solid_angles),
                                ASDIC_ARG_BUFFER(sim->splats),
                                ASDIC_ARG_BUFFER(sim->hits),
                                ASDIC_ARG_BUFFER(triangles),
                                ASDIC_ARG_BUFFER(sim->parts),
                                ASDIC_ARG_BUFFER(sim->materials),
                                ASDIC_ARG_BUFFER(sim->volume_inverse),
                                ASDIC_ARG_BUFFER(sim->accumulator),
                                ASDIC_ARG_BUFFER(sim->saturated),
                                ASDIC_ARG_VALUE(items)};
    size_t local = sim->layout.deposit == ASDIC_DEPOSIT_OWNED ? 1 : sim->layout.local;
    status = asdic_kernel_run(sim->shade, shade, COUNT(shade), (size_t)ping->groups * items, local);
    return status || !sim->has_mirrors ? status : run_bounces(sim, ping, items);
}

/* Turns water that ends in a bin into water that crosses it, in SUMS [group][component][bin][beam]. */
static asdic_status run_suffix(asdic_simulator *sim, const dev_ping *ping, asdic_buffer *sums) {
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer), ASDIC_ARG_BUFFER(sums)};
    return asdic_kernel_run(sim->suffix, args, COUNT(args), (size_t)ping->groups * ping->beams,
                            sim->layout.local);
}

static asdic_status reduce_groups(asdic_simulator *sim, const dev_ping *ping) {
    asdic_status status = run_suffix(sim, ping, sim->accumulator);
    if (status) {
        return status;
    }
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                               ASDIC_ARG_BUFFER(sim->accumulator),
                               ASDIC_ARG_BUFFER(sim->volume_ratio), ASDIC_ARG_BUFFER(sim->sums),
                               ASDIC_ARG_BUFFER(sim->spreads)};
    status = asdic_kernel_run(sim->reduce, args, COUNT(args), sim->cells, sim->layout.local);
    return status ? status
                  : asdic_buffer_read(sim->spreads, 0, 4 * sim->cells * sizeof(float),
                                      sim->host_spreads);
}

static asdic_status reduce_fan(asdic_simulator *sim, const dev_ping *ping) {
    asdic_status status = asdic_beam_fan_project(&sim->fan, ping, sim->ping_buffer,
                                                 sim->beam_buffer, sim->accumulator, sim->sums);
    return status ? status : run_suffix(sim, ping, sim->sums);
}

double asdic_simulator_spread(const asdic_simulator *sim, size_t cell) {
    if (sim->fan.cells) {
        return 1.0; /* one group: the calibration is the relative error itself */
    }
    unsigned level = 0;
    while (level < 3 && (16u >> level) > sim->groups) {
        level++;
    }
    return sim->host_spreads[4 * cell + level];
}

/* Relative standard error of a total to dB: its spread over groups, calibrated. */
static float stderr_db_of(const asdic_simulator *sim, size_t cell) {
    return (float)(10.0 / log(10.0) * asdic_simulator_spread(sim, cell) * sim->calibration[cell]);
}

static void convert_levels(asdic_simulator *sim, const dev_ping *ping,
                           const asdic_water_column *water, asdic_ping *out) {
    static const asdic_component component[DEV_DEPOSIT_COUNT] = {
        [DEV_DEPOSIT_BOTTOM] = ASDIC_BOTTOM,
        [DEV_DEPOSIT_SURFACE] = ASDIC_SURFACE,
        [DEV_DEPOSIT_OBJECT] = ASDIC_OBJECT,
        [DEV_DEPOSIT_MULTIPATH] = ASDIC_MULTIPATH,
        [DEV_DEPOSIT_VOLUME] = ASDIC_VOLUME};
    double source = pow(10.0, sim->sonar.source_level_db / 10.0);
    /* The paper prints 2 d - 1 metres of absorption where 2 (d - 1) is meant: one metre more. */
    if (sim->env.variant == ASDIC_VARIANT_PRINTED) {
        source *= exp(-water->absorption_np_per_m);
    }
    double strength = pow(10.0, 0.1 * volume_backscatter_db(sim->env.particle_strength_db,
                                                            sim->sonar.frequency_hz / 1e3));
    size_t beams = sim->sonar.receiver_count;
    for (size_t n = 0; n < sim->bins; n++) {
        double loss = source * asdic_water_column_loss(water, sim->sonar.bin_length_m, n);
        double volume =
            source * strength *
            asdic_water_column_volume(water, sim->sonar.bin_length_m, sim->sonar.blanking_m, n);
        for (size_t b = 0; b < beams; b++) {
            size_t from = n * beams + b, to = b * sim->bins + n;
            double total = 0.0;
            for (int c = 0; c < DEV_DEPOSIT_COUNT; c++) {
                double unit = c == DEV_DEPOSIT_VOLUME ? volume : loss;
                double energy = (double)sim->host_sums[(size_t)c * sim->cells + from];
                energy = energy > 0.0 ? energy * unit / ping->deposit_scale[c] : 0.0;
                out->intensity_lin[component[c]][to] = energy;
                total += energy;
            }
            double noise = out->intensity_lin[ASDIC_NOISE][to];
            out->stderr_db[to] =
                total > 0.0 ? (float)(stderr_db_of(sim, from) * total / (total + noise)) : 0.0f;
            out->intensity_lin[ASDIC_TOTAL][to] = total + noise;
        }
    }
}

asdic_status asdic_simulator_simulate(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                      uint32_t stream, asdic_ping *out) {
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    dev_ping ping;
    asdic_status status = asdic_simulator_describe(sim, pose, index, stream, &ping);
    if (status || (status = upload_bins(sim, &water)) ||
        (status = asdic_buffer_zero(sim->accumulator, asdic_buffer_bytes(sim->accumulator))) ||
        (status = asdic_buffer_zero(sim->saturated, sizeof(uint32_t)))) {
        return status;
    }
    size_t rays_per_group = (sim->sampling.rays + sim->groups - 1) / sim->groups;
    for (size_t first = 0; first < rays_per_group; first += sim->per_group) {
        ping.batch_first = (dev_uint)first;
        if ((status = run_batch(sim, &ping)) != ASDIC_OK) {
            return status;
        }
    }
    uint32_t saturated = 0;
    status = sim->fan.cells ? reduce_fan(sim, &ping) : reduce_groups(sim, &ping);
    if (status ||
        (status = asdic_buffer_read(sim->sums, 0, DEV_DEPOSIT_COUNT * sim->cells * sizeof(int64_t),
                                    sim->host_sums)) != ASDIC_OK ||
        (status = asdic_buffer_read(sim->saturated, 0, sizeof saturated, &saturated)) != ASDIC_OK) {
        return status;
    }
    asdic_noise_levels(&sim->env, &sim->sonar, water.sound_speed_mps, out);
    convert_levels(sim, &ping, &water, out);
    out->bin_length_m = sim->sonar.bin_length_m;
    out->rays = sim->sampling.rays;
    out->saturated = saturated;
    return ASDIC_OK;
}

asdic_status asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                  asdic_ping *out) {
    if (!sim || !pose || !out) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_ping: NULL argument");
    }
    if (out->beams != sim->sonar.receiver_count || out->bins != sim->bins) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping holds %zu beams x %zu bins, the simulator makes %zu x %zu",
                          out->beams, out->bins, sim->sonar.receiver_count, sim->bins);
    }
    asdic_status status = asdic_simulator_simulate(sim, pose, index, 0, out);
    if (!status) {
        double c = asdic_environment_sound_speed_mps(&sim->env, pose->position_m.z);
        asdic_pulse_smear(&sim->sonar, c, sim->smear_scratch, out);
        asdic_speckle_apply(&sim->sonar, c, sim->sampling.seed, index, out);
    }
    return status;
}
