"""Parameters of a robot with a footprint: its outline, how it drives, and what its paths cost."""

import ast
from dataclasses import dataclass
from functools import cached_property
import math

from hnr_planner.core.errors import SpaceError
from hnr_planner.core.spaces.poses.drive import DRIVES
from hnr_planner.core.spaces.poses.footprint import check_footprint
from hnr_planner.server.parameters.rules import distance, setting, SettingsError

Point = tuple[float, float]


@dataclass(frozen=True)
class RobotSettings:
    """
    The parameters that have a meaning with a footprint only, frozen.

    Making an instance checks the form of ``footprint``: SettingsError is raised where it is not
    the outline of a polygon.
    """

    footprint: str = setting(
        '[]',
        'Outline of the robot in its own frame, x ahead: "[[x, y], [x, y], [x, y], ...]", as in '
        'Nav2; then paths have headings, and the whole outline stays free. []: a circle of '
        'robot_radius.',
        'm',
    )
    drive: str = setting(
        'differential',
        'How a robot with a footprint moves: differential turns on the spot, car drives arcs of '
        'min_turning_radius at least, omnidirectional moves in any direction.',
        choices=DRIVES,
    )
    min_turning_radius: float = distance(
        'Radius of the tightest arc of a car; 0 for the other drives.'
    )
    reverse: bool = setting(True, 'Whether a robot with a footprint may drive backwards.')
    reverse_penalty: float = setting(
        2.0,
        'A metre driven backwards counts as so many metres.',
        lower=1.0,
        upper=1000.0,
    )
    heading_tolerance: float = setting(
        0.0,
        'Angle by which a robot with a footprint may be turned from the goal at the end.',
        'rad',
        lower=0.0,
        upper=math.pi,
    )

    def __post_init__(self) -> None:
        """Raise SettingsError where the footprint is not the outline of a polygon."""
        _ = self.vertices

    @cached_property
    def vertices(self) -> tuple[Point, ...]:
        """Vertices [m] of the footprint; none where the robot is a circle."""
        return outline(self.footprint)


def outline(footprint: str) -> tuple[Point, ...]:
    """
    Return the vertices [m] of a footprint in Nav2's form; none for ``[]`` and for an empty text.

    Raises
    ------
    SettingsError
        When the text has another form, or the polygon crosses itself or has no area.

    """
    if not footprint.strip():
        return ()
    try:
        vertices = tuple((float(x), float(y)) for x, y in ast.literal_eval(footprint.strip()))
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        raise SettingsError(
            'footprint must be [] or the points "[[x, y], [x, y], [x, y], ...]" of a polygon [m], '
            f'got {footprint!r}'
        ) from None
    if vertices:
        try:
            check_footprint(vertices)
        except SpaceError as error:
            raise SettingsError(str(error)) from None
    return vertices
