"""
Parse YAML as map_server's parser reads it.

Nav2 reads map files with yaml-cpp: scalars are text until a number or a flag is asked for, the
first of two equal keys counts, tabs are blanks, and bytes need not be UTF-8. No Python parser does
all of this. This module uses the parser of libyaml, through PyYAML: it is maintained and packaged
for Ubuntu, and takes tabs for blanks inside a line, which the pure Python scanners of PyYAML and
ruamel.yaml refuse. Only its node tree is used, never its types, so YAML 1.1's octal numbers and
implicit booleans do not occur; ``prepared`` removes what is left of the difference before parsing.
"""

from __future__ import annotations

import codecs
from collections import Counter
import os
import re
from typing import Any, NamedTuple

import yaml

#: A scalar as text (None for a plain null), a sequence of such, or what else a node is, in words.
Value = str | None | list[Any] | dict[str, Any]

#: PyYAML without libyaml still reads most files, but none with tabs.
_Loader: Any = getattr(yaml, 'CBaseLoader', yaml.BaseLoader)

#: Each byte beyond printable ASCII, moved to Unicode's private area and back: libyaml would refuse
#: control characters, and bytes that are not UTF-8; map_server ignores them or passes them on.
_HIDDEN = {byte: 0xF700 + byte for byte in (*range(9), 11, 12, *range(14, 32), *range(127, 256))}
_SHOWN = {hidden: byte for byte, hidden in _HIDDEN.items()}
_ENCODINGS = {
    codecs.BOM_UTF8: 'utf-8',
    codecs.BOM_UTF32_LE: 'utf-32',  # before UTF-16, whose mark it begins with
    codecs.BOM_UTF32_BE: 'utf-32',
    codecs.BOM_UTF16_LE: 'utf-16',
    codecs.BOM_UTF16_BE: 'utf-16',
}

_DIRECTIVES = re.compile(r'\A(?:[ \t]*(?:#.*)?\n|%.*\n)+')
_INDENTATION = re.compile(r'^(?:[ \t]+|-(?=[ \t]))+', re.MULTILINE)
_NULLS = ('', '~', 'null', 'Null', 'NULL')

_NUMBER = re.compile(r'[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?')
_WHOLE = re.compile(r'([+-]?)(?:(0[xX][0-9a-fA-F]+)|0([0-7]*)|([1-9][0-9]*))')
_TRUE, _FALSE = ('y', 'yes', 'true', 'on'), ('n', 'no', 'false', 'off')


class YamlError(ValueError):
    """The text is no YAML; the message says where, in one line."""


class Mapping(NamedTuple):
    """The first document of a YAML file: values by key, and the keys that occur repeatedly."""

    values: dict[str, Value]
    repeated: tuple[str, ...]


def read_document(content: bytes) -> Mapping | Value:
    """
    Parse the first document of a file.

    Returns
    -------
    Mapping or Value
        The document; of a key that occurs repeatedly the first value.

    Raises
    ------
    YamlError
        When it is no YAML.

    """
    try:
        loader = _Loader(prepared(content))
        node = loader.get_node() if loader.check_node() else None
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        where = str(error).replace('in "<unicode string>", ', 'in ')
        raise YamlError(_printable(_text(' '.join(where.split())))) from error
    if not isinstance(node, yaml.MappingNode):
        return _value(node)
    pairs = [(_value(key), value) for key, value in node.value]
    counts = Counter(key for key, _ in pairs if isinstance(key, str))
    values = {key: _value(value) for key, value in reversed(pairs) if isinstance(key, str)}
    return Mapping(values, tuple(key for key, count in counts.items() if count > 1))


def prepared(content: bytes) -> str:
    """
    Return the text of a file in the form that libyaml reads as yaml-cpp reads the file.

    Directives such as ``%YAML:1.0`` are blanked, tabs in indentation become spaces, and bytes
    beyond printable ASCII go to Unicode's private area, from which ``_text`` brings them back.
    """
    for mark, encoding in _ENCODINGS.items():
        if content.startswith(mark):
            content = content.decode(encoding).lstrip('\ufeff').encode()
            break
    text = content.decode('latin-1').replace('\r\n', '\n').replace('\r', '\n').translate(_HIDDEN)
    text = _DIRECTIVES.sub(lambda head: '\n' * head[0].count('\n'), text)
    return _INDENTATION.sub(lambda blanks: blanks[0].replace('\t', ' '), text)


def as_number(value: Value) -> float | None:
    """Return a scalar as yaml-cpp converts it to a double; None where it is no finite number."""
    if not isinstance(value, str) or not _NUMBER.fullmatch(value.rstrip()):
        return None
    number = float(value)
    return number if abs(number) < float('inf') else None


def as_flag(value: Value) -> bool | None:
    """Return a scalar as map_server reads a flag: an integer or a boolean; None where neither."""
    if not isinstance(value, str):
        return None
    whole = _WHOLE.fullmatch(value.rstrip())
    if whole:
        return any(digit not in '0xX' for digit in whole[0].lstrip('+-'))
    if value not in (value.lower(), value.upper(), value.capitalize()):
        return None
    return {**dict.fromkeys(_TRUE, True), **dict.fromkeys(_FALSE, False)}.get(value.lower())


def as_file_name(value: Value) -> str | None:
    """Return a scalar as a name of a file, whatever its encoding; None where it cannot be one."""
    if not isinstance(value, str) or not value.strip() or '\0' in value:
        return None
    return os.fsdecode(value.encode('utf-8', 'surrogateescape'))


def shown(value: Value) -> str:
    """Return a value as it fits into a message of one line."""
    if isinstance(value, list):
        text = f'[{", ".join(map(shown, value))}]'
    elif isinstance(value, dict):
        text = f'{{{", ".join(f"{key}: {shown(inner)}" for key, inner in value.items())}}}'
    else:
        text = 'nothing' if value is None else _quoted(value)
    return text if len(text) <= 60 else f'{text[:57]}...'


def _value(node: Any, depth: int = 1) -> Value:
    """Return a node as text and lists, one level deep: aliases may make a tree endless."""
    if node is None:
        return None
    if isinstance(node, yaml.ScalarNode):
        is_null = not node.style and node.value in _NULLS
        return None if is_null else _text(node.value)
    if depth == 0:
        return '...'
    if isinstance(node, yaml.SequenceNode):
        return [_value(item, depth - 1) for item in node.value]
    return {str(_value(key, 0)): _value(item, depth - 1) for key, item in node.value}


def _text(raw: str) -> str:
    """Return parsed text with the hidden bytes restored; bytes not UTF-8 become surrogates."""
    parts = (
        bytes([_SHOWN[ord(char)]]) if ord(char) in _SHOWN else char.encode('utf-8', 'replace')
        for char in raw
    )
    return b''.join(parts).decode('utf-8', 'surrogateescape')


def _printable(text: str) -> str:
    """Return text with the bytes that are not UTF-8 escaped."""
    return text.encode('utf-8', 'surrogateescape').decode('utf-8', 'backslashreplace')


def _quoted(text: str) -> str:
    """Return a scalar for a message, in quotes where it is blank or not printable."""
    return text if text.strip() and text.isprintable() else repr(_printable(text))
