/*
 * What several commands say of a scene: remarks on laws that it uses outside their range of validity
 * (printed once, the command goes on), and how its sonar scans.
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

/* Lets MISSION follow the form of --refraction where it is given; false after a bad word. */
bool cli_refract(cli *c, asdic_mission *mission);

#endif
