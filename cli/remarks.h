/*
 * Remarks on laws that a scene uses outside their range of validity: printed once, the command goes
 * on.
 */
#ifndef ASDIC_CLI_REMARKS_H
#define ASDIC_CLI_REMARKS_H

#include "cli.h"
#include "json.h"

/* A line each on standard error, unless --quiet was given; PATH names the scene. */
void cli_remark(const cli *c, const char *path, const asdic_mission *mission);

/* "remarks": [...] */
void cli_json_remarks(json *j, const asdic_mission *mission);

#endif
