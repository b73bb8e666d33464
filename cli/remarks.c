#include "remarks.h"

void cli_remark(const cli *c, const char *path, const asdic_mission *mission) {
    asdic_remarks remarks = asdic_mission_remarks(mission);
    for (size_t i = 0; i < remarks.count; i++) {
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
