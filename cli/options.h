/*
 * The options a command takes, its own first; for help, man pages and completions.
 */
#ifndef ASDIC_CLI_OPTIONS_H
#define ASDIC_CLI_OPTIONS_H

#include "cli_state.h"

size_t cli_options_of(const cli_command *command, const cli_option *out[CLI_MAX_OPTIONS]);

#endif
