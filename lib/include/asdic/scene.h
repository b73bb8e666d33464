/*
 * A scene: the sea surface, a bottom (plane or mesh) and objects, each with a material. Build it,
 * commit it once, then simulate in it; a committed scene is read-only and may be shared by
 * simulators in several threads.
 */
#ifndef ASDIC_SCENE_H
#define ASDIC_SCENE_H

#include <asdic/law.h>
#include <asdic/mesh.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_scene asdic_scene;

/* Nothing but the sea surface is in a new scene. */
ASDIC_API asdic_status asdic_scene_create(asdic_context *ctx, asdic_scene **out);
ASDIC_API void asdic_scene_destroy(asdic_scene **scene);

/* The plane z = 0; on in a new scene, with the law of the course. Surface and bottom plane:
 * ASDIC_ERROR_ARGUMENT: the scene is committed, MATERIAL's law is not made for it (a bottom may be
 * of what objects are) or a field of it out of range. */
ASDIC_API asdic_status asdic_scene_set_surface(asdic_scene *scene, bool enabled);
ASDIC_API asdic_status asdic_scene_set_surface_law(asdic_scene *scene, asdic_material material);
ASDIC_API asdic_status asdic_scene_set_bottom_plane(asdic_scene *scene, double depth_m,
                                                    asdic_material material);

/* Adds a mesh as (part of) the bottom or as an object, placed by POSE (mesh frame to world). The
 * mesh is copied. NAME identifies an object in detections; the bottom has none.
 * ASDIC_ERROR_ARGUMENT: the scene is committed, MATERIAL's law is not made for it, a field of
 * MATERIAL is out of range, POSE is not finite. */
ASDIC_API asdic_status asdic_scene_add_bottom(asdic_scene *scene, const asdic_mesh *mesh,
                                              asdic_pose pose, asdic_material material);
ASDIC_API asdic_status asdic_scene_add_object(asdic_scene *scene, const char *name,
                                              const asdic_mesh *mesh, asdic_pose pose,
                                              asdic_material material);

/* The same for an object that asdic_simulator_move (asdic/ping.h) may place anew between pings;
 * POSE is where it is until then. It has a hierarchy of its own: moving it costs time in proportion
 * to its triangles, not to the scene's. */
ASDIC_API asdic_status asdic_scene_add_moving_object(asdic_scene *scene, const char *name,
                                                     const asdic_mesh *mesh, asdic_pose pose,
                                                     asdic_material material);

/* The angle between facets, 0 to pi / 2, from which on objects that are added hereafter have an
 * edge there; below it, facets stand for one curved surface where they go on turning. 35 degrees
 * in a new scene; 0: every facet is flat. */
ASDIC_API asdic_status asdic_scene_set_crease(asdic_scene *scene, double crease_rad);

/* Adds a point with a target strength of its own (dB re 1 m2, -200..100) for what a shape cannot
 * give: calibration spheres, whose resonances are elastic; fish; buoys known by measurement. It
 * sends nothing on to other things and hides nothing; bottom, surface and objects hide it. Any
 * point may be moved between pings. */
ASDIC_API asdic_status asdic_scene_add_point(asdic_scene *scene, const char *name,
                                             asdic_vec3 position_m, double target_strength_db);

/* How many threads commit may use; 0, as in a new scene: one per processor. Never changes the
 * result. */
ASDIC_API void asdic_scene_set_threads(asdic_scene *scene, unsigned threads);

/* Builds the bounding volume hierarchy. Nothing may be added afterwards. */
ASDIC_API asdic_status asdic_scene_commit(asdic_scene *scene);

/* Height of POSITION above the bottom straight below it, m; INFINITY where there is none. */
ASDIC_API double asdic_scene_altitude_m(const asdic_scene *scene, asdic_vec3 position_m);

typedef struct asdic_scene_info {
    bool has_surface, has_bottom_plane;
    double bottom_plane_depth_m;
    size_t triangles, bvh_nodes;
    size_t objects; /* points included */
    uint64_t bvh_bytes;
    double build_s;          /* of the commit */
    double hierarchy_s;      /* of its part that built the hierarchy */
    asdic_vec3 origin_m;     /* where the scene frame has its origin */
    asdic_vec3 min_m, max_m; /* of the triangles; zeros when there are none */
} asdic_scene_info;

/* Triangles, nodes, sizes and times once the scene is committed. */
ASDIC_API asdic_scene_info asdic_scene_get_info(const asdic_scene *scene);

#ifdef __cplusplus
}
#endif

#endif
