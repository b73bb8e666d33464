/*
 * OBJ, OFF and STL files, sound and unsound; PLY: test_mesh_ply.c. OpenMesh reports success for most of the unsound ones.
 */
#include "mesh_rig.h"

#include "scene/triangles.h"

#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

static mesh_rig rig;

static const char tetrahedron_obj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
                                      "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

static void put_float(unsigned char *at, float value) {
    memcpy(at, &value, sizeof value); /* the tests run on little-endian machines only */
}

/* A binary STL of two facets that says COUNT, cut to BYTES. */
static void write_stl(uint32_t count, size_t bytes, float odd_one) {
    unsigned char stl[84 + 2 * 50] = "binary";
    const float v[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, odd_one};
    memcpy(stl + 80, &count, sizeof count);
    for (int i = 0; i < 18; i++) {
        put_float(stl + 84 + 50 * (i / 9) + 12 + 4 * (i % 9), v[i]);
    }
    mesh_rig_write_bytes(&rig, "m.stl", stl, bytes);
}

static void stl_sizes(void **state) {
    (void)state;
    write_stl(2, 184, 0.0f);
    mesh_rig_expect(&rig, 2, 0);
    write_stl(2, 150, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: a binary STL of 2 facets has 184 bytes, this file has 150");
    write_stl(1, 184, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: a binary STL of 1 facets has 134 bytes, this file has 184");
    mesh_rig_refuse(&rig, "184: 50 bytes too many; save it anew");
    write_stl(2, 150, 0.0f);
    mesh_rig_refuse(&rig, "150: cut short or damaged; save it anew");
    write_stl(4000000000u, 184, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: a binary STL of 4000000000 facets has 200000000084 bytes");
    write_stl(0, 84, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: a binary STL without facets");
    write_stl(2, 50, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: 50 bytes");
    write_stl(2, 0, 0.0f);
    mesh_rig_refuse(&rig, "m.stl: the file is empty");
    write_stl(2, 184, NAN);
    mesh_rig_refuse(&rig, "m.stl: corner 2 of facet 1 is not finite");
    write_stl(2, 184, INFINITY);
    mesh_rig_refuse(&rig, "m.stl: corner 2 of facet 1 is not finite");
}

static void stl_text(void **state) {
    (void)state;
    const char *facet = "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                        "vertex 0 %s 0\nendloop\nendfacet\n";
    char text[2048], body[512];
    snprintf(body, sizeof body, facet, "1");
    snprintf(text, sizeof text, "solid x\n%sendsolid x\n", body);
    mesh_rig_write(&rig, "m.STL", text);
    mesh_rig_expect(&rig, 1, 0);
    /* blanks before the first word, and capitals as old writers have them */
    snprintf(text, sizeof text, "\r\n \tsolid x\n%sendsolid x\n", body);
    mesh_rig_write(&rig, "m.stl", text);
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.stl",
                   "SOLID X\n FACET NORMAL 0.0E0 0 1\n OUTER LOOP\n  VERTEX 0 0 0\n"
                   "  VERTEX 1.0E0 0 0\n  VERTEX 0 1 0\n ENDLOOP\n ENDFACET\nENDSOLID X\n");
    mesh_rig_expect(&rig, 1, 0);
    snprintf(text, sizeof text, "mesh x\n%sendmesh x\n", body);
    mesh_rig_write(&rig, "m.stl", text);
    mesh_rig_refuse(&rig,
                    "bytes are neither a binary STL nor a text one, which begins with 'solid'");
    snprintf(text, sizeof text, "solid x\n%sfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", body);
    mesh_rig_write(&rig, "m.stl", text);
    mesh_rig_refuse(&rig, ":11: ends after 1 facets and 1 corners");
    snprintf(body, sizeof body, facet, "one");
    snprintf(text, sizeof text, "solid x\n%sendsolid x\n", body);
    mesh_rig_write(&rig, "m.stl", text);
    mesh_rig_refuse(&rig, ":6: coordinate 2");
    snprintf(body, sizeof body, facet, "0");
    char sound[512];
    snprintf(sound, sizeof sound, facet, "1");
    snprintf(text, sizeof text, "solid x\n%s%sendsolid x\n", sound, body);
    mesh_rig_write(&rig, "m.stl", text);
    mesh_rig_expect(&rig, 1, 1);
    mesh_rig_write(&rig, "m.stl",
                   "solid x\nfacet normal 0 0 1\nouter loop\nvertex 4500000.1 0 0\n"
                   "vertex 4500000.3 0 0\nvertex 4500000.1 0.2 0\nendloop\nendfacet\nendsolid\n");
    mesh_rig_refuse(&rig, "m.stl: 0.2 across, but so far from 0 that");
}

static void obj_sound(void **state) {
    (void)state;
    mesh_rig_write(&rig, "m.obj", tetrahedron_obj);
    mesh_rig_expect(&rig, 4, 0);
    mesh_rig_write(&rig, "m.OBJ",
                   "# \\ in a comment\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nvn 0 0 1\n"
                   "vt 0 0\nv 0 1 0 0 0 1\nv 0 0 1\nf -4/1/1 -3/1/1 -2/1/1\nf 1//1 4//1 2//1");
    mesh_rig_expect(&rig, 2, 0);
    /* a facet that names a vertex twice is dropped and counted */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2\nf 1 2 3\nf 1 1 1\n");
    mesh_rig_expect(&rig, 1, 2);
    /* a corner that is there again: triangles written as quads, and one with a spike there and back */
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
                   "f 1 2 3 3\nf 1/1 1/2 3/3 4/4\nf 1 2 1 2\nf 2 3 4 2 1\n");
    mesh_rig_expect(&rig, 3, 1);
    /* an edge of three facets is kept, and of a facet twice one */
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\n"
                   "f 1 2 3\nf 1 2 4\nf 1 2 5\nf 1 2 3\n");
    mesh_rig_expect(&rig, 3, 0);
}

static void copies_are_dropped(void **state) {
    (void)state;
    static const char *const again[] = {
        "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", /* the tetrahedron once more, from other corners, ... */
        "f 2 1 3\nf 4 1 2\nf 3 4 2\nf 3 1 4\n",
        "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 3 4 1\n", /* ... wound the other way, as sheets of two sides are; ... */
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 5 7 6\n"}; /* ... and a facet of vertices of its own */
    for (size_t i = 0; i < 4; i++) {
        char text[512];
        snprintf(text, sizeof text, "%s%s", tetrahedron_obj, again[i]);
        mesh_rig_write(&rig, "m.obj", text);
        asdic_mesh *mesh = mesh_rig_load(&rig);
        assert_non_null(mesh);
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        assert_int_equal(info.copies, i < 3 ? 4 : 1);
        assert_int_equal(info.triangles, 4);
        assert_int_equal(info.dropped, 0);
        assert_int_equal(info.open_edges, 0);
        asdic_mesh_destroy(&mesh);
    }
}

static void obj_unsound(void **state) {
    (void)state;
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, ":2: coordinate 1");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv a b c\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, ":2: coordinate 1");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, ":2: coordinate 3");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 1e999\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, ":2: coordinate 3");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 1e60\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, "m.obj: holds 3 vertices and 1 facets, but OpenMesh reads 2 and 1");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n2 3\n");
    mesh_rig_refuse(&rig, ":4: continued");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 7\n");
    mesh_rig_refuse(&rig, ":5: this facet names vertex 7");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n");
    mesh_rig_refuse(&rig, ":4: corner 3");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n");
    mesh_rig_refuse(&rig, ":4: corner 3");
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n");
    mesh_rig_refuse(&rig, ":4: a facet with 2 corners");
    mesh_rig_write(&rig, "m.obj", "This is not a mesh.\nIt is text.\n");
    mesh_rig_refuse(&rig, "m.obj: 0 vertices");
    mesh_rig_write(&rig, "m.obj", "");
    mesh_rig_refuse(&rig, "m.obj: the file is empty");
    mesh_rig_write_bytes(&rig, "m.obj", "\xff\xfev\0 \0\x31\0", 8);
    mesh_rig_refuse(&rig, "m.obj: binary or UTF-16");
    mesh_rig_write(&rig, "m.obj", "\xef\xbb\xbf\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_refuse(&rig, ":4: this facet names vertex 3");
    mesh_rig_write(&rig, "m.xyz", tetrahedron_obj);
    mesh_rig_refuse(&rig, "'.xyz' is not a mesh format");
}

/* A byte order mark, and lines that end in CR alone. */
static void what_systems_put_about_text_is_passed_over(void **state) {
    (void)state;
    mesh_rig_write(&rig, "m.obj", "\xef\xbb\xbfv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.off", "\xef\xbb\xbfOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.obj", "# one\rv 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r");
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.off", "OFF\r3 1 0\r0 0 0\r1 0 0\r0 1 0\r3 0 1 2");
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\rv 1 0 0\rv 0 1 q\rf 1 2 3\r");
    mesh_rig_refuse(&rig, ":3: coordinate 3");
}

/* Area seen along z: what a fan of a concave polygon gets wrong. */
static double area_of_load(void) {
    asdic_mesh *mesh = mesh_rig_load(&rig);
    if (!mesh) {
        print_error("%s\n", asdic_context_error(rig.ctx));
    }
    assert_non_null(mesh);
    asdic_scene *scene;
    assert_int_equal(asdic_scene_create(rig.ctx, &scene), ASDIC_OK);
    asdic_pose here = {.position_m = {0.0, 0.0, 50.0}};
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, here, asdic_material_bottom(2)), ASDIC_OK);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    size_t inside = 0;
    for (int i = 0; i < 100; i++) {
        for (int j = 0; j < 100; j++) {
            asdic_vec3 p = {0.04 * (i + 0.503), 0.04 * (j + 0.497), 0.0};
            inside += isfinite(asdic_scene_altitude_m(scene, p));
        }
    }
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&mesh);
    return (double)inside * 0.04 * 0.04;
}

static void pipes_are_refused(void **state) {
    (void)state;
    unlink(mesh_rig_write(&rig, "m.obj", ""));
    assert_int_equal(mkfifo(rig.path, 0600), 0);
    alarm(5); /* ends the test if the file is waited for */
    mesh_rig_refuse(&rig, "m.obj: not a regular file");
    alarm(0);
}

static void polygons(void **state) {
    (void)state;
    /* an arrow head whose first corner sees outside: area 8 - 4 */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 2 2 0\nf 1 2 3 4\n");
    mesh_rig_expect(&rig, 2, 0);
    assert_close(area_of_load(), 4.0, 0.1);
    /* the same from every corner, and wound the other way */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 2 2 0\nf 2 3 4 1\n");
    assert_close(area_of_load(), 4.0, 0.1);
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 4 2 0\nv 0 4 0\nv 2 2 0\nf 4 3 2 1\n");
    assert_close(area_of_load(), 4.0, 0.1);
    /* a small one of 0.32 - 0.16 m2, from every corner and wound either way */
    static const char *const darts[] = {"1 2 3 4", "2 3 4 1", "3 4 1 2", "4 1 2 3",
                                        "4 3 2 1", "3 2 1 4", "2 1 4 3", "1 4 3 2"};
    for (size_t i = 0; i < sizeof darts / sizeof *darts; i++) {
        char text[128];
        snprintf(text, sizeof text, "v 0 0 0\nv 0.8 0.4 0\nv 0 0.8 0\nv 0.4 0.4 0\nf %s\n",
                 darts[i]);
        mesh_rig_write(&rig, "m.obj", text);
        mesh_rig_expect(&rig, 2, 0);
        assert_close(area_of_load(), 0.16, 0.03);
    }
    /* a comb with three teeth: 4 x 1 and three of 3 x 0.8 */
    mesh_rig_write(&rig, "m.off",
                   "OFF\n12 1 0\n0 0 0\n1 0 0\n1 4 0\n4 4 0\n4 3.2 0\n1 3.2 0\n1 2.4 0\n4 2.4 0\n"
                   "4 1.6 0\n1 1.6 0\n1 0.8 0\n4 0.8 0\n12 0 11 10 9 8 7 6 5 4 3 2 1\n");
    mesh_rig_refuse(
        &rig,
        "m.off: the outline of facet 0 (12 corners) crosses"); /* 0-11 cuts 1-10: not a comb at all */
    mesh_rig_write(&rig, "m.off",
                   "OFF\n12 1 0\n0 0 0\n4 0 0\n4 0.8 0\n1 0.8 0\n1 1.6 0\n4 1.6 0\n4 2.4 0\n"
                   "1 2.4 0\n1 3.2 0\n4 3.2 0\n4 4 0\n0 4 0\n12 0 1 2 3 4 5 6 7 8 9 10 11\n");
    mesh_rig_expect(&rig, 10, 0);
    assert_close(area_of_load(), 4.0 + 3 * 2.4, 0.1);
    /* corners on a straight line, and a corner twice */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 2 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4 5\n");
    assert_close(area_of_load(), 16.0, 0.05);
    /* a spike out of a triangle, there and back again, and one that is all there is */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 2 0 0\nv 4 0 0\nv 2 0 0\nv 2 2 0\nf 1 2 3 4 5\n");
    assert_close(area_of_load(), 2.0, 0.05);
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 1 0 0\nv 4 0 0\nv 3 0 0\nv 0 1 0\nf 1 2 3 4\nf 1 2 5\n");
    mesh_rig_expect(&rig, 1, 1);
    /* twice its area is just 1, its normal up or down; and none, though not on a line */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 1 0.5 0\nv 0 0.5 0\nf 1 2 3 4\n");
    mesh_rig_expect(&rig, 2, 0);
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 1 0.5 0\nv 0 0.5 0\nf 4 3 2 1\n");
    mesh_rig_expect(&rig, 2, 0);
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3 4\nf 1 3 5\n");
    mesh_rig_expect(&rig, 1, 1);
    /* a square with a square hole, to which an edge leads and back: 16 - 4; in front of it a triangle, as OpenMesh
     * counts facets, and one that it drops */
    static const char *const keyhole[] = {"m.obj", "m.off"};
    static const char *const holed[] = {
        "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
        "f 1 1 2\nf 1 2 5\nf 1 2 3 4 1 5 6 7 8 5\nf 1 2 3 4\n",
        "OFF\n8 1 0\n0 0 0\n4 0 0\n4 4 0\n0 4 0\n1 1 0\n1 3 0\n3 3 0\n3 1 0\n"
        "10 0 1 2 3 0 4 5 6 7 4\n"};
    for (size_t i = 0; i < 2; i++) {
        mesh_rig_write(&rig, keyhole[i], holed[i]);
        mesh_rig_expect(&rig, i == 0 ? 11 : 8, i == 0);
    }
    assert_close(area_of_load(), 12.0, 0.05);
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
                   "f 1 1 2\nf 1 2 5\nf 1 2 3 4 1 5 6 7 8 5\n");
    mesh_rig_expect(&rig, 9, 1);
    assert_close(area_of_load(), 12.0, 0.05);
    /* a square gone round three times */
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nf 1 2 3 4 1 2 3 4 1 2 3 4\n");
    mesh_rig_expect(&rig, 2, 0);
    assert_close(area_of_load(), 16.0, 0.05);
    /* outlines that cross themselves by roundings: one that is no more than that, and a large one */
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 4 1e-7 0\nv 4 0 0\nv 0 1e-7 0\nv 0 4 0\nf 1 2 3 4\nf 1 3 5\n");
    assert_close(area_of_load(), 8.0, 0.1);
    mesh_rig_write(&rig, "m.obj",
                   "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 4 0\nv 2.0000001 4.0000001 0\n"
                   "v 2.0000001 3.9999999 0\nv 2 4.0000001 0\nv 0 4 0\nf 1 2 3 4 5 6 7 8\n");
    assert_close(area_of_load(), 16.0, 0.05);
    /* a bow tie */
    mesh_rig_write(&rig, "m.obj", "v 0 0 0\nv 4 4 0\nv 4 0 0\nv 0 3 0\nf 1 2 3 4\n");
    mesh_rig_refuse(&rig, "m.obj: the outline of facet 0 (4 corners) crosses itself");
    /* no corner of which can be cut off */
    mesh_rig_write(&rig, "m.obj", "v 5 2 0\nv 6 3 0\nv 5 3 0\nv 3 1 0\nv 1 2 0\nf 1 2 3 4 5\n");
    mesh_rig_refuse(&rig, "m.obj: the outline of facet 0 (5 corners) crosses itself");
}

static void off_variants(void **state) {
    (void)state;
    mesh_rig_write(&rig, "m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    mesh_rig_expect(&rig, 1, 0);
    mesh_rig_write(&rig, "m.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    mesh_rig_refuse(&rig, ":6: ends after 1 of 2 facets");
    mesh_rig_write(&rig, "m.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n");
    mesh_rig_refuse(&rig, ":5: ends after 3 of 4 vertices");
    mesh_rig_write(&rig, "m.off", "OFF\n2000000000 1 0\n0 0 0\n");
    mesh_rig_refuse(&rig, ":2: 2000000000 vertices and 1 facets do not fit 25 bytes");
    mesh_rig_write(&rig, "m.off", "OFF\n3 1 0\n0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n");
    mesh_rig_refuse(&rig, ":4: coordinate 2 of vertex 1");
    mesh_rig_write(&rig, "m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n");
    mesh_rig_refuse(&rig, ":6: corner 2 of facet 0");
    mesh_rig_write(&rig, "m.off", "OFF\n# no more\n");
    mesh_rig_refuse(&rig, ":2: ends before its counts");
    mesh_rig_write(&rig, "m.off", "OFF BINARY\n3 1 0\n");
    mesh_rig_refuse(&rig, ":1: binary OFF");
    mesh_rig_write(&rig, "m.off", "hello\n");
    mesh_rig_refuse(&rig, ":1: does not start with OFF");
    mesh_rig_write(&rig, "m.off", "OFF\n3 1 0\n0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n");
    mesh_rig_refuse(&rig, ":4: coordinate 2 of vertex 1");
    /* Comments, one line, colours: right or refused, never silently short. */
    static const char *const doubtful[] = {
        "OFF # keyword\n# counts\n3 1 0\n0 0 0\n# between\n1 0 0 # here\n0 1 0\n3 0 1 2\n",
        "OFF 3 1 0 0 0 0 1 0 0 0 1 0 3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n",
        "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 1.0 0.5 0.5\n3 0 1 3 1.0 0.5 0.5\n",
        "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2\n",
        "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
    };
    for (size_t i = 0; i < sizeof doubtful / sizeof *doubtful; i++) {
        mesh_rig_write(&rig, "m.off", doubtful[i]);
        asdic_mesh *mesh = mesh_rig_load(&rig);
        if (mesh) {
            asdic_mesh_info info = asdic_mesh_get_info(mesh);
            assert_int_equal(info.triangles, i == 3 ? 2 : 1);
            assert_close(info.max_m.x, 1.0, 0.0);
            asdic_mesh_destroy(&mesh);
        }
    }
}

static void transform_and_info(void **state) {
    (void)state;
    asdic_mesh *mesh;
    mesh_rig_write(&rig, "m.obj",
                   "v 1 2 3\nv 5 2 3\nv 1 7 3\nv 1 2 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\n");
    assert_int_equal(asdic_mesh_load(rig.ctx, rig.path, 0.5, true, &mesh), ASDIC_OK);
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    assert_close(info.min_m.x, 1.0, 0.0); /* north = file's y */
    assert_close(info.max_m.x, 3.5, 0.0);
    assert_close(info.max_m.y, 2.5, 0.0); /* east = file's x */
    assert_close(info.min_m.z, -4.5, 0.0);
    assert_int_equal(info.open_edges, 3); /* the fourth side is missing */
    assert_string_equal(info.hint, "");
    asdic_mesh_destroy(&mesh);
    assert_int_equal(asdic_mesh_load(rig.ctx, rig.path, 0.001, false, &mesh), ASDIC_OK);
    assert_non_null(strstr(asdic_mesh_get_info(mesh).hint, "0.006 m across"));
    asdic_mesh_destroy(&mesh);
    assert_int_equal(asdic_mesh_load(rig.ctx, rig.path, 0.0, false, &mesh), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_mesh_load(rig.ctx, "no/such.obj", 1.0, false, &mesh), ASDIC_ERROR_INPUT);
    assert_non_null(strstr(asdic_context_error(rig.ctx), "no/such.obj"));
}

/* The same model in four formats, from the Debian package assimp-testmodels. */
static void four_formats_agree(void **state) {
    (void)state;
    static const char *const paths[] = {
        "/usr/share/assimp/models/OBJ/WusonOBJ.obj", "/usr/share/assimp/models/OFF/Wuson.off",
        "/usr/share/assimp/models/PLY/Wuson.ply", "/usr/share/assimp/models/STL/Wuson.stl"};
    size_t triangles = 0, open_edges = 0;
    for (size_t i = 0; i < 4; i++) {
        asdic_mesh *mesh;
        if (access(paths[i], R_OK) != 0) {
            skip();
        }
        assert_int_equal(asdic_mesh_load(rig.ctx, paths[i], 1.0, false, &mesh), ASDIC_OK);
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        triangles = i == 0 ? info.triangles : triangles;
        open_edges = i == 0 ? info.open_edges : open_edges;
        assert_int_equal(info.triangles, triangles);
        assert_int_equal(info.open_edges, open_edges);
        asdic_mesh_destroy(&mesh);
    }
    assert_in_range(triangles, 3000, 4000);
}

/* A plate with a hole, of the Debian package assimp-testmodels: its one facet's outline leads to the hole and back. */
static void an_outline_of_others_keeps_its_area(void **state) {
    (void)state;
    asdic_mesh *mesh;
    const char *path = "/usr/share/assimp/models/OBJ/concave_polygon.obj";
    if (access(path, R_OK) != 0) {
        skip();
    }
    assert_int_equal(asdic_mesh_load(rig.ctx, path, 1.0, false, &mesh), ASDIC_OK);
    double area_m2 = 0.0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        double c[9];
        asdic_mesh_corners(mesh, i, c);
        area_m2 += 0.5 * fabs((c[4] - c[1]) * (c[8] - c[2]) - (c[5] - c[2]) * (c[7] - c[1]));
    }
    assert_close(area_m2, 0.2454966872, 1e-9); /* of the file's numbers, by Gauss's formula */
    asdic_mesh_destroy(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stl_sizes),
        cmocka_unit_test(stl_text),
        cmocka_unit_test(pipes_are_refused),
        cmocka_unit_test(obj_sound),
        cmocka_unit_test(obj_unsound),
        cmocka_unit_test(polygons),
        cmocka_unit_test(off_variants),
        cmocka_unit_test(transform_and_info),
        cmocka_unit_test(four_formats_agree),
        cmocka_unit_test(copies_are_dropped),
        cmocka_unit_test(an_outline_of_others_keeps_its_area),
        cmocka_unit_test(what_systems_put_about_text_is_passed_over),
    };
    mesh_rig_open(&rig);
    int failed = mesh_rig_reads_files(&rig) ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
    mesh_rig_close(&rig);
    return failed;
}
