/* Intel Embree 3 on the same rays, for comparison only: the library never sees it. */
#include "beside.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#define MOST_THREADS 64

struct bench_embree {
    RTCDevice device;
    RTCScene scene;
    unsigned threads;
};

const char *bench_embree_version(void) {
    return RTC_VERSION_STRING;
}

/* Every triangle with corners of its own, as this program's blocks have them. */
static bool fill_geometry(RTCGeometry geometry, const float *corners_m, size_t triangles) {
    float *vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                              RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles);
    unsigned *indices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
                                                RTC_FORMAT_UINT3, 3 * sizeof(unsigned), triangles);
    if (!vertices || !indices) {
        return false;
    }
    memcpy(vertices, corners_m, 9 * triangles * sizeof *vertices);
    for (size_t i = 0; i < 3 * triangles; i++) {
        indices[i] = (unsigned)i;
    }
    rtcCommitGeometry(geometry);
    return true;
}

bench_embree *bench_embree_create(const float *corners_m, size_t triangles, unsigned threads,
                                  bool robust, double *build_s) {
    char options[64];
    bench_embree *e = calloc(1, sizeof *e);
    if (!e) {
        return NULL;
    }
    snprintf(options, sizeof options, "threads=%u,set_affinity=0", threads);
    e->threads = threads < MOST_THREADS ? threads : MOST_THREADS;
    e->device = rtcNewDevice(options);
    e->scene = e->device ? rtcNewScene(e->device) : NULL;
    RTCGeometry geometry = e->scene ? rtcNewGeometry(e->device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
    if (!geometry || !fill_geometry(geometry, corners_m, triangles)) {
        bench_embree_destroy(e);
        return NULL;
    }
    rtcSetSceneBuildQuality(e->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSceneFlags(e->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    rtcAttachGeometry(e->scene, geometry);
    rtcReleaseGeometry(geometry);
    double began = cli_clock_s();
    rtcCommitScene(e->scene);
    *build_s = cli_clock_s() - began;
    return e;
}

void bench_embree_destroy(bench_embree *e) {
    if (e && e->scene) {
        rtcReleaseScene(e->scene);
    }
    if (e && e->device) {
        rtcReleaseDevice(e->device);
    }
    free(e);
}

typedef struct job {
    const bench_embree *e;
    bench_embree_mode mode;
    const asdic_ray *rays;
    size_t count;
    asdic_ray_hit *hits;
} job;

static void cast_single(const job *j, struct RTCIntersectContext *context) {
    for (size_t i = 0; i < j->count; i++) {
        const asdic_ray *ray = &j->rays[i];
        struct RTCRayHit h = {.ray = {.org_x = ray->origin_m[0],
                                      .org_y = ray->origin_m[1],
                                      .org_z = ray->origin_m[2],
                                      .dir_x = ray->direction[0],
                                      .dir_y = ray->direction[1],
                                      .dir_z = ray->direction[2],
                                      .tfar = ray->longest_m,
                                      .mask = ~0u},
                              .hit = {.geomID = RTC_INVALID_GEOMETRY_ID}};
        rtcIntersect1(j->e->scene, context, &h);
        bool met = h.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        j->hits[i].range_m = met ? h.ray.tfar : INFINITY;
        j->hits[i].triangle = met ? h.hit.primID : ASDIC_NO_TRIANGLE;
    }
}

/* Sixteen rays from FIRST on; the last packet repeats the last ray in lanes that do not count. */
static void fill_packet(const job *j, size_t first, struct RTCRayHit16 *h, int valid[16]) {
    for (size_t lane = 0; lane < 16; lane++) {
        bool live = first + lane < j->count;
        const asdic_ray *ray = &j->rays[live ? first + lane : j->count - 1];
        valid[lane] = live ? -1 : 0;
        h->ray.org_x[lane] = ray->origin_m[0];
        h->ray.org_y[lane] = ray->origin_m[1];
        h->ray.org_z[lane] = ray->origin_m[2];
        h->ray.dir_x[lane] = ray->direction[0];
        h->ray.dir_y[lane] = ray->direction[1];
        h->ray.dir_z[lane] = ray->direction[2];
        h->ray.tnear[lane] = 0.0f;
        h->ray.tfar[lane] = ray->longest_m;
        h->ray.time[lane] = 0.0f;
        h->ray.mask[lane] = ~0u;
        h->ray.flags[lane] = 0;
        h->hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
}

static void cast_packets(const job *j, struct RTCIntersectContext *context) {
    for (size_t first = 0; first < j->count; first += 16) {
        struct RTCRayHit16 h;
        _Alignas(64) int valid[16];
        fill_packet(j, first, &h, valid);
        rtcIntersect16(valid, j->e->scene, context, &h);
        for (size_t lane = 0; lane < 16 && first + lane < j->count; lane++) {
            bool met = h.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
            j->hits[first + lane].range_m = met ? h.ray.tfar[lane] : INFINITY;
            j->hits[first + lane].triangle = met ? h.hit.primID[lane] : ASDIC_NO_TRIANGLE;
        }
    }
}

static void *work(void *user) {
    const job *j = user;
    struct RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    if (j->mode == BENCH_EMBREE_COHERENT) {
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
    if (j->mode == BENCH_EMBREE_SINGLE) {
        cast_single(j, &context);
    } else {
        cast_packets(j, &context);
    }
    return NULL;
}

void bench_embree_cast(const bench_embree *e, bench_embree_mode mode, const asdic_ray *rays,
                       size_t count, asdic_ray_hit *hits) {
    pthread_t threads[MOST_THREADS];
    job jobs[MOST_THREADS];
    bool started[MOST_THREADS] = {false};
    /* Whole packets for every thread. */
    size_t share = (count / e->threads + 15) / 16 * 16;
    for (unsigned i = 0; i < e->threads; i++) {
        size_t first = i * share < count ? i * share : count;
        size_t end = i + 1 < e->threads && first + share < count ? first + share : count;
        jobs[i] = (job){e, mode, rays + first, end - first, hits + first};
        started[i] = i > 0 && pthread_create(&threads[i], NULL, work, &jobs[i]) == 0;
    }
    for (unsigned i = 0; i < e->threads; i++) {
        if (!started[i]) {
            work(&jobs[i]);
        }
    }
    for (unsigned i = 0; i < e->threads; i++) {
        if (started[i]) {
            pthread_join(threads[i], NULL);
        }
    }
}
