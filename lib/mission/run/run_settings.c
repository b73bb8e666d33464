#include "run_settings.h"

#include "base/context.h"
#include "base/number.h"
#include "mission/mission_build.h"

#include <stdlib.h>
#include <string.h>

asdic_status asdic_settings_read(asdic_context *ctx, const char *name, const char *text,
                                 asdic_mission **out) {
    asdic_arena arena = {0};
    asdic_scene_file file;
    asdic_problems problems = {.name = name};
    locale_t before = asdic_c_locale_enter();
    asdic_status status = ASDIC_OK;
    asdic_mission *mission = calloc(1, sizeof *mission);
    mission_builder builder = {
        .ctx = ctx, .file = &file, .problems = &problems, .arena = &arena, .mission = mission};
    *out = NULL;
    if (!mission || !(mission->path = strdup(name)) || !(mission->text = strdup(text)) ||
        !asdic_scene_file_parse(text, strlen(text), &arena, &problems, &file)) {
        status = asdic_fail_memory(ctx, "a scene's settings");
        goto fail;
    }
    mission->ctx = ctx;
    status = asdic_mission_build_settings(&builder);
    if (status == ASDIC_OK) {
        status = asdic_problems_report(&problems, ctx);
    }
    if (status == ASDIC_OK) {
        *out = mission;
        mission = NULL;
    }
fail:
    asdic_mission_destroy(&mission);
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    asdic_c_locale_leave(before);
    return status;
}
