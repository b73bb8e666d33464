/*
 * What the host tells the device about one ping. Shared by both sides, bit for bit.
 */
#ifndef ASDIC_KERNEL_PING_TYPES_H
#define ASDIC_KERNEL_PING_TYPES_H

#include "types.h"

#define DEV_SAMPLER_UNIFORM_SPHERE 0
#define DEV_SAMPLER_BEAM 1
#define DEV_SAMPLER_ADAPTIVE 2

/* A mirror that reflects less than this share (-60 dB) is not followed. */
#define DEV_MIN_MIRROR 1e-6f

/* fan.cl computes this many receivers together. */
#define DEV_FAN_TILE 128
/* Floats of one of its rows of BINS: whole lines of a cache, an odd number of them, so that rows do not share
 * their place in it. */
#define DEV_FAN_ROW(bins) ((((bins) + 15u) / 16u | 1u) * 16u)

/* A footprint in range spans at least this many rays, next to each other in elevation. */
#define DEV_FOOTPRINT_RAYS 4.0f

#define DEV_MAX_LOBES 12
/* A lobe's scale far beyond any window: evenly spread. */
#define DEV_EVEN_SCALE 1e4f
#define DEV_MAX_CONES 8    /* at objects, as many at their images, and at glints */
#define DEV_MAX_BUNDLES 32 /* cones at objects through layers */
#define DEV_CONES (DEV_MAX_BUNDLES + DEV_MAX_CONES)
/* Of the learnt table, see learnt.h; powers of two. */
#define DEV_TABLE_CELLS 512
#define DEV_TABLE_ROWS 32
#define DEV_AZIMUTH_CELLS 32
#define DEV_TABLE_FLOATS (DEV_TABLE_CELLS + 1 + DEV_TABLE_ROWS * (DEV_AZIMUTH_CELLS + 1))
#define DEV_MAX_GROUPS 16

/* Deposit components, in the order of the accumulator; a scene has the first 3, those and objects, or
 * all, and pays for no others. */
#define DEV_DEPOSIT_BOTTOM 0
#define DEV_DEPOSIT_SURFACE 1
#define DEV_DEPOSIT_VOLUME 2
#define DEV_DEPOSIT_OBJECT 3
#define DEV_DEPOSIT_MULTIPATH 4
#define DEV_DEPOSIT_COUNT 5

/* An aperture: rows turn a world direction into its face frame (x away from the face, y along the
 * horizontal side, z along the vertical side); sides in wavelengths. */
typedef struct dev_beam {
    float rows[9];
    float length_h_wl, length_v_wl;
    float pad;
} dev_beam;

/* Where a sampler looks. Sampler "beam": directions around the axis of `aim`, heavy-tailed in
 * vertical direction cosine (scale_v) and azimuth (scale_h / cos). Sampler "adaptive": azimuths
 * around the ridge cos(phi - beta) = -tilt uz / cos, on one side of beta; or over a sector between two
 * ridges, of its beams with the least and the most azimuth. */
typedef struct dev_lobe {
    float rows[9]; /* as dev_beam, of the aperture that it is for */
    float scale_h, scale_v;
    float share;       /* of the rays; shares sum to 1 */
    float share_begin; /* sum of the shares before */
    float beta_rad, tilt,
        side;         /* adaptive: ridge; of a sector its middle's, and the least's tilt */
    float limit_rad;  /* half-width of the azimuth window; < 0: the front of the transmitter */
    float margin_rad; /* > 0: a sector; added to the window, more where elevations are steep */
    float most_tilt;  /* of a sector */
    float along[3];   /* adaptive: the side that the ridge runs along, pi times its wavelengths */
    dev_uint aside;   /* 1: a ridge far in azimuth from the transmitter's axis */
} dev_lobe;

/* Directions towards the bounding sphere of an object or its image, or round a glint, which get COUNT rays of their own,
 * from ray FIRST on; adaptive sampler only. */
typedef struct dev_cone {
    float rows[9]; /* world to cone: the third row points at the centre */
    float chord
        [2]; /* of the half-angles along the first row and the second, in a sphere of radius 1 */
    float splat; /* as ray_sample */
    dev_uint first, count;
} dev_cone;

/* A part to which several rays come, and how much louder what it sends comes home by all of them than by a straight one. */
typedef struct dev_pair {
    dev_uint part;
    float home_lin;
} dev_pair;

/* A triangle that rays are aimed at: its id, and the share of such rays up to it. */
typedef struct dev_face {
    float cumulative;
    dev_uint triangle;
} dev_face;

/* What one ray's direction sends to every receiver: up to four deposits, quanta for a row (component, bin) of
 * the accumulator each, before a receiver's gain. */
typedef struct dev_arrival {
    float direction[3];
    dev_uint
        more; /* of a direct arrival: odd where mirrors add two of their own; else see truth.h */
    dev_uint row[4];
    float quanta[4];
} dev_arrival; /* 48 bytes */

/* A layer of the water, in the scene frame: its planes, the bend as dev_ping has it, and how far the lifted
 * triangles of this layer are moved down, away from those of others. */
typedef struct dev_layer {
    float top_m, bottom_m;
    float bend_per_m;
    float shift_m;
    dev_uint has_triangles; /* 0: surely none */
} dev_layer;                /* 20 bytes */

/* Floats of a ray's last leg through layers so far; echo.h says which. */
#define DEV_LEG_FLOATS 17u

/* A pilot ray: its position in the learnt table, and the bins of its echoes: direct, which is the last bin that it
 * crosses, and by way of a mirror across and along (multipath.cl). */
#define DEV_PILOT_ECHOES 3
typedef struct dev_pilot {
    float x, y;
    dev_uint bins[DEV_PILOT_ECHOES];
} dev_pilot; /* 20 bytes */
/* In a receiver: the energies of the echoes, then of the water. */
#define DEV_PILOT_WATER DEV_PILOT_ECHOES
#define DEV_PILOT_ENERGIES (DEV_PILOT_ECHOES + 1)

/* Sets of arrivals, each with one per ray, group by group. */
#define DEV_ARRIVAL_DIRECT 0 /* echo and water */
#define DEV_ARRIVAL_ALONG 1  /* from mirrors, in the ray's own direction */
#define DEV_ARRIVAL_ACROSS 2 /* from mirrors, straight from what they showed */
#define DEV_ARRIVAL_WATER(mirrors) ((mirrors) ? 3u : 1u) /* the first of those of volume.cl */
#define DEV_WATER_SETS 6u
#define DEV_WATER_SHIFT 16u /* in `more` of the first: how many sets there are */
#define DEV_ARRIVAL_SETS(mirrors, layers)                                                          \
    (DEV_ARRIVAL_WATER(mirrors) + ((layers) ? DEV_WATER_SETS : 0u))

/* A ping's rays, and those of them that are in the current batch. Each group (replicate) has its share;
 * order.h says how they lie in memory. */
typedef struct dev_batch {
    dev_uint rays, groups;               /* of the ping */
    dev_uint first;                      /* of each group's rays in this batch */
    dev_uint per_group;                  /* slots of each group in this batch */
    dev_uint last;                       /* 1: no batch follows */
    dev_uint order_block, order_inverse; /* order.h: F, I */
    dev_uint order_lanes[16];            /* k I modulo F */
} dev_batch;

/* Elevation zones of the adaptive sampler. */
typedef struct dev_zones {
    float bottom_m, surface_m; /* h', hs: distances of the planes that rays are spread over */
    float bottom_far_m, surface_far_m;           /* up to these ranges */
    float bottom_bend_per_m, surface_bend_per_m; /* of rays to them, > 0: away from the plane */
    float cap_rad;  /* polar angle of the caps round nadir and zenith */
    float share[5]; /* nadir cap, bottom, gap, surface, zenith cap; sum 1 */
} dev_zones;

/* How directions are drawn. */
typedef struct dev_sampling {
    dev_uint sampler;    /* DEV_SAMPLER_... */
    dev_uint background; /* rays that neither cones nor faces have, the first ones */
    dev_uint cones;      /* number of cones */
    dev_uint face_first, face_count, faces; /* rays aimed at faces; number of faces */
    dev_uint azimuths_learnt;               /* 0: all rows of the learnt table are even */
    dev_uint lattice_shift;                 /* c1 */
    dev_uint stream;                        /* of random numbers, where there is no lattice */
    float lattice_offset;                   /* c0 */
    float footprint_rays; /* rays, next to each other in elevation, that a level footprint spans */
    float front[3];       /* transmitter axis, world */
    float front_azimuth_rad;
    float sender_y[3], sender_z[3]; /* its sides, pi times their wavelengths */
    dev_zones zones;
    dev_uint lobes;
    dev_lobe lobe[DEV_MAX_LOBES];
    dev_cone cone[DEV_CONES];
} dev_sampling;

/* The accumulator and what becomes of it, see deposit.h and reduce.cl. */
typedef struct dev_sums {
    dev_uint components;     /* DEV_DEPOSIT_COUNT at most */
    dev_uint present;        /* a bit for each component that something can be added to */
    dev_uint columns;        /* receivers, rounded up */
    dev_uint component_rows; /* bins, rounded up: from one component to the next */
    dev_uint group_cells;    /* of a block */
    dev_uint blocks;
    dev_uint total_cells;                 /* of the groups' totals, from one group to the next */
    dev_uint result_words;                /* 64-bit words of a ping's results */
    float scale[DEV_DEPOSIT_COUNT];       /* quanta per energy, powers of two */
    float limit;                          /* largest single deposit, in quanta */
    dev_uint truth_rows;                  /* of truth.h; 0: nobody asks for them */
    dev_uint truth_columns;               /* receivers, rounded up to whole vectors */
    dev_uint truth_cells;                 /* a receiver's, of all rows of this ping */
    dev_uint truth_first;                 /* those of the pings before it */
    float truth_ratio[DEV_DEPOSIT_COUNT]; /* scale of the row of depressions over a component's */
} dev_sums;

/* A row of truth.h: bins from LOW to HIGH - 1; CELL is where the first of them is, in a receiver's cells. */
typedef struct dev_truth_row {
    dev_uint low, high, cell, pad;
} dev_truth_row;

/* The rows before the objects' own. */
#define DEV_TRUTH_DEPRESSION 0
#define DEV_TRUTH_BY_SURFACE 1
#define DEV_TRUTH_BY_BOTTOM 2
#define DEV_TRUTH_OBJECTS 3
#define DEV_TRUTH_ROW_BITS 11 /* that an arrival has to name its row */
#define DEV_TRUTH_MOST_ROWS (1 << DEV_TRUTH_ROW_BITS)

/* In the buffer that kernels get, the apertures follow: the transmitter, then the receivers. One transfer
 * carries them all, and those of all pings that go together (ping_batch.h). */
typedef struct dev_ping {
    float origin[3];           /* of the sonar in the scene frame */
    float bend_per_m;          /* of the water, over the sound speed at the scene frame's zero */
    float shift_m;             /* the farthest that a dev_layer's triangles are moved; else 0 */
    float surface_m;           /* sonar below the surface; INFINITY: no surface */
    float bottom_m;            /* sonar above the bottom plane; INFINITY: no bottom plane */
    float blanking_m, range_m; /* received from, to */
    float reach_m;             /* rays end: a footprint's half beyond the range */
    float bin_m;
    float absorption_np_per_m; /* one-way intensity decay: alpha ln 10 / 1e4 */
    float rear_lin;            /* one-way gain behind a face */
    dev_uint boundary_mirrors; /* 1: bottom and surface reflect, too */
    float wavelength_m;
    dev_uint bottom_material, surface_material;
    dev_uint beams, bins;
    dev_uint stride;        /* bytes from this ping to the next that goes with it */
    dev_uint states_errors; /* 0: nobody asks for the groups' spread */
    dev_uint seed[2], ping[2];
    dev_uint pair_count;
    dev_pair pair[DEV_MAX_CONES];
    float fan_rows[9]; /* world to fan: z is the faces' common axis; see receive.h */
    dev_batch batch;
    dev_sampling sampling;
    dev_sums sums;
} dev_ping;

#endif
