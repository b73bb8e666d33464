/* A program that was built without Embree. */
#include "beside.h"

const char *bench_embree_version(void) {
    return NULL;
}

bench_embree *bench_embree_create(const float *corners_m, size_t triangles, unsigned threads,
                                  bool robust, double *build_s) {
    (void)corners_m;
    (void)triangles;
    (void)threads;
    (void)robust;
    (void)build_s;
    return NULL;
}

void bench_embree_destroy(bench_embree *e) {
    (void)e;
}

void bench_embree_cast(const bench_embree *e, bench_embree_mode mode, const asdic_ray *rays,
                       size_t count, asdic_ray_hit *hits) {
    (void)e;
    (void)mode;
    (void)rays;
    (void)count;
    (void)hits;
}
