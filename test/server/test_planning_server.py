"""Every request is admitted, counted and responded to, even where the planner has a defect."""

from test.server.test_requests import GOAL, rooms, SETTINGS, store

from hnr_planner.server.map.map_store import MapSnapshot
from hnr_planner.server.map.waiting import NewestMap
from hnr_planner.server.planning.respond import only_same_frame
from hnr_planner.server.planning_server import PlanningServer
from hnr_planner.server.requests.outcomes import Outcome
from hnr_planner.server.requests.plan_request import PlanRequest, Pose

REQUEST = PlanRequest(Pose((0.5, 0.5, 0.0)), Pose((*GOAL, 0.0)), 0.0, 'rrt')


def server(newest: NewestMap, defects: list[str] | None = None) -> PlanningServer:
    """Return a server that admits requests, and appends tracebacks to ``defects``."""
    report = (defects if defects is not None else []).append
    made = PlanningServer(lambda: SETTINGS, newest, only_same_frame, report)
    made.searches.enable()
    return made


def test_requests_are_counted_by_their_outcomes() -> None:
    planning = server(store(rooms()).newest)
    assert planning.plan(REQUEST).outcome is Outcome.SOLVED
    assert planning.sample().outcome is Outcome.SAMPLED
    assert planning.statistics.summary().outcomes == {Outcome.SOLVED: 1, Outcome.SAMPLED: 1}
    assert len(planning.searches) == 0


def test_nothing_is_planned_while_searches_are_not_admitted() -> None:
    planning = server(store(rooms()).newest)
    planning.searches.disable()
    assert planning.plan(REQUEST).outcome is Outcome.NOT_ACTIVE
    assert planning.sample().outcome is Outcome.NOT_ACTIVE


def test_defect_is_reported_and_has_a_response() -> None:
    def broken() -> MapSnapshot:
        raise ZeroDivisionError('a bug')

    defects: list[str] = []
    planning = server(broken, defects)
    for response in (planning.plan(REQUEST), planning.sample()):
        assert response.outcome is Outcome.INTERNAL_ERROR
        assert 'a bug' in response.why
    assert len(defects) == 2 and all('ZeroDivisionError' in text for text in defects)
    assert len(planning.searches) == 0


def test_response_has_its_poses() -> None:
    response = server(store(rooms()).newest).plan(REQUEST)
    assert response.poses.shape[1] == 7
    assert response.poses[0, :2].tolist() == [0.5, 0.5]
    assert response.poses[-1, :2].tolist() == list(GOAL)
