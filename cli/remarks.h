/*
 * What several commands say of a scene: remarks on laws that it uses outside their range of validity
 * (printed once, the command goes on), how its sonar scans, and what a run of it writes, beside the
 * room that there is for it.
 */
#ifndef ASDIC_CLI_REMARKS_H
#define ASDIC_CLI_REMARKS_H

#include "cli.h"
#include "json.h"

/* A line each on standard error, unless --quiet was given; PATH names the scene. WILL_RUN, into a
 * new folder: what no such run begins with is left to its error. */
void cli_remark(const cli *c, const char *path, const asdic_mission *mission, bool will_run);

/* "remarks": [...] */
void cli_json_remarks(json *j, const asdic_mission *mission);

/* How a scanned sonar looks round, as words for people and as "scan": {...}; no words, and nothing,
 * of a sonar that does not. */
#define CLI_SCAN_SIZE 160
void cli_scan_words(const asdic_mission *mission, char words[CLI_SCAN_SIZE]);
void cli_json_scan(json *j, const asdic_mission *mission);

/* "8.4 MB a ping, 15.6 GB in all; 20.1 GB free", of PINGS pings in FOLDER. */
#define CLI_SIZE_TEXT 160
const char *cli_size(const asdic_mission *mission, size_t pings, const char *folder,
                     char text[CLI_SIZE_TEXT]);

/* Says that bins.csv is left out because of the many beams, where it is. */
void cli_remark_csv(const cli *c, const char *path, const asdic_mission *mission);

/* "output": {...}, of the whole mission in the folder that we are in. */
void cli_json_size(json *j, const asdic_mission *mission);

/* Lets MISSION follow the form of --refraction where it is given; false after a bad word. */
bool cli_refract(cli *c, asdic_mission *mission);

#endif
