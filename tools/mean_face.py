"""Make the mean face that pliant ships: `python tools/mean_face.py`.

The landmark network, shown a plain grey picture, answers with what it expects of any face. Its answers to several
greys are aligned with one another and with their mirror images, so that their mean is symmetric, and brought into a
frame of centimetres: x to the viewer's right, y up, z towards the viewer. The width of a face, 14 cm, is assumed.

The triangles are made here too. Any triangulation of the 468 points whose boundaries are the outline (36 vertices), the
lids of either eye (16 each) and the inner lips (20) has 852 triangles, by Euler's formula. One half is triangulated in
the frontal view with the edges of the features kept, other edges are flipped until the surface bends least, and the
other half is its mirror image.
"""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
from scipy.optimize import linear_sum_assignment
from scipy.spatial import Delaunay
from scipy.spatial.distance import cdist

from pliant.face.networks import LANDMARKS, network
from pliant.shape.procrustes import align, generalized_procrustes, moved

WIDTH = 14.0  # centimetres, assumed
ROUNDNESS = 0.1  # centimetres of bent edge that a degenerate triangle is as bad as
FILE = Path(__file__).parents[1] / "src" / "pliant" / "face" / "mean_face.npz"

# Landmarks of the subject's right half, in the network's numbering; rings run around, chains along.
OUTLINE = (10, 109, 67, 103, 54, 21, 162, 127, 234, 93, 132, 58, 172, 136, 150, 149, 176, 148, 152)
EYE = (33, 7, 163, 144, 145, 153, 154, 155, 133, 173, 157, 158, 159, 160, 161, 246)
LIPS = (  # from the middle of the upper lip to that of the lower: outer edges first
    (0, 37, 39, 40, 185, 61, 146, 91, 181, 84, 17),
    (11, 72, 73, 74, 184, 76, 77, 90, 180, 85, 16),
    (12, 38, 41, 42, 183, 62, 96, 89, 179, 86, 15),
    (13, 82, 81, 80, 191, 78, 95, 88, 178, 87, 14),
)
MIDDLE_ABOVE = (10, 151, 9, 8, 168, 6, 197, 195, 5, 4, 1, 19, 94, 2, 164, 0, 11, 12, 13)
MIDDLE_BELOW = (14, 15, 16, 17, 18, 200, 199, 175, 152)
BROWS = (46, 53, 52, 65, 55), (70, 63, 105, 66, 107)
CORNERS = (33, 130), (133, 243)
Edge = tuple[int, int]
Triangle = tuple[int, int, int]


def main() -> None:
    """Write the file."""
    points, triangles, pairs = made()
    numbers = {"triangles": triangles.astype(np.int16), "pairs": pairs.astype(np.int16)}
    np.savez_compressed(FILE, points=points.round(5), **numbers)
    print(f"wrote {FILE.name}: {len(points)} points, {len(triangles)} triangles")


def made() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(468, 3) points, (852, 3) triangles, and (468,) the landmark opposite each."""
    points, pairs = symmetric(answers())
    points = in_frame(points)
    return points, whole(half(points, pairs), pairs), pairs


def answers() -> np.ndarray:
    """(17, 468, 3) what the network says of greys, y up and z towards the viewer."""
    look = network(LANDMARKS)
    greys = np.linspace(0, 1, 17)
    return np.array([look(np.full((look.size, look.size, 3), g))[0].reshape(-1, 3) for g in greys]) * [1.0, -1.0, -1.0]


def symmetric(shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(468, 3) the mean, symmetric about x = 0, and (468,) the landmark opposite each."""
    _, mean = generalized_procrustes(shapes, scale=True)
    flipped = mean * [-1, 1, 1]
    pairs = linear_sum_assignment(cdist(mean - mean.mean(axis=0), flipped - flipped.mean(axis=0)))[1]
    for _ in range(20):
        placed = moved(align(flipped[pairs], mean), flipped)
        pairs = linear_sum_assignment(cdist(mean, placed))[1]
    assert (pairs[pairs] == np.arange(len(pairs))).all()
    _, mean = generalized_procrustes(np.concatenate([shapes, (shapes * [-1, 1, 1])[:, pairs]]), scale=True)
    mirrored = (mean * [-1, 1, 1])[pairs]
    matrix = align(mirrored, mean)  # mirrors the mean onto itself: its plane is what stays
    normal = np.linalg.svd(matrix[:3, :3] @ np.diag([-1, 1, 1]) - np.eye(3))[0][:, 0]
    normal *= np.sign(normal[0])
    down = mean[152] - mean[10]
    up = -(down - normal * (down @ normal))
    axes = np.stack([normal, up / np.linalg.norm(up), np.cross(normal, up / np.linalg.norm(up))])
    turned = (mean - mean.mean(axis=0)) @ axes.T
    turned[:, 0] -= (turned[:, 0] + turned[pairs, 0]).mean() / 2
    return (turned + turned[pairs] * [-1, 1, 1]) / 2, pairs


def in_frame(points: np.ndarray) -> np.ndarray:
    """Centimetres, the forehead's top right above the chin's tip, the origin in the middle of the bounds."""
    points = points * WIDTH / np.ptp(points[:, 0])
    middle = (points.max(axis=0) + points.min(axis=0)) / 2
    return points - middle * [0, 1, 1]


def half(points: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """(426, 3) triangles of the subject's right half, which is on the viewer's left."""
    chosen = np.flatnonzero((points[:, 0] < 0) | (pairs == np.arange(len(pairs))))
    flat = frontal(points)[chosen]
    number = {int(vertex): at for at, vertex in enumerate(chosen)}
    chains = [OUTLINE, *LIPS, MIDDLE_ABOVE, MIDDLE_BELOW, (*EYE, EYE[0]), *BROWS, *CORNERS]
    wanted = {edge(number[a], number[b]) for chain in chains for a, b in itertools.pairwise(chain)}
    net = Net(Delaunay(flat).simplices, flat)
    net.include(wanted)
    border = [number[v] for v in (*OUTLINE, *MIDDLE_BELOW[-2::-1], *LIPS[-1][-2::-1], *MIDDLE_ABOVE[-2:0:-1])]
    net.cut(flat[border], flat[[number[v] for v in EYE]])
    return chosen[smoother(np.array(sorted(net.triangles)), points[chosen], wanted)]


def frontal(points: np.ndarray) -> np.ndarray:
    """(468, 2) where the viewer sees the points; sides turned outwards, and lips parted so that none hides another."""
    flat = points[:, :2] / (1 + points[:, 2:] / 40)
    outer = np.array(LIPS[0])
    middle = flat[[0, 17]].mean(axis=0)
    for chain, size in zip(LIPS[1:], (0.9, 0.8, 0.7), strict=True):
        flat[list(chain)] = middle + size * (flat[outer] - middle)
    return flat


class Net:
    """Triangles in the plane whose edges can be flipped."""

    def __init__(self, triangles: np.ndarray, flat: np.ndarray) -> None:
        self.flat = flat
        self.triangles: set[Triangle] = set()
        self.around: dict[Edge, set[Triangle]] = {}
        for row in triangles:
            self.add(tuple(int(v) for v in row))

    def add(self, triangle: Triangle) -> None:
        """Put a triangle in, counter-clockwise and its least vertex first."""
        a, b, c = triangle if turn(*self.flat[list(triangle)]) > 0 else triangle[::-1]
        first = min((a, b, c), (b, c, a), (c, a, b))
        self.triangles.add(first)
        for each in edges(first):
            self.around.setdefault(each, set()).add(first)

    def remove(self, triangle: Triangle) -> None:
        """Take a triangle out."""
        self.triangles.remove(triangle)
        for each in edges(triangle):
            self.around[each].remove(triangle)

    def diagonal(self, shared: Edge) -> Edge | None:
        """The other diagonal of the two triangles on an edge; None where it does not lie within them."""
        corners = [v for t in self.around[shared] for v in t if v not in shared]
        if len(corners) == 2 and crosses(self.flat[corners], self.flat[list(shared)]):
            return edge(*corners)
        return None

    def flip(self, shared: Edge) -> bool:
        """Exchange an edge for the other diagonal, where that is possible."""
        other = self.diagonal(shared)
        if other is None:
            return False
        for triangle in list(self.around[shared]):
            self.remove(triangle)
        for end in shared:
            self.add((end, *other))
        return True

    def include(self, wanted: set[Edge]) -> None:
        """Flip edges until all that are wanted are there (Sloan 1993)."""
        for segment in sorted(wanted):
            while not self.around.get(segment):
                ends = self.flat[list(segment)]
                apart = [e for e, t in self.around.items() if t and not set(e) & set(segment)]
                crossing = [e for e in sorted(apart) if crosses(self.flat[list(e)], ends)]
                if not any(self.flip(e) for e in crossing):
                    raise RuntimeError(f"edge {segment} cannot be brought in")

    def cut(self, border: np.ndarray, hole: np.ndarray) -> None:
        """Keep what lies within a border and outside a hole."""
        triangles = sorted(self.triangles)
        centers = self.flat[np.array(triangles)].mean(axis=1)
        kept = inside(centers, border) & ~inside(centers, hole)
        for triangle, keep in zip(triangles, kept, strict=True):
            if not keep:
                self.remove(triangle)


def smoother(triangles: np.ndarray, points: np.ndarray, fixed: set[Edge]) -> np.ndarray:
    """Triangles after flips of edges that are not fixed, while the surface bends less and its triangles grow rounder.

    The energy is the sum over edges of (1 - cos of the angle between the normals) times the length, and over triangles
    of ROUNDNESS times (1 - 4 sqrt(3) area / sum of squared sides).
    """
    beside = {(t[i - 1], t[i]): t for t in map(tuple, triangles.tolist()) for i in range(3)}

    def normal(t: Triangle) -> np.ndarray:
        a, b, c = points[list(t)]
        return np.cross(b - a, c - a)

    def bend(one: Triangle, two: Triangle, shared: Edge) -> float:
        m, n = normal(one), normal(two)
        return (1 - m @ n / np.sqrt((m @ m) * (n @ n))) * np.linalg.norm(points[shared[0]] - points[shared[1]])

    def thin(t: Triangle) -> float:
        sides = points[list(t)] - points[[t[1], t[2], t[0]]]
        return 1 - 2 * np.sqrt(3) * np.linalg.norm(normal(t)) / (sides**2).sum()

    def energy(pair: tuple[Triangle, Triangle], shared: Edge, without: tuple[Triangle, ...]) -> float:
        total = bend(*pair, shared) + ROUNDNESS * (thin(pair[0]) + thin(pair[1]))
        for t in pair:
            outer = ((each, beside.get(each[::-1])) for each in half_edges(t))
            total += sum(bend(t, other, each) for each, other in outer if other is not None and other not in without)
        return total

    better = True
    while better:
        better = False
        for a, b in sorted(beside):
            if a > b or (b, a) not in beside or (a, b) in fixed:
                continue
            old = beside[a, b], beside[b, a]
            c, d = (next(v for v in t if v not in (a, b)) for t in old)
            new = (a, d, c), (d, b, c)
            if (c, d) in beside or (d, c) in beside or energy(new, (c, d), old) >= energy(old, (a, b), old) - 1e-9:
                continue
            for each in [each for t in old for each in half_edges(t)]:
                del beside[each]
            beside |= {each: t for t in new for each in half_edges(t)}
            better = True
    least_first = {min(t, (*t[1:], t[0]), (t[2], *t[:2])) for t in beside.values()}
    return np.array(sorted(least_first))


def half_edges(triangle: Triangle) -> list[Edge]:
    """The three edges of a triangle in its own direction."""
    a, b, c = triangle
    return [(a, b), (b, c), (c, a)]


def edge(a: int, b: int) -> Edge:
    """Two vertices, the lower first."""
    return (a, b) if a < b else (b, a)


def edges(triangle: Triangle) -> list[Edge]:
    """The three edges of a triangle, the lower vertex of each first."""
    return [edge(*each) for each in half_edges(triangle)]


def crosses(one: np.ndarray, two: np.ndarray) -> bool:
    """Whether two segments (2, 2) cross, inside both."""
    return all(turn(p, q, r) * turn(p, q, s) < 0 for (p, q), (r, s) in ((one, two), (two, one)))


def turn(p: np.ndarray, q: np.ndarray, r: np.ndarray) -> float:
    """Twice the signed area of a triangle: above zero where it is counter-clockwise."""
    return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))


def inside(points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    """Which points lie in a polygon: a ray crosses it an odd number of times."""
    x, y = points.T[:, :, None]
    (ax, ay), (bx, by) = polygon.T, np.roll(polygon, -1, axis=0).T
    with np.errstate(divide="ignore", invalid="ignore"):
        hits = ((ay > y) != (by > y)) & (x < (bx - ax) * (y - ay) / (by - ay) + ax)
    return hits.sum(axis=1) % 2 == 1


def whole(right: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """(852, 3) a half and its mirror image."""
    return np.vstack([right, pairs[right][:, ::-1]])


if __name__ == "__main__":
    main()
