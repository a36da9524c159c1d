"""
The demo: real nodes in processes of their own, asked, listened to, checked and drawn.

`run` tells the story; `scene` is what is asked, `processes` are the nodes, `client` asks and
listens in one of them, `check` goes over the paths, `report` shows it all.
"""
