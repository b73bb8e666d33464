/* Built without Cyclone DDS. */
#include "serve.h"

int serve_ros2(cli *c, const serve_ros2_options *options, const asdic_ros_about *about,
               const serve_pinger *pinger) {
    (void)options;
    (void)about;
    (void)pinger;
    cli_error(c, "this asdic was built without Cyclone DDS, hence without topics of ROS 2 "
                 "(cyclonedds-dev and cyclonedds-tools, then meson configure -Dros2=enabled)");
    return CLI_FAILED;
}
