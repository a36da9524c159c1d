// What OMPL asks of a space, answered by a grid: states, motions, and where a state lies.

#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProjectionEvaluator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>

#include "grid.hpp"

namespace ob = ompl::base;

inline const double * coordinates(const ob::State * state)
{
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

class GridLookup : public ob::StateValidityChecker
{
public:
  GridLookup(const ob::SpaceInformationPtr & si, const Grid & grid)
  : ob::StateValidityChecker(si), grid_(grid) {}

  bool isValid(const ob::State * state) const override
  {
    const double * at = coordinates(state);
    return si_->satisfiesBounds(state) &&
           grid_.is_free(static_cast<std::int64_t>(at[0]), static_cast<std::int64_t>(at[1]));
  }

private:
  const Grid & grid_;
};

class GridTraversal : public ob::MotionValidator
{
public:
  GridTraversal(const ob::SpaceInformationPtr & si, const Grid & grid)
  : ob::MotionValidator(si), grid_(grid) {}

  bool checkMotion(const ob::State * from, const ob::State * to) const override
  {
    return si_->satisfiesBounds(to) && free_part(from, to) >= 1.0;
  }

  bool checkMotion(
    const ob::State * from, const ob::State * to,
    std::pair<ob::State *, double> & last_valid) const override
  {
    const double part = si_->satisfiesBounds(to) ? free_part(from, to) : 0.0;
    if (part >= 1.0) {
      return true;
    }
    last_valid.second = std::max(0.0, part - STOP_BEFORE / si_->distance(from, to));
    if (last_valid.first != nullptr) {
      si_->getStateSpace()->interpolate(from, to, last_valid.second, last_valid.first);
    }
    return false;
  }

private:
  static constexpr double STOP_BEFORE = 1e-6;  // cells

  double free_part(const ob::State * from, const ob::State * to) const
  {
    const double * a = coordinates(from);
    const double * b = coordinates(to);
    return grid_.free_part(a[0], a[1], b[0], b[1]);
  }

  const Grid & grid_;
};

// The projection that OMPL would choose for itself, with its cells: the one in Debian's library ends
// in a failed assertion.
class Position : public ob::ProjectionEvaluator
{
public:
  Position(const ob::StateSpace * space, const ob::RealVectorBounds & bounds)
  : ob::ProjectionEvaluator(space)
  {
    for (const double extent : bounds.getDifference()) {
      cellSizes_.push_back(extent / SPLITS);
    }
  }

  unsigned int getDimension() const override {return 2;}

  void project(const ob::State * state, Eigen::Ref<Eigen::VectorXd> projection) const override
  {
    projection[0] = coordinates(state)[0];
    projection[1] = coordinates(state)[1];
  }

private:
  static constexpr double SPLITS = 20.0;
};
