"""
``plan --html``: a page that shows a search, looked at in a real browser.

Without chromium and its driver (Debian: chromium, chromium-driver) these tests are skipped.
"""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator
from dataclasses import replace
import json
import math
from pathlib import Path
import re
from test.browser import ActionChains, BrowserPage, Keys, open_browser
from test.cli.conftest import at, OFFICE, Ran
from typing import Any

from hnr_planner.core import GridSpace, plan
from hnr_planner.core.planning.poses.search import POSE_PLANNERS
from hnr_planner.core.planning.registry import PLANNERS
from hnr_planner.maps import load_map, OccupancyMap
from hnr_planner.page.write import COLOURS, path_as_found
import numpy as np
import pytest

pytestmark = pytest.mark.usefixtures('compiled')

REQUEST = ('--start', 3, 22, '--goal', 34, 5, '--robot-radius', 0.22, '--seed', 3)
REQUEST += ('--optimize-for', 0, '--time-limit', 600)
#: Every planner that searches, with its colour on the page.
SHOWN = dict(
    zip((entry.name for entry in PLANNERS if entry.name != 'auto'), COLOURS, strict=False)
)
PHONE = {'width': 390, 'height': 844, 'deviceScaleFactor': 2, 'mobile': True}


@pytest.fixture(scope='module')
def browser() -> Iterator[Any]:
    """Return a browser without network access."""
    with open_browser() as driver:
        yield driver


def data_of(file: Path) -> dict[str, Any]:
    """Return the data that a page holds."""
    (data,) = re.findall('id="data">(.*?)</script>', file.read_text())
    return dict(json.loads(data))


def through_the_door(rooms: OccupancyMap) -> list[object]:
    """Return arguments for a start in one room and a goal in the other."""
    return ['--start', *at(rooms, 5, 5), '--goal', *at(rooms, 8, 75)]


@pytest.fixture
def page(browser: Any, run: Callable[..., Ran], tmp_path: Path) -> Iterator[Page]:
    """Return the page of a request on the office map, and check that no script fails."""
    file = tmp_path / 'page.html'
    ran = run('plan', OFFICE, *REQUEST, '--algorithm', 'hit_and_run', '--json', '--html', file)
    assert ran.code == 0, ran.err
    page = Page(browser, file, json.loads(ran.out))
    yield page
    assert page.errors() == []


class Page(BrowserPage):
    """A page of a request in the browser."""

    def __init__(self, browser: Any, file: Path, result: dict[str, Any] | None = None) -> None:
        """Open the page."""
        super().__init__(browser, file.as_uri())
        self.file, self.result = file, result

    def toggle(self, name: str) -> None:
        self.find(f'#algorithms [data-name="{name}"]').click()


def test_it_is_one_file_that_loads_nothing(page: Page) -> None:
    loaded = page.browser.execute_script(
        "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    )
    assert all(name.startswith('data:') for name in loaded)
    assert not re.search(r'(src|href)="(?!data:)|@import|url\(', page.file.read_text())
    assert page.file.stat().st_size < 1_000_000


def test_a_script_that_fails_is_noticed(page: Page, tmp_path: Path) -> None:
    broken = tmp_path / 'broken.html'
    broken.write_text(
        page.file.read_text().replace('function drawMap() {', 'function drawMap() {{')
    )
    assert Page(page.browser, broken).errors() != []
    silent = tmp_path / 'silent.html'
    silent.write_text(page.file.read_text().replace('drawEnds();', 'drawNothing();', 1))
    failing = Page(page.browser, silent)
    failing.wait(lambda: failing.errors() != [])
    page.browser.get('about:blank')
    page.errors()  # takes away those that were meant to be


def test_it_holds_the_search_that_was_asked_for(page: Page) -> None:
    data = data_of(page.file)
    assert {search['name']: search['colour'] for search in data['searches']} == SHOWN
    (asked,) = (search for search in data['searches'] if search['asked'])
    assert page.result is not None
    assert asked['name'] == page.result['algorithm'] == 'hit_and_run'
    assert asked['path'] == page.result['path']
    assert asked['iterations'] == page.result['iterations']
    assert asked['elapsed'] == page.result['elapsed']  # the very same search
    samples = np.frombuffer(base64.b64decode(asked['samples']), '<f4').reshape(-1, 2)
    # The chain of the walk is the path as it was found, up to the goal that its last one sees.
    assert samples == pytest.approx(np.array(asked['found'])[:-1], rel=1e-6)
    chords = np.frombuffer(base64.b64decode(asked['chords']), '<f4').reshape(-1, 2, 2)[1:]
    along = chords[:, 1] - chords[:, 0]
    to_sample, to_parent = samples[1:] - chords[:, 0], samples[:-1] - chords[:, 0]
    for between in (to_sample, to_parent):
        part = (between * along).sum(axis=1) / (along * along).sum(axis=1)
        assert ((part > 0) & (part < 1)).all()
        assert part[:, np.newaxis] * along == pytest.approx(between, abs=1e-4)


@pytest.mark.parametrize(
    'settings',
    [['--alternatives', 2, '--goal-radius', 0.5], ['--no-simplify'], ['--clearance', 0.2]],
    ids=lambda settings: settings[0],
)
def test_every_algorithm_answers_as_the_command_does(
    run: Callable[..., Ran],
    rooms: OccupancyMap,
    rooms_file: Path,
    tmp_path: Path,
    settings: list[object],
) -> None:
    file = tmp_path / 'page.html'
    command = ['plan', rooms_file, *through_the_door(rooms), '--seed', 4, '--time-limit', 600]
    command += ['--optimize-for', 0]
    assert run(*command, *settings, '--html', file).code == 0
    shown = {search['name']: search for search in data_of(file)['searches']}
    assert shown.keys() == SHOWN.keys()
    for name, search in shown.items():
        result = json.loads(run(*command, '--algorithm', name, *settings, '--json').out)
        assert [search['path'], *search['others']] == result['paths']
        assert search['iterations'] == result['iterations']
        assert search['found'][0] == search['path'][0]


def test_every_algorithm_looks_for_shorter_paths(
    run: Callable[..., Ran], rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    file, ends = tmp_path / 'page.html', through_the_door(rooms)
    assert run('plan', rooms_file, *ends, '--optimize-for', 0.1, '--html', file).code == 0
    assert 'the best path of 0.1 s' in data_of(file)['options']

    space = GridSpace.from_occupancy(rooms.data, rooms.resolution, rooms.origin)
    request = {'start': ends[1:3], 'goal': ends[4:6], 'seed': 4, 'time_limit': math.inf}
    for name in SHOWN:
        plain = plan(space, **request, algorithm=name)
        better = plan(space, **request, algorithm=name, optimize_iterations=2)
        assert better.length <= plain.length
        is_shortest = plain.length <= (1.0 + 1e-6) * plain.lower_bound
        assert (better.iterations > plain.iterations) is not is_shortest
        assert is_shortest is (name == 'polyanya')


@pytest.mark.parametrize('goal_radius', [0.0, 1.0])
@pytest.mark.parametrize('algorithm', SHOWN)
def test_the_path_as_found_lies_on_the_samples(algorithm: str, goal_radius: float) -> None:
    office = load_map(OFFICE)
    space = GridSpace.from_occupancy(office.data, office.resolution, office.origin)
    request = {'algorithm': algorithm, 'goal_radius': goal_radius, 'time_limit': math.inf}
    goal = (34.0, 5.0)
    for seed in range(10):
        shortened, found = (
            plan(space, (3.0, 22.0), goal, simplify=simplify, seed=seed, **request)
            for simplify in (True, False)
        )
        assert np.array_equal(path_as_found(shortened), found.path)


def test_a_path_that_another_search_found_is_not_drawn(rooms: OccupancyMap) -> None:
    space = GridSpace.from_occupancy(rooms.data, rooms.resolution, rooms.origin)
    ends = at(rooms, 5, 5), at(rooms, 8, 75)
    one, other = (plan(space, *ends, algorithm='rrt', seed=seed) for seed in (1, 2))
    assert len(path_as_found(one)) > 2
    assert len(path_as_found(replace(one, first_solution=other.first_solution))) == 0
    assert len(path_as_found(replace(one, first_solution=None))) == 0


def test_it_plays_to_the_end(page: Page) -> None:
    page.pause()
    began = page.time()
    page.browser.execute_script('play(true)')
    page.wait(lambda: page.time() > began)
    page.find('#time').send_keys(Keys.END, Keys.ARROW_LEFT, Keys.ARROW_LEFT)
    page.find('#play').click()
    page.wait(lambda: page.time() == 1000)
    assert page.text('#now') == 'done'
    assert page.find('#play').get_attribute('aria-label') == 'Play'


def test_the_search_unfolds_and_ends_in_the_path(page: Page) -> None:
    page.go_to(Keys.HOME)
    assert page.text('#now') == '1 sample'
    assert not page.has(SHOWN['hit_and_run'])
    page.go_to(Keys.END)
    assert page.has(SHOWN['hit_and_run'])
    for layer in ('samples', 'tree', 'chord', 'detours'):
        page.find(f'#layers [name="{layer}"]').click()
    assert page.has(SHOWN['hit_and_run'])
    page.find('#layers [name="path"]').click()
    assert not page.has(SHOWN['hit_and_run'])


def test_algorithms_are_switched_on_and_off(page: Page) -> None:
    page.go_to(Keys.END)
    for name, colour in SHOWN.items():
        assert page.has(colour) == (name == 'hit_and_run')
        page.toggle(name)
        assert page.has(colour) == (name != 'hit_and_run')


def test_zoom_keeps_the_place_under_the_pointer_and_fit_comes_back(page: Page) -> None:
    page.go_to(Keys.END)
    whole = page.pixels()
    canvas = page.find('#view')
    ActionChains(page.browser).move_to_element_with_offset(canvas, -100, -50).perform()
    place, scale = page.text('#place'), page.text('#scale')
    page.browser.execute_script(
        'document.getElementById("view").dispatchEvent(new WheelEvent("wheel", '
        '{deltaY: -600, clientX: 600, clientY: 350}))'
    )
    assert not np.array_equal(page.pixels(), whole)
    assert page.text('#scale') != scale
    page.find('#fit').click()
    assert np.array_equal(page.pixels(), whole)
    ActionChains(page.browser).drag_and_drop_by_offset(canvas, 60, 30).perform()
    assert not np.array_equal(page.pixels(), whole)
    ActionChains(page.browser).move_to_element_with_offset(canvas, -40, -20).perform()
    assert page.text('#place') == place


def test_words_say_what_is_to_be_seen(page: Page) -> None:
    page.go_to(Keys.HOME)
    (about,) = (entry.summary for entry in PLANNERS if entry.name == 'hit_and_run')
    assert page.text('#caption')[1:] == f'{about[1:]}.'
    page.go_to(Keys.END)
    assert page.result is not None
    assert f'{page.result["length"]:.1f} m' in page.text('#caption')
    for name in SHOWN:
        (search,) = (s for s in data_of(page.file)['searches'] if s['name'] == name)
        assert search['about']
    for words in ('robot radius 0.22 m', 'seed 3', '(34, 5)', 'occupied', 'unknown', 'free'):
        assert words in page.text('#panel')


def test_keys_play_step_zoom_and_move(page: Page) -> None:
    page.go_to(Keys.HOME)
    page.browser.execute_script('document.activeElement.blur()')
    for key, samples in ((Keys.ARROW_RIGHT, 2), (Keys.ARROW_RIGHT, 3), (Keys.ARROW_LEFT, 2)):
        page.press(key)
        assert page.text('#now') == f'{samples} samples'
    page.press(Keys.SPACE)
    assert page.find('#play').get_attribute('aria-label') == 'Pause'
    page.press(Keys.SPACE)
    assert page.find('#play').get_attribute('aria-label') == 'Play'
    page.go_to(Keys.END)
    whole = page.pixels()
    for keys in ('+', '-'):
        page.press(keys)
        assert not np.array_equal(page.pixels(), whole)
        page.press('0')
        assert np.array_equal(page.pixels(), whole)
    page.browser.execute_script('document.getElementById("view").focus()')
    for key in (Keys.ARROW_RIGHT, Keys.ARROW_LEFT, Keys.ARROW_UP, Keys.ARROW_DOWN):
        page.press(key)
        assert not np.array_equal(page.pixels(), whole)
        assert page.time() == 1000
        page.press('0')
    # What has the focus keeps its own keys.
    switch = page.find('#algorithms [data-name="rrt"]')
    switch.send_keys(Keys.SPACE)
    assert switch.get_attribute('aria-pressed') == 'true'
    assert page.find('#play').get_attribute('aria-label') == 'Play'


def test_a_phone_shows_the_map_first_and_the_panel_on_demand(page: Page) -> None:
    page.browser.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', PHONE)
    try:
        page.browser.refresh()
        page.go_to(Keys.END)
        assert page.has(SHOWN['hit_and_run'])
        assert not page.find('#algorithms').is_displayed()
        page.find('summary').click()
        page.toggle('rrt')
        assert page.has(SHOWN['rrt'])
        inside = page.browser.execute_script(
            "return [...document.querySelectorAll('button, input, summary, #now, #caption')]"
            '.map((part) => part.getBoundingClientRect())'
            '.every((box) => box.left >= 0 && box.right <= innerWidth)'
        )
        assert inside
    finally:
        page.browser.execute_cdp_cmd('Emulation.clearDeviceMetricsOverride', {})


def test_a_search_without_a_path_is_shown_too(
    browser: Any, run: Callable[..., Ran], rooms_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / 'page.html'
    ran = run(
        'plan', rooms_file, '--start', -1.5, 3.5, '--goal', 2.5, 8.4, '--html', file, '--seed', 1
    )  # the goal lies in the closed cupboard
    assert ran.code == 1, ran.out
    page = Page(browser, file)
    page.go_to(Keys.END)
    assert 'unreachable' in page.text('#algorithms')
    assert page.errors() == []


@pytest.mark.interpreted
def test_a_robot_with_a_footprint_moves_along_its_path(
    browser: Any, run: Callable[..., Ran], rooms: OccupancyMap, rooms_file: Path, tmp_path: Path
) -> None:
    file = tmp_path / 'page.html'
    start, goal = (*at(rooms, 8, 8), 0.4), (*at(rooms, 10, 70), 3.5)
    robot = ('--footprint', '[[0.3, 0.2], [0.3, -0.2], [-0.2, -0.2], [-0.2, 0.2]]', '--seed', 1)
    limits = ('--optimize-for', 0, '--time-limit', 600)
    ran = run(
        'plan', rooms_file, '--start', *start, '--goal', *goal, *robot, *limits, '--html', file
    )
    assert ran.code == 0, ran.err
    data = data_of(file)
    (asked,) = (search for search in data['searches'] if search['asked'])
    assert [search['name'] for search in data['searches']] == list(POSE_PLANNERS)
    poses = np.array(asked['path'])
    np.testing.assert_allclose(poses[0], start)
    turned = poses[-1] - goal
    assert np.hypot(*turned[:2]) < 1e-9 and abs(np.sin(turned[2] / 2.0)) < 1e-9
    # So that the page can interpolate them: no jump by a whole turn.
    assert np.abs(np.diff(poses, axis=0)).max() <= 0.1 + 1e-9
    page = Page(browser, file)
    names = '[...document.querySelectorAll("#layers input")].map((box) => box.name)'
    assert browser.execute_script(f'return {names}') == [
        'footprint',
        'samples',
        'tree',
        'chord',
        'path',
    ]
    page.pause()
    for layer in ('samples', 'tree', 'chord', 'path'):
        page.find(f'#layers [name="{layer}"]').click()
    seen = []
    for time in (0.9, 0.95):
        browser.execute_script(f'setTime({time})')
        assert page.has(asked['colour'])  # the robot on its way
        seen.append(page.pixels())
    assert (seen[0] != seen[1]).any()
    page.find('#layers [name="footprint"]').click()
    assert not page.has(asked['colour'])
    assert 'footprint of 0.5 x 0.4 m' in page.text('#options')
    assert page.errors() == []


def test_a_page_with_another_ending_is_refused(run: Callable[..., Ran], tmp_path: Path) -> None:
    ran = run('plan', OFFICE, *REQUEST, '--html', tmp_path / 'page.png')
    assert ran.code == 2
    assert 'does not end in one of .html, .htm' in ran.err
