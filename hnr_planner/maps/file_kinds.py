"""Recognise the kind of a file by its first bytes, not by its name."""

from __future__ import annotations

import re

#: Number of bytes of a file that ``kind_of`` needs.
HEAD = 512

#: What a file is, with a pattern of its first bytes.
_KINDS = {
    'PNG image': rb'\x89PNG\r\n\x1a\n',
    'PGM image': rb'P[25][\s#]',
    'PPM image': rb'P[36][\s#]',
    'PBM image': rb'P[14][\s#]',
    'BMP image': rb'BM',
    'PFM image': rb'P[fF]\s',
    'PAM image': rb'P7\s',
    'JPEG image': rb'\xff\xd8\xff',
    'GIF image': rb'GIF8[79]a',
    'TIFF image': rb'II[*+]\0|MM\0[*+]',
    'WebP image': rb'RIFF.{4}WEBP',
    'AVIF or HEIF image': rb'.{4}ftyp(avi|hei|mif)',
    'JPEG 2000 image': rb'\0{3}\x0cjP  ',
    'icon': rb'\0\0\x01\0',
    'TGA image': rb'.\0[\x01\x02\x03\x09\x0a\x0b]\0{5}',
    'XPM image': rb'/\* XPM \*/',
    'Photoshop image': rb'8BPS',
    'GIMP image': rb'gimp xcf',
    'OpenEXR image': rb'v/1\x01',
    'SVG drawing': rb'\s*(<\?xml[^>]*>\s*|<!--.*?-->\s*|<!DOCTYPE[^>]*>\s*)*<svg\b',
    'PDF document': rb'%PDF-',
    'PostScript file': rb'%!PS',
    'gzip archive': rb'\x1f\x8b',
    'ZIP archive': rb'PK\x03\x04',
    'map of the Moving AI benchmarks': rb'type\s+octile\s',
}
#: The kinds that are images.
IMAGES = frozenset(kind for kind in _KINDS if kind.endswith(('image', 'icon', 'drawing')))
_PATTERNS = {kind: re.compile(pattern, re.DOTALL) for kind, pattern in _KINDS.items()}


def kind_of(head: bytes) -> str | None:
    """
    Return the kind of a file, such as ``PNG image``; None where no kind is recognised.

    ``head`` has the first ``HEAD`` bytes of the file, or all bytes of a shorter one.
    """
    return next((kind for kind, pattern in _PATTERNS.items() if pattern.match(head)), None)


def with_article(kind: str) -> str:
    """Return the name of a kind with the article ``a`` or ``an`` before it."""
    # Letters that are spelt out count as they sound: an SVG, a UTF.
    is_vowel = kind[0] in 'aeio' or (kind[:2].isupper() and kind[0] in 'AEFHILMNORSX')
    return f'{"an" if is_vowel else "a"} {kind}'
