/*
 * PLY files, sound and unsound, in text and binary of either byte order.
 */
#include "mesh_rig.h"

#include "base/text.h"
#include "scene/mesh_build.h"

#include <stdio.h>
#include <time.h>

static mesh_rig rig;

#define PLY_HEAD(vertices, faces)                                                                  \
    "ply\nformat ascii 1.0\nelement vertex " vertices                                              \
    "\nproperty float x\nproperty float y\nproperty float z\nelement face " faces                  \
    "\nproperty list uchar int vertex_indices\nend_header\n"

#define SIXTY "qwertyuiop1qwertyuiop2qwertyuiop3qwertyuiop4qwertyuiop5qwert"

/* Three vertices with a whole number each, the first one's FIRST, and a facet of them. */
#define PLY_WHOLE(first)                                                                           \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"                \
    "property float z\nproperty uchar quality\nelement face 1\n"                                   \
    "property list uchar int vertex_indices\nend_header\n"                                         \
    "0 0 0 " first "\n1 0 0 0\n0 1 0 0\n3 0 1 2\n"

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void ply_counts(void **state) {
    (void)state;
    const char *body = "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    char text[1024];
    static const char *const forged[] = {PLY_HEAD("3", "900000000000"), PLY_HEAD("2000000000", "1"),
                                         PLY_HEAD("900000000000", "1"), PLY_HEAD("-3", "1"),
                                         PLY_HEAD("3", "-1"),           PLY_HEAD("3", "0")};
    snprintf(text, sizeof text, "%s%s", PLY_HEAD("3", "1"), body);
    mesh_rig_write(&rig, "m.ply", text);
    mesh_rig_expect(&rig, 1, 0);
    double start = seconds();
    for (size_t i = 0; i < sizeof forged / sizeof *forged; i++) {
        snprintf(text, sizeof text, "%s%s", forged[i], body);
        mesh_rig_write(&rig, "m.ply", text);
        mesh_rig_refuse(&rig, "m.ply");
    }
    assert_true(seconds() - start < 1.0); /* OpenMesh takes 20 s and 4.6 GB */
}

static void ply_bodies(void **state) {
    (void)state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n",
         "'git lfs pull' fetches it"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1\n", ":13: face 0 of 1 is cut short"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
         ":13: face 0 of 1 names a vertex that is not there: 3"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n",
         ":13: face 0 of 1 names a vertex that is not there: -1"},
        {PLY_HEAD("3", "1") "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
         ":11: vertex 1 of 3 is cut short, or holds no finite number of its type"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 inf\n0 1 0\n3 0 1 2\n", ":11: vertex 1"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n2 0 1\n3 0 1 2\n",
         ":13: face 0 of 1 has fewer than 3 corners: 2"},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nproperty list uchar float more\nelement face 1\n"
         "property list uchar int vertex_indices\nend_header\n0 0 0 0\n1 0 0 0\n0 1 0 0\n3 0 1 2\n",
         ":7: a list among a vertex's"},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0\n1 0\n0 1\n"
         "3 0 1 2\n",
         "m.ply: vertices need x, y, z"},
        {"ply\nformat ascii 1.0\nelement vertex 3\n", ":3: the header has no format or no end"},
        {"ply\ncomment\nformat ascii 1.0\nformat binary_little_endian 1.0\n",
         ":4: a second format"},
        {"ply\nformat ascii 1.0\nelement v\ve 0\n",
         ":3: a control character"}, /* it reads on forever */
        {"solid\n", ":1: does not start with 'ply'"},
        {"ply\nformat ascii 1.1\n", ":2: the version"}, /* OpenMesh reads on forever */
        {"ply\nformat ascii 1.0\ncom\n", ":3: unknown line"},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list short int vertex_indices\n",
         ":4: OpenMesh reads how many corners"},
        {"ply\nformat ascii 1.0\nelement edge 900000000000\nend_header\n",
         "m.ply: an element has no properties"},
        {"ply\nformat ascii 1.0\nelement vertex 3 4\n", ":3: '4' follows"},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty float\n", ":4: this property has no"},
        {"ply\nformat ascii 1.0\nelement vertex 3\nproperty real x\n",
         ":4: unknown type of a property"},
        {"ply\nformat ascii 1.0\nproperty float x\n", ":3: a property outside an element"},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list byte int vertex_indices\n",
         ":4: unknown type of a list's length"},
        {"ply\nformat ascii 1.0\nelement vertex\n", ":3: this element has no count"},
        {"ply\nformat ascii 1.0\nelement vertex -1\n", ":3: this element has no count"},
        {"ply\nformat text 1.0\n", ":2: unknown PLY format"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0x1 0\n0 1 0\n3 0 1 2\n", ":11: vertex 1"},
        {PLY_HEAD("3", "1") "0 0 0\n1 1e39 0\n0 1 0\n3 0 1 2\n", ":11: vertex 1"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 \v\n0\n3 0 1 2\n", ":12: vertex 2"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n3.5 0 1 2 1\n", ":13: face 0"},
        {PLY_HEAD("3", "1") "0 0 0\n1 0 0\n0 1 0\n300 0 1 2\n", ":13: face 0"},
        {PLY_HEAD("3", "0") "0 0 0\n1 0 0\n0 1 0\n", "m.ply: 3 vertices and 0 faces"},
        {"ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\n"
         "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
         "3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n",
         "m.ply: has its faces before its vertices"},
        {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nelement vertex 2\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "m.ply: declares its vertices twice"},
        {PLY_WHOLE("256"), ":11: vertex 0"},
        {PLY_WHOLE("-1"), ":11: vertex 0"},
        {PLY_WHOLE("2.5"), ":11: vertex 0"},
        {PLY_WHOLE("2x"), ":11: vertex 0"},
        {"ply\nformat ascii 1.0\nelement vertex 3 " SIXTY "a\n", ":3: '" SIXTY "' follows"},
        {"ply\nformat ascii 1.0\nelement vertex 3 " SIXTY "\n", ":3: '" SIXTY "' follows"},
    };
    static const char *const sound[] = {
        PLY_WHOLE("0"),
        PLY_WHOLE("255"),
        /* lines without the word comment, as short as that and longer */
        "ply\nformat ascii 1.0\nmade by\nmade: by\nmade: by me\nelement vertex 3\n"
        "property float x\nproperty float y\nproperty float z\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
        /* lines of Windows, and a format behind what it is to precede */
        "ply\r\ncomment x\r\nelement vertex 3\r\nproperty float x\r\nformat ascii 1.0\r\n"
        "property float y\r\nproperty float z\r\nelement face 1\r\n"
        "property list uchar int vertex_indices\r\nend_header\r\n"
        "0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2\r\n",
        "ply\r\nformat ascii 1.0\r\nelement vertex 3\r\nproperty float x\r\n"
        "property float y\r\nproperty float z\r\nelement face 1\r\n"
        "property list uchar int vertex_indices\r\nend_header\r\n"
        "0 0 0\r\n1 0 0\r\n0 1 0\r\n3 0 1 2",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "\n0 0\n0 1 0 0\n\n0 1\n0 3 0 1\r\n2\n",
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        mesh_rig_write(&rig, "m.ply", cases[i].text);
        mesh_rig_refuse(&rig, cases[i].part);
    }
    for (size_t i = 0; i < sizeof sound / sizeof *sound; i++) {
        mesh_rig_write(&rig, "m.ply", sound[i]);
        mesh_rig_expect(&rig, 1, 0);
    }
}

/* A vertex has 64 properties at most. */
static void ply_properties(void **state) {
    (void)state;
    for (int count = 64; count <= 65; count++) {
        asdic_text text = {0};
        asdic_text_format(&text, "ply\nformat ascii 1.0\nelement vertex 3\n"
                                 "property float x\nproperty float y\nproperty float z\n");
        for (int k = 3; k < count; k++) {
            asdic_text_format(&text, "property float p%d\n", k);
        }
        asdic_text_format(&text, "element face 1\nproperty list uchar int vertex_indices\n"
                                 "end_header\n");
        for (int corner = 0; corner < 3; corner++) {
            asdic_text_format(&text, "%d %d 0", corner == 1, corner == 2);
            for (int k = 3; k < count; k++) {
                asdic_text_format(&text, " 5");
            }
            asdic_text_format(&text, "\n");
        }
        asdic_text_format(&text, "3 0 1 2\n");
        assert_false(text.failed);
        mesh_rig_write(&rig, "m.ply", text.data);
        asdic_text_finish(&text);
        if (count == 64) {
            mesh_rig_expect(&rig, 1, 0);
        } else {
            mesh_rig_refuse(&rig, ":68: a property outside an element, or more than 64 of them");
        }
    }
}

/* Three vertices in doubles and one facet, in either byte order, cut to BYTES of the body. */
static void write_binary_ply(bool big_endian, double odd_one, uint32_t index, size_t body_bytes) {
    unsigned char file[512];
    const double v[9] = {4500000.125, 0, 0, 4500001.125, 0, 0, 4500000.125, 1, odd_one};
    int head = snprintf((char *)file, sizeof file,
                        "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty double x\n"
                        "property double y\nproperty double z\nelement face 1\n"
                        "property list uchar uint vertex_index\nend_header\n",
                        big_endian ? "big" : "little");
    unsigned char *at = file + head;
    const uint32_t corners[3] = {0, 1, index};
    for (int i = 0; i < 9; i++) {
        unsigned char bytes[8];
        memcpy(bytes, &v[i], 8);
        for (int k = 0; k < 8; k++) {
            *at++ = bytes[big_endian ? 7 - k : k];
        }
    }
    *at++ = 3;
    for (int i = 0; i < 3; i++) {
        unsigned char bytes[4];
        memcpy(bytes, &corners[i], 4);
        for (int k = 0; k < 4; k++) {
            *at++ = bytes[big_endian ? 3 - k : k];
        }
    }
    mesh_rig_write_bytes(&rig, "m.ply", file, (size_t)head + body_bytes);
}

static void ply_binary(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        write_binary_ply(big, 0.0, 2, 85);
        mesh_rig_expect(&rig, 1, 0);
        asdic_mesh *mesh = mesh_rig_load(&rig);
        /* doubles stay doubles: single precision has steps of half a metre here */
        assert_close(asdic_mesh_get_info(mesh).min_m.x, 4500000.125, 0.0);
        asdic_mesh_destroy(&mesh);
        write_binary_ply(big, NAN, 2, 85);
        mesh_rig_refuse(&rig, "m.ply: vertex 2 of 3"); /* it has no lines */
        write_binary_ply(big, 0.0, 3, 85);
        mesh_rig_refuse(&rig, "m.ply: face 0 of 1");
        write_binary_ply(big, 0.0, 2, 80);
        mesh_rig_refuse(&rig, "m.ply: face 0 of 1");
        write_binary_ply(big, 0.0, 2, 60);
        mesh_rig_refuse(&rig,
                        "m.ply: its header needs at least 73 bytes of data, but there are 60");
    }
}

/* Facets by integers of one and two bytes, in either byte order, beside what is passed over; and coordinates of whole
 * numbers, which OpenMesh cannot read. */
static void ply_integers(void **state) {
    (void)state;
    static const float corners[3][3] = {{-5, 300, -7}, {4, -300, -7}, {-5, -2, 100}};
    static const char *const types[] = {"float", "short"};
    for (int k = 0; k < 4; k++) {
        bool big = k % 2 != 0;
        unsigned char file[512];
        int head = snprintf((char *)file, sizeof file,
                            "ply\nformat binary_%s_endian 1.0\nelement vertex 3\nproperty %s x\n"
                            "property float y\nproperty float z\nproperty int8 confidence\n"
                            "element face 1\nproperty list uint8 int16 vertex_index\nend_header\n",
                            big ? "big" : "little", types[k / 2]);
        unsigned char *at = file + head;
        for (int i = 0; i < 9; i++) {
            unsigned char bytes[4];
            memcpy(bytes, &corners[i / 3][i % 3], 4);
            for (int b = 0; b < 4; b++) {
                *at++ = bytes[big ? 3 - b : b];
            }
            if (i % 3 == 2) {
                *at++ = 0xfe;
            }
        }
        *at++ = 3;
        for (unsigned char i = 0; i < 3; i++) {
            *at++ = big ? 0 : i;
            *at++ = big ? i : 0;
        }
        mesh_rig_write_bytes(&rig, "m.ply", file, (size_t)(at - file));
        if (k >= 2) {
            mesh_rig_refuse(&rig, "m.ply: coordinates are whole numbers");
            continue;
        }
        mesh_rig_expect(&rig, 1, 0);
        asdic_mesh *mesh = mesh_rig_load(&rig);
        for (size_t i = 0; i < 3; i++) {
            asdic_vec3 v = asdic_mesh_vertex(mesh, i);
            assert_true(v.x == (double)corners[i][0] && v.y == (double)corners[i][1] &&
                        v.z == (double)corners[i][2]);
        }
        asdic_mesh_destroy(&mesh);
    }
}

/* The bytes of VALUE, an integer or a float of BYTES bytes, least significant first, or in the other order. */
static unsigned char *put(unsigned char *at, const void *value, size_t bytes, bool big) {
    for (size_t i = 0; i < bytes; i++) {
        *at++ = ((const unsigned char *)value)[big ? bytes - 1 - i : i];
    }
    return at;
}

/* A square and a triangle in FORMAT, with the properties whose bits are set in BESIDE: a scalar and a list
 * before the facets' corners, and behind them. */
static void write_beside(const char *format, unsigned beside) {
    bool text = format[0] == 'a', big = strstr(format, "big") != NULL;
    static const char *const extra[] = {"property uchar flags\n",
                                        "property list uchar float texcoord\n"};
    static const char *const corners[] = {"4 0 1 2 3", "3 1 4 2"};
    static const float points[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {2, 1, 0}};
    char file[2048];
    size_t at = (size_t)snprintf(file, sizeof file,
                                 "ply\nformat %s 1.0\ncomment made by hand\nelement camera 1\n"
                                 "property int a\nelement vertex 5\nproperty float x\n"
                                 "property float y\nproperty uchar red\nproperty float z\n"
                                 "element face 2\n%s%sproperty list uchar int vertex_indices\n"
                                 "%s%send_header\n",
                                 format, beside & 1 ? extra[0] : "", beside & 2 ? extra[1] : "",
                                 beside & 4 ? extra[0] : "", beside & 8 ? extra[1] : "");
    if (text) {
        at += (size_t)snprintf(file + at, sizeof file - at, "7\n");
        for (int i = 0; i < 5; i++) {
            at +=
                (size_t)snprintf(file + at, sizeof file - at, "%g %g 200\n%g\n",
                                 (double)points[i][0], (double)points[i][1], (double)points[i][2]);
        }
        for (int i = 0; i < 2; i++) {
            at += (size_t)snprintf(file + at, sizeof file - at, "%s%s%s%s%s\n",
                                   beside & 1 ? "9 " : "", beside & 2 ? "6 0 1 0 .25 1 1 " : "",
                                   corners[i], beside & 4 ? " 9" : "",
                                   beside & 8 ? " 6 0 1 0 .25 1 1" : "");
        }
        mesh_rig_write(&rig, "m.ply", file);
        return;
    }
    static const unsigned char nine = 9, six = 6, red = 200;
    static const int camera = 7;
    unsigned char *to = put((unsigned char *)file + at, &camera, 4, big);
    for (int i = 0; i < 5; i++) {
        to = put(put(to, &points[i][0], 4, big), &points[i][1], 4, big);
        to = put(put(to, &red, 1, big), &points[i][2], 4, big);
    }
    for (int i = 0; i < 2; i++) {
        for (unsigned bit = 0; bit < 4; bit++) {
            if (bit == 2) {
                for (const char *digit = corners[i]; *digit; digit += 1 + (digit[1] == ' ')) {
                    int value = *digit - '0';
                    unsigned char count = (unsigned char)value;
                    to = digit == corners[i] ? put(to, &count, 1, big) : put(to, &value, 4, big);
                }
            }
            if ((beside >> bit & 1) == 0) {
                continue;
            }
            to = bit % 2 == 0 ? put(to, &nine, 1, big) : put(to, &six, 1, big);
            for (int k = 0; k < 6 && bit % 2 == 1; k++) {
                static const float uv[] = {0, 1, 0, .25f, 1, 1};
                to = put(to, &uv[k], 4, big);
            }
        }
    }
    mesh_rig_write_bytes(&rig, "m.ply", file, (size_t)(to - (unsigned char *)file));
}

/* Facets are the file's whatever stands beside their corners, as MeshLab's coordinates of a texture do. */
static void ply_beside_corners(void **state) {
    (void)state;
    static const char *const formats[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    static const double area_m2 = 1.5; /* a square of 1 m and half of one */
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        for (unsigned beside = 0; beside < 16; beside++) {
            write_beside(formats[i], beside);
            asdic_mesh *mesh = mesh_rig_load(&rig);
            assert_non_null(mesh);
            assert_true(asdic_mesh_get_info(mesh).triangles == 3);
            double sum_m2 = 0.0;
            for (size_t k = 0; k < 3; k++) {
                const uint32_t *c = &mesh->indices[3 * k];
                asdic_vec3 a = asdic_mesh_vertex(mesh, c[0]), b = asdic_mesh_vertex(mesh, c[1]),
                           d = asdic_mesh_vertex(mesh, c[2]);
                sum_m2 += 0.5 * fabs((b.x - a.x) * (d.y - a.y) - (b.y - a.y) * (d.x - a.x));
            }
            assert_close(sum_m2, area_m2, 1e-12);
            asdic_mesh_destroy(&mesh);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ply_counts),     cmocka_unit_test(ply_bodies),
        cmocka_unit_test(ply_properties), cmocka_unit_test(ply_binary),
        cmocka_unit_test(ply_integers),   cmocka_unit_test(ply_beside_corners),
    };
    mesh_rig_open(&rig);
    int failed = mesh_rig_reads_files(&rig) ? cmocka_run_group_tests(tests, NULL, NULL) : 77;
    mesh_rig_close(&rig);
    return failed;
}
