"""
Random streams: the published generator to the bit, one stream for each purpose, the right laws.

Sample sizes and false-alarm rates: each statistical test draws N = 200 000 numbers from a fixed
seed and asks scipy for a p-value above 1e-6; so a right stream fails once in a million seeds.
"""

import itertools

from hnr_planner.core.kernels import streams
from hnr_planner.core.kernels.kernel import interpreted, kernel
from hnr_planner.core.kernels.streams import draw_normals, normal, stream, uniform
import numpy as np
import pytest
from scipy import stats

N = 200_000
FALSE_ALARM = 1e-6
WORD = 2**64 - 1


def splitmix64(state):
    """Words of SplitMix64 as its authors write it, in whole numbers of Python."""
    while True:
        state = (state + 0x9E3779B97F4A7C15) & WORD
        z = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & WORD
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & WORD
        yield z ^ (z >> 31)


def xoshiro256pp(state):
    """Words of xoshiro256++ as its authors write it, in whole numbers of Python."""

    def turned(word, by):
        return ((word << by) | (word >> (64 - by))) & WORD

    s = list(state)
    while True:
        yield (turned((s[0] + s[3]) & WORD, 23) + s[0]) & WORD
        t = (s[1] << 17) & WORD
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= t
        s[3] = turned(s[3], 45)


@kernel
def drawn(rng, n):
    """Draw (n,) uniform and (n,) normal numbers."""
    uniforms, normals = np.empty(n), np.empty(n)
    for i in range(n):
        uniforms[i] = uniform(rng)
    for i in range(n):
        normals[i] = normal(rng)
    return uniforms, normals


@kernel
def drawn_at_once(rng, n):
    """Draw (n,) normal numbers, and return them with their squared length."""
    normals = np.empty(n)
    return normals, draw_normals(rng, normals)


def test_numbers_are_those_of_the_published_generator():
    rng = stream(1)
    words = xoshiro256pp(int(word) for word in rng)
    expected = [(word >> 11) * 2.0**-53 for word in itertools.islice(words, 1000)]
    assert drawn(rng, 1000)[0].tolist() == expected


def test_a_state_is_drawn_from_splitmix64():
    key = np.uint64(12345)
    mixed = interpreted(streams._mixed)(key + streams._GOLDEN)
    assert int(mixed) == next(splitmix64(12345))


def test_each_seed_and_purpose_has_a_stream_of_its_own():
    told = [
        (seed, *purpose)
        for seed in (0, 1, 2, 3, 2**31, 2**64 - 1, 2**64, 2**64 + 1, 2**100)
        for purpose in ((), (0,), (1,), (2**31,), (0, 0), (0, 1), (1, 0), (0, 0, 0))
    ]
    states = {tuple(stream(*words).tolist()) for words in told}
    assert len(states) == len(told)
    assert stream(7, 1, 2).tolist() == stream(7, 1, 2).tolist()


def test_compiled_and_interpreted_streams_are_the_same():
    compiled = drawn(stream(5), 3000)
    plain = interpreted(drawn)(stream(5), 3000)
    np.testing.assert_array_equal(compiled, plain)


def test_normals_drawn_at_once_are_those_drawn_one_by_one():
    rng, another = stream(8), stream(8)
    drawn(another, 0)
    normals, squared = drawn_at_once(rng, 3000)
    one_by_one = [interpreted_normal(another) for _ in range(3000)]
    assert normals.tolist() == one_by_one
    assert rng.tolist() == another.tolist()
    assert squared == pytest.approx(normals @ normals, rel=1e-12)
    plain, plain_squared = interpreted(drawn_at_once)(stream(8), 3000)
    assert plain.tolist() == one_by_one
    assert plain_squared == squared


def interpreted_normal(rng):
    return interpreted(normal)(rng)


def test_layers_of_the_normal_law_have_one_area_and_cover_the_density():
    edges, heights = streams._EDGES, streams._HEIGHTS
    areas = edges[1:-1] * np.diff(heights)[1:]
    tail = np.sqrt(2.0 * np.pi) * stats.norm.sf(streams._TAIL)
    np.testing.assert_allclose(areas, streams._AREA, rtol=1e-9)
    assert edges[1] * heights[1] + tail == pytest.approx(streams._AREA, rel=1e-9)
    assert (edges[-1], heights[-1]) == (0.0, 1.0)


def p_value_uniform(draws):
    return stats.kstest(draws, 'uniform').pvalue


def p_value_pairs(draws):
    """Chi-square of successive pairs over 32 x 32 squares."""
    squares = np.histogram2d(draws[::2], draws[1::2], bins=32, range=((0, 1), (0, 1)))[0]
    return stats.chisquare(squares.ravel()).pvalue


@pytest.mark.parametrize('seed', [0, 1, 2**63])
def test_uniform_and_normal_draws_have_their_laws(seed: int):
    uniforms, normals = drawn(stream(seed), N)
    assert uniforms.min() >= 0.0
    assert uniforms.max() < 1.0
    assert p_value_uniform(uniforms) > FALSE_ALARM
    assert p_value_pairs(uniforms) > FALSE_ALARM
    assert stats.kstest(normals, 'norm').pvalue > FALSE_ALARM
    assert p_value_pairs(stats.norm.cdf(normals)) > FALSE_ALARM


def test_the_first_draws_of_neighbouring_streams_are_unrelated():
    firsts = np.array([drawn(stream(9, k), 1)[0][0] for k in range(20_000)])
    assert p_value_uniform(firsts) > FALSE_ALARM
    assert p_value_pairs(firsts) > FALSE_ALARM


def p_value_far_normals(draws):
    """Chi-square of what lies where the ziggurat has its corners: beyond 3 in steps of .2."""
    ends = np.append(np.arange(3.0, 4.4, 0.2), np.inf)
    counts = np.histogram(np.abs(draws), bins=np.append(0.0, ends))[0]
    expected = 2.0 * np.diff(stats.norm.cdf(np.append(0.0, ends))) * len(draws)
    return stats.chisquare(counts, expected).pvalue


def test_far_normal_draws_have_their_law():
    """With 10 million draws; the same draws without the tail, or with one too thin, are caught."""
    normals, _ = drawn_at_once(stream(4), 10_000_000)
    assert p_value_far_normals(normals) > FALSE_ALARM
    assert p_value_uniform(stats.norm.cdf(normals[:2_000_000])) > FALSE_ALARM
    tail = np.abs(normals) > streams._TAIL
    assert p_value_far_normals(normals[~tail]) < FALSE_ALARM
    thin = np.where(tail, streams._TAIL + 0.8 * (np.abs(normals) - streams._TAIL), normals)
    assert p_value_far_normals(thin) < FALSE_ALARM


@pytest.mark.parametrize(
    'broken',
    [
        lambda u: u**1.03,  # not quite uniform
        lambda u: 0.5 * (u + np.roll(u, 1)) % 1.0,  # averages of neighbours
        lambda u: np.where(np.arange(len(u)) % 2, np.roll(u, 1), u),  # every number twice
    ],
)
def test_the_tests_of_the_laws_catch_broken_streams(broken):
    draws = broken(drawn(stream(0), N)[0])
    assert min(p_value_uniform(draws), p_value_pairs(draws)) < FALSE_ALARM
