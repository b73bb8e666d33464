#include "run_open.h"

#include "base/context.h"
#include "base/try.h"
#include "out/record.h"
#include "run_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static asdic_status open_run(asdic_run *run) {
    asdic_run_facts *facts = &run->facts;
    TRY(asdic_run_facts_read(run->ctx, run->folder, &run->arena, facts));
    TRY(asdic_settings_read(run->ctx, facts->scene_path, facts->scene_text, &run->settings));
    facts->sweep = run->settings.sweep;
    facts->sampling.coherent = run->settings.sampling.coherent;
    run->settings.environment.refraction = facts->refraction;
    run->settings.environment.layer_from_m = facts->layer_from_m;
    run->settings.environment.layer_to_m = facts->layer_to_m;
    if (run->settings.sonar.receiver_count != facts->beams) {
        return asdic_fail(run->ctx, ASDIC_ERROR_INPUT,
                          "'%s/run.json' is damaged: %zu beams, but its scene has %zu", run->folder,
                          facts->beams, run->settings.sonar.receiver_count);
    }
    TRY(asdic_run_advise(run->ctx, asdic_run_check(run->ctx, run->folder, facts, ASDIC_RUN_SMALL)));
    const asdic_store_shape shape = {
        .first_ping = facts->first_ping,
        .layout =
            asdic_store_layout(&run->settings, facts->beams, facts->bins, facts->plan.left_out)};
    asdic_status status =
        asdic_store_open(run->ctx, run->folder, ASDIC_STORE_READ, &shape, &run->store);
    if (status == ASDIC_ERROR_IO) {
        return asdic_fail(run->ctx, ASDIC_ERROR_INPUT,
                          "%s; if the run was killed, or the file removed, 'asdic run' with "
                          "--resume makes it again",
                          asdic_context_error(run->ctx));
    }
    TRY(asdic_run_advise(run->ctx, status));
    run->scene_name = asdic_scene_name(facts->scene_path);
    run->buffer = malloc(asdic_record_bytes(facts->beams, facts->bins));
    return run->scene_name && run->buffer ? ASDIC_OK : asdic_fail_memory(run->ctx, "a run");
}

asdic_status asdic_run_open(asdic_context *ctx, const char *folder, asdic_run **out) {
    if (!ASDIC_PLACE(out) || !folder) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_run_open: no folder or no result");
    }
    asdic_run *run = calloc(1, sizeof *run);
    if (!run || !(run->folder = strdup(folder))) {
        free(run);
        return asdic_fail_memory(ctx, "a run");
    }
    run->ctx = ctx;
    asdic_status status = open_run(run);
    if (status != ASDIC_OK) {
        asdic_run_close(&run);
    }
    *out = run;
    return status;
}

void asdic_run_close(asdic_run **run) {
    if (!run || !*run) {
        return;
    }
    asdic_store_close(&(*run)->store);
    asdic_settings_finish(&(*run)->settings);
    asdic_arena_finish(&(*run)->arena);
    free((*run)->buffer);
    free((*run)->scene_name);
    free((*run)->folder);
    free(*run);
    *run = NULL;
}

asdic_run_info asdic_run_get_info(const asdic_run *run) {
    if (!run) {
        return (asdic_run_info){0};
    }
    const asdic_run_facts *facts = &run->facts;
    return (asdic_run_info){.first_ping = facts->first_ping,
                            .pings = asdic_store_count(run->store),
                            .pings_planned = facts->pings_planned,
                            .beams = facts->beams,
                            .bins = facts->bins,
                            .sonar = &run->settings.sonar,
                            .environment = &run->settings.environment,
                            .detector = &run->settings.detector,
                            .sampling = facts->sampling,
                            .has_surface = facts->has_surface,
                            .bottom = facts->bottom_law,
                            .scene_name = run->scene_name,
                            .scene_hash = facts->scene_hash,
                            .uncertainty = facts->uncertainty};
}

asdic_run_errors asdic_run_get_errors(const asdic_run *run) {
    return run ? run->facts.errors : (asdic_run_errors){NAN, NAN, NAN};
}

asdic_status asdic_run_read(asdic_run *run, size_t index, asdic_record *record) {
    if (!run || !record) {
        return asdic_fail_null(run ? run->ctx : NULL, __func__);
    }
    if (index >= asdic_store_count(run->store)) {
        return asdic_fail(run->ctx, ASDIC_ERROR_ARGUMENT, "record %zu of a run of %zu", index,
                          asdic_store_count(run->store));
    }
    TRY(asdic_run_advise(run->ctx, asdic_store_read(run->store, index, run->buffer)));
    asdic_record_view(run->buffer, run->facts.beams, run->facts.bins, record);
    return ASDIC_OK;
}

asdic_flat_scene asdic_run_flat_scene(const asdic_run *run, const asdic_record *record) {
    if (!run || !record) {
        return (asdic_flat_scene){0};
    }
    bool has_bottom = isfinite(record->altitude_m);
    return (asdic_flat_scene){.has_surface = run->facts.has_surface,
                              .has_bottom = has_bottom,
                              .altitude_m = has_bottom ? record->altitude_m : 0.0,
                              .depth_m = record->pose.position_m.z,
                              .bottom = run->facts.bottom_law,
                              .surface = run->facts.surface_law};
}
