"""Chains: resumed to the last bit, with correct caches and counts, and an error when stuck."""

from pathlib import Path
import pickle
from test.laws import maps
from test.sweeps import sweep

from hnr_planner.core import (
    BallSpace,
    BallWalk,
    begin_chains,
    BoxSpace,
    Chains,
    DifferenceSpace,
    GridSpace,
    PolytopeSpace,
    RequestError,
    sample,
    Space,
    StuckError,
    walk_on,
    WALKS,
)
from hnr_planner.core.kernels.kernel import interpreted
from hnr_planner.core.kernels.streams import stream
from hnr_planner.core.sampling.chain import new_chain, take_steps
from hnr_planner.core.sampling.walks import make_walk
from hnr_planner.core.spaces.chain_cache import chord_cached, NO_AXIS, open_cache, REFRESH, refresh
import numpy as np
import pytest


def simplex(dim: int) -> PolytopeSpace:
    """Return x > 0, sum x < 1: its columns are nearly empty."""
    return PolytopeSpace(np.vstack([-np.eye(dim), np.ones((1, dim))]), [*[0.0] * dim, 1.0])


def polytope(n_planes: int, dim: int) -> PolytopeSpace:
    """Return a polytope with planes in all directions: its columns are full."""
    normals = np.random.default_rng(1).normal(size=(n_planes, dim))
    return PolytopeSpace(normals, np.linalg.norm(normals, axis=1))


ROOMS = GridSpace.from_blocked(maps.rooms(40, 40, 10, seed=2), 0.1, (1.0, -3.0, 0.6))
HOLED = DifferenceSpace(BoxSpace((0.0, 0.0, 0.0), (1.0, 1.0, 2.0)), BallSpace((0.7, 0.5, 1), 0.4))
SPACES: dict[str, tuple[Space, list[float]]] = {
    'grid': (ROOMS, ROOMS.cell_centres(1, 1).tolist()),
    'simplex': (simplex(5), [0.15] * 5),
    'full polytope': (polytope(60, 4), [0.0] * 4),
    'difference': (HOLED, [0.1, 0.2, 0.3]),
}
#: Spaces whose walks would be compiled for them alone.
FURTHER = ('difference',)
EACH_SPACE = pytest.mark.parametrize(
    ('space', 'start'),
    [
        sweep(*values, name=name) if name in FURTHER else pytest.param(*values, id=name)
        for name, values in SPACES.items()
    ],
)
EACH_POLYTOPE = pytest.mark.parametrize('name', ['simplex', 'full polytope'])
EACH_WALK = pytest.mark.parametrize('walk', [*WALKS, sweep(BallWalk(0.3, segment_visible=False))])


def assert_same(some: Chains, others: Chains) -> None:
    for name, array in vars(some).items():
        np.testing.assert_array_equal(array, vars(others)[name], err_msg=name)


@EACH_SPACE
@EACH_WALK
def test_two_halves_are_one_long_run_to_the_last_bit(space, start, walk, tmp_path: Path):
    """The second half begins from a file, in between two times that memory is renewed."""
    chains = begin_chains(space, start, n_chains=3, seed=4)
    draws, after = walk_on(space, chains, 900, walk=walk, thin=3)
    first, half = walk_on(space, chains, 500, walk=walk, thin=3)
    np.savez(tmp_path / 'chains.npz', **vars(half))
    with np.load(tmp_path / 'chains.npz') as file:
        read = Chains(**file)
    assert_same(read, pickle.loads(pickle.dumps(half)))
    second, end = walk_on(space, read, 400, walk=walk, thin=3)
    np.testing.assert_array_equal(np.concatenate([first, second], axis=1), draws)
    assert_same(end, after)
    assert (after.steps == 2700).all()
    assert 500 * 3 % REFRESH != 0 < REFRESH < 2700


@pytest.mark.sweep
@EACH_SPACE
@EACH_WALK
def test_compiled_and_interpreted_chains_are_the_same(space, start, walk):
    outcomes = []
    for steps in (take_steps, interpreted(take_steps)):
        chain = new_chain(space, space.to_kernel(np.array(start)), stream(5))
        chain.counts[0] = REFRESH - 60
        refresh(space.data, open_cache(space.data, chain.x, chain.memory))
        draws, u = np.zeros((40, space.dim)), np.zeros(space.dim)
        with np.errstate(over='ignore', divide='ignore'):  # as compiled code does
            steps(space.data, make_walk(walk).compiled(space), chain, u, 3, draws)
        outcomes.append([*chain, draws])
    for compiled, plain in zip(*outcomes, strict=True):
        np.testing.assert_array_equal(compiled, plain)
    assert (outcomes[0][-1] != start).any()


@EACH_SPACE
@EACH_WALK
def test_walking_on_changes_nothing_that_was_there(space, start, walk):
    chains = begin_chains(space, start, n_chains=2, seed=1)
    before = pickle.loads(pickle.dumps(chains))
    draws, _ = walk_on(space, chains, 20, walk=walk)
    assert_same(chains, before)
    np.testing.assert_array_equal(draws, sample(space, start, 20, walk=walk, n_chains=2, seed=1))


@EACH_SPACE
@EACH_WALK
def test_every_point_of_a_chain_is_free(space, start, walk):
    draws = sample(space, start, 4000, walk=walk, thin=7, seed=3)[0]
    assert space.contains(draws).all()
    assert len(np.unique(draws, axis=0)) > 400


def test_a_chain_may_change_its_walk():
    space, start = SPACES['simplex']
    chains = begin_chains(space, start, seed=1)
    for walk in (*WALKS, *WALKS):
        draws, chains = walk_on(space, chains, 500, walk=walk)
        assert space.contains(draws[0]).all()
        assert_cache_is_right(space, chains)


# -- what polytopes cache ----------------------------------------------------------------------


def assert_cache_is_right(space: PolytopeSpace, chains: Chains) -> None:
    """Assert that the cached distances to the planes are those of the points."""
    first = space.dim
    end = first + len(space.data.offsets)
    cached = chains.memory[:, first:end]
    slacks = space.data.offsets - chains.points @ space.data.normals.T
    np.testing.assert_allclose(cached, slacks, rtol=0.0, atol=space.data.doubt)


@EACH_POLYTOPE
@EACH_WALK
def test_distances_go_along_with_the_chain(name: str, walk):
    space, start = SPACES[name]
    chains = begin_chains(space, start, seed=2)
    for n_steps in (1, 5, REFRESH - 10, 3 * REFRESH + 7):
        _, chains = walk_on(space, chains, 1, walk=walk, thin=n_steps)
        assert_cache_is_right(space, chains)


@pytest.mark.interpreted
@EACH_POLYTOPE
def test_chords_from_memory_are_those_of_the_space(name: str):
    space, start = SPACES[name]
    rng = np.random.default_rng(6)
    for point in sample(space, start, 50, thin=5, seed=4)[0]:
        cache = open_cache(space.data, point, np.zeros(space.dim + 3 * len(space.data.offsets)))
        refresh(space.data, cache)
        axis = int(rng.integers(space.dim))
        for u, which in ((rng.normal(size=space.dim), NO_AXIS), (np.eye(space.dim)[axis], axis)):
            assert chord_cached(space.data, cache, u, which) == pytest.approx(
                space.chord(point, u), rel=1e-12
            )


@pytest.mark.parametrize('walk', WALKS)
@pytest.mark.parametrize('distance', [1e-300, 1e-18, 1e-9])
def test_a_chain_leaves_a_corner_that_it_nearly_touches(walk: str, distance: float):
    draws = sample(simplex(3), [distance] * 3, 20_000, walk=walk, seed=5)[0]
    assert simplex(3).contains(draws).all()
    np.testing.assert_allclose(draws[10_000:].mean(axis=0), 0.25, atol=0.05)


def test_near_the_boundary_the_point_itself_decides():
    """Were memory trusted at any distance, some of these would be outside by rounding."""
    space = PolytopeSpace([[1.0, 3.0], [-1.0, 2.0], [0.3, -1.0]], [0.1, 0.7, 0.9])
    space.data = space.data._replace(doubt=np.inf)
    expected = sample(space, space.centre, 3000, seed=1)
    space.data = space.data._replace(doubt=1e-12)
    np.testing.assert_allclose(sample(space, space.centre, 3000, seed=1), expected, atol=1e-9)


# -- counts, and chains that stick ----------------------------------------------------------------


def test_counts_tell_steps_and_moves():
    _, chains = walk_on(ROOMS, begin_chains(ROOMS, ROOMS.cell_centres(1, 1), seed=1), 50, thin=4)
    assert (chains.steps, chains.moves) == (200, 200)
    assert (chains.zero_chords, chains.redraws) == (0, 0)
    walk = BallWalk(0.5)
    draws, chains = walk_on(ROOMS, chains, 2000, walk=walk)
    assert chains.steps == 2200
    stayed = (np.diff(draws[0], axis=0) == 0.0).all(axis=1).sum()
    assert 200 < stayed < 1800
    assert abs(2200 - chains.moves - stayed) <= 1


@pytest.mark.interpreted
@pytest.mark.parametrize('segment_visible', [True, False])
def test_a_ball_walk_with_steps_too_long_is_stuck(segment_visible: bool):
    walk = BallWalk(1e4, segment_visible=segment_visible)
    with pytest.raises(StuckError, match=r'not moved in 1000 steps from .* of 1000 steps 0 moved'):
        sample(HOLED, (0.1, 0.1, 0.1), 1, thin=2000, walk=walk, seed=1)


@pytest.mark.interpreted
@pytest.mark.parametrize('walk', ['hit_and_run', 'coordinate_hit_and_run'])
def test_a_chain_between_walls_that_numbers_do_not_resolve_is_stuck(walk: str):
    """Between the slab's faces lies one number; along them there would be room."""
    x = 1.0 + 2.0**-51
    slab = DifferenceSpace(
        BoxSpace((0.0, 0.0), (2.0, 2.0)),
        BoxSpace((0.5, 0.5), (1.5, x - 2.0**-52)),
        BoxSpace((0.5, x + 2.0**-52), (1.5, 1.5)),
        BoxSpace((0.5, 0.9), (1.0, 1.1)),
        BoxSpace((1.0 + 2.0**-51, 0.9), (1.5, 1.1)),
    )
    start = (1.0 + 2.0**-52, x)
    with pytest.raises(StuckError, match='0 moved it, 1000 had no chord'):
        sample(slab, start, 2000, walk=walk, seed=1)


# -- starts ---------------------------------------------------------------------------------------


def test_chains_may_start_each_at_a_point_of_its_own():
    starts = ROOMS.cell_centres([1, 1, 2], [1, 2, 1])
    draws = sample(ROOMS, starts, 10, seed=1)
    assert draws.shape == (3, 10, 2)
    np.testing.assert_array_equal(draws, sample(ROOMS, starts, 10, n_chains=3, seed=1))
    one = begin_chains(ROOMS, starts[0], n_chains=3, seed=1)
    np.testing.assert_array_equal(one.streams, begin_chains(ROOMS, starts, seed=1).streams)
    assert len(np.unique(one.streams, axis=0)) == 3


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        ({'start': [[1.1, 2.0], [0.1, 0.1]]}, r'start \[.*\] is outside the map'),
        ({'start': np.empty((0, 2))}, 'start must be at least one point'),
        ({'start': [[np.nan, 0.0]]}, 'start must be finite'),
        ({'start': ROOMS.cell_centres([1, 1], [1, 2]), 'n_chains': 3}, '3 chains need one start'),
        ({'walk': BallWalk}, 'walk must be one of'),
        ({'walk': 3}, 'walk must be one of'),
    ],
)
def test_a_malformed_request_is_refused(change, words: str):
    request = {'start': ROOMS.cell_centres(1, 1), 'n_draws': 3, **change}
    with pytest.raises(RequestError, match=words):
        sample(ROOMS, **request)


def test_chains_of_another_space_are_refused():
    chains = begin_chains(ROOMS, ROOMS.cell_centres(1, 1), seed=1)
    with pytest.raises(RequestError, match='have 5 columns of points'):
        walk_on(SPACES['simplex'][0], chains, 1)
    with pytest.raises(RequestError, match='columns of memory'):
        walk_on(simplex(2), chains, 1)


@pytest.mark.parametrize('radius', [0.0, -1.0, np.nan, 'far'])
def test_a_radius_that_is_none_is_refused(radius):
    with pytest.raises(RequestError, match='radius must be'):
        BallWalk(radius)
