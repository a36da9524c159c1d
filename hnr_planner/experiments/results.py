"""
The results of an experiment: a CSV file that grows, and the table that is read from it.

The rows have a fixed order: every case with seed 0, every case with seed 1, and so on. So an
interrupted run resumes where the file ends, a longer run continues a shorter one, and the numbers
of rows of the cases differ by at most one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
import csv
from dataclasses import dataclass
from itertools import count, islice
import json
import math
from pathlib import Path
import platform
from typing import Any, NamedTuple

from hnr_planner import __version__
from hnr_planner.core.errors import HnrError
from hnr_planner.core.kernels.cache_folder import CORE, source_digest
import numpy as np
from numpy.typing import NDArray


class ResultsError(HnrError, ValueError):
    """Error: a results file has rows of other cases, or of another version of the core."""


class Mean(NamedTuple):
    """A mean and half the width of its 95 % interval; nan where the interval is unknown."""

    value: float
    half: float

    def __str__(self) -> str:
        """Return mean and half width, rounded to two significant digits of the half width."""
        if math.isnan(self.value):
            return '-'
        if not math.isfinite(self.half) or self.half == 0.0:
            return f'{self.value:,.4g}'
        digits = max(1 - math.floor(math.log10(self.half)), 0)
        return f'{self.value:,.{digits}f} ± {self.half:,.{digits}f}'


@dataclass(frozen=True)
class Results:
    """A table of columns (n_rows,): floats where all values are numbers, else strings."""

    columns: Mapping[str, NDArray[Any]]

    def __len__(self) -> int:
        """Return the number of rows."""
        return len(next(iter(self.columns.values()), ()))

    def __getitem__(self, column: str) -> NDArray[Any]:
        """Return a column by its name."""
        return self.columns[column]

    def where(self, **values: object) -> Results:
        """Return the rows in which each column named has the value given for it."""
        chosen = np.ones(len(self), dtype=bool)
        for name, value in values.items():
            chosen &= self[name] == value
        return self.rows(chosen)

    def rows(self, chosen: NDArray[np.bool_]) -> Results:
        """Return the rows chosen by a mask (n_rows,)."""
        return Results({name: column[chosen] for name, column in self.columns.items()})

    def of(self, case: Any) -> Results:
        """Return the rows whose columns equal all fields of a case."""
        return self.where(**case._asdict())

    def distinct(self, column: str) -> list[Any]:
        """Return the distinct values of a column, in the order of their first row."""
        return list(dict.fromkeys(self[column].tolist()))

    def mean(self, column: str) -> Mean:
        """
        Return the mean of a column of numbers, with its 95 % interval by the normal distribution.

        Values that are nan or inf are left out; the mean is nan if no value is left.
        """
        values = self[column]
        values = values[np.isfinite(values)]
        if len(values) == 0:
            return Mean(math.nan, math.nan)
        error = values.std(ddof=1) / math.sqrt(len(values)) if len(values) > 1 else math.nan
        return Mean(float(values.mean()), 1.96 * float(error))

    @property
    def runs(self) -> int:
        """Number of runs of every case."""
        return int(self['seed'].max()) + 1 if len(self) else 0


class ResultsFile:
    """
    The CSV file of an experiment's results, with a note of the versions that computed them.

    Parameters
    ----------
    file : Path
        The CSV file; the note has the same name and ends in .json.
    cases : sequence of NamedTuple
        The cases: their fields are the first columns, and the seed is the next one.
    fresh : bool
        Whether existing results are discarded.

    Raises
    ------
    ResultsError
        When the existing results are those of other cases, or of other sources of the core.

    """

    def __init__(self, file: Path, cases: Sequence[Any], *, fresh: bool = False) -> None:
        """Read the existing rows, and drop a last row that was not written completely."""
        self._file, self._note, self._cases = file, file.with_suffix('.json'), cases
        if fresh or not (file.exists() and self._note.exists()):
            file.write_text('', encoding='utf-8')
            self._note.write_text(json.dumps(made_with(), indent=2) + '\n', encoding='utf-8')
        #: Versions that the rows were computed with.
        self.made_with = self._check_note()
        lines = file.read_text(encoding='utf-8').splitlines(keepends=True)
        whole = [line for line in lines if line.endswith('\n')]
        self._check_rows(whole)
        file.write_text(''.join(whole), encoding='utf-8')
        self.n_rows = max(len(whole) - 1, 0)

    def tasks(self, runs: int) -> list[tuple[Any, int]]:
        """Return (case, seed) of each row missing for ``runs`` runs, in the file's order."""
        endless = ((case, seed) for seed in count() for case in self._cases)
        return list(islice(endless, self.n_rows, max(runs * len(self._cases), self.n_rows)))

    def extend(self, rows: Iterable[tuple[Any, int, Mapping[str, float]]]) -> None:
        """Write rows of case, seed and measured columns, each as soon as it is computed."""
        with self._file.open('a', encoding='utf-8', newline='') as file:
            writer = csv.writer(file, lineterminator='\n')
            for case, seed, measured in rows:
                if self.n_rows == 0:
                    writer.writerow([*case._fields, 'seed', *measured])
                writer.writerow([*case, seed, *measured.values()])
                file.flush()
                self.n_rows += 1

    def read(self, runs: int) -> Results:
        """Return the results of the first ``runs`` runs of every case; the file must have them."""
        with self._file.open(encoding='utf-8', newline='') as file:
            header, *rows = list(csv.reader(file))
        columns = zip(*rows[: runs * len(self._cases)], strict=True)
        return Results(
            {name: _array(column) for name, column in zip(header, columns, strict=True)}
        )

    def _check_note(self) -> dict[str, str]:
        """Return the note; raise ResultsError if rows are of other sources of the core."""
        note: dict[str, str] = json.loads(self._note.read_text(encoding='utf-8'))
        now = made_with()
        if note['core'] != now['core']:
            raise ResultsError(
                f'{self._file} holds results of other sources of the core ({note["core"]}, now '
                f'{now["core"]}): choose another folder, or begin afresh'
            )
        return note

    def _check_rows(self, lines: list[str]) -> None:
        """Raise ResultsError unless ``lines`` are those of the cases, in order, after a header."""
        for number, row in enumerate(csv.reader(lines[1:])):
            seed, k = divmod(number, len(self._cases))
            expected = [str(value) for value in (*self._cases[k], seed)]
            if row[: len(expected)] != expected:
                raise ResultsError(
                    f'{self._file}: row {number + 1} should begin with {",".join(expected)} and '
                    f'is {",".join(row)}: choose another folder, or begin afresh'
                )


def made_with() -> dict[str, str]:
    """Return what results depend on, by name: versions and a digest of the core's sources."""
    import numba

    return {
        'hnr_planner': __version__,
        'core': source_digest(CORE),
        'python': platform.python_version(),
        'numpy': np.__version__,
        'numba': numba.__version__,
        'machine': platform.machine(),
    }


def markdown(header: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a Markdown table whose columns after the first are aligned to the right."""
    lines = [header, ['---', *['---:'] * (len(header) - 1)], *rows]
    return '\n'.join(f'| {" | ".join(map(str, line))} |' for line in lines) + '\n'


def _array(texts: Sequence[str]) -> NDArray[Any]:
    """Return a column as floats where all values are numbers, else as strings."""
    try:
        return np.array(texts, dtype=float)
    except ValueError:
        return np.array(texts)
