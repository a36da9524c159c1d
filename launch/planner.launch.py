"""
Start the planner, and a map source if a map is named.

    ros2 launch hnr_planner planner.launch.py map:=/path/to/map.yaml

Without ``map`` the planner listens to the topic ``map`` of a map server that runs already.
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


def generate_launch_description() -> LaunchDescription:
    """Describe the arguments and the two nodes."""
    default_params = PathJoinSubstitution(
        [FindPackageShare('hnr_planner'), 'config', 'hnr_planner.yaml']
    )
    namespace = LaunchConfiguration('namespace')
    map_file = LaunchConfiguration('map')
    clock = {'use_sim_time': ParameterValue(LaunchConfiguration('use_sim_time'), value_type=bool)}
    # Room for large clouds; a profile that is chosen already stays.
    profile = 'FASTRTPS_DEFAULT_PROFILES_FILE'
    our_profile = PathJoinSubstitution([FindPackageShare('hnr_planner'), 'config', 'fastdds.xml'])
    map_parameters = {'yaml_filename': ParameterValue(map_file, value_type=str)}

    return LaunchDescription(
        [
            DeclareLaunchArgument(
                'map', default_value='', description='Map file (YAML) to publish; empty for none.'
            ),
            DeclareLaunchArgument(
                'params_file',
                default_value=default_params,
                description='YAML file with the parameters of the planner.',
            ),
            DeclareLaunchArgument(
                'namespace', default_value='', description='Namespace of the nodes and topics.'
            ),
            DeclareLaunchArgument(
                'use_sim_time', default_value='false', description='Take the time from /clock.'
            ),
            Node(
                package='hnr_planner',
                executable='planner_node',
                name='hnr_planner',
                namespace=namespace,
                parameters=[LaunchConfiguration('params_file'), clock],
                additional_env={profile: EnvironmentVariable(profile, default_value=our_profile)},
                output='screen',
            ),
            Node(
                package='hnr_planner',
                executable='map_node',
                name='map_source',
                namespace=namespace,
                parameters=[map_parameters, clock],
                output='screen',
                condition=IfCondition(NotEqualsSubstitution(map_file, '')),
            ),
        ]
    )
