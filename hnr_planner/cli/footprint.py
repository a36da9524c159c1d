"""Arguments of a robot with a footprint, and the space of its poses."""

from __future__ import annotations

import argparse
from typing import Any, TYPE_CHECKING

from hnr_planner.cli.argument_types import length, positive
from hnr_planner.cli.arguments import BadInputError

if TYPE_CHECKING:
    from hnr_planner.core import GridSpace, PlanResult, PoseSpace
    from numpy.typing import NDArray

#: Names of the drives; literal, so that ``--help`` does not import the core. A test compares.
DRIVE_NAMES = ('differential', 'car', 'omnidirectional')
#: Arguments that need ``--footprint``, by their names in the parsed arguments.
NEED_FOOTPRINT = {
    'drive': '--drive',
    'min_turning_radius': '--min-turning-radius',
    'reverse': '--no-reverse',
    'reverse_penalty': '--reverse-penalty',
    'heading_tolerance': '--heading-tolerance',
}


def add_footprint_arguments(
    parser: argparse.ArgumentParser, description: str
) -> argparse._ArgumentGroup:
    """Add ``--footprint`` and how the robot drives to a parser, in a group, and return that."""
    group = parser.add_argument_group('robots that are not round', description)
    group.add_argument(
        '--footprint',
        metavar='"[[X, Y], ...]"',
        help='outline of the robot in its own frame, x ahead [m], as in Nav2: at least three '
        'points of a polygon; in the place of --robot-radius',
    )
    group.add_argument(
        '--drive',
        choices=DRIVE_NAMES,
        help='differential turns on the spot, car drives arcs, omnidirectional moves in any '
        'direction; default differential',
    )
    group.add_argument(
        '--min-turning-radius',
        type=positive,
        metavar='R',
        help='radius of the tightest arc of a car [m]',
    )
    group.add_argument(
        '--no-reverse',
        dest='reverse',
        action='store_const',
        const=False,
        help='never drive backwards',
    )
    return group


def add_planning_arguments(group: argparse._ArgumentGroup) -> None:
    """Add the options that decide between paths of a robot with a footprint to its group."""
    group.add_argument(
        '--reverse-penalty',
        type=positive,
        metavar='P',
        help='a metre driven backwards counts as P metres, at least 1; default 2',
    )
    group.add_argument(
        '--heading-tolerance',
        type=length,
        metavar='A',
        help='the robot may be turned by this angle from the goal [rad]; default 0',
    )


def pose_space(arguments: argparse.Namespace, grid: GridSpace) -> PoseSpace | None:
    """
    Return the space of poses of the robot that the arguments describe; None without a footprint.

    Raises
    ------
    BadInputError
        When an argument has no meaning without a footprint, or with one.
    HnrError
        When the arguments describe no robot, or one that does not fit into the map.

    """
    from hnr_planner.core import PoseSpace
    from hnr_planner.server.parameters.robot import outline

    values: dict[str, Any] = vars(arguments)
    given = {name: values[name] for name in NEED_FOOTPRINT if values.get(name) is not None}
    vertices = outline(arguments.footprint or '')
    if not vertices:
        for name in given:
            raise BadInputError(f'{NEED_FOOTPRINT[name]} needs --footprint')
        if arguments.footprint is not None:
            raise BadInputError('--footprint has no points: leave it out for a round robot')
        return None
    if arguments.robot_radius > 0.0:
        raise BadInputError('--robot-radius has no meaning with --footprint')
    names = ('drive', 'min_turning_radius', 'reverse')
    return PoseSpace(grid, vertices, **{name: given[name] for name in names if name in given})


def planning_options(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return the arguments of ``plan`` that were given for a footprint, by name."""
    given = {name: getattr(arguments, name) for name in ('reverse_penalty', 'heading_tolerance')}
    return {name: value for name, value in given.items() if value is not None}


def poses_of(space: PoseSpace, result: PlanResult) -> NDArray:
    """Return poses (n, 3) along a path, at most half a cell apart; none without a path."""
    if len(result.path) == 0:
        return result.path
    return result.poses(0.5 * space.grid.resolution)


def in_words(space: PoseSpace) -> str:
    """Return a footprint and its drive as a phrase."""
    long, wide = space.footprint.max(axis=0) - space.footprint.min(axis=0)
    return f'footprint of {long:g} x {wide:g} m, {space.drive.name} drive'
