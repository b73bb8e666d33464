/*
 * What 'asdic check' reports on one file: as text on stdout, or as an object in J when it is not
 * NULL. The caller reports failures.
 */
#ifndef ASDIC_CLI_CHECK_H
#define ASDIC_CLI_CHECK_H

#include "cli.h"
#include "json.h"

asdic_status check_scene(cli *c, const char *path, json *j);
asdic_status check_mesh(cli *c, const char *path, bool is_grid, json *j);

/* Significant digits that tell a coordinate to a hundredth, at least LEAST: those of UTM have seven
 * before the point. */
int check_digits(double x, int least);
/* Prints "AXIS LOW .. HIGH". */
void check_span(const char *axis, double low, double high, int least);

/* "KEY": [x, y, z] */
void check_json_vec(json *j, const char *key, asdic_vec3 v);

#endif
