/*
 * What a run writes, beside the room that there is for it.
 */
#ifndef ASDIC_CLI_SIZE_H
#define ASDIC_CLI_SIZE_H

#include "cli.h"
#include "json.h"

/* "8.4 MB a ping, 15.6 GB in all; 20.1 GB free", of PINGS pings in FOLDER. */
#define CLI_SIZE_TEXT 160
const char *cli_size(const asdic_mission *mission, size_t pings, const char *folder,
                     char text[CLI_SIZE_TEXT]);

/* Says that bins.csv is left out because of the many beams, where it is. */
void cli_remark_csv(const cli *c, const char *path, const asdic_mission *mission);

/* "output": {...}, of the whole mission in the folder that we are in. */
void cli_json_size(json *j, const asdic_mission *mission);

#endif
