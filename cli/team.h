/*
 * The processes that a launcher (mpirun, srun) started together to run one mission.
 */
#ifndef ASDIC_CLI_TEAM_H
#define ASDIC_CLI_TEAM_H

#include "cli.h"

/* The team that this process is one of, NULL when it is alone; false after a report when a
 * launcher started several but this program cannot speak with the others. */
bool cli_team_begin(cli *c, asdic_team **out);

/* When everything else is done, in every process and whatever happened. */
void cli_team_end(cli *c, asdic_team **team);

/* Not process 0, which alone speaks and whose exit code counts. */
bool cli_team_is_member(const asdic_team *team);

/* By MPI (team_mpi.c); *OUT is NULL when there is only one process. */
asdic_status cli_mpi_begin(asdic_context *ctx, asdic_team **out);
void cli_mpi_end(asdic_team **team);

#endif
