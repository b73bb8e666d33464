/*
 * Where the vehicle is at each ping, as a track that can be read again.
 */
#include "track_write.h"

#include "base/context.h"
#include "base/vec.h"
#include "out/digits.h"

#define RADIANS (ASDIC_PI / 180.0)

/* Not more digits than an attitude has, and few enough to be exact in text. */
static double nanodegrees(double angle_rad) {
    return rint(angle_rad / RADIANS * 1e9) / 1e9;
}

double asdic_track_round(double angle_rad) {
    return nanodegrees(angle_rad) * RADIANS;
}

void asdic_track_file_begin(asdic_file *file) {
    fputs("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n", asdic_file_stream(file));
}

void asdic_track_file_add(asdic_file *file, double time_s, const asdic_pose *pose) {
    FILE *out = asdic_file_stream(file);
    const double values[] = {time_s,
                             pose->position_m.x,
                             pose->position_m.y,
                             pose->position_m.z,
                             nanodegrees(pose->roll_rad),
                             nanodegrees(pose->pitch_rad),
                             nanodegrees(pose->yaw_rad)};
    for (size_t k = 0; k < 7; k++) {
        char digits[ASDIC_DIGITS_SIZE];
        asdic_digits_double(digits, values[k]);
        fputs(digits, out);
        fputc(k < 6 ? ',' : '\n', out);
    }
}

asdic_status asdic_track_file_write(asdic_context *ctx, const asdic_mission *mission, size_t first,
                                    size_t count, const char *path) {
    asdic_file *file = NULL;
    asdic_status status = asdic_file_create(ctx, path, &file);
    if (status != ASDIC_OK) {
        return status;
    }
    asdic_track_file_begin(file);
    for (size_t i = first; i < first + count; i++) {
        double time_s;
        asdic_pose pose = asdic_mission_pose(mission, i, &time_s);
        asdic_track_file_add(file, time_s, &pose);
    }
    return asdic_file_commit(&file);
}

asdic_status asdic_mission_write_track(asdic_context *ctx, const asdic_mission *mission,
                                       const char *path) {
    if (!mission || !path) {
        return asdic_fail_null(ctx, __func__);
    }
    return asdic_track_file_write(ctx, mission, 0, asdic_mission_ping_count(mission), path);
}
