"""Renders a relume scene file with Mitsuba 3, and compares two EXR images.

    reference.py SCENE.toml -o OUT.exr [--size WxH] [--spp N] [--bounces N] [--seed N]
    reference.py --compare CANDIDATE.exr REFERENCE.exr

Nothing here is shared with relume: the script reads TOML, OBJ and MTL itself
and leaves sampling, intersection and shading to Mitsuba, so a fault of relume's
conventions shows as a difference. It needs the wheels `mitsuba` (3.9)
and `numpy` of PyPI.
"""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np

mi.set_variant("scalar_rgb")

# Side of the squares over which the blockwise error takes its means: large
# enough to average the noise of single pixels away.
BLOCK = 8
# Paths are never ended at random, so that the noise stays low in corners.
NO_RUSSIAN_ROULETTE = 10_000


@dataclass
class Material:
    """What MTL says about a surface, linear RGB."""

    albedo: list[float] = field(default_factory=lambda: [0.8, 0.8, 0.8])
    emission: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])


@dataclass
class Triangles:
    """Corner positions and normals of one material: (count, 3, 3) each."""

    positions: np.ndarray
    normals: np.ndarray


@dataclass
class Obj:
    """Fans of an OBJ file; corners are (position, normal or -1), from 0."""

    positions: np.ndarray
    normals: np.ndarray
    fans: dict[str, list[list[tuple[int, int]]]]
    materials: dict[str, Material]


def read_mtl(path: Path) -> dict[str, Material]:
    """Materials of an MTL file by name."""
    materials: dict[str, Material] = {}
    current = Material()
    for line in path.read_text().splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword == "newmtl":
            current = materials.setdefault(rest.strip(), Material())
        elif keyword == "Kd":
            current.albedo = [float(value) for value in rest.split()]
        elif keyword == "Ke":
            current.emission = [float(value) for value in rest.split()]
        elif keyword in ("map_Kd", "map_Ke"):
            raise SystemExit(f"{path}: textures are not supported")
    return materials


def read_corner(word: str, position_count: int, normal_count: int) -> tuple[int, int]:
    """Indices from 0 of `v`, `v/vt`, `v//vn` or `v/vt/vn`."""
    parts = word.split("/")
    position = int(parts[0])
    normal = int(parts[2]) if len(parts) == 3 and parts[2] else 0
    return (
        position - 1 if position > 0 else position_count + position,
        normal - 1 if normal >= 0 else normal_count + normal,
    )


def read_obj(path: Path) -> Obj:
    """Triangles of an OBJ file, polygons split from their first corner."""
    obj = Obj(np.empty(0), np.empty(0), {}, {})
    positions: list[list[float]] = []
    normals: list[list[float]] = []
    fan = obj.fans.setdefault("", [])
    for line in path.read_text().splitlines():
        keyword, *words = line.split() or [""]
        if keyword == "v":
            positions.append([float(word) for word in words[:3]])
        elif keyword == "vn":
            normals.append([float(word) for word in words])
        elif keyword == "usemtl":
            fan = obj.fans.setdefault(" ".join(words), [])
        elif keyword == "mtllib":
            obj.materials |= read_mtl(path.parent / " ".join(words))
        elif keyword == "f":
            corners = [read_corner(word, len(positions), len(normals)) for word in words]
            fan.extend([corners[0], b, c] for b, c in zip(corners[1:], corners[2:]))
    obj.positions = np.array(positions)
    obj.normals = np.array(normals or [[0.0, 0.0, 1.0]])
    return obj


def face_normals(positions: np.ndarray) -> np.ndarray:
    """Cross products of the edges, twice the area long, (count, 3)."""
    a, b, c = positions[:, 0], positions[:, 1], positions[:, 2]
    return np.cross(b - a, c - a)


def smooth_normals(positions: np.ndarray) -> np.ndarray:
    """Area-weighted normals over equal positions."""
    corners = positions.reshape(-1, 3)
    _, group = np.unique(corners, axis=0, return_inverse=True)
    sums = np.zeros((group.max() + 1, 3))
    np.add.at(sums, group.reshape(-1), np.repeat(face_normals(positions), 3, axis=0))
    return sums[group.reshape(-1)].reshape(positions.shape)


def triangles_of(obj: Obj, name: str, normals_key: str) -> Triangles:
    """Triangles of one material with the normals that the scene asks for."""
    corners = np.array(obj.fans[name])
    positions = obj.positions[corners[..., 0]]
    flat = face_normals(positions)
    kept = np.linalg.norm(flat, axis=1) > 0.0
    corners, positions, flat = corners[kept], positions[kept], flat[kept]
    normals = np.repeat(flat[:, None, :], 3, axis=1)
    if normals_key == "smooth":
        normals = smooth_normals(positions)
    elif normals_key == "file":
        has_normals = (corners[..., 1] >= 0).all(axis=1)
        given = obj.normals[np.maximum(corners[..., 1], 0)]
        normals = np.where(has_normals[:, None, None], given, normals)
    return Triangles(positions, normals / np.linalg.norm(normals, axis=2, keepdims=True))


def rgb(values: list[float]) -> dict[str, Any]:
    """A linear Rec.709 colour."""
    return {"type": "rgb", "value": [float(value) for value in values]}


def shape(triangles: Triangles, material: Material) -> mi.Mesh:
    """A Mitsuba mesh that is diffuse on both sides."""
    properties = mi.Properties()
    bsdf = {"type": "diffuse", "reflectance": rgb(material.albedo)}
    properties["bsdf"] = mi.load_dict({"type": "twosided", "nested": bsdf})
    if any(value > 0.0 for value in material.emission):
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": rgb(material.emission)})
    count = len(triangles.positions)
    mesh = mi.Mesh("mesh", 3 * count, count, props=properties, has_vertex_normals=True)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = triangles.positions.ravel()
    parameters["vertex_normals"] = triangles.normals.ravel()
    parameters["faces"] = np.arange(3 * count, dtype=np.uint32)
    parameters.update()
    return mesh


def spot(light: dict[str, Any]) -> dict[str, Any]:
    """A spot: both programs fall linearly with the angle between two half angles."""
    origin = np.array(light["position"], dtype=float)
    if "target" in light:
        target = np.array(light["target"], dtype=float)
    else:
        target = origin + np.array(light["direction"], dtype=float)
    axis = (target - origin) / np.linalg.norm(target - origin)
    up = [1.0, 0.0, 0.0] if abs(axis[1]) > 0.9 else [0.0, 1.0, 0.0]
    cutoff = float(light.get("cutoff", 30.0))
    return {
        "type": "spot",
        "to_world": mi.ScalarTransform4f().look_at(origin=origin, target=target, up=up),
        "intensity": rgb(light["intensity"]),
        "cutoff_angle": cutoff,
        "beam_width": float(light.get("beam", 0.75 * cutoff)),
    }


def emitter(light: dict[str, Any]) -> dict[str, Any]:
    """A light of the scene file."""
    kind = light["kind"]
    if kind == "point":
        position = [float(value) for value in light["position"]]
        return {"type": "point", "position": position, "intensity": rgb(light["intensity"])}
    if kind == "spot":
        return spot(light)
    if kind == "directional":
        direction = [float(value) for value in light["direction"]]
        return {
            "type": "directional",
            "direction": direction,
            "irradiance": rgb(light["irradiance"]),
        }
    raise SystemExit(f"light kind {kind} is not supported")


def sensor(camera: dict[str, Any], size: tuple[int, int], spp: int) -> dict[str, Any]:
    """A pinhole camera whose pixels are plain means over their squares."""
    return {
        "type": "perspective",
        "fov": float(camera["vfov"]),
        "fov_axis": "y",
        "near_clip": 1e-3,
        "far_clip": 1e6,
        "to_world": mi.ScalarTransform4f().look_at(
            origin=camera["position"],
            target=camera["target"],
            up=camera.get("up", [0.0, 1.0, 0.0]),
        ),
        "sampler": {"type": "independent", "sample_count": spp},
        "film": {
            "type": "hdrfilm",
            "width": size[0],
            "height": size[1],
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
    }


def load_scene(path: Path, size: tuple[int, int] | None, spp: int, bounces: int | None) -> mi.Scene:
    """The Mitsuba scene of a relume scene file."""
    description = tomllib.loads(path.read_text())
    obj = read_obj(path.parent / description["mesh"])
    for override in description.get("material", []):
        material = obj.materials.setdefault(override["name"], Material())
        material.albedo = override.get("albedo", material.albedo)
        material.emission = override.get("emission", material.emission)
    if bounces is None:
        bounces = description.get("render", {}).get("bounces", 4)
    camera = description["camera"]
    scene: dict[str, Any] = {
        "type": "scene",
        # Depth 1 is emission alone, depth 2 direct light.
        "integrator": {
            "type": "path",
            "max_depth": int(bounces) + 2,
            "rr_depth": NO_RUSSIAN_ROULETTE,
        },
        "sensor": sensor(camera, size or tuple(camera["size"]), spp),
    }
    for name, fans in obj.fans.items():
        if fans:
            triangles = triangles_of(obj, name, description.get("normals", "file"))
            mesh = shape(triangles, obj.materials.get(name, Material()))
            scene[f"shape{len(scene)}"] = mesh
    for index, light in enumerate(description.get("light", [])):
        scene[f"light{index}"] = emitter(light)
    return mi.load_dict(scene)


def read_exr(path: Path) -> np.ndarray:
    """RGB of an EXR image, (height, width, 3)."""
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(bitmap, dtype=np.float64)


def block_means(image: np.ndarray) -> np.ndarray:
    """Means over whole squares of BLOCK pixels; a rest at the border is left out."""
    rows, columns = image.shape[0] // BLOCK, image.shape[1] // BLOCK
    cut = image[: rows * BLOCK, : columns * BLOCK]
    return cut.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3))


def relative_rmse(candidate: np.ndarray, reference: np.ndarray) -> float:
    """Root of the summed squared difference over that of the reference."""
    return float(np.sqrt(((candidate - reference) ** 2).sum() / (reference**2).sum()))


def compare(candidate_path: Path, reference_path: Path) -> dict[str, float]:
    """How far a candidate is from a reference."""
    candidate, reference = read_exr(candidate_path), read_exr(reference_path)
    if candidate.shape != reference.shape:
        raise SystemExit(f"sizes differ: {candidate.shape} and {reference.shape}")
    return {
        "bias": float((candidate.sum() - reference.sum()) / reference.sum()),
        "rel_rmse": relative_rmse(candidate, reference),
        "block_rel_rmse": relative_rmse(block_means(candidate), block_means(reference)),
        "reference_mean": float(reference.mean()),
    }


def parse_size(text: str) -> tuple[int, int]:
    """WxH."""
    width, height = text.split("x")
    return int(width), int(height)


def parse_arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scene", type=Path, nargs="?", help="scene file")
    parser.add_argument("-o", "--output", type=Path, help="EXR to write")
    parser.add_argument("--size", type=parse_size, help="WxH; default: the scene file's")
    parser.add_argument("--spp", type=int, default=64, help="paths a pixel")
    parser.add_argument("--bounces", type=int, help="indirect bounces; default: the scene file's")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--compare", type=Path, nargs=2, metavar=("CANDIDATE", "REFERENCE"))
    arguments = parser.parse_args()
    if not arguments.compare and not (arguments.scene and arguments.output):
        parser.error("give a scene and -o, or --compare")
    return arguments


def main() -> int:
    """Renders or compares."""
    arguments = parse_arguments()
    if arguments.compare:
        print(json.dumps(compare(*arguments.compare)))
        return 0
    scene = load_scene(arguments.scene, arguments.size, arguments.spp, arguments.bounces)
    image = mi.render(scene, spp=arguments.spp, seed=arguments.seed)
    mi.Bitmap(image).write(str(arguments.output))
    return 0


if __name__ == "__main__":
    sys.exit(main())
