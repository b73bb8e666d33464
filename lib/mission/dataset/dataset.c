#include <asdic/dataset.h>

#include "base/context.h"
#include "base/text.h"
#include "base/try.h"
#include "gather.h"
#include "labelled.h"
#include "mission/mission.h"
#include "mission/run/run_folder.h"
#include "mission/scene_inputs.h"
#include "out/raster.h"

#include <dirent.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Scenes that are kept built: frames that differ in poses alone share one. */
#define KEPT 8
/* Frames that are made and written at the same time. */
#define SLOTS 3

/* A scene that is built, with its objects where poses put them. */
typedef struct built {
    asdic_mission *mission;
    asdic_simulator *simulator;
    size_t bins;
    asdic_frame_map maps[ASDIC_FORM_COUNT];
    size_t used;       /* when last; 0: empty */
    unsigned borrowed; /* by frames that are being written */
} built;

/* A frame on its way to the disk. */
typedef struct slot {
    asdic_ping *ping;
    asdic_labelled frame;
    float *gain_db;
    uint16_t *classes; /* of the scene's objects */
    bool *heard;       /* by asdic_lobes_reach; NULL: side lobes count */
    char *facts;
    built *from;
    bool is_full;
} slot;

typedef struct dataset {
    asdic_context *ctx;
    const char *scene;
    asdic_device *device;
    asdic_dataset_options options;
    DIR *folder; /* held while frames are made */
    built kept[KEPT];
    size_t clock;
    bool goes_on;   /* with the set in the folder, whose frames stay */
    double depth_m; /* of the first frame that is not void; NAN before it is loaded */
    double low_db, high_db;
    /* The writer's thread takes what SLOTS hold, in turn. */
    pthread_mutex_t lock;
    pthread_cond_t changed;
    slot slots[SLOTS];
    size_t put, taken; /* frames */
    bool is_over;
    asdic_status failure;
} dataset;

asdic_dataset_options asdic_dataset_options_default(void) {
    return (asdic_dataset_options){.seed = 1,
                                   .frames = 1000,
                                   .end = SIZE_MAX,
                                   .threshold = 0.5,
                                   .radius_px = 512.0,
                                   .low_db = NAN,
                                   .high_db = NAN};
}

/* --- scenes ----------------------------------------------------------------------------------- */

static void forget(built *b) {
    asdic_simulator_destroy(&b->simulator);
    asdic_frame_maps_finish(b->maps);
    asdic_mission_destroy(&b->mission);
    *b = (built){0};
}

/* The place for a scene more: the one that was not used for longest. */
static built *make_place(dataset *d) {
    built *oldest = &d->kept[0];
    for (size_t i = 1; i < KEPT; i++) {
        oldest = d->kept[i].used < oldest->used ? &d->kept[i] : oldest;
    }
    pthread_mutex_lock(&d->lock);
    while (oldest->borrowed > 0) {
        pthread_cond_wait(&d->changed, &d->lock);
    }
    pthread_mutex_unlock(&d->lock);
    forget(oldest);
    return oldest;
}

/* Builds a simulator for MISSION, which is taken over. What hangs on the sound speed at the sonar (array, bins,
 * automatic rays, speckle) is that of the first frame's depth in all scenes, whichever frame builds one. */
static asdic_status build(dataset *d, asdic_mission *mission, built **out) {
    built *b = *out = make_place(d);
    b->mission = mission;
    b->used = 1;
    if (isnan(d->depth_m)) {
        d->depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    }
    const asdic_settings *s = &mission->settings;
    asdic_sampling *sampling = asdic_mission_sampling(mission);
    if (s->auto_rays > 0) {
        double speed_mps = asdic_environment_sound_speed_mps(&s->environment, d->depth_m);
        sampling->rays = asdic_rays_auto(&s->sonar, speed_mps, s->rays_over);
    }
    if (sampling->coherent) {
        return asdic_fail(d->ctx, ASDIC_ERROR_INPUT,
                          "%s: labels are the truth about each bin, which coherent pings do not "
                          "have: leave 'coherent' out of 'sampling'",
                          d->scene);
    }
    sampling->truth = true;
    sampling->without_errors = true;
    TRY(asdic_simulator_create(d->ctx, d->device, asdic_mission_scene(mission),
                               asdic_mission_environment(mission), asdic_mission_sonar(mission),
                               sampling, d->depth_m, &b->simulator));
    b->bins = asdic_simulator_bin_count(b->simulator);
    return asdic_frame_maps_init(d->ctx, asdic_mission_sonar(mission), b->bins,
                                 d->options.radius_px, b->maps);
}

/* The mission of frame INDEX, to be destroyed unless it is FROM's own. A frame whose sonar would be below the bottom is
 * void: it has no FROM, and WHY says so. */
static asdic_status load(dataset *d, size_t index, asdic_mission **mission, built **from,
                         char why[ASDIC_BELOW_BOTTOM_SIZE]) {
    const asdic_mission *bases[KEPT];
    for (size_t i = 0; i < KEPT; i++) {
        bases[i] = d->kept[i].mission;
    }
    const asdic_draw draw = {d->options.seed, index};
    TRY(asdic_mission_load_like(d->ctx, d->scene, &draw, bases, KEPT, isnan(d->depth_m), mission));
    if (asdic_mission_is_below_bottom(*mission, 0, why)) {
        return ASDIC_OK;
    }
    for (size_t i = 0; i < KEPT; i++) {
        if ((*mission)->base && (*mission)->base == bases[i]) {
            *from = &d->kept[i];
            return ASDIC_OK;
        }
    }
    asdic_status status = build(d, *mission, from);
    if (status) {
        *mission = NULL; /* kept there */
    }
    return status;
}

/* --- a frame ---------------------------------------------------------------------------------- */

/* Twelve digits tell 0.01 mm in UTM, too. */
static void describe_pose(asdic_text *text, const asdic_pose *pose) {
    const double degree = 180.0 / 3.14159265358979323846;
    asdic_text_format(text, "\"position_m\":[%.12g,%.12g,%.12g],\"attitude_deg\":[%.9g,%.9g,%.9g]",
                      pose->position_m.x, pose->position_m.y, pose->position_m.z,
                      pose->roll_rad * degree, pose->pitch_rad * degree, pose->yaw_rad * degree);
}

/* The frame's line of the manifest; WHY it is void, NULL: it is not. */
static char *describe(const dataset *d, size_t index, const asdic_mission *m, const char *why) {
    asdic_text text = {0};
    asdic_pose pose = asdic_mission_pose(m, 0, NULL);
    asdic_text_format(&text, "{\"frame\":%zu,\"seed\":%llu,\"run\":%zu,\"scene_sha256\":\"%s\",",
                      index, (unsigned long long)d->options.seed, index, asdic_mission_hash(m));
    describe_pose(&text, &pose);
    asdic_text_add(&text, ",\"objects\":[");
    const char *comma = "";
    for (size_t i = 0; i < m->object_count; i++) {
        const asdic_mission_object *o = &m->objects[i];
        if (o->name[0]) {
            asdic_text_format(&text, "%s{\"number\":%zu,\"name\":", comma,
                              asdic_mission_class(m, o->name));
            asdic_text_add_json(&text, o->name);
            asdic_text_add(&text, ",");
            describe_pose(&text, &o->pose);
            asdic_text_add(&text, "}");
            comma = ",";
        }
    }
    asdic_text_add(&text, "],\"drawn\":{");
    for (size_t i = 0; asdic_mission_drawn(m, i).key; i++) {
        asdic_setting s = asdic_mission_drawn(m, i);
        asdic_text_add(&text, i ? "," : "");
        asdic_text_add_json(&text, s.key);
        asdic_text_add(&text, ":");
        asdic_text_add_json(&text, s.value);
    }
    asdic_text_add(&text, "}");
    if (why) {
        asdic_text_add(&text, ",\"void\":");
        asdic_text_add_json(&text, why);
    }
    asdic_text_add(&text, "}");
    return asdic_text_take(&text);
}

/* The classes of M's objects, by the numbers that truth gives them, from 1. */
static uint16_t *classes_of(const asdic_mission *m) {
    uint16_t *classes = calloc(m->object_count + 1, sizeof *classes);
    for (size_t i = 0, number = 0; classes && i < m->object_count; i++) {
        if (m->objects[i].name[0]) {
            classes[++number] = (uint16_t)asdic_mission_class(m, m->objects[i].name);
        }
    }
    return classes;
}

/* The time-varied gain of every bin, dB. */
static void fill_gain(const asdic_mission *m, double depth_m, size_t bins, float *gain_db) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    double alpha = asdic_environment_absorption_db_per_km(asdic_mission_environment(m),
                                                          sonar->frequency_hz, depth_m);
    for (size_t n = 0; n < bins; n++) {
        double range_m = ((double)n + 0.5) * sonar->bin_length_m;
        gain_db[n] = (float)(30.0 * log10(range_m) + 2.0 * alpha * range_m / 1000.0);
    }
}

static asdic_status make_room(dataset *d, slot *s, size_t beams, size_t bins) {
    if (s->ping && s->ping->beams == beams && s->ping->bins == bins) {
        return ASDIC_OK;
    }
    asdic_ping_destroy(&s->ping);
    free(s->gain_db);
    s->gain_db = malloc(bins * sizeof *s->gain_db);
    if (!s->gain_db) {
        return asdic_fail_memory(d->ctx, "a frame");
    }
    TRY(asdic_ping_create(d->ctx, beams, bins, &s->ping));
    return asdic_ping_add_truth(d->ctx, s->ping);
}

/* Simulates frame INDEX of MISSION in the scene FROM into S. */
static asdic_status shoot(dataset *d, size_t index, const asdic_mission *m, built *from, slot *s) {
    asdic_pose pose = asdic_mission_pose(m, 0, NULL);
    TRY(make_room(d, s, asdic_mission_sonar(m)->receiver_count, from->bins));
    for (size_t i = 0; i < m->object_count; i++) {
        if (m->objects[i].name[0] && from->mission->stands_anywhere) {
            TRY(asdic_simulator_move(from->simulator, m->objects[i].name, &m->objects[i].pose));
        }
    }
    TRY(asdic_simulator_ping(from->simulator, &pose, index, s->ping));
    fill_gain(m, pose.position_m.z, from->bins, s->gain_db);
    free(s->facts);
    free(s->classes);
    s->facts = describe(d, index, m, NULL);
    s->classes = classes_of(m);
    free(s->heard);
    s->heard = d->options.side_lobes ? NULL : asdic_lobes_reach(m, from->mission);
    if (!s->facts || !s->classes || (!s->heard && !d->options.side_lobes)) {
        return asdic_fail_memory(d->ctx, "a frame");
    }
    s->from = from;
    s->frame = (asdic_labelled){.index = index,
                                .folder = d->options.folder,
                                .facts = s->facts,
                                .ping = s->ping,
                                .maps = from->maps,
                                .gain_db = s->gain_db,
                                .low_db = d->low_db,
                                .high_db = d->high_db,
                                .threshold = d->options.threshold,
                                .heard = s->heard,
                                .classes = s->classes,
                                .class_count = m->class_count};
    return ASDIC_OK;
}

/* A frame without a ping, and WHY. */
static asdic_status leave_void(dataset *d, size_t index, const asdic_mission *m, const char *why,
                               slot *s) {
    free(s->facts);
    s->facts = describe(d, index, m, why);
    s->from = NULL;
    s->frame = (asdic_labelled){.index = index, .folder = d->options.folder, .facts = s->facts};
    return s->facts ? ASDIC_OK : asdic_fail_memory(d->ctx, "a frame");
}

static asdic_status make_frame(dataset *d, size_t index, slot *s) {
    asdic_mission *mission = NULL;
    built *from = NULL;
    char why[ASDIC_BELOW_BOTTOM_SIZE];
    asdic_status status = load(d, index, &mission, &from, why);
    if (!status && from) {
        from->used = ++d->clock + 1;
        status = shoot(d, index, mission, from, s);
    } else if (!status) {
        status = leave_void(d, index, mission, why, s);
    }
    if (mission && (!from || mission != from->mission)) {
        asdic_mission_destroy(&mission);
    }
    return status;
}

/* --- frame after frame ------------------------------------------------------------------------ */

static void *write_frames(void *user) {
    dataset *d = user;
    pthread_mutex_lock(&d->lock);
    for (;;) {
        slot *s = &d->slots[d->taken % SLOTS];
        if (!s->is_full) {
            if (d->is_over) {
                break;
            }
            pthread_cond_wait(&d->changed, &d->lock);
            continue;
        }
        asdic_status failed = d->failure;
        pthread_mutex_unlock(&d->lock);
        asdic_status status = failed ? failed : asdic_frame_write(d->ctx, &s->frame);
        pthread_mutex_lock(&d->lock);
        d->failure = d->failure ? d->failure : status;
        s->is_full = false;
        if (s->from) {
            s->from->borrowed--;
        }
        d->taken++;
        pthread_cond_broadcast(&d->changed);
    }
    pthread_mutex_unlock(&d->lock);
    return NULL;
}

/* The next slot that is free, or NULL after a failure. */
static slot *next_slot(dataset *d) {
    pthread_mutex_lock(&d->lock);
    slot *s = &d->slots[d->put % SLOTS];
    while (s->is_full) {
        pthread_cond_wait(&d->changed, &d->lock);
    }
    s = d->failure ? NULL : s;
    pthread_mutex_unlock(&d->lock);
    return s;
}

static void hand_over(dataset *d, slot *s) {
    pthread_mutex_lock(&d->lock);
    s->is_full = true;
    if (s->from) {
        s->from->borrowed++;
    }
    d->put++;
    pthread_cond_broadcast(&d->changed);
    pthread_mutex_unlock(&d->lock);
}

/* Without dataset.json nothing says of which set a frame is. The writer's thread may have failed meanwhile, and what it
 * said must stay: nothing is said here. */
static bool is_there(const dataset *d, size_t index) {
    return d->goes_on && asdic_frame_check(NULL, d->options.folder, index) == ASDIC_OK;
}

static asdic_status make_frames(dataset *d) {
    const asdic_dataset_options *o = &d->options;
    for (size_t index = o->first; index < o->end; index++) {
        if (asdic_step(d->ctx, "frames", index - o->first, o->end - o->first)) {
            return asdic_fail(d->ctx, ASDIC_ERROR_INTERRUPTED,
                              "interrupted at frame %zu; --resume goes on", index);
        }
        if (!is_there(d, index)) {
            slot *s = next_slot(d);
            if (!s) {
                return d->failure;
            }
            TRY(make_frame(d, index, s));
            hand_over(d, s);
        }
    }
    return ASDIC_OK;
}

/* NAN: not known yet. */
static asdic_status check_window(asdic_context *ctx, double low_db, double high_db) {
    return low_db >= high_db || isinf(low_db) || isinf(high_db)
               ? asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no window of levels: %g to %g dB", low_db,
                            high_db)
               : ASDIC_OK;
}

/* What `asdic check` says of a scene, of the one that is kept first, and what is odd about a set. */
static void tell(dataset *d, const asdic_mission *m) {
    asdic_remarks remarks = asdic_mission_remarks(m);
    for (size_t i = 0; i < remarks.count - remarks.lacks_format; i++) { /* no set has such */
        asdic_log(d->ctx, ASDIC_LOG_WARNING, "%s: remark: %s", d->scene, remarks.text[i]);
    }
    if (!asdic_mission_drawn(m, 0).key) {
        asdic_log(d->ctx, ASDIC_LOG_WARNING,
                  "%s: remark: nothing is drawn, so that frames differ in rays and speckle alone; "
                  "give 'trial: {draws: ...}'",
                  d->scene);
    }
    if (m->class_count == 0) {
        asdic_log(d->ctx, ASDIC_LOG_WARNING, "%s: remark: no objects, and so no classes", d->scene);
    }
}

/* Finds the first frame that is not void, and its scene, which is kept, for the names of classes. */
static asdic_status find_first(dataset *d, size_t *first) {
    char why[ASDIC_BELOW_BOTTOM_SIZE], other[ASDIC_BELOW_BOTTOM_SIZE];
    for (size_t index = 0; index < d->options.frames; index++) {
        asdic_mission *mission = NULL;
        built *from = NULL;
        TRY(load(d, index, &mission, &from, index == 0 ? why : other));
        if (from) {
            tell(d, mission);
            *first = index;
            return ASDIC_OK;
        }
        asdic_mission_destroy(&mission);
    }
    return asdic_fail(d->ctx, ASDIC_ERROR_INPUT, "%s: all %zu frames are void: frame 0, %s",
                      d->scene, d->options.frames, why);
}

/* The window of levels, that the first frame fills where none is given. */
static asdic_status look_at_first(dataset *d) {
    size_t first = 0;
    d->low_db = d->options.low_db;
    d->high_db = d->options.high_db;
    TRY(find_first(d, &first));
    if (!isnan(d->low_db) && !isnan(d->high_db)) {
        return ASDIC_OK;
    }
    slot *s = &d->slots[0];
    TRY(make_frame(d, first, s));
    size_t cells = s->ping->beams * s->ping->bins;
    float *levels_db = malloc(cells * sizeof *levels_db);
    if (!levels_db) {
        return asdic_fail_memory(d->ctx, "levels");
    }
    double low_db = 0.0, high_db = 0.0;
    for (size_t i = 0; i < cells; i++) {
        levels_db[i] = (float)asdic_level_db(s->ping->intensity_lin[ASDIC_TOTAL][i]) +
                       s->gain_db[i % s->ping->bins];
    }
    asdic_status status = asdic_raster_window(d->ctx, levels_db, cells, &low_db, &high_db);
    free(levels_db);
    d->low_db = isnan(d->low_db) ? low_db : d->low_db;
    d->high_db = isnan(d->high_db) ? high_db : d->high_db;
    return status ? status : check_window(d->ctx, d->low_db, d->high_db);
}

static asdic_status run_frames(dataset *d) {
    pthread_t writer;
    if (pthread_create(&writer, NULL, write_frames, d) != 0) {
        return asdic_fail_memory(d->ctx, "a thread");
    }
    asdic_status status = make_frames(d);
    pthread_mutex_lock(&d->lock);
    d->is_over = true;
    pthread_cond_broadcast(&d->changed);
    pthread_mutex_unlock(&d->lock);
    pthread_join(writer, NULL);
    return status ? status : d->failure;
}

/* --- the set ---------------------------------------------------------------------------------- */

/* What the set is; the same text for every part of it. */
static char *describe_set(const dataset *d, const char *scene_hash) {
    asdic_text text = {0};
    const asdic_dataset_options *o = &d->options;
    const asdic_mission *m = NULL;
    for (size_t i = 0; i < KEPT && !m; i++) {
        m = d->kept[i].mission;
    }
    asdic_text_add(&text, "{\"format\":\"asdic data set 1\",\"version\":");
    asdic_text_add_json(&text, asdic_version());
    asdic_text_format(&text,
                      ",\"seed\":%llu,\"frames\":%zu,\"threshold\":%.9g,\"radius_px\":%.9g,"
                      "\"side_lobes\":%s,\"low_db\":%.9g,\"high_db\":%.9g,"
                      "\"gain\":\"30 log r + 2 alpha r\",\"classes\":[",
                      (unsigned long long)o->seed, o->frames, o->threshold, o->radius_px,
                      o->side_lobes ? "true" : "false", d->low_db, d->high_db);
    for (size_t i = 0; m && i < m->class_count; i++) {
        asdic_text_add(&text, i ? "," : "");
        asdic_text_add_json(&text, m->classes[i]);
    }
    asdic_text_format(&text, "],\"scene\":\"%s\"}\n", scene_hash);
    return asdic_text_take(&text);
}

static asdic_status check_options(asdic_context *ctx, asdic_dataset_options *o) {
    o->end = o->end == SIZE_MAX ? o->frames : o->end;
    if (!o->folder || !o->folder[0]) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a data set needs a folder to write to");
    }
    if (o->first >= o->end || o->end > o->frames) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "frames %zu to %zu (without the last) are no part of a set of %zu",
                          o->first, o->end, o->frames);
    }
    if (!(o->threshold > 0.0 && o->threshold <= 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "threshold %g is out of range (0, 1]: a share of a bin's energy",
                          o->threshold);
    }
    if (!(o->radius_px >= 16.0 && o->radius_px <= 8192.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "radius %g is out of range [16, 8192] pixels",
                          o->radius_px);
    }
    TRY(check_window(ctx, o->low_db, o->high_db));
    return asdic_folder_check_mode(ctx, o->force, o->resume);
}

/* Of a frame that cannot be drawn the set should not end after hours. */
static asdic_status check_draws(const dataset *d) {
    const asdic_dataset_options *o = &d->options;
    asdic_text opened = {0};
    asdic_status status = ASDIC_OK;
    for (size_t index = o->first; !status && index < o->end; index++) {
        const asdic_draw draw = {o->seed, index};
        status = asdic_step(d->ctx, "draws", index - o->first, o->end - o->first);
        status = status ? status
                        : asdic_mission_check_run(d->ctx, d->scene, NULL, 0, &draw,
                                                  index == o->first ? &opened : NULL);
    }
    asdic_text_finish(&opened);
    return status;
}

static asdic_status make_set(dataset *d) {
    TRY(asdic_dataset_check(d->ctx, &d->options));
    TRY(check_draws(d));
    TRY(look_at_first(d));
    TRY(asdic_dataset_enter(d->ctx, &d->options, &d->folder));
    d->goes_on = asdic_dataset_is_in(d->options.folder);
    char hex[65];
    TRY(asdic_scene_inputs_hash(d->ctx, d->scene, hex));
    char *text = describe_set(d, hex);
    asdic_status status = text ? asdic_dataset_begin(d->ctx, &d->options, text)
                               : asdic_fail_memory(d->ctx, "what a data set is");
    free(text);
    TRY(status);
    TRY(run_frames(d));
    return asdic_dataset_gather(d->ctx, &d->options);
}

asdic_status asdic_dataset_make(asdic_context *ctx, const char *scene, asdic_device *device,
                                const asdic_dataset_options *options) {
    if (!scene || !device || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    dataset *d = calloc(1, sizeof *d);
    if (!d) {
        return asdic_fail_memory(ctx, "a data set");
    }
    d->ctx = ctx;
    d->scene = scene;
    d->device = device;
    d->options = *options;
    d->depth_m = NAN;
    pthread_mutex_init(&d->lock, NULL);
    pthread_cond_init(&d->changed, NULL);
    asdic_status status = check_options(ctx, &d->options);
    status = status ? status : make_set(d);
    if (d->folder) {
        closedir(d->folder);
    }
    for (size_t i = 0; i < KEPT; i++) {
        forget(&d->kept[i]);
    }
    for (size_t i = 0; i < SLOTS; i++) {
        asdic_ping_destroy(&d->slots[i].ping);
        free(d->slots[i].gain_db);
        free(d->slots[i].facts);
        free(d->slots[i].classes);
        free(d->slots[i].heard);
    }
    pthread_cond_destroy(&d->changed);
    pthread_mutex_destroy(&d->lock);
    free(d);
    return status;
}
