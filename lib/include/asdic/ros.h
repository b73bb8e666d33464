/*
 * Pings as messages of ROS 2, in CDR: the bytes that a DDS sends and that an MCAP file holds.
 * Neither ROS nor a DDS is needed to make them.
 *
 * Frames are ROS's (REP 103): the world has x east, y north, z up from the sea surface, the vehicle
 * x forward, y to port, z up; poses are turned from and to asdic's north-east-down here, and
 * nowhere else. The sonar's frame is that of marine_acoustic_msgs: z ahead and y to port, therefore
 * x down; it turns with a scanned head.
 */
#ifndef ASDIC_ROS_H
#define ASDIC_ROS_H

#include <asdic/sonar.h>
#include <asdic/sweep.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a ping is told by. */
typedef enum asdic_ros_output {
    ASDIC_ROS_TRANSFORMS, /* tf2_msgs/TFMessage: world to vehicle to sonar */
    ASDIC_ROS_POSE,       /* geometry_msgs/PoseStamped of the vehicle in the world */
    ASDIC_ROS_SONAR,      /* marine_acoustic_msgs/ProjectedSonarImage: float32 dB re 1 uPa */
    ASDIC_ROS_PICTURE,    /* sensor_msgs/Image: the fan in colour, rgb8 */
    ASDIC_ROS_DETECTIONS, /* marine_acoustic_msgs/SonarDetections */
    ASDIC_ROS_HEAD,       /* tf2_msgs/TFMessage of a scan: vehicle to sonar alone */
    ASDIC_ROS_OUTPUT_COUNT
} asdic_ros_output;

typedef struct asdic_ros asdic_ros;

typedef struct asdic_ros_about {
    const asdic_sonar *sonar; /* copied */
    asdic_sweep sweep;
    double sound_speed_mps;
    size_t bins;
    const char *world_frame, *vehicle_frame, *sonar_frame; /* must outlive the encoder */
} asdic_ros_about;

/* map, base_link, sonar; the rest zero. */
ASDIC_API asdic_ros_about asdic_ros_about_default(void);

typedef struct asdic_ros_ping {
    int64_t time_ns; /* since the beginning of ROS's time */
    uint64_t ping;
    asdic_pose vehicle;    /* NED */
    const float *level_db; /* [beam * bins + bin], NAN without energy */
    const bool *detected;  /* the same; for ASDIC_ROS_DETECTIONS alone */
} asdic_ros_ping;

ASDIC_API asdic_status asdic_ros_create(asdic_context *ctx, const asdic_ros_about *about,
                                        asdic_ros **out);
ASDIC_API void asdic_ros_destroy(asdic_ros **ros);

/* Of an output: its type, as "sensor_msgs/msg/Image", and whether there is one: a picture needs
 * three beams or more in the order of their bearings, none straight up or down, or a scan; a head
 * needs a scan. */
ASDIC_API const char *asdic_ros_type_name(asdic_ros_output output);
ASDIC_API bool asdic_ros_has(const asdic_ros *ros, asdic_ros_output output);

/* PING as OUTPUT. The bytes belong to ROS until the next call. Pings are given in their order: the
 * picture's window of levels is that of the first, from the 5th to the 99.5th percentile rounded
 * outwards to 10 dB, and a scan's picture grows with every one, whatever its output. */
ASDIC_API asdic_status asdic_ros_encode(asdic_ros *ros, asdic_ros_output output,
                                        const asdic_ros_ping *ping, const void **bytes,
                                        size_t *size);

/* A pose that came in. */
typedef struct asdic_ros_stamped {
    int64_t time_ns;
    const char *frame; /* points into the bytes */
    asdic_pose pose;   /* NED, of the vehicle */
} asdic_ros_stamped;

/* Reads a geometry_msgs/PoseStamped or, with IS_ODOMETRY, a nav_msgs/Odometry. ASDIC_ERROR_INPUT
 * when SIZE BYTES are none, or it holds what is no place: numbers that are not finite, an
 * orientation that is no rotation. */
ASDIC_API asdic_status asdic_ros_decode_pose(asdic_context *ctx, bool is_odometry,
                                             const void *bytes, size_t size,
                                             asdic_ros_stamped *out);

#ifdef __cplusplus
}
#endif

#endif
