// OMPL for a car with a footprint: reads commands, one a line, and answers each request with one.
//
//   pose_planners SEED
//   grid FILE RADIUS STEP N X Y X Y ...     a grid as planners.cpp reads it, the least turning radius,
//                                           the distance between states that are tested, and the N
//                                           vertices of a convex footprint; all in cells. No answer.
//   PLANNER SECONDS X Y YAW X Y YAW         a request: start and goal
//   SECONDS LENGTH                          the answer: inf where no path was found in time;
//                                           seconds of the processor for setup and solve
//
// The space is OMPL's own for Reeds and Shepp's car. A state is tested exactly, polygon against
// cells; a motion as OMPL does it, at states no farther apart than STEP.

#include <ctime>
#include <iostream>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/ReedsSheppStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/rrt/BiTRRT.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>

#include "footprint.hpp"
#include "grid.hpp"
#include "named_planners.hpp"
#include "seed.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace
{

using Car = ob::ReedsSheppStateSpace;

const NamedPlanners PLANNERS = {
  {"RRTConnect", make<og::RRTConnect>}, {"BiTRRT", make<og::BiTRRT>},
  {"BKPIECE1", make<og::BKPIECE1>}, {"BiEST", make<og::BiEST>}, {"RRT", make<og::RRT>},
};

class Lookup : public ob::StateValidityChecker
{
public:
  Lookup(const ob::SpaceInformationPtr & si, const Footprint & footprint)
  : ob::StateValidityChecker(si), footprint_(footprint) {}

  bool isValid(const ob::State * state) const override
  {
    const auto * pose = state->as<Car::StateType>();
    return footprint_.is_free(pose->getX(), pose->getY(), pose->getYaw());
  }

private:
  const Footprint & footprint_;
};

// A grid and a footprint, and OMPL set up on it.
class Course
{
public:
  Course(const std::string & file, double radius, double step,
    std::vector<std::pair<double, double>> vertices)
  : grid_(file), footprint_(grid_, std::move(vertices))
  {
    auto space = std::make_shared<Car>(radius);
    ob::RealVectorBounds bounds(2);
    bounds.low = {1.0, 1.0};
    bounds.high = {grid_.columns - 1.0, grid_.rows - 1.0};
    space->setBounds(bounds);
    si_ = std::make_shared<ob::SpaceInformation>(space);
    si_->setStateValidityChecker(std::make_shared<Lookup>(si_, footprint_));
    si_->setStateValidityCheckingResolution(step / space->getMaximumExtent());
    si_->setup();
  }

  // Return the seconds of setup and solve, and the length of the path.
  std::pair<double, double> answer(
    const std::string & request, double seconds, const double (& ends)[6]) const
  {
    const std::string name = request.substr(0, request.find(SIMPLIFY));
    auto problem = std::make_shared<ob::ProblemDefinition>(si_);
    ob::ScopedState<Car> start(si_), goal(si_);
    start->setXY(ends[0], ends[1]);
    start->setYaw(ends[2]);
    goal->setXY(ends[3], ends[4]);
    goal->setYaw(ends[5]);
    problem->setStartAndGoalStates(start, goal);
    const ob::PlannerPtr planner = PLANNERS.at(name)(si_);
    planner->setProblemDefinition(problem);
    double length = std::numeric_limits<double>::infinity();
    const auto began = std::clock();
    planner->setup();
    if (planner->solve(ob::timedPlannerTerminationCondition(seconds)) ==
      ob::PlannerStatus::EXACT_SOLUTION)
    {
      og::PathGeometric path = *problem->getSolutionPath()->as<og::PathGeometric>();
      if (name != request) {
        og::PathSimplifier(si_, problem->getGoal()).simplifyMax(path);
      }
      length = path.length();
    }
    return {static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC, length};
  }

private:
  Grid grid_;
  Footprint footprint_;
  ob::SpaceInformationPtr si_;
};

std::unique_ptr<Course> read_course(std::istream & stream)
{
  std::string file;
  double radius, step;
  std::size_t n;
  stream >> file >> radius >> step >> n;
  std::vector<std::pair<double, double>> vertices(n);
  for (auto & vertex : vertices) {
    stream >> vertex.first >> vertex.second;
  }
  return std::make_unique<Course>(file, radius, step, vertices);
}

}  // namespace

int main(int argc, char ** argv)
{
  if (!seed_ompl(argc, argv)) {
    return 2;
  }
  std::unique_ptr<Course> course;
  for (std::string command; std::cin >> command; ) {
    if (command == "grid") {
      course = read_course(std::cin);
      continue;
    }
    double seconds, ends[6];
    std::cin >> seconds;
    for (double & value : ends) {
      std::cin >> value;
    }
    const auto answer = course->answer(command, seconds, ends);
    std::cout << answer.first << ' ' << answer.second << std::endl;
  }
  return 0;
}
