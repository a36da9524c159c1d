"""The picture: time against length on the maps, and time against width on the spirals."""

from __future__ import annotations

from pathlib import Path

from benchmarks.race import Standing
from benchmarks.standings import Summary, summary
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox
import numpy as np

#: Colours that stay apart for all kinds of sight (Okabe and Ito); the shape says it once more.
LOOKS = {'ours': ('#D55E00', 'o'), 'OMPL': ('#0072B2', 's'), 'grid': ('#009E73', '^')}
#: Of the many, those whose line over the spirals says something.
ON_SPIRALS = ('auto', 'RRTConnect', 'BKPIECE1', 'KPIECE1', 'SBL', 'A*', 'wavefront')
#: Nearer to the best than this [%] is drawn here.
LEAST = 0.01
#: Where a name may stand beside its mark [points], best first.
PLACES = (
    ((6, 3), 'left'),
    ((6, -9), 'left'),
    ((-6, 3), 'right'),
    ((-6, -9), 'right'),
    ((6, 12), 'left'),
    ((6, -18), 'left'),
)

Mark = tuple[str, tuple[float, float]]


def draw(standings: list[Standing], file: Path) -> None:
    """Draw the standings into a PNG file."""
    figure = Figure(figsize=(10, 4.6), layout='constrained')
    left, right = figure.subplots(1, 2)
    on_maps = _maps(left, [row for row in standings if not row.problem.is_spiral])
    on_spirals = _spirals(right, [row for row in standings if row.problem.is_spiral])
    FigureCanvasAgg(figure).draw()  # settles where everything is
    _name(left, on_maps)
    _name(right, on_spirals)
    figure.savefig(file, dpi=110)


def _maps(axes: Axes, standings: list[Standing]) -> list[Mark]:
    marks = []
    for name, group, found in _by_competitor(standings):
        colour, marker = LOOKS[group]
        seconds = np.array([row.seconds for row in found])
        ratios = np.array([row.ratio for row in found])
        if not (np.isfinite(seconds).all() and np.isfinite(ratios).all()):
            continue
        time, ratio = 1e3 * np.exp(np.log(seconds).mean()), np.exp(np.log(ratios).mean())
        longer = max(100 * (ratio - 1), LEAST)
        axes.plot(time, longer, marker, color=colour, markersize=7)
        marks.append((name, (time, longer)))
    axes.set(xscale='log', yscale='log', xlabel='time [ms]', ylabel='longer than the best [%]')
    axes.set_title(f'{len(standings)} maps: geometric means of the medians', fontsize=10)
    _tidy(axes)
    return marks


def _spirals(axes: Axes, standings: list[Standing]) -> list[Mark]:
    marks = []
    widths = np.array([float(standing.problem.name.split()[1]) for standing in standings])
    for name, group, found in _by_competitor(standings):
        if name not in ON_SPIRALS:
            continue
        colour, marker = LOOKS[group]
        times = 1e3 * np.array([row.seconds for row in found])
        style = {'color': colour, 'marker': marker, 'markersize': 4}
        axes.plot(widths, times, linewidth=2.2 if group == 'ours' else 1.0, **style)
        for k in np.flatnonzero(np.isfinite(times))[-1:]:
            marks.append((name, (widths[k], times[k])))
    axes.invert_xaxis()
    axes.set(yscale='log', xlabel='width of the corridor [m]', ylabel='time to a path [ms]')
    axes.set_title('spirals: a line ends where most runs fail in 1 s', fontsize=10)
    axes.margins(x=0.15)
    _tidy(axes)
    return marks


def _name(axes: Axes, marks: list[Mark]) -> None:
    """Write a name beside each mark, where none stands yet."""
    points = axes.transData.transform([at for _, at in marks])
    taken = [Bbox.from_bounds(x - 4, y - 4, 8, 8) for x, y in points]
    for name, at in marks:
        for offset, align in PLACES:
            text = axes.annotate(
                name, at, xytext=offset, textcoords='offset points', fontsize=8, ha=align
            )
            box = text.get_window_extent()
            if not any(box.overlaps(other) for other in taken):
                break
            if (offset, align) != PLACES[-1]:
                text.remove()
        taken.append(box)


def _by_competitor(standings: list[Standing]) -> list[tuple[str, str, list[Summary]]]:
    if not standings:
        return []
    return [
        (
            entry.competitor.name,
            entry.competitor.group,
            [summary(standing.entries[k], standing) for standing in standings],
        )
        for k, entry in enumerate(standings[0].entries)
    ]


def _tidy(axes: Axes) -> None:
    axes.grid(alpha=0.3)
    axes.spines[['top', 'right']].set_visible(False)
