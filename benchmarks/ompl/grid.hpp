// An occupancy grid: lookup, and the exact traversal of a segment.

#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

struct Grid
{
  std::int32_t rows, columns;
  std::vector<std::uint8_t> blocked;

  explicit Grid(const std::string & file)
  {
    std::ifstream stream(file, std::ios::binary);
    stream.read(reinterpret_cast<char *>(&rows), sizeof rows);
    stream.read(reinterpret_cast<char *>(&columns), sizeof columns);
    blocked.resize(static_cast<std::size_t>(rows) * columns);
    stream.read(reinterpret_cast<char *>(blocked.data()), blocked.size());
    if (!stream) {
      throw std::runtime_error("no grid in " + file);
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
