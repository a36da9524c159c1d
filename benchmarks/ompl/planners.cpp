// OMPL on an occupancy grid: reads a grid, then one request a line, and answers each with a line.
//
//   planners GRID SEED      GRID: int32 rows, int32 columns, then a byte for each cell, row by row,
//                           not 0 where it is blocked; the rim must be blocked
//   request                 PLANNER SECONDS START_X START_Y GOAL_X GOAL_Y        [cells]
//   answer                  SECONDS N X Y X Y ...   N vertices, 0 when no path was found in time
//
// The seconds of an answer are those of setup() and solve() of a new planner (and of the path
// simplifier where the request asks for it). States are looked up in the grid; motions are
// tested exactly, cell by cell, so that no path leads through a thin wall.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/ProjectionEvaluator.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/objectives/PathLengthOptimizationObjective.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/est/EST.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/KPIECE1.h>
#include <ompl/geometric/planners/rrt/RRT.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/rrt/RRTstar.h>
#include <ompl/geometric/planners/sbl/SBL.h>
#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace
{

const std::string SIMPLIFY = "+simplify";

struct Grid
{
  std::int32_t rows, columns;
  std::vector<std::uint8_t> blocked;

  explicit Grid(const char * file)
  {
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char *>(&rows), sizeof rows);
    stream.read(reinterpret_cast<char *>(&columns), sizeof columns);
    blocked.resize(static_cast<std::size_t>(rows) * columns);
    stream.read(reinterpret_cast<char *>(blocked.data()), blocked.size());
    if (!stream) {
      throw std::runtime_error(std::string("no grid in ") + file);
    }
  }

  bool is_free(std::int64_t column, std::int64_t row) const
  {
    return blocked[row * columns + column] == 0;
  }

  // The part of a segment (from its free beginning) that is free, 1 for all of it.
  double free_part(double ax, double ay, double bx, double by) const
  {
    auto column = static_cast<std::int64_t>(ax), row = static_cast<std::int64_t>(ay);
    const auto last_column = static_cast<std::int64_t>(bx);
    const auto last_row = static_cast<std::int64_t>(by);
    const int column_step = last_column >= column ? 1 : -1, row_step = last_row >= row ? 1 : -1;
    const double dx = std::abs(bx - ax), dy = std::abs(by - ay);
    // Distances to the next grid lines; that of the column comes first when to_x / dx < to_y / dy.
    double to_x = column_step > 0 ? column + 1 - ax : ax - column;
    double to_y = row_step > 0 ? row + 1 - ay : ay - row;
    while (column != last_column || row != last_row) {
      const double at_column = to_x * dy, at_row = to_y * dx;
      const bool column_next = row == last_row || (column != last_column && at_column <= at_row);
      const bool row_next = column == last_column || (row != last_row && at_row <= at_column);
      const double reached = column_next ? to_x / dx : to_y / dy;
      if (column_next && row_next &&
        !(is_free(column + column_step, row) && is_free(column, row + row_step)))
      {
        return reached;
      }
      if (column_next) {
        column += column_step;
        to_x += 1.0;
      }
      if (row_next) {
        row += row_step;
        to_y += 1.0;
      }
      if (!is_free(column, row)) {
        return reached;
      }
    }
    return 1.0;
  }
};

const double * coordinates(const ob::State * state)
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

ob::PlannerPtr make_planner(const std::string & name, const ob::SpaceInformationPtr & si)
{
  if (name == "RRTConnect") {return std::make_shared<og::RRTConnect>(si);}
  if (name == "BKPIECE1") {return std::make_shared<og::BKPIECE1>(si);}
  if (name == "KPIECE1") {return std::make_shared<og::KPIECE1>(si);}
  if (name == "RRT") {return std::make_shared<og::RRT>(si);}
  if (name == "EST") {return std::make_shared<og::EST>(si);}
  if (name == "SBL") {return std::make_shared<og::SBL>(si);}
  if (name == "RRTstar") {return std::make_shared<og::RRTstar>(si);}
  throw std::runtime_error("no planner is called " + name);
}

struct Request
{
  std::string planner;
  double seconds, ends[4];
};

std::istream & operator>>(std::istream & stream, Request & request)
{
  stream >> request.planner >> request.seconds;
  for (double & value : request.ends) {
    stream >> value;
  }
  return stream;
}

std::string answer(const ob::SpaceInformationPtr & si, Request request)
{
  const auto at = request.planner.find(SIMPLIFY);
  const bool simplify = at != std::string::npos;
  const std::string name = request.planner.substr(0, at);

  auto problem = std::make_shared<ob::ProblemDefinition>(si);
  ob::ScopedState<ob::RealVectorStateSpace> start(si), goal(si);
  for (int i = 0; i < 2; ++i) {
    start[i] = request.ends[i];
    goal[i] = request.ends[i + 2];
  }
  problem->setStartAndGoalStates(start, goal);
  if (name == "RRTstar") {
    problem->setOptimizationObjective(std::make_shared<ob::PathLengthOptimizationObjective>(si));
  }
  auto planner = make_planner(name, si);
  planner->setProblemDefinition(problem);

  const auto began = std::chrono::steady_clock::now();
  planner->setup();
  const bool solved =
    planner->solve(ob::timedPlannerTerminationCondition(request.seconds)) ==
    ob::PlannerStatus::EXACT_SOLUTION;
  og::PathGeometric path(si);
  if (solved) {
    path = *problem->getSolutionPath()->as<og::PathGeometric>();
    if (simplify) {
      og::PathSimplifier(si, problem->getGoal()).simplifyMax(path);
    }
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;

  std::ostringstream line;
  line << std::setprecision(17) << seconds.count() << ' ' << path.getStateCount();
  for (const ob::State * state : path.getStates()) {
    line << ' ' << coordinates(state)[0] << ' ' << coordinates(state)[1];
  }
  return line.str();
}

}  // namespace

int main(int argc, char ** argv)
{
  if (argc != 3) {
    std::cerr << "usage: planners GRID SEED\n";
    return 2;
  }
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(std::stoul(argv[2]));
  const Grid grid(argv[1]);

  auto space = std::make_shared<ob::RealVectorStateSpace>(2);
  ob::RealVectorBounds bounds(2);
  // One cell of the rim on each side is blocked: leave it out.
  bounds.low = {1.0, 1.0};
  bounds.high = {grid.columns - 1.0, grid.rows - 1.0};
  space->setBounds(bounds);
  auto si = std::make_shared<ob::SpaceInformation>(space);
  si->setStateValidityChecker(std::make_shared<GridLookup>(si, grid));
  si->setMotionValidator(std::make_shared<GridTraversal>(si, grid));
  si->setup();
  space->registerDefaultProjection(std::make_shared<Position>(space.get(), bounds));

  Request request;
  while (std::cin >> request) {
    std::cout << answer(si, request) << std::endl;
  }
  return 0;
}
