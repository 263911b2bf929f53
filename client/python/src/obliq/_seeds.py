"""Noise and independent speckle of each frame's own, from one seed and the frame's place in a data set."""
from __future__ import annotations

import operator

WORD = (1 << 64) - 1


def mix64(word: int) -> int:
    """The finaliser of SplitMix64 (Steele, Lea and Flood, "Fast splittable pseudorandom number generators", 2014), as
    terrain/base/hash.h has it."""
    word = (word + 0x9E3779B97F4A7C15) & WORD
    word = (word ^ word >> 30) * 0xBF58476D1CE4E5B9 & WORD
    word = (word ^ word >> 27) * 0x94D049BB133111EB & WORD
    return word ^ word >> 31


def checked(seed: int) -> int:
    """The seed, where it is one."""
    try:
        seed = operator.index(seed)
    except TypeError:
        raise TypeError(f"seed: found {seed!r}; allowed: a whole number") from None
    if not 0 <= seed <= WORD:
        raise ValueError(f"seed: found {seed}; allowed: 0 to {WORD}")
    return seed


def draw(seed: int, place: int, speckle_per_frame: bool = False) -> dict[str, int]:
    """Settings by which the frame at a place, from 0, has noise and independent speckle that no other has. Both follow from
    noise_frame. Speckle of the ground stays that of the ground, unless speckle_per_frame."""
    # Hashed before the place joins it: with seed ^ place, neighbouring seeds would share frames in another order.
    number = mix64(mix64(seed) ^ place)
    own = {"noise_frame": number}
    if speckle_per_frame:
        own["speckle_seed"] = _signed(mix64(number))
    return own


def _signed(word: int) -> int:
    return word - (1 << 64) if word >> 63 else word
