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
from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np

from emitters import emitter, read_rgb, rgb
from wavefront import Material, TextureMap, Triangles, read_obj, triangles_of

mi.set_variant("scalar_rgb")

# Side of the squares over which the blockwise error takes its means: large
# enough to average the noise of single pixels away.
BLOCK = 8
# Paths are never ended at random, so that the noise stays low in corners.
NO_RUSSIAN_ROULETTE = 10_000
# Of a material that says nothing.
DEFAULT_ALBEDO = [0.8, 0.8, 0.8]


def texture(color: list[float], image: TextureMap) -> dict[str, Any]:
    """A colour times an image, which Mitsuba interpolates and repeats."""
    texels = read_rgb(image.path) * np.array(color, dtype=np.float32)
    return {
        "type": "bitmap",
        "bitmap": mi.Bitmap(texels.astype(np.float32)),
        # The values are linear already.
        "raw": True,
        "filter_type": "bilinear",
        "wrap_mode": "repeat",
    }


def colored(color: list[float] | None, default: list[float], image: TextureMap | None) -> Any:
    """A colour, or an image times it; beside an image no colour and black mean 1."""
    if image is None:
        return rgb(default if color is None else color)
    return texture(color if any(color or []) else [1.0, 1.0, 1.0], image)


def image_coordinates(coordinates: np.ndarray, image: TextureMap | None) -> np.ndarray:
    """Coordinates with v = 0 at the top row, as Mitsuba has them."""
    if image is not None:
        coordinates = coordinates * np.array(image.scale) + np.array(image.offset)
    return np.stack([coordinates[..., 0], 1.0 - coordinates[..., 1]], axis=-1)


def shape(triangles: Triangles, material: Material) -> mi.Mesh:
    """A Mitsuba mesh that is diffuse on both sides and emits on its front."""
    properties = mi.Properties()
    albedo = colored(material.albedo, DEFAULT_ALBEDO, material.albedo_map)
    bsdf = {"type": "diffuse", "reflectance": albedo}
    properties["bsdf"] = mi.load_dict({"type": "twosided", "nested": bsdf})
    if material.emission_map is not None or any(material.emission or []):
        radiance = colored(material.emission, [0.0] * 3, material.emission_map)
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": radiance})
    count = len(triangles.positions)
    mesh = mi.Mesh(
        "mesh",
        3 * count,
        count,
        props=properties,
        has_vertex_normals=True,
        has_vertex_texcoords=True,
    )
    coordinates = image_coordinates(
        triangles.coordinates, material.albedo_map or material.emission_map
    )
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = triangles.positions.ravel()
    parameters["vertex_normals"] = triangles.normals.ravel()
    parameters["vertex_texcoords"] = coordinates.ravel()
    parameters["faces"] = np.arange(3 * count, dtype=np.uint32)
    parameters.update()
    return mesh


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
        scene[f"light{index}"] = emitter(light, path.parent)
    return mi.load_dict(scene)


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
    candidate, reference = (
        read_rgb(path).astype(np.float64) for path in (candidate_path, reference_path)
    )
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
