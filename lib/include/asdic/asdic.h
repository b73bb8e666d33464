/*
 * asdic: calibrated forward-looking sonar, simulated on any OpenCL device.
 *
 * In one breath: create a context, open a device, load a mission (or build scene, environment and
 * sonar by hand), create a simulator, ask it for pings.
 *
 *     asdic_context *ctx;   asdic_context_create(&ctx);
 *     asdic_device **dev;   size_t n;   asdic_devices_open(ctx, "auto", &dev, &n);
 *     asdic_mission *m;     asdic_mission_load(ctx, "scene.yaml", &m);
 *     asdic_mission_run(ctx, m, dev, n, &options);
 *
 * Every call that can fail returns an asdic_status and leaves one sentence in the context. The
 * library never prints, exits or aborts, and keeps no global state.
 */
#ifndef ASDIC_ASDIC_H
#define ASDIC_ASDIC_H

#include <asdic/common.h>
#include <asdic/context.h>
#include <asdic/detect.h>
#include <asdic/dataset.h>
#include <asdic/detections.h>
#include <asdic/device.h>
#include <asdic/environment.h>
#include <asdic/expected.h>
#include <asdic/law.h>
#include <asdic/lookout.h>
#include <asdic/loop.h>
#include <asdic/mesh.h>
#include <asdic/mission.h>
#include <asdic/model.h>
#include <asdic/output.h>
#include <asdic/ping.h>
#include <asdic/plan.h>
#include <asdic/rays.h>
#include <asdic/roc.h>
#include <asdic/ros.h>
#include <asdic/run.h>
#include <asdic/scan.h>
#include <asdic/scene.h>
#include <asdic/sonar.h>
#include <asdic/sweep.h>
#include <asdic/team.h>
#include <asdic/trial.h>
#include <asdic/truth.h>
#include <asdic/view.h>

#endif
