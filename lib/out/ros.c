#include <asdic/ros.h>

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "beam_width.h"
#include "out/ros_types.h"
#include "polar.h"
#include "raster.h"
#include "ros_outputs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PICTURE_RADIUS_PX 400.0
#define PICTURE_BACKGROUND_RGB 0x000000u
#define SECOND_NS 1000000000
/* Of a ping's messages beside levels, ranges and picture: headers, poses; direction and widths. */
#define HEAD_BYTES 900
#define BEAM_BYTES 32

struct asdic_ros {
    asdic_context *ctx;
    asdic_ros_about about;
    asdic_sonar sonar; /* with beams of our own */
    size_t cells;
    asdic_ros_vector3 *directions; /* of the beams */
    float *widths;                 /* [2 * beams]: receivers horizontally, transmitter vertically */
    float *ranges_m;
    float *levels_db;               /* [bin * beams + beam] */
    float *found;                   /* [5 * cells]: what is detected, list after list */
    asdic_ros_detection_flag *good; /* [cells], zeros */
    double *bearing_rad;            /* of the beams */
    asdic_polar polar;              /* of a scan */
    asdic_picture_options look;
    bool has_window;
    asdic_raster raster;
    asdic_bytes bytes;
};

asdic_ros_about asdic_ros_about_default(void) {
    return (asdic_ros_about){
        .world_frame = "map", .vehicle_frame = "base_link", .sonar_frame = "sonar"};
}

/* --- frames ----------------------------------------------------------------------------------- */

static asdic_ros_point point_of(asdic_vec3 ned) {
    return (asdic_ros_point){.x = ned.y, .y = ned.x, .z = -ned.z};
}

/* Both frames change: north-east-down to east-north-up turns the heading, forward-starboard-down
 * to forward-port-up the sign of the pitch (REP 103). Then the quaternion of yaw, pitch, roll
 * about the turned z, y, x (J. Diebel, Representing Attitude, Stanford University, 2006: Euler
 * angles 1, 2, 3). */
static asdic_ros_quaternion quaternion_of(const asdic_pose *ned) {
    double roll = 0.5 * ned->roll_rad, pitch = -0.5 * ned->pitch_rad;
    double yaw = 0.5 * (0.5 * ASDIC_PI - ned->yaw_rad);
    double cr = cos(roll), sr = sin(roll), cp = cos(pitch), sp = sin(pitch);
    double cy = cos(yaw), sy = sin(yaw);
    return (asdic_ros_quaternion){.x = sr * cp * cy - cr * sp * sy,
                                  .y = cr * sp * cy + sr * cp * sy,
                                  .z = cr * cp * sy - sr * sp * cy,
                                  .w = cr * cp * cy + sr * sp * sy};
}

/* The way back, of any length but 0. Where the bow looks straight up or down, roll is 0. */
static void attitude_of(const asdic_ros_quaternion *q, asdic_pose *ned) {
    double n = q->x * q->x + q->y * q->y + q->z * q->z + q->w * q->w;
    double sine = 2.0 * (q->w * q->y - q->z * q->x) / n, yaw;
    if (fabs(sine) > 1.0 - 1e-12) {
        ned->roll_rad = 0.0;
        ned->pitch_rad = -copysign(0.5 * ASDIC_PI, sine);
        yaw = -2.0 * copysign(1.0, sine) * atan2(q->x, q->w);
    } else {
        ned->roll_rad = atan2(2.0 * (q->w * q->x + q->y * q->z),
                              q->w * q->w - q->x * q->x - q->y * q->y + q->z * q->z);
        ned->pitch_rad = -asin(sine);
        yaw = atan2(2.0 * (q->w * q->z + q->x * q->y),
                    q->w * q->w + q->x * q->x - q->y * q->y - q->z * q->z);
    }
    ned->yaw_rad = 0.5 * ASDIC_PI - yaw;
}

/* The sonar's z ahead, y to port, x down: a quarter turn about y after the head's about z, which is
 * HEAD_RAD to starboard. */
static asdic_ros_quaternion sonar_rotation(double head_rad) {
    double half = sqrt(0.5), port = 0.5 * (0.0 - head_rad), c = cos(port), s = sin(port);
    return (asdic_ros_quaternion){.x = 0.0 - s * half, .y = c * half, .z = s * half, .w = c * half};
}

/* --- making ----------------------------------------------------------------------------------- */

static void aim(asdic_ros *ros) {
    const asdic_sonar *sonar = &ros->sonar;
    double wavelength_m = ros->about.sound_speed_mps / sonar->frequency_hz;
    size_t beams = sonar->receiver_count;
    for (size_t b = 0; b < beams; b++) {
        const asdic_beam *beam = &sonar->receivers[b];
        double cp = cos(beam->pitch_rad); /* positive looks down */
        ros->directions[b] = (asdic_ros_vector3){
            .x = sin(beam->pitch_rad), .y = -cp * sin(beam->yaw_rad), .z = cp * cos(beam->yaw_rad)};
        ros->widths[b] = (float)asdic_half_power_rad(wavelength_m, beam->length_h_m);
        ros->widths[beams + b] =
            (float)asdic_half_power_rad(wavelength_m, sonar->transmitter.length_v_m);
        ros->bearing_rad[b] = beam->yaw_rad;
    }
    for (size_t i = 0; i < ros->about.bins; i++) {
        ros->ranges_m[i] = (float)(((double)i + 0.5) * sonar->bin_length_m);
    }
}

static asdic_status begin(asdic_ros *ros, const asdic_ros_about *about) {
    size_t beams = about->sonar->receiver_count, bins = about->bins;
    asdic_beam *receivers = malloc(beams * sizeof *receivers);
    ros->about = *about;
    ros->sonar = *about->sonar;
    ros->sonar.receivers = receivers;
    ros->cells = beams * bins;
    ros->directions = malloc(beams * sizeof *ros->directions);
    ros->widths = malloc(2 * beams * sizeof *ros->widths);
    ros->ranges_m = malloc(bins * sizeof *ros->ranges_m);
    ros->levels_db = malloc(ros->cells * sizeof *ros->levels_db);
    ros->bearing_rad = malloc(beams * sizeof *ros->bearing_rad);
    ros->look = asdic_picture_options_default();
    if (!receivers || !ros->directions || !ros->widths || !ros->ranges_m || !ros->levels_db ||
        !ros->bearing_rad) {
        return asdic_fail_memory(ros->ctx, "messages of ROS 2");
    }
    memcpy(receivers, about->sonar->receivers, beams * sizeof *receivers);
    aim(ros);
    return about->sweep.directions
               ? asdic_polar_init(ros->ctx, &about->sweep, receivers[0].yaw_rad, bins, &ros->polar)
               : ASDIC_OK;
}

asdic_status asdic_ros_create(asdic_context *ctx, const asdic_ros_about *about, asdic_ros **out) {
    if (!ASDIC_PLACE(out) || !about || !about->sonar || !about->sonar->receivers ||
        !about->world_frame || !about->vehicle_frame || !about->sonar_frame) {
        return asdic_fail_null(ctx, __func__);
    }
    size_t beams = about->sonar->receiver_count, bins = about->bins;
    if (beams == 0 || beams > ASDIC_SONAR_MAX_RECEIVERS || bins == 0 || bins > UINT32_MAX ||
        about->sweep.directions > UINT32_MAX) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "messages of %zu beams and %zu bins in %zu directions", beams, bins,
                          about->sweep.directions);
    }
    *out = calloc(1, sizeof **out);
    if (!*out) {
        return asdic_fail_memory(ctx, "messages of ROS 2");
    }
    (*out)->ctx = ctx;
    asdic_status status = begin(*out, about);
    if (status) {
        asdic_ros_destroy(out);
    }
    return status;
}

void asdic_ros_destroy(asdic_ros **ros) {
    asdic_ros *r = ros ? *ros : NULL;
    if (r) {
        free((void *)r->sonar.receivers);
        free(r->directions);
        free(r->widths);
        free(r->ranges_m);
        free(r->levels_db);
        free(r->found);
        free(r->good);
        free(r->bearing_rad);
        asdic_polar_finish(&r->polar);
        asdic_raster_finish(&r->raster);
        asdic_bytes_finish(&r->bytes);
        free(r);
        *ros = NULL;
    }
}

/* --- pings ------------------------------------------------------------------------------------ */

static asdic_ros_time time_of(int64_t time_ns) {
    int64_t seconds = time_ns / SECOND_NS - (time_ns % SECOND_NS < 0 ? 1 : 0);
    return (asdic_ros_time){.sec = (int32_t)seconds,
                            .nanosec = (uint32_t)(time_ns - seconds * SECOND_NS)};
}

static asdic_ros_header header_of(const asdic_ros_ping *ping, const char *frame) {
    return (asdic_ros_header){.stamp = time_of(ping->time_ns), .frame_id = frame};
}

static asdic_ros_ping_info info_of(const asdic_ros *ros) {
    size_t beams = ros->sonar.receiver_count;
    return (asdic_ros_ping_info){.frequency = (float)ros->sonar.frequency_hz,
                                 .sound_speed = (float)ros->about.sound_speed_mps,
                                 .tx_beamwidths = {ros->widths + beams, beams},
                                 .rx_beamwidths = {ros->widths, beams}};
}

/* The way from the world to the sonar, without the first LEFT_OUT of its two steps. */
static asdic_status put_way(asdic_ros *ros, const asdic_ros_ping *ping, size_t left_out) {
    const asdic_ros_about *a = &ros->about;
    asdic_ros_point at = point_of(ping->vehicle.position_m);
    double head_rad =
        asdic_sweep_bearing_rad(&a->sweep, asdic_sweep_direction(&a->sweep, ping->ping));
    const asdic_ros_transform_stamped both[2] = {
        {.header = header_of(ping, a->world_frame),
         .child_frame_id = a->vehicle_frame,
         .transform = {.translation = {at.x, at.y, at.z},
                       .rotation = quaternion_of(&ping->vehicle)}},
        {.header = header_of(ping, a->vehicle_frame),
         .child_frame_id = a->sonar_frame,
         .transform = {.rotation = sonar_rotation(head_rad)}}};
    const asdic_ros_tfmessage message = {.transforms = {both + left_out, 2 - left_out}};
    asdic_ros_write(&ros->bytes, &asdic_ros_tfmessage_type, &message);
    return ASDIC_OK;
}

static asdic_status put_transforms(asdic_ros *ros, const asdic_ros_ping *ping) {
    return put_way(ros, ping, 0);
}

static asdic_status put_head(asdic_ros *ros, const asdic_ros_ping *ping) {
    return put_way(ros, ping, 1);
}

static asdic_status put_pose(asdic_ros *ros, const asdic_ros_ping *ping) {
    const asdic_ros_pose_stamped message = {.header = header_of(ping, ros->about.world_frame),
                                            .pose = {.position = point_of(ping->vehicle.position_m),
                                                     .orientation = quaternion_of(&ping->vehicle)}};
    asdic_ros_write(&ros->bytes, &asdic_ros_pose_stamped_type, &message);
    return ASDIC_OK;
}

/* Beam by beam becomes range by range, as the viewers of these messages read them. */
static asdic_status put_sonar(asdic_ros *ros, const asdic_ros_ping *ping) {
    size_t beams = ros->sonar.receiver_count, bins = ros->about.bins;
    for (size_t b = 0; b < beams; b++) {
        for (size_t i = 0; i < bins; i++) {
            ros->levels_db[i * beams + b] = ping->level_db[b * bins + i];
        }
    }
    const asdic_ros_projected_sonar_image message = {
        .header = header_of(ping, ros->about.sonar_frame),
        .ping_info = info_of(ros),
        .beam_directions = {ros->directions, beams},
        .ranges = {ros->ranges_m, bins},
        .image = {.dtype = ASDIC_ROS_SONAR_IMAGE_DATA_DTYPE_FLOAT32,
                  .beam_count = (uint32_t)beams,
                  .data = {(const uint8_t *)ros->levels_db, ros->cells * sizeof(float)}}};
    asdic_ros_write(&ros->bytes, &asdic_ros_projected_sonar_image_type, &message);
    return ASDIC_OK;
}

static asdic_status paint(asdic_ros *ros, const asdic_ros_ping *ping) {
    asdic_fan fan = {.levels_db = ping->level_db,
                     .bearing_rad = ros->bearing_rad,
                     .beams = ros->sonar.receiver_count,
                     .bins = ros->about.bins,
                     .bin_length_m = ros->sonar.bin_length_m};
    if (!ros->has_window) {
        TRY(asdic_raster_window(ros->ctx, ping->level_db, ros->cells, &ros->look.db_low,
                                &ros->look.db_high));
        ros->has_window = true;
    }
    if (ros->about.sweep.directions) {
        fan = asdic_polar_fan(&ros->polar, fan.bin_length_m);
    }
    asdic_raster_finish(&ros->raster);
    asdic_sector sector = asdic_sector_of(&fan, PICTURE_RADIUS_PX);
    return asdic_raster_fan(ros->ctx, &fan, &sector, &ros->look, PICTURE_BACKGROUND_RGB,
                            &ros->raster);
}

static asdic_status put_picture(asdic_ros *ros, const asdic_ros_ping *ping) {
    TRY(paint(ros, ping));
    const asdic_raster *r = &ros->raster;
    const asdic_ros_image message = {.header = header_of(ping, ros->about.sonar_frame),
                                     .height = (uint32_t)r->height,
                                     .width = (uint32_t)r->width,
                                     .encoding = "rgb8",
                                     .step = (uint32_t)(3 * r->width),
                                     .data = {r->rgb, 3 * r->width * r->height}};
    asdic_ros_write(&ros->bytes, &asdic_ros_image_type, &message);
    return ASDIC_OK;
}

/* One entry for each bin that is detected. */
static asdic_status put_detections(asdic_ros *ros, const asdic_ros_ping *ping) {
    size_t bins = ros->about.bins, count = 0;
    ros->found = ros->found ? ros->found : calloc(5 * ros->cells, sizeof *ros->found);
    ros->good = ros->good ? ros->good : calloc(ros->cells, sizeof *ros->good);
    if (!ros->found || !ros->good) {
        return asdic_fail_memory(ros->ctx, "detections for ROS 2");
    }
    float *times_s = ros->found, *delays_s = times_s + ros->cells;
    float *levels_db = delays_s + ros->cells, *up_rad = levels_db + ros->cells;
    float *starboard_rad = up_rad + ros->cells;
    for (size_t i = 0; i < ros->cells; i++) {
        const asdic_beam *beam = &ros->sonar.receivers[i / bins];
        if (ping->detected[i]) {
            times_s[count] = 2.0f * ros->ranges_m[i % bins] / (float)ros->about.sound_speed_mps;
            levels_db[count] = ping->level_db[i];
            up_rad[count] = (float)-beam->pitch_rad;
            starboard_rad[count++] = (float)beam->yaw_rad;
        }
    }
    const asdic_ros_sonar_detections message = {.header = header_of(ping, ros->about.sonar_frame),
                                                .ping_info = info_of(ros),
                                                .flags = {ros->good, count},
                                                .two_way_travel_times = {times_s, count},
                                                .tx_delays = {delays_s, count},
                                                .intensities = {levels_db, count},
                                                .tx_angles = {up_rad, count},
                                                .rx_angles = {starboard_rad, count}};
    asdic_ros_write(&ros->bytes, &asdic_ros_sonar_detections_type, &message);
    return ASDIC_OK;
}

static const struct {
    const asdic_ros_type *type;
    asdic_status (*put)(asdic_ros *ros, const asdic_ros_ping *ping);
} outputs[ASDIC_ROS_OUTPUT_COUNT] = {
    [ASDIC_ROS_TRANSFORMS] = {&asdic_ros_tfmessage_type, put_transforms},
    [ASDIC_ROS_POSE] = {&asdic_ros_pose_stamped_type, put_pose},
    [ASDIC_ROS_SONAR] = {&asdic_ros_projected_sonar_image_type, put_sonar},
    [ASDIC_ROS_PICTURE] = {&asdic_ros_image_type, put_picture},
    [ASDIC_ROS_DETECTIONS] = {&asdic_ros_sonar_detections_type, put_detections},
    [ASDIC_ROS_HEAD] = {&asdic_ros_tfmessage_type, put_head},
};

/* The sector's box hangs on the outer beams and their neighbours alone. */
static size_t picture_bytes(const asdic_sonar *sonar, const asdic_sweep *sweep) {
    size_t n = sweep->directions ? sweep->directions : sonar->receiver_count;
    const size_t outer[4] = {0, 1, n - 2, n - 1};
    double bearing_rad[4], aim_rad = sweep->is_circle ? 0.0 : sonar->receivers[0].yaw_rad;
    for (size_t i = 0; i < 4; i++) {
        bearing_rad[i] = sweep->directions ? asdic_sweep_bearing_rad(sweep, outer[i]) + aim_rad
                                           : sonar->receivers[outer[i]].yaw_rad;
    }
    const asdic_fan fan = {.bearing_rad = bearing_rad, .beams = 4};
    asdic_sector box = asdic_sector_of(&fan, PICTURE_RADIUS_PX);
    return 3 * box.width * box.height;
}

static bool has_picture(const asdic_sonar *sonar, const asdic_sweep *sweep) {
    return sweep->directions >= 3 || asdic_beams_make_fan(sonar);
}

size_t asdic_ros_ping_bytes(const asdic_sonar *sonar, const asdic_sweep *sweep) {
    return HEAD_BYTES + sonar->receiver_count * BEAM_BYTES +
           (has_picture(sonar, sweep) ? picture_bytes(sonar, sweep) : 0);
}

const asdic_ros_type *asdic_ros_type_of(asdic_ros_output output) {
    return outputs[output].type;
}

const char *asdic_ros_type_name(asdic_ros_output output) {
    return (unsigned)output < ASDIC_ROS_OUTPUT_COUNT ? outputs[output].type->name : NULL;
}

bool asdic_ros_has(const asdic_ros *ros, asdic_ros_output output) {
    return (unsigned)output < ASDIC_ROS_OUTPUT_COUNT &&
           (output != ASDIC_ROS_PICTURE || has_picture(&ros->sonar, &ros->about.sweep)) &&
           (output != ASDIC_ROS_HEAD || ros->about.sweep.directions);
}

asdic_status asdic_ros_encode(asdic_ros *ros, asdic_ros_output output, const asdic_ros_ping *ping,
                              const void **bytes, size_t *size) {
    if (!ros || !ping || !ping->level_db || !bytes || !size ||
        (output == ASDIC_ROS_DETECTIONS && !ping->detected)) {
        return asdic_fail_null(ros ? ros->ctx : NULL, __func__);
    }
    if (!asdic_ros_has(ros, output)) {
        return asdic_fail(ros->ctx, ASDIC_ERROR_ARGUMENT,
                          "no output %d of this sonar; a picture needs three beams or more in the "
                          "order of their bearings, or a scan, and a head a scan",
                          (int)output);
    }
    if (ros->about.sweep.directions) { /* whatever is asked for: the picture is of all pings */
        asdic_polar_add(&ros->polar, ping->ping, ping->level_db);
    }
    TRY(outputs[output].put(ros, ping));
    if (ros->bytes.failed) {
        return asdic_fail_memory(ros->ctx, "a message of ROS 2");
    }
    *bytes = ros->bytes.bytes;
    *size = ros->bytes.size;
    return ASDIC_OK;
}

/* --- poses that come in ----------------------------------------------------------------------- */

static asdic_status no_place(asdic_context *ctx, const asdic_ros_pose *pose) {
    const asdic_ros_point *p = &pose->position;
    const asdic_ros_quaternion *q = &pose->orientation;
    return asdic_fail(
        ctx, ASDIC_ERROR_INPUT,
        "the pose is none: position (%g, %g, %g), orientation (%g, %g, %g, %g); numbers "
        "must be finite and a quaternion of length 1",
        p->x, p->y, p->z, q->x, q->y, q->z, q->w);
}

asdic_status asdic_ros_decode_pose(asdic_context *ctx, bool is_odometry, const void *bytes,
                                   size_t size, asdic_ros_stamped *out) {
    asdic_ros_odometry odometry;
    asdic_ros_pose_stamped stamped;
    if (!bytes || !out) {
        return asdic_fail_null(ctx, __func__);
    }
    bool good = is_odometry ? asdic_ros_read(&asdic_ros_odometry_type, bytes, size, &odometry)
                            : asdic_ros_read(&asdic_ros_pose_stamped_type, bytes, size, &stamped);
    if (!good) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%zu bytes are no %s", size,
                          is_odometry ? "nav_msgs/msg/Odometry" : "geometry_msgs/msg/PoseStamped");
    }
    const asdic_ros_pose *pose = is_odometry ? &odometry.pose.pose : &stamped.pose;
    const asdic_ros_header *header = is_odometry ? &odometry.header : &stamped.header;
    const asdic_ros_point *p = &pose->position;
    const asdic_ros_quaternion *q = &pose->orientation;
    double length = sqrt(q->x * q->x + q->y * q->y + q->z * q->z + q->w * q->w);
    if (!isfinite(p->x) || !isfinite(p->y) || !isfinite(p->z) || !(fabs(length - 1.0) < 0.01)) {
        return no_place(ctx, pose);
    }
    out->time_ns = (int64_t)header->stamp.sec * SECOND_NS + header->stamp.nanosec;
    out->frame = header->frame_id;
    out->pose.position_m = (asdic_vec3){p->y, p->x, -p->z};
    attitude_of(q, &out->pose);
    return ASDIC_OK;
}
