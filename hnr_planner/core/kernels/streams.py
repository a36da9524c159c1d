"""
Random streams: the random numbers of kernels.

A stream is four words, the state of xoshiro256++ (Blackman and Vigna, "Scrambled linear
pseudorandom number generators", 2021), seeded through SplitMix64 as its authors advise. An array
costs nothing to make and to hand to a kernel; NumPy's ``Generator`` costs more at each request
than most searches take (25 us against .5). Each purpose has a stream of its own, all follow from
one seed, and a stream belongs to one call at a time: drawing moves it on.
"""

import math
from typing import TypeAlias

from hnr_planner.core.kernels.kernel import inlined, kernel
import numpy as np
from numpy.typing import NDArray

#: State (4,) of a stream.
Stream: TypeAlias = NDArray[np.uint64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_WORD = 2**64 - 1


def stream(seed: int, *purpose: int) -> Stream:
    """
    Return the initial state (4,) of the random numbers for a seed >= 0 and one purpose.

    The purpose is named by integers >= 0, any number of them. The same seed and purpose give the
    same stream; other purposes give other streams.
    """
    words = [len(purpose), *purpose, seed & _WORD]
    while seed > _WORD:
        seed >>= 64
        words.append(seed & _WORD)
    return _seeded(np.array(words, dtype=np.uint64))


@kernel
def _seeded(words):
    """Return the state (4,) of a stream, a hash of ``words`` (k,) uint64."""
    key = np.uint64(0)
    for word in words:
        key = _mixed((key ^ word) + _GOLDEN)
    state = np.empty(4, dtype=np.uint64)
    for i in range(4):
        key += _GOLDEN
        state[i] = _mixed(key)
    return state


@kernel
def _mixed(z):
    """Return the value of SplitMix64's output function at the 64-bit word ``z``."""
    z = (z ^ (z >> np.uint64(30))) * _MIX_1
    z = (z ^ (z >> np.uint64(27))) * _MIX_2
    return z ^ (z >> np.uint64(31))


@inlined
def uniform(rng):
    """Return a number drawn uniformly from the multiples of 2^-53 in [0, 1); advance ``rng``."""
    return (_next_word(rng) >> np.uint64(11)) * 2.0**-53


@inlined
def normal(rng):
    """Return a number drawn from the standard normal distribution; advance stream ``rng``."""
    layer, x = _in_a_layer(_next_word(rng))
    return x if abs(x) < _EDGES[layer + 1] else _beyond_the_step(rng, layer, x)


@inlined
def draw_normals(rng, u):
    """
    Write n independent standard normal numbers into ``u`` (n,), and advance stream ``rng``.

    Return the sum of their squares.
    """
    squared = 0.0
    s0, s1, s2, s3 = rng[0], rng[1], rng[2], rng[3]  # in registers as long as nothing else draws
    for i in range(len(u)):
        word, s0, s1, s2, s3 = _advanced(s0, s1, s2, s3)
        layer, x = _in_a_layer(word)
        if abs(x) >= _EDGES[layer + 1]:
            rng[0], rng[1], rng[2], rng[3] = s0, s1, s2, s3
            x = _beyond_the_step(rng, layer, x)
            s0, s1, s2, s3 = rng[0], rng[1], rng[2], rng[3]
        u[i] = x
        squared += x * x
    rng[0], rng[1], rng[2], rng[3] = s0, s1, s2, s3
    return squared


# -- the normal distribution ----------------------------------------------------------------------
#
# The ziggurat (Marsaglia and Tsang, "The ziggurat method for generating random variables", 2000;
# signs and edges as in Doornik, "An improved ziggurat method to generate normal random samples",
# 2005): layers of one area cover the density, a word picks a layer and a point across it. All but
# one point in a hundred lie under the density for certain, and cost a product and a comparison.
# Layer and point come from bits of their own.

_N_LAYERS = 256
#: Where the lowest layer's tail begins, and the area of each layer under exp(-x^2 / 2), x > 0.
_TAIL, _AREA = 3.6541528853610088, 0.00492867323399


def _density(x: float) -> float:
    """Return exp(-x^2 / 2), the standard normal density without its constant factor."""
    return math.exp(-0.5 * x * x)


def _edges() -> NDArray[np.float64]:
    """
    Return the right ends (``_N_LAYERS`` + 1,) of the layers, from the lowest and widest to 0.

    The lowest layer has a tail; its right end is that of a rectangle of the same area and height.
    """
    edges = [_AREA / _density(_TAIL), _TAIL]
    while len(edges) < _N_LAYERS:
        edges.append(math.sqrt(-2.0 * math.log(_density(edges[-1]) + _AREA / edges[-1])))
    return np.array([*edges, 0.0])


_EDGES = _edges()
_HEIGHTS = np.exp(-0.5 * _EDGES**2)


@inlined
def _in_a_layer(word):
    """
    Return a layer, and a point x between its left and right end, chosen by one random ``word``.

    The lowest 8 bits of the word choose the layer, the upper 53 bits the point.
    """
    layer = int(word & np.uint64(_N_LAYERS - 1))
    return layer, ((word >> np.uint64(11)) * 2.0**-52 - 1.0) * _EDGES[layer]


@kernel
def _beyond_the_step(rng, layer, x):
    """
    Return a normal number, given a point ``x`` of a layer that may lie above the density.

    Return ``x`` if a height drawn in the layer is below the density, and draw layer and point
    again otherwise. In the lowest layer, draw from the tail on the side of ``x``.
    """
    while abs(x) >= _EDGES[layer + 1]:
        if layer == 0:
            return math.copysign(_in_the_tail(rng), x)
        low, high = _HEIGHTS[layer], _HEIGHTS[layer + 1]
        if low + (high - low) * uniform(rng) < math.exp(-0.5 * x * x):
            return x
        layer, x = _in_a_layer(_next_word(rng))
    return x


@kernel
def _in_the_tail(rng):
    """Return a number > ``_TAIL`` drawn from the normal distribution's tail (Marsaglia, 1964)."""
    while True:
        beyond = -math.log(1.0 - uniform(rng)) / _TAIL
        if -2.0 * math.log(1.0 - uniform(rng)) > beyond * beyond:
            return _TAIL + beyond


# -- the generator --------------------------------------------------------------------------------


@inlined
def _next_word(s):
    """Return the next 64 random bits of the stream with state ``s`` (4,), and advance ``s``."""
    word, s[0], s[1], s[2], s[3] = _advanced(s[0], s[1], s[2], s[3])
    return word


@inlined
def _advanced(s0, s1, s2, s3):
    """Return the next word of xoshiro256++ from a state of four words, and the state after it."""
    word = _rotated(s0 + s3, 23) + s0
    shifted = s1 << np.uint64(17)
    s2 ^= s0
    s3 ^= s1
    s1 ^= s2
    s0 ^= s3
    return word, s0, s1, s2 ^ shifted, _rotated(s3, 45)


@inlined
def _rotated(word, by):
    """Return the 64-bit ``word`` rotated to the left by ``by`` bits."""
    return (word << np.uint64(by)) | (word >> np.uint64(64 - by))
