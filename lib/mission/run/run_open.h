/*
 * The inside of an opened run folder.
 */
#ifndef ASDIC_MISSION_RUN_OPEN_H
#define ASDIC_MISSION_RUN_OPEN_H

#include "mission/mission_settings.h"
#include "run_facts.h"
#include "run_store.h"

#include <asdic/run.h>

struct asdic_run {
    asdic_context *ctx;
    char *folder, *scene_name;
    asdic_arena arena; /* of the facts' strings */
    asdic_run_facts facts;
    asdic_settings settings;
    asdic_store *store;
    void *buffer; /* one record */
};

#endif
