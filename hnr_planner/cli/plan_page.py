"""The HTML page of the command ``plan``: one request, and how each algorithm answers it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from hnr_planner.cli.footprint import in_words
from hnr_planner.core.planning.plan import plan
from hnr_planner.core.planning.poses.search import POSE_PLANNERS
from hnr_planner.core.planning.registry import ALGORITHMS
from hnr_planner.core.planning.result import PlanResult
from hnr_planner.core.spaces import GridSpace, PoseSpace
from hnr_planner.maps import is_moving_ai, OccupancyMap
from hnr_planner.page.write import Shown, write_page


def write_plan_page(
    arguments: argparse.Namespace,
    occupancy: OccupancyMap,
    space: GridSpace | PoseSpace,
    request: dict[str, Any],
    result: PlanResult,
) -> None:
    """
    Write the page of a request: its result, and the results of all other algorithms but auto.

    Each other algorithm searches for the same request now, with the seed of ``result``.

    Parameters
    ----------
    arguments : Namespace
        Parsed arguments of the command; ``html`` is the file to write.
    occupancy, space
        The map, and the robot's free space on it.
    request : dict
        Arguments that ``plan`` was called with, besides the space.
    result : PlanResult
        Result that ``plan`` returned for the request.

    """
    asked = Shown(result, asked=True)
    names = POSE_PLANNERS if isinstance(space, PoseSpace) else ALGORITHMS
    others = [name for name in names if name != 'auto']
    searches = [
        asked
        if name == result.planner
        else Shown(plan(space, **{**request, 'algorithm': name, 'seed': result.seed}), asked=False)
        for name in others
    ]
    write_page(
        arguments.html,
        Path(arguments.map).stem,
        occupancy,
        space,
        arguments.start,
        arguments.goal,
        searches if asked in searches else [asked, *searches],
        goal_radius=arguments.goal_radius,
        simplify=arguments.simplify,
        options=_in_words(arguments, space, request, result.seed),
    )


def _in_words(
    arguments: argparse.Namespace,
    space: GridSpace | PoseSpace,
    request: dict[str, Any],
    seed: int,
) -> list[str]:
    """Return the options of the request as phrases for the page; most defaults are left out."""
    robot = f'robot radius {arguments.robot_radius:g} m'
    words = {
        in_words(space) if isinstance(space, PoseSpace) else robot: True,
        'unknown cells free': arguments.unknown == 'free',
        f'goal radius {arguments.goal_radius:g} m': arguments.goal_radius > 0.0,
        f'clearance {arguments.clearance:g} m': arguments.clearance > 0.0,
        f'goal tolerance {arguments.goal_tolerance:g} m': arguments.goal_tolerance > 0.0,
        f'start escape {arguments.start_escape:g} m': arguments.start_escape > 0.0,
        f'{arguments.alternatives} different paths': arguments.alternatives > 1,
        'not simplified': not arguments.simplify,
        f'the best path of {request["optimize_for"]:g} s': request['optimize_for'] > 0.0,
        f'at most {arguments.time_limit:g} s': True,
        f'seed {seed}': True,
        'swamp (S) free, water (W) and trees (T) blocked': is_moving_ai(arguments.map),
    }
    return [text for text, holds in words.items() if holds]
