"""The command ``watch``: a page that shows a running node."""

from __future__ import annotations

import argparse
from importlib.util import find_spec

from hnr_planner.cli.argument_types import bounded
from hnr_planner.cli.arguments import add_command, BadInputError
from hnr_planner.cli.extras import require_extra

EPILOG = """\
The page shows the map as it changes, the last search as it unfolds, its path and alternatives, and
the outcome in words. With --allow-requests, clicks on the map set a start and a goal, and plan.

examples:
  %(prog)s
  %(prog)s --node robot/hnr_planner --map map --allow-requests
  %(prog)s --host 0.0.0.0 --token "$(openssl rand -hex 16)"

Exit code 0: ended by Ctrl-C. 2: the page cannot be served, or ROS 2 or a library is not installed.
"""

port = bounded(int, least=0, most=65535)
process = bounded(int, least=1)


def add_parser(commands: argparse._SubParsersAction) -> None:
    """Add the command ``watch`` to the command line."""
    parser = add_command(
        commands,
        'watch',
        run,
        summary='look at a running node in a browser',
        description='Serve a page that shows what a running planning node does.',
        epilog=EPILOG,
    )
    parser.add_argument(
        '--node',
        default='hnr_planner',
        metavar='NAME',
        help='the planning node, with its namespace; default hnr_planner',
    )
    parser.add_argument(
        '--map',
        default='map',
        metavar='TOPIC',
        help="topic of the maps, where it is remapped, in the node's namespace; default map",
    )
    parser.add_argument(
        '--host',
        default='127.0.0.1',
        metavar='ADDRESS',
        help='address to serve on; default 127.0.0.1, which only this machine can reach',
    )
    parser.add_argument(
        '--port', type=port, default=8000, help='port to serve on, 0 for any; default 8000'
    )
    parser.add_argument(
        '--token',
        metavar='T',
        help='what a browser has to know, as ?token=T; needed for an address that other machines '
        'can reach; at least 16 letters, digits, - or _',
    )
    parser.add_argument(
        '--allow-requests',
        action='store_true',
        help='let clicks on the map plan; else the page is to look at only',
    )
    parser.add_argument(
        '--end-with',
        type=process,
        metavar='PID',
        help='end when that process ends, as the node with watch_port wants it',
    )


def run(arguments: argparse.Namespace) -> int:
    """Serve the page and return the exit code; BadInputError names what is not installed."""
    if find_spec('rclpy') is None:
        raise BadInputError('watch needs ROS 2 (rclpy): source a ROS 2 Jazzy')
    require_extra('watch', 'watch')
    from hnr_planner.watch.run import Served, watch

    watch(
        Served(
            arguments.node,
            arguments.map,
            arguments.host,
            arguments.port,
            arguments.token,
            arguments.allow_requests,
            arguments.end_with,
        )
    )
    return 0
