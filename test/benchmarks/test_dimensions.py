"""Problems in n dimensions: ours, OMPL's program and the judge speak of the same free space."""

from itertools import islice
from test.sweeps import sweep

from benchmarks.dimensions.courses import Arm, GRAZE, instances, PROBLEMS
import numpy as np
import pytest

pytestmark = pytest.mark.interpreted

#: The problem whose instances take longest to find.
ONE = '6-D, 30 balls'


@pytest.mark.parametrize('name', PROBLEMS)
def test_the_judge_knows_the_free_space(name):
    """Our space and the judge agree: the ends of a request are free, its segment is not."""
    rng = np.random.default_rng(0)
    for course, request in islice(instances(name, 0), 2):
        space = course.space()
        points = rng.uniform(*course.bounds, (30, space.dim))
        np.testing.assert_array_equal(space.contains(points), course.free(points))
        assert space.contains(request).all()
        assert not space.is_motion_valid(*request)
        assert not course.is_path_free(request)


@pytest.mark.parametrize('name', [sweep(ONE), *(each for each in PROBLEMS if each != ONE)])
def test_an_instance_follows_from_its_seed(name):
    """Those of other seeds, which settings were tuned on, are others."""
    (course, request), (_, other) = islice(instances(name, 1000), 2)
    again = next(instances(name, 1000))
    assert course.words() == again.course.words()
    np.testing.assert_array_equal(request, again.request)
    assert (request != other).any()


def test_the_arm_is_judged_at_the_depth_that_its_motions_may_miss():
    """A disc at the tip of the stretched arm: deeper than ``GRAZE`` nothing is forgiven."""
    angles = np.zeros((1, 7))
    for depth, forgiven in ((0.9 * GRAZE, True), (1.1 * GRAZE, False)):
        arm = Arm(np.array([[1.0 + 0.1 - depth, 0.0, 0.1]]))
        assert not arm.free(angles).any()
        assert arm.free(angles, GRAZE).all() == forgiven
