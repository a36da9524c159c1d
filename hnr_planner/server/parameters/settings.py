"""
Parameters of the planning server, each with its meaning, unit, range and default.

``Settings`` is the only table of them: the node declares its ROS parameters from it, each request
is planned with one frozen instance of it, and a test compares the documented configuration to it.
"""

import dataclasses
from dataclasses import dataclass

from hnr_planner.core import ALGORITHMS, KINODYNAMIC_PLANNERS, WALKS
from hnr_planner.server.parameters.robot import RobotSettings
from hnr_planner.server.parameters.rules import distance, Rule, setting, SettingsError

#: Largest value of an integer parameter.
LARGEST_INT = 2**31 - 1

#: Most paths that a request may find.
MOST_ALTERNATIVES = 16

#: Names of all planners that a request may ask for.
SERVED_ALGORITHMS = (*ALGORITHMS, *KINODYNAMIC_PLANNERS)


@dataclass(frozen=True)
class Settings(RobotSettings):
    """
    The parameters of the planning server, frozen.

    Making an instance checks every value, and raises SettingsError for one that is not allowed.
    """

    algorithm: str = setting(
        'auto',
        'Algorithm of the service ~/plan, and of requests that name none.',
        choices=ALGORITHMS,
    )
    robot_radius: float = distance(
        'Radius of the robot as a circle: give the circumscribed one. 0 for a map that is '
        'inflated already.'
    )
    unknown: str = setting(
        'blocked', 'Whether the robot may enter unknown cells.', choices=('blocked', 'free')
    )
    occupied_threshold: int = setting(
        65,
        'A cell with this value or more is occupied; 99, with robot_radius 0, for a Nav2 costmap.',
        lower=1,
        upper=100,
    )
    time_limit: float = setting(
        1.0, 'Longest time for the whole planning of one request.', 's', lower=0.001, upper=3600.0
    )
    max_iterations: int = setting(
        0,
        'Most transitions (proposals handled) for one request; 0 for no limit.',
        lower=0,
        upper=LARGEST_INT,
    )
    goal_radius: float = distance(
        'The goal is reached within this distance; 0: the path ends exactly at the goal.'
    )
    simplify: bool = setting(True, 'Shorten the path that was found by visibility.')
    optimize_for: float = setting(
        0.02,
        'A shorter path is looked for until so long after the request, inside time_limit; 0: the '
        'first path is taken.',
        's',
        lower=0.0,
        upper=3600.0,
    )
    clearance: float = distance(
        'Distance to obstacles that a path keeps where it can; narrower passages are passed in '
        'their middle. 0: the shortest path. It needs simplify.'
    )
    alternatives: int = setting(
        1,
        'Paths to find, none of which can be deformed into another past an obstacle: ~/paths has '
        'all of them. With more than 1 it needs simplify.',
        lower=1,
        upper=MOST_ALTERNATIVES,
    )
    roadmap: bool = setting(
        False,
        'Build a roadmap of each map in the background, and plan with it under the algorithm '
        'auto once it is ready.',
    )
    keep_route: float = setting(
        0.0,
        'The last path to the same goal, mended where robot and map have moved, is kept unless a '
        'new one is shorter by more than this fraction of it; 0: each request is planned afresh.',
        lower=0.0,
        upper=1.0,
    )
    max_acceleration: float = setting(
        1.0,
        'Largest acceleration of a robot with inertia, for the services ~/plan_kinodynamic_...',
        'm/s^2',
        lower=0.001,
        upper=1000.0,
    )
    max_speed: float = setting(
        1.0, 'Largest speed of a robot with inertia.', 'm/s', lower=0.001, upper=1000.0
    )
    goal_speed: float = setting(
        0.0,
        'Largest speed of a robot with inertia at the goal; -1: any. 0, at rest, only '
        '~/plan_kinodynamic_connect can do; for the others it means any.',
        'm/s',
        lower=-1.0,
        upper=1000.0,
    )
    boundary: str = setting(
        'forbidden',
        'What an obstacle does in ~/plan_kinodynamic_hit_and_run and _rrt: it must not be met, or '
        'it stops the robot, which goes on from there.',
        choices=('forbidden', 'inelastic'),
    )
    seed: int = setting(
        -1,
        'Seed of every request; -1: a fresh one for each request. The outcome states it.',
        lower=-1,
        upper=LARGEST_INT,
    )
    default_tolerance: float = distance(
        'How far from a goal that cannot be reached the path may end, for clicks and actions; a '
        'request by a service brings its own tolerance.'
    )
    escape_radius: float = setting(
        0.0,
        'A start that is not free is led to free space in a straight line, if that is within this '
        'distance and no obstacle between; 0: such a start is refused.',
        'm',
        lower=0.0,
        upper=10.0,
    )
    any_order: bool = setting(
        False,
        'Pass the poses of compute_path_through_poses, the last one included, in the order that '
        'makes the path short.',
    )
    transform_tolerance: float = setting(
        0.3,
        'Longest time to wait for the transform of a start or goal in another frame than the '
        "map's, inside time_limit.",
        's',
        lower=0.0,
        upper=60.0,
    )
    robot_base_frame: str = setting(
        'base_link',
        'Frame of the robot: where a path begins that an action asks for without a start.',
    )
    pose_spacing: float = setting(
        -1.0,
        'Largest distance between poses of the path; -1: the resolution of the map; 0: the '
        'vertices only.',
        'm',
        lower=-1.0,
        upper=1000.0,
    )
    samples_max: int = setting(
        100_000, 'Most samples of one search in ~/samples.', lower=0, upper=10_000_000
    )
    sample_count: int = setting(
        1000,
        'Draws of the free space for one request to ~/sample; seed and time_limit hold for them, '
        'too.',
        lower=1,
        upper=1_000_000,
    )
    sample_walk: str = setting('hit_and_run', 'Random walk of ~/sample.', choices=WALKS)
    sample_radius: float = distance('Longest step of ball_walk; 0: what suits the map.')
    sample_thin: int = setting(
        1,
        'Steps of the walk from one draw of ~/sample to the next: with more, draws depend less on '
        'each other.',
        lower=1,
        upper=100_000,
    )
    map_wait: float = setting(
        1.0,
        'How long a request that comes before the first map waits for it, inside time_limit.',
        's',
        lower=0.0,
        upper=3600.0,
    )
    planner_aliases: tuple[str, ...] = setting(
        ('GridBased:auto',),
        'Names of planners in goals of Nav2, each with the algorithm that it stands for.',
        entries='NAME:ALGORITHM',
    )
    allow_partial_planning: bool = setting(
        False,
        'Whether a path through poses may end at the last pose that can be reached, after the '
        'first one at least; else it fails.',
    )
    rviz_clicks: bool = setting(
        False, 'Listen to the click tools of RViz: initialpose keeps the start, goal_pose plans.'
    )
    watch_port: int = setting(
        0,
        'Port on which this machine alone can look at the node in a browser; 0: none. Read only: '
        'set it when the node starts.',
        lower=0,
        upper=65535,
        read_only=True,
    )
    autostart: bool = setting(
        True,
        'Whether the node configures and activates itself; false: the transitions come from '
        'outside, as from the lifecycle manager of Nav2. Read only: set it when the node starts.',
        read_only=True,
    )
    map_subscribe_transient_local: bool = setting(
        True,
        'Ask for a latched map (as map_server offers it). Read only: set it when the node starts.',
        read_only=True,
    )

    def __post_init__(self) -> None:
        """
        Raise SettingsError where a value is not allowed.

        Checks are the rule of each parameter, the values between -1 and 0 of ``pose_spacing`` and
        ``goal_speed``, what needs ``simplify``, the form of each alias, and the footprint.
        """
        object.__setattr__(self, 'planner_aliases', tuple(self.planner_aliases))
        for name, rule in RULES.items():
            rule.check(name, getattr(self, name))
        super().__post_init__()
        if -1.0 < self.pose_spacing < 0.0:
            raise SettingsError(
                f'pose_spacing must be -1 (the resolution of the map), 0 (vertices only) or '
                f'positive, got {self.pose_spacing!r}'
            )
        if not self.simplify and (self.clearance > 0.0 or self.alternatives > 1):
            raise SettingsError(
                'clearance must be 0 and alternatives 1 where simplify is false, got '
                f'{self.clearance!r} and {self.alternatives!r}'
            )
        if -1.0 < self.goal_speed < 0.0:
            raise SettingsError(
                f'goal_speed must be -1 (any), 0 (at rest) or positive, got {self.goal_speed!r}'
            )
        for alias in filter(None, self.planner_aliases):
            name, _, algorithm = alias.partition(':')
            if not name or algorithm not in SERVED_ALGORITHMS:
                names = ', '.join(SERVED_ALGORITHMS)
                raise SettingsError(
                    f'planner_aliases must be NAME:ALGORITHM each, with an algorithm of {names}, '
                    f'got {alias!r}'
                )

    @property
    def aliases(self) -> dict[str, str]:
        """The algorithm of each alias, by its name; empty entries of the parameter are skipped."""
        return dict(alias.split(':', 1) for alias in self.planner_aliases if alias)

    @property
    def patience(self) -> float:
        """Longest wait [s] of a request for the first map: no more than ``time_limit``."""
        return min(self.map_wait, self.time_limit)

    @property
    def robot(self) -> str:
        """The robot in words: its radius, or its footprint and drive."""
        if self.vertices:
            return f'footprint with {len(self.vertices)} vertices, {self.drive} drive'
        return f'robot radius {self.robot_radius:g} m'


#: The rule of each parameter, by its name.
RULES: dict[str, Rule] = {
    field.name: field.metadata['rule'] for field in dataclasses.fields(Settings)
}

#: The default of each parameter.
DEFAULTS = Settings()
