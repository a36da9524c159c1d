// The only argument of a program that OMPL plans in: the seed of its random numbers.

#pragma once

#include <iostream>
#include <string>

#include <ompl/util/Console.h>
#include <ompl/util/RandomNumbers.h>

// Seed OMPL by the argument and silence its log; return false, with a line on stderr, without one.
inline bool seed_ompl(int argc, char ** argv)
{
  if (argc != 2) {
    std::cerr << "usage: " << argv[0] << " SEED\n";
    return false;
  }
  ompl::msg::setLogLevel(ompl::msg::LOG_NONE);
  ompl::RNG::setSeed(std::stoul(argv[1]));
  return true;
}
