"""The page of the command ``plan``: one request, and how each algorithm answers it."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from hnr_planner.core import ALGORITHMS, GridSpace, plan, PlanResult
from hnr_planner.core.planning.registry import make_planner
from hnr_planner.maps import is_moving_ai, OccupancyMap
from hnr_planner.page import Shown, write_page

#: What a request can hold that is a planner's own, and what it means where a planner has it not.
OF_PLANNERS = {'clearance': 'keeps no clearance'}


def write_plan_page(
    arguments: argparse.Namespace,
    occupancy: OccupancyMap,
    space: GridSpace,
    request: dict[str, Any],
    result: PlanResult,
) -> None:
    """
    Write the page: the answer to a request, and those of the other algorithms.

    Parameters
    ----------
    arguments : Namespace
        Of the command.
    occupancy, space
        The map, and the robot's space on it.
    request : dict
        What ``plan`` was called with, besides the space.
    result : PlanResult
        What it answered.

    """
    write_page(
        arguments.html,
        Path(arguments.map).stem,
        occupancy,
        space,
        arguments.start,
        arguments.goal,
        [
            Shown(result, asked=True)
            if name == result.planner
            else answer(space, {**request, 'algorithm': name, 'seed': result.seed})
            for name in ALGORITHMS
            if name != 'auto'
        ],
        goal_radius=arguments.goal_radius,
        simplify=arguments.simplify,
        wishes=_in_words(arguments, request, result.seed),
    )


def answer(space: GridSpace, request: dict[str, Any]) -> Shown:
    """Return how another algorithm answers a request, without what it has no setting for."""
    planner = make_planner(request['algorithm'], {})
    lacks = [name for name in OF_PLANNERS if name in request and not hasattr(planner, name)]
    taken = {name: value for name, value in request.items() if name not in lacks}
    notes = [OF_PLANNERS[name] for name in lacks]
    return Shown(plan(space, **taken), asked=False, notes=notes)


def _in_words(arguments: argparse.Namespace, request: dict[str, Any], seed: int) -> list[str]:
    """Return the options of the request, as phrases for the page."""
    words = {
        f'robot radius {arguments.robot_radius:g} m': True,
        'unknown cells free': arguments.unknown == 'free',
        f'goal radius {arguments.goal_radius:g} m': arguments.goal_radius > 0.0,
        f'clearance {arguments.clearance:g} m': arguments.clearance > 0.0,
        f'{arguments.alternatives} different paths': arguments.alternatives > 1,
        'not simplified': not arguments.simplify,
        f'the best path of {request["optimize_for"]:g} s': request['optimize_for'] > 0.0,
        f'at most {arguments.time_limit:g} s': True,
        f'seed {seed}': True,
        'swamp (S) free, water (W) and trees (T) blocked': is_moving_ai(arguments.map),
    }
    return [text for text, holds in words.items() if holds]
