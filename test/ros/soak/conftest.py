"""Figures of a run, told at its end."""

from collections.abc import Callable

import pytest

FIGURES: list[str] = []


@pytest.fixture
def tell(request: pytest.FixtureRequest) -> Callable[[str], None]:
    """Return what takes a figure of this test, in words."""
    return lambda words: FIGURES.append(f'{request.node.name}: {words}')


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Print all figures."""
    if FIGURES:
        terminalreporter.section('under load and faults')
    for line in FIGURES:
        terminalreporter.line(line)
