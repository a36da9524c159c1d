"""Draw the picture: length against time on maps, time against width on spirals."""

from __future__ import annotations

from pathlib import Path

from benchmarks.competitors.ompl_planners import NATIVE, WHEEL
from benchmarks.race import Standing
from benchmarks.standings import course, summary
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
import numpy as np
from numpy.typing import NDArray

#: Groups of the two panels on the maps, and colours of the lines beside ours.
PANELS = {'OMPL': (NATIVE, WHEEL), 'grid search': ('grid',)}
OURS = ('#D55E00', '#E69F00', '#7F3B08', '#FDB863', '#B35806', '#F4A582')
OTHERS = (
    '#0072B2',
    '#56B4E9',
    '#009E73',
    '#332288',
    '#44AA99',
    '#117733',
    '#88CCEE',
    '#999933',
    '#661100',
    '#AA4499',
    '#CC79A7',
    '#6699CC',
    '#555555',
    '#999999',
)
#: Our competitors in the panels on maps, and all competitors in the panel on spirals.
SHOWN = ('auto (ours)', 'auto + simplify (ours)', 'auto, optimized (ours)')
ON_SPIRALS = (
    'auto (ours)',
    f'RRTConnect ({NATIVE})',
    f'BKPIECE1 ({NATIVE})',
    f'KPIECE1 ({NATIVE})',
    f'SBL ({NATIVE})',
    f'RRTConnect ({WHEEL})',
    'nano-astar (grid)',
    'Theta* (grid)',
    'wavefront (grid)',
)
#: Least excess over the best known length that is drawn [%]; smaller ones are drawn there.
LEAST = 0.05
#: Positions of a name beside the end of its line [points], the best first.
PLACES = tuple(
    ((x, y), align)
    for y in (3, -9, 12, -18, 21, -27, 30, -36)
    for x, align in ((6, 'left'), (-6, 'right'))
)

Floats = NDArray[np.float64]
#: Label and colour of a competitor, and the coordinates of its line.
Line = tuple[str, str, Floats, Floats]


def draw(standings: list[Standing], file: Path) -> None:
    """Draw the standings into a PNG file."""
    figure = Figure(figsize=(16, 6.5), layout='constrained')
    panels = figure.subplots(1, 3)
    maps = [row for row in standings if not row.problem.is_spiral]
    spirals = [row for row in standings if row.problem.is_spiral]
    marks = []
    for axes, (name, groups) in zip(panels, PANELS.items(), strict=False):
        marks.append(_plot(axes, _on_maps(maps, groups)))
        axes.set(xscale='log', yscale='log', xlim=(10e-3, 1e3))
        axes.set(xlabel='time [ms]', ylabel='longer than the best known [%]')
        axes.set_title(
            f'ours and {name}, {len(maps)} maps: medians, one run and more', fontsize=10
        )
    marks.append(_plot(panels[2], _over_spirals(spirals), marker='o'))
    panels[2].invert_xaxis()
    panels[2].set(yscale='log', xlabel='width of the corridor [m]', ylabel='time to a path [ms]')
    panels[2].set_title('spirals: a line ends where most runs fail in 1 s', fontsize=10)
    panels[2].margins(x=0.25)
    FigureCanvasAgg(figure).draw()  # settles where everything is
    for axes, ends in zip(panels, marks, strict=True):
        axes.grid(alpha=0.3)
        axes.spines[['top', 'right']].set_visible(False)
        _name(axes, ends)
    figure.savefig(file, dpi=100)


def _on_maps(standings: list[Standing], groups: tuple[str, ...]) -> list[Line]:
    """Return time and length after each step, medians over the maps."""
    lines: list[Line] = []
    for k, label, group in _competitors(standings):
        if group not in groups and label not in SHOWN:
            continue
        times, ratios = _typical([course(row.entries[k], row) for row in standings])
        drawn = np.isfinite(ratios) & (ratios > ratios[-1])
        drawn[np.argmin(ratios)] = np.isfinite(ratios.min())
        if drawn.any():
            longer = np.maximum(100 * (ratios[drawn] - 1), LEAST)
            lines.append((label, _colour(label, group, lines), 1e3 * times[drawn], longer))
    return lines


def _typical(courses: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """Return medians over courses, step by step; a course that ends keeps its last values."""
    steps = int(np.median([len(times) for times, _ in courses]))
    longer = [
        [np.pad(values[:steps], (0, max(steps - len(values), 0)), 'edge') for values in each]
        for each in courses
    ]
    times, ratios = np.quantile(longer, 0.5, axis=0, method='inverted_cdf')
    return times, ratios


def _over_spirals(standings: list[Standing]) -> list[Line]:
    lines: list[Line] = []
    widths = np.array([float(standing.problem.name.split()[1]) for standing in standings])
    for k, label, group in _competitors(standings):
        if label not in ON_SPIRALS:
            continue
        times = np.array([summary(row.entries[k], row).seconds for row in standings])
        drawn = np.isfinite(times)
        if drawn.any():
            colour = _colour(label, group, lines)
            lines.append((label, colour, widths[drawn], 1e3 * times[drawn]))
    return lines


def _competitors(standings: list[Standing]) -> list[tuple[int, str, str]]:
    entries = standings[0].entries if standings else []
    return [(k, e.competitor.label, e.competitor.group) for k, e in enumerate(entries)]


def _colour(label: str, group: str, lines: list[Line]) -> str:
    """Return the next unused colour, of those for ours or for the others."""
    colours = OURS if group == 'ours' else OTHERS
    used = {colour for _, colour, *_ in lines}
    return next((colour for colour in colours if colour not in used), 'black')


def _plot(axes: Axes, lines: list[Line], marker: str = '') -> list[tuple[str, str, float, float]]:
    """Draw the lines; return label, colour and end of each, from which it gets its name."""
    ends = []
    for label, colour, x, y in lines:
        width = 2.5 if label.endswith('(ours)') else 1.2
        axes.plot(x, y, color=colour, linewidth=width, marker=marker, markersize=4)
        axes.plot(x[0], y[0], 'o', color=colour, markersize=5)
        ends.append((label.removesuffix(' (ours)').removesuffix(' (grid)'), colour, x[-1], y[-1]))
    return ends


def _name(axes: Axes, ends: list[tuple[str, str, float, float]]) -> None:
    """Write a name beside the end of each line, without overlap."""
    points = axes.transData.transform([(x, y) for _, _, x, y in ends] or np.empty((0, 2)))
    taken = [Bbox.from_bounds(x - 3, y - 3, 6, 6) for x, y in points]
    for name, colour, x, y in ends:
        for offset, align in PLACES:
            text = axes.annotate(
                name,
                (x, y),
                xytext=offset,
                textcoords='offset points',
                fontsize=8,
                color=colour,
                ha=align,
            )
            box = text.get_window_extent()
            if not any(box.overlaps(other) for other in taken):
                break
            if (offset, align) != PLACES[-1]:
                text.remove()
        taken.append(box)
