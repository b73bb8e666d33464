/*
 * Rays through a committed scene, without a sonar: the nearest triangle along each, cast on a
 * device as pings cast theirs. For visibility questions, tests and `asdic bench rays`.
 *
 * Rays and hits are in the scene's frame: world axes, relative to asdic_scene_info.origin_m. The
 * hit of a ray depends on the ray and the triangles alone, bit for bit, never on kernel, device
 * threads or the order of rays; neighbours in the array should be neighbours in direction, for
 * speed.
 */
#ifndef ASDIC_RAYS_H
#define ASDIC_RAYS_H

#include <asdic/device.h>
#include <asdic/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_ray {
    float origin_m[3];
    float longest_m;    /* nothing beyond counts; 0 or less: no ray. INFINITY is allowed */
    float direction[3]; /* of unit length */
    float unused;
} asdic_ray;

#define ASDIC_NO_TRIANGLE 0xffffffffu

typedef struct asdic_ray_hit {
    float range_m;     /* INFINITY: nothing was met */
    uint32_t triangle; /* in the order in which meshes were added; ASDIC_NO_TRIANGLE: none */
} asdic_ray_hit;

typedef struct asdic_caster asdic_caster;

/* Uploads SCENE's triangles; SCENE and DEVICE must outlive the caster. KERNEL names a form of the
 * ray kernel, see asdic_ray_kernel_name; NULL or "auto" measures on the first rays and keeps the
 * fastest. */
ASDIC_API asdic_status asdic_caster_create(asdic_context *ctx, asdic_device *device,
                                           const asdic_scene *scene, const char *kernel,
                                           asdic_caster **out);
ASDIC_API void asdic_caster_destroy(asdic_caster **caster);

/* From now on rays bend as in water with SPEED_MPS (1000..2000) at the depth of the scene frame's
 * zero, and GRADIENT_PER_S (-30..30) more per metre of depth; 0: straight again. The range of a hit
 * is then the travel time to it times the sound speed where the ray starts. Rays that were loaded
 * before are forgotten. */
ASDIC_API asdic_status asdic_caster_bend(asdic_caster *caster, double speed_mps,
                                         double gradient_per_s);

/* Brings COUNT rays (1..2^28) to the device, in place of those before. */
ASDIC_API asdic_status asdic_caster_load(asdic_caster *caster, const asdic_ray *rays, size_t count);
/* Casts them; returns when the device has finished. */
ASDIC_API asdic_status asdic_caster_cast(asdic_caster *caster);
/* Their hits, as many as there are rays. ASDIC_ERROR_ARGUMENT: they were not cast. */
ASDIC_API asdic_status asdic_caster_read(asdic_caster *caster, asdic_ray_hit *hits);

/* The form that casts the loaded rays; "auto" before the first cast. Never NULL. */
ASDIC_API const char *asdic_caster_kernel(const asdic_caster *caster);

/* Forms of the ray kernel one after the other: "wide8", "pkt16", "frustum64", "scalar"; NULL at the
 * end. All give the same hits. */
ASDIC_API const char *asdic_ray_kernel_name(size_t index);

/* Corners of a committed scene's triangle as the device has them, scene frame: 3 x 3
 * coordinates. */
ASDIC_API asdic_status asdic_scene_triangle(const asdic_scene *scene, size_t index,
                                            float corners_m[9]);

#ifdef __cplusplus
}
#endif

#endif
