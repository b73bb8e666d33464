/* Where faces of a body stay flat, and where the surface that they stand for goes on. */
#include "lathe.h"
#include "smooth_rig.h"

/* Strips of 1 m that turn by so much from one to the next, each in CUTS along its width. */
static asdic_scene *folded(const double *lengths_m, const double *turns_rad, int strips, int cuts) {
    enum { MOST = 16 };
    double v[6 * (MOST + 1)] = {0}, angle = 0.0;
    uint32_t f[6 * MOST];
    uint32_t count = (uint32_t)(strips * cuts);
    assert_true(count <= MOST);
    for (uint32_t i = 0; i < count; i++) {
        int strip = (int)i / cuts;
        angle += (int)i % cuts == 0 ? turns_rad[strip] : 0.0;
        v[6 * i + 4] = 1.0;
        for (int side = 0; side < 2; side++) {
            v[6 * i + 6 + 3 * side] = v[6 * i] + lengths_m[strip] / cuts * cos(angle);
            v[6 * i + 7 + 3 * side] = side;
            v[6 * i + 8 + 3 * side] = v[6 * i + 2] + lengths_m[strip] / cuts * sin(angle);
        }
        uint32_t corners[6] = {2 * i, 2 * i + 1, 2 * i + 3, 2 * i, 2 * i + 3, 2 * i + 2};
        memcpy(f + 6 * i, corners, sizeof corners);
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, 2 * (count + 1), f, 2 * count, &mesh));
    return steel_scene(mesh);
}

/* A face of 1 m stays flat, whether its edge is rounded by five strips of 2 cm, which do not, or
 * bevelled by one, and whatever it is cut into. */
static void an_edge_leaves_its_face_flat(void **state) {
    (void)state;
    static const double round_m[] = {1.0, 0.02, 0.02, 0.02, 0.02, 0.02};
    static const double round_rad[] = {0.0, 0.25, 0.25, 0.25, 0.25, 0.25};
    static const double bevel_m[] = {1.0, 0.02, 1.0}, bevel_rad[] = {0.0, 0.5, 0.5};
    for (int bevel = 0; bevel < 2; bevel++) {
        for (int cuts = 1; cuts < 3; cuts++) {
            int strips = bevel ? 3 : 6;
            asdic_scene *scene =
                folded(bevel ? bevel_m : round_m, bevel ? bevel_rad : round_rad, strips, cuts);
            for (int i = 0; i < 2 * cuts * strips; i++) {
                bool face = (bevel ? bevel_m : round_m)[i / 2 / cuts] == 1.0;
                bool flat = scene->triangles[i].corner_normals[0] == DEV_FLAT;
                assert_true(face ? flat : !flat || cuts > 1);
            }
            assert_close(scene->triangles[0].flat_m2, 1.0, 1e-4);
            asdic_scene_destroy(&scene);
        }
    }
}

/* Plates of one width, two or three: nothing goes on turning; five do. */
static void few_plates_stay_flat(void **state) {
    (void)state;
    static const double lengths_m[5] = {1.0, 1.0, 1.0, 1.0, 1.0};
    static const double turns_rad[] = {0.02, 0.1, 0.2, 0.5};
    for (int k = 0; k < 4; k++) {
        double turn = turns_rad[k], rad[5] = {0.0, turn, turn, turn, turn};
        for (int strips = 2; strips <= 5; strips += strips == 3 ? 2 : 1) {
            for (int cuts = 1; cuts <= 3; cuts++) {
                asdic_scene *scene = folded(lengths_m, rad, strips, cuts);
                for (int i = 0; i < 2 * cuts * strips; i++) {
                    bool flat = scene->triangles[i].corner_normals[0] == DEV_FLAT;
                    int quad = i / 2, at = quad % cuts;
                    bool bent = (at == 0 && quad > 0) || (at == cuts - 1 && quad < 5 * cuts - 1);
                    assert_int_equal(flat, strips < 5 || !bent);
                }
                asdic_scene_destroy(&scene);
            }
        }
    }
}

/* The lathe's body at CREASE_RAD. */
static asdic_scene *lathe(const ring *rings, uint32_t count, uint32_t sides, double crease_rad) {
    asdic_mesh *mesh = lathe_mesh(ctx, rings, count, sides);
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_ok(ctx, asdic_scene_set_crease(scene, crease_rad));
    assert_ok(ctx, asdic_scene_add_object(scene, "body", mesh, (asdic_pose){.position_m.z = 9.0},
                                          asdic_material_facet(45.0, 0.0, 0.0)));
    assert_ok(ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    return scene;
}

#define CREASE_RAD (35.0 * PI / 180.0)

/* How many facets of SCENE are flat; of the others, the most that a corner's normal leans along x off its facet's own. */
static size_t count_flat(const asdic_scene *scene, double *most) {
    size_t count = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        bool flat = t->corner_normals[0] == DEV_FLAT;
        count += flat;
        for (int k = 0; !flat && k < 3; k++) {
            *most = fmax(*most, fabs(smooth_unpack(t->corner_normals[k]).x - t->normal[0]));
        }
    }
    return count;
}

/* Boxes whose ends are chamfered by 30 degrees, narrow or wide, or taper off to the other end. */
static void a_chamfered_box_is_flat(void **state) {
    (void)state;
    static const double widths_m[] = {0.01, 0.04, 0.045, 0.06, 0.3};
    for (int k = 0; k < 5; k++) {
        double w = widths_m[k], cosine = cos(PI / 6.0), out = sqrt(2.0) * (0.1 + w * cosine),
               off = 0.0;
        const ring box[] = {{0.0, 0.1 * sqrt(2.0)}, {0.5 * w, out}, {0.3 + w, out}};
        asdic_scene *scene = lathe(box, 3, 4, CREASE_RAD);
        assert_int_equal(count_flat(scene, &off), scene->triangle_count);
        asdic_scene_destroy(&scene);
    }
}

/* Barrels that end in cones, gentle or not, and in a dome: round across, straight along. */
static void a_barrel_with_cones_is_straight(void **state) {
    (void)state;
    static const double angles_deg[] = {1.0, 5.0, 11.3, 25.0};
    for (int k = 0; k < 4; k++) {
        for (uint32_t sides = 12; sides <= 48; sides += 12) {
            double drop = 0.15 * tan(angles_deg[k] * PI / 180.0), cones = 0.0, domed = 0.0;
            const ring one[] = {{-0.5, 0.1}, {0.5, 0.1}, {0.65, 0.1 - drop}};
            const ring two[] = {
                {-0.65, 0.1 - drop}, {-0.5, 0.1}, {0.0, 0.1}, {0.5, 0.1}, {0.65, 0.1 - drop}};
            const ring neck[] = {{-0.5, 0.1}, {0.0, 0.1}, {0.15, 0.1 - drop}, {0.7, 0.1 - drop}};
            asdic_scene *scenes[] = {lathe(one, 3, sides, CREASE_RAD),
                                     lathe(two, 5, sides, CREASE_RAD),
                                     lathe(neck, 4, sides, CREASE_RAD)};
            for (int i = 0; i < 3; i++) {
                assert_int_equal(count_flat(scenes[i], &cones), 2 * sides);
                asdic_scene_destroy(&scenes[i]);
            }
            ring dome[10];
            for (int i = 0; i < 9; i++) {
                double angle = 0.5 * PI * (i + 0.1) / 8.1;
                dome[i] = (ring){-0.5 - 0.1 * cos(angle), 0.1 * sin(angle)};
            }
            dome[9] = (ring){0.5, 0.1};
            asdic_scene *scene = lathe(dome, 10, sides, CREASE_RAD);
            for (size_t i = 0; i < scene->triangle_count; i++) {
                const dev_triangle *t = &scene->triangles[i];
                for (int c = 0;
                     t->corner_normals[0] != DEV_FLAT && fabs(t->normal[0]) < 1e-6 && c < 3; c++) {
                    domed = fmax(domed, fabs(smooth_unpack(t->corner_normals[c]).x));
                }
            }
            asdic_scene_destroy(&scene);
            print_message("%g deg, %u sides: normals lean along by %.2g, beside a dome %.2g\n",
                          angles_deg[k], sides, cones, domed);
            assert_true(cones < 0.02 && domed < 1e-3);
        }
    }
}

/* How far the normals of a capsule of radius 0.2 m, whose dome's BANDS turn by 90 degrees together, are off the round ones,
 * of barrel and domes, rad. */
static void off_capsule(double length_m, uint32_t bands, double crease_rad, double off[2]) {
    enum { MOST = 26 };
    const double radius_m = 0.2;
    ring rings[MOST];
    assert_true(2 * (bands + 1) <= MOST);
    for (uint32_t i = 0; i <= bands; i++) {
        double polar = 0.5 * PI * i / bands, x = 0.5 * length_m + radius_m * cos(polar);
        rings[i] = (ring){-x, radius_m * sin(polar)};
        rings[2 * bands + 1 - i] = (ring){x, radius_m * sin(polar)};
    }
    asdic_scene *scene = lathe(rings, 2 * (bands + 1), 48, crease_rad);
    off[0] = off[1] = 0.0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        float p[3];
        point_at(t, 0.25, 0.25, p);
        double x = p[0] + scene->origin_m.x, end = copysign(0.5 * length_m, x);
        bool domed = fabs(x) > 0.5 * length_m;
        if (hypot(p[1] + scene->origin_m.y, p[2] + scene->origin_m.z - 9.0) > 1e-3 &&
            t->corner_normals[0] != DEV_FLAT) {
            asdic_vec3 round = {domed ? x - end : 0.0, p[1] + scene->origin_m.y,
                                p[2] + scene->origin_m.z - 9.0};
            off[domed] = fmax(off[domed], off_rad(t, p, round));
        }
    }
    asdic_scene_destroy(&scene);
}

/* A barrel is straight beside its domes, however short it is and however coarse they are, and they begin along it. */
static void a_short_capsule_is_straight_and_round(void **state) {
    (void)state;
    static const double lengths_m[] = {0.1, 0.15, 0.3, 0.5, 1.0};
    static const uint32_t bands[] = {2, 3, 4, 6, 12};
    for (int k = 0; k < 25; k++) {
        double off[2], length_m = lengths_m[k / 5];
        uint32_t count = bands[k % 5];
        off_capsule(length_m, count, count == 2 ? 50.0 * PI / 180.0 : CREASE_RAD, off);
        double step = 0.5 * PI / count;
        print_message("%g m, %u bands: barrel off by %.2g of a step, domes by %.2g\n", length_m,
                      count, off[0] / step, off[1] / step);
        assert_true(off[0] < 0.01 * step && off[1] < 0.1 * step);
    }
}

/* Hills are round, though pairs of their facets lie level by chance: what is beside a pair is no edge of it. */
static void pairs_on_hills_are_no_walls(void **state) {
    (void)state;
    enum { SIDE = 32, COUNT = SIDE * SIDE };
    const double step_m = 2.0 / (SIDE - 1);
    double v[3 * COUNT], sum = 0.0;
    uint32_t f[6 * COUNT], count = 0;
    for (uint32_t i = 0; i < COUNT; i++) {
        double x = step_m * (i / SIDE), y = step_m * (i % SIDE);
        const double at[] = {x, y, 0.03 * sin(3.0 * x) * sin(2.0 * y)};
        memcpy(v + 3 * (size_t)i, at, sizeof at);
        if (i / SIDE + 1 < SIDE && i % SIDE + 1 < SIDE) {
            const uint32_t two[] = {i, i + SIDE, i + SIDE + 1, i, i + SIDE + 1, i + 1};
            memcpy(f + 3 * (size_t)count, two, sizeof two);
            count += 2;
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx, asdic_mesh_from_triangles(ctx, v, COUNT, f, count, &mesh));
    asdic_scene *scene = scene_of(mesh, (asdic_pose){0}, asdic_material_facet(45.0, 0.0, 0.0));
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        for (int k = 0; t->corner_normals[0] != DEV_FLAT && k < 3; k++) {
            float p[3];
            point_at(t, k == 1 ? 0.9 : 0.05, k == 2 ? 0.9 : 0.05, p);
            double x = p[0] + scene->origin_m.x, y = p[1] + scene->origin_m.y;
            asdic_vec3 up = {-0.09 * cos(3.0 * x) * sin(2.0 * y),
                             -0.06 * sin(3.0 * x) * cos(2.0 * y), 1.0};
            double off = off_rad(t, p, up);
            sum += off * off / (3.0 * count);
        }
    }
    print_message("hills: normals off by %.2g rad, rms\n", sqrt(sum));
    assert_true(sum > 0.0 && sqrt(sum) < 0.002);
    asdic_scene_destroy(&scene);
}

/* Half the thickness of NACA 0015 over its chord; Abbott and von Doenhoff 1959, eq. 6.2, its trailing edge closed. */
static double naca_0015(double x) {
    return 0.75 * (0.2969 * sqrt(x) - x * (0.126 + x * (0.3516 - x * (0.2843 - x * 0.1036))));
}

/* At how many corners that two facets share, which do not meet at an edge, they have two normals. */
static size_t count_creases(const dev_triangle *a, const dev_triangle *b) {
    const float *at[2][3] = {{a->v0, a->v1, a->v2}, {b->v0, b->v1, b->v2}};
    bool is_edge =
        vector_dot(vector_load(a->normal), vector_load(b->normal)) < (float)cos(CREASE_RAD);
    size_t count = 0;
    for (int i = 0; i < 9 && !is_edge; i++) {
        bool meet = memcmp(at[0][i / 3], at[1][i % 3], sizeof a->v0) == 0;
        vector one = smooth_unpack(a->corner_normals[i / 3]);
        count += meet && vector_dot(one, smooth_unpack(b->corner_normals[i % 3])) < 0.999f;
    }
    return count;
}

/* Strips of a wing are wide amidships and narrow at the nose, and turn by unlike angles: it is round all the same. */
static void a_wing_of_few_strips_is_round(void **state) {
    (void)state;
    enum { STATIONS = 8, AROUND = 2 * STATIONS, ROWS = 4 };
    double v[3 * AROUND * (ROWS + 1)];
    uint32_t f[6 * AROUND * ROWS];
    for (uint32_t i = 0; i < AROUND * (ROWS + 1); i++) {
        int k =
            (int)(i % AROUND) - STATIONS; /* from the trailing edge above to the nose and back */
        double x = 0.5 * (1.0 - cos(PI * k / STATIONS));
        v[3 * i] = 0.5 * x;
        v[3 * i + 1] = 1.0 / ROWS * (i / AROUND);
        v[3 * i + 2] = (k < 0 ? -0.5 : 0.5) * naca_0015(x);
        if (i < AROUND * ROWS) {
            uint32_t next = i - i % AROUND + (i + 1) % AROUND;
            const uint32_t two[] = {i, next, next + AROUND, i, next + AROUND, i + AROUND};
            memcpy(f + 6 * i, two, sizeof two);
        }
    }
    asdic_mesh *mesh;
    assert_ok(ctx,
              asdic_mesh_from_triangles(ctx, v, AROUND * (ROWS + 1), f, 2 * AROUND * ROWS, &mesh));
    asdic_scene *scene =
        scene_of(mesh, (asdic_pose){.position_m.z = 9.0}, asdic_material_facet(45.0, 0.0, 0.0));
    size_t creases = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        for (size_t k = 0; k < scene->triangle_count; k++) {
            creases += count_creases(&scene->triangles[i], &scene->triangles[k]);
        }
    }
    print_message("%zu corners with two normals\n", creases);
    assert_int_equal(creases, 0);
    asdic_scene_destroy(&scene);
}

/* Facets of a cylinder are flat where its crease angle says so. */
static void a_crease_angle_makes_facets_flat(void **state) {
    (void)state;
    static const ring tube[] = {{0.0, 0.1}, {1.0, 0.1}};
    static const double creases_rad[] = {0.0, 29.0 * PI / 180.0, 31.0 * PI / 180.0, PI / 2.0};
    for (int k = 0; k < 4; k++) {
        double off = 0.0;
        asdic_scene *scene = lathe(tube, 2, 12, creases_rad[k]);
        assert_int_equal(count_flat(scene, &off), k < 2 ? scene->triangle_count : 24);
        asdic_scene_destroy(&scene);
    }
    asdic_scene *scene;
    assert_ok(ctx, asdic_scene_create(ctx, &scene));
    assert_int_equal(asdic_scene_set_crease(scene, 1.6), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_set_crease(scene, -0.1), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_scene_set_crease(scene, NAN), ASDIC_ERROR_ARGUMENT);
    asdic_scene_destroy(&scene);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edge_leaves_its_face_flat),
        cmocka_unit_test(few_plates_stay_flat),
        cmocka_unit_test(a_chamfered_box_is_flat),
        cmocka_unit_test(a_barrel_with_cones_is_straight),
        cmocka_unit_test(a_short_capsule_is_straight_and_round),
        cmocka_unit_test(pairs_on_hills_are_no_walls),
        cmocka_unit_test(a_wing_of_few_strips_is_round),
        cmocka_unit_test(a_crease_angle_makes_facets_flat),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
