/*
 * In which order a ping's rays lie in memory: kernels/order.h says why.
 */
#ifndef ASDIC_SIM_RAY_ORDER_H
#define ASDIC_SIM_RAY_ORDER_H

#include "../../kernels/ping_types.h"

/* Fills order_block, order_inverse and order_lanes for PING's groups and per_group. */
void asdic_ray_order(dev_ping *ping);

#endif
