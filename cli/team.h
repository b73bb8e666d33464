/*
 * The processes that a launcher (mpirun, srun) started together to run one mission.
 */
#ifndef ASDIC_CLI_TEAM_H
#define ASDIC_CLI_TEAM_H

#include "cli.h"

/* The team of this process, NULL when it is alone. False after a report when a launcher started
 * several processes but this program was built without MPI. */
bool cli_team_begin(cli *c, asdic_team **out);

/* Call it last, in every process, whatever happened. */
void cli_team_end(cli *c, asdic_team **team);

/* Whether this process is a worker: not process 0, the coordinator, which alone prints and sets the
 * exit code. */
bool cli_team_is_worker(const asdic_team *team);

/* Of the module "mpi"; *OUT is NULL when there is only one process. */
asdic_status cli_mpi_begin(asdic_context *ctx, asdic_team **out);
void cli_mpi_end(asdic_team **team);

#endif
