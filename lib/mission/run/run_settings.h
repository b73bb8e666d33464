/*
 * The settings of a scene file's text (environment, sonar, sampling, output) without its geometry,
 * which may be elsewhere by now.
 */
#ifndef ASDIC_MISSION_RUN_SETTINGS_H
#define ASDIC_MISSION_RUN_SETTINGS_H

#include <asdic/mission.h>

/* NAME is what errors call the text. The mission has neither scene nor track. */
asdic_status asdic_settings_read(asdic_context *ctx, const char *name, const char *text,
                                 asdic_mission **out);

#endif
