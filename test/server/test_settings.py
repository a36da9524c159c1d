"""The table of parameters: defaults, rules, and the documented configuration."""

import dataclasses
import math
from pathlib import Path
from typing import Any

from hnr_planner.core import KINODYNAMIC_PLANNERS
from hnr_planner.server.parameters.arguments import (
    plan_arguments,
    sample_arguments,
    trajectory_arguments,
)
from hnr_planner.server.parameters.rules import SettingsError
from hnr_planner.server.parameters.settings import DEFAULTS, RULES, Settings
import pytest
import yaml

CONFIG = Path(__file__).parents[2] / 'config' / 'hnr_planner.yaml'


def test_configuration_holds_every_parameter_with_its_default() -> None:
    configured = yaml.safe_load(CONFIG.read_text())['/**/hnr_planner']['ros__parameters']
    # A file has lists, a frozen value has tuples.
    defaults = {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in dataclasses.asdict(DEFAULTS).items()
    }
    assert configured == defaults
    for name, value in configured.items():
        assert type(value) is type(defaults[name]), name


def test_configuration_states_units_and_ranges() -> None:
    text = CONFIG.read_text()
    for name, rule in RULES.items():
        comment = text[: text.index(f'\n    {name}:')].rsplit('\n\n', 1)[1]
        assert comment.lstrip().startswith('#'), name
        words = ' '.join(comment.replace('#', ' ').split())
        assert not rule.unit or f'[{rule.unit}]' in words, name
        assert all(choice in words for choice in rule.choices), name
        if rule.lower is not None and rule.upper is not None:
            # -1 has a meaning of its own, beside the range.
            assert f'{max(rule.lower, 0):.10g} to {rule.upper:.10g}' in words, name
            assert rule.lower >= 0 or '-1' in words, name


@pytest.mark.parametrize(
    ('name', 'value', 'words'),
    [
        ('algorithm', 'a_star', 'hit_and_run'),
        ('unknown', 'maybe', 'blocked, free'),
        ('robot_radius', -0.1, '0..1000 m'),
        ('robot_radius', math.nan, 'nan'),
        ('occupied_threshold', 0, '1..100'),
        ('occupied_threshold', 101, '1..100'),
        ('time_limit', 0.0, '0.001..3600 s'),
        ('time_limit', math.inf, 'inf'),
        ('max_iterations', -1, '0..2147483647'),
        ('goal_radius', -1.0, '0..1000 m'),
        ('optimize_for', -1.0, '0..3600 s'),
        ('seed', -2, '-1..2147483647'),
        ('seed', 2**31, '-1..2147483647'),
        ('pose_spacing', -0.5, 'vertices only'),
        ('samples_max', -1, '0..10000000'),
        ('sample_count', 0, '1..1000000'),
        ('sample_walk', 'drunk', 'hit_and_run'),
        ('sample_radius', -0.1, '0..1000 m'),
        ('sample_thin', 0, '1..100000'),
        ('map_wait', -1.0, '0..3600 s'),
        ('clearance', -0.1, '0..1000 m'),
        ('alternatives', 0, '1..16'),
        ('alternatives', 17, '1..16'),
        ('drive', 'legs', 'car, differential, omnidirectional'),
        ('min_turning_radius', -1.0, '0..1000 m'),
        ('reverse_penalty', 0.5, '1..1000'),
        ('heading_tolerance', 3.2, '0..3.141592654 rad'),
    ],
)
def test_impossible_value_is_refused_with_value_and_rule(
    name: str, value: Any, words: str
) -> None:
    with pytest.raises(SettingsError) as refusal:
        dataclasses.replace(DEFAULTS, **{name: value})
    assert name in str(refusal.value)
    assert repr(value) in str(refusal.value)
    assert words in str(refusal.value)


@pytest.mark.parametrize(('name', 'value'), [('clearance', 0.5), ('alternatives', 2)])
def test_what_needs_shortening_is_refused_without(name: str, value: float) -> None:
    with pytest.raises(SettingsError, match='simplify is false') as refusal:
        dataclasses.replace(DEFAULTS, simplify=False, **{name: value})
    assert repr(value) in str(refusal.value)


def test_escape_of_nav2_leaves_an_inflation_and_no_more() -> None:
    nav2 = yaml.safe_load((CONFIG.parent / 'nav2.yaml').read_text())
    values = nav2['/**/hnr_planner']['ros__parameters']
    assert 0.0 < values['escape_radius'] <= values['robot_radius'] + 2 * 0.05


@pytest.mark.parametrize('alias', ['GridBased', ':auto', 'GridBased:a_star', 'GridBased:'])
def test_alias_of_no_algorithm_is_refused_with_value_and_rule(alias: str) -> None:
    with pytest.raises(SettingsError) as refusal:
        dataclasses.replace(DEFAULTS, planner_aliases=('ok:rrt', alias))
    assert repr(alias) in str(refusal.value)
    assert 'NAME:ALGORITHM' in str(refusal.value) and 'hit_and_run' in str(refusal.value)


def test_aliases_may_be_none() -> None:
    assert dataclasses.replace(DEFAULTS, planner_aliases=('',)).aliases == {}
    assert dataclasses.replace(DEFAULTS, planner_aliases=()).aliases == {}


def test_first_map_is_awaited_within_the_time_limit() -> None:
    assert Settings(map_wait=5.0, time_limit=0.5).patience == 0.5
    assert Settings(map_wait=0.2, time_limit=0.5).patience == 0.2


def test_trajectory_that_is_not_shortened_is_not_optimized_either() -> None:
    for algorithm in KINODYNAMIC_PLANNERS:
        arguments = trajectory_arguments(Settings(simplify=False), algorithm, goal_is_moved=False)
        assert (arguments['simplify'], arguments['optimize_for']) == (False, 0.0)
        arguments = trajectory_arguments(Settings(), algorithm, goal_is_moved=False)
        assert arguments['optimize_for'] == Settings().optimize_for > 0.0
    assert plan_arguments(Settings(simplify=False))['optimize_for'] > 0.0


def test_no_seed_and_no_limit_reach_the_planner_as_none() -> None:
    assert plan_arguments(Settings())['seed'] is None
    assert sample_arguments(Settings())['seed'] is None
    assert plan_arguments(Settings())['max_iterations'] is None
    chosen = plan_arguments(Settings(seed=0, max_iterations=5))
    assert (chosen['seed'], chosen['max_iterations']) == (0, 5)
