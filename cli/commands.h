/*
 * All commands, in the order in which help lists them.
 */
#ifndef ASDIC_CLI_COMMANDS_H
#define ASDIC_CLI_COMMANDS_H

#include "cli.h"

/* clang-format off */
#define CLI_COMMANDS(X) \
    X(run) X(expect) X(detect) X(roc) X(trial) X(view) X(serve) X(render) X(merge) X(dataset) \
    X(model) X(bench) X(check) X(plan) X(schema) X(devices) X(help)
/* clang-format on */

#define DECLARE(name) extern const cli_command cli_##name##_command;
CLI_COMMANDS(DECLARE)
#undef DECLARE

extern const cli_command *const cli_commands[]; /* ends with NULL */

/* NULL when there is none of that name. */
const cli_command *cli_find_command(const char *name);

/* "unknown command 'runn'; did you mean 'run'?" */
void cli_unknown_command(const cli *c, const char *name);

#endif
