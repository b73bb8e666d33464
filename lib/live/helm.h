/*
 * Manual steering: speed, rudder and planes, with the manoeuvring models that fly waypoints.
 */
#ifndef ASDIC_LIVE_HELM_H
#define ASDIC_LIVE_HELM_H

#include "mission/track/flight_model.h"

#include <asdic/scene.h>

typedef struct asdic_helm {
    asdic_flight flight;
    flight_model model;
    flight_state state;
    double wanted_mps;     /* speed through the water */
    double rudder, planes; /* -1..1: to starboard, down */
    bool holds_depth;
    double hold_z_m;
} asdic_helm;

/* The vehicle that FLIGHT describes, at rest at the origin. */
void asdic_helm_init(asdic_helm *helm, const asdic_flight *flight);

/* Takes over at POSE and SPEED_MPS; the rudder is amidships and the depth held. */
void asdic_helm_take(asdic_helm *helm, const asdic_pose *pose, double speed_mps);

/* Within what the vehicle does. */
void asdic_helm_change_speed(asdic_helm *helm, double by_mps);
void asdic_helm_change_rudder(asdic_helm *helm, double by);
void asdic_helm_change_planes(asdic_helm *helm, double by); /* ends holding the depth */
void asdic_helm_toggle_hold(asdic_helm *helm);

double asdic_helm_speed_mps(const asdic_helm *helm);

/* Flies for STEP_S; stays below the surface and above the bottom of SCENE. */
asdic_pose asdic_helm_advance(asdic_helm *helm, const asdic_scene *scene, double step_s);

#endif
