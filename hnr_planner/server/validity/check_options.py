"""Options of Nav2's requests to check a path, where its messages have such fields."""

import math
from typing import Any, NamedTuple, Self

from hnr_planner.server.parameters.settings import Settings
from hnr_planner.server.requests.outcomes import Outcome, Refusal

#: Cost in a costmap of Nav2 from which a cell is an obstacle for the centre of the robot.
INSCRIBED_COST = 253


class CheckOptions(NamedTuple):
    """
    Options of a request to check whether a path is valid.

    Attributes
    ----------
    lookahead : float
        Length of the path [m] to check, from the robot on; inf for all of it.
    most_indices : int, optional
        Most indices of blocked poses to return; None for all.
    layer, footprint : str
        A layer of a costmap and a polygon to check with; empty for none.
    max_cost : int
        Highest cost that is no obstacle.
    unknown_blocks : bool
        Whether unknown cells are obstacles, whatever the parameters say.

    """

    lookahead: float = math.inf
    most_indices: int | None = None
    layer: str = ''
    footprint: str = ''
    max_cost: int = INSCRIBED_COST
    unknown_blocks: bool = False

    @classmethod
    def of(cls, request: Any) -> Self:
        """Return the options in a message; those that it has no field for have their defaults."""
        distance = float(getattr(request, 'max_lookahead_distance', -1.0))
        return cls(
            lookahead=distance if distance >= 0.0 else math.inf,
            most_indices=1 if getattr(request, 'stop_at_first_collision', False) else None,
            layer=getattr(request, 'layer_name', ''),
            footprint=getattr(request, 'footprint', ''),
            max_cost=int(getattr(request, 'max_cost', INSCRIBED_COST)),
            unknown_blocks=bool(getattr(request, 'consider_unknown_as_obstacle', False)),
        )

    def check(self, settings: Settings) -> None:
        """Raise Refusal (BAD_REQUEST) for an option that no node with ``settings`` has."""
        why = ''
        if self.layer:
            why = f'layer_name must be empty, as there are no layers here, got {self.layer!r}'
        elif self.footprint:
            why = (
                'footprint must be empty, as the parameters footprint and robot_radius are the '
                f'robot here, got {self.footprint!r}'
            )
        elif self.max_cost < INSCRIBED_COST:
            why = (
                f'max_cost must be {INSCRIBED_COST} or more, as a cell is free or blocked here, '
                f'got {self.max_cost}'
            )
        elif self.unknown_blocks and settings.unknown == 'free':
            why = (
                'consider_unknown_as_obstacle must be false where the parameter unknown is free, '
                'got true'
            )
        if why:
            raise Refusal(Outcome.BAD_REQUEST, why)
