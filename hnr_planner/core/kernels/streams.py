"""
Random streams: the random numbers of kernels.

A stream is four words, the state of xoshiro256++ (Blackman and Vigna, "Scrambled linear
pseudorandom number generators", 2021), seeded through SplitMix64 as they advise. An array costs
nothing to make and to hand to a kernel; NumPy's ``Generator`` costs more at each request than most
searches take (25 us against .5). Each purpose has a stream of its own, all follow from one seed,
and a stream belongs to one call at a time: drawing moves it on.
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
    """Return the stream of a ``seed`` >= 0 for one purpose, which whole numbers >= 0 name."""
    words = [len(purpose), *purpose, seed & _WORD]
    while seed > _WORD:
        seed >>= 64
        words.append(seed & _WORD)
    return _seeded(np.array(words, dtype=np.uint64))


@kernel
def _seeded(words):
    """Return the state (4,) of the stream that ``words`` (k,) uint64 name."""
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
    """Return the output function of SplitMix64 at ``z``."""
    z = (z ^ (z >> np.uint64(30))) * _MIX_1
    z = (z ^ (z >> np.uint64(27))) * _MIX_2
    return z ^ (z >> np.uint64(31))


@inlined
def uniform(rng):
    """Draw uniformly from the multiples of 2^-53 in [0, 1)."""
    return (_next_word(rng) >> np.uint64(11)) * 2.0**-53


@inlined
def normal(rng):
    """Draw from the standard normal distribution."""
    layer, x = _in_a_layer(_next_word(rng))
    return x if abs(x) < _EDGES[layer + 1] else _beyond_the_step(rng, layer, x)


@inlined
def draw_normals(rng, u):
    """Draw ``u`` (n,) from the standard normal distribution; return its squared length."""
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


# -- the normal law -------------------------------------------------------------------------------
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
    """Return the density of the normal distribution, without its factor."""
    return math.exp(-0.5 * x * x)


def _edges() -> NDArray[np.float64]:
    """Right ends (layers + 1,), the widest first; the lowest is as wide as if it had no tail."""
    edges = [_AREA / _density(_TAIL), _TAIL]
    while len(edges) < _N_LAYERS:
        edges.append(math.sqrt(-2.0 * math.log(_density(edges[-1]) + _AREA / edges[-1])))
    return np.array([*edges, 0.0])


_EDGES = _edges()
_HEIGHTS = np.exp(-0.5 * _EDGES**2)


@inlined
def _in_a_layer(word):
    """Pick a layer by the lowest 8 bits, and a point across it, left or right, by the upper 53."""
    layer = int(word & np.uint64(_N_LAYERS - 1))
    return layer, ((word >> np.uint64(11)) * 2.0**-52 - 1.0) * _EDGES[layer]


@kernel
def _beyond_the_step(rng, layer, x):
    """Finish the draw of a point ``x`` that may lie above the density."""
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
    """Draw from the normal distribution beyond ``_TAIL`` (Marsaglia, 1964)."""
    while True:
        beyond = -math.log(1.0 - uniform(rng)) / _TAIL
        if -2.0 * math.log(1.0 - uniform(rng)) > beyond * beyond:
            return _TAIL + beyond


# -- the generator --------------------------------------------------------------------------------


@inlined
def _next_word(s):
    """Draw 64 bits, and move the stream on."""
    word, s[0], s[1], s[2], s[3] = _advanced(s[0], s[1], s[2], s[3])
    return word


@inlined
def _advanced(s0, s1, s2, s3):
    """Return 64 bits, and the state after it: xoshiro256++."""
    word = _rotated(s0 + s3, 23) + s0
    shifted = s1 << np.uint64(17)
    s2 ^= s0
    s3 ^= s1
    s1 ^= s2
    s0 ^= s3
    return word, s0, s1, s2 ^ shifted, _rotated(s3, 45)


@inlined
def _rotated(word, by):
    """Return 64 bits rotated to the left."""
    return (word << np.uint64(by)) | (word >> np.uint64(64 - by))
