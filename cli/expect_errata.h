/*
 * What the slips of the paper change on a scene.
 */
#ifndef ASDIC_CLI_EXPECT_ERRATA_H
#define ASDIC_CLI_EXPECT_ERRATA_H

#include "cli.h"

/* One ping of a mission without objects. */
typedef struct expect_scene {
    asdic_environment env;
    asdic_sonar sonar;
    asdic_flat_scene flat;
    asdic_pose pose;
    size_t bins;
} expect_scene;

/* Prints the table; returns an exit code. */
int expect_errata(cli *c, const expect_scene *scene);

#endif
