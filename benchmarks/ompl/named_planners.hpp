// Geometric planners by name, made anew for each request.

#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

#include <ompl/base/Planner.h>
#include <ompl/base/SpaceInformation.h>

// Ending of the name in a request whose path OMPL is to simplify.
inline const std::string SIMPLIFY = "+simplify";

using NamedPlanners = std::map<
  std::string,
  std::function<ompl::base::PlannerPtr(const ompl::base::SpaceInformationPtr &)>>;

template<typename Planner>
ompl::base::PlannerPtr make(const ompl::base::SpaceInformationPtr & si)
{
  return std::make_shared<Planner>(si);
}
