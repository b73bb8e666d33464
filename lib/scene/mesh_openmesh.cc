/*
 * OpenMesh reads the formats; its reader modules call an importer for every vertex and facet. Ours
 * keeps them as they come: no half-edge mesh is built, so facets that share an edge three times or
 * name a vertex twice are neither split nor dropped, and polygons keep their corners.
 */
#include "mesh_openmesh.h"

#include "asdic_config.h"

extern "C" {
#include "../base/context.h"
}

#include <cstdlib>

extern "C" void asdic_polygons_finish(asdic_polygons *polygons) {
    std::free(polygons->vertices_m);
    std::free(polygons->corners);
    std::free(polygons->first);
    *polygons = asdic_polygons{};
}

#if ASDIC_HAVE_OPENMESH

#include <OpenMesh/Core/IO/IOManager.hh>
#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include <cstring>
#include <istream>
#include <mutex>
#include <new>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <vector>

namespace {

using namespace OpenMesh;

/* Attributes that a sonar does not hear are accepted and forgotten. */
#define FORGET(setter, ...)                                                                        \
    void setter(__VA_ARGS__) override {                                                            \
    }

/* More than the scan found is refused at once: a reader that lost its place may go on for as long as
 * an int can count. */
class PolygonImporter : public IO::BaseImporter {
  public:
    explicit PolygonImporter(const asdic_mesh_scan *scan)
        : most_vertices(scan->vertices_m ? scan->vertices : 3 * scan->facets),
          most_facets(scan->facets), most_corners(scan->size) {
    }
    std::vector<float> vertices;
    std::vector<uint32_t> corners;
    std::vector<uint32_t> first{0};

    VertexHandle add_vertex(const Vec3f &point) override {
        if (n_vertices() == most_vertices) {
            throw std::length_error("it finds more vertices than there are");
        }
        vertices.insert(vertices.end(), {point[0], point[1], point[2]});
        return VertexHandle(static_cast<int>(n_vertices()) - 1);
    }
    VertexHandle add_vertex() override {
        return add_vertex(Vec3f(0.0f, 0.0f, 0.0f));
    }
    void set_point(VertexHandle vertex, const Vec3f &point) override {
        for (size_t k = 0; k < 3; k++) {
            vertices.at(3 * static_cast<size_t>(vertex.idx()) + k) = point[static_cast<int>(k)];
        }
    }
    FaceHandle add_face(const VHandles &handles) override {
        if (n_faces() == most_facets || corners.size() + handles.size() > most_corners) {
            throw std::length_error("it finds more facets or corners than there are");
        }
        for (VertexHandle handle : handles) {
            corners.push_back(static_cast<uint32_t>(handle.idx()));
        }
        first.push_back(static_cast<uint32_t>(corners.size()));
        return FaceHandle(static_cast<int>(n_faces()) - 1);
    }
    size_t n_vertices() const override {
        return vertices.size() / 3;
    }
    size_t n_faces() const override {
        return first.size() - 1;
    }
    size_t n_edges() const override {
        return 0;
    }

    HalfedgeHandle add_edge(VertexHandle, VertexHandle) override {
        return HalfedgeHandle();
    }
    FaceHandle add_face(HalfedgeHandle) override {
        return FaceHandle();
    }
    FORGET(add_face_texcoords, FaceHandle, VertexHandle, const std::vector<Vec2f> &)
    FORGET(add_face_texcoords, FaceHandle, VertexHandle, const std::vector<Vec3f> &)
    FORGET(set_face_texindex, FaceHandle, int)
    FORGET(set_halfedge, VertexHandle, HalfedgeHandle)
    FORGET(set_normal, VertexHandle, const Vec3f &)
    FORGET(set_normal, VertexHandle, const Vec3d &)
    FORGET(set_color, VertexHandle, const Vec3uc &)
    FORGET(set_color, VertexHandle, const Vec4uc &)
    FORGET(set_color, VertexHandle, const Vec3f &)
    FORGET(set_color, VertexHandle, const Vec4f &)
    FORGET(set_texcoord, VertexHandle, const Vec2f &)
    FORGET(set_status, VertexHandle, const Attributes::StatusInfo &)
    FORGET(set_next, HalfedgeHandle, HalfedgeHandle)
    FORGET(set_face, HalfedgeHandle, FaceHandle)
    void request_face_texcoords2D() override {
    }
    FORGET(set_texcoord, HalfedgeHandle, const Vec2f &)
    FORGET(set_texcoord, VertexHandle, const Vec3f &)
    FORGET(set_texcoord, HalfedgeHandle, const Vec3f &)
    FORGET(set_status, HalfedgeHandle, const Attributes::StatusInfo &)
    FORGET(set_color, EdgeHandle, const Vec3uc &)
    FORGET(set_color, EdgeHandle, const Vec4uc &)
    FORGET(set_color, EdgeHandle, const Vec3f &)
    FORGET(set_color, EdgeHandle, const Vec4f &)
    FORGET(set_status, EdgeHandle, const Attributes::StatusInfo &)
    FORGET(set_normal, FaceHandle, const Vec3f &)
    FORGET(set_normal, FaceHandle, const Vec3d &)
    FORGET(set_color, FaceHandle, const Vec3uc &)
    FORGET(set_color, FaceHandle, const Vec4uc &)
    FORGET(set_color, FaceHandle, const Vec3f &)
    FORGET(set_color, FaceHandle, const Vec4f &)
    FORGET(set_status, FaceHandle, const Attributes::StatusInfo &)
    FORGET(add_texture_information, int, std::string)

  private:
    size_t most_vertices, most_facets, most_corners;
};

/* The scanned bytes as a stream, so that both look at the same file. */
class MemoryBuffer : public std::streambuf {
  public:
    MemoryBuffer(char *text, size_t size) {
        setg(text, text, text + size);
    }

  protected:
    pos_type seekoff(off_type offset, std::ios_base::seekdir way,
                     std::ios_base::openmode) override {
        off_type base = way == std::ios_base::beg   ? 0
                        : way == std::ios_base::cur ? gptr() - eback()
                                                    : egptr() - eback();
        if (base + offset < 0 || base + offset > egptr() - eback()) {
            return pos_type(off_type(-1));
        }
        setg(eback(), eback() + base + offset, egptr());
        return pos_type(base + offset);
    }
    pos_type seekpos(pos_type position, std::ios_base::openmode mode) override {
        return seekoff(off_type(position), std::ios_base::beg, mode);
    }
};

/* OpenMesh's error, output and log streams kept quiet while in scope. */
class Silence {
  public:
    Silence() {
        for (int i = 0; i < 3; i++) {
            enabled[i] = stream(i).is_enabled();
            stream(i).disable();
        }
    }
    ~Silence() {
        for (int i = 0; i < 3; i++) {
            if (enabled[i]) {
                stream(i).enable();
            }
        }
    }
    Silence(const Silence &) = delete;
    Silence &operator=(const Silence &) = delete;

  private:
    bool enabled[3];
    static mostream &stream(int i) {
        return i == 0 ? omerr() : i == 1 ? omout() : omlog();
    }
};

/* Reader modules, their options and the streams are OpenMesh's globals: one file at a time. */
std::mutex &openmesh_lock() {
    static std::mutex lock;
    return lock;
}

const char *extension_of(asdic_mesh_format format) {
    switch (format) {
    case ASDIC_MESH_OBJ:
        return "obj";
    case ASDIC_MESH_OFF:
        return "off";
    case ASDIC_MESH_PLY:
        return "ply";
    default:
        return "stl";
    }
}

template <typename T> T *copy_of(const std::vector<T> &from) {
    T *to = static_cast<T *>(std::malloc((from.size() + 1) * sizeof(T)));
    if (!to) {
        throw std::bad_alloc();
    }
    if (!from.empty()) {
        std::memcpy(to, from.data(), from.size() * sizeof(T));
    }
    return to;
}

bool read_polygons(const asdic_mesh_scan *scan, PolygonImporter &importer) {
    std::lock_guard<std::mutex> guard(openmesh_lock());
    Silence silence;
    MemoryBuffer buffer(scan->text, scan->size);
    std::istream stream(&buffer);
    stream.imbue(std::locale::classic());
    IO::Options options;
    if (scan->format == ASDIC_MESH_STL_BINARY) {
        options += IO::Options::Binary;
    }
    return IO::IOManager().read(stream, extension_of(scan->format), importer, options);
}

} // namespace

extern "C" asdic_status asdic_openmesh_read(const asdic_mesh_scan *scan, asdic_polygons *out) {
    *out = asdic_polygons{};
    try {
        PolygonImporter importer(scan);
        if (!read_polygons(scan, importer)) {
            return asdic_fail(
                scan->ctx, ASDIC_ERROR_INPUT,
                "%s: OpenMesh cannot read this file; write it anew in a plain layout, "
                "or in another format (.obj, .off, .ply, .stl)",
                scan->path);
        }
        out->vertices_m = copy_of(importer.vertices);
        out->corners = copy_of(importer.corners);
        out->first = copy_of(importer.first);
        out->vertex_count = importer.n_vertices();
        out->corner_count = importer.corners.size();
        out->facet_count = importer.n_faces();
        return ASDIC_OK;
    } catch (const std::bad_alloc &) {
        asdic_polygons_finish(out);
        return asdic_fail(scan->ctx, ASDIC_ERROR_MEMORY, "%s: out of memory while reading",
                          scan->path);
    } catch (const std::exception &error) {
        asdic_polygons_finish(out);
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT, "%s: OpenMesh gave up: %s", scan->path,
                          error.what());
    } catch (...) {
        asdic_polygons_finish(out);
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT, "%s: OpenMesh gave up", scan->path);
    }
}

#else

extern "C" asdic_status asdic_openmesh_read(const asdic_mesh_scan *scan, asdic_polygons *out) {
    *out = asdic_polygons{};
    return asdic_fail(scan->ctx, ASDIC_ERROR_UNSUPPORTED,
                      "%s: this build reads no mesh files (configure with -Dopenmesh=enabled)",
                      scan->path);
}

#endif
