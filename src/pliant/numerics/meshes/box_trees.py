"""Boxes around triangles, in a balanced binary tree that can be changed: what is near to a box is found in few steps.

A tree is one array: node ``i`` has the children ``2 i`` and ``2 i + 1``, node 1 is the root, and the last half are the
leaves, one for each triangle. An empty box is one whose low corner is above its high one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.compiling import called

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_BITS = 10


def space_order(points: Floats, triangles: NDArray[np.integer]) -> Indices:
    """(t,) an order of triangles in which neighbours are near in space (Morton's)."""
    middle = points[triangles].mean(axis=1)
    low, high = middle.min(axis=0), middle.max(axis=0)
    cells = ((middle - low) / np.maximum(high - low, 1e-300) * (2**_BITS - 1)).astype(np.int64)
    code = np.zeros(len(cells), np.int64)
    for bit in range(_BITS):
        for axis in range(3):
            code |= ((cells[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable")


def box_tree(points: Floats, triangles: NDArray[np.integer]) -> Floats:
    """(2 m, 6) low and high corners of the nodes above triangles, m a power of two."""
    leaves = 1 << max(int(len(triangles) - 1).bit_length(), 0)
    boxes = np.full((2 * leaves, 6), np.inf)
    boxes[:, 3:] = -np.inf
    corners = points[triangles]
    boxes[leaves : leaves + len(triangles), :3] = corners.min(axis=1)
    boxes[leaves : leaves + len(triangles), 3:] = corners.max(axis=1)
    while leaves > 1:
        pairs = boxes[leaves : 2 * leaves].reshape(-1, 2, 6)
        leaves //= 2
        boxes[leaves : 2 * leaves, :3] = pairs[:, :, :3].min(axis=1)
        boxes[leaves : 2 * leaves, 3:] = pairs[:, :, 3:].max(axis=1)
    return boxes


@called
def boxes_near(boxes, box, normal, low, high, stack, found):
    """How many leaves meet a box, and the layer where the product with a normal is between two heights.

    ``found``, which holds as many as there are leaves, gets them.
    """
    leaves = len(boxes) // 2
    count, top = 0, 1
    stack[0] = 1
    while top:
        top -= 1
        node = stack[top]
        apart = False
        for i in range(3):
            apart = apart or boxes[node, i] > box[3 + i] or boxes[node, 3 + i] < box[i]
        if apart:
            continue
        least, most = 0.0, 0.0
        for i in range(3):
            one, two = normal[i] * boxes[node, i], normal[i] * boxes[node, 3 + i]
            least += min(one, two)
            most += max(one, two)
        if least > high or most < low:
            continue
        if node >= leaves:
            found[count] = node - leaves
            count += 1
        else:
            stack[top], stack[top + 1] = 2 * node, 2 * node + 1
            top += 2
    return count


@called
def set_box(boxes, leaf, a, b, c, empty):
    """Another triangle, or none, in a leaf, and what that means for the nodes above."""
    node = len(boxes) // 2 + leaf
    for i in range(3):
        boxes[node, i] = np.inf if empty else min(a[i], b[i], c[i])
        boxes[node, 3 + i] = -np.inf if empty else max(a[i], b[i], c[i])
    node //= 2
    while node:
        for i in range(3):
            boxes[node, i] = min(boxes[2 * node, i], boxes[2 * node + 1, i])
            boxes[node, 3 + i] = max(boxes[2 * node, 3 + i], boxes[2 * node + 1, 3 + i])
        node //= 2
