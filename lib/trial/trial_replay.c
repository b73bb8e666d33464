/*
 * The scene of a run, and the run once more.
 */
#include "trial_run.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/text.h"
#include "base/try.h"
#include "mission/run/run_folder.h"
#include "out/digits.h"
#include "out/file.h"
#include "sim/variates.h"

#include "../../kernels/random.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Rays a ping where the scene leaves them to asdic: so many, or as many times two as leave no rough
 * pings, whose errors a detector would have to allow for. */
#define LEAST_RAYS 4096u
/* Where the search for as many as a tolerance takes begins. */
#define FIRST_RAYS 1024u
#define MOST_SETTINGS 3
#define SEED "sampling.seed"
#define RAYS "sampling.rays"
/* Seeds that a scene file holds exactly. */
#define SEED_BITS 52

/* The seed of a run's pings, the same for all variants. */
static uint64_t ping_seed(uint64_t seed, uint64_t run) {
    asdic_variates v = asdic_variates_begin(RANDOM_TRIAL, seed, run, 0xffffffffu);
    return (uint64_t)(asdic_variates_uniform(&v) * (double)((uint64_t)1 << SEED_BITS));
}

/* They are a number then: a loop has another one of its own for `auto`. */
static void choose_rays(asdic_mission *m) {
    asdic_ray_forecast forecast = asdic_mission_ray_forecast(m);
    uint32_t *rays = &asdic_mission_sampling(m)->rays, most = forecast.auto_rays;
    if (!forecast.is_auto) {
        return;
    }
    *rays = LEAST_RAYS;
    while (*rays < most && asdic_mission_ray_forecast(m).is_rough) {
        *rays = *rays < most / 2 ? 2 * *rays : most;
    }
    m->settings.auto_rays = 0;
}

/* What the trial sets itself is the same of all designs. */
static asdic_status check_vary(asdic_context *ctx, const asdic_trial_options *o) {
    const char *key = o->variants.key ? o->variants.key : "";
    if (strcmp(key, SEED) == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "'%s' cannot be varied: all designs share each run's seed, which comes "
                          "of the trial's (--seed)",
                          key);
    }
    return o->rays > 0 && strcmp(key, RAYS) == 0
               ? asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                            "'%s' cannot be varied where all designs are given the same (--rays, "
                            "--tolerance)",
                            key)
               : ASDIC_OK;
}

/* What the scene of a run has in place of what its file says. */
typedef struct run_settings {
    asdic_setting items[MOST_SETTINGS];
    size_t count;
    char seed[ASDIC_DIGITS_SIZE], rays[ASDIC_DIGITS_SIZE];
} run_settings;

static void find_settings(const asdic_trial_options *o, uint64_t run, size_t variant,
                          run_settings *s) {
    s->count = 0;
    if (o->variants.key) { /* first: it may be a map that holds the others */
        s->items[s->count++] = (asdic_setting){o->variants.key, o->variants.values[variant]};
    }
    asdic_digits_natural(s->seed, ping_seed(o->seed, run));
    s->items[s->count++] = (asdic_setting){SEED, s->seed};
    if (o->rays > 0) {
        asdic_digits_natural(s->rays, o->rays);
        s->items[s->count++] = (asdic_setting){RAYS, s->rays};
    }
}

/* OPENED as in asdic_mission_check_run, for the first run. */
static asdic_status check_run(asdic_context *ctx, const asdic_trial_options *o, uint64_t run,
                              asdic_text *opened) {
    const asdic_draw draw = {o->seed, run};
    TRY(asdic_step(ctx, "draws", run - o->first, o->count));
    for (size_t v = 0; v < o->variants.count; v++) {
        run_settings s;
        find_settings(o, run, v, &s);
        TRY(asdic_mission_check_run(ctx, o->scene, s.items, s.count, &draw, opened));
    }
    return ASDIC_OK;
}

asdic_status asdic_trial_check_draws(asdic_context *ctx, const asdic_trial_options *o) {
    asdic_text opened = {0};
    asdic_status status = check_vary(ctx, o);
    for (uint64_t run = o->first; !status && run < o->first + o->count; run++) {
        status = check_run(ctx, o, run, run == o->first ? &opened : NULL);
    }
    asdic_text_finish(&opened);
    return status;
}

asdic_status asdic_trial_load(asdic_context *ctx, const asdic_trial_options *o, uint64_t run,
                              size_t variant, asdic_mission *donor, asdic_mission **out) {
    const asdic_draw draw = {o->seed, run};
    run_settings s;
    TRY(check_vary(ctx, o));
    find_settings(o, run, variant, &s);
    TRY(asdic_mission_load_trial(ctx, o->scene, s.items, s.count, &draw, donor, out));
    if (o->rule && (*out)->trial.is_ideal) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "'trial: {ideal: ...}' makes no pings that a rule of another program "
                          "(--rule) could read; take 'ideal' out, or fly by the scene's own rule");
    }
    choose_rays(*out);
    return ASDIC_OK;
}

/* What is in FOLDER stays as it is unless it is to be given up; the trial's own scene always does. */
static asdic_status check_folder(asdic_context *ctx, const asdic_trial_options *o,
                                 const char *folder, const char *scene, const char *poses) {
    if (asdic_file_is_same(scene, o->scene)) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                          "'%s' is the trial's own scene, which a run again would replace; choose "
                          "another folder",
                          scene);
    }
    bool is_taken =
        access(scene, F_OK) == 0 || access(poses, F_OK) == 0 || asdic_folder_has_run(folder);
    return is_taken && !o->force
               ? asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                            "'%s' holds a scene, a track or a run already; use --force to replace "
                            "it, or another folder",
                            folder)
               : ASDIC_OK;
}

asdic_status asdic_trial_find_rays(asdic_context *ctx, asdic_device *device,
                                   const asdic_trial_options *options, size_t variant,
                                   const asdic_tolerance *tolerance, asdic_ray_budget *out) {
    if (!options || !options->scene || variant >= options->variants.count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "rays of a trial need its scene and one of its variants");
    }
    const asdic_trial_variants *v = &options->variants;
    const asdic_setting vary = {v->key, v->key ? v->values[variant] : NULL};
    const asdic_draw draw = {options->seed, 0};
    asdic_mission *mission = NULL;
    TRY(asdic_mission_load_trial(ctx, options->scene, &vary, v->key != NULL, &draw, NULL,
                                 &mission));
    asdic_mission_sampling(mission)->rays = options->rays > 0 ? options->rays : FIRST_RAYS;
    asdic_status status = asdic_mission_find_rays(ctx, mission, device, tolerance, out);
    asdic_mission_destroy(&mission);
    return status;
}

typedef struct replay {
    const asdic_trial_options *options;
    asdic_mission *mission;
    asdic_track *track;
    asdic_eye eye;
} replay;

static asdic_status write_track(asdic_context *ctx, const replay *r, const char *path) {
    const asdic_sweep *sweep = &r->mission->settings.sweep;
    asdic_file *file = NULL;
    TRY(asdic_file_create(ctx, path, &file));
    asdic_track_file_begin(file, sweep);
    for (size_t i = 0; i < r->track->count; i++) {
        const track_point *p = &r->track->points[i];
        const asdic_pose pose = {{p->x_m, p->y_m, p->z_m}, p->roll_rad, p->pitch_rad, p->yaw_rad};
        asdic_track_file_add(file, sweep, i, p->time_s, &pose);
    }
    return asdic_file_commit(&file);
}

static asdic_status fly_again(asdic_context *ctx, replay *r, uint64_t run, size_t variant,
                              const char *folder, asdic_trial_run *out) {
    const asdic_trial_options *o = r->options;
    const asdic_file_name scene = asdic_file_in(folder, "scene.yaml");
    const asdic_file_name poses = asdic_file_in(folder, "track.csv");
    char why[ASDIC_TRIAL_WHY];
    TRY(check_folder(ctx, o, folder, scene.text, poses.text));
    TRY(asdic_trial_load(ctx, o, run, variant, NULL, &r->mission));
    if (!r->eye.device && !r->mission->trial.is_ideal) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a trial that pings needs a device");
    }
    const asdic_trial_job job = {r->mission, o->seed, run, 0, o->rule, r->track};
    TRY(asdic_trial_run_one(&r->eye, &job, out, why));
    if (why[0]) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT, "run %llu is %s: %s", (unsigned long long)run,
                          asdic_trial_outcome_name(out->outcome), why);
    }
    TRY(asdic_folder_make(ctx, folder));
    TRY(asdic_mission_write_scene(ctx, r->mission, scene.text, "track.csv"));
    return write_track(ctx, r, poses.text);
}

asdic_status asdic_trial_replay(asdic_context *ctx, asdic_device *device,
                                const asdic_trial_options *options, uint64_t run, size_t variant,
                                const char *folder, asdic_trial_run *out) {
    if (!options || !options->scene || !folder || !out || variant >= options->variants.count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a run of a trial needs its scene, one of its variants and a folder");
    }
    replay r = {.options = options,
                .track = calloc(1, sizeof *r.track),
                .eye = {.device = device, .lookout.ctx = ctx}};
    asdic_status status = r.track ? fly_again(ctx, &r, run, variant, folder, out)
                                  : asdic_fail_memory(ctx, "a run of a trial");
    asdic_eye_finish(&r.eye);
    asdic_mission_destroy(&r.mission);
    asdic_track_destroy(&r.track);
    return status;
}
