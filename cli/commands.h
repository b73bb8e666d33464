/*
 * All commands, in the order in which help lists them.
 */
#ifndef ASDIC_CLI_COMMANDS_H
#define ASDIC_CLI_COMMANDS_H

#include "cli.h"

extern const cli_command cli_bench_command;
extern const cli_command cli_check_command;
extern const cli_command cli_detect_command;
extern const cli_command cli_devices_command;
extern const cli_command cli_expect_command;
extern const cli_command cli_merge_command;
extern const cli_command cli_dataset_command;
extern const cli_command cli_render_command;
extern const cli_command cli_roc_command;
extern const cli_command cli_run_command;
extern const cli_command cli_model_command;
extern const cli_command cli_help_command_row;
extern const cli_command cli_plan_command;
extern const cli_command cli_schema_command;
extern const cli_command cli_serve_command;
extern const cli_command cli_trial_command;
extern const cli_command cli_view_command;

extern const cli_command *const cli_commands[]; /* ends with NULL */

/* NULL when there is none of that name. */
const cli_command *cli_find_command(const char *name);

/* "unknown command 'runn'; did you mean 'run'?" */
void cli_unknown_command(const cli *c, const char *name);

#endif
