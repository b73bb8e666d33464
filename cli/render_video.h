/*
 * A video of a run.
 */
#ifndef ASDIC_CLI_RENDER_VIDEO_H
#define ASDIC_CLI_RENDER_VIDEO_H

#include "cli.h"

/* A frame for each ping of the run in FOLDER, its fan or the one picture of a ping that OPTIONS
 * choose, into PATH; the file's ending says the format. Returns an exit code. */
int render_video(cli *c, const char *folder, const asdic_render_options *options, const char *path);

#endif
