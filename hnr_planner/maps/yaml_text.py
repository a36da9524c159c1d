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

#: Value of a node: a scalar as text (None for a plain null), or a list or dict of scalars, in
#: which ``...`` stands for a nested list or mapping.
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
    """Error that a file is not valid YAML; the message, of one line, says what and where."""


class Mapping(NamedTuple):
    """
    Mapping that a YAML file holds as its first document.

    ``values`` has the value of each key, the first one where the key occurs repeatedly;
    ``repeated`` has the names of the keys that do.
    """

    values: dict[str, Value]
    repeated: tuple[str, ...]


def read_document(content: bytes) -> Mapping | Value:
    """
    Parse the first document of a YAML file, given the file's bytes.

    Returns
    -------
    Mapping or Value
        A ``Mapping`` where the document is a YAML mapping, else its text or list; None where it
        is a plain null, or the file holds no document.

    Raises
    ------
    YamlError
        When ``content`` is not valid YAML.

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
    """Return the double that yaml-cpp converts a scalar to; None if it is no finite number."""
    if not isinstance(value, str) or not _NUMBER.fullmatch(value.rstrip()):
        return None
    number = float(value)
    return number if abs(number) < float('inf') else None


def as_flag(value: Value) -> bool | None:
    """
    Return the truth of a scalar as map_server reads a flag.

    An integer is true unless it is 0; y, yes, true and on are true, n, no, false and off are
    false, all in lower case, in upper case or capitalised. It is None for anything else.
    """
    if not isinstance(value, str):
        return None
    whole = _WHOLE.fullmatch(value.rstrip())
    if whole:
        return any(digit not in '0xX' for digit in whole[0].lstrip('+-'))
    if value not in (value.lower(), value.upper(), value.capitalize()):
        return None
    return {**dict.fromkeys(_TRUE, True), **dict.fromkeys(_FALSE, False)}.get(value.lower())


def as_file_name(value: Value) -> str | None:
    """
    Return a scalar as the name of a file, with bytes in any encoding.

    It is None where the value is no text, is blank, or contains a null character.
    """
    if not isinstance(value, str) or not value.strip() or '\0' in value:
        return None
    return os.fsdecode(value.encode('utf-8', 'surrogateescape'))


def shown(value: Value) -> str:
    """Return a value as text for a message: in one line, cut to at most 60 characters."""
    if isinstance(value, list):
        text = f'[{", ".join(map(shown, value))}]'
    elif isinstance(value, dict):
        text = f'{{{", ".join(f"{key}: {shown(inner)}" for key, inner in value.items())}}}'
    else:
        text = 'nothing' if value is None else _quoted(value)
    return text if len(text) <= 60 else f'{text[:57]}...'


def _value(node: Any, depth: int = 1) -> Value:
    """
    Return a node as text, None for a plain null, or a list or dict of its items.

    Items that are lists or mappings themselves are ``...``, since aliases may make a tree endless.
    """
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
    """
    Return parsed text, its bytes restored that ``prepared`` moved to Unicode's private area.

    Bytes that are not UTF-8 become surrogates, as ``surrogateescape`` writes them.
    """
    parts = (
        bytes([_SHOWN[ord(char)]]) if ord(char) in _SHOWN else char.encode('utf-8', 'replace')
        for char in raw
    )
    return b''.join(parts).decode('utf-8', 'surrogateescape')


def _printable(text: str) -> str:
    """Return text whose surrogates, for bytes that are not UTF-8, are backslash escapes."""
    return text.encode('utf-8', 'surrogateescape').decode('utf-8', 'backslashreplace')


def _quoted(text: str) -> str:
    """Return the text of a scalar for a message, in quotes where it is blank or not printable."""
    return text if text.strip() and text.isprintable() else repr(_printable(text))
