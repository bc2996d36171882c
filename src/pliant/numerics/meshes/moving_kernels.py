"""Vertices of an enclosing surface moved, and its edges flipped, where what comes of it may stand."""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import called, kernel
from pliant.numerics.meshes.box_trees import set_box
from pliant.numerics.meshes.enclosing_kernels import MOST, may_stand, plane_of

_TURN = 0.15
_LEVEL = 0.4  # the least cosine between a face of a flipped edge and the two that were there


@called
def _taken(v, points, faces, around, valence, gone, mark, corners, ids, before):
    """The faces around a vertex, as they are."""
    for n in range(valence[v]):
        f = around[v, n]
        gone[f] = mark
        for k in range(3):
            ids[n, k] = faces[f, k]
            corners[n, k] = points[faces[f, k]]
        plane_of(corners[n, 0], corners[n, 1], corners[n, 2], before[n])


@kernel
def move_vertices(points, faces, boxes, around, valence, goals, mesh, mesh_boxes, room, halvings):
    """Move each vertex to its goal, or part of the way; how far the farthest went."""
    gone, mark = np.zeros(len(faces), np.int64), 0
    stack, found = np.empty(128, np.int64), np.empty(max(len(boxes), len(mesh_boxes)), np.int64)
    corners, ids, before = np.empty((MOST, 3, 3)), np.empty((MOST, 3), np.int64), np.empty((MOST, 3))
    farthest = 0.0
    for v in range(len(points)):
        away = goals[v] - points[v]
        length = np.sqrt((away**2).sum())
        if valence[v] == 0 or length == 0.0:
            continue
        mark += 1
        _taken(v, points, faces, around, valence, gone, mark, corners, ids, before)
        part = 1.0
        for _ in range(halvings):
            for n in range(valence[v]):
                for k in range(3):
                    if ids[n, k] == v:
                        corners[n, k] = points[v] + part * away
            if may_stand(
                corners[: valence[v]], ids, before, _TURN, gone, mark, points, faces, boxes, mesh, mesh_boxes, room,
                stack, found,
            ):  # fmt: skip
                points[v] += part * away
                for n in range(valence[v]):
                    set_box(boxes, around[v, n], corners[n, 0], corners[n, 1], corners[n, 2], False)
                farthest = max(farthest, part * length)
                break
            part *= 0.5
    return farthest


@called
def _beyond(faces, f, a, b):
    """The corner of a face that is neither of two; -1 where it has not both."""
    other, met = -1, 0
    for k in range(3):
        if faces[f, k] == a or faces[f, k] == b:
            met += 1
        else:
            other = faces[f, k]
    return other if met == 2 else -1


@called
def _least_angle(a, b, c):
    """The largest cosine of a triangle's angles."""
    one, two, three = 0.0, 0.0, 0.0
    for i in range(3):
        one += (b[i] - a[i]) ** 2
        two += (c[i] - b[i]) ** 2
        three += (a[i] - c[i]) ** 2
    first = (one + three - two) / max(2 * np.sqrt(one * three), 1e-300)
    second = (one + two - three) / max(2 * np.sqrt(one * two), 1e-300)
    third = (two + three - one) / max(2 * np.sqrt(two * three), 1e-300)
    return max(first, second, third)


@called
def _swap(around, valence, vertex, less, more):
    """Take one face from those around a vertex, or, where there is none to take, add another one."""
    if less < 0:
        around[vertex, valence[vertex]] = more
        valence[vertex] += 1
        return
    for at in range(valence[vertex]):
        if around[vertex, at] == less:
            valence[vertex] -= 1
            around[vertex, at] = around[vertex, valence[vertex]]
            return


@called
def _across(faces, around, valence, f, a, b):
    """The other face of an edge."""
    for at in range(valence[a]):
        if around[a, at] != f and _beyond(faces, around[a, at], a, b) >= 0:
            return around[a, at]
    return f


@called
def _joined(faces, around, valence, c, d):
    """Whether two vertices have an edge."""
    for at in range(valence[c]):  # noqa: SIM110
        if _beyond(faces, around[c, at], c, d) >= 0:
            return True
    return False


@called
def _crowded(around, valence, a, b, c, d):
    """Whether an edge from a to b cannot become one from c to d: too few faces would be left, or too many."""
    most = around.shape[1] - 1
    return c == d or valence[a] <= 3 or valence[b] <= 3 or valence[c] >= most or valence[d] >= most


@called
def _between(points, a, b, c, d, before):
    """The mean normal of the two faces of an edge."""
    one, two = np.empty(3), np.empty(3)
    plane_of(points[a], points[b], points[c], one)
    plane_of(points[b], points[a], points[d], two)
    one += two
    before[:] = one / max(np.sqrt((one**2).sum()), 1e-300)


@kernel
def flip_edges(points, faces, boxes, around, valence, ring, following, mesh, mesh_boxes, room, gain):
    """Flip edges where the least angle becomes larger, its cosine by ``gain``; how many were."""
    gone, mark, count = np.zeros(len(faces), np.int64), 0, 0
    stack, found = np.empty(128, np.int64), np.empty(max(len(boxes), len(mesh_boxes)), np.int64)
    corners, ids, before = np.empty((2, 3, 3)), np.empty((2, 3), np.int64), np.empty((2, 3))
    for half in range(3 * len(faces)):
        f, side = half // 3, half % 3
        a, b, c = faces[f, side], faces[f, (side + 1) % 3], faces[f, (side + 2) % 3]
        if a < 0 or (ring[a] >= 0 and ring[b] >= 0 and (following[a] == b or following[b] == a)):
            continue
        g = _across(faces, around, valence, f, a, b)
        d = _beyond(faces, g, a, b)
        if _crowded(around, valence, a, b, c, d) or _joined(faces, around, valence, c, d):
            continue
        now = max(_least_angle(points[a], points[b], points[c]), _least_angle(points[a], points[b], points[d]))
        then = max(_least_angle(points[a], points[d], points[c]), _least_angle(points[d], points[b], points[c]))
        if then > now - gain:
            continue
        ids[0, 0], ids[0, 1], ids[0, 2] = a, d, c
        ids[1, 0], ids[1, 1], ids[1, 2] = d, b, c
        for n in range(2):
            _between(points, a, b, c, d, before[n])
            for k in range(3):
                corners[n, k] = points[ids[n, k]]
        mark += 1
        gone[f] = gone[g] = mark
        if not may_stand(
            corners, ids, before, _LEVEL, gone, mark, points, faces, boxes, mesh, mesh_boxes, room, stack, found
        ):
            continue
        faces[f], faces[g] = ids[0], ids[1]
        _swap(around, valence, a, g, -1)
        _swap(around, valence, b, f, -1)
        _swap(around, valence, c, -1, g)
        _swap(around, valence, d, -1, f)
        set_box(boxes, f, corners[0, 0], corners[0, 1], corners[0, 2], False)
        set_box(boxes, g, corners[1, 0], corners[1, 1], corners[1, 2], False)
        count += 1
    return count
