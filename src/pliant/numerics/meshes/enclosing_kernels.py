"""What every change of an enclosing surface asks: whether these faces may stand where those stood.

A surface that encloses a mesh and does not cut itself stays so, whatever is done to it, as long as each change puts
faces there that cut neither the mesh nor any other face: nothing has to be verified and mended afterwards.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import called
from pliant.numerics.meshes.box_trees import boxes_near
from pliant.numerics.meshes.crossing_kernels import edge_through

FLAT = 3e-3  # a face's height over its longest side, at the least
_FOLDED = -0.97  # the cosine between two faces that lie on one another, nearly
MOST = 128  # faces that may change at once


@called
def plane_of(a, b, c, normal):
    """Twice the area of a triangle over its longest side squared; ``normal`` gets its unit normal."""
    longest = 0.0
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j])
    one, two, three = 0.0, 0.0, 0.0
    for i in range(3):
        one += (b[i] - a[i]) ** 2
        two += (c[i] - b[i]) ** 2
        three += (a[i] - c[i]) ** 2
    longest = max(one, two, three)
    size = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    for i in range(3):
        normal[i] /= max(size, 1e-300)
    return size / max(longest, 1e-300)


@called
def _apart(one, two):
    """Whether the boxes of two triangles do not meet."""
    for i in range(3):
        if max(one[0, i], one[1, i], one[2, i]) < min(two[0, i], two[1, i], two[2, i]):
            return True
        if max(two[0, i], two[1, i], two[2, i]) < min(one[0, i], one[1, i], one[2, i]):
            return True
    return False


@called
def _cut(one, one_ids, two, two_ids):
    if _apart(one, two):
        return False
    return edge_through(one, one_ids, two, two_ids) or edge_through(two, two_ids, one, one_ids)


@called
def _folded(one_ids, two, two_ids, normal, other):
    """Whether two faces share an edge and turn back on one another; ``normal`` is that of the first."""
    shared = 0
    for k in range(3):
        for n in range(3):
            shared += one_ids[k] == two_ids[n]
    if shared != 2:
        return False
    plane_of(two[0], two[1], two[2], other)
    return normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2] < _FOLDED


@called
def _well_shaped(corners, before, turn, normal):
    """Whether faces have some height, and look where those looked that they replace."""
    for n in range(len(corners)):
        if plane_of(corners[n, 0], corners[n, 1], corners[n, 2], normal) < FLAT:
            return False
        if normal[0] * before[n, 0] + normal[1] * before[n, 1] + normal[2] * before[n, 2] < turn:
            return False
    return True


@called
def _meets_others(n, corners, ids, normal):
    """Whether a face cuts one of those before it, or lies on it."""
    other = np.empty(3)
    for m in range(n):
        if _folded(ids[n], corners[m], ids[m], normal, other) or _cut(corners[n], ids[n], corners[m], ids[m]):
            return True
    return False


@called
def _meets_surface(face, its, normal, near, gone, mark, points, faces):
    """Whether a face cuts one of the surface, or lies on it."""
    other, corners = np.empty(3), np.empty((3, 3))
    for f in near:
        if gone[f] == mark:
            continue
        for k in range(3):
            for i in range(3):
                corners[k, i] = points[faces[f, k], i]
        if _folded(its, corners, faces[f], normal, other) or _cut(face, its, corners, faces[f]):
            return True
    return False


@called
def may_stand(corners, ids, before, turn, gone, mark, points, faces, boxes, mesh, mesh_boxes, room, stack, found):
    """Whether faces cut neither the mesh, nor other faces, nor one another, keep their room, and have not turned over.

    Parameters
    ----------
    corners, ids, before
        (k, 3, 3) the faces, (k, 3) their vertices, (k, 3) unit normals of those whose places they take.
    turn
        The least cosine between a face and what was there before.
    gone, mark
        (f,) faces that are to be left out have this mark.
    points, faces, boxes
        The surface as it is, and its tree.
    mesh, mesh_boxes, room
        (t, 3, 3) what is enclosed, its tree, and how far behind each face it shall be.
    stack, found
        Room to work in.
    """
    normal, box = np.empty(3), np.empty(6)
    behind, none = np.empty((3, 3)), np.full(3, -1)
    if not _well_shaped(corners, before, turn, normal):
        return False
    for n in range(len(corners)):
        face = corners[n]
        plane_of(face[0], face[1], face[2], normal)
        for i in range(3):
            for k in range(3):
                behind[k, i] = face[k, i] - room * normal[i]
            box[i] = min(face[0, i], face[1, i], face[2, i], behind[0, i], behind[1, i], behind[2, i])
            box[3 + i] = max(face[0, i], face[1, i], face[2, i], behind[0, i], behind[1, i], behind[2, i])
        height = normal[0] * face[0, 0] + normal[1] * face[0, 1] + normal[2] * face[0, 2]
        slack = 1e-9 * room + 1e-12 * abs(height)
        if _meets_others(n, corners, ids, normal):
            return False
        for at in range(boxes_near(mesh_boxes, box, normal, height - room - slack, height + slack, stack, found)):
            near = mesh[found[at]]
            if _cut(face, ids[n], near, none) or _cut(behind, ids[n], near, none):
                return False
        count = boxes_near(boxes, box, normal, height - slack, height + slack, stack, found)
        if _meets_surface(face, ids[n], normal, found[:count], gone, mark, points, faces):
            return False
    return True
