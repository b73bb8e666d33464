/*
 * An independent scan of a mesh file before OpenMesh reads it: the vertices and facets that it
 * declares and holds, and the coordinates in double. OpenMesh returns success for many files that
 * it reads wrongly (a vertex with a word in it is skipped and shifts all indices; a wrong count
 * gives an empty mesh), and keeps single precision only.
 */
#ifndef ASDIC_SCENE_MESH_SCAN_H
#define ASDIC_SCENE_MESH_SCAN_H

#include <asdic/context.h>

#include <locale.h>

typedef enum asdic_mesh_format {
    ASDIC_MESH_OBJ,
    ASDIC_MESH_OFF,
    ASDIC_MESH_PLY,
    ASDIC_MESH_STL_ASCII,
    ASDIC_MESH_STL_BINARY,
} asdic_mesh_format;

/* A whole file in memory and what the scan finds in it. */
typedef struct asdic_mesh_scan {
    asdic_context *ctx;
    const char *path;
    char *text; /* SIZE bytes and a terminating zero */
    size_t size;
    locale_t c_locale;
    asdic_mesh_format format;
    size_t vertices, facets;
    size_t degenerate;   /* facets of fewer than three vertices or places: OpenMesh may drop them;
                         * not counted for PLY and OFF, whose facets it hands over as is */
    uint64_t facet_hash; /* of all facets' corner counts and indices; OBJ: each vertex once, and
                         * degenerate ones apart */
    double *vertices_m;  /* 3 * vertices; NULL for STL, whose facets carry their own corners */
    uint32_t *outlines; /* of OBJ facets that name a vertex twice, which OpenMesh does not hand over
                          * whole: the facet's number as OpenMesh counts, its corners' number, they */
    size_t outlines_size;
} asdic_mesh_scan;

/* Reads the file and scans it by its extension; every error names the file and, in text, the line.
 * Finish the scan in any case. */
asdic_status asdic_mesh_scan_file(asdic_context *ctx, const char *path, asdic_mesh_scan *out);
void asdic_mesh_scan_finish(asdic_mesh_scan *scan);

/* The two steps before a format's own: the bytes; and, of text, whether they can be that, without what
 * systems put about it: a byte order mark, ends of lines of their own. */
asdic_status asdic_mesh_scan_open(asdic_context *ctx, const char *path, asdic_mesh_scan *out);
asdic_status asdic_mesh_scan_take_text(asdic_mesh_scan *scan);

/* The formats, one file each. */
asdic_status asdic_mesh_scan_obj(asdic_mesh_scan *scan);
asdic_status asdic_mesh_scan_off(asdic_mesh_scan *scan);
asdic_status asdic_mesh_scan_ply(asdic_mesh_scan *scan);
asdic_status asdic_mesh_scan_stl(asdic_mesh_scan *scan);

/* One line of a text file after another, without its end. */
typedef struct asdic_line {
    const char *at, *end; /* what is left of the line */
    size_t number;        /* from 1 */
} asdic_line;

/* The next line; false at the end of the file. Start with {text, text, 0}. */
bool asdic_line_next(const asdic_mesh_scan *scan, asdic_line *line);
void asdic_line_skip_blanks(asdic_line *line);

/* Takes WORD from the line when it comes next and ends there. */
bool asdic_line_take_word(asdic_line *line, const char *word);

/* Takes a finite number; false, with nothing taken, when there is none. */
bool asdic_line_take_number(const asdic_mesh_scan *scan, asdic_line *line, double *out);
bool asdic_line_take_integer(asdic_line *line, long long *out);

/* "PATH:LINE: MESSAGE" and ASDIC_ERROR_INPUT. */
asdic_status asdic_mesh_scan_fail(const asdic_mesh_scan *scan, size_t line, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Makes room for one vertex more than *CAPACITY holds, and appends. */
asdic_status asdic_mesh_scan_add_vertex(asdic_mesh_scan *scan, const double v[3], size_t *capacity);

#endif
