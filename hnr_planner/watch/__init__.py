"""
A running node in the browser: the command ``watch`` and the parameter ``watch_port``.

A process of its own subscribes to what the planning node publishes and serves a page that shows
it (``page/live.js``), so that the node pays for its publications only, and for none that nobody
looks at: the subscriptions last as long as a page is open. ``node`` is the ROS side, ``server``
the HTTP and WebSocket side, which knows no ROS; ``hub`` lies between them.

HTTP and WebSocket are tornado's: it does both on one port, depends on nothing, has been kept up
for many years, and is what rosbridge uses, so that a ROS from apt has it as python3-tornado. (The
websockets library of Ubuntu 24.04 is older than its present interface; aiohttp brings seven more
packages.)
"""
