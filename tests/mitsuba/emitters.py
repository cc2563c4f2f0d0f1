"""The lights of a relume scene file as Mitsuba emitters and shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mitsuba as mi
import numpy as np


def rgb(values: list[float]) -> dict[str, Any]:
    """A linear Rec.709 colour."""
    return {"type": "rgb", "value": [float(value) for value in values]}


def read_rgb(path: Path) -> np.ndarray:
    """Linear RGB of an image, (height, width, 3); 8-bit files are decoded from sRGB."""
    bitmap = mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)
    return np.array(bitmap)


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


def rectangle(light: dict[str, Any]) -> dict[str, Any]:
    """A black parallelogram; Mitsuba's square from -1 to 1 emits along +z."""
    corner, u, v = (np.array(light[key], dtype=float) for key in ("corner", "edge_u", "edge_v"))
    normal = np.cross(u, v)
    world_from_square = np.eye(4)
    world_from_square[:3, 0] = 0.5 * u
    world_from_square[:3, 1] = 0.5 * v
    world_from_square[:3, 2] = normal / np.linalg.norm(normal)
    world_from_square[:3, 3] = corner + 0.5 * (u + v)
    return {
        "type": "rectangle",
        "to_world": mi.ScalarTransform4f(world_from_square),
        "bsdf": {"type": "diffuse", "reflectance": rgb([0.0, 0.0, 0.0])},
        "emitter": {"type": "area", "radiance": rgb(light["radiance"])},
    }


def rows_at_mitsubas_places(texels: np.ndarray) -> np.ndarray:
    """The same bilinear map with rows where Mitsuba has them.

    Texel centres of a scene file's map are at (i + 0.5) / n and the outermost
    rows go on to the poles. Mitsuba has such columns, but row i of n at
    i / (n - 1). With 2 n + 1 rows each bend of the first kind is a row of the
    second, so nothing is blurred.
    """
    height = len(texels)
    place = np.clip(np.arange(2 * height + 1) / 2.0 - 0.5, 0.0, height - 1.0)
    above = np.floor(place).astype(int)
    below = np.minimum(above + 1, height - 1)
    share = (place - above)[:, None, None]
    return texels[above] * (1.0 - share) + texels[below] * share


def environment(light: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A sky: one radiance, or a latitude-longitude map.

    Mitsuba's u is atan2(d.x, -d.z) / 2 pi too, v = 0 the zenith. The scene
    file's rotation adds to u, which grows from -z to +x: the map turns by the
    same angle from +z to +x, the positive sense about +y.
    """
    scale = float(light.get("scale", 1.0))
    if "map" not in light:
        return {"type": "constant", "radiance": rgb([scale * x for x in light["radiance"]])}
    texels = rows_at_mitsubas_places(read_rgb(folder / light["map"]))
    turn = float(light.get("rotation", 0.0))
    return {
        "type": "envmap",
        "bitmap": mi.Bitmap(texels.astype(np.float32)),
        "scale": scale,
        "to_world": mi.ScalarTransform4f().rotate([0.0, 1.0, 0.0], turn),
    }


def emitter(light: dict[str, Any], folder: Path) -> dict[str, Any]:
    """A light of the scene file in `folder`."""
    kind = light["kind"]
    if kind == "point":
        position = [float(value) for value in light["position"]]
        return {"type": "point", "position": position, "intensity": rgb(light["intensity"])}
    if kind == "spot":
        return spot(light)
    if kind == "area":
        return rectangle(light)
    if kind == "environment":
        return environment(light, folder)
    if kind == "directional":
        direction = [float(value) for value in light["direction"]]
        return {
            "type": "directional",
            "direction": direction,
            "irradiance": rgb(light["irradiance"]),
        }
    raise SystemExit(f"light kind {kind} is not supported")
