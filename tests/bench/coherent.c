/* What coherent pings cost: how time grows with elements, samples and scatterers, and the published
 * case of Project DAVE: 512 beams, 114 echoes in each, 2,392 cells of range to 60 m. */
#include "bench_pings.h"
#include "kinds.h"

#include <asdic/plan.h>

#include <math.h>

#define BEAMS 128
#define MOST_BEAMS 512
#define BEAM_POINTS 114
#define MOST_ROUNDS 15
#define DEPTH_M 7.0
#define SOUND_MPS 1500.0

const bench_column coherent_columns[] = {{"case", "case", 12, 0, 0.0},
                                         {"elements", "elements", 8, 0, 0.0},
                                         {"samples", "samples", 8, 0, 0.0},
                                         {"scatterers", "scatterers", 10, 0, 0.0},
                                         {"beams", "beams", 6, 0, 0.0},
                                         {"ping_s", "ms/ping", 9, 1, 1e3},
                                         {"processor_s", "processor", 9, 1, 1e3},
                                         {"pair_s", "ns/pair", 8, 2, 1e9},
                                         {NULL, NULL, 0, 0, 0.0}};

/* RANGE_M is the farthest; beams look SECTOR_DEG wide. */
typedef struct array_case {
    const char *name;
    size_t elements, beams;
    uint32_t rays;
    double frequency_hz, bandwidth_hz, range_m, sector_deg;
    bool points; /* as many in every beam, and nothing else; otherwise a floor */
} array_case;

static const array_case cases[] = {
    {"goal", 64, BEAMS, 130000, 100e3, 10e3, 75.0, 90.0, false},
    {"elements/4", 16, BEAMS, 400000, 100e3, 10e3, 75.0, 90.0, false},
    {"elements*4", 256, BEAMS, 130000, 100e3, 10e3, 75.0, 90.0, false},
    {"samples/4", 64, BEAMS, 400000, 100e3, 10e3, 18.75, 90.0, false},
    {"scatterers*4", 64, BEAMS, 1600000, 100e3, 10e3, 75.0, 90.0, false},
    {"512 x 114", 512, MOST_BEAMS, 10000, 900e3, 29.9e3, 60.0, 90.0, true},
};
enum { CASES = sizeof cases / sizeof *cases };

static asdic_sonar sonar_of(const array_case *of, asdic_beam *receivers) {
    double wavelength_m = SOUND_MPS / of->frequency_hz;
    asdic_sonar sonar = asdic_sonar_default();
    sonar.frequency_hz = of->frequency_hz;
    sonar.bandwidth_hz = of->bandwidth_hz;
    sonar.bin_length_m = 0.5 * SOUND_MPS / of->bandwidth_hz;
    sonar.max_range_m = of->range_m;
    sonar.ping_rate_hz = SOUND_MPS / (2.0 * of->range_m);
    sonar.transmitter.length_h_m = sonar.transmitter.length_v_m = 0.5 * wavelength_m;
    sonar.array = (asdic_array){
        .elements = of->elements, .spacing_m = 0.5 * wavelength_m, .element = sonar.transmitter};
    for (size_t b = 0; b < of->beams; b++) {
        double share = (double)b / (double)(of->beams - 1) - 0.5;
        receivers[b] = sonar.transmitter;
        receivers[b].length_h_m = (double)of->elements * 0.5 * wavelength_m;
        receivers[b].yaw_rad = share * of->sector_deg * CLI_PI / 180.0;
    }
    sonar.receivers = receivers;
    sonar.receiver_count = of->beams;
    return sonar;
}

static asdic_status time_pings(const bench *b, const array_case *of, asdic_simulator *sim,
                               asdic_ping *ping, double *ping_s, double *processor_s) {
    size_t rounds = b->quick || of->points ? 3 : MOST_ROUNDS;
    double times_s[MOST_ROUNDS], busy_s[MOST_ROUNDS];
    asdic_pose pose = {.position_m = {0.0, 0.0, DEPTH_M}};
    TRY(asdic_simulator_ping(sim, &pose, 0, ping)); /* compiles */
    for (size_t k = 0; k < rounds; k++) {
        TRY(bench_interrupted(b));
        double began = cli_clock_s(), busy = cli_processor_s();
        pose.position_m.x = 0.5 * (double)k;
        TRY(asdic_simulator_ping(sim, &pose, k + 1, ping));
        times_s[k] = cli_clock_s() - began;
        busy_s[k] = cli_processor_s() - busy;
    }
    *ping_s = bench_median(times_s, rounds);
    *processor_s = bench_median(busy_s, rounds);
    return ASDIC_OK;
}

/* What a case hears: a sandy floor, or points by beams, at ranges that the golden section
 * spreads evenly. */
static asdic_status furnish(asdic_scene *scene, const array_case *of) {
    asdic_scene_set_surface(scene, false);
    if (!of->points) {
        return asdic_scene_set_bottom_plane(scene, 12.0, asdic_material_bottom(2.0));
    }
    for (size_t i = 0; i < of->beams * BEAM_POINTS; i++) {
        double share = ((double)(i / BEAM_POINTS) + 0.5) / (double)of->beams - 0.5;
        double bearing = share * of->sector_deg * CLI_PI / 180.0;
        double range_m = 2.0 + 0.95 * (of->range_m - 2.0) * fmod((double)i * 0.6180339887, 1.0);
        asdic_vec3 at = {range_m * cos(bearing), range_m * sin(bearing), DEPTH_M};
        TRY(asdic_scene_add_point(scene, "point", at, -30.0));
    }
    return ASDIC_OK;
}

static asdic_status measure_case(bench *b, const asdic_scene *scene, const array_case *of) {
    asdic_context *ctx = cli_context(b->c);
    asdic_beam receivers[MOST_BEAMS];
    asdic_environment env = asdic_environment_default();
    asdic_sampling sampling = asdic_sampling_default();
    asdic_sonar sonar = sonar_of(of, receivers);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    double ping_s = NAN, processor_s = NAN;
    env.sound_speed_mps = SOUND_MPS;
    sampling.rays = of->rays;
    sampling.coherent = true;
    sampling.left_out = of->points ? 1u << ASDIC_TERM_VOLUME : 0u;
    asdic_status status =
        asdic_simulator_create(ctx, b->device, scene, &env, &sonar, &sampling, DEPTH_M, &sim);
    status =
        status ? status : asdic_ping_create(ctx, of->beams, asdic_simulator_bin_count(sim), &ping);
    status = status ? status : time_pings(b, of, sim, ping, &ping_s, &processor_s);
    if (!status) {
        double pairs = (double)ping->rays * (double)of->elements;
        const bench_cell cells[] = {BENCH_TEXT(of->name),
                                    BENCH_NUMBER(of->elements),
                                    BENCH_NUMBER(asdic_simulator_sample_count(sim)),
                                    BENCH_NUMBER(ping->rays),
                                    BENCH_NUMBER(of->beams),
                                    BENCH_NUMBER(ping_s),
                                    BENCH_NUMBER(processor_s),
                                    BENCH_NUMBER(processor_s / pairs)};
        bench_add(b, cells);
    }
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

static asdic_status run_case(bench *b, const array_case *of) {
    asdic_scene *scene = NULL;
    asdic_status status = asdic_scene_create(cli_context(b->c), &scene);
    status = status ? status : furnish(scene, of);
    status = status ? status : asdic_scene_commit(scene);
    status = status ? status : measure_case(b, scene, of);
    asdic_scene_destroy(&scene);
    return status;
}

asdic_status coherent(bench *b) {
    for (size_t i = 0; i < (b->quick ? 2 : CASES); i++) {
        TRY(run_case(b, &cases[i]));
    }
    return ASDIC_OK;
}
