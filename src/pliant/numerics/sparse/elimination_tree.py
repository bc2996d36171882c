"""Kernels that find where a sparse Cholesky factor has entries, before any number is known (Davis 2006, chapter 4).

Column j of L hands its entries on to its parent in the elimination tree: the row of its first entry below the
diagonal. Row i of L is reached by walking up the tree from the entries of row i of the matrix, until a column that
has been visited for that row: every walk below is this one.

Arguments that the kernels share:

``pointers, indices``
    The pattern of the symmetric matrix by columns, both triangles.
``order, place``
    The unknown at each place of the elimination order, and the place of each unknown.
``parent``
    (n,) the parent of each place, -1 for a root.
"""

from __future__ import annotations

import numpy as np

from pliant.numerics.compute.compiling import inlined, kernel


@kernel
def find_tree(pointers, indices, order, place):
    """The elimination tree (Liu 1990), as ``parent``, and a postorder of it: subtrees are runs, children first."""
    size = len(order)
    parent, ancestor = np.empty(size, np.int64), np.empty(size, np.int64)
    for i in range(size):
        parent[i] = ancestor[i] = -1
        for p in range(pointers[order[i]], pointers[order[i] + 1]):
            k = place[indices[p]]
            while k != -1 and k < i:
                above, ancestor[k] = ancestor[k], i
                if above == -1:
                    parent[k] = i
                k = above  # the path that was walked is cut short
    return parent, _postorder(parent)


@inlined
def _postorder(parent):
    size = len(parent)
    child, sibling = np.empty(size + 1, np.int64), np.empty(size, np.int64)
    for j in range(size + 1):
        child[j] = -1  # the roots are the children of a last place
    for j in range(size - 1, -1, -1):
        above = parent[j] if parent[j] >= 0 else size
        sibling[j], child[above] = child[above], j
    result, stack = np.empty(size, np.int64), np.empty(size + 1, np.int64)
    stack[0] = size
    depth, done = 0, 0
    while depth >= 0:
        j = stack[depth]
        if child[j] >= 0:
            depth += 1
            stack[depth], child[j] = child[j], sibling[child[j]]
        else:
            if j < size:
                result[done] = j
                done += 1
            depth -= 1
    return result


@inlined
def _count(pointers, indices, order, place, parent):
    """(n,) how many entries each column of L has below its diagonal."""
    size = len(order)
    count, seen = np.empty(size, np.int64), np.empty(size, np.int64)
    for i in range(size):
        count[i], seen[i] = 0, i
        for p in range(pointers[order[i]], pointers[order[i] + 1]):
            k = place[indices[p]]
            while k < i and seen[k] != i:
                count[k] += 1
                seen[k] = i
                k = parent[k]
    return count


@kernel
def join_columns(pointers, indices, order, place, parent, few, share, first):
    """How many runs of columns the places, postordered, form, and the entries below each column; fills ``first``.

    Neighbours with the same rows below them are one run. It takes in the run before it, if that one's parent is
    inside, where no more than ``few`` columns come together or ``share`` of the joint entries are zeros.
    """
    size, runs, begin = len(parent), 0, 0
    count = _count(pointers, indices, order, place, parent)
    zeros = np.empty(size, np.int64)
    while begin < size:
        end = begin + 1
        while end < size and parent[end - 1] == end and count[end - 1] == count[end] + 1:
            end += 1
        first[runs], zeros[runs] = begin, 0
        while runs > 0 and parent[first[runs] - 1] >= first[runs] and parent[first[runs] - 1] < end:
            middle, width = first[runs], end - first[runs - 1]
            more = (middle - first[runs - 1]) * (end - middle + count[end - 1] - count[middle - 1])
            empty = zeros[runs - 1] + zeros[runs] + more
            if width > few and empty > share * width * ((width + 1) // 2 + count[end - 1]):
                break
            runs -= 1
            zeros[runs] = empty
        runs += 1
        first[runs] = begin = end
    return runs, count


@kernel
def find_rows(pointers, indices, order, place, first, above, row_starts):
    """The rows below each run of columns, sorted; ``above`` is the parent of each run."""
    runs = len(first) - 1
    owner, seen, end = np.empty(len(order), np.int64), np.empty(runs, np.int64), np.empty(runs, np.int64)
    rows = np.empty(row_starts[runs], np.int32)
    for s in range(runs):
        seen[s], end[s] = -1, row_starts[s]
        for j in range(first[s], first[s + 1]):
            owner[j] = s
    for i in range(len(order)):
        for p in range(pointers[order[i]], pointers[order[i] + 1]):
            if place[indices[p]] >= i:
                continue
            s = owner[place[indices[p]]]
            while first[s + 1] <= i and seen[s] != i:
                seen[s] = i
                rows[end[s]] = i
                end[s] += 1
                s = above[s]
    return rows


@kernel
def place_updates(above, single, width, lead, columns, starts):
    """Where each supernode's update lies: on the one of two stacks that its children's updates do not lie on.

    Supernodes are numbered children first, so that what a stack holds on top is what is consumed next. A supernode
    marked ``single`` takes over its only child's update, less the first ``width`` columns, and the child's ``lead``.
    Returns the room that all need; ``starts`` is filled.
    """
    supernodes = len(above)
    stack, child = np.empty(supernodes, np.int64), np.empty(supernodes, np.int64)
    for s in range(supernodes - 1, -1, -1):
        stack[s], child[s] = 0, -1
        if above[s] >= 0:
            stack[s] = stack[above[s]] if single[above[s]] else 1 - stack[above[s]]
            child[above[s]] = s  # in the end the first: its update is the lowest
    top, most, base = np.zeros(2, np.int64), np.zeros(2, np.int64), np.empty(supernodes, np.int64)
    for s in range(supernodes):
        side, lowest = stack[s], child[s]
        if single[s]:
            base[s], lead[s] = base[lowest], lead[lowest]
            starts[s] = starts[lowest] + width[s] * (lead[s] + 1)
            continue
        if lowest >= 0:
            top[1 - side] = base[lowest]
        base[s] = starts[s] = top[side]
        top[side] += lead[s] * columns[s]
        most[side] = max(most[side], top[side])
    for s in range(supernodes):
        starts[s] += stack[s] * most[0]
    return most[0] + most[1]
