// OMPL on occupancy grids: reads commands, one a line, and answers each request with a line.
//
//   planners SEED
//   grid FILE               int32 rows, int32 columns, then a byte for each cell, row by row, not 0
//                           where it is blocked; the rim must be blocked. No answer.
//   PLANNER SECONDS START_X START_Y GOAL_X GOAL_Y        in cells; a request on that grid
//   SECONDS N X Y X Y ...   the answer: N vertices, 0 when no path was found in time
//
// The seconds of an answer are those of setup() and solve() of a new planner (and of the path
// simplifier where the request asks for it). States are looked up in the grid; motions are
// tested exactly, cell by cell, so that no path leads through a thin wall.

#include <chrono>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/informedtrees/BITstar.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/rrt/InformedRRTstar.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/sbl/SBL.h>

#include "grid.hpp"
#include "named_planners.hpp"
#include "seed.hpp"
#include "validity.hpp"

namespace og = ompl::geometric;

namespace
{

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

const NamedPlanners PLANNERS = {
  {"RRTConnect", make<og::RRTConnect>}, {"BKPIECE1", make<og::BKPIECE1>},
  {"KPIECE1", make<og::KPIECE1>}, {"RRT", make<og::RRT>}, {"EST", make<og::EST>},
  {"SBL", make<og::SBL>}, {"RRTstar", make<og::RRTstar>},
  {"InformedRRTstar", make<og::InformedRRTstar>}, {"BITstar", make<og::BITstar>},
};

struct Request
{
  std::string planner;
  double seconds, ends[4];

  bool simplify() const {return planner.find(SIMPLIFY) != std::string::npos;}
  std::string name() const {return planner.substr(0, planner.find(SIMPLIFY));}
};

std::istream & operator>>(std::istream & stream, Request & request)
{
  stream >> request.seconds;
  for (double & value : request.ends) {
    stream >> value;
  }
  return stream;
}

// A grid, and OMPL set up on it.
class Course
{
public:
  explicit Course(const std::string & file)
  : grid_(file)
  {
    auto space = std::make_shared<ob::RealVectorStateSpace>(2);
    ob::RealVectorBounds bounds(2);
    // One cell of the rim on each side is blocked: leave it out.
    bounds.low = {1.0, 1.0};
    bounds.high = {grid_.columns - 1.0, grid_.rows - 1.0};
    space->setBounds(bounds);
    si_ = std::make_shared<ob::SpaceInformation>(space);
    si_->setStateValidityChecker(std::make_shared<GridLookup>(si_, grid_));
    si_->setMotionValidator(std::make_shared<GridTraversal>(si_, grid_));
    si_->setup();
    space->registerDefaultProjection(std::make_shared<Position>(space.get(), bounds));
  }

  std::string answer(const Request & request) const
  {
    auto problem = std::make_shared<ob::ProblemDefinition>(si_);
    ob::ScopedState<ob::RealVectorStateSpace> start(si_), goal(si_);
    for (int i = 0; i < 2; ++i) {
      start[i] = request.ends[i];
      goal[i] = request.ends[i + 2];
    }
    problem->setStartAndGoalStates(start, goal);
    // Those that want no shorter path than the first do not look at it.
    problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si_));
    og::PathGeometric path(si_);
    const double seconds = solve(request, problem, path);
    std::ostringstream line;
    line << std::setprecision(17) << seconds << ' ' << path.getStateCount();
    for (const ob::State * state : path.getStates()) {
      line << ' ' << coordinates(state)[0] << ' ' << coordinates(state)[1];
    }
    return line.str();
  }

private:
  double solve(
    const Request & request, const ob::ProblemDefinitionPtr & problem,
    og::PathGeometric & path) const
  {
    const ob::PlannerPtr planner = PLANNERS.at(request.name())(si_);
    planner->setProblemDefinition(problem);
    const auto began = Clock::now();
    planner->setup();
    const ob::PlannerStatus status =
      planner->solve(ob::timedPlannerTerminationCondition(request.seconds));
    if (status == ob::PlannerStatus::EXACT_SOLUTION) {
      path = *problem->getSolutionPath()->as<og::PathGeometric>();
      if (request.simplify()) {
        og::PathSimplifier(si_, problem->getGoal()).simplifyMax(path);
      }
    }
    return Seconds(Clock::now() - began).count();
  }

  Grid grid_;
  ob::SpaceInformationPtr si_;
};

}  // namespace

int main(int argc, char ** argv)
{
  if (!seed_ompl(argc, argv)) {
    return 2;
  }
  std::unique_ptr<Course> course;
  for (Request request; std::cin >> request.planner; ) {
    if (request.planner == "grid") {
      std::string file;
      std::cin >> file;
      course = std::make_unique<Course>(file);
    } else if (std::cin >> request) {
      std::cout << course->answer(request) << std::endl;
    }
  }
  return 0;
}
