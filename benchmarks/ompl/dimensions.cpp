// OMPL in n dimensions: reads commands, one a line, and answers each request with a line.
//
//   dimensions SEED
//   solids DIM LOWER... UPPER... N_BOXES (LOWER... UPPER...)... N_BALLS (CENTRE... RADIUS)...
//                           a box without boxes and balls. No answer.
//   arm LINKS RESOLUTION N_DISCS (X Y RADIUS)...
//                           an arm among discs; motions are tested at that distance. No answer.
//   PLANNER SECONDS START... GOAL...
//   SECONDS N X...          the answer: N vertices, 0 when no path was found in time
//
// The seconds of an answer are processor time of setup() and solve() of a new planner. With
// PLANNER+simplify the path simplifier runs once, as it does by default, and with PLANNER+shorten
// again and again until the seconds of the request are over; that counts. Among solids motions are
// tested exactly; for the arm OMPL tests states along them, as it does by default.

#include <algorithm>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include <ompl/base/MotionValidator.h>
#include <ompl/base/ProblemDefinition.h>
#include <ompl/base/SpaceInformation.h>
#include <ompl/base/spaces/RealVectorStateSpace.h>
#include <ompl/geometric/PathGeometric.h>
#include <ompl/geometric/PathSimplifier.h>
#include <ompl/geometric/planners/est/BiEST.h>
#include <ompl/geometric/planners/kpiece/BKPIECE1.h>
#include <ompl/geometric/planners/kpiece/LBKPIECE1.h>
#include <ompl/geometric/planners/rrt/RRTConnect.h>
#include <ompl/geometric/planners/sbl/SBL.h>

#include "named_planners.hpp"
#include "seed.hpp"
#include "solids.hpp"

namespace ob = ompl::base;
namespace og = ompl::geometric;

namespace
{

const std::string SHORTEN = "+shorten";
const double STOP_BEFORE = 1e-9;

using States = std::shared_ptr<ob::RealVectorStateSpace>;

const NamedPlanners PLANNERS = {
  {"RRTConnect", make<og::RRTConnect>}, {"BKPIECE1", make<og::BKPIECE1>},
  {"LBKPIECE1", make<og::LBKPIECE1>}, {"SBL", make<og::SBL>}, {"BiEST", make<og::BiEST>},
};

double processor_time()
{
  timespec now;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

const double * coordinates(const ob::State * state)
{
  return state->as<ob::RealVectorStateSpace::StateType>()->values;
}

template<typename Obstacles>
class Membership : public ob::StateValidityChecker
{
public:
  Membership(const ob::SpaceInformationPtr & si, const Obstacles & obstacles)
  : ob::StateValidityChecker(si), obstacles_(obstacles) {}

  bool isValid(const ob::State * state) const override
  {
    return si_->satisfiesBounds(state) && obstacles_.is_free(coordinates(state));
  }

private:
  const Obstacles obstacles_;
};

class ExactMotions : public ob::MotionValidator
{
public:
  ExactMotions(const ob::SpaceInformationPtr & si, const Solids & solids)
  : ob::MotionValidator(si), solids_(solids) {}

  bool checkMotion(const ob::State * from, const ob::State * to) const override
  {
    return si_->satisfiesBounds(to) && solids_.is_free(coordinates(from), coordinates(to));
  }

  bool checkMotion(
    const ob::State * from, const ob::State * to,
    std::pair<ob::State *, double> & last_valid) const override
  {
    const double part =
      si_->satisfiesBounds(to) ? solids_.free_part(coordinates(from), coordinates(to)) : 0.0;
    if (part > 1.0) {
      return true;
    }
    last_valid.second = std::max(0.0, part - STOP_BEFORE / si_->distance(from, to));
    if (last_valid.first != nullptr) {
      si_->getStateSpace()->interpolate(from, to, last_valid.second, last_valid.first);
    }
    return false;
  }

private:
  const Solids solids_;
};

// Free space, and OMPL set up in it.
class Course
{
public:
  static Course of_solids(std::istream & stream)
  {
    std::size_t dim, count;
    stream >> dim;
    Course course(dim);
    course.bounds_.low = read_numbers(stream, dim);
    course.bounds_.high = read_numbers(stream, dim);
    Solids solids;
    for (stream >> count; count > 0; --count) {
      const Numbers lower = read_numbers(stream, dim);
      solids.boxes.push_back({lower, read_numbers(stream, dim)});
    }
    for (stream >> count; count > 0; --count) {
      const Numbers centre = read_numbers(stream, dim);
      solids.balls.push_back({centre, read_numbers(stream, 1)[0]});
    }
    course.set_up<Solids>(solids);
    course.si_->setMotionValidator(std::make_shared<ExactMotions>(course.si_, solids));
    course.si_->setup();
    return course;
  }

  static Course of_arm(std::istream & stream)
  {
    std::size_t links, n_discs;
    double resolution;
    stream >> links >> resolution >> n_discs;
    Course course(links);
    course.bounds_.setLow(-M_PI);
    course.bounds_.setHigh(M_PI);
    course.set_up<Arm>({links, read_numbers(stream, 3 * n_discs)});
    course.si_->setStateValidityCheckingResolution(resolution / course.space_->getMaximumExtent());
    course.si_->setup();
    return course;
  }

  std::string answer(const std::string & request, std::istream & stream) const
  {
    const std::size_t dim = space_->getDimension();
    const double limit = read_numbers(stream, 1)[0];
    const Numbers ends = read_numbers(stream, 2 * dim);
    auto problem = std::make_shared<ob::ProblemDefinition>(si_);
    ob::ScopedState<ob::RealVectorStateSpace> start(space_), goal(space_);
    for (std::size_t i = 0; i < dim; ++i) {
      start[i] = ends[i];
      goal[i] = ends[dim + i];
    }
    problem->setStartAndGoalStates(start, goal);
    og::PathGeometric path(si_);
    const double seconds = solve(request, limit, problem, path);
    std::ostringstream line;
    line << std::setprecision(17) << seconds << ' ' << path.getStateCount();
    for (const ob::State * state : path.getStates()) {
      for (std::size_t i = 0; i < dim; ++i) {
        line << ' ' << coordinates(state)[i];
      }
    }
    return line.str();
  }

private:
  explicit Course(std::size_t dim)
  : space_(std::make_shared<ob::RealVectorStateSpace>(dim)), bounds_(dim) {}

  template<typename Obstacles>
  void set_up(const Obstacles & obstacles)
  {
    space_->setBounds(bounds_);
    si_ = std::make_shared<ob::SpaceInformation>(space_);
    si_->setStateValidityChecker(std::make_shared<Membership<Obstacles>>(si_, obstacles));
  }

  double solve(
    const std::string & request, double limit, const ob::ProblemDefinitionPtr & problem,
    og::PathGeometric & path) const
  {
    const std::size_t plus = std::min(request.find('+'), request.size());
    const std::string after = request.substr(plus);
    const ob::PlannerPtr planner = PLANNERS.at(request.substr(0, plus))(si_);
    planner->setProblemDefinition(problem);
    const double began = processor_time();
    planner->setup();
    if (planner->solve(ob::timedPlannerTerminationCondition(limit)) ==
      ob::PlannerStatus::EXACT_SOLUTION)
    {
      path = *problem->getSolutionPath()->as<og::PathGeometric>();
      og::PathSimplifier simplifier(si_, problem->getGoal());
      if (after == SIMPLIFY) {
        simplifier.simplifyMax(path);
      } else if (after == SHORTEN) {
        simplifier.simplify(path, began + limit - processor_time());
      }
    }
    return processor_time() - began;
  }

  States space_;
  ob::RealVectorBounds bounds_;
  ob::SpaceInformationPtr si_;
};

}  // namespace

int main(int argc, char ** argv)
{
  if (!seed_ompl(argc, argv)) {
    return 2;
  }
  std::unique_ptr<Course> course;
  for (std::string command; std::cin >> command; ) {
    if (command == "solids") {
      course = std::make_unique<Course>(Course::of_solids(std::cin));
    } else if (command == "arm") {
      course = std::make_unique<Course>(Course::of_arm(std::cin));
    } else {
      std::cout << course->answer(command, std::cin) << std::endl;
    }
  }
  return 0;
}
