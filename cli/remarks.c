#include "remarks.h"

#include <math.h>
#include <stdio.h>

void cli_remark(const cli *c, const char *path, const asdic_mission *mission, bool will_run) {
    asdic_remarks remarks = asdic_mission_remarks(mission);
    for (size_t i = 0; i < remarks.count - (will_run && remarks.lacks_format); i++) {
        cli_note(c, "%s: remark: %s", path, remarks.text[i]);
    }
}

void cli_json_remarks(json *j, const asdic_mission *mission) {
    asdic_remarks remarks = asdic_mission_remarks(mission);
    json_open(j, "remarks", '[');
    for (size_t i = 0; i < remarks.count; i++) {
        json_text(j, NULL, remarks.text[i]);
    }
    json_close(j);
}

bool cli_refract(cli *c, asdic_mission *mission) {
    const char *const words[] = {asdic_refraction_name(ASDIC_REFRACTION_FULL),
                                 asdic_refraction_name(ASDIC_REFRACTION_LAYER),
                                 asdic_refraction_name(ASDIC_REFRACTION_OFF), NULL};
    int form = -1;
    cli_choice(c, "refraction", words, &form);
    if (form >= 0) {
        asdic_mission_refract(mission, (asdic_refraction)form);
    }
    return !cli_bad_usage(c);
}

static double turn_s(const asdic_mission *mission, const asdic_sweep *sweep) {
    return (double)sweep->directions / asdic_mission_sonar(mission)->ping_rate_hz;
}

void cli_scan_words(const asdic_mission *mission, char words[CLI_SCAN_SIZE]) {
    asdic_sweep sweep = asdic_mission_sweep(mission);
    double half_deg = cli_degrees(asdic_sweep_bearing_rad(&sweep, sweep.directions - 1));
    words[0] = 0;
    if (sweep.directions == 0) {
        return;
    }
    int used = snprintf(words, CLI_SCAN_SIZE, "%zu directions, %.6g degrees apart, ",
                        sweep.directions, cli_degrees(sweep.step_rad));
    snprintf(words + used, CLI_SCAN_SIZE - (size_t)used,
             sweep.is_circle ? "round and round; a turn takes %.4g s"
                             : "back and forth; one way takes %.4g s, to %.6g degrees either side",
             turn_s(mission, &sweep), half_deg);
}

void cli_json_scan(json *j, const asdic_mission *mission) {
    asdic_sweep sweep = asdic_mission_sweep(mission);
    if (sweep.directions == 0) {
        return;
    }
    json_open(j, "scan", '{');
    json_integer(j, "directions", sweep.directions);
    json_number(j, "step_deg", cli_degrees(sweep.step_rad));
    json_bool(j, "circle", sweep.is_circle);
    json_number(j, "turn_s", turn_s(mission, &sweep));
    json_close(j);
}

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
