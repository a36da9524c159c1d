// A convex footprint on a grid: whether it touches a blocked cell at a pose, decided exactly.

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "grid.hpp"

class Footprint
{
public:
  Footprint(const Grid & grid, std::vector<std::pair<double, double>> vertices)
  : grid_(grid), vertices_(std::move(vertices)), before_((grid.columns + 1) * std::size_t(grid.rows))
  {
    for (std::int64_t row = 0; row < grid.rows; ++row) {
      for (std::int64_t column = 0; column < grid.columns; ++column) {
        const std::size_t at = row * (grid.columns + 1) + column;
        before_[at + 1] = before_[at] + (grid.is_free(column, row) ? 0 : 1);
      }
    }
  }

  // The part of a convex polygon in a row of cells meets every cell from its leftmost to its
  // rightmost point: one look at the sums of the row is enough.
  bool is_free(double x, double y, double yaw) const
  {
    const double cos = std::cos(yaw), sin = std::sin(yaw);
    const std::size_t n = vertices_.size();
    std::vector<std::pair<double, double>> placed(n);
    double lowest = INF, highest = -INF;
    for (std::size_t k = 0; k < n; ++k) {
      placed[k] = {x + cos * vertices_[k].first - sin * vertices_[k].second,
        y + sin * vertices_[k].first + cos * vertices_[k].second};
      lowest = std::min(lowest, placed[k].second);
      highest = std::max(highest, placed[k].second);
    }
    const auto first = static_cast<std::int64_t>(std::floor(lowest));
    const auto last = static_cast<std::int64_t>(std::floor(highest));
    if (first < 0 || last >= grid_.rows) {
      return false;
    }
    for (std::int64_t row = first; row <= last; ++row) {
      double left = INF, right = -INF;
      for (std::size_t k = 0; k < n; ++k) {
        span(placed[k], placed[(k + 1) % n], row, row + 1.0, left, right);
      }
      if (left > right) {
        continue;
      }
      const auto begin = static_cast<std::int64_t>(std::floor(left));
      const auto end = static_cast<std::int64_t>(std::floor(right));
      if (begin < 0 || end >= grid_.columns) {
        return false;
      }
      const std::size_t base = row * (grid_.columns + 1);
      if (before_[base + end + 1] != before_[base + begin]) {
        return false;
      }
    }
    return true;
  }

private:
  using Point = std::pair<double, double>;
  static constexpr double INF = std::numeric_limits<double>::infinity();

  // Extend [left, right] by the part of a segment between two heights.
  static void span(Point a, Point b, double bottom, double top, double & left, double & right)
  {
    if (a.second > b.second) {
      std::swap(a, b);
    }
    if (a.second > top || b.second < bottom) {
      return;
    }
    const double slope = (b.first - a.first) / (b.second - a.second);
    const double low = a.second < bottom ? a.first + (bottom - a.second) * slope : a.first;
    const double high = b.second > top ? a.first + (top - a.second) * slope : b.first;
    left = std::min(left, std::min(low, high));
    right = std::max(right, std::max(low, high));
  }

  const Grid & grid_;
  std::vector<Point> vertices_;
  std::vector<std::int32_t> before_;
};
