"""Determine how much memory this process can still allocate."""

from __future__ import annotations

import math
from pathlib import Path
import resource

GIB = 2**30


def available_memory() -> float:
    """
    Return how many bytes this process can still allocate; inf where the system has no figure.

    It is the least of what the machine has free and what two limits leave: that of the control
    group (a container) and that of the address space (``ulimit -v``).
    """
    return min(_of_the_machine(), _of_the_control_group(), _of_the_address_space())


def in_words(n_bytes: float) -> str:
    """Return a number of bytes as text: in GiB from 1 GiB on, else in MiB."""
    return f'{n_bytes / GIB:.1f} GiB' if n_bytes >= GIB else f'{n_bytes / 2**20:.0f} MiB'


def _of_the_machine() -> float:
    for line in _read('/proc/meminfo').splitlines():
        name, _, rest = line.partition(':')
        if name == 'MemAvailable':
            return 1024.0 * int(rest.split()[0])
    return math.inf


def _of_the_control_group() -> float:
    """
    Return how many bytes the memory limits of control groups (version 2) leave.

    It is the least of this process's group and of all groups around it; inf where none
    has a limit.
    """
    name = _read('/proc/self/cgroup').strip().rpartition('::')[2]
    root = Path('/sys/fs/cgroup')
    folder = root / name.lstrip('/')
    least = math.inf
    for group in (folder, *folder.parents):
        limit, used = (_read(group / f'memory.{what}').strip() for what in ('max', 'current'))
        if limit.isdigit() and used.isdigit():
            least = min(least, int(limit) - int(used) + _reclaimable(group))
        if group == root:
            break
    return max(least, 0.0)


def _reclaimable(group: Path) -> int:
    """Return how many bytes of a group's cached files the kernel gives up when memory is short."""
    words = [line.split() for line in _read(group / 'memory.stat').splitlines()]
    return sum(int(value) for name, value in words if name == 'inactive_file')


def _of_the_address_space() -> float:
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    pages = _read('/proc/self/statm').split()
    return float(limit - int(pages[0]) * resource.getpagesize()) if pages else math.inf


def _read(path: str | Path) -> str:
    try:
        return Path(path).read_text()
    except OSError:
        return ''
