"""
The demo: request paths from real nodes, check them and draw them.

``run`` is the sequence of steps; ``scene`` chooses the request, ``processes`` runs the nodes,
``client`` sends the requests and receives the messages, ``check`` verifies the paths, ``report``
prints and draws the result.
"""
