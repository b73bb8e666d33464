/*
 * ROS 2's messages in CDR, the bytes that DDS sends and MCAP files hold (OMG DDSI-RTPS 2.5, 10;
 * DDS-XTypes 1.3, 7.4.1: version 1, plain): four bytes that say so, then field after field, each
 * aligned to its size.
 */
#ifndef ASDIC_OUT_ROS_CDR_H
#define ASDIC_OUT_ROS_CDR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum asdic_ros_kind {
    ASDIC_ROS_BOOL,
    ASDIC_ROS_U8,
    ASDIC_ROS_I32,
    ASDIC_ROS_U32,
    ASDIC_ROS_F32,
    ASDIC_ROS_F64,
    ASDIC_ROS_STRING,
    ASDIC_ROS_MESSAGE
} asdic_ros_kind;

typedef enum asdic_ros_form {
    ASDIC_ROS_ONE,
    ASDIC_ROS_ARRAY,   /* of a fixed number of items, in the struct */
    ASDIC_ROS_SEQUENCE /* of any number, which the struct points to */
} asdic_ros_form;

typedef struct asdic_ros_field {
    size_t offset, count; /* in the struct; of an array */
    asdic_ros_kind kind;
    asdic_ros_form form;
    const struct asdic_ros_type *type; /* of a message */
} asdic_ros_field;

typedef struct asdic_ros_type {
    const char *name; /* "geometry_msgs/msg/Pose" */
    const asdic_ros_field *fields;
    size_t field_count, bytes; /* of the struct */
    const char *schema;        /* ros2msg, with all that it needs */
} asdic_ros_type;

/* Bytes that grow. Zeros are an empty one; when memory ends it has failed and takes nothing
 * more. */
typedef struct asdic_bytes {
    uint8_t *bytes;
    size_t size, capacity;
    bool failed;
} asdic_bytes;

void asdic_bytes_add(asdic_bytes *out, const void *bytes, size_t size);
void asdic_bytes_finish(asdic_bytes *bytes);

/* MESSAGE, a struct of TYPE, in place of what OUT held; little-endian. */
void asdic_ros_write(asdic_bytes *out, const asdic_ros_type *type, const void *message);

/* Fills MESSAGE, a struct of TYPE that has no sequences, from bytes of either order. Its strings
 * point into BYTES. False when they are no such message. */
bool asdic_ros_read(const asdic_ros_type *type, const void *bytes, size_t size, void *message);

#endif
