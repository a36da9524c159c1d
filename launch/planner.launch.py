"""
Start the planner; with ``map`` a map source too, and with ``rviz:=true`` RViz.

    ros2 launch hnr_planner planner.launch.py map:=/path/to/map.yaml rviz:=true

Without ``map`` the planner takes the topic ``map`` of a map server that runs already. No
transition is sent from here: with ``autostart`` the planner activates itself, without it waits for
a lifecycle manager. Transforms are taken from ``tf`` and ``tf_static`` of the namespace, as in
nav2_bringup.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.conditions import IfCondition
from launch.substitutions import (
    EnvironmentVariable,
    LaunchConfiguration,
    NotEqualsSubstitution,
    PathJoinSubstitution,
)
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare

#: The folder of the configuration.
CONFIG = PathJoinSubstitution([FindPackageShare('hnr_planner'), 'config'])

#: Name, default and description.
ARGUMENTS = (
    ('map', '', 'Map file (YAML) to publish; empty for none.'),
    (
        'params_file',
        PathJoinSubstitution([CONFIG, 'hnr_planner.yaml']),
        'YAML file with the parameters of the planner.',
    ),
    ('namespace', '', 'Namespace of the nodes and topics.'),
    ('use_sim_time', 'false', 'Take the time from /clock.'),
    ('autostart', 'true', 'Activate the planner; false: a lifecycle manager does.'),
    ('rviz', 'false', 'Start RViz with the layout of this package.'),
    (
        'rviz_clicks',
        LaunchConfiguration('rviz'),
        'Plan where the click tools of RViz say; as rviz if not given.',
    ),
)

#: Transforms of a robot in a namespace are in it too.
TRANSFORMS = [('/tf', 'tf'), ('/tf_static', 'tf_static')]

#: Topics that the layout of RViz names; they follow the namespace.
IN_LAYOUT = (
    '/map',
    '/map_updates',
    '/initialpose',
    '/goal_pose',
    '/hnr_planner/samples',
    '/hnr_planner/markers',
    '/hnr_planner/path',
)


def generate_launch_description() -> LaunchDescription:
    """Describe the arguments and the nodes."""
    namespace = LaunchConfiguration('namespace')
    map_file = LaunchConfiguration('map')
    # Room for large clouds; a profile that is chosen already stays.
    profile = 'FASTRTPS_DEFAULT_PROFILES_FILE'
    our_profile = PathJoinSubstitution([CONFIG, 'fastdds.xml'])

    return LaunchDescription(
        [
            *(
                DeclareLaunchArgument(name, default_value=default, description=description)
                for name, default, description in ARGUMENTS
            ),
            Node(
                package='hnr_planner',
                executable='planner_node',
                name='hnr_planner',
                namespace=namespace,
                parameters=[
                    LaunchConfiguration('params_file'),
                    _booleans('use_sim_time', 'autostart', 'rviz_clicks'),
                ],
                remappings=TRANSFORMS,
                additional_env={profile: EnvironmentVariable(profile, default_value=our_profile)},
                output='screen',
            ),
            Node(
                package='hnr_planner',
                executable='map_node',
                name='map_source',
                namespace=namespace,
                parameters=[
                    {'yaml_filename': ParameterValue(map_file, value_type=str)},
                    _booleans('use_sim_time'),
                ],
                output='screen',
                condition=IfCondition(NotEqualsSubstitution(map_file, '')),
            ),
            Node(
                package='rviz2',
                executable='rviz2',
                namespace=namespace,
                arguments=['-d', PathJoinSubstitution([CONFIG, 'hnr_planner.rviz'])],
                parameters=[_booleans('use_sim_time')],
                remappings=[*TRANSFORMS, *((topic, topic.lstrip('/')) for topic in IN_LAYOUT)],
                output='screen',
                condition=IfCondition(LaunchConfiguration('rviz')),
            ),
        ]
    )


def _booleans(*names: str) -> dict[str, ParameterValue]:
    """Return parameters, each with the name and the value of a launch argument."""
    return {name: ParameterValue(LaunchConfiguration(name), value_type=bool) for name in names}
