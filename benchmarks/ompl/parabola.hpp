// Whether a parabola is free on a grid: cell traversal between its turning points, exact.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "grid.hpp"

// One coordinate: x + v t + a t^2 / 2.
struct Coordinate
{
  double x, v, a;

  double at(double t) const {return x + t * (v + t * a / 2.0);}

  // The first turning point after t.
  double turn(double t) const
  {
    const double at_turn = a != 0.0 ? -v / a : -1.0;
    return at_turn > t ? at_turn : std::numeric_limits<double>::infinity();
  }

  // When it gets from where it is at t to a value, before it turns; infinite for never.
  double reach(double value, double t) const
  {
    const double speed = v + a * t, away = value - at(t);
    const double squared = speed * speed + 2.0 * a * away;
    if (squared < 0.0) {
      return std::numeric_limits<double>::infinity();
    }
    return t + 2.0 * away / (speed + std::copysign(std::sqrt(squared), away));
  }
};

// Follow a piece without turning points; the rim of the grid is blocked.
inline bool is_piece_free(
  const Grid & grid, const Coordinate & x, const Coordinate & y, double begin, double end)
{
  const double infinity = std::numeric_limits<double>::infinity();
  const double dx = x.at(end) - x.at(begin), dy = y.at(end) - y.at(begin);
  const int column_step = (dx > 0.0) - (dx < 0.0), row_step = (dy > 0.0) - (dy < 0.0);
  const auto first_cell = [](double value, int step) {
      return static_cast<std::int64_t>(step < 0 ? std::ceil(value) - 1.0 : std::floor(value));
    };
  std::int64_t column = first_cell(x.at(begin), column_step);
  std::int64_t row = first_cell(y.at(begin), row_step);
  while (grid.is_free(column, row)) {
    const double to_column =
      column_step != 0 ? x.reach(column + (column_step > 0), begin) : infinity;
    const double to_row = row_step != 0 ? y.reach(row + (row_step > 0), begin) : infinity;
    const double next = std::min(to_column, to_row);
    if (next > end) {
      return true;
    }
    if (to_column == to_row &&
      !(grid.is_free(column + column_step, row) && grid.is_free(column, row + row_step)))
    {
      return false;
    }
    column += to_column == next ? column_step : 0;
    row += to_row == next ? row_step : 0;
  }
  return false;
}

inline bool is_free(
  const Grid & grid, const Coordinate & x, const Coordinate & y, double duration)
{
  double begin = 0.0;
  while (begin < duration) {
    const double end = std::min({duration, x.turn(begin), y.turn(begin)});
    if (!is_piece_free(grid, x, y, begin, end)) {
      return false;
    }
    begin = end;
  }
  return true;
}
