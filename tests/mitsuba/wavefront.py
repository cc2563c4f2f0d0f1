"""Reads OBJ and MTL files: triangles by material, with normals and coordinates."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

# Numbers that follow an option of a texture statement, at most.
OPTION_NUMBERS = 3


@dataclass
class TextureMap:
    """An image that multiplies a colour; coordinates are scaled, then moved."""

    path: Path
    scale: list[float]
    offset: list[float]


@dataclass
class Material:
    """What MTL says about a surface, linear RGB; `None` where it says nothing."""

    albedo: list[float] | None = None
    emission: list[float] | None = None
    albedo_map: TextureMap | None = None
    emission_map: TextureMap | None = None


@dataclass
class Triangles:
    """Corners of one material: positions and normals (count, 3, 3), coordinates (count, 3, 2)."""

    positions: np.ndarray
    normals: np.ndarray
    coordinates: np.ndarray


@dataclass
class Obj:
    """Fans of an OBJ file; corners are (position, coordinate or -1, normal or -1), from 0."""

    positions: np.ndarray
    coordinates: np.ndarray
    normals: np.ndarray
    fans: dict[str, list[list[tuple[int, int, int]]]]
    materials: dict[str, Material]


def is_number(word: str) -> bool:
    """Whether a word reads as a number."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def read_map(words: list[str], folder: Path) -> TextureMap:
    """A texture statement: `-s u v w` and `-o u v w`, then the file."""
    result = TextureMap(folder, [1.0, 1.0], [0.0, 0.0])
    while words[0] in ("-s", "-o"):
        option, words = words[0], words[1:]
        numbers: list[float] = []
        while is_number(words[0]) and len(numbers) < OPTION_NUMBERS:
            numbers.append(float(words[0]))
            words = words[1:]
        default = result.scale if option == "-s" else result.offset
        given = [numbers[axis] if axis < len(numbers) else default[axis] for axis in range(2)]
        if option == "-s":
            result.scale = given
        else:
            result.offset = given
    if words[0].startswith("-"):
        raise SystemExit(f"{folder}: texture option {words[0]} is not supported")
    result.path = folder / " ".join(words)
    return result


def read_mtl(path: Path) -> dict[str, Material]:
    """Materials of an MTL file by name."""
    materials: dict[str, Material] = {}
    current = Material()
    for line in path.read_text().splitlines():
        keyword, *words = line.split() or [""]
        if keyword == "newmtl":
            current = materials.setdefault(" ".join(words), Material())
        elif keyword == "Kd":
            current.albedo = [float(word) for word in words[:3]]
        elif keyword == "Ke":
            current.emission = [float(word) for word in words[:3]]
        elif keyword == "map_Kd":
            current.albedo_map = read_map(words, path.parent)
        elif keyword == "map_Ke":
            current.emission_map = read_map(words, path.parent)
    return materials


def read_corner(word: str, counts: tuple[int, int, int]) -> tuple[int, int, int]:
    """Indices from 0 of `v`, `v/vt`, `v//vn` or `v/vt/vn`; -1 where there is none."""
    parts = [int(part) if part else 0 for part in word.split("/")]
    parts += [0] * (3 - len(parts))
    position, coordinate, normal = (
        part - 1 if part >= 0 else count + part for part, count in zip(parts, counts)
    )
    return position, coordinate, normal


def read_obj(path: Path) -> Obj:
    """Triangles of an OBJ file, polygons split from their first corner."""
    materials: dict[str, Material] = {}
    fans: dict[str, list[list[tuple[int, int, int]]]] = {}
    positions: list[list[float]] = []
    coordinates: list[list[float]] = []
    normals: list[list[float]] = []
    fan = fans.setdefault("", [])
    for line in path.read_text().splitlines():
        keyword, *words = line.split() or [""]
        if keyword == "v":
            positions.append([float(word) for word in words[:3]])
        elif keyword == "vt":
            coordinates.append([float(word) for word in words[:2]])
        elif keyword == "vn":
            normals.append([float(word) for word in words])
        elif keyword == "usemtl":
            fan = fans.setdefault(" ".join(words), [])
        elif keyword == "mtllib":
            materials |= read_mtl(path.parent / " ".join(words))
        elif keyword == "f":
            counts = (len(positions), len(coordinates), len(normals))
            corners = [read_corner(word, counts) for word in words]
            fan.extend([corners[0], b, c] for b, c in zip(corners[1:], corners[2:]))
    return Obj(
        np.array(positions),
        np.array(coordinates or [[0.0, 0.0]]),
        np.array(normals or [[0.0, 0.0, 1.0]]),
        fans,
        materials,
    )


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
        has_normals = (corners[..., 2] >= 0).all(axis=1)
        given = obj.normals[np.maximum(corners[..., 2], 0)]
        normals = np.where(has_normals[:, None, None], given, normals)
    coordinates = obj.coordinates[np.maximum(corners[..., 1], 0)]
    if has_map(obj.materials.get(name)) and (corners[..., 1] < 0).any():
        raise SystemExit(f"material {name} has a texture, but triangles without coordinates")
    unit_normals = normals / np.linalg.norm(normals, axis=2, keepdims=True)
    return Triangles(positions, unit_normals, coordinates)


def has_map(material: Material | None) -> bool:
    """Whether a material needs texture coordinates."""
    return material is not None and bool(material.albedo_map or material.emission_map)
