// OMPL's control planners on occupancy grids, for the double integrator.
//
//   control_planners SEED
//   grid FILE               as in planners.cpp. No answer.
//   PLANNER SECONDS ACCELERATION SPEED STEP RADIUS START_X START_Y GOAL_X GOAL_Y
//                           in cells and seconds; from rest into the region around the goal
//   SECONDS N T X Y VX VY AX AY ...
//                           the answer: N states, each with its time and the acceleration after it
//
// PLANNER+first ends with the first solution; alone it takes its time for a shorter one. The seconds
// of an answer are those of setup() and solve() of a new planner. Each step of propagation is a
// parabola that is tested exactly, cell by cell.

#include <chrono>
#include <cmath>
#include <functional>
#include <iomanip>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <sstream>
#include <string>

#include <ompl/base/OptimizationObjective.h>
#include <ompl/base/goals/GoalSampleableRegion.h>
#include <ompl/control/PathControl.h>
#include <ompl/control/SpaceInformation.h>
#include <ompl/control/planners/est/EST.h>
#include <ompl/control/planners/kpiece/KPIECE1.h>
#include <ompl/control/planners/rrt/RRT.h>
#include <ompl/control/planners/sst/SST.h>
#include <ompl/control/spaces/RealVectorControlSpace.h>

#include "parabola.hpp"
#include "seed.hpp"
#include "validity.hpp"

namespace oc = ompl::control;

namespace
{

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

const std::string FIRST = "+first";
enum {X, Y, VX, VY, TIME, DIMENSION};

template<typename Planner>
ob::PlannerPtr make(const oc::SpaceInformationPtr & si)
{
  return std::make_shared<Planner>(si);
}

const std::map<std::string, std::function<ob::PlannerPtr(const oc::SpaceInformationPtr &)>>
PLANNERS = {
  {"RRT", make<oc::RRT>}, {"SST", make<oc::SST>}, {"KPIECE1", make<oc::KPIECE1>},
  {"EST", make<oc::EST>},
};

struct Request
{
  std::string planner;
  double seconds, acceleration, speed, step, radius, start[2], goal[2];

  bool first() const {return planner.find(FIRST) != std::string::npos;}
  std::string name() const {return planner.substr(0, planner.find(FIRST));}
};

std::istream & operator>>(std::istream & stream, Request & request)
{
  stream >> request.seconds >> request.acceleration >> request.speed >> request.step;
  stream >> request.radius >> request.start[0] >> request.start[1];
  return stream >> request.goal[0] >> request.goal[1];
}

double * values(ob::State * state)
{
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

// Position and velocity; the time is carried along, and is no part of the distance.
class MovingSpace : public ob::RealVectorStateSpace
{
public:
  MovingSpace()
  : ob::RealVectorStateSpace(DIMENSION) {}

  double distance(const ob::State * a, const ob::State * b) const override
  {
    double squared = 0.0;
    for (int i = 0; i < TIME; ++i) {
      squared += std::pow(coordinates(a)[i] - coordinates(b)[i], 2);
    }
    return std::sqrt(squared);
  }
};

// Uniform in the disc of accelerations.
class DiscSampler : public oc::ControlSampler
{
public:
  DiscSampler(const oc::ControlSpace * space, double radius)
  : oc::ControlSampler(space), radius_(radius) {}

  void sample(oc::Control * control) override
  {
    const double length = radius_ * std::sqrt(rng_.uniform01());
    const double angle = rng_.uniformReal(-M_PI, M_PI);
    auto * a = control->as<oc::RealVectorControlSpace::ControlType>()->values;
    a[0] = length * std::cos(angle);
    a[1] = length * std::sin(angle);
  }

private:
  double radius_;
};

// The duration from one state to the next.
class Duration : public ob::OptimizationObjective
{
public:
  explicit Duration(const ob::SpaceInformationPtr & si)
  : ob::OptimizationObjective(si) {}
  ob::Cost stateCost(const ob::State *) const override {return ob::Cost(0.0);}
  ob::Cost motionCost(const ob::State * a, const ob::State * b) const override
  {
    return ob::Cost(std::abs(coordinates(b)[TIME] - coordinates(a)[TIME]));
  }
};

class Region : public ob::GoalSampleableRegion
{
public:
  Region(const ob::SpaceInformationPtr & si, const Request & request)
  : ob::GoalSampleableRegion(si), request_(request) {setThreshold(request.radius);}

  double distanceGoal(const ob::State * state) const override
  {
    const double * at = coordinates(state);
    return std::hypot(at[X] - request_.goal[0], at[Y] - request_.goal[1]);
  }
  void sampleGoal(ob::State * state) const override
  {
    double * at = values(state);
    at[X] = request_.goal[0];
    at[Y] = request_.goal[1];
    at[VX] = at[VY] = at[TIME] = 0.0;
  }
  unsigned int maxSampleCount() const override {return std::numeric_limits<unsigned int>::max();}

private:
  const Request & request_;
};

class Plane : public ob::ProjectionEvaluator
{
public:
  Plane(const ob::StateSpace * space, const Grid & grid)
  : ob::ProjectionEvaluator(space)
  {
    bounds_.resize(2);
    bounds_.low = {0.0, 0.0};
    bounds_.high = {static_cast<double>(grid.columns), static_cast<double>(grid.rows)};
    cellSizes_ = {grid.columns / 20.0, grid.rows / 20.0};
  }
  unsigned int getDimension() const override {return 2;}
  void project(const ob::State * state, Eigen::Ref<Eigen::VectorXd> projection) const override
  {
    projection[0] = coordinates(state)[X];
    projection[1] = coordinates(state)[Y];
  }
};

oc::SpaceInformationPtr make_information(const Grid & grid, const Request & request)
{
  auto space = std::make_shared<MovingSpace>();
  ob::RealVectorBounds bounds(DIMENSION);
  const double v = request.speed;
  bounds.low = {1.0, 1.0, -v, -v, 0.0};
  bounds.high = {grid.columns - 1.0, grid.rows - 1.0, v, v, 1e6};
  space->setBounds(bounds);
  space->registerDefaultProjection(std::make_shared<Plane>(space.get(), grid));
  auto controls = std::make_shared<oc::RealVectorControlSpace>(space, 2);
  ob::RealVectorBounds pulls(2);
  pulls.setLow(-request.acceleration);
  pulls.setHigh(request.acceleration);
  controls->setBounds(pulls);
  controls->setControlSamplerAllocator(
    [a = request.acceleration](const oc::ControlSpace * of) {
      return std::make_shared<DiscSampler>(of, a);
    });
  auto si = std::make_shared<oc::SpaceInformation>(space, controls);
  si->setStateValidityChecker(
    [&grid, v](const ob::State * state) {
      const double * at = coordinates(state);
      return at[X] > 1.0 && std::hypot(at[VX], at[VY]) <= v &&
             grid.is_free(static_cast<std::int64_t>(at[X]), static_cast<std::int64_t>(at[Y]));
    });
  si->setStatePropagator(
    [&grid](const ob::State * from, const oc::Control * control, double duration, ob::State * to) {
      const double * at = coordinates(from);
      const auto * a = control->as<oc::RealVectorControlSpace::ControlType>()->values;
      const Coordinate x{at[X], at[VX], a[0]}, y{at[Y], at[VY], a[1]};
      const double begin = at[TIME];
      const bool free = is_free(grid, x, y, duration);
      double * end = values(to);
      // A motion that meets the boundary ends nowhere.
      end[X] = free ? x.at(duration) : -1.0;
      end[Y] = free ? y.at(duration) : -1.0;
      end[VX] = x.v + x.a * duration;
      end[VY] = y.v + y.a * duration;
      end[TIME] = begin + duration;
    });
  si->setPropagationStepSize(request.step);
  si->setMinMaxControlDuration(1, 20);
  si->setup();
  return si;
}

std::string answer(const Grid & grid, const Request & request)
{
  const auto si = make_information(grid, request);
  auto problem = std::make_shared<ob::ProblemDefinition>(si);
  ob::ScopedState<MovingSpace> start(si->getStateSpace());
  start[X] = request.start[0];
  start[Y] = request.start[1];
  start[VX] = start[VY] = start[TIME] = 0.0;
  problem->addStartState(start);
  problem->setGoal(std::make_shared<Region>(si, request));
  auto objective = std::make_shared<Duration>(si);
  if (request.first()) {
    objective->setCostThreshold(ob::Cost(1e9));
  }
  problem->setOptimizationObjective(objective);
  const ob::PlannerPtr planner = PLANNERS.at(request.name())(si);
  planner->setProblemDefinition(problem);
  const auto began = Clock::now();
  planner->setup();
  const ob::PlannerStatus status =
    planner->solve(ob::timedPlannerTerminationCondition(request.seconds));
  const double seconds = Seconds(Clock::now() - began).count();
  std::ostringstream line;
  line << std::setprecision(17) << seconds;
  if (status != ob::PlannerStatus::EXACT_SOLUTION) {
    line << " 0";
    return line.str();
  }
  const auto & path = *problem->getSolutionPath()->as<oc::PathControl>();
  line << ' ' << path.getStateCount();
  double time = 0.0;
  for (std::size_t k = 0; k < path.getStateCount(); ++k) {
    const double * at = coordinates(path.getState(k));
    const bool last = k + 1 == path.getStateCount();
    const double * a = last ? nullptr :
      path.getControl(k)->as<oc::RealVectorControlSpace::ControlType>()->values;
    line << ' ' << time << ' ' << at[X] << ' ' << at[Y] << ' ' << at[VX] << ' ' << at[VY];
    line << ' ' << (last ? 0.0 : a[0]) << ' ' << (last ? 0.0 : a[1]);
    time += last ? 0.0 : path.getControlDuration(k);
  }
  return line.str();
}

}  // namespace

int main(int argc, char ** argv)
{
  if (!seed_ompl(argc, argv)) {
    return 2;
  }
  std::unique_ptr<Grid> grid;
  for (Request request; std::cin >> request.planner; ) {
    if (request.planner == "grid") {
      std::string file;
      std::cin >> file;
      grid = std::make_unique<Grid>(file);
    } else if (std::cin >> request) {
      std::cout << answer(*grid, request) << std::endl;
    }
  }
  return 0;
}
