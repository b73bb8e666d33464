#include "size.h"

#include <stdio.h>

/* "8.4 MB" */
static const char *show(uint64_t bytes, char text[32]) {
    static const char *const units[] = {"kB", "MB", "GB", "TB", "PB"};
    double value = 1e-3 * (double)bytes;
    size_t unit = 0;
    while (value >= 999.5 && unit + 1 < sizeof units / sizeof *units) {
        value *= 1e-3;
        unit++;
    }
    snprintf(text, 32, "%.3g %s", value, units[unit]);
    return text;
}

const char *cli_size(const asdic_mission *mission, size_t pings, const char *folder,
                     char text[CLI_SIZE_TEXT]) {
    char each[32], all[32], left[32];
    uint64_t bytes = asdic_mission_ping_bytes(mission), room = asdic_disk_free_bytes(folder);
    snprintf(text, CLI_SIZE_TEXT, "%s a ping, %s in all; %s%s", show(bytes, each),
             show(asdic_mission_run_bytes(mission, pings), all),
             room == UINT64_MAX ? "unknown room" : show(room, left),
             room == UINT64_MAX ? "" : " free");
    return text;
}

void cli_remark_csv(const cli *c, const char *path, const asdic_mission *mission) {
    if (asdic_mission_leaves_csv_out(mission)) {
        cli_note(
            c,
            "%s: remark: no bins.csv, which would have some 100 bytes for each bin of %zu beams; "
            "'output: {csv: long}' writes it, pings.npy holds the same",
            path, asdic_mission_sonar(mission)->receiver_count);
    }
}

void cli_json_size(json *j, const asdic_mission *mission) {
    uint64_t bytes = asdic_mission_run_bytes(mission, asdic_mission_ping_count(mission));
    uint64_t room = asdic_disk_free_bytes(".");
    json_open(j, "output", '{');
    json_integer(j, "ping_bytes", asdic_mission_ping_bytes(mission));
    json_integer(j, "bytes", bytes);
    json_integer(j, "free_bytes", room);
    json_bool(j, "fits", bytes <= room);
    json_bool(j, "csv_left_out", asdic_mission_leaves_csv_out(mission));
    json_close(j);
}
