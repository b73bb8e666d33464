"""Scenes: from files, or put together here from dictionaries and arrays."""
from __future__ import annotations

import hashlib
import itertools
import json
import os
from typing import Any, Container, Iterable, Iterator, Mapping, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from ._library import (MASKED, ArgumentError, Context, FileError, Handle, counted, doubles, encoded, fail, ffi, lib, masked,
                       numbers, text, value_of, whole)

Keys = Mapping[str, Any]
SECTIONS = ("environment", "surface", "bottom", "sonar", "mission", "sampling", "model", "detector", "output")
FILES = ("file", "grid", "mesh", "track", "curve", "sound_speed_profile")


def _material(material: str | Keys) -> Any:
    """A word, or the keys of a scene file's material."""
    if not isinstance(material, (str, Mapping)):
        raise TypeError(f"material = {material!r} is neither a word, as 'steel', nor the keys of a scene file's material")
    return material if isinstance(material, str) else dict(material)


def _plain(value: Any) -> Any:
    """What json does not know: numpy's numbers and arrays, paths."""
    if isinstance(value, (np.generic, np.ndarray)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    raise TypeError(f"a scene cannot hold a {type(value).__name__}: {value!r}")


def _json(sections: Keys) -> str:
    """A scene file's text. YAML knows no pairs of surrogates, which JSON's escapes have beyond U+FFFF: without escapes."""
    result = json.dumps(sections, default=_plain, ensure_ascii=False, indent=1)
    encoded(result, "the scene")
    return result


def _rows(values: ArrayLike, what: str) -> Any:
    """VALUES as an array [n, 3], perhaps masked."""
    array = masked(values, what)
    if array.ndim != 2 or array.shape[1] != 3 or len(array) == 0:
        raise fail(ArgumentError, f"{what} have the shape {array.shape}; it must be (n, 3)")
    return array


class _Mesh(str):
    """A mesh from arrays, and its name, by which a scene has it: it is there as long as anything is called so.

    No other mesh has that name, whatever folder it is saved in.
    """

    corners: np.ndarray
    indices: np.ndarray
    handle: Handle

    def __new__(cls, vertices: ArrayLike, triangles: ArrayLike) -> _Mesh:
        corners = np.array(doubles(_rows(vertices, "vertices"), "vertices"), order="C")
        found = numbers(_rows(triangles, "triangles"), "triangles", "iu")
        if MASKED.is_masked(found):
            raise fail(ArgumentError, "triangles have masked corners; leave those triangles out")
        if found.min() < 0 or found.max() >= len(corners):
            worst = found.min() if found.min() < 0 else found.max()
            raise fail(ArgumentError, f"a triangle has the corner {worst}, but there are {len(corners)} vertices")
        indices, context = np.array(found, dtype=np.uint32, order="C"), Context()
        mesh = super().__new__(cls, f"mesh_{hashlib.sha256(corners.tobytes() + indices.tobytes()).hexdigest()[:16]}.ply")
        mesh.corners, mesh.indices = corners, indices
        mesh.handle = context.make(
            "asdic_mesh", lib.asdic_mesh_destroy, lib.asdic_mesh_from_triangles, context.pointer,
            ffi.from_buffer("double[]", corners), len(corners), ffi.from_buffer("uint32_t[]", indices), len(indices))
        return mesh

    def __reduce__(self) -> Any:
        return _Mesh, (self.corners, self.indices)


def _meshes_in(value: Any) -> Iterator[_Mesh]:
    """The meshes from arrays that VALUE, a part of a scene, names."""
    if isinstance(value, _Mesh):
        yield value
    elif isinstance(value, (Mapping, list, tuple)):
        for inner in value.values() if isinstance(value, Mapping) else value:
            yield from _meshes_in(inner)


def _write_ply(path: str, corners: np.ndarray, indices: np.ndarray) -> None:
    """A mesh file with every digit of the corners."""
    facets = np.empty(len(indices), [("count", "u1"), ("corners", "<u4", (3,))])
    facets["count"], facets["corners"] = 3, indices
    with open(path, "wb") as file:
        file.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(corners)}\n"
                   "property double x\nproperty double y\nproperty double z\n"
                   f"element face {len(indices)}\nproperty list uchar uint vertex_indices\nend_header\n".encode())
        file.write(corners.astype("<f8").tobytes())
        file.write(facets.tobytes())


def _whole(name: Any, folder: str, known: Container[str]) -> Any:
    """The path of the file NAME in FOLDER, unless it is none or is KNOWN."""
    return os.path.join(folder, name) if isinstance(name, str) and name and name not in known else name


def _find_files(value: Any, folder: str, known: Container[str] = (), key: str = "") -> Any:
    """VALUE, which stands at KEY, with whole paths of the files that lie in FOLDER, but of those that are KNOWN."""
    if isinstance(value, dict):
        drawn = str(value.get("key", key)).rpartition(".")[2]  # what a draw's choice, or a choice in it, stands for
        return {name: _find_files(inner, folder, known, drawn if name == "choice" else name)
                for name, inner in value.items()}
    if isinstance(value, list):
        return [_find_files(inner, folder, known, key) for inner in value]
    return _whole(value, folder, known) if key in FILES else value


class Scene:
    """A scene in memory: the sections of a scene file as dictionaries, and meshes from arrays.

    Keys, units and ranges are those of scene files (docs/guide.md, or `asdic.schema()`): degrees, metres,
    kHz; x north, y east, z DOWN from the sea surface.

        scene = asdic.Scene(bottom={"depth_m": 12, "type": "sand"}, sonar={...}, mission={...})
        scene.add_mesh(vertices, triangles, material="steel", position_m=(20, 0, 9))
        run = asdic.simulate(scene)
    """

    def __init__(self, *, environment: Keys | None = None, surface: Keys | None = None,
                 bottom: Keys | str | None = None, sonar: Keys | None = None, mission: Keys | None = None,
                 sampling: Keys | None = None, model: Keys | None = None, detector: Keys | None = None,
                 output: Keys | None = None, objects: Iterable[Keys] = ()) -> None:
        self.environment, self.surface, self.bottom = environment, surface, bottom
        self.sonar, self.mission, self.sampling = sonar, mission, sampling
        self.model, self.detector, self.output = model, detector, output
        self.objects: list[Any] = list(objects)
        self._more: dict[str, Any] = {}  # sections of a file that are no arguments here

    @classmethod
    def open(cls, path: str | os.PathLike[str]) -> Scene:
        """The scene of a file, to be changed and added to. Files that it names are looked for where it is."""
        context = Context()
        found = ffi.new("char **")
        context.call(lib.asdic_mission_file_json, context.pointer, encoded(path, "path"), found)
        try:
            sections = json.loads(text(found[0]))
        finally:
            lib.free(found[0])
        sections = _find_files(sections, os.path.dirname(os.path.abspath(os.fsdecode(path))))
        sections.pop("version", None)
        scene = cls(objects=sections.pop("objects", None) or ())
        scene._more = {name: value for name, value in sections.items() if name not in SECTIONS}
        for name in sections.keys() - scene._more.keys():
            setattr(scene, name, sections[name])
        return scene

    def add(self, name: str, *, position_m: Sequence[float] | None = None, material: str | Keys | None = None,
            **keys: Any) -> None:
        """An object by the keys of a scene file: `add("wall", box={"size_m": [1, 20, 4]}, position_m=...)`.

        Without POSITION_M it is at (0, 0, 0), or where its track says.
        """
        entry: dict[str, Any] = {"name": name, **keys}
        if position_m is not None or "track" not in keys:
            entry["position_m"] = [0.0, 0.0, 0.0] if position_m is None else list(position_m)
        if material is not None:
            entry["material"] = _material(material)
        self.objects.append(entry)

    def add_mesh(self, vertices: ArrayLike, triangles: ArrayLike, material: str | Keys = "steel", *,
                 name: str | None = None, position_m: Sequence[float] | None = None,
                 rotation_deg: Sequence[float] | None = None, **keys: Any) -> str:
        """An object of TRIANGLES, rows of three indices into VERTICES, rows of x, y, z in metres.

        The arrays are copied. MATERIAL is a word ("steel", "concrete", "sand", ...) or the keys of a scene
        file's material. Returns the object's name: without NAME, the next free of object0, object1, ...
        """
        if name is None:  # objects may have been taken out: how many there are may be another's number
            taken = [one.get("name") for one in self.objects if isinstance(one, dict)]
            name = next(free for k in itertools.count(len(self.objects)) if (free := f"object{k}") not in taken)
        if rotation_deg is not None:
            keys["rotation_deg"] = list(rotation_deg)
        self.add(name, position_m=position_m, material=material,
                 mesh={"file": _Mesh(vertices, triangles), "z_up": False}, **keys)
        return name

    def set_terrain(self, north_m: ArrayLike, east_m: ArrayLike, depth_m: ArrayLike,
                    material: str | Keys = "sand") -> None:
        """A bottom from depths at the crossings of a grid: DEPTH_M[i, k] at NORTH_M[i], EAST_M[k]; holes where it is NAN
        or masked."""
        north, east, depth = (doubles(values, what) for values, what in ((north_m, "north_m"), (east_m, "east_m"),
                                                                         (depth_m, "depth_m")))
        if depth.shape != (north.size, east.size) or north.ndim != 1 or east.ndim != 1 or min(depth.shape) < 2:
            raise fail(ArgumentError, f"depth_m has the shape {depth.shape}; of {north.size} north_m and {east.size} "
                       f"east_m it must be ({north.size}, {east.size}), at least (2, 2)")
        for name, along in (("north_m", north), ("east_m", east)):
            if not np.isfinite(along).all():
                raise fail(ArgumentError, f"{name} is {along[~np.isfinite(along)][0]} in places; only depth_m has holes")
            steps = np.diff(along)
            if not (np.all(steps >= 0) or np.all(steps <= 0)):  # a sheet that is folded over itself
                raise fail(ArgumentError, f"{name} goes to and fro; a grid's lines ascend or descend")
            if not steps.any():
                raise fail(ArgumentError, f"{name} is {along[0]:g} throughout; a grid has two lines or more")
        vertices = np.stack([*np.meshgrid(north, east, indexing="ij"), depth], axis=-1).reshape(-1, 3)
        corner = np.arange(depth.size).reshape(depth.shape)
        a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
        there = ~np.isnan(depth.ravel())
        has_ac = (there[a] & there[c])[..., None]  # else the other diagonal may save half of the cell
        faces = np.stack([np.where(has_ac, np.stack([a, c, b], axis=-1), np.stack([a, d, b], axis=-1)),
                          np.where(has_ac, np.stack([a, d, c], axis=-1), np.stack([b, d, c], axis=-1))]).reshape(-1, 3)
        faces = faces[there[faces].all(axis=1)]
        if len(faces) == 0:
            raise fail(ArgumentError, "depth_m is NAN but for single places; a terrain has three neighbours or more")
        if np.nanmax(depth) < 0.0:
            raise fail(ArgumentError, f"depth_m is {np.nanmin(depth):g} to {np.nanmax(depth):g} m, above the sea surface; "
                       "depths are positive down: give heights with the other sign")
        self.set_bottom(vertices[there], (np.cumsum(there) - 1)[faces], material)

    def set_bottom(self, vertices: ArrayLike, triangles: ArrayLike, material: str | Keys = "sand") -> None:
        """A bottom of triangles, as of add_mesh."""
        law = _material(material)
        law = {"type": law} if isinstance(law, str) else law
        self.bottom = {"mesh": {"file": _Mesh(vertices, triangles), "z_up": False}, **law}

    @property
    def _sections(self) -> dict[str, Any]:
        """What stands in the scene's file."""
        sections = {"version": 1, **self._more, **{name: getattr(self, name) for name in SECTIONS},
                    "objects": self.objects}
        return {name: value for name, value in sections.items() if value not in (None, [])}

    @property
    def _meshes(self) -> dict[str, _Mesh]:
        """The meshes from arrays that the scene names."""
        return {mesh: mesh for mesh in _meshes_in(self._sections)}

    def save(self, folder: str | os.PathLike[str]) -> str:
        """Writes the scene for the asdic program: FOLDER/scene.json, whose path it returns, and the meshes."""
        place, content = os.fsdecode(encoded(folder, "folder")), self.saved_json()
        path = os.path.join(place, "scene.json")
        try:
            os.makedirs(place, exist_ok=True)
            for name, mesh in self._meshes.items():
                _write_ply(os.path.join(place, name), mesh.corners, mesh.indices)
            with open(path, "w", encoding="utf-8", errors="surrogateescape") as file:
                file.write(content)
        except OSError as error:
            raise fail(FileError, f"the scene cannot be saved in '{place}': {error.strerror}") from error
        return path

    def to_json(self) -> str:
        """The scene as a scene file's text; JSON is YAML. Meshes from arrays stand in it by name."""
        return _json(self._sections)

    def saved_json(self) -> str:
        """The text that save writes, with whole paths of the files that the scene names in the working folder."""
        return _json(_find_files(json.loads(self.to_json()), os.getcwd(), self._meshes))

    def __repr__(self) -> str:
        given = [name for name in SECTIONS if getattr(self, name) is not None]
        objects, meshes = counted(len(self.objects), "object"), len(self._meshes)
        return f"<asdic.Scene: {objects}, {meshes} {'mesh' if meshes == 1 else 'meshes'}, with {', '.join(given)}>"

    def load(self, context: Context) -> Handle:
        """The mission that the scene describes."""
        data = self.to_json().encode(errors="surrogateescape")  # names of files may be of any bytes; the reader judges
        named = self._meshes
        meshes = ffi.new("asdic_named_mesh[]", len(named))
        keeps: list[Any] = [data]
        for entry, (name, mesh) in zip(meshes, named.items()):
            keeps.append(ffi.new("char[]", name.encode()))
            entry.name, entry.mesh = keeps[-1], mesh.handle.pointer
        content, path = ffi.from_buffer("char[]", data), ffi.new("char[]", b"scene")
        source = ffi.new("asdic_scene_text *", {"text": content, "length": len(data), "name": path, "meshes": meshes,
                                                "mesh_count": len(named)})
        return context.make("asdic_mission", lib.asdic_mission_destroy, lib.asdic_mission_load_text, context.pointer,
                            source)


SceneLike = Union[str, "os.PathLike[str]", Scene]


def load_mission(context: Context, scene: SceneLike) -> Handle:
    """The mission of a scene file or a Scene."""
    if isinstance(scene, Scene):
        return scene.load(context)
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"scene is a {type(scene).__name__}; it must be the path of a scene file or an asdic.Scene")
    return context.make("asdic_mission", lib.asdic_mission_destroy, lib.asdic_mission_load, context.pointer,
                        encoded(scene, "scene"))


def choose_sampling(mission: Handle, rays: int | None, seed: int | None, sampler: str | None) -> Any:
    """The mission's sampling, with what is given in place of what the scene says."""
    sampling = lib.asdic_mission_sampling(mission.pointer)
    if rays is not None:
        sampling.rays = whole(rays, "rays", 64, 1 << 28)
    if seed is not None:
        sampling.seed = whole(seed, "seed", 0, (1 << 64) - 1)
    if sampler is not None:
        sampling.sampler = value_of("asdic_sampler", sampler, "sampler")
    return sampling


def remarks(mission: Handle) -> list[str]:
    """Laws outside the range of their sources, rays too few."""
    found = lib.asdic_mission_remarks(mission.pointer)
    return [text(found.text[i]) for i in range(found.count)]


def schema() -> dict[str, Any]:
    """The JSON Schema of scene files: every key, its unit, range and default."""
    data = lib.asdic_mission_schema()
    if data == ffi.NULL:
        raise MemoryError("out of memory while writing the schema")
    try:
        return dict(json.loads(text(data)))
    finally:
        lib.free(data)


__all__ = ["Keys", "Scene", "SceneLike", "choose_sampling", "load_mission", "remarks", "schema"]
