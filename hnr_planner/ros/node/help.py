"""The text that ``planner_node --help`` prints."""

from collections.abc import Iterable
import textwrap

from hnr_planner.core.planning.registry import PLANNERS
from hnr_planner.core.trajectories.registry import KINODYNAMIC_ENTRIES
from hnr_planner.server.parameters.rules import Rule
from hnr_planner.server.parameters.settings import DEFAULTS, RULES

#: Most characters of a line of the text.
WIDTH = 99

USAGE = """\
usage: planner_node [--help] [--ros-args [-p NAME:=VALUE] [--params-file FILE] [-r FROM:=TO] ...]

Plan paths on an occupancy map: subscribe to the topic map, serve requests, publish every sample.

  planner_node --ros-args -p robot_radius:=0.22 -p algorithm:=rrt
  planner_node --ros-args --params-file hnr_planner.yaml -r map:=/global_costmap/costmap

services (nav_msgs/srv/GetPlan): {services}
other services: ~/sample, ~/cancel; topics: ~/path, ~/samples, ~/markers, ~/outcome

algorithms:
{algorithms}

parameters, with unit and default:
"""


def help_text(services: Iterable[str]) -> str:
    """Return the help text: usage, ``services`` by name, algorithms and all parameters."""
    names = ', '.join(f'~/{name}' for name in services)
    algorithms = '\n'.join(
        f'  {entry.name}: {entry.summary}' for entry in (*PLANNERS, *KINODYNAMIC_ENTRIES)
    )
    usage = '\n'.join(
        textwrap.fill(line, WIDTH, subsequent_indent='  ') if len(line) > WIDTH else line
        for line in USAGE.format(services=names, algorithms=algorithms).splitlines()
    )
    return '\n'.join([usage, *(_entry(name, rule) for name, rule in RULES.items())])


def _entry(name: str, rule: Rule) -> str:
    """Return the lines on one parameter: name, unit and default, then its meaning and choices."""
    unit = f' [{rule.unit}]' if rule.unit else ''
    choices = f' One of {", ".join(rule.choices)}.' if rule.choices else ''
    indent = ' ' * 6
    meaning = textwrap.fill(
        rule.description + choices, WIDTH, initial_indent=indent, subsequent_indent=indent
    )
    default = getattr(DEFAULTS, name)
    shown = list(default) if isinstance(default, tuple) else default
    return f'  {name}{unit} ({shown})\n{meaning}'
