#include "team.h"

#include "cli_state.h"

#include <stdlib.h>

/* Variables in which launchers tell how many processes they started: Open MPI; MPICH, Intel,
 * Slurm's PMI. */
static const char *const sizes[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"};

static long launched(void) {
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const char *value = getenv(sizes[i]);
        if (value) {
            return strtol(value, NULL, 10);
        }
    }
    /* PMIx tells only the rank; MPI tells how many there are. */
    return getenv("PMIX_RANK") ? 2 : 1;
}

bool cli_team_begin(cli *c, asdic_team **out) {
    *out = NULL;
    if (launched() < 2) {
        return true;
    }
#ifdef CLI_HAVE_MPI
    __typeof__(cli_mpi_begin) *begin = cli_module(c, "mpi", "cli_mpi_begin");
    if (!begin) {
        return false;
    }
    if (begin(cli_context(c), out) != ASDIC_OK) {
        cli_error(c, "%s", asdic_context_error(cli_context(c)));
        return false;
    }
    if (cli_team_is_worker(*out)) {
        c->verbosity = CLI_MUTE;
        cli_report_begin(c);
    }
    return true;
#else
    if (cli_given(c, "shard")) {
        return true; /* each process has a part of its own */
    }
    cli_usage(c,
              "this is one of %ld processes that a launcher started, but asdic was built without "
              "MPI; build it with -Dmpi=enabled, or give every process a --shard of its own",
              launched());
    return false;
#endif
}

void cli_team_end(cli *c, asdic_team **team) {
    if (!*team) {
        return;
    }
    if (asdic_team_end(cli_context(c), *team) != ASDIC_OK) {
        cli_error(c, "%s", asdic_context_error(cli_context(c)));
    }
#ifdef CLI_HAVE_MPI
    __typeof__(cli_mpi_end) *end = cli_module(c, "mpi", "cli_mpi_end");
    if (end) {
        end(team);
    }
#endif
}

bool cli_team_is_worker(const asdic_team *team) {
    return team && team->rank > 0;
}
