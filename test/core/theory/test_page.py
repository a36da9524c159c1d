"""Every figure in the tables of docs/theory.md is the value of its function."""

import math
from pathlib import Path
from test.core.theory import errors
from test.core.theory.paths import (
    AROUND_THE_U,
    N_LINES,
    N_WALKS,
    theory_of,
    THROUGH_THE_DOOR,
    walks_of,
)
from test.core.theory.sets import DISC, L_SET, SQUARE, two_rooms, U_SET
from test.core.theory.stars import DIVIDED, divided, SMOOTH, smooth, walked
from test.laws.maps import SPIRAL, TWO_ROOMS
from test.sweeps import sweep

from hnr_planner.core import BallSpace, BoxSpace, GridSpace, ShearedSpace
from hnr_planner.core.theory import (
    annulus_sector_links,
    ball_boundary_ratio,
    ball_image,
    best_cut,
    cell_flow,
    chain_distance,
    corrected_conductance,
    cross_ratio_distance,
    link_diameter,
    log_ball_volume,
    mended_conductance,
    mixing_bound,
    polygon_area,
    printed_conductance,
    step_length,
    step_probability,
    transition_density,
    view,
)
import pytest

PAGE = Path(__file__).resolve().parents[3] / 'docs' / 'theory.md'
BANANA = ShearedSpace(BallSpace((0.0, 0.0), math.pi**-0.5), 2.0)


def rows():
    """Return the rows of the page's tables by their first cell."""
    lines = [line for line in PAGE.read_text().splitlines() if line.startswith('| ')]
    return {line.split('|')[1].strip(): line for line in lines}


def quantities():
    parts = (BoxSpace((0, 0), (1, 1)), BoxSpace((1, 0), (2, 1)), BoxSpace((0, 1), (1, 2)))
    yield 'density', [f'{transition_density(DISC, (0, 0), (0.5, 0))[0]:.4f}']
    yield 'step', [f'{step_probability(L_SET, (0.5, 0.4), part):.4f}' for part in parts]
    yield 'view', [f'{polygon_area(view(L_SET, u)):.4f}' for u in ((1.5, 0.5), (1.75, 0.75))]
    yield 'view', [f'{polygon_area(view(U_SET, (1, 8))):.4f}']
    yield 'short step', [f'{step_length(DISC, u):.4f}' for u in ((0, 0), (0.9, 0))]
    yield 'short step', [f'{step_length(SQUARE, (0.9, 0.05)):.4f}']
    ends = (0.25, 0.5), (1.25, 0.5)
    yield 'cross-ratio distance', [f'{cross_ratio_distance(L_SET, *ends)[0]:.3f}', ' 8 ']
    around = chain_distance(U_SET, (1, 8), (6, 8), 3)
    yield 'chain distance', [f'{around.lower:.1f} to {around.upper:.1f}', '2 log 3']
    spiral, hall = (link_diameter(GridSpace.from_blocked(grid)) for grid in (SPIRAL, TWO_ROOMS))
    yield 'links', [f'{spiral.lower}', f'{hall.lower} to {hall.upper:.0f}']
    yield 'links', [f'{annulus_sector_links(1, 2, math.pi)}']
    yield 'curvature', [f'{ball_image(BANANA).kappa:.2f}', '6.28']
    yield 'boundary ratio', [f'{ball_boundary_ratio(1, 0.1):.3f}']


def conductances():
    for name, space, shape in (
        ('disc', DISC, (12, 12)),
        ('ell', L_SET, (12, 12)),
        ('banana', BANANA, (12, 12)),
        ('U', U_SET, (18, 14)),
        ('two rooms, door .2', two_rooms(0.2), (10, 20)),
        ('two rooms, door .05', two_rooms(0.05), (10, 20)),
    ):
        flow = cell_flow(space, shape, N_LINES)
        cut = best_cut(flow).conductance
        gap = 1 / flow.relaxation_time
        yield name, [f'{gap / 2:.4f}', f'{cut:.4f}', f'{1 / (2 * cut):.2f}', f'{1 / gap:.2f}']


def bounds():
    for dim in errors.DIMENSIONS:
        found = errors.rate_on_the_ball()
        versions = ('printed', 'corrected', 'mended')
        yield (
            f'ball, n = {dim}',
            [f'{found[f"{name}, n = {dim}"]:.1e}' for name in versions]
            + [f'{found[f"slope {name}, n = {dim}"]:.2f}' for name in versions],
        )
    image = ball_image(BANANA)
    conductance = [f(image) for f in (printed_conductance, corrected_conductance)]
    conductance.append(mended_conductance(image))
    yield 'banana, n = 2', [f'{value:.1e}' for value in conductance]
    yield 'banana, steps', [f'{mixing_bound(value, 2.0, 0.01):.1e}' for value in conductance]


def assumptions():
    volumes = [f'{math.exp(log_ball_volume(n)):.4f}' for n in (2, 12, 13)]
    yield 'its volume', volumes
    for name in DIVIDED:
        sides = divided(name)
        yield (
            name,
            [f'{sides.third:.4f}', f'{sides.expected:.4f}', f'{sides.smaller:.4f}']
            + [f' {sides.ratio:.2f} '],
        )


def stars():
    for name in SMOOTH:
        eta, image, found = smooth(name)
        yield name, [f'{eta:.3f}', f'{image.stretch:.3f}', f'{image.kappa:.2f}']
        yield name, [f'{value:.1e}' for value in found]
    for name, row in (('L', 'L, radius .6'), ('star', 'star, radius 1.2')):
        eta, local, phi = walked(name)
        yield row, [f'{eta:.4f}', f'{local:.4f}', f'{phi:.1e}', f'{2 / phi**2:.0e}']


def paths():
    for name, problem in (
        ('U, arm to arm', AROUND_THE_U),
        ('two rooms, corner to corner', THROUGH_THE_DOOR),
    ):
        theory, walks = theory_of(problem), walks_of(problem)
        error = walks.std() / math.sqrt(N_WALKS)
        yield (
            name,
            [
                f'{theory.fraction:.4f}',
                f'{theory.mixing}',
                f'{theory.by_mixing:.0f}',
                f'{theory.expected:.1f}',
                f'{walks.mean():.1f} +- {error:.1f}',
            ],
        )


def in_the_paper():
    first, third = errors.first_branch(), errors.third_branch()
    yield '1', [f'{first[f"{which}, n = 2"]:.4f}' for which in ('printed', 'd', 'corrected')]
    yield '2', [f'{third[which] * 1e5:.2f}' for which in ('printed', 'd', 'corrected')]
    yield '3', ['1/24']
    rate = errors.rate_on_the_ball()
    yield '4', [f'{rate["printed, n = 2"]:.1e}', f'{rate["slope printed, n = 10000"]:.2f}']
    cap = errors.cap()
    yield '5', [f'{cap[f"P(A_2), n = {dim}"]:.3f}' for dim in (2, 3, 10_000)]
    yield '5', [f'{cap["P(A_3), disc, .75 from the middle"]:.3f}', '2/7']
    yield '5', [f'{cap["sum, n = 2"]:.2f}', f'{cap["sum cut at 2 / sqrt n"]:.3f}']
    detours = errors.detours()
    yield '6', [f'{detours[f"{k}, disc"]:.2f}' for k in ('2 links', '3 links', 'limit')]
    yield '6', [f'{detours["2 links, plus"]:.3f}', '1.25']
    saddle = errors.saddle()
    yield '7', [f'{saddle[f"kappa, h = {h:g}"]:.0f}' for h in (1e-2, 1e-4, 1e-6)]
    idle = errors.idle_terms()
    yield '8', [f'{value:.3f}' for value in idle.values()]
    yield '9', ['9']
    yield '10', ['h/8', '.125']
    hull = errors.hull()
    yield '11', [f'{hull[f"{which}, size {k}"]:.2f}' for k in (1, 2) for which in ('d_C', 'l_C')]
    warmth = errors.warmth()
    yield '12', [f'{warmth[f"n = {n}, k = 2, s = 0.001"]:.2f}' for n in (2, 3)]
    angles = errors.plane_angles()
    yield 'plane', [f'{angles[f"loss, n = {dim}"]:.2f}' for dim in (2, 3, 10, 100)]


@pytest.mark.parametrize(
    'table',
    [quantities, bounds, assumptions, stars, *map(sweep, (conductances, paths, in_the_paper))],
)
def test_the_page_prints_what_the_functions_give(table):
    printed = rows()
    missing = {
        name: figures
        for name, figures in table()
        if any(figure not in printed.get(name, '') for figure in figures)
    }
    assert not missing
