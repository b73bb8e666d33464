#include "run_rig.h"

#include <asdic/asdic.h>

#include <dirent.h>
#include <stdio.h>
#include <unistd.h>

/* ---- the fake ------------------------------------------------------------------------------- */

struct asdic_simulator {
    asdic_context *ctx;
    asdic_device *device;
    uint64_t block, seed;
    size_t bins;
};

asdic_status __wrap_asdic_simulator_create(asdic_context *ctx, asdic_device *device,
                                           const asdic_scene *scene, const asdic_environment *env,
                                           const asdic_sonar *sonar, const asdic_sampling *sampling,
                                           double depth_m, asdic_simulator **out);
void __wrap_asdic_simulator_destroy(asdic_simulator **sim);
size_t __wrap_asdic_simulator_bin_count(const asdic_simulator *sim);
asdic_status __wrap_asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose,
                                          uint64_t index);
size_t __wrap_asdic_simulator_ping_batch(const asdic_simulator *sim);
asdic_status __wrap_asdic_simulator_pings(asdic_simulator *sim, const asdic_pose *poses,
                                          uint64_t first, size_t count, asdic_ping *const *pings);
const asdic_device_info *__wrap_asdic_device_get_info(const asdic_device *device);

asdic_status __wrap_asdic_simulator_create(asdic_context *ctx, asdic_device *device,
                                           const asdic_scene *scene, const asdic_environment *env,
                                           const asdic_sonar *sonar, const asdic_sampling *sampling,
                                           double depth_m, asdic_simulator **out) {
    (void)scene;
    *out = NULL;
    if (device->refuses) {
        return ASDIC_ERROR_DEVICE;
    }
    *out = calloc(1, sizeof **out);
    (*out)->ctx = ctx;
    (*out)->device = device;
    (*out)->block = UINT64_MAX;
    (*out)->seed = sampling->seed;
    (*out)->bins = asdic_sonar_bin_count(sonar, asdic_environment_sound_speed_mps(env, depth_m));
    return ASDIC_OK;
}

void __wrap_asdic_simulator_destroy(asdic_simulator **sim) {
    free(*sim);
    *sim = NULL;
}

size_t __wrap_asdic_simulator_bin_count(const asdic_simulator *sim) {
    return sim->bins;
}

asdic_status __wrap_asdic_simulator_learn(asdic_simulator *sim, const asdic_pose *pose,
                                          uint64_t index) {
    (void)pose;
    assert_int_equal(index % ASDIC_LEARN_BLOCK, 0);
    sim->block = index / ASDIC_LEARN_BLOCK;
    sim->device->learnt++;
    return ASDIC_OK;
}

/* Levels that tell ping, beam, bin and what was learnt. */
static asdic_status fake_ping(asdic_simulator *sim, uint64_t index, asdic_ping *ping) {
    while (sim->device->after && !sim->device->after->is_lost) {
        usleep(50);
    }
    if (sim->device->pings == sim->device->fails_after) {
        sim->device->is_lost = true;
        return ASDIC_ERROR_DEVICE_LOST;
    }
    sim->device->pings++;
    usleep(sim->device->delay_us);
    for (size_t i = 0; i < ping->beams * ping->bins; i++) {
        for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
            double x = (double)(1 + i + 1000 * index + 7 * sim->block + sim->seed) * (1 + c);
            ping->intensity_lin[c][i] = i % 5 == 0 && c == ASDIC_OBJECT ? 0.0 : 1e-9 * x;
        }
        ping->stderr_db[i] = 0.125f;
    }
    ping->rays = 1000;
    ping->saturated = sim->device->saturated;
    return ASDIC_OK;
}

asdic_status __wrap_asdic_simulator_pings(asdic_simulator *sim, const asdic_pose *poses,
                                          uint64_t first, size_t count, asdic_ping *const *pings) {
    asdic_status status = ASDIC_OK;
    assert_non_null(poses);
    assert_int_equal(first / ASDIC_LEARN_BLOCK, (first + count - 1) / ASDIC_LEARN_BLOCK);
    for (size_t k = 0; status == ASDIC_OK && k < count; k++) {
        status = fake_ping(sim, first + k, pings[k]);
    }
    return status;
}

/* Devices of several kinds: how many go together must not matter. */
size_t __wrap_asdic_simulator_ping_batch(const asdic_simulator *sim) {
    return sim->device->together ? sim->device->together : 1;
}

const asdic_device_info *__wrap_asdic_device_get_info(const asdic_device *device) {
    return &device->info;
}

/* ---- a mission to run ----------------------------------------------------------------------- */

char run_rig_folder[] = "/tmp/asdic-run-XXXXXX";

char *in_folder(const char *name) {
    static char paths[4][256];
    static int turn;
    char *path = paths[turn++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", run_rig_folder, name);
    return path;
}

static void on_log(void *user, asdic_log_level level, const char *message) {
    fixture *f = user;
    if (level <= ASDIC_LOG_WARNING) {
        size_t used = strlen(f->warnings);
        snprintf(f->warnings + used, sizeof f->warnings - used, "%s\n", message);
    }
}

void begin(fixture *f) {
    *f = (fixture){.stop_at = SIZE_MAX};
    assert_int_equal(asdic_context_create(&f->ctx), ASDIC_OK);
    asdic_context_set_log(f->ctx, ASDIC_LOG_WARNING, on_log, f);
    assert_int_equal(asdic_mission_load(f->ctx, in_folder("scene.yaml"), &f->mission), ASDIC_OK);
    for (int i = 0; i < 3; i++) {
        f->devices[i].fails_after = SIZE_MAX;
        f->devices[i].delay_us = 50u * (unsigned)(i + 1);
        snprintf(f->devices[i].info.name, sizeof f->devices[i].info.name, "fake %d", i);
        f->pointers[i] = &f->devices[i];
    }
}

void end(fixture *f) {
    asdic_mission_destroy(&f->mission);
    asdic_context_destroy(&f->ctx);
}

static void on_progress(void *user, const asdic_run_progress *progress) {
    fixture *f = user;
    assert_true(progress->pings_done <= progress->pings_total);
    f->reported = progress->pings_done;
    if (progress->pings_done >= f->stop_at) {
        asdic_context_interrupt(f->ctx);
    }
}

asdic_status run(fixture *f, size_t devices, asdic_run_options options, const char *name) {
    char path[256]; /* of its own: processes of a team are threads here */
    snprintf(path, sizeof path, "%s/%s", run_rig_folder, name);
    options.folder = path;
    options.progress = on_progress;
    options.user = f;
    return asdic_mission_run(f->ctx, f->mission, f->pointers, devices, &options);
}

char *read_file(const char *run_name, const char *name, size_t *length) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s/%s", run_rig_folder, run_name, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *length = (size_t)ftell(file);
    rewind(file);
    char *data = malloc(*length + 1);
    assert_int_equal(fread(data, 1, *length, file), *length);
    data[*length] = 0;
    fclose(file);
    return data;
}

void assert_same_files(const char *a, const char *b) {
    static const char *const names[] = {"bins.csv", "pings.npy", "levels.npy",
                                        "waterfall_forward.png", "waterfall_down.png"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        size_t length, other_length;
        char *data = read_file(a, names[i], &length),
             *other = read_file(b, names[i], &other_length);
        assert_int_equal(length, other_length);
        assert_memory_equal(data, other, length);
        free(data);
        free(other);
    }
}

void assert_state(const char *run_name, const char *state, size_t pings) {
    char expected[64];
    size_t length;
    char *json = read_file(run_name, "run.json", &length);
    snprintf(expected, sizeof expected, "\"state\": \"%s\"", state);
    assert_non_null(strstr(json, expected));
    snprintf(expected, sizeof expected, "\"pings\": %zu,", pings);
    assert_non_null(strstr(json, expected));
    free(json);
}

/* Every file of a folder is whole. */
void assert_no_part(const char *run_name) {
    DIR *dir = opendir(in_folder(run_name));
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir));) {
        assert_null(strstr(entry->d_name, ".part"));
    }
    closedir(dir);
}

int set_up(void **state) {
    (void)state;
    if (!mkdtemp(run_rig_folder)) {
        return -1;
    }
    FILE *file = fopen(in_folder("scene.yaml"), "w");
    fprintf(file,
            "version: 1\n"
            "bottom: {depth_m: 12, type: sand}\n"
            "sonar:\n"
            "  frequency_khz: 100\n"
            "  ping_rate_hz: 20\n"
            "  bin_length_m: 1\n"
            "  receivers:\n"
            "    - {name: forward}\n"
            "    - {name: down, pitch_deg: 45}\n"
            "mission: {pose: {position_m: [0, 0, 5]}, pings: %d}\n"
            "output: {npy: true, images: [waterfall]}\n",
            PINGS);
    fclose(file);
    fixture f;
    begin(&f);
    assert_int_equal(run(&f, 1, asdic_run_options_default(), "reference"), ASDIC_OK);
    assert_int_equal(f.reported, PINGS);
    assert_int_equal(f.devices[0].learnt, (PINGS + ASDIC_LEARN_BLOCK - 1) / ASDIC_LEARN_BLOCK);
    assert_no_part("reference");
    assert_state("reference", "complete", PINGS);
    end(&f);
    return 0;
}

int tear_down(void **state) {
    (void)state;
    char command[300];
    snprintf(command, sizeof command, "rm -r '%s'", run_rig_folder);
    return system(command);
}
