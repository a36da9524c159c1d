"""
Random streams: where every draw of a kernel comes from.

A stream is four words, the state of xoshiro256++ (Blackman and Vigna, "Scrambled linear
pseudorandom number generators", 2021), seeded through SplitMix64 as they advise. An array costs
nothing to make and to hand to a kernel; NumPy's ``Generator`` costs more at each request than most
searches take (25 us against .5). Each purpose has a stream of its own, all follow from one seed,
and a stream belongs to one call at a time: drawing moves it on.
"""

import math
from typing import TypeAlias

from hnr_planner.core.kernels import kernel
import numpy as np
from numpy.typing import NDArray

#: State (4,) of a stream.
Stream: TypeAlias = NDArray[np.uint64]

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_WORD = 2**64 - 1


def stream(seed: int, *purpose: int) -> Stream:
    """Return the stream for one purpose, told by whole numbers >= 0, of one ``seed`` >= 0."""
    words = [len(purpose), *purpose, seed & _WORD]
    while seed > _WORD:
        seed >>= 64
        words.append(seed & _WORD)
    return _seeded(np.array(words, dtype=np.uint64))


@kernel
def _seeded(words):
    """Stream told by ``words`` (k,) uint64: they are mixed in, and four words drawn."""
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
    """Output function of SplitMix64."""
    z = (z ^ (z >> np.uint64(30))) * _MIX_1
    z = (z ^ (z >> np.uint64(27))) * _MIX_2
    return z ^ (z >> np.uint64(31))


@kernel
def uniform(rng):
    """Draw uniformly from the multiples of 2^-53 in [0, 1)."""
    return (_next_word(rng) >> np.uint64(11)) * 2.0**-53


@kernel
def normal(rng):
    """Draw from the standard normal distribution (Marsaglia's polar method)."""
    while True:
        x, y = 2.0 * uniform(rng) - 1.0, 2.0 * uniform(rng) - 1.0
        squared = x * x + y * y
        if 0.0 < squared < 1.0:
            return x * math.sqrt(-2.0 * math.log(squared) / squared)


@kernel
def _next_word(s):
    """Draw 64 bits, and move the stream on: xoshiro256++."""
    word = _rotated(s[0] + s[3], 23) + s[0]
    shifted = s[1] << np.uint64(17)
    s[2] ^= s[0]
    s[3] ^= s[1]
    s[1] ^= s[2]
    s[0] ^= s[3]
    s[2] ^= shifted
    s[3] = _rotated(s[3], 45)
    return word


@kernel
def _rotated(word, by):
    return (word << np.uint64(by)) | (word >> np.uint64(64 - by))
