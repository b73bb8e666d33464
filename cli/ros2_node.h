/*
 * A node of ROS 2 by Cyclone DDS: topics of the names and types that ROS 2 gives them on the wire.
 */
#ifndef ASDIC_CLI_ROS2_NODE_H
#define ASDIC_CLI_ROS2_NODE_H

#include "serve.h"

typedef struct ros2_node ros2_node;

/* Joins the domain of the environment's ROS_DOMAIN_ID. False when that is not possible, which is told. */
bool ros2_node_open(cli *c, const serve_ros2_options *options, const asdic_ros *ros,
                    ros2_node **out);
void ros2_node_close(ros2_node **node);

/* Waits up to MS for a pose, or whatever else comes. */
void ros2_node_wait(ros2_node *node, unsigned ms);

/* The newest pose that came and was not taken; how many older ones are passed over with it is added
 * to *PASSED. False when there is none, or none that can be read, which is told. */
bool ros2_node_take_pose(ros2_node *node, asdic_ros_stamped *out, uint64_t *passed);

/* The last time of /clock; false before the first. */
bool ros2_node_clock(ros2_node *node, int64_t *time_ns);

/* Whether anybody subscribes to OUTPUT: what nobody takes need not be made. */
bool ros2_node_is_heard(const ros2_node *node, asdic_ros_output output);

/* Sends a message; false when the DDS refuses, which is told. */
bool ros2_node_publish(ros2_node *node, asdic_ros_output output, const void *bytes, size_t size);

/* Tells, each thing once, why no poses come or nobody gets pings: nobody publishes, another type, a
 * quality of service that does not go together. Cheap; call it often. */
void ros2_node_look_around(ros2_node *node);

#endif
