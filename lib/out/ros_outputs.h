/*
 * What a file of the messages that asdic/ros.h makes must know: their types, and how long they are.
 */
#ifndef ASDIC_OUT_ROS_OUTPUTS_H
#define ASDIC_OUT_ROS_OUTPUTS_H

#include "ros_cdr.h"

#include <asdic/ros.h>

const asdic_ros_type *asdic_ros_type_of(asdic_ros_output output);

/* Of all messages of a ping but detections, beside the levels and ranges themselves; about. */
size_t asdic_ros_ping_bytes(const asdic_sonar *sonar, const asdic_sweep *sweep);

#endif
