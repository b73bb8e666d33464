/*
 * Where the vehicle is at each ping, as a track that can be read again.
 */
#include "mission.h"

#include "../base/context.h"
#include "../base/vec.h"
#include "../out/digits.h"
#include "../out/file.h"

asdic_status asdic_mission_write_track(asdic_context *ctx, const asdic_mission *mission,
                                       const char *path) {
    const double deg = 180.0 / ASDIC_PI;
    asdic_file *file = NULL;
    asdic_status status = asdic_file_create(ctx, path, &file);
    if (status != ASDIC_OK) {
        return status;
    }
    FILE *out = asdic_file_stream(file);
    fputs("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n", out);
    for (size_t i = 0; i < mission->ping_count; i++) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(mission, i, &time_s);
        const double values[] = {time_s,
                                 pose.position_m.x,
                                 pose.position_m.y,
                                 pose.position_m.z,
                                 deg * pose.roll_rad,
                                 deg * pose.pitch_rad,
                                 deg * pose.yaw_rad};
        for (size_t k = 0; k < 7; k++) {
            char digits[ASDIC_DIGITS_SIZE];
            asdic_digits_double(digits, values[k]);
            fputs(digits, out);
            fputc(k < 6 ? ',' : '\n', out);
        }
    }
    return asdic_file_commit(&file);
}
