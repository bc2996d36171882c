from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import csr_array
from scipy.spatial import ConvexHull, Voronoi, cKDTree

from pliant.errors import InvalidDeformer, InvalidMesh
from pliant.numerics.neighbors.ghost_box import FADE, GhostBox
from pliant.space.dirichlet_ffd import DirichletFFD
from pliant.testing import check_deformer


def grid(*counts):
    return np.stack(np.meshgrid(*(np.arange(n) / max(n - 1, 1) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)


def on_sphere(count):
    directions = np.random.default_rng(7).normal(size=(count, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


ARRANGEMENTS = {
    "anywhere": np.random.default_rng(1).random((60, 3)),
    "regular grid": grid(4, 4, 4),
    "grid in a plane": grid(5, 4, 1),
    "plane": np.random.default_rng(2).random((30, 3)) * [1, 1, 0],
    "line": grid(7, 1, 1),
    "cospherical": on_sphere(50),
    "octahedron": np.vstack([np.eye(3), -np.eye(3)]),
    "two": np.array([[0.0, 0, 0], [1, 2, 3]]),
    "far from the origin, tiny": 1e3 + 1e-4 * np.random.default_rng(3).random((20, 3)),
    "huge": 1e150 * np.random.default_rng(4).random((20, 3)),
}


def everywhere(box, count=400, seed=0):
    """Points in the box of the ghosts, short of where displacements are led to zero; local."""
    return np.random.default_rng(seed).uniform(-FADE, FADE, (count, 3)) * box.half


def displaced(sites, size=0.03, seed=3, **options):
    deformer = DirichletFFD(sites, **options)
    scale = np.linalg.norm(np.ptp(deformer.rest, axis=0))
    return deformer.moved(deformer.rest + np.random.default_rng(seed).normal(size=deformer.rest.shape) * size * scale)


def summed(coordinates, values):
    """Sums over each point's row of values (e, ...)."""
    rows = np.repeat(np.arange(len(coordinates.starts) - 1), np.diff(coordinates.starts))
    result = np.zeros((len(coordinates.starts) - 1, *values.shape[1:]))
    np.add.at(result, rows, values)
    return result


@pytest.mark.parametrize("kind", ["sibson", "laplace"])
@pytest.mark.parametrize("name", ARRANGEMENTS)
def test_coordinates_are_a_partition_of_unity_with_linear_precision_and_not_negative(name, kind):
    box = GhostBox(ARRANGEMENTS[name], 1.0, kind)
    points = everywhere(box)
    found = box.neighbors.at(points, gradients=True)
    at = box.everyone[found.sites]
    assert found.values.min() >= 0
    assert np.abs(summed(found, found.values) - 1).max() < 1e-14
    assert np.abs(summed(found, found.values[:, None] * at) - points).max() < (1e-12 if kind == "sibson" else 1e-11)
    assert np.abs(summed(found, found.gradients)).max() < 1e-9
    assert np.abs(summed(found, at[:, :, None] * found.gradients[:, None]) - np.eye(3)).max() < 1e-6


@pytest.mark.parametrize("margin", [0.25, 0.5, 4.0])
def test_margins_keep_linear_precision_up_to_the_fade(random, margin):
    for extents in ([1, 1, 1], [1, 1, 0], [1, 0.1, 0]):
        box = GhostBox(random.random((30, 3)) * extents, margin, "sibson")
        points = everywhere(box)
        found = box.neighbors.at(points)
        assert np.abs(summed(found, found.values[:, None] * box.everyone[found.sites]) - points).max() < 1e-11


def test_agrees_with_the_textbook(random):
    """Volumes of Qhull's Voronoi cells before and after a query becomes a site."""
    sites = random.random((200, 3))
    deformer = DirichletFFD(sites)
    queries = random.uniform(0.4, 0.6, (20, 3))
    weights = deformer.bind(queries).matrix().toarray()
    assert np.abs(weights.sum(axis=1) - 1).max() < 1e-14  # no ghost among the neighbours

    def volume(diagram, site):
        region = diagram.regions[diagram.point_region[site]]
        return ConvexHull(diagram.vertices[region]).volume if -1 not in region else np.nan

    before = Voronoi(sites)
    for query, row in zip(queries, weights, strict=True):
        after = Voronoi(np.vstack([sites, query]))
        taken = np.array([volume(before, i) - volume(after, i) if row[i] else 0.0 for i in range(len(sites))])
        assert np.nansum(taken) == pytest.approx(volume(after, len(sites)), rel=1e-9)
        assert np.abs(taken / volume(after, len(sites)) - row).max() < 1e-10


@pytest.mark.parametrize("kind", ["sibson", "laplace"])
@pytest.mark.parametrize("name", ["anywhere", "regular grid"])
def test_a_search_that_goes_astray_is_noticed_and_repeated(name, kind):
    """Edges that lead nowhere: whatever is found along them, each facet of each cell is asked after all."""
    box = GhostBox(ARRANGEMENTS[name], 1.0, kind)
    points = everywhere(box, 200)
    expected = box.neighbors.at(points, gradients=True)
    skeleton = box.neighbors._skeleton
    lost = skeleton._replace(starts=np.zeros_like(skeleton.starts))
    found = replace(box.neighbors)
    found.__dict__["_skeleton"] = lost
    found = found.at(points, gradients=True)
    shape = (len(points), len(box.everyone))
    first, second = (csr_array((c.values, c.sites, c.starts), shape=shape).toarray() for c in (expected, found))
    assert np.abs(first - second).max() < 1e-11


def test_laplace_coordinates_are_areas_over_distances(random):
    sites = random.random((90, 3))
    queries = random.uniform(0.4, 0.6, (10, 3))
    weights = DirichletFFD(sites, coordinates="laplace").bind(queries).matrix().toarray()
    for query, row in zip(queries, weights, strict=True):
        diagram, expected = Voronoi(np.vstack([sites, query])), np.zeros(len(sites))
        for pair, ridge in zip(diagram.ridge_points, diagram.ridge_vertices, strict=True):
            if len(sites) in pair:
                other = pair.min()
                corners = diagram.vertices[ridge]
                apart = sites[other] - query
                length = np.linalg.norm(apart)
                spread = [np.cross(a - corners[0], b - corners[0]) for a, b in pairwise(corners)]
                expected[other] = abs(np.sum(spread, axis=0) @ apart) / length / length
        assert np.abs(expected / expected.sum() - row).max() < 1e-11


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("name", ["anywhere", "regular grid", "grid in a plane", "line", "two"])
def test_laws(name, smooth):
    sites = ARRANGEMENTS[name]
    random = np.random.default_rng(5)
    low, high = sites.min(axis=0), sites.max(axis=0)
    points = random.uniform(low - 0.3, high + 0.3, (150, 3)) if name != "anywhere" else random.uniform(-3, 4, (200, 3))
    check_deformer(displaced(sites, 0.01, smooth=smooth), points)


def test_laws_of_the_cheap_mode(random):
    points = random.random((100, 3)) * 1.4 - 0.2
    deformer = displaced(ARRANGEMENTS["anywhere"], 0.01, coordinates="laplace")
    step = 1e-4 * np.linalg.norm(np.ptp(points, axis=0))

    def smooth(where):  # second derivatives jump where a neighbour appears
        near = where[:, None] + step * np.concatenate([np.eye(3), -np.eye(3)])
        counts = np.diff(deformer.bind(near.reshape(-1, 3)).matrix().indptr).reshape(-1, 6)
        return (counts == counts[:, :1]).all(axis=1)

    assert smooth(points).mean() > 0.8
    check_deformer(deformer, points, smooth=smooth)


def test_laws_on_a_mesh(box_mesh, random):
    sites = np.unique(box_mesh.points[::4], axis=0)
    sites += 0.05 * random.random(sites.shape)

    def away(points):  # the plain form has a cusp at each site
        return cKDTree(sites).query(points)[0] > 1e-3

    check_deformer(displaced(sites, 0.01), box_mesh, smooth=away)
    check_deformer(displaced(sites, 0.01, smooth=True), box_mesh, smooth=away)


@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("name", ARRANGEMENTS)
def test_a_site_goes_where_it_is_moved(name, smooth):
    deformer = displaced(ARRANGEMENTS[name], smooth=smooth)
    scale = np.abs(deformer.controls).max()
    assert np.abs(deformer(deformer.rest) - deformer.controls).max() <= 1e-15 * scale


@pytest.mark.parametrize("kind", ["sibson", "laplace"])
@pytest.mark.parametrize("name", ["anywhere", "regular grid", "cospherical"])
def test_points_beside_a_site_follow_it_at_any_distance(name, kind, random):
    """Also where they are so close that rounding hides what they take from its cell."""
    box = GhostBox(ARRANGEMENTS[name], 3.0, kind)
    distances = 10.0 ** np.linspace(-16, -8, 200)
    beside = random.integers(0, len(box.sites), len(distances))
    directions = random.normal(size=(len(distances), 3))
    points = box.everyone[beside] + distances[:, None] * directions
    found = box.neighbors.at(points)
    weights = csr_array((found.values, found.sites, found.starts), shape=(len(points), len(box.everyone))).toarray()
    assert np.abs(weights.sum(axis=1) - 1).max() < 1e-14
    assert np.abs(weights @ box.everyone - points).max() < 1e-10
    assert weights[np.arange(len(points)), beside].min() > 0.99


def test_farins_form_reproduces_quadratics(random):
    sites, points = random.random((300, 3)), random.uniform(0.3, 0.7, (500, 3))
    bowl = random.normal(size=(3, 3, 3)) * 0.1

    def quadratic(x):
        return np.einsum("cij,ni,nj->nc", bowl, x, x) + x @ bowl[0]

    smooth = DirichletFFD(sites, smooth=True).moved(sites + quadratic(sites))
    assert np.abs(smooth(points) - points - quadratic(points)).max() < 7e-15
    slope = np.einsum("cij,nj->nci", bowl + bowl.transpose(0, 2, 1), points) + bowl[0].T + np.eye(3)
    assert np.abs(smooth.jacobian(points) - slope).max() < 1e-11
    plain = DirichletFFD(sites).moved(sites + quadratic(sites))
    assert np.abs(plain(points) - points - quadratic(points)).max() > 1e-4


def test_farins_closed_form_is_the_sum_over_triples(random):
    deformer = displaced(random.random((12, 3)), smooth=True)
    box, points = deformer._box, random.random((6, 3))
    found = box.neighbors.at(box.local(points))
    values = np.vstack([deformer.displacements, np.zeros((8, 3))])
    slopes = np.vstack([(box.fit @ deformer.displacements), np.zeros((24, 3))]).reshape(-1, 3, 3)
    for n, point in enumerate(points):
        at = slice(found.starts[n], found.starts[n + 1])
        sites, shares = found.sites[at], found.values[at]
        count = len(sites)
        edge = np.empty((count, count, 3))  # b_iij; b_iii on the diagonal
        for a, i in enumerate(sites):
            for b, j in enumerate(sites):
                edge[a, b] = values[i] + (box.everyone[j] - box.everyone[i]) @ slopes[i] / 3
        total = np.zeros(3)
        for a in range(count):
            for b in range(count):
                for c in range(count):
                    if len({a, b, c}) == 3:
                        six = sum(edge[i, j] for i in (a, b, c) for j in (a, b, c) if i != j)
                        knot = six / 4 - values[sites[[a, b, c]]].sum(axis=0) / 6
                    else:
                        twice = a if a in (b, c) else b
                        once = ({a, b, c} - {twice} or {twice}).pop()
                        knot = edge[twice, once]
                    total += shares[a] * shares[b] * shares[c] * knot
        assert np.abs(deformer(point[None])[0] - point - total).max() < 1e-14


def test_the_smooth_form_has_one_derivative_at_a_site_and_the_plain_form_has_not(random):
    sites = random.random((40, 3))
    around = 1e-6 * on_sphere(30)
    site = sites[np.argmin(np.linalg.norm(sites - 0.5, axis=1))]
    jumps = []
    for smooth in (True, False):
        deformer = displaced(sites, 0.05, smooth=smooth)
        jacobian = deformer.jacobian(site + around)
        at_site = deformer.jacobian(site[None])[0]
        jumps.append(np.abs(jacobian - at_site).max())
    assert jumps[0] < 1e-4 < 1e-2 < jumps[1]


def test_influence_is_local_and_a_drag_touches_nothing_else(random):
    sites, points = random.random((200, 3)), random.random((3000, 3))
    binding = DirichletFFD(sites).bind(points)
    column = binding.matrix()[:, [17]].toarray()[:, 0]
    controls = sites.copy()
    controls[17] += [0.1, 0, 0]
    touched = binding.drag(sites).update(controls, changed=[17])
    assert np.array_equal(touched, np.flatnonzero(column))
    assert len(touched) < 0.12 * len(points)
    without = DirichletFFD(np.delete(sites, 17, axis=0)).bind(points).matrix().toarray()
    same = binding.matrix()[column == 0].toarray()
    assert np.abs(np.delete(same, 17, axis=1) - without[column == 0]).max() < 1e-13


def test_points_fade_towards_the_ghosts_and_rest_beyond(random):
    sites = random.random((30, 3))
    deformer = displaced(sites, 0.1)
    half = np.ptp(sites, axis=0) / 2 + np.linalg.norm(np.ptp(sites, axis=0))
    center = (sites.min(axis=0) + sites.max(axis=0)) / 2
    face, axis = random.uniform(-1, 1, (200, 3)) * half, random.integers(0, 3, 200)
    face[np.arange(200), axis] = half[axis]
    beyond = center + face * 1.0001
    assert np.array_equal(deformer(beyond), beyond)
    assert np.array_equal(deformer(1e6 * beyond), 1e6 * beyond)
    before = center + face * (1 - 1e-5)
    assert np.abs(deformer(before) - before).max() < 1e-8  # it arrives at rest with slope zero


@given(
    st.lists(st.tuples(*[st.integers(0, 4)] * 3), min_size=3, max_size=40, unique=True),
    st.lists(st.tuples(*[st.integers(-4, 12)] * 3), min_size=1, max_size=20),
)
@settings(deadline=None, max_examples=60)
def test_integer_sites_and_queries_at_half_integers(sites, queries):
    """Everything that is degenerate: cospherical, coplanar, queries on sites, on edges, on spheres."""
    sites, queries = np.array(sites, float), np.array(queries) / 2
    box = GhostBox(sites, 1.0, "sibson")
    local = box.local(queries)
    local = local[(np.abs(local) <= FADE * box.half).all(axis=1)]
    found = box.neighbors.at(local, gradients=True)
    assert np.abs(summed(found, found.values[:, None] * box.everyone[found.sites]) - local).max(initial=0.0) < 1e-12
    at = box.everyone[found.sites]
    away = np.diff(found.starts) > 1  # a site has no gradient
    slopes = summed(found, at[:, :, None] * found.gradients[:, None])[away]
    assert np.abs(slopes - np.eye(3)).max(initial=0.0) < 1e-9
    moved = displaced(sites, 0.05)
    assert np.isfinite(moved(queries)).all()
    assert np.isfinite(moved.jacobian(queries)).all()


def test_moves_of_all_sites_are_rigid_where_no_ghost_is_felt(random):
    sites, points = random.random((200, 3)), random.uniform(0.3, 0.7, (300, 3))
    linear, shift = np.eye(3) + random.normal(size=(3, 3)) * 0.2, random.normal(size=3)
    for smooth in (False, True):
        moved = DirichletFFD(sites, smooth=smooth).moved(sites @ linear.T + shift)
        assert np.abs(moved(points) - points @ linear.T - shift).max() < 1e-12


def test_errors_name_cause_and_cure(random):
    sites = random.random((10, 3))
    with pytest.raises(InvalidDeformer, match=r"sites 2 and 7 are in the same place.*keep one"):
        DirichletFFD(np.vstack([sites[:7], sites[2], sites[7:]]))
    with pytest.raises(InvalidDeformer, match="two sites or more"):
        DirichletFFD(sites[:1])
    with pytest.raises(InvalidDeformer, match="two sites or more"):
        DirichletFFD(sites[:, :2])
    with pytest.raises(InvalidDeformer, match="1 of 10 sites are not finite, the first is site 3"):
        DirichletFFD(np.where(np.arange(10)[:, None] == 3, np.nan, sites))
    with pytest.raises(InvalidDeformer, match="'sibson' or 'laplace'"):
        DirichletFFD(sites, coordinates="natural")
    for margin in (0, -1, np.nan, np.inf):
        with pytest.raises(InvalidDeformer, match="margin"):
            DirichletFFD(sites, margin=margin)
    with pytest.raises(InvalidMesh, match="not finite"):
        DirichletFFD(sites)([[0, 0, np.nan]])
