"""Edges of an enclosing surface collapsed by quadric errors (Garland & Heckbert 1997), rings kept in their planes."""

from __future__ import annotations

import heapq

import numpy as np

from pliant.numerics.compute.compiling import called, kernel
from pliant.numerics.meshes.box_trees import set_box
from pliant.numerics.meshes.enclosing_kernels import MOST, may_stand, plane_of

CHOICES = 8  # places that are tried for what an edge becomes
VALENCE = 64  # faces around a vertex, at the most
_NEW, _ANY = -2, -1  # edges whose error is not known, or whose place is not: else the number of the place
_TURN = 0.15
_EAGER = 0.02  # how much cheaper rings are simplified than what is between them


@called
def _error(q, p):
    x, y, z = p[0], p[1], p[2]
    return (
        q[0] * x * x + 2 * q[1] * x * y + 2 * q[2] * x * z + q[3] * y * y + 2 * q[4] * y * z + q[5] * z * z
        + 2 * (q[6] * x + q[7] * y + q[8] * z) + q[9]
    )  # fmt: skip


@called
def _lowest(q, p):
    """Where a quadric is least, by Cramer's rule; whether it is anywhere."""
    c0, c1, c2 = q[3] * q[5] - q[4] * q[4], q[2] * q[4] - q[1] * q[5], q[1] * q[4] - q[2] * q[3]
    whole = q[0] * c0 + q[1] * c1 + q[2] * c2
    size = q[0] + q[3] + q[5]
    if whole <= 1e-9 * size * size * size:
        return False
    c4, c5, c8 = q[0] * q[5] - q[2] * q[2], q[1] * q[2] - q[0] * q[4], q[0] * q[3] - q[1] * q[1]
    p[0] = -(c0 * q[6] + c1 * q[7] + c2 * q[8]) / whole
    p[1] = -(c1 * q[6] + c4 * q[7] + c5 * q[8]) / whole
    p[2] = -(c2 * q[6] + c5 * q[7] + c8 * q[8]) / whole
    return True


@called
def _places_on_a_ring(u, v, points, target, places):
    """From a corner to the middle of an edge of its ring, and its ends."""
    for c in range(CHOICES - 2):
        part = 1.0 - c / (CHOICES - 3)
        for i in range(3):
            places[c, i] = part * target[i] + (1.0 - part) * 0.5 * (points[u, i] + points[v, i])
    for i in range(3):
        places[CHOICES - 2, i], places[CHOICES - 1, i] = points[u, i], points[v, i]


@called
def _places_beside_a_ring(v, points, normal, outwards, reach, places):
    """A vertex of a ring, and farther out in its plane."""
    along = normal[0] * outwards[0] + normal[1] * outwards[1] + normal[2] * outwards[2]
    for c in range(CHOICES):
        far = 0.0 if c == 0 else reach * 2.0 ** (c - 5)
        for i in range(3):
            places[c, i] = points[v, i] + far * (outwards[i] - along * normal[i])


@called
def _places_between(u, v, points, q, outwards, reach, places):
    """Where the error is least, the middle and the ends of an edge, and farther out."""
    best = places[0]
    found = _lowest(q, best)
    length, away = 0.0, 0.0
    for i in range(3):
        places[1, i], places[2, i], places[3, i] = 0.5 * (points[u, i] + points[v, i]), points[v, i], points[u, i]
        length += (points[u, i] - points[v, i]) ** 2
        away += (best[i] - places[1, i]) ** 2
    for i in range(3):
        if not found or away > 2 * length:
            best[i] = places[1, i]
    for c in range(4, CHOICES):
        for i in range(3):
            places[c, i] = best[i] + reach * 2.0 ** (c - 5) * outwards[i]


@called
def _places(u, v, points, quadrics, ring, sector, targets, planes, outwards, reach, places, q):
    """The places that are tried, best first, and by how much errors count."""
    for i in range(10):
        q[i] = quadrics[u, i] + quadrics[v, i]
    if ring[u] >= 0 and ring[v] >= 0:
        _places_on_a_ring(u, v, points, targets[sector[v]], places)
        return _EAGER
    if ring[v] >= 0:
        _places_beside_a_ring(v, points, planes[ring[v]], outwards, reach, places)
    else:
        _places_between(u, v, points, q, outwards, reach, places)
    return 1.0


@called
def _linked(u, v, faces, around, valence, seen, mark):
    """How many vertices are joined to both ends of an edge."""
    for at in range(valence[u]):
        for k in range(3):
            seen[faces[around[u, at], k]] = mark
    count = 0
    seen[u] = seen[v] = mark + 1
    for at in range(valence[v]):
        for k in range(3):
            w = faces[around[v, at], k]
            if seen[w] == mark:
                seen[w] = mark + 1
                count += 1
    return count


@called
def _outwards(u, v, points, faces, around, valence, outwards):
    """The mean unit normal around an edge."""
    outwards[0] = outwards[1] = outwards[2] = 0.0
    normal = np.empty(3)
    for end in (u, v):
        for at in range(valence[end]):
            f = around[end, at]
            plane_of(points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]], normal)
            for i in range(3):
                outwards[i] += normal[i]
    size = np.sqrt(outwards[0] ** 2 + outwards[1] ** 2 + outwards[2] ** 2)
    for i in range(3):
        outwards[i] /= max(size, 1e-300)


@called
def _without(around, valence, vertex, face):
    """Take a face from those around a vertex."""
    for at in range(valence[vertex]):
        if around[vertex, at] == face:
            valence[vertex] -= 1
            around[vertex, at] = around[vertex, valence[vertex]]
            return


@called
def _may_join(u, v, ring, sector, following):
    """Whether an edge may collapse: on a ring, along it and towards one corner only."""
    if ring[u] < 0 or ring[v] < 0:
        return True
    return sector[u] == sector[v] and (following[u] == v or following[v] == u)


@called
def _has(faces, f, v):
    return faces[f, 0] == v or faces[f, 1] == v or faces[f, 2] == v


@called
def _star(u, v, points, faces, around, valence, gone, mark, corners, ids, before):
    """How many faces are left around an edge that becomes its end ``v``: their corners, and how they looked."""
    count = 0
    for end in (u, v):
        for at in range(valence[end]):
            f = around[end, at]
            gone[f] = mark
            if _has(faces, f, u + v - end):
                continue
            for k in range(3):
                ids[count, k] = v if faces[f, k] == end else faces[f, k]
                for i in range(3):
                    corners[count, k, i] = points[faces[f, k], i]
            plane_of(corners[count, 0], corners[count, 1], corners[count, 2], before[count])
            count += 1
    return count


@called
def _put(v, place, corners, ids):
    """Faces with a vertex elsewhere."""
    for n in range(len(corners)):
        for k in range(3):
            for i in range(3):
                corners[n, k, i] = place[i] if ids[n, k] == v else corners[n, k, i]


@called
def _place(there, values):
    for i in range(len(there)):
        there[i] = values[i]


@called
def _shorten(u, v, following):
    """A ring without its vertex ``u``, which is beside ``v``."""
    if following[u] == v:
        for w in range(len(following)):
            if following[w] == u:
                following[w] = v
    else:
        following[v] = following[u]
    following[u] = -1


@called
def _merge(u, v, points, faces, boxes, around, valence):
    """Give the faces around ``u`` to ``v``, but those between them."""
    for at in range(valence[u]):
        f = around[u, at]
        if _has(faces, f, v):
            for k in range(3):
                if faces[f, k] != u:
                    _without(around, valence, faces[f, k], f)
            faces[f, 0] = faces[f, 1] = faces[f, 2] = -1
            set_box(boxes, f, points[v], points[v], points[v], True)
            continue
        for k in range(3):
            if faces[f, k] == u:
                faces[f, k] = v
        around[v, valence[v]] = f
        valence[v] += 1
    valence[u] = 0
    for at in range(valence[v]):
        f = around[v, at]
        set_box(boxes, f, points[faces[f, 0]], points[faces[f, 1]], points[faces[f, 2]], False)


@called
def _wait(heap, v, faces, around, valence, version, ring, sector, following, once):
    """Let the edges around a vertex wait for being looked at; where ``once``, from their lower ends only."""
    for at in range(valence[v]):
        f = around[v, at]
        for k in range(3):
            w = faces[f, (k + 1) % 3]
            if faces[f, k] == v and (v < w or not once) and _may_join(v, w, ring, sector, following):
                heapq.heappush(heap, (-1.0, v, w, version[v], version[w], _NEW))


@called
def _stale(u, v, one, two, version, valence):
    """Whether an edge is no more what it was when it was put into the queue."""
    return valence[u] == 0 or valence[v] == 0 or version[u] != one or version[v] != two


@called
def _may_collapse(u, v, faces, around, valence, seen, mark):
    """Whether the surface stays a manifold."""
    if valence[u] + valence[v] > VALENCE or (valence[u] == 3 and valence[v] == 3):  # these are a tetrahedron
        return False
    return _linked(u, v, faces, around, valence, seen, mark) == 2


@kernel
def collapse_edges(
    points, faces, boxes, around, valence, quadrics, ring, sector, following, targets, planes, mesh, mesh_boxes,
    room, reach, wanted, limit,
):  # fmt: skip
    """Collapse edges until no more than ``wanted`` vertices are left, and rings have a vertex for each corner.

    Between rings, edges whose error exceeds ``limit`` stay. A vertex that is gone has the valence 0; a face that is
    gone has -1 for its corners. How many vertices are left is returned.
    """
    version, gone = np.zeros(len(points), np.int64), np.zeros(len(faces), np.int64)
    seen, mark, left = np.zeros(len(points), np.int64), 0, 0
    stack, found = np.empty(128, np.int64), np.empty(max(len(boxes), len(mesh_boxes)), np.int64)
    corners, ids, before = np.empty((MOST, 3, 3)), np.empty((MOST, 3), np.int64), np.empty((MOST, 3))
    places, q, outwards = np.empty((CHOICES, 3)), np.empty(10), np.empty(3)
    heap = [(0.0, 0, 0, 0, 0, 0)]
    heap.pop()
    for u in range(len(points)):
        left += valence[u] > 0
        _wait(heap, u, faces, around, valence, version, ring, sector, following, True)
    while heap:
        cost, u, v, one, two, choice = heapq.heappop(heap)
        along = ring[u] >= 0 and ring[v] >= 0
        if _stale(u, v, one, two, version, valence) or (left <= wanted and not along):
            continue
        if ring[u] >= 0 and ring[v] < 0:
            u, v, one, two = v, u, two, one
        mark += 2
        if not _may_collapse(u, v, faces, around, valence, seen, mark):
            continue
        _outwards(u, v, points, faces, around, valence, outwards)
        weight = _places(u, v, points, quadrics, ring, sector, targets, planes, outwards, reach, places, q)
        if choice == _NEW:
            heapq.heappush(heap, (weight * max(_error(q, places[0]), 0.0), u, v, one, two, _ANY))
            continue
        count = _star(u, v, points, faces, around, valence, gone, mark, corners, ids, before)
        chosen = -1
        for c in range(max(choice, 0), CHOICES if choice == _ANY else choice + 1):
            _put(v, places[c], corners[:count], ids)
            if may_stand(
                corners[:count], ids, before, _TURN, gone, mark, points, faces, boxes, mesh, mesh_boxes, room, stack,
                found,
            ):  # fmt: skip
                chosen = c
                break
        true = weight * max(_error(q, places[chosen]), 0.0)
        if chosen < 0 or (true > limit and not along):
            continue
        if choice == _ANY and heap and true > 1.01 * cost and true > heap[0][0]:
            heapq.heappush(heap, (true, u, v, one, two, chosen))
            continue
        _place(points[v], places[chosen])
        _place(quadrics[v], q)
        if along:
            _shorten(u, v, following)
        _merge(u, v, points, faces, boxes, around, valence)
        left -= 1
        version[v] += 1
        _wait(heap, v, faces, around, valence, version, ring, sector, following, False)
    return left
