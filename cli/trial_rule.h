/*
 * A rule in another program: it gets each ping as `asdic serve` writes it, and answers with a line.
 */
#ifndef ASDIC_CLI_TRIAL_RULE_H
#define ASDIC_CLI_TRIAL_RULE_H

#include "cli.h"

typedef struct trial_programs trial_programs;

/* Whether the shell finds the program that COMMAND begins with. True where that cannot be told before
 * it runs: the command begins with an assignment, a quotation or other syntax of the shell. */
bool trial_program_exists(const char *command);

/* COMMAND is run by the shell, a process for each of WORKERS, when it is needed first. NULL: no
 * memory. */
trial_programs *trial_programs_begin(const char *command, size_t workers, double timeout_s);

/* Ends the processes. */
void trial_programs_end(trial_programs **programs);

/* asdic_trial_rule.decide of the programs. What crashed, hung or answered nonsense is ended, and begun
 * anew for the next run. */
bool trial_programs_decide(void *programs, const asdic_trial_look *look, asdic_trial_order *order,
                           char why[ASDIC_TRIAL_WHY]);

#endif
