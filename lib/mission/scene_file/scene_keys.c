/*
 * The scene file as a whole, and its short parts.
 */
#include "scene_keys.h"

#include "sim/environment.h"

/* --- environment ------------------------------------------------------------------------------ */

static const asdic_word particle_words[] = {
    {"low", -90}, {"moderate", -70}, {"high", -50}, {NULL, 0}};

static const asdic_key profile_speed = {"sound_speed_profile", ASDIC_KEY_NUMBER, .unit = "m/s",
                                        .min = ASDIC_SOUND_LEAST_MPS, .max = ASDIC_SOUND_MOST_MPS};

#define ENV(member) AT(file_environment, member)
static const asdic_key environment_keys[] = {
    {"temperature_degc", ASDIC_KEY_NUMBER, ENV(temperature_degc), .unit = "degC", .min = -2,
     .max = 40, .fallback = "10", .doc = "water temperature"},
    {"salinity_ppt", ASDIC_KEY_NUMBER, ENV(salinity_ppt), .unit = "ppt", .min = 0, .max = 45,
     .fallback = "35", .doc = "salinity"},
    {"ph", ASDIC_KEY_NUMBER, ENV(ph), .min = 7, .max = 8.5, .fallback = "8",
     .doc = "acidity, for the boric-acid part of absorption"},
    {"wind_speed_kn", ASDIC_KEY_NUMBER, ENV(wind_speed_kn), .unit = "kn", .min = 0, .max = 60,
     .fallback = "10", .doc = "wind speed, for surface scattering and sea-state noise"},
    {"shipping_density", ASDIC_KEY_NUMBER, ENV(shipping_density), .min = 0, .max = 1,
     .fallback = "0.5", .doc = "distant shipping, from none (0) to heavy (1), for traffic noise"},
    {"particle_density", ASDIC_KEY_NUMBER, ENV(particle_strength_db), .unit = "dB re 1/m at 1 kHz",
     .min = -200, .max = 0, .words = particle_words, .fallback = "low",
     .doc = "particles in the water, for volume scattering: low -90, moderate -70, high -50"},
    {"sound_speed_mps", ASDIC_KEY_NUMBER, ENV(sound_speed_mps), .unit = "m/s", .min = 1300,
     .max = 1700, .doc = "sound speed; else from temperature, salinity and the sonar's depth"},
    {"max_depth_m", ASDIC_KEY_NUMBER, ENV(max_depth_m), .unit = "m", .min = 0, .max = 11000,
     .doc = "depth that absorption is computed for; else the sonar's depth"},
    {"sound_speed_gradient_per_s", ASDIC_KEY_NUMBER, ASDIC_KEY_AT_MOST_ONE,
     ENV(sound_speed_gradient_per_s), .unit = "1/s", .min = -30, .max = 30, .fallback = "0",
     .doc = "change of the sound speed with depth, which bends rays; the speed is then that at the "
            "surface"},
    {"sound_speed_profile", ASDIC_KEY_CURVE, ASDIC_KEY_AT_MOST_ONE, ENV(sound_speed_profile),
     .file = ASDIC_FILE_CAST, .unit = "m", .min = 0, .max = 11000, .ordinate = &profile_speed,
     .least = 2, .count = ASDIC_PROFILE_POINTS,
     .doc = "sound speed over depth: a CSV file with depth_m,sound_speed_mps or "
            "depth_m,temperature_degc[,salinity_ppt], or a list of [depth_m, sound_speed_mps]"},
};
static const asdic_table environment_table = {TABLE(environment_keys, file_environment),
                                              .doc = "the water"};

/* --- how to compute, what to write ------------------------------------------------------------ */

#define SAMPLER_WORD(sampler, name) {name, sampler},
static const asdic_word sampler_words[] = {ASDIC_SAMPLERS(SAMPLER_WORD){NULL, 0}};
static const asdic_word multipath_words[] = {{"off", ASDIC_MULTIPATH_OFF},
                                             {"first", ASDIC_MULTIPATH_FIRST},
                                             {"boundaries", ASDIC_MULTIPATH_BOUNDARIES},
                                             {NULL, 0}};
static const asdic_word rays_words[] = {{"auto", FILE_RAYS_AUTO}, {NULL, 0}};
static const asdic_key sampling_keys[] = {
    {"rays", ASDIC_KEY_INTEGER, AT(file_sampling, rays), .min = 64, .max = 268435456,
     .words = rays_words, .fallback = "auto",
     .doc = "rays per ping; auto: by beams, bins and meshes, for a stated error of about 0.5 dB"},
    {"sampler", ASDIC_KEY_WORD, AT(file_sampling, sampler), .words = sampler_words,
     .fallback = "adaptive", .doc = "how directions are drawn; uniform-sphere is the paper's"},
    {"seed", ASDIC_KEY_INTEGER, AT(file_sampling, seed), .min = 0, .max = 9007199254740992.0,
     .fallback = "1", .doc = "start of the random sequence; equal seeds give equal bytes"},
    {"multipath", ASDIC_KEY_WORD, AT(file_sampling, multipath), .words = multipath_words,
     .fallback = "first",
     .doc = "echoes over a mirror: of objects (first), of bottom and surface as well (boundaries)"},
    {"coherent", ASDIC_KEY_BOOL, AT(file_sampling, coherent), .fallback = "false",
     .doc = "pressures with phase at the elements of the sonar's array, from which its beams are "
            "formed; rays is then about how many scatterers there are"},
};
static const asdic_table sampling_table = {TABLE(sampling_keys, file_sampling),
                                           .doc = "how rays are spent"};

static const asdic_word variant_words[] = {
    {"corrected", ASDIC_VARIANT_CORRECTED}, {"printed", ASDIC_VARIANT_PRINTED}, {NULL, 0}};
static const asdic_word terms_words[] = {
    {"needed", FILE_TERMS_NEEDED}, {"all", FILE_TERMS_ALL}, {NULL, 0}};
static const asdic_word refraction_words[] = {{"auto", FILE_REFRACTION_AUTO},
                                              {"full", ASDIC_REFRACTION_FULL},
                                              {"layer", ASDIC_REFRACTION_LAYER},
                                              {"off", ASDIC_REFRACTION_OFF},
                                              {NULL, 0}};
static const asdic_key model_keys[] = {
    {"variant", ASDIC_KEY_WORD, AT(file_model, variant), .words = variant_words,
     .fallback = "corrected", .doc = "the formulas put right, or as the paper prints them"},
    {"terms", ASDIC_KEY_WORD, AT(file_model, terms), .words = terms_words, .fallback = "needed",
     .doc = "leave out what no ping of the mission would show (needed), or nothing (all)"},
    {"refraction", ASDIC_KEY_WORD, AT(file_model, refraction), .words = refraction_words,
     .fallback = "auto",
     .doc =
         "follow all layers of a profile (full), one fitted layer, or none (off: straight rays); "
         "auto: what 'asdic plan' says"},
};
static const asdic_table model_table = {TABLE(model_keys, file_model), .doc = "the formulas"};

static const asdic_word target_words[] = {{"swerling0", ASDIC_TARGET_SWERLING0},
                                          {"swerling1", ASDIC_TARGET_SWERLING1},
                                          {"swerling2", ASDIC_TARGET_SWERLING2},
                                          {"swerling3", ASDIC_TARGET_SWERLING3},
                                          {NULL, 0}};
static const asdic_key detector_keys[] = {
    {"target", ASDIC_KEY_WORD, AT(file_detector, target), .words = target_words,
     .fallback = "swerling1", .doc = "how the target's echo fluctuates"},
    {"pfa", ASDIC_KEY_NUMBER, AT(file_detector, pfa), .min = ASDIC_DETECTOR_MIN_PFA,
     .max = ASDIC_DETECTOR_MAX_PFA, .fallback = "1.0e-3",
     .doc = "probability of false alarm per bin"},
    {"prior", ASDIC_KEY_NUMBER, AT(file_detector, prior), .min = ASDIC_DETECTOR_MIN_PRIOR,
     .max = ASDIC_DETECTOR_MAX_PRIOR, .fallback = "0.01",
     .doc = "prior probability that a bin holds a target"},
    {"snr_db", ASDIC_KEY_NUMBER, AT(file_detector, snr_db), .unit = "dB",
     .min = ASDIC_DETECTOR_MIN_SNR_DB, .max = ASDIC_DETECTOR_MAX_SNR_DB, .fallback = "10",
     .doc = "strength of the target that likelihood ratios assume, re the background"},
    {"cost_ratio", ASDIC_KEY_NUMBER, AT(file_detector, cost_ratio), .min = ASDIC_DETECTOR_MIN_COST,
     .max = ASDIC_DETECTOR_MAX_COST,
     .doc =
         "cost of a miss over that of a false alarm: the threshold that costs least; else by pfa"},
};
static const asdic_table detector_table = {TABLE(detector_keys, file_detector),
                                           .doc = "the detector"};

static const asdic_word csv_words[] = {{"auto", FILE_AUTO},
                                       {"long", ASDIC_CSV_LONG},
                                       {"wide", ASDIC_CSV_WIDE},
                                       {"none", ASDIC_CSV_NONE},
                                       {NULL, 0}};
static const asdic_word record_words[] = {{"auto", FILE_AUTO},
                                          {"full", ASDIC_RECORD_FULL},
                                          {"compact", ASDIC_RECORD_COMPACT},
                                          {"levels", ASDIC_RECORD_LEVELS},
                                          {NULL, 0}};
static const asdic_word image_words[] = {
    {"waterfall", ASDIC_IMAGE_WATERFALL}, {"ascope", ASDIC_IMAGE_ASCOPE}, {"fan", ASDIC_IMAGE_FAN},
    {"overview", ASDIC_IMAGE_OVERVIEW},   {"plan", ASDIC_IMAGE_PLAN},     {NULL, 0}};
#define FORMAT_KEY(name_of)                                                                        \
    {#name_of, ASDIC_KEY_BOOL, AT(file_output, formats[ASDIC_FORMAT_##name_of]),                   \
     .fallback = "false", .doc = asdic_format_doc_##name_of},
static const asdic_key output_keys[] = {
    {"csv", ASDIC_KEY_WORD, AT(file_output, csv), .words = csv_words, .fallback = "auto",
     .doc = "bins.csv: long has a row per ping, beam and bin, wide one per ping and beam; none: no "
            "such file, pings.npy holds the same; auto: long, but of several pings of more than 5 "
            "MB each none, with levels_float16.npy unless another format is asked for"},
    {"records", ASDIC_KEY_WORD, AT(file_output, records), .words = record_words, .fallback = "auto",
     .doc = "pings.npy: full has float32 throughout; compact has levels in float32, errors and the "
            "parts that the scene can have in float16; levels the same without parts; auto: full, "
            "but compact where csv: auto writes none"},
    {"elements", ASDIC_KEY_BOOL, AT(file_output, elements), .fallback = "false",
     .doc = "also elements.npy: of coherent pings the pressure by ping, element and sample, "
            "complex64"},
    {"truth", ASDIC_KEY_BOOL, AT(file_output, truth), .fallback = "false",
     .doc = "also truth.npy: strongest source, object, shares by path and depression of every bin"},
    ASDIC_FORMATS(FORMAT_KEY){
        "images", ASDIC_KEY_WORDS, AT(file_output, images), .words = image_words,
        .fallback = "[waterfall, ascope, fan, overview, plan]", .doc = "pictures to draw"},
};
static const asdic_table output_table = {TABLE(output_keys, file_output),
                                         .doc = "what a run writes"};

/* --- the file --------------------------------------------------------------------------------- */

#define SCENE(member) AT(asdic_scene_file, member)
static const asdic_key scene_keys[] = {
    {"version", ASDIC_KEY_INTEGER, ASDIC_KEY_REQUIRED, SCENE(version), .min = 1, .max = 1,
     .doc = "version of this format"},
    {"environment", ASDIC_KEY_MAP, SCENE(environment), .table = &environment_table,
     .doc = "the water"},
    {"surface", ASDIC_KEY_MAP, SCENE(surface), .table = &asdic_surface_table,
     .doc = "the sea surface, the plane z = 0"},
    {"bottom", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(bottom), .table = &asdic_bottom_table,
     .doc = "the sea floor: depth_m, mesh, grid or none"},
    {"objects", ASDIC_KEY_LIST, SCENE(objects), .count = 65536, .table = &asdic_object_table,
     .doc = "what is in the water or on the bottom"},
    {"sonar", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(sonar), .table = &asdic_sonar_table,
     .doc = "transmitter, receivers, pulse and bins"},
    {"mission", ASDIC_KEY_MAP, ASDIC_KEY_REQUIRED, SCENE(mission), .table = &asdic_mission_table,
     .doc = "where the vehicle is: pose, track or waypoints"},
    {"sampling", ASDIC_KEY_MAP, SCENE(sampling), .table = &sampling_table,
     .doc = "how rays are spent"},
    {"model", ASDIC_KEY_MAP, SCENE(model), .table = &model_table, .doc = "the formulas"},
    {"detector", ASDIC_KEY_MAP, SCENE(detector), .table = &detector_table, .doc = "the detector"},
    {"output", ASDIC_KEY_MAP, SCENE(output), .table = &output_table, .doc = "what a run writes"},
    {"trial", ASDIC_KEY_MAP, SCENE(trial), .table = &asdic_trial_table,
     .doc = "what differs from run to run of a trial"},
};
const asdic_table asdic_file_table = {
    TABLE(scene_keys, asdic_scene_file),
    .doc = "what asdic simulates: water, surface, bottom, objects, sonar and mission"};
