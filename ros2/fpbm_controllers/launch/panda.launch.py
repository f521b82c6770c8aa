"""A Panda with mock hardware and the target controller."""

from launch import LaunchDescription
from launch.substitutions import Command, PathJoinSubstitution
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from launch_ros.substitutions import FindPackageShare


def generate_launch_description() -> LaunchDescription:
    package = FindPackageShare("fpbm_controllers")
    urdf = Command(["xacro ", PathJoinSubstitution([package, "urdf", "panda.urdf.xacro"])])
    parameters = PathJoinSubstitution([package, "config", "panda.yaml"])
    return LaunchDescription(
        [
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{"robot_description": ParameterValue(urdf, value_type=str)}],
            ),
            Node(package="controller_manager", executable="ros2_control_node", parameters=[parameters], output="both"),
            Node(
                package="controller_manager",
                executable="spawner",
                arguments=["joint_state_broadcaster", "targets", "--param-file", parameters],
            ),
        ]
    )
