#include "size.h"

#include <stdio.h>

const char *cli_size(const asdic_mission *mission, size_t pings, const char *folder,
                     char text[CLI_SIZE_TEXT]) {
    char each[ASDIC_BYTES_TEXT], all[ASDIC_BYTES_TEXT], left[ASDIC_BYTES_TEXT];
    uint64_t bytes = asdic_mission_ping_bytes(mission), room = asdic_disk_free_bytes(folder);
    snprintf(text, CLI_SIZE_TEXT, "%s a ping, %s in all; %s%s", asdic_bytes_text(bytes, each),
             asdic_bytes_text(asdic_mission_run_bytes(mission, pings), all),
             room == UINT64_MAX ? "unknown room" : asdic_bytes_text(room, left),
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
