"""Voronoi cells of sites in a box, without a triangulation.

A convex polytope is the cell of its site when no corner of it is nearer to another site; which site is nearest to a
corner, a k-d tree says. Cells begin with the half-spaces of a few near sites and are cut anew with the offenders
until there are none.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pliant.numerics.compute.chunks import for_chunks

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

FIRST = 24  # near sites that a cell begins with
PIECES = 16  # of work a round: cells take about the same time
NEARER = 1e-13  # by how much another site's half-space must cut a corner off, relative to the lengths involved


@dataclass(frozen=True, eq=False)
class VoronoiCells:
    """The cells of some sites, as facets with corners.

    Parameters
    ----------
    sites
        (m, 3) no two alike.
    starts, facets
        (m + 1,), (e,) the facets of cell i are ``facets[starts[i]:starts[i + 1]]``.
    owners, others
        (f,) the sites on either side of each facet; for a wall ``others`` is -1.
    normals, offsets
        (f, 3) unit normals that point from owner to other; (f,) distances from the owner.
    corner_starts
        (f + 1,) where each facet's corners start.
    corners
        (c, 3) relative to the facet's owner, counter-clockwise seen from the other.
    """

    sites: Floats
    starts: Integers
    facets: Integers
    owners: NDArray[np.int32]
    others: NDArray[np.int32]
    normals: Floats
    offsets: Floats
    corner_starts: Integers
    corners: Floats

    @classmethod
    def of(cls, sites: Floats, wall: float, always: Integers) -> VoronoiCells:
        """Cut the cells of (m, 3) sites, bounded by a cube about the origin.

        Parameters
        ----------
        sites
            (m, 3) inside the cube, no two alike.
        wall
            Half the cube's edge.
        always
            Sites whose half-spaces each cell begins with, however far they are.
        """
        from scipy.spatial import cKDTree

        tree = cKDTree(sites)
        near = tree.query(sites, k=min(FIRST + 1, len(sites)))[1].reshape(len(sites), -1)
        candidates = [_sorted(sites, i, np.union1d(near[i], always)) for i in range(len(sites))]
        cells: list[_Cell] = [_NOTHING] * len(sites)
        reach = np.full(len(sites), 4 * wall)
        unfinished = np.arange(len(sites))
        while len(unfinished):
            pieces: dict[int, list[_Cell]] = {}
            batch = max(1, -(-len(unfinished) // PIECES))

            def work(start: int, stop: int, pieces=pieces, chosen=unfinished) -> None:  # type: ignore[no-untyped-def]
                part = chosen[start:stop]
                pieces[start] = _cut(part, sites, [candidates[i] for i in part], wall, reach[part])

            for_chunks(work, len(unfinished), batch)
            cut = [cell for start in sorted(pieces) for cell in pieces[start]]
            for i, cell in zip(unfinished, cut, strict=True):
                cells[i] = cell
            offended = _find_offenders(tree, sites, unfinished, cut, candidates)
            known = np.array([1.01 * np.linalg.norm(cells[i].corners, axis=1).max() for i in unfinished])
            coarse = unfinished[4 * known < reach[unfinished]]  # cut from large squares, with their rounding
            reach[unfinished] = known
            unfinished = np.union1d(offended, coarse)
        return _assembled(cls, sites, cells)


@dataclass(frozen=True, eq=False)
class _Cell:
    """One cell: its facets' neighbours, normals, offsets and numbers of corners; its corners."""

    neighbors: NDArray[np.int32]
    normals: Floats
    offsets: Floats
    sizes: Integers
    corners: Floats


_NOTHING = _Cell(np.empty(0, np.int32), np.empty((0, 3)), np.empty(0), np.empty(0, np.int64), np.empty((0, 3)))


def nearest_sites(tree: Any, points: Floats) -> NDArray[np.int32]:
    """(n,) the sites nearest to (n, 3) points, by a k-d tree, on all processors."""
    found = np.empty(len(points), np.int32)

    def work(start: int, stop: int) -> None:
        found[start:stop] = tree.query(points[start:stop])[1]

    for_chunks(work, len(points), 2048)
    return found


def _sorted(sites: Floats, own: int, others: Integers) -> Integers:
    """Other sites, the nearest first."""
    others = others[others != own]
    return np.asarray(others[np.argsort(((sites[others] - sites[own]) ** 2).sum(axis=1), kind="stable")], np.int64)


def _cut(chosen: Integers, sites: Floats, candidates: list[Integers], wall: float, reach: Floats) -> list[_Cell]:
    """The cells of some sites among their candidates; workspaces grow until everything fits."""
    from pliant.numerics.neighbors import clipping

    starts = np.concatenate([[0], np.cumsum([len(c) for c in candidates])]).astype(np.int64)
    flat = np.concatenate([np.empty(0, np.int64), *candidates]).astype(np.int32)
    room = np.array([24 * len(chosen) + 64, 160 * len(chosen) + 512, 64])  # facets, corners, corners of one polygon
    while True:
        facet_ends, neighbors = np.empty(len(chosen), np.int64), np.empty(room[0], np.int32)
        normals, offsets, corner_ends = np.empty(3 * room[0]), np.empty(room[0]), np.empty(room[0], np.int64)
        corners, work = np.empty(3 * room[1]), np.empty((2, 3 * room[2]))
        facets, small = clipping.cut_cells(
            chosen, sites.reshape(-1), flat, starts, wall, reach, facet_ends, neighbors, normals,
            offsets, corner_ends, corners, work,
        )  # fmt: skip
        if not small:
            break
        room[small - 1] *= 2
    sizes = np.diff(corner_ends[:facets], prepend=0)
    cells = []
    for first, last in zip(np.concatenate([[0], facet_ends[:-1]]), facet_ends, strict=True):
        a, b = corner_ends[first] - sizes[first] if first < last else 0, corner_ends[last - 1] if first < last else 0
        cells.append(
            _Cell(
                neighbors[first:last].copy(),
                normals[3 * first : 3 * last].reshape(-1, 3).copy(),
                offsets[first:last].copy(),
                sizes[first:last].copy(),
                corners[3 * a : 3 * b].reshape(-1, 3).copy(),
            )
        )
    return cells


def _find_offenders(
    tree: Any, sites: Floats, chosen: Integers, cells: list[_Cell], candidates: list[Integers]
) -> Integers:
    """The cells of which another site cuts a corner off; that site is put among their candidates."""
    counts = [len(cell.corners) for cell in cells]
    owners = np.repeat(chosen, counts)
    local = np.concatenate([cell.corners for cell in cells])
    nearest = nearest_sites(tree, local + sites[owners])
    apart = sites[nearest] - sites[owners]
    length = np.linalg.norm(apart, axis=1)
    depth = np.einsum("ij,ij->i", local, apart) - length**2 / 2
    offends = depth > NEARER * length * (np.linalg.norm(local, axis=1) + length)
    owner, offender = owners[offends], nearest[offends]  # owners ascend
    again = []
    for i, first, last in zip(*np.unique(owner, return_index=True), _ends(owner), strict=True):
        more = np.union1d(candidates[i], offender[first:last])
        if len(more) > len(candidates[i]):  # a site that is there already cuts deeper by rounding only
            candidates[i] = _sorted(sites, i, more)
            again.append(i)
    return np.array(again, np.int64)


def _ends(ascending: Integers) -> Integers:
    """Where each run of equal numbers ends."""
    return np.flatnonzero(np.diff(ascending, append=-1)) + 1 if len(ascending) else ascending


def _assembled(cls: type[VoronoiCells], sites: Floats, cells: list[_Cell]) -> VoronoiCells:
    """The cells together; of a facet that two cells have, the one of the lower site is kept."""
    sizes = np.concatenate([cell.sizes for cell in cells])
    others = np.concatenate([cell.neighbors for cell in cells])
    owners = np.repeat(np.arange(len(cells), dtype=np.int32), [len(cell.neighbors) for cell in cells])
    pairs = np.sort(np.stack([owners, others], axis=1), axis=1)
    walls = others < 0
    pairs[walls, 0] = -1 - np.arange(walls.sum())  # each wall is a facet of its own
    kept = np.sort(np.unique(pairs, axis=0, return_index=True)[1])
    corners = np.concatenate([cell.corners for cell in cells])[np.repeat(np.isin(np.arange(len(sizes)), kept), sizes)]
    owners, others, count = owners[kept], others[kept], len(kept)
    users = np.concatenate([owners, others[others >= 0]])
    facets = np.concatenate([np.arange(count), np.flatnonzero(others >= 0)])
    order = np.lexsort([facets, users])
    return cls(
        sites,
        np.searchsorted(users[order], np.arange(len(cells) + 1)),
        facets[order],
        owners,
        others,
        np.concatenate([cell.normals for cell in cells])[kept],
        np.concatenate([cell.offsets for cell in cells])[kept],
        np.concatenate([[0], np.cumsum(sizes[kept])]).astype(np.int64),
        corners,
    )
