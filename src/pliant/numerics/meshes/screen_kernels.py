"""Kernels for a depth picture: what lies in front, pixel by pixel."""

from __future__ import annotations

import math

import numpy as np

from pliant.numerics.compute.compiling import kernel


@kernel
def cover(pixels, triangles, depth):
    """Lower ``depth`` (rows, columns) to the triangles (t, 3) of vertices ``pixels`` (n, 3): column, row, depth."""
    rows, columns = depth.shape
    for t in range(len(triangles)):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax, ay, bx, by = pixels[a, 0], pixels[a, 1], pixels[b, 0], pixels[b, 1]
        cx, cy = pixels[c, 0], pixels[c, 1]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area == 0.0:
            continue
        left = max(0, math.ceil(min(ax, bx, cx)))
        right = min(columns - 1, math.floor(max(ax, bx, cx)))
        low = max(0, math.ceil(min(ay, by, cy)))
        high = min(rows - 1, math.floor(max(ay, by, cy)))
        for y in range(low, high + 1):
            for x in range(left, right + 1):
                u = ((bx - x) * (cy - y) - (by - y) * (cx - x)) / area
                v = ((cx - x) * (ay - y) - (cy - y) * (ax - x)) / area
                w = 1.0 - u - v
                if u >= 0.0 and v >= 0.0 and w >= 0.0:
                    z = u * pixels[a, 2] + v * pixels[b, 2] + w * pixels[c, 2]
                    depth[y, x] = min(depth[y, x], z)


@kernel
def hidden(pixels, depth, slack):
    """(n,) which vertices lie behind the nearest picture element, and its neighbours, by more than ``slack``."""
    result = np.zeros(len(pixels), np.bool_)
    rows, columns = depth.shape
    for i in range(len(pixels)):
        x, y = pixels[i, 0], pixels[i, 1]
        if not (0.0 <= x <= columns - 1.0 and 0.0 <= y <= rows - 1.0):
            continue
        farthest = -np.inf
        for row in range(int(y), min(int(y) + 2, rows)):
            for column in range(int(x), min(int(x) + 2, columns)):
                farthest = max(farthest, depth[row, column])
        result[i] = pixels[i, 2] > farthest + slack
    return result
